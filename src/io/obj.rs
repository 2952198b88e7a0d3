//! Cages of subdivision surfaces from Wavefront OBJ files.
//!
//! ```text
//! v -1 -1 0          a vertex: x y z
//! f 1 2 3 4          a face: vertices counted from 1, or back from the last with -1
//! f 1/1 2/2/1 3//1   texture and normal indices may follow; they are not used
//! t crease 2/1/0 0 1 2.5        the edge from vertex 0 to 1 has sharpness 2.5
//! t corner 1/1/0 3 inf          vertex 3 is sharp
//! t interpolateboundary 1/0/0 2
//! ```
//!
//! What is done with the rest:
//!
//! | statement | |
//! |---|---|
//! | `v` with a weight or a colour | weight must be 1 if a face or tag uses `v`; colours are left out with a note |
//! | `v` that no face and no tag uses | left out, and a note says so |
//! | `v` at the same place as another one | only vertices of the same number join faces; a note says so |
//! | `f` that has a vertex twice in a row | counts once; `f` is left out if fewer than three remain; a note says so |
//! | `fo` | `f` in older files |
//! | `vp`, `cstype`, `deg`, `curv`, `surf` and the like: free-form (NURBS) curves and surfaces | not read yet: beside a sound cage a note says so, else an error does |
//! | `t crease`, `t corner` | as OpenSubdiv's test shapes write them: vertices counted from 0, sharpness of 10 or more is infinite |
//! | `t interpolateboundary` | 1: edges and corners, 2: edges only; others are an error |
//! | `t creasemethod` | `normal` or `uniform`, which make no difference; others are an error |
//! | `vt`, `vn`, `g`, `o`, `s`, `usemtl`, `mtllib`, points, lines | left out, with one note a kind |
//! | statements for display only, or that call other programs | left out, with one note a kind |
//! | anything else | an error |
//!
//! A bare OBJ file, and `shape = { file = … }` in a scene, show the cage's Catmull–Clark surface;
//! `shape = { doo_sabin = { file = … } }` shows the Doo–Sabin surface.
//!
//! A line that ends in `\` continues on the next; `#` begins a comment.

mod tags;

use std::borrow::Cow;
use std::collections::HashSet;
use std::num::IntErrorKind;

use glam::DVec3;

use super::LoadError;
use super::cage_offsets::CageOffsets;
use super::source::Source;
use crate::geometry::{Cage, CageError, CageParts};
use crate::math::Counted;
use crate::scene::ImportNote;

/// A cage from a file, and what else the file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct CageModel {
    /// The cage.
    pub cage: Cage,
    /// What is not used, and why.
    pub notes: Vec<ImportNote>,
}

/// The reason given for leaving out statements for free-form geometry.
const FREE_FORM: &str = "free-form (NURBS) curves and surfaces in OBJ are not read yet";

/// Statements that are no part of a cage, and what they are.
const IGNORED: [(&str, &str); 42] = [
    ("vt", "texture coordinates are not used"),
    ("vn", "the surface has its own normals"),
    ("vp", FREE_FORM),
    ("g", "groups are not used"),
    ("o", "all objects of the file are one cage"),
    ("s", "the subdivision scheme smooths the surface"),
    ("mg", "the subdivision scheme smooths the surface"),
    ("usemtl", "materials come from the scene"),
    ("mtllib", "materials come from the scene"),
    ("usemap", "materials come from the scene"),
    ("maplib", "materials come from the scene"),
    ("l", "a line has no surface"),
    ("p", "a point has no surface"),
    ("bevel", "it is for display only"),
    ("c_interp", "it is for display only"),
    ("d_interp", "it is for display only"),
    ("lod", "it is for display only"),
    ("shadow_obj", "it is for display only"),
    ("trace_obj", "it is for display only"),
    ("call", "no other file is read, and no program run"),
    ("csh", "no other file is read, and no program run"),
    ("ctech", FREE_FORM),
    ("stech", FREE_FORM),
    ("cstype", FREE_FORM),
    ("deg", FREE_FORM),
    ("bmat", FREE_FORM),
    ("step", FREE_FORM),
    ("curv", FREE_FORM),
    ("curv2", FREE_FORM),
    ("surf", FREE_FORM),
    ("parm", FREE_FORM),
    ("trim", FREE_FORM),
    ("hole", FREE_FORM),
    ("scrv", FREE_FORM),
    ("sp", FREE_FORM),
    ("con", FREE_FORM),
    ("end", FREE_FORM),
    // Of older versions of the format.
    ("bsp", FREE_FORM),
    ("bzp", FREE_FORM),
    ("cdc", FREE_FORM),
    ("cdp", FREE_FORM),
    ("res", FREE_FORM),
];

