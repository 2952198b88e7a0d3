//! Pieces in power form about their middle: `Σ Bᵢ(s) Bⱼ(t) Pᵢⱼ = Σ cᵢⱼ xⁱ yʲ`, `x = 2 s − 1`,
//! `y = 2 t − 1`.
//!
//! Horner's scheme takes half the operations of sums of Bernstein functions. It loses few digits
//! for low degrees, because powers are taken about the middle of a piece and no farther from it
//! than one: the rounding error of the sums is a few units of `Σ |cᵢⱼ| |x|ⁱ |y|ʲ`, over the weight
//! there (Farouki and Rajan 1987, "On the numerical condition of polynomials in Bernstein form").
//! Where that is many times the coordinates of the piece, as on zigzag nets, which reach 8 times in
//! degree three and more than 100 times in degree seven, or where weights differ much, sums stay in
//! Bernstein form, whose terms are never larger than their sum may be.
//!
//! The coefficients are made of differences of points from one in the middle, as far from both ends
//! as can be: so they are zero where points are equal. The first or last of the spline control
//! points that govern a piece may be far larger than anything on the piece, because its share there
//! is small (`1 / p!` where knots are evenly spaced); the rounding error of differences from such a
//! point would exceed the promised error bound.

use std::ops::{Add, Mul, Sub};

use glam::{DVec3, DVec4};
use smallvec::SmallVec;

use crate::geometry::{Extraction, Extractions, KnotVector};
use crate::math::bernstein::binomials;
use crate::math::rounding::UNIT_ROUNDOFF;
use crate::patch::BezierNet;

/// The highest degree that is written in power form. Few pieces of higher degree would be well
/// conditioned, and eight of their nets are not held side by side.
pub(crate) const MOST_DEGREE: usize = 7;

const _: () =
    assert!(Extractions::MOST_DEGREE <= MOST_DEGREE, "nets of splines are made by powers");

/// The largest sum of the sizes of a piece's terms, those of the weight included, in units of its
/// coordinates. One bound for the whole piece is tried first; only if it fails are the terms
/// checked at 25 places: an estimate of how many digits are lost, not a proof.
const MOST_CONDITION: f64 = 8.0;

/// The largest ratio of two weights of a gentle spline.
const GENTLE_WEIGHTS: f64 = 2.0;

/// The largest ratio of two knot spans of a gentle spline: beyond it, a control point may have so
/// small a share in a piece that differences from it are all rounding error.
const MOST_UNEVEN: f64 = 4.0;

/// Whether pieces of these degrees can be written in power form.
pub(super) fn suit([p, q]: [usize; 2]) -> bool {
    p.max(q) <= MOST_DEGREE
}

/// The fraction of the promised error bound by which a power net made from a spline's control
/// points may move points.
const MOST_OFF: f64 = 0.5;

/// Coefficients that are left out change each coordinate, and either derivative of it, by no more
/// than this part of its largest value. In bicubic nets that had been elevated once or twice they
/// were seen to reach 22 unit roundoffs; what is allowed is less, for the sake of normals.
const MOST_LEFT_OUT: f64 = 16.0 * UNIT_ROUNDOFF;

/// Pieces are checked where `x` and `y` are any of these.
const PLACES: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// The largest second difference of three neighbouring control points of a gentle spline, as a part
/// of their largest coordinate: beyond it, they may be far larger than the points of the surface.
const MOST_ZIGZAG: f64 = 0.5;

