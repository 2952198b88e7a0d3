//! Trim edges: where they run over a surface, and the same as curves in space, exactly.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use super::trim_edge::Piece;
use super::{TrimEdge, TrimmedSurface};
use crate::geometry::knots::MAX_DEGREE;
use crate::geometry::trim::EdgePiece;
use crate::geometry::{
    CurveError, Direction, KnotError, KnotVector, NurbsCurve, NurbsSurface, SurfaceError,
};
use crate::math::bernstein::binomial;

/// Two pieces of an edge are joined if their ends agree to this many roundings of the surface's
/// largest coordinate: a surface with a knot of full multiplicity may jump. An edge no longer than
/// that is a point.
const JOINT: f64 = 256.0;

impl TrimmedSurface {
    /// The trim edges, `S(c(t))` for the trim curves `c`. Each loop gives its part in the closed
    /// domain, in the loop's direction: one edge, or several where the domain cuts the loop or the
    /// surface jumps. Edges that are points, as along a pole, are left out: all that is within 256
    /// roundings of the surface's largest coordinate of where it begins.
    pub fn edges(&self) -> Vec<TrimEdge> {
        let cells = Cells::new(self.surface());
        let cuts = cells.lines.each_ref().map(Vec::as_slice);
        let mut edges = Vec::new();
        for chain in self.trims().edge_chains(cuts) {
            let mut parts: Vec<Vec<Piece>> = Vec::new();
            for piece in chain {
                let piece = cells.cell_of(piece);
                match parts.last_mut() {
                    Some(part) if cells.joins(&part[part.len() - 1], &piece) => part.push(piece),
                    _ => parts.push(vec![piece]),
                }
            }
            let parts = parts.into_iter().filter(|part| !cells.is_point(part));
            edges.extend(parts.map(|part| TrimEdge::new(Arc::clone(&cells.surface), part)));
        }
        edges
    }

    /// The [trim edges](Self::edges) as NURBS curves in space.
    ///
    /// # Errors
    /// As [`TrimEdge::curve`].
    pub fn edge_curves(&self) -> Result<Vec<NurbsCurve>, CurveError> {
        self.edges().iter().map(TrimEdge::curve).collect()
    }

    /// The kept stretches of the [curve](NurbsSurface::curve_at) on which one parameter is `at`,
    /// each on its own part of the domain.
    ///
    /// # Errors
    /// When the parameter is off the domain.
    pub fn kept_curves(&self, fixed: Direction, at: f64) -> Result<Vec<NurbsCurve>, SurfaceError> {
        let whole = self.surface().curve_at(fixed, at)?;
        let kept = self.trims().kept_along(fixed, at).into_iter();
        Ok(kept.map(|range| whole.restricted(range)).collect())
    }
}

/// A surface as Bézier pieces: the cells that edges run through.
struct Cells {
    surface: Arc<NurbsSurface>,
    /// The parameters at which pieces end, in u and in v.
    lines: [Vec<f64>; 2],
    /// The largest coordinate of the surface's control points. Errors of points are relative to it,
    /// even where an edge passes the origin of space.
    largest: f64,
}

impl Cells {
    fn new(surface: &NurbsSurface) -> Self {
        let surface = surface.bezier_form();
        let lines = [surface.knots_u(), surface.knots_v()].map(|knots| {
            let [_, end] = knots.domain();
            knots.spans().map(|span| span.start).chain([end]).collect()
        });
        let largest = |point: DVec3| point.abs().max_element();
        let points = surface.control().iter().map(|c| largest(c.xyz() / c.w));
        let largest = points.fold(0.0, f64::max);
        Self { surface: Arc::new(surface), lines, largest }
    }

    /// A piece of an edge, with the Bézier piece that it lies in.
    fn cell_of(&self, piece: EdgePiece) -> Piece {
        let middle = piece.middle();
        let span = |knots: &KnotVector, t: f64| {
            let index = knots.span_index(t);
            (index - knots.degree(), [knots.values()[index], knots.values()[index + 1]])
        };
        let (i, [u0, u1]) = span(self.surface.knots_u(), middle.x);
        let (j, [v0, v1]) = span(self.surface.knots_v(), middle.y);
        let local = piece.within(DVec2::new(u0, v0), DVec2::new(u1, v1));
        Piece { control: piece.control, local, first: [i, j] }
    }

