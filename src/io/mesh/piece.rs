//! A smooth piece of a surface, evaluated row by row, for tessellation.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use super::grid_mesh::{MeshError, MeshPoint};
use crate::geometry::trim::Trims;
use crate::geometry::{BasisDerivatives, Chart, ChartMap, Direction, KnotVector, NurbsSurface};

/// A part of a surface between creases: its first derivatives are continuous.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    surface: NurbsSurface,
    map: ChartMap,
    /// The trims, if they do not keep all of the piece.
    pub(super) trims: Option<Arc<Trims>>,
}

/// A point and its first derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangents {
    pub(super) point: DVec3,
    pub(super) du: DVec3,
    pub(super) dv: DVec3,
}

/// The curve `v ↦ S(u, v)` and its derivative in u, as homogeneous control points.
#[derive(Clone, Debug)]
pub(super) struct Row {
    points: Vec<DVec4>,
    slopes: Vec<DVec4>,
}

impl Piece {
    /// The pieces of a chart, which is cut at every knot whose multiplicity is the degree or more:
    /// strips of equal u one after another, each from low v to high v. Also returns the number of
    /// pieces in a strip.
    ///
    /// Neighbours share the control points of their border, and so its vertices bit for bit where
    /// they are cut alike; but each has its own normals.
    ///
    /// # Errors
    /// When the surface cannot be cut there.
    pub(super) fn all(chart: Chart<'_>) -> Result<(Vec<Self>, usize), MeshError> {
        let Chart { surface, map, trims, .. } = chart;
        let (mut pieces, mut columns) = (Vec::new(), 0);
        for strip in cut(surface.into_owned(), Direction::U)? {
            let cut = cut(strip, Direction::V)?;
            columns = cut.len();
            let piece = |surface| Self { surface, map, trims: trims.clone() };
            pieces.extend(cut.into_iter().map(piece));
        }
        Ok((pieces, columns))
    }

    pub(super) fn knots(&self, direction: Direction) -> &KnotVector {
        self.surface.knots(direction)
    }

    /// The row at a parameter u, given the basis functions there.
    pub(super) fn row(&self, u: &BasisDerivatives) -> Row {
        let columns = self.surface.size().1;
        let p = self.knots(Direction::U).degree();
        let mut row =
            Row { points: vec![DVec4::ZERO; columns], slopes: vec![DVec4::ZERO; columns] };
        let lines = self.surface.control().chunks(columns).skip(u.span - p);
        for ((line, value), slope) in lines.zip(&u.orders[0][..=p]).zip(&u.orders[1]) {
            for (j, point) in line.iter().enumerate() {
                row.points[j] += value * point;
                row.slopes[j] += slope * point;
            }
        }
        row
    }

    /// Point and tangents where a row meets a parameter v (quotient rule).
    pub(super) fn tangents(&self, row: &Row, v: &BasisDerivatives) -> Tangents {
        let q = self.knots(Direction::V).degree();
        let [mut a, mut au, mut av] = [DVec4::ZERO; 3];
        for k in 0..=q {
            let j = v.span - q + k;
            a += v.orders[0][k] * row.points[j];
            au += v.orders[0][k] * row.slopes[j];
            av += v.orders[1][k] * row.points[j];
        }
        let point = a.xyz() / a.w;
        let du = (au.xyz() - au.w * point) / a.w;
        let dv = (av.xyz() - av.w * point) / a.w;
        Tangents { point, du, dv }
    }

    /// The point at a pair of parameters.
    pub(super) fn point(&self, uv: DVec2) -> MeshPoint {
        let at = self.surface.derivatives(uv.x, uv.y);
        let normal = at.du.cross(at.dv).try_normalize();
        let normal = normal.or_else(|| self.surface.normal(uv.x, uv.y)).unwrap_or(DVec3::NAN);
        MeshPoint { position: at.point, normal, uv: self.map.uv(uv) }
    }

    /// The vertices at all pairs of parameters, row by row.
    pub(super) fn lattice(&self, us: &[f64], vs: &[f64]) -> Vec<MeshPoint> {
        let basis_v: Vec<_> =
            vs.iter().map(|&v| self.knots(Direction::V).basis_derivatives(v)).collect();
        let mut points = Vec::with_capacity(us.len() * vs.len());
        for (i, &u) in us.iter().enumerate() {
            let row = self.row(&self.knots(Direction::U).basis_derivatives(u));
            for (j, (&v, basis)) in vs.iter().zip(&basis_v).enumerate() {
                let Tangents { point, du, dv } = self.tangents(&row, basis);
                // Edges may be collapsed; the surface knows how to find a limit there.
                let border = i == 0 || j == 0 || i + 1 == us.len() || j + 1 == vs.len();
                let inner = if border { None } else { du.cross(dv).try_normalize() };
                let normal = inner.or_else(|| self.surface.normal(u, v)).unwrap_or(DVec3::NAN);
                points.push(MeshPoint {
                    position: point,
                    normal,
                    uv: self.map.uv(DVec2::new(u, v)),
                });
            }
        }
        points
    }
}

/// Cuts a surface at the creases of one direction.
fn cut(surface: NurbsSurface, direction: Direction) -> Result<Vec<NurbsSurface>, MeshError> {
    let knots = surface.knots(direction);
    let (degree, start) = (knots.degree(), knots.domain().0);
    let creases: Vec<f64> = knots
        .spans()
        .map(|span| span.start)
        .filter(|&t| t > start && knots.multiplicity(t) >= degree)
        .collect();
    let (mut pieces, mut rest) = (Vec::new(), surface);
    for crease in creases {
        let (before, after) = rest.split(direction, crease)?;
        pieces.push(before);
        rest = after;
    }
    pieces.push(rest);
    Ok(pieces)
}