/// Whether the knot spans and the weights of a spline differ so little, and its control points
/// zigzag so little, that [`is_made_well`] need not be called: it holds for all pieces of such
/// splines that a test has made.
pub(super) fn are_gentle(knots: [&KnotVector; 2], control: &[DVec4]) -> bool {
    let range = |(least, most): (f64, f64), value: f64| (least.min(value), most.max(value));
    let none = (f64::INFINITY, 0f64);
    let are_even = |knots: &KnotVector| {
        let (shortest, longest) = knots.spans().map(|span| span.end - span.start).fold(none, range);
        longest <= MOST_UNEVEN * shortest
    };
    let (least, most) = control.iter().map(|point| point.w).fold(none, range);
    let columns = knots[1].point_count();
    let point = |k: usize| control[k].truncate() / control[k].w;
    let is_smooth = |k: usize, step: usize| {
        let [before, here, after] = [point(k), point(k + step), point(k + 2 * step)];
        let largest = before.abs().max(here.abs()).max(after.abs()).max_element();
        (before - 2.0 * here + after).abs().max_element() <= MOST_ZIGZAG * largest
    };
    let along_rows = |k: usize| k % columns + 2 >= columns || is_smooth(k, 1);
    let along_columns = |k: usize| k + 2 * columns >= control.len() || is_smooth(k, columns);
    knots.into_iter().all(are_even)
        && most <= GENTLE_WEIGHTS * least
        && (0..control.len()).all(|k| along_rows(k) && along_columns(k))
}

/// Whether all pieces of a gentle spline are assumed to be well conditioned: for degree three or
/// less, checking them takes a tenth to a sixth of the time to build them. Such splines are dense,
/// and most of their knots are simple: their nets zigzag less than their control points.
pub(super) fn suit_all(degree: [usize; 2]) -> bool {
    degree.into_iter().all(|degree| degree <= 3)
}