/// Entry of the statements left out: a colour after a vertex.
const COLOUR: (&str, &str) = ("v", "colours of vertices are not used");

/// Entry of the statements left out: vertices without faces.
const UNUSED: (&str, &str) = ("v", "a vertex of no face is not used");

/// Entry of the statements left out: vertices at the same place as another one.
const COINCIDENT: (&str, &str) = (
    "v",
    "another vertex lies at the same place: the surface ends there, or has a seam of its own",
);

/// Entry of the statements left out: faces that have a vertex twice in a row.
const REPEATED: (&str, &str) = ("f", "a corner repeated in a row counts once");

/// Entry of the statements left out: faces left with fewer than three corners.
const DEGENERATE: (&str, &str) = ("f", "a face of fewer than three corners is not used");

/// Reads a cage; errors and notes call the file `label`. Lines end with LF, CR LF, or, as in old
/// files, CR.
///
/// # Errors
/// When a statement is not understood, or the faces do not make a cage; then the error's place is
/// the face, vertex or tag that is at fault.
pub fn read_obj_cage(text: &str, label: &str) -> Result<CageModel, LoadError> {
    let text = &with_line_feeds(text.strip_prefix('\u{feff}').unwrap_or(text));
    let mut reader = Reader {
        source: Source::new(text, label),
        parts: CageParts::default(),
        offsets: CageOffsets::default(),
        left_out: Vec::new(),
        weighted: Vec::new(),
        ahead: Vec::new(),
    };
    for line in lines(text) {
        reader.statement(&line)?;
    }
    reader.finish()
}

/// The text with LF in place of every CR that stands alone: no LF ends the run of them that it is
/// in. (Files that were translated twice have CR CR LF.)
fn with_line_feeds(text: &str) -> Cow<'_, str> {
    // From the end on: whether a run of CRs, if it goes on, ends in LF.
    let is_alone = |ends: &mut bool, byte: u8| match byte {
        b'\r' => !*ends,
        _ => {
            *ends = byte == b'\n';
            false
        }
    };
    let mut ends = false;
    if !text.bytes().rev().any(|byte| is_alone(&mut ends, byte)) {
        return text.into();
    }
    let (mut bytes, mut ends) = (text.as_bytes().to_vec(), false);
    for byte in bytes.iter_mut().rev() {
        if is_alone(&mut ends, *byte) {
            *byte = b'\n';
        }
    }
    String::from_utf8_lossy(&bytes).into_owned().into()
}

/// The words of a statement.
type Words<'a> = Vec<&'a str>;

/// The statements of a text: lines, joined with their continuations, without comments.
fn lines(text: &str) -> impl Iterator<Item = Words<'_>> {
    let mut rest = text.lines();
    std::iter::from_fn(move || {
        let mut words = Vec::new();
        let mut line = rest.next()?;
        loop {
            let code = line.split('#').next().unwrap_or("").trim_end();
            // In some encodings a character may end with the byte of a backslash.
            let (code, goes_on) = match code.strip_suffix('\\') {
                Some(code) if !code.ends_with(char::REPLACEMENT_CHARACTER) => (code, true),
                _ => (code, false),
            };
            words.extend(code.split_whitespace());
            match if goes_on { rest.next() } else { None } {
                Some(next) => line = next,
                None => return Some(words),
            }
        }
    })
}

/// A word of the file within a message: in quotes, on one line, and shortened if it is long, as in
/// files that are not OBJ at all.
fn shown(word: &str) -> String {
    let (beginning, more) = shortened(word);
    format!("{beginning:?}{more}")
}

