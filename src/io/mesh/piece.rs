//! A smooth piece of a surface, evaluated row by row, for tessellation.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use super::grid_mesh::MeshError;
use super::lattice::{Detail, Lattice};
use crate::geometry::trim::Trims;
use crate::geometry::{
    BasisDerivatives, Chart, ChartMap, Direction, KnotVector, MAX_DEGREE, NurbsSurface,
};

/// A part of a surface between creases: its first derivatives are continuous.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    surface: NurbsSurface,
    map: ChartMap,
    /// The weight of all control points of the chart, if it is the same.
    weight: Option<f64>,
    /// The trims of the chart, if it has any.
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
        let weight = (!surface.is_rational()).then(|| surface.control()[0].w);
        let (mut pieces, mut columns) = (Vec::new(), 0);
        for strip in cut(surface.into_owned(), Direction::U)? {
            let cut = cut(strip, Direction::V)?;
            columns = cut.len();
            let piece = |surface| Self { surface, map, weight, trims: trims.clone() };
            pieces.extend(cut.into_iter().map(piece));
        }
        Ok((pieces, columns))
    }

    pub(super) fn knots(&self, direction: Direction) -> &KnotVector {
        self.surface.knots(direction)
    }

    /// The row at a parameter u, given the basis functions there.
    pub(super) fn row(&self, u: &BasisDerivatives) -> Row {
        let columns = self.surface.size()[1];
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

    /// The place in space at a pair of parameters.
    pub(super) fn position(&self, uv: DVec2) -> DVec3 {
        self.positions(&[uv.x], &[uv.y])[0]
    }

    /// The normal at a pair of parameters, and what these are on the whole surface.
    pub(super) fn detail(&self, uv: DVec2) -> Detail {
        let normal = self.surface.normal(uv).unwrap_or(DVec3::NAN);
        Detail { normal, uv: self.map.uv(uv) }
    }

    /// The places in space at all pairs of parameters, row by row.
    ///
    /// The basis functions are evaluated once for each parameter, and each row is a curve with
    /// control points of its own: one vertex takes `q + 1` products of a number and a point.
    fn positions(&self, us: &[f64], vs: &[f64]) -> Vec<DVec3> {
        let [p, q] = Direction::BOTH.map(|direction| self.knots(direction).degree());
        let columns = self.surface.size()[1];
        let (mut starts, mut table) = (Vec::new(), Vec::new());
        let mut values = [0.0; MAX_DEGREE + 1];
        for &v in vs {
            starts.push(self.knots(Direction::V).basis(v, &mut values) - q);
            table.extend_from_slice(&values[..=q]);
        }
        let mut positions = Vec::with_capacity(us.len() * vs.len());
        let mut row = vec![DVec4::ZERO; columns];
        for &u in us {
            let first = self.knots(Direction::U).basis(u, &mut values) - p;
            row.fill(DVec4::ZERO);
            let lines = self.surface.control().chunks(columns).skip(first);
            for (line, &value) in lines.zip(&values[..=p]) {
                row.iter_mut().zip(line).for_each(|(sum, point)| *sum += value * point);
            }
            let vertices = starts.iter().zip(table.chunks_exact(q + 1));
            positions.extend(vertices.map(|(&start, values)| {
                let sum = match q {
                    1 => mixed::<2>(values, &row[start..]),
                    2 => mixed::<3>(values, &row[start..]),
                    3 => mixed::<4>(values, &row[start..]),
                    _ => sum(values, &row[start..]),
                };
                // Equal weights add up to themselves.
                match self.weight {
                    Some(1.0) => sum.xyz(),
                    Some(weight) => sum.xyz() / weight,
                    None => sum.xyz() / sum.w,
                }
            }));
        }
        positions
    }

    /// The vertices at all pairs of parameters, with their normals if those are asked for.
    pub(super) fn lattice(&self, us: Vec<f64>, vs: Vec<f64>, detailed: bool) -> Lattice {
        let positions = self.positions(&us, &vs);
        let details = if detailed { self.details(&us, &vs) } else { Vec::new() };
        Lattice { us, vs, positions, details }
    }

    /// Normals and parameters at all pairs of parameters, row by row.
    fn details(&self, us: &[f64], vs: &[f64]) -> Vec<Detail> {
        let basis_v: Vec<_> =
            vs.iter().map(|&v| self.knots(Direction::V).basis_derivatives(v)).collect();
        let mut details = Vec::with_capacity(us.len() * vs.len());
        for (i, &u) in us.iter().enumerate() {
            let row = self.row(&self.knots(Direction::U).basis_derivatives(u));
            for (j, (&v, basis)) in vs.iter().zip(&basis_v).enumerate() {
                let Tangents { du, dv, .. } = self.tangents(&row, basis);
                // Edges may be collapsed; the surface knows how to find a limit there.
                let border = i == 0 || j == 0 || i + 1 == us.len() || j + 1 == vs.len();
                let inner = if border { None } else { du.cross(dv).try_normalize() };
                let normal =
                    inner.or_else(|| self.surface.normal(DVec2::new(u, v))).unwrap_or(DVec3::NAN);
                details.push(Detail { normal, uv: self.map.uv(DVec2::new(u, v)) });
            }
        }
        details
    }
}

/// The sum of `N` points times their values.
#[inline(always)]
fn mixed<const N: usize>(values: &[f64], points: &[DVec4]) -> DVec4 {
    sum(&values[..N], &points[..N])
}

#[inline(always)]
fn sum(values: &[f64], points: &[DVec4]) -> DVec4 {
    values.iter().zip(points).fold(DVec4::ZERO, |sum, (&value, &point)| sum + value * point)
}

/// Cuts a surface at the creases of one direction.
fn cut(surface: NurbsSurface, direction: Direction) -> Result<Vec<NurbsSurface>, MeshError> {
    let knots = surface.knots(direction);
    let (degree, start) = (knots.degree(), knots.domain()[0]);
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