/// Whether the power net [made](ToPowers) from the control points that govern a piece equals, to
/// rounding, that of its Bézier points. The error bound of points is `factor` times the largest
/// coordinate.
pub(super) fn is_made_well(
    degree: [usize; 2],
    (net, bezier): (&[DVec4], &[DVec4]),
    (control, along): (&[DVec4], [ToPowers<'_>; 2]),
    factor: f64,
) -> bool {
    let magnitude = magnitude(bezier);
    // The net as it is made in lanes, except for the rounding of products.
    let mut off = in_both_directions(degree, control, |k, line, step| {
        along[k].apply(degree[k], line, step);
    });
    off.iter_mut().zip(net).for_each(|(made, &net)| *made -= net);
    let is_near = |x: f64, y: f64| {
        let [off, here] = [&off[..], net].map(|net| sum(net, degree[1] + 1, [x, y], |c| c));
        let moved = off.truncate().abs().max_element() + off.w.abs() * magnitude;
        moved <= MOST_OFF * factor * magnitude * here.w
    };
    everywhere(is_near)
}

/// Whether a condition holds at all places.
fn everywhere(is_so: impl Fn(f64, f64) -> bool) -> bool {
    PLACES.iter().all(|&x| PLACES.iter().all(|&y| is_so(x, y)))
}

/// The largest absolute coordinate of the points.
fn magnitude(points: &[DVec4]) -> f64 {
    points.iter().map(|c| c.truncate().abs().max_element() / c.w).fold(0.0, f64::max)
}

/// The sum of a power net at a place, with `term` applied to each coefficient.
fn sum(net: &[DVec4], columns: usize, [x, y]: [f64; 2], term: fn(DVec4) -> DVec4) -> DVec4 {
    let row = |row: &[DVec4]| row.iter().rev().fold(DVec4::ZERO, |s, &c| s * y + term(c));
    net.chunks_exact(columns).rev().fold(DVec4::ZERO, |sum, terms| sum * x + row(terms))
}

/// The power net of a piece, from its Bézier points; `None` if it is not well conditioned.
pub(super) fn net_of(degree: [usize; 2], bezier: &[DVec4]) -> Option<BezierNet> {
    let columns = degree[1] + 1;
    let net = in_both_directions(degree, bezier, |k, line, step| to_powers(degree[k], line, step));
    let magnitude = magnitude(bezier);
    // Tests all places with `x` and `y` no larger than these, if the weight there is at least
    // `weight`.
    let suits = |x: f64, y: f64, weight: f64| {
        let sizes = sum(&net, columns, [x.abs(), y.abs()], DVec4::abs);
        sizes.truncate().max_element() + sizes.w * magnitude <= MOST_CONDITION * magnitude * weight
    };
    let suits_all = suits(1.0, 1.0, bezier.iter().map(|c| c.w).fold(f64::INFINITY, f64::min))
        || everywhere(|x, y| suits(x, y, sum(&net, columns, [x, y], |c| c).w));
    suits_all.then_some(net)
}

/// The least degrees, but one at least, that a piece has up to rounding: as a rule its own; less
/// where they have been elevated. All other coefficients of its power net are as good as zero.
///
/// A half circle, too, is a cubic whose degree was elevated: as a quadratic, it has a control point
/// of weight zero, at infinity. So a sphere of two bicubic pieces is biquadratic.
pub(super) fn least_degree(degree: [usize; 2], net: &[DVec4], bezier: &[DVec4]) -> [usize; 2] {
    let columns = degree[1] + 1;
    let largest = bezier.iter().map(|c| c.truncate().abs() / c.w).fold(DVec3::ZERO, DVec3::max);
    let weights = PLACES.iter().flat_map(|&x| PLACES.iter().map(move |&y| [x, y]));
    let weights = weights.map(|at| sum(net, columns, at, |c| c).w);
    let most = MOST_LEFT_OUT * weights.fold(f64::INFINITY, f64::min) * largest;
    let suffices = |[p, q]: [usize; 2]| {
        let others = net.iter().enumerate().filter(|(k, _)| k / columns > p || k % columns > q);
        // A derivative multiplies a coefficient by its power of `x` or `y`.
        let off: DVec4 = others.map(|(k, c)| (k / columns + k % columns) as f64 * c.abs()).sum();
        (off.truncate() + off.w * largest).cmple(most).all()
    };
    let mut least = degree;
    for k in 0..2 {
        while least[k] > 1 {
            let mut lower = least;
            lower[k] -= 1;
            if !suffices(lower) {
                break;
            }
            least = lower;
        }
    }
    least
}

/// Converts Bernstein coefficients of degree up to three on `[−1, 1]` to power coefficients;
/// entries beyond the degree stay as they are.
#[inline]
pub(in crate::patch) fn powers<V>(degree: usize, [a, b, c, d]: [V; 4]) -> [V; 4]
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    match degree {
        1 => [(a + b) * 0.5, (b - a) * 0.5, c, d],
        2 => [(a + c) * 0.25 + b * 0.5, (c - a) * 0.5, ((a - b) + (c - b)) * 0.25, d],
        _ => {
            let (outer, inner) = (a + d, (b + c) * 3.0);
            let (across, between) = (d - a, c - b);
            [
                (outer + inner) * 0.125,
                (across + between) * 0.375,
                ((a - b) + (d - c)) * 0.375,
                (across - between * 3.0) * 0.125,
            ]
        }
    }
}

/// The same for degrees up to [`MOST_DEGREE`], in place, for every `step`-th coefficient from the
/// first on.
fn to_powers<V>(degree: usize, coefficients: &mut [V], step: usize)
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    let first = coefficients[0];
    let mut from = [first; MOST_DEGREE + 1];
    for (k, coefficient) in from[..=degree].iter_mut().enumerate() {
        *coefficient = coefficients[k * step];
    }
    if degree <= 3 {
        let [a, b, c, d, ..] = from;
        let made = powers(degree, [a, b, c, d]);
        for (k, &coefficient) in made[..=degree].iter().enumerate() {
            coefficients[k * step] = coefficient;
        }
        return;
    }
    let middle = from[ToPowers::middle(degree)];
    let nothing = middle * 0.0;
    for (i, shares) in BERNSTEIN_TO_POWERS[degree][..=degree].iter().enumerate() {
        let start = if i == 0 { middle } else { nothing };
        let terms = from[..=degree].iter().zip(shares);
        let sum = terms.fold(start, |sum, (&of, &share)| sum + (of - middle) * share);
        coefficients[i * step] = sum;
    }
}