    /// Whether a piece of an edge begins where another one ends.
    fn joins(&self, before: &Piece, next: &Piece) -> bool {
        let [end, _] = before.at(&self.surface, 1.0);
        let [start, _] = next.at(&self.surface, 0.0);
        self.are_one(end, start)
    }

    /// Whether all of an edge is one point. A piece of degree n that has the same point at n + 1
    /// places has it everywhere; where these are Chebyshev's, points that differ by little there
    /// differ by no more than some times that elsewhere.
    fn is_point(&self, pieces: &[Piece]) -> bool {
        let [start, _] = pieces[0].at(&self.surface, 0.0);
        pieces.iter().all(|piece| {
            let degree = piece.degree(&self.surface);
            let turn = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / (degree + 1) as f64;
            let mut shares = (0..=degree).map(|k| 0.5 - 0.5 * turn(k).cos());
            shares.all(|share| self.are_one(start, piece.at(&self.surface, share)[0]))
        })
    }

    fn are_one(&self, a: DVec3, b: DVec3) -> bool {
        a.distance(b) <= JOINT * f64::EPSILON * self.largest
    }
}

impl TrimEdge {
    /// The edge as a curve in space, with the same parameter.
    ///
    /// It is exact except for rounding: a rational Bézier curve of degree d within a piece of the
    /// surface of degrees p and q is one of degree (p + q) d in space (DeRose, Goldman, Hagen &
    /// Mann, "Functional composition algorithms via blossoming", 1993; here by products of
    /// Bernstein polynomials).
    ///
    /// # Errors
    /// When that degree exceeds [`MAX_DEGREE`], or a weight or point is beyond the range of f64.
    pub fn curve(&self) -> Result<NurbsCurve, CurveError> {
        let degree = self.pieces()[0].degree(self.form()); // that of all
        if degree > MAX_DEGREE {
            return Err(KnotError::Degree { degree }.into());
        }
        let mut control = Vec::new();
        let mut knots = vec![0.0];
        for (k, piece) in self.pieces().iter().enumerate() {
            append(&mut control, lifted(piece, self.form()));
            knots.extend(vec![k as f64; degree]);
        }
        let [_, end] = self.domain();
        knots.extend(vec![end; degree + 1]);
        NurbsCurve::from_homogeneous(KnotVector::new(degree, knots)?, control)
    }
}

/// The homogeneous control points in space of an edge's piece.
fn lifted(piece: &Piece, form: &NurbsSurface) -> Vec<DVec4> {
    let (degree, [p, q]) = (piece.degree(form), form.degree());
    // Σ Σ C(p, a) C(q, b) Xᵃ (W − X)ᵖ⁻ᵃ Yᵇ (W − Y)^(q−b) P_ab with x = X / W and y = Y / W. The
    // Bernstein coefficients of each factor include their binomials: products are convolutions.
    let scaled = |of: fn(DVec3) -> f64| -> Vec<f64> {
        let n = piece.local.len() - 1;
        piece.local.iter().enumerate().map(|(k, &c)| binomial(n, k) * of(c)).collect()
    };
    let along_u = blends(&scaled(|c| c.x), &scaled(|c| c.z - c.x), p);
    let along_v = blends(&scaled(|c| c.y), &scaled(|c| c.z - c.y), q);
    let [i, j] = piece.first;
    let mut sum = vec![DVec4::ZERO; degree + 1];
    for (a, blend_u) in along_u.iter().enumerate() {
        for (b, blend_v) in along_v.iter().enumerate() {
            let point = form.homogeneous(i + a, j + b);
            for (sum, factor) in sum.iter_mut().zip(product(blend_u, blend_v)) {
                *sum += factor * point;
            }
        }
    }
    sum.into_iter().enumerate().map(|(k, c)| c / binomial(degree, k)).collect()
}

/// `C(p, a) Xᵃ Zᵖ⁻ᵃ` for a = 0 … p.
fn blends(x: &[f64], z: &[f64], p: usize) -> Vec<Vec<f64>> {
    let powers = |of: &[f64]| {
        let mut powers = vec![vec![1.0]];
        for k in 0..p {
            powers.push(product(&powers[k], of));
        }
        powers
    };
    let (x, z) = (powers(x), powers(z));
    let blend = |a: usize| {
        let factor = binomial(p, a);
        product(&x[a], &z[p - a]).into_iter().map(|value| factor * value).collect()
    };
    (0..=p).map(blend).collect()
}

