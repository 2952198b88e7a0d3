//! Control polygons and control nets as things to see.

use std::collections::HashSet;

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::ConstructError;
use super::error::check_net;
use super::tube::{Caps, Piece, TubeStyle, ball, tube};
use crate::geometry::{NurbsCurve, NurbsSurface};

/// How thick a net is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetStyle {
    /// The radius of the lines between control points.
    pub radius: f64,
    /// The radius of the balls at the control points; larger than that of the lines, or the
    /// two touch along a circle.
    pub joints: f64,
}

/// The control net of a surface: a cylinder for each pair of neighbours along u and v, a ball
/// for each control point. Points that coincide, as at poles and seams, are drawn once.
///
/// # Errors
/// When a radius is not a positive length.
pub fn control_net(surface: &NurbsSurface, style: &NetStyle) -> Result<Vec<Piece>, ConstructError> {
    let (nu, nv) = surface.size();
    check_net(nu, nv, MAX_DRAWN)?;
    let mut drawing = Drawing::new(surface.control(), *style);
    for i in 0..nu {
        for j in 0..nv {
            let here = surface.point(i, j);
            if i + 1 < nu {
                drawing.line(here, surface.point(i + 1, j))?;
            }
            if j + 1 < nv {
                drawing.line(here, surface.point(i, j + 1))?;
            }
            drawing.point(here)?;
        }
    }
    Ok(drawing.pieces)
}

/// The control polygon of a curve, as [`control_net`].
///
/// # Errors
/// When a radius is not a positive length.
pub fn control_polygon(curve: &NurbsCurve, style: &NetStyle) -> Result<Vec<Piece>, ConstructError> {
    let mut drawing = Drawing::new(curve.control(), *style);
    let count = curve.control().len();
    check_net(count, 1, MAX_DRAWN)?;
    for i in 0..count {
        drawing.point(curve.point(i))?;
        if i + 1 < count {
            drawing.line(curve.point(i), curve.point(i + 1))?;
        }
    }
    Ok(drawing.pieces)
}

/// The most control points of a net that is drawn: each becomes a ball of 45 control points
/// and two lines of 18, hundreds of leaves in all; more of them than this cannot be told apart.
const MAX_DRAWN: usize = 1 << 16;

/// A point on a grid so fine that only points that are the same but for rounding share a place.
type Place = [i64; 3];

/// The grid's width as a share of the largest coordinate: thousands of roundings.
const GRID: f64 = 1e-12;

struct Drawing {
    style: NetStyle,
    cell: f64,
    points: HashSet<Place>,
    lines: HashSet<[Place; 2]>,
    pieces: Vec<Piece>,
}

impl Drawing {
    fn new(control: &[DVec4], style: NetStyle) -> Self {
        let largest = |point: &DVec4| (point.xyz() / point.w).abs().max_element();
        let magnitude = control.iter().map(largest).fold(f64::MIN_POSITIVE, f64::max);
        let (points, lines) = (HashSet::new(), HashSet::new());
        Self { style, cell: GRID * magnitude, points, lines, pieces: Vec::new() }
    }

    /// Halfway off the grid's lines, where round numbers lie.
    fn place(&self, point: DVec3) -> Place {
        (point / self.cell + DVec3::splat(0.3)).floor().to_array().map(|x| x as i64)
    }

    fn point(&mut self, at: DVec3) -> Result<(), ConstructError> {
        if self.points.insert(self.place(at)) {
            self.pieces.push(Piece { what: "point", ..ball(at, self.style.joints)? });
        }
        Ok(())
    }

    fn line(&mut self, a: DVec3, b: DVec3) -> Result<(), ConstructError> {
        let mut ends = [self.place(a), self.place(b)];
        ends.sort_unstable();
        if ends[0] == ends[1] || !self.lines.insert(ends) {
            return Ok(());
        }
        let line = NurbsCurve::polyline(&[a, b]).map_err(ConstructError::of("line"))?;
        let style = TubeStyle { radius: self.style.radius, caps: Caps::Open, tolerance: None };
        let tubes = tube(&line, &style)?;
        self.pieces.extend(tubes.into_iter().map(|piece| Piece { what: "line", ..piece }));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{KnotVector, shapes};

    fn counts(pieces: &[Piece]) -> [usize; 2] {
        ["line", "point"].map(|what| pieces.iter().filter(|p| p.what == what).count())
    }

    #[test]
    fn poles_and_seams_are_drawn_once() {
        for size in [1e-8, 1.0, 1e8] {
            let style = NetStyle { radius: 0.02 * size, joints: 0.05 * size };
            let hemisphere = shapes::hemisphere(size).unwrap();
            // Two poles, 8 points; rows of 3 lines twice, columns of 3 lines four times.
            assert_eq!(counts(&control_net(&hemisphere, &style).unwrap()), [6 + 12, 10]);
            // The sphere's net closes: 6 columns, of which one begins and ends the rows.
            let sphere = shapes::sphere(size).unwrap();
            assert_eq!(counts(&control_net(&sphere, &style).unwrap()), [12 + 18, 14]);
        }
        let polygon =
            control_polygon(&shapes::circle_cubic(), &NetStyle { radius: 0.1, joints: 0.2 });
        assert_eq!(counts(&polygon.unwrap()), [6, 6]);
    }

    #[test]
    fn radii_must_be_lengths() {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let message = |radius, joints| {
            control_net(&plane, &NetStyle { radius, joints }).unwrap_err().to_string()
        };
        assert_eq!(message(-1.0, 1.0), "tube: radius -1: it must be positive and finite");
        let knots = KnotVector::uniform(1, 300).unwrap();
        let points = (0..90_000).map(|k| DVec3::new(f64::from(k % 300), f64::from(k / 300), 0.0));
        let large = NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap();
        assert_eq!(
            control_net(&large, &NetStyle { radius: 0.1, joints: 0.2 }).unwrap_err().to_string(),
            "300 × 300 control points: at most 65536 in all are supported"
        );
        assert_eq!(message(1.0, 0.0), "joint radius 0: it must be positive and finite");
    }
}
