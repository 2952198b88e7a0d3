//! What surfaces look like: diffuse colours and patterns on (u, v).

use glam::DVec2;

use super::light::check_amount;
use super::{LightError, Rgb};

/// A diffuse material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name; unique in a scene.
    pub name: String,
    /// Its colour from place to place.
    pub texture: Texture,
}

/// A colour for each (u, v), on parameters scaled to `[0, 1]²` over the surface's domain.
///
/// Patterns are functions of the surface's own parameters: they show how it was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Texture {
    /// One colour everywhere.
    Constant(Rgb),
    /// Rectangles of two colours in turn.
    Checker {
        /// How many rectangles from end to end, in u and in v.
        count: [u32; 2],
        /// The colour at the start of the domain, and the other one.
        colors: [Rgb; 2],
    },
    /// Iso-parameter lines: `count` cells from end to end with a line around each, so that
    /// the borders (seams, poles) have one too.
    IsoLines {
        /// How many cells from end to end, in u and in v; 0 draws no line across that way.
        count: [u32; 2],
        /// The width of a line as a share of a cell, in [0, 1].
        width: f64,
        /// The colour of the lines.
        line: Rgb,
        /// The colour between them.
        base: Rgb,
    },
}

impl Texture {
    /// Refuses numbers that are not colours, and widths of lines that are not a share of their
    /// cells.
    ///
    /// # Errors
    /// When a number of a colour is negative or not finite, or a width is not from 0 to 1.
    pub fn check(&self) -> Result<(), LightError> {
        match *self {
            Self::Constant(color) => check_amount("color", color),
            Self::Checker { colors, .. } => {
                colors.into_iter().try_for_each(|color| check_amount("color", color))
            }
            Self::IsoLines { width, line, base, .. } => {
                if !(0.0..=1.0).contains(&width) {
                    return Err(LightError::Width { width });
                }
                check_amount("color of lines", line)?;
                check_amount("color between lines", base)
            }
        }
    }
}

impl Material {
    /// The largest share of light it sends back anywhere, in any of the three channels.
    pub fn largest_albedo(&self) -> f64 {
        let colors = match self.texture {
            Texture::Constant(color) => [color, color],
            Texture::Checker { colors, .. } => colors,
            Texture::IsoLines { line, base, .. } => [line, base],
        };
        colors.into_iter().flatten().fold(0.0, f64::max)
    }

    /// The share of light sent back at (u, v) of a surface with this domain, linear Rec. 709.
    ///
    /// Parameters off the domain take the colour of its nearest border; NaN that of its start.
    /// The domain is only asked for where the colour depends on the place.
    pub fn albedo(&self, uv: DVec2, domain: impl FnOnce() -> [[f64; 2]; 2]) -> Rgb {
        let place = || {
            let [u, v] = domain();
            [share(uv.x, u), share(uv.y, v)]
        };
        match self.texture {
            Texture::Constant(color) => color,
            Texture::Checker { count, colors } => {
                let place = place();
                let cells = cell(place[0], count[0]) + cell(place[1], count[1]);
                colors[(cells % 2) as usize]
            }
            Texture::IsoLines { count, width, line, base } => {
                let place = place();
                let on_line = (0..2).any(|k| near_line(place[k], count[k], width));
                if on_line { line } else { base }
            }
        }
    }
}

/// Where `t` lies in a domain, as a share of it in [0, 1].
pub(crate) fn share(t: f64, [start, end]: [f64; 2]) -> f64 {
    let share = (t - start) / (end - start);
    if share > 0.0 { share.min(1.0) } else { 0.0 } // NaN too
}

/// Which of `count` cells a share lies in; the end belongs to the last.
fn cell(share: f64, count: u32) -> u64 {
    let last = u64::from(count.max(1) - 1);
    ((share * f64::from(count)) as u64).min(last)
}

/// Whether a share lies within half a line's width of one of `count + 1` even lines.
fn near_line(share: f64, count: u32, width: f64) -> bool {
    let cells = share * f64::from(count);
    let nearest = (cells + 0.5) as u64; // unlike `round`, no call
    count > 0 && (cells - nearest as f64).abs() <= 0.5 * width
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: [[f64; 2]; 2] = [[-1.0, 3.0], [0.0, 2.0]];
    const A: Rgb = [1.0, 0.0, 0.0];
    const B: Rgb = [0.0, 0.0, 1.0];

    fn at(texture: Texture, u: f64, v: f64) -> Rgb {
        Material { name: "m".into(), texture }.albedo(DVec2::new(u, v), || DOMAIN)
    }

    #[test]
    fn checker_cells_alternate_and_the_last_is_closed() {
        let checker = Texture::Checker { count: [4, 2], colors: [A, B] };
        assert_eq!(at(checker, -1.0, 0.0), A);
        assert_eq!(at(checker, 0.5, 0.5), B);
        assert_eq!(at(checker, 0.5, 1.5), A);
        assert_eq!(at(checker, 3.0, 0.0), B);
        assert_eq!(at(checker, 3.0, 2.0), A);
        assert_eq!(at(checker, 99.0, f64::NAN), B);
    }

    #[test]
    fn lines_lie_on_both_borders_and_between() {
        let lines = Texture::IsoLines { count: [4, 0], width: 0.2, line: A, base: B };
        for u in [-1.0, 0.0, 1.0, 2.0, 3.0, 0.0999, -0.0999] {
            assert_eq!(at(lines, u, 1.0), A, "u = {u}");
        }
        for u in [-0.5, 0.1001, 2.5] {
            assert_eq!(at(lines, u, 0.0), B, "u = {u}: no line across v");
        }
    }

    #[test]
    fn the_largest_albedo_is_found_in_every_texture() {
        let largest = |texture| Material { name: "m".into(), texture }.largest_albedo();
        assert_eq!(largest(Texture::Constant([0.1, 0.7, 0.3])), 0.7);
        assert_eq!(largest(Texture::Checker { count: [1, 1], colors: [A, [0.0, 0.0, 2.0]] }), 2.0);
        let lines = Texture::IsoLines { count: [1, 1], width: 0.1, line: [0.2; 3], base: [0.1; 3] };
        assert_eq!(largest(lines), 0.2);
    }

    #[test]
    fn what_is_no_colour_is_refused() {
        let lines = |width, base| Texture::IsoLines { count: [1, 1], width, line: A, base };
        assert_eq!(lines(1.0, B).check(), Ok(()));
        for (texture, expected) in [
            (lines(1.5, B), "width 1.5: a share of a cell, from 0 to 1, is needed"),
            (lines(f64::NAN, B), "width NaN: a share of a cell, from 0 to 1, is needed"),
            (
                lines(0.5, [0.0, -1.0, 0.0]),
                "color between lines (0, -1, 0): red, green and blue \
                 must be finite numbers from 0 to 3.4e38",
            ),
            (
                Texture::Checker { count: [1, 1], colors: [A, [0.0, 0.0, f64::INFINITY]] },
                "color (0, 0, inf): red, green and blue must be finite numbers from 0 to 3.4e38",
            ),
        ] {
            assert_eq!(texture.check().unwrap_err().to_string(), expected);
        }
    }

    #[test]
    fn constant_is_constant() {
        assert_eq!(at(Texture::Constant(A), f64::NAN, f64::INFINITY), A);
    }
}