/// The product of two polynomials whose Bernstein coefficients include their binomials.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// Appends a piece to a curve, which keeps its own last point; the piece's weights are scaled to
/// fit.
fn append(curve: &mut Vec<DVec4>, piece: Vec<DVec4>) {
    let Some(last) = curve.last() else {
        curve.extend(piece);
        return;
    };
    let scale = last.w / piece[0].w;
    curve.extend(piece.into_iter().skip(1).map(|point| scale * point));
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::Vec3Swizzles;

    use super::*;
    use crate::geometry::shapes;
    use crate::geometry::trim::{Kept, TrimCurve, TrimDomain, TrimLoop, Trims};

    fn trimmed(surface: NurbsSurface, loops: &[TrimLoop]) -> TrimmedSurface {
        let domain = TrimDomain::with_seams_of(&surface).unwrap();
        TrimmedSurface::new(surface, Trims::new(domain, Kept::Even, loops).unwrap()).unwrap()
    }

    fn samples(curve: &NurbsCurve) -> Vec<DVec3> {
        let [start, end] = curve.domain();
        (0..=200).map(|k| curve.point_at(start + f64::from(k) / 200.0 * (end - start))).collect()
    }

    /// The graph z = x² y over [0, 3] × [0, 2] with knots at (1, 2) in u and 1 in v.
    fn graph() -> NurbsSurface {
        let (x, z) = ([0.0, 1.5, 3.0], [0.0, 0.0, 9.0]);
        let point = |k: usize| {
            let y = 2.0 * (k % 2) as f64;
            DVec3::new(x[k / 2], y, z[k / 2] * y)
        };
        let points: Vec<DVec3> = (0..6).map(point).collect();
        let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 3.0, 3.0, 3.0]).unwrap();
        let v = KnotVector::new(1, vec![0.0, 0.0, 2.0, 2.0]).unwrap();
        let surface = NurbsSurface::new(u, v, points, None).unwrap();
        let surface = surface.insert_knot_u(1.0, 1).unwrap().insert_knot_u(2.0, 2).unwrap();
        surface.insert_knot_v(1.0, 1).unwrap()
    }

    #[test]
    fn edges_lie_on_a_graph_over_their_curves() {
        let (center, radius) = (DVec2::new(1.4, 0.95), 0.7);
        let circle = TrimLoop::circle(center, radius).unwrap();
        let edges = trimmed(graph(), &[circle]).edge_curves().unwrap();
        assert_eq!(edges.len(), 1);
        assert_eq!(edges[0].knots().degree(), 6);
        let (mut length, points) = (0.0, samples(&edges[0]));
        for point in &points {
            assert!((point.xy().distance(center) - radius).abs() < 1e-14, "{point}");
            assert!((point.z - point.x * point.x * point.y).abs() < 2e-14, "{point}");
        }
        for pair in points.windows(2) {
            length += pair[0].xy().distance(pair[1].xy());
        }
        assert!((length / (TAU * radius) - 1.0).abs() < 1e-3, "{length}");
        assert!(points[0].distance(points[200]) < 1e-14);
    }

    /// A band around a cylinder, cut open at the seam or elsewhere, has two edges; a band that
    /// reaches only part of the way around has its ends as edges, too.
    #[test]
    fn what_has_the_same_on_both_sides_is_no_edge() {
        let cylinder = shapes::cylinder(2.0, 3.0).unwrap();
        let [[u0, u1], [v0, v1]] = cylinder.domain();
        for shift in [0.0, 0.25, -0.5, 3.0] {
            let low = u0 + shift * (u1 - u0);
            let at = |u: f64, v: f64| DVec2::new(low + u * (u1 - u0), v0 + v * (v1 - v0));
            let band = [at(0.0, 0.25), at(1.0, 0.25), at(1.0, 0.75), at(0.0, 0.75)];
            let edges = trimmed(cylinder.clone(), &[TrimLoop::polygon(&band).unwrap()]);
            let edges = edges.edge_curves().unwrap();
            // Two, or four halves where the domain cuts the loop and its copy at the seam.
            let is_cut = shift.fract() != 0.0;
            assert_eq!(edges.len(), if is_cut { 4 } else { 2 }, "{shift}");
            for edge in edges {
                let [start, end] = edge.domain();
                let heights =
                    [0.0, 0.3, 0.8, 1.0].map(|t| edge.point_at(start + t * (end - start)).z);
                let flat = heights.iter().all(|z| (z - heights[0]).abs() < 1e-14);
                assert!(flat, "{shift}: along the seam, {heights:?}");
                assert!([0.75, 2.25].iter().any(|z| (z - heights[0]).abs() < 1e-14), "{heights:?}");
            }
            let part = band.map(|uv| DVec2::new(low + 0.9 * (uv.x - low), uv.y));
            let edges = trimmed(cylinder.clone(), &[TrimLoop::polygon(&part).unwrap()]);
            let edges = edges.edge_curves().unwrap();
            // The seam, if it runs through the part, cuts its edge in two.
            assert_eq!(edges.len(), if is_cut { 2 } else { 1 }, "{shift}");
            let steep = edges.into_iter().any(|edge| {
                let [start, end] = edge.domain();
                let middle = edge.point_at(0.5 * (start + end)).z;
                (0..=100).any(|k| {
                    let z = edge.point_at(start + f64::from(k) / 100.0 * (end - start)).z;
                    (z - 1.5).abs() < 0.5 || (middle - 1.5).abs() < 0.5
                })
            });
            assert!(steep, "{shift}: its ends are edges");
        }
    }

    /// CAD files have knots of trim curves a rounding error beside those of the surface.
    #[test]
    fn edges_are_not_cut_into_slivers_at_knots() {
        for [du, dv] in [[0, 0], [1, 1], [-1, 1], [3, -3], [-5, 5]] {
            let beside = |knot: f64, roundings: i32| knot + f64::from(roundings) * f64::EPSILON;
            let [u, v] = [beside(1.0, du), beside(1.0, dv)];
            // Two sides along u = 0.5 and about along u = 1, both cut at v = 1, between two others.
            let corners = [[0.5, 0.5], [u, 0.5], [beside(1.0, -du), 1.5], [0.5, 1.5]];
            let tall = TrimLoop::polygon(&corners.map(DVec2::from)).unwrap();
            // From corner to corner within one piece of the surface.
            let corners = [[0.25, v], [u, beside(1.0, -dv)], [u, 1.75], [0.25, 1.75]];
            let flat = TrimLoop::polygon(&corners.map(DVec2::from)).unwrap();
            for (outline, expected) in [(tall, 6), (flat, 4)] {
                let edges = trimmed(graph(), &[outline]).edge_curves().unwrap();
                assert_eq!(edges.len(), 1);
                assert_eq!(edges[0].knots().spans().count(), expected, "{du}, {dv}");
                for point in samples(&edges[0]) {
                    let off = point.z - point.x * point.x * point.y;
                    assert!(off.abs() < 2e-14, "{du}, {dv}: {point}");
                }
            }
        }
    }

    /// Near the origin, points are still as inexact as the surface's largest coordinates.
    #[test]
    fn an_edge_through_the_origin_is_one() {
        for k in 0..200 {
            // A slanted sheet with a knot at u = 0.5. The circle passes this line near the origin.
            let slope = 0.1 + 0.013 * f64::from(k);
            let at = |x: f64, y: f64| DVec3::new(x, y, slope * (x + 0.25 * y));
            let high = 1.0 + 0.003 * f64::from(k);
            let net = [-0.96, -0.24, 0.24, 0.96].map(|x| [at(x, -1.1), at(x, high)]);
            let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]).unwrap();
            let v = KnotVector::bezier(1).unwrap();
            let sheet = NurbsSurface::new(u, v, net.concat(), None).unwrap();
            let origin = DVec2::new(0.5, 1.1 / (1.1 + high));
            let radius = 0.1 + 0.001 * f64::from(k);
            let toward = DVec2::from_angle(0.3 + 0.01 * f64::from(k));
            let circle = TrimLoop::circle(origin + radius * toward, radius).unwrap();
            assert_eq!(trimmed(sheet, &[circle]).edge_curves().unwrap().len(), 1, "{k}");
        }
    }

    /// Such sides cut nothing, though they are off by rounding; as far as they reach, the border
    /// is kept.
    #[test]
    fn sides_along_the_border_are_no_edges() {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let domain = TrimDomain::of(&plane).unwrap();
        for off in [0.0, 1e-18, 2e-16, 8e-16] {
            for [du, dv] in [[off, off], [-off, off], [-off, -off]] {
                let corners = [[du, dv], [0.75, dv], [du, 0.5]].map(DVec2::from);
                let outline = TrimLoop::polygon(&corners).unwrap();
                let trims = Trims::new(domain, Kept::Odd, &[outline]).unwrap();
                let part = TrimmedSurface::new(plane.clone(), trims).unwrap();
                let edges = part.edge_curves().unwrap();
                assert_eq!(edges.len(), 1, "{du}, {dv}");
                let (ends, from_to) = (edges[0].ends(), [[0.75, 0.0], [0.0, 0.5]]);
                for (end, [u, v]) in ends.into_iter().zip(from_to) {
                    assert!(
                        end.distance(plane.point_at(DVec2::new(u, v))) < 2e-15,
                        "{du}, {dv}: {end}"
                    );
                }
                let kept = |direction, at| part.trims().kept_along(direction, at);
                for (direction, end) in [(Direction::U, 0.5), (Direction::V, 0.75)] {
                    let found = kept(direction, 0.0);
                    let is_so = matches!(found[..], [[0.0, to]] if (to - end).abs() < 2e-15);
                    assert!(is_so, "{du}, {dv}: {found:?}");
                }
                assert!(kept(Direction::U, 1.0).is_empty() && kept(Direction::V, 1.0).is_empty());
            }
        }
    }

    #[test]
    fn loops_end_at_the_domain_s_border_and_cross_seams() {
        // Half a circle is off the graph: one arc, from border to border.
        let circle = TrimLoop::circle(DVec2::new(0.0, 1.0), 0.5).unwrap();
        let edges = trimmed(graph(), &[circle]).edge_curves().unwrap();
        assert_eq!(edges.len(), 1);
        for end in edges[0].ends() {
            assert!(end.x.abs() < 1e-15 && ((end.y - 1.0).abs() - 0.5).abs() < 1e-14, "{end}");
        }
        assert!(samples(&edges[0]).iter().all(|point| point.x >= -1e-15));

        // A hole across the seam of a cylinder: the loop comes twice, and each copy is cut once.
        let cylinder = shapes::cylinder(2.0, 3.0).unwrap();
        let [[u0, u1], [v0, v1]] = cylinder.domain();
        let center = DVec2::new(u0, 0.5 * (v0 + v1));
        let hole = TrimLoop::circle(center, 0.1 * (u1 - u0)).unwrap();
        let edges = trimmed(cylinder, &[hole]).edge_curves().unwrap();
        assert_eq!(edges.len(), 2);
        for point in edges.iter().flat_map(samples) {
            assert!((point.xy().length() - 2.0).abs() < 4e-15, "{point}");
        }
        // Both end on the seam, each where the other begins.
        let [a, b] = [edges[0].ends(), edges[1].ends()];
        assert!(a[0].distance(b[1]) < 1e-14 && a[1].distance(b[0]) < 1e-14, "{a:?}, {b:?}");
    }

    #[test]
    fn rational_surfaces_and_mixed_loops() {
        // Lines and a cubic on a sphere of two rational bicubic pieces: S at the curve's points.
        let sphere = shapes::sphere(1.0).unwrap();
        let cubic = [[0.1, 0.3], [0.1, 0.9], [0.8, 0.9], [0.8, 0.3]].map(DVec2::from);
        let curves = [
            TrimCurve::bezier(&cubic, None).unwrap(),
            TrimCurve::line(cubic[3], cubic[0]).unwrap(),
        ];
        let edges = trimmed(sphere.clone(), &[TrimLoop::new(&curves).unwrap()]);
        let edges = edges.edge_curves().unwrap();
        assert_eq!((edges.len(), edges[0].knots().degree()), (1, 18));
        let on_edge = samples(&edges[0]);
        for point in &on_edge {
            assert!((point.length() - 1.0).abs() < 1e-13, "{point}");
        }
        // Dense points of the loop, each near one of the edge's, and the middle of the line.
        let middle = sphere.point_at(DVec2::new(0.45, 0.3));
        let near = |at: DVec3| on_edge.iter().map(|p| p.distance(at)).fold(f64::INFINITY, f64::min);
        assert!(near(middle) < 0.02, "{}", near(middle));
        for k in 0..=50 {
            let t = f64::from(k) / 50.0;
            let points = crate::geometry::bernstein(3, t).unwrap();
            let at: DVec2 = cubic.iter().zip(points).map(|(p, b)| b * *p).sum();
            assert!(near(sphere.point_at(at)) < 0.03, "{at}");
        }

        // (5 + 5) · 4 is too much for a NURBS curve, not for an edge.
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let high = plane.elevated_u(4).unwrap().elevated_v(4).unwrap();
        let quartic = [[0.2, 0.2], [0.2, 0.9], [0.5, 0.9], [0.8, 0.9], [0.8, 0.2]].map(DVec2::from);
        let curves = [
            TrimCurve::bezier(&quartic, None).unwrap(),
            TrimCurve::line(quartic[4], quartic[0]).unwrap(),
        ];
        let edges = trimmed(high, &[TrimLoop::new(&curves).unwrap()]).edges();
        assert_eq!(edges.len(), 1);
        let error = edges[0].curve().unwrap_err();
        assert_eq!(error.to_string(), "degree 40: degrees from 1 to 32 are supported");
        for t in [0.0, 0.3, 0.999, 1.0, 1.7, 2.0] {
            let [uv, _] = edges[0].uv_at(t);
            assert!(edges[0].point_at(t).distance(plane.point_at(uv)) < 2e-15, "{t}");
        }
    }

    #[test]
    fn lines_of_constant_parameter_end_at_trims() {
        let circle = TrimLoop::circle(DVec2::new(1.5, 1.0), 0.5).unwrap();
        let island = TrimLoop::circle(DVec2::new(1.5, 1.0), 0.25).unwrap();
        let sheet = trimmed(graph(), &[circle, island]);
        let kept = |direction, at: f64| sheet.trims().kept_along(direction, at);
        let close = |found: Vec<[f64; 2]>, expected: &[[f64; 2]]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((a - b).abs() < 1e-15, "{found:?} for {expected:?}");
            }
        };
        close(kept(Direction::U, 1.5), &[[0.0, 0.5], [0.75, 1.25], [1.5, 2.0]]);
        close(kept(Direction::V, 1.0), &[[0.0, 1.0], [1.25, 1.75], [2.0, 3.0]]);
        close(kept(Direction::U, 1.1), &[[0.0, 0.7], [1.3, 2.0]]);
        close(kept(Direction::U, 0.5), &[[0.0, 2.0]]);
        close(kept(Direction::V, 0.5), &[[0.0, 3.0]]); // it touches the circle
        assert!(kept(Direction::U, 3.5).is_empty() && kept(Direction::V, f64::NAN).is_empty());

        let curves = sheet.kept_curves(Direction::U, 1.5).unwrap();
        assert_eq!(curves.len(), 3);
        let [from, to] = curves[1].ends();
        assert!(from.distance(DVec3::new(1.5, 0.75, 2.25 * 0.75)) < 1e-14, "{from}");
        assert!(to.distance(DVec3::new(1.5, 1.25, 2.25 * 1.25)) < 1e-14, "{to}");

        // Along edges, the kept part is closed; beyond them nothing is kept.
        let square = [[1.0, 0.5], [2.0, 0.5], [2.0, 1.5], [1.0, 1.5]].map(DVec2::from);
        let domain = TrimDomain::of(&graph()).unwrap();
        let trims = Trims::new(domain, Kept::Odd, &[TrimLoop::polygon(&square).unwrap()]).unwrap();
        assert_eq!(trims.kept_along(Direction::U, 1.0), [[0.5, 1.5]]);
        assert_eq!(trims.kept_along(Direction::V, 1.5), [[1.0, 2.0]]);
        assert!(trims.kept_along(Direction::V, 1.6).is_empty());
    }
}