/// The share of each Bernstein coefficient in each power coefficient, by degree; all exact:
/// `C(p, j) / 2ᵖ` times the coefficients of `(1 + x)ʲ (1 − x)ᵖ⁻ʲ`.
const BERNSTEIN_TO_POWERS: [[[f64; MOST_DEGREE + 1]; MOST_DEGREE + 1]; MOST_DEGREE + 1] = {
    let mut shares = [[[0.0; MOST_DEGREE + 1]; MOST_DEGREE + 1]; MOST_DEGREE + 1];
    let (mut p, mut scale) = (0, 1.0);
    while p <= MOST_DEGREE {
        let mut j = 0;
        while j <= p {
            let mut product = [0.0; MOST_DEGREE + 1];
            product[0] = scale * binomials(p)[j];
            let mut factor = 0;
            while factor < p {
                // Times `1 + x`, or `1 − x`.
                let sign = if factor < j { 1.0 } else { -1.0 };
                let mut i = factor + 1;
                while i > 0 {
                    product[i] += sign * product[i - 1];
                    i -= 1;
                }
                factor += 1;
            }
            let mut i = 0;
            while i <= p {
                shares[p][i][j] = product[i];
                i += 1;
            }
            j += 1;
        }
        (p, scale) = (p + 1, 0.5 * scale);
    }
    shares
};

/// How the power coefficients of a span are made from the control points that govern it: each sums
/// shares of the differences of the other points from the [middle](Self::middle) one, and the first
/// includes the middle point itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToPowers<'a> {
    /// For each coefficient, the shares of these differences.
    shares: &'a [f64],
}

impl<'a> ToPowers<'a> {
    /// The map with these shares.
    pub(super) fn new(shares: &'a [f64]) -> Self {
        Self { shares }
    }

    /// The index of the middle one of the control points that govern a span.
    #[inline(always)]
    pub(crate) fn middle(degree: usize) -> usize {
        degree / 2
    }

    /// Converts control points to coefficients, in place, for every `step`-th point from the first
    /// on.
    fn apply(&self, degree: usize, points: &mut [DVec4], step: usize) {
        let at = Self::middle(degree);
        let middle = points[at * step];
        let others = (0..=degree).filter(|&j| j != at).map(|j| points[j * step] - middle);
        let others: SmallVec<[DVec4; MOST_DEGREE]> = others.collect();
        for (i, shares) in self.shares.chunks_exact(degree).enumerate() {
            let start = if i == 0 { middle } else { DVec4::ZERO };
            let terms = others.iter().zip(shares);
            points[i * step] = terms.fold(start, |sum, (&other, &share)| sum + other * share);
        }
    }

    /// For each coefficient, the shares of the differences from the middle point, in the order of
    /// the other points: as many as the degree.
    #[inline(always)]
    pub(crate) fn shares(&self) -> &'a [f64] {
        self.shares
    }
}

/// Computes the shares that a [`ToPowers`] holds: `p (p + 1)` numbers.
pub(super) fn shares_of_points(extraction: Extraction<'_>, degree: usize, shares: &mut [f64]) {
    let others = (0..=degree).filter(|&j| j != ToPowers::middle(degree));
    for (k, j) in others.enumerate() {
        let mut of_point = extraction.shares_of(degree, j);
        to_powers(degree, &mut of_point, 1);
        for (shares, of_point) in shares.chunks_exact_mut(degree).zip(of_point) {
            shares[k] = of_point;
        }
    }
}