/// The beginning of a word, and a mark for the rest if it is long.
fn shortened(word: &str) -> (&str, &'static str) {
    match word.char_indices().nth(LONGEST) {
        Some((end, _)) => (&word[..end], "…"),
        None => (word, ""),
    }
}

/// The longest word shown in full.
const LONGEST: usize = 40;

/// The vertex that a corner names, as written.
fn vertex_of(corner: &str) -> String {
    let (vertex, more) = shortened(corner.split('/').next().unwrap_or(corner));
    format!("{vertex}{more}")
}

#[derive(Debug)]
struct Reader<'a> {
    source: Source<'a>,
    parts: CageParts,
    offsets: CageOffsets,
    /// Kind of statement, offset of the first one, and their number.
    left_out: Vec<((&'static str, &'static str), usize, usize)>,
    /// Vertices whose weight is not 1, with the weight as written: free-form surfaces may have such
    /// vertices.
    weighted: Vec<(usize, &'a str)>,
    /// Corners whose vertices had not come yet, each later than those of the corners before it; the
    /// first one whose vertex never comes is among them.
    ahead: Vec<(usize, &'a str)>,
}

impl<'a> Reader<'a> {
    fn statement(&mut self, words: &[&'a str]) -> Result<(), LoadError> {
        let Some((&keyword, values)) = words.split_first() else { return Ok(()) };
        match keyword {
            "v" => self.vertex(keyword, values),
            "f" | "fo" => self.face(keyword, values),
            "t" => self.tag(keyword, values),
            _ => match IGNORED.iter().find(|(known, _)| *known == keyword) {
                Some(kind) => {
                    self.leave_out(*kind, keyword);
                    Ok(())
                }
                None => {
                    Err(self.malformed(keyword, format!("unknown statement {}", shown(keyword))))
                }
            },
        }
    }

    fn leave_out(&mut self, kind: (&'static str, &'static str), word: &'a str) {
        self.leave_out_at(kind, self.source.offset_of(word));
    }

    fn leave_out_at(&mut self, kind: (&'static str, &'static str), offset: usize) {
        match self.left_out.iter_mut().find(|(known, _, _)| *known == kind) {
            Some((_, _, count)) => *count += 1,
            None => self.left_out.push((kind, offset, 1)),
        }
    }

    fn malformed(&self, word: &'a str, message: impl Into<String>) -> LoadError {
        LoadError::malformed(self.source.place(self.source.offset_of(word)), message)
    }

    fn number(&self, word: &'a str) -> Result<f64, LoadError> {
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(self.malformed(word, format!("{}: numbers must be finite", shown(word)))),
            Err(_) => Err(self.malformed(word, format!("{} is not a number", shown(word)))),
        }
    }

    /// `v x y z`, followed by a weight, a colour, both or nothing.
    fn vertex(&mut self, keyword: &'a str, values: &[&'a str]) -> Result<(), LoadError> {
        let numbers = values.iter().map(|word| self.number(word));
        let numbers = numbers.collect::<Result<Vec<f64>, _>>()?;
        let weight = match numbers.len() {
            3 | 6 => None,
            4 | 7 => Some(3),
            count => {
                let message =
                    format!("a vertex has {}: it needs 3 (x y z)", Counted(count, "number"));
                return Err(self.malformed(keyword, message));
            }
        };
        if let Some(index) = weight.filter(|&index| numbers[index] != 1.0) {
            self.weighted.push((self.parts.positions.len(), values[index]));
        }
        if numbers.len() > 4 {
            self.leave_out(COLOUR, keyword);
        }
        self.parts.positions.push(DVec3::new(numbers[0], numbers[1], numbers[2]));
        self.offsets.vertices.push(self.source.offset_of(keyword));
        Ok(())
    }

    /// `f v v v …`, `f v/vt …`, `f v//vn …` or `f v/vt/vn …`.
    fn face(&mut self, keyword: &'a str, values: &[&'a str]) -> Result<(), LoadError> {
        if values.len() < 3 {
            let message =
                format!("a face has {}: it needs 3 or more", Counted(values.len(), "corner"));
            return Err(self.malformed(keyword, message));
        }
        let corners = values.iter().map(|word| self.corner_vertex(word));
        let corners = corners.collect::<Result<Vec<usize>, _>>()?;
        for (&vertex, &word) in corners.iter().zip(values) {
            let latest = self.ahead.last().map_or(self.parts.positions.len(), |(last, _)| last + 1);
            if vertex >= latest {
                self.ahead.push((vertex, word));
            }
        }
        self.parts.faces.push(corners);
        self.offsets.faces.push(self.source.offset_of(keyword));
        Ok(())
    }

    /// The vertex of a face's corner, counted from 0. It may come later in the file.
    fn corner_vertex(&self, word: &'a str) -> Result<usize, LoadError> {
        let mut indices = word.split('/');
        let vertex = indices.next().unwrap_or("");
        let others: Vec<&str> = indices.collect();
        let index = |written: &str| match written.parse::<i64>() {
            Ok(index) if index != 0 => Ok(index),
            Ok(_) => Err(self.malformed(word, "index 0: indices count from 1".to_owned())),
            // No file has as many vertices as that, which is said below or later.
            Err(error) if *error.kind() == IntErrorKind::PosOverflow => Ok(i64::MAX),
            Err(error) if *error.kind() == IntErrorKind::NegOverflow => Ok(i64::MIN),
            Err(_) => {
                let message = format!("{} is not a corner: v, v/vt, v//vn or v/vt/vn", shown(word));
                Err(self.malformed(word, message))
            }
        };
        let vertex = index(vertex)?;
        for other in others.iter().filter(|other| !other.is_empty()) {
            index(other)?;
        }
        if others.len() > 2 {
            let message = format!("{} has {} indices: at most 3", shown(word), others.len() + 1);
            return Err(self.malformed(word, message));
        }
        let known = self.parts.positions.len();
        if vertex > 0 {
            return Ok(usize::try_from(vertex - 1).unwrap_or(usize::MAX));
        }
        let back = usize::try_from(vertex.unsigned_abs()).unwrap_or(usize::MAX);
        known.checked_sub(back).ok_or_else(|| {
            self.malformed(word, {
                let verb = if known == 1 { "comes" } else { "come" };
                let vertex = vertex_of(word);
                format!("vertex {vertex}: only {} {verb} before", Counted(known, "vertex"))
            })
        })
    }

    /// The first statement for free-form geometry, and where it is.
    fn free_form(&self) -> Option<(&'static str, usize)> {
        let mut kinds = self.left_out.iter().filter(|((_, why), ..)| *why == FREE_FORM);
        kinds.next().map(|((keyword, _), first, _)| (*keyword, *first))
    }

    /// Leaves out corners repeated in a row, and faces left with fewer than three corners; returns
    /// the numbers of the faces kept.
    fn tidy_faces(&mut self) -> Result<Vec<usize>, LoadError> {
        let vertices = self.parts.positions.len();
        if let Some((_, word)) = self.ahead.iter().find(|(vertex, _)| *vertex >= vertices) {
            let message = format!("vertex {}: the file has only {vertices}", vertex_of(word));
            return Err(self.malformed(word, message));
        }
        let mut kept = Vec::new();
        for (number, mut corners) in std::mem::take(&mut self.parts.faces).into_iter().enumerate() {
            let offset = self.offsets.faces[number];
            let count = corners.len();
            corners.dedup();
            if corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            if corners.len() < 3 {
                self.leave_out_at(DEGENERATE, offset);
                continue;
            }
            if corners.len() < count {
                self.leave_out_at(REPEATED, offset);
            }
            kept.push(number);
            self.parts.faces.push(corners);
        }
        Ok(kept)
    }

    /// Leaves out vertices that neither faces nor tags use; returns the numbers of those kept.
    fn keep_used_vertices(&mut self) -> Vec<usize> {
        let CageParts { positions, faces, creases, corners, .. } = &mut self.parts;
        let mut is_used = vec![false; positions.len()];
        let named = faces.iter().flatten().copied();
        let named = named.chain(creases.iter().flat_map(|crease| crease.vertices));
        for vertex in named.chain(corners.iter().map(|corner| corner.vertex)) {
            // Tags may name vertices that do not exist: an error, reported later.
            is_used.get_mut(vertex).into_iter().for_each(|used| *used = true);
        }
        let (kept, unused): (Vec<usize>, Vec<usize>) =
            (0..positions.len()).partition(|&vertex| is_used[vertex]);
        if let Some(&first) = unused.first() {
            self.left_out.push((UNUSED, self.offsets.vertices[first], unused.len()));
            let mut numbers = vec![0; positions.len()];
            for (new, &old) in kept.iter().enumerate() {
                numbers[old] = new;
            }
            // A vertex that does not exist keeps its number.
            let renumber = |vertex: &mut usize| *vertex = *numbers.get(*vertex).unwrap_or(vertex);
            *positions = kept.iter().map(|&vertex| positions[vertex]).collect();
            faces.iter_mut().flatten().for_each(renumber);
            creases.iter_mut().flat_map(|crease| &mut crease.vertices).for_each(renumber);
            corners.iter_mut().map(|corner| &mut corner.vertex).for_each(renumber);
        }
        kept
    }

    /// Notes vertices at the same place as an earlier one: if faces share no vertices, nothing is
    /// smoothed.
    fn note_coincident(&mut self, kept: &[usize]) {
        let place_of = |position: &DVec3| (*position + DVec3::ZERO).to_array().map(f64::to_bits); // −0 becomes 0
        let mut places = HashSet::new();
        let all = kept.iter().zip(&self.parts.positions);
        let mut again = all.filter(|(_, position)| !places.insert(place_of(position)));
        if let Some((&first, _)) = again.next() {
            let count = 1 + again.count();
            self.left_out.push((COINCIDENT, self.offsets.vertices[first], count));
        }
    }

    fn finish(mut self) -> Result<CageModel, LoadError> {
        let vertices = self.parts.positions.len();
        let kept_faces = self.tidy_faces()?;
        let kept = self.keep_used_vertices();
        self.note_coincident(&kept);
        self.left_out.sort_by_key(|(_, first, _)| *first); // in the order of the file
        // Files of free-form surfaces have no faces at all. The error is then that these are not
        // read, not that the cage is wrong.
        let free_form = self.free_form().map(|(keyword, first)| {
            let message =
                format!("statement \"{keyword}\": {FREE_FORM}; cages, made of faces, are");
            LoadError::malformed(self.source.place(first), message)
        });
        let of_cage = |vertex: &usize| kept.binary_search(vertex).is_ok();
        if let Some(&(_, weight)) = self.weighted.iter().find(|(vertex, _)| of_cage(vertex)) {
            let message = format!("weight {}: vertices of a cage have weight 1", shown(weight));
            return Err(self.malformed(weight, message));
        }
        let notes = self.left_out.iter().map(|((keyword, why), first, count)| {
            let times = if *count == 1 { "once" } else { &format!("{count} times") };
            let what = format!("statement \"{keyword}\", {times}");
            ImportNote { place: self.source.place(*first), what, why: (*why).to_owned() }
        });
        let notes = notes.collect();
        let has_faces = self.left_out.iter().any(|(what, ..)| *what == DEGENERATE);
        let (source, offsets) = (self.source, self.offsets);
        match Cage::new(self.parts) {
            Ok(cage) => Ok(CageModel { cage, notes }),
            Err(error) => {
                if let (CageError::Empty, Some(free_form)) = (&error, free_form) {
                    return Err(free_form);
                }
                let error = error.of_kept((&kept, vertices), &kept_faces);
                let place = match offsets.of(&error) {
                    Some(offset) => source.place(offset),
                    None => source.file().clone(),
                };
                let message = match error {
                    CageError::Empty if has_faces => {
                        "no face of the file has three different corners: it is no cage".to_owned()
                    }
                    CageError::Empty => "the file has no faces: it is no cage".to_owned(),
                    _ => format!("{error} (counted from 0)"),
                };
                Err(LoadError::malformed(place, message))
            }
        }
    }
}

#[cfg(test)]
mod tests;
