//! Tags that sharpen a cage: `t name integers/numbers/strings …`, as in RenderMan.

use super::{Reader, shown};
use crate::geometry::{BoundaryRule, Corner, Crease};
use crate::io::LoadError;
use crate::math::Counted;

/// A sharpness in a file of this or more is infinite, as in OpenSubdiv.
const INFINITE: f64 = 10.0;

impl<'a> Reader<'a> {
    /// Reads a tag: its name, the number of values of each kind, and the values.
    pub(super) fn tag(&mut self, keyword: &'a str, words: &[&'a str]) -> Result<(), LoadError> {
        let [name, counts, values @ ..] = words else {
            let message = "a tag needs a name and counts, as in t crease 2/1/0 0 1 2.5";
            return Err(self.malformed(keyword, message));
        };
        let [integers, numbers, strings] = self.counts(counts)?;
        let wanted = integers.checked_add(numbers).and_then(|sum| sum.checked_add(strings));
        if wanted != Some(values.len()) {
            let needed = wanted.map_or_else(String::new, |wanted| format!(", which need {wanted}"));
            let message = format!(
                "{} {} the counts {}{needed}",
                Counted(values.len(), "value"),
                if values.len() == 1 { "follows" } else { "follow" },
                shown(counts)
            );
            return Err(self.malformed(counts, message));
        }
        let (integers, rest) = values.split_at(integers);
        let numbers = &rest[..numbers];
        match *name {
            "crease" => self.crease(counts, integers, numbers),
            "corner" => self.corner(counts, integers, numbers),
            "interpolateboundary" => self.boundary(counts, integers),
            "creasemethod" if rest == ["normal"] || rest == ["uniform"] => Ok(()),
            "creasemethod" => {
                let (word, found) = match rest {
                    [only] => (*only, shown(only)),
                    _ => (*name, Counted(rest.len(), "word").to_string()),
                };
                let message = format!("creasemethod {found}: normal or uniform is needed");
                Err(self.malformed(word, message))
            }
            _ => {
                let message = format!(
                    "tag {} is not understood: crease, corner, interpolateboundary and \
                     creasemethod are",
                    shown(name)
                );
                Err(self.malformed(name, message))
            }
        }
    }

    fn counts(&self, word: &'a str) -> Result<[usize; 3], LoadError> {
        let counts: Option<Vec<usize>> = word.split('/').map(|count| count.parse().ok()).collect();
        match counts.as_deref() {
            Some(&[integers, numbers, strings]) => Ok([integers, numbers, strings]),
            _ => {
                Err(self
                    .malformed(word, format!("{} is no count of values like 2/1/0", shown(word))))
            }
        }
    }

    fn index(&self, word: &'a str) -> Result<usize, LoadError> {
        let message = || format!("{} is not a vertex counted from 0", shown(word));
        word.parse().map_err(|_| self.malformed(word, message()))
    }

    fn sharpness(&self, word: &'a str) -> Result<f64, LoadError> {
        match word.parse::<f64>() {
            Ok(value) if value >= INFINITE => Ok(f64::INFINITY),
            Ok(value) if value >= 0.0 => Ok(value),
            _ => Err(self.malformed(word, format!("{} is not a sharpness from 0 on", shown(word)))),
        }
    }

    /// A chain of vertices, with one sharpness for all its edges or one for each.
    fn crease(
        &mut self,
        counts: &'a str,
        vertices: &[&'a str],
        numbers: &[&'a str],
    ) -> Result<(), LoadError> {
        let edges = vertices.len().saturating_sub(1);
        if edges == 0 || (numbers.len() != 1 && numbers.len() != edges) {
            let message = format!(
                "a crease of {} with {}: it needs 2 or more, and one sharpness or one for each edge",
                Counted(vertices.len(), "vertex"),
                Counted(numbers.len(), "sharpness")
            );
            return Err(self.malformed(counts, message));
        }
        for (edge, pair) in vertices.windows(2).enumerate() {
            let sharpness = self.sharpness(numbers[edge.min(numbers.len() - 1)])?;
            let vertices = [self.index(pair[0])?, self.index(pair[1])?];
            self.parts.creases.push(Crease { vertices, sharpness });
            self.offsets.creases.push(self.source.offset_of(pair[0]));
        }
        Ok(())
    }

    /// Vertices, with one sharpness for all or one for each.
    fn corner(
        &mut self,
        counts: &'a str,
        vertices: &[&'a str],
        numbers: &[&'a str],
    ) -> Result<(), LoadError> {
        if vertices.is_empty() || (numbers.len() != 1 && numbers.len() != vertices.len()) {
            let message = format!(
                "{} with {}: one for all or one for each is needed",
                Counted(vertices.len(), "corner"),
                Counted(numbers.len(), "sharpness")
            );
            return Err(self.malformed(counts, message));
        }
        for (index, word) in vertices.iter().enumerate() {
            let sharpness = self.sharpness(numbers[index.min(numbers.len() - 1)])?;
            self.parts.corners.push(Corner { vertex: self.index(word)?, sharpness });
            self.offsets.corners.push(self.source.offset_of(word));
        }
        Ok(())
    }

    fn boundary(&mut self, counts: &'a str, integers: &[&'a str]) -> Result<(), LoadError> {
        self.parts.boundary = match integers {
            ["1"] => BoundaryRule::EdgeAndCorner,
            ["2"] => BoundaryRule::EdgeOnly,
            _ => {
                let found = shown(&integers.join(" "));
                let message = format!(
                    "interpolateboundary {found}: 1 (edges and corners) or 2 (edges only) is needed"
                );
                return Err(self.malformed(integers.first().unwrap_or(&counts), message));
            }
        };
        Ok(())
    }
}