/// The power net of a net of points. `make` converts one line: it is given the direction, the
/// points from the first of the line on, and their stride.
fn in_both_directions(
    [_, q]: [usize; 2],
    points: &[DVec4],
    make: impl Fn(usize, &mut [DVec4], usize),
) -> BezierNet {
    let mut net = BezierNet::from_slice(points);
    for j in 0..=q {
        make(0, &mut net[j..], q + 1);
    }
    for row in net.chunks_exact_mut(q + 1) {
        make(1, row, 1);
    }
    net
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat};

    use super::*;
    use crate::geometry::{NurbsSurface, shapes};
    use crate::math::bernstein;
    use crate::patch::{NetSource, PatchSet};

    #[test]
    fn bernstein_coefficients_become_those_of_powers() {
        for degree in 1..=MOST_DEGREE {
            let points: Vec<_> = (0..=degree)
                .map(|k| (1.0 + k as f64).sin())
                .map(|x| DVec4::new(x, x * x, 1.0 - x, 2.0 * x))
                .collect();
            // Every third is converted; the others stay as they are.
            let mut coefficients = vec![DVec4::NAN; 3 * degree + 2];
            for (k, &point) in points.iter().enumerate() {
                coefficients[3 * k] = point;
            }
            to_powers(degree, &mut coefficients, 3);
            for x in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let basis: [f64; 8] = bernstein::basis(degree, 0.5 * (x + 1.0));
                let wanted: DVec4 = (0..=degree).map(|i| basis[i] * points[i]).sum();
                let power = |i: usize| x.powi(i as i32) * coefficients[3 * i];
                let value: DVec4 = (0..=degree).map(power).sum();
                assert!(value.distance(wanted) < 1e-14, "degree {degree} at {x}");
            }
            assert!(coefficients[1].is_nan() && coefficients[3 * degree + 1].is_nan());
        }
    }

    /// Spans up to four times as long as others, weights up to twice as large, and points that
    /// zigzag about as much as they may, around the origin.
    #[test]
    fn nets_of_gentle_splines_are_made_well() {
        let mut state = 0.37;
        let mut unit = move || {
            state = (997.0f64 * state + 0.123).fract();
            state
        };
        let degrees = [[3, 3], [2, 3], [1, 3], [4, 4], [5, 5], [6, 5], [7, 3], [7, 7]];
        for (degree, alternating) in degrees.into_iter().flat_map(|d| [(d, false), (d, true)]) {
            let scale = 0.01 + unit();
            let knots = degree.map(|degree| {
                let mut values = vec![0.0; degree + 1];
                for _ in 0..if degree <= 3 { 64 } else { 40 } {
                    let last = values[values.len() - 1];
                    values.push(last + 1.0 + 2.9 * unit().powi(3).round());
                }
                values.extend(std::iter::repeat_n(values[values.len() - 1], degree));
                KnotVector::new(degree, values).unwrap()
            });
            let count = knots[0].point_count() * knots[1].point_count();
            let columns = knots[1].point_count();
            let points = (0..count).map(|k| {
                let [x, y] = [k / columns, k % columns].map(|i| (i as f64 - 20.0) * scale);
                let zigzag = 0.1 * (x.abs().max(y.abs()) - scale).max(scale);
                let [dx, dy, dz] = [0; 3].map(|_| zigzag * (2.0 * unit() - 1.0));
                let sign = if (k / columns + k % columns) % 2 == 0 { 1.0 } else { -1.0 };
                DVec3::new(x + dx, y + dy, if alternating { sign * zigzag } else { dz })
            });
            let points: Vec<DVec3> = points.collect();
            let weights = (0..count).map(|_| 1.0 + unit()).collect();
            let [u, v] = knots;
            let surface = NurbsSurface::new(u, v, points, Some(weights)).unwrap();
            let knots = [surface.knots_u(), surface.knots_v()];
            assert!(are_gentle(knots, surface.control()));
            let higher = |point: &DVec4| DVec4::new(point.x, point.y, 20.0 * point.z, point.w);
            let steep: Vec<DVec4> = surface.control().iter().map(higher).collect();
            assert!(!are_gentle(knots, &steep));
            let (set, _) = PatchSet::new(&[surface]).unwrap();
            let mut checked = 0;
            for piece in set.pieces() {
                let NetSource::Spline(net) = piece.patch.sums_source() else { continue };
                let Some(along) = net.by_powers() else { continue };
                let bezier = net.bezier_net();
                let by_powers = net_of(degree, &bezier).unwrap_or_else(|| {
                    in_both_directions(degree, &bezier, |k, line, step| {
                        to_powers(degree[k], line, step);
                    })
                });
                let nets = (&by_powers[..], &bezier[..]);
                let factor = piece.patch.residual_factor();
                assert!(is_made_well(degree, nets, (&net.control(), along), factor), "{degree:?}");
                checked += 1;
            }
            assert!(checked > 400, "{degree:?}: {checked}");
        }
    }

    /// The degrees of the sums of a surface's pieces.
    fn least_degree_of(surface: NurbsSurface) -> [usize; 2] {
        let (set, _) = PatchSet::new(&[surface]).unwrap();
        let degree = set.pieces()[0].patch.sums_degree();
        assert!(set.pieces().iter().all(|piece| piece.patch.sums_degree() == degree));
        degree
    }

    #[test]
    fn elevated_degrees_are_left_out() {
        for (degree @ [p, q], times @ [in_u, in_v]) in [
            ([1, 1], [1, 1]),
            ([1, 2], [1, 0]),
            ([2, 2], [1, 0]),
            ([2, 1], [0, 1]),
            ([3, 3], [0, 1]),
        ] {
            for (rational, far) in [(false, 0.0), (true, 0.0), (false, 1e4), (true, 1e4)] {
                let [u, v] = degree.map(|degree| {
                    let mut values = vec![0.0; degree + 1];
                    values.extend([0.3, 0.45]);
                    values.extend(vec![1.0; degree + 1]);
                    KnotVector::new(degree, values).unwrap()
                });
                let columns = q + 3;
                let control = (0..(p + 3) * columns).map(|k| {
                    let (x, y) = ((k / columns) as f64, (k % columns) as f64);
                    let weight = if rational { 1.0 + 0.4 * (x + 2.0 * y).sin() } else { 1.0 };
                    (weight * (DVec3::new(x, y, (x * y).cos()) + far)).extend(weight)
                });
                let plain = NurbsSurface::from_homogeneous(u, v, control.collect()).unwrap();
                let elevated = plain.elevated_u(in_u).unwrap().elevated_v(in_v).unwrap();
                let told = format!("{degree:?}, {times:?} times, {rational}, {far}");
                assert_eq!(least_degree_of(plain), degree, "{told}");
                assert_eq!(least_degree_of(elevated.clone()), degree, "{told}");

                // Anything more than rounding needs the whole degree.
                let mut control = elevated.control().to_vec();
                control[0].x += 1e-12 * (10.0 + far);
                let [u, v] = [elevated.knots_u(), elevated.knots_v()].map(KnotVector::clone);
                let degree = [p + in_u, q + in_v];
                let moved = NurbsSurface::from_homogeneous(u, v, control).unwrap();
                let (set, _) = PatchSet::new(&[moved]).unwrap();
                assert_eq!(set.pieces()[0].patch.sums_degree(), degree, "{told}");
            }
        }
    }

    #[test]
    fn half_circles_are_quadratic() {
        let sphere = || shapes::sphere(0.7).unwrap();
        assert_eq!(sphere().knots_u().degree(), 3);
        assert_eq!(least_degree_of(sphere()), [2, 2]);
        let turned = DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -2.0) / 3.0, 0.9),
            DVec3::new(-30.0, 4.0, 100.0),
        );
        assert_eq!(least_degree_of(sphere().transformed(&turned).unwrap()), [2, 2]);
    }

    #[test]
    fn equal_points_have_no_other_powers() {
        let net = net_of([5, 7], &[DVec4::new(0.1, -0.7, 0.3, 1.0); 48]).unwrap();
        assert_eq!(net[0], DVec4::new(0.1, -0.7, 0.3, 1.0));
        assert!(net[1..].iter().all(|&c| c == DVec4::ZERO));
    }
}
