//! Coons patches: a surface through four border curves.

use glam::{DVec4, Vec4Swizzles};

use super::compatible::compatible;
use super::fold::check_fold;
use super::net_size::net_size;
use super::{ConstructError, CoonsCorner};
use crate::geometry::{Direction, KnotVector, MAX_DEGREE, NurbsCurve, NurbsSurface, Span};

/// The four borders of a Coons patch. Each is named by the parameter that is fixed there, and
/// runs in the direction in which the other one grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Borders {
    /// Where `u` begins; runs along `v`.
    pub u0: NurbsCurve,
    /// Where `u` ends; runs along `v`.
    pub u1: NurbsCurve,
    /// Where `v` begins; runs along `u`.
    pub v0: NurbsCurve,
    /// Where `v` ends; runs along `u`.
    pub v1: NurbsCurve,
}

const CORNERS: [CoonsCorner; 4] = [
    CoonsCorner { u: 0, v: 0 },
    CoonsCorner { u: 0, v: 1 },
    CoonsCorner { u: 1, v: 0 },
    CoonsCorner { u: 1, v: 1 },
];

/// Two ends agree if they are no farther apart than a few rounding errors of their coordinates: a
/// rotation costs about six operations of half an ulp, division by a weight another.
const SAME_CORNER: f64 = 8.0 * f64::EPSILON;

/// Weights whose relative difference is at most this are equal up to rounding.
const SAME_WEIGHT: f64 = 4.0 * f64::EPSILON;

/// The bilinearly blended patch of Coons (1967) between four borders, on `[0, 1]²`: the ruled
/// surface between `v0` and `v1`, plus the one between `u0` and `u1`, minus the bilinear surface
/// between the corners.
///
/// The patch meets its borders exactly, and with their own speeds where these begin and end with
/// equal weights. A border with unequal end weights is run at another speed (a linear rational
/// reparametrisation, Piegl & Tiller 1997, 6.4); its shape is unchanged. The inside is exactly the
/// sum above if the borders are polynomial. Rational borders are blended in homogeneous
/// coordinates, with weights 1 at the corners: that gives a surface of the same degrees, but not
/// the sum of the three surfaces in space. The whole control net is computed at once: linear
/// functions have their Greville abscissae as coefficients.
///
/// # Errors
/// When two borders do not end in the same point (within rounding of their coordinates); when two
/// opposite borders run back over themselves and so does everything between them (it need not where
/// the other two borders part); or when weights inside the patch would not be positive, as where
/// cubic borders have weights below 1/3 inside. (Where only those of control points would not be,
/// spans of the borders are halved, up to five times.)
pub fn coons(borders: &Borders) -> Result<NurbsSurface, ConstructError> {
    let Borders { u0, u1, v0, v1 } = borders;
    check_corners(borders)?;
    let mut along_u = unit_pair([v0, v1], "v")?;
    let mut along_v = unit_pair([u0, u1], "u")?;
    let mut net = blended(&along_u, &along_v)?;
    for _ in 0..HALVINGS {
        if net.iter().all(|point| point.w > 0.0) || !has_weight(&along_u, &along_v) {
            break;
        }
        let finer = (halved(&along_u, "v")?, halved(&along_v, "u")?);
        let Ok(finer_net) = blended(&finer.0, &finer.1) else { break }; // too large
        (along_u, along_v) = finer;
        net = finer_net;
    }
    if let Some(place) = net.iter().position(|point| point.w <= 0.0) {
        let columns = along_v[0].control().len();
        let (point, weight) = ([place / columns, place % columns], net[place].w);
        return Err(ConstructError::BorderWeights { point, weight });
    }
    let [knots_u, knots_v] = [&along_u, &along_v].map(|pair| pair[0].knots().clone());
    let patch = NurbsSurface::from_homogeneous(knots_u, knots_v, net)?;
    check_folds(borders, &patch)?;
    Ok(patch)
}

/// How often spans are halved for the sake of positive weights: each time brings the weights of
/// control points four times as near to the surface's own.
const HALVINGS: usize = 5;

/// Whether the patch's own weights are positive at the ends and middles of all spans. At corners
/// they are 1.
fn has_weight(along_u: &[NurbsCurve; 2], along_v: &[NurbsCurve; 2]) -> bool {
    let places = |curve: &NurbsCurve| -> Vec<f64> {
        let spans = curve.knots().spans();
        spans.flat_map(|Span { start, end, .. }| [start, 0.5 * (start + end)]).collect()
    };
    let weights = |pair: &[NurbsCurve; 2], t: f64| pair.each_ref().map(|curve| weight_at(curve, t));
    let (us, vs) = (places(&along_u[0]), places(&along_v[0]));
    let at_us: Vec<[f64; 2]> = us.iter().map(|&u| weights(along_u, u)).collect();
    let at_vs: Vec<[f64; 2]> = vs.iter().map(|&v| weights(along_v, v)).collect();
    let between = |[from, to]: [f64; 2], share: f64| from + share * (to - from);
    us.iter().zip(&at_us).all(|(&u, &at_u)| {
        let weight = |(&v, &at_v): (&f64, &[f64; 2])| between(at_u, v) + between(at_v, u) - 1.0;
        vs.iter().zip(&at_vs).all(|at| weight(at) > 0.0)
    })
}

fn weight_at(curve: &NurbsCurve, t: f64) -> f64 {
    let mut values = [0.0; MAX_DEGREE + 1];
    let span = curve.knots().basis(t, &mut values);
    let active = &curve.control()[span - curve.knots().degree()..=span];
    active.iter().zip(values).map(|(point, value)| value * point.w).sum()
}

/// A pair of borders of one name with a knot in the middle of each span.
fn halved(pair: &[NurbsCurve; 2], name: &str) -> Result<[NurbsCurve; 2], ConstructError> {
    let mut halved = pair.clone();
    for Span { start, end, .. } in pair[0].knots().spans() {
        let middle = 0.5 * (start + end);
        if !(start < middle && middle < end) {
            continue; // neighbouring numbers
        }
        for (k, curve) in halved.iter_mut().enumerate() {
            let named = ConstructError::of(format!("border {name}{k}"));
            *curve = curve.insert_knot(middle, 1).map_err(named)?;
        }
    }
    Ok(halved)
}

/// The net of the patch between two borders along `u` and two along `v`.
fn blended(
    along_u: &[NurbsCurve; 2],
    along_v: &[NurbsCurve; 2],
) -> Result<Vec<DVec4>, ConstructError> {
    let [c0, c1] = along_u.each_ref().map(|curve| curve.control());
    let [mut d0, mut d1] = along_v.each_ref().map(|curve| curve.control().to_vec());

    // Corners that agree up to rounding are made equal.
    let (last_i, last_j) = (c0.len() - 1, d0.len() - 1);
    let corners = [[c0[0], c1[0]], [c0[last_i], c1[last_i]]];
    [d0[0], d0[last_j]] = corners[0];
    [d1[0], d1[last_j]] = corners[1];

    let (shares_u, shares_v) = (greville(along_u[0].knots()), greville(along_v[0].knots()));
    let mut net = Vec::with_capacity(net_size(c0.len(), d0.len())?);
    for (i, &mu) in shares_u.iter().enumerate() {
        for (j, &nu) in shares_v.iter().enumerate() {
            net.push(match (i, j) {
                (0, j) => d0[j],
                (i, j) if i == last_i => d1[j],
                (i, 0) => c0[i],
                (i, j) if j == last_j => c1[i],
                (i, j) => {
                    let between = |a: DVec4, b: DVec4, share: f64| (1.0 - share) * a + share * b;
                    let [low, high] = corners.map(|[a, b]| between(a, b, nu));
                    between(c0[i], c1[i], nu) + between(d0[j], d1[j], mu) - between(low, high, mu)
                }
            });
        }
    }
    Ok(net)
}

/// The parameters at which lines between two borders are checked for folds: no places that borders
/// or their symmetry single out.
const BETWEEN: [f64; 3] = [0.23, 0.47, 0.81];

/// Fails if two opposite borders, and the lines between them, run back over themselves.
fn check_folds(borders: &Borders, patch: &NurbsSurface) -> Result<(), ConstructError> {
    let Borders { u0, u1, v0, v1 } = borders;
    for (pair, direction) in [([u0, u1], Direction::U), ([v0, v1], Direction::V)] {
        let fold = |k: usize| check_fold(pair[k], &format!("border {direction}{k}"));
        let (Err(error), Err(_)) = (fold(0), fold(1)) else { continue };
        let mut all = true;
        for share in BETWEEN {
            all &= check_fold(&patch.curve_at(direction, share)?, &direction.to_string()).is_err();
        }
        if all {
            return Err(error);
        }
    }
    Ok(())
}

fn check_corners(borders: &Borders) -> Result<(), ConstructError> {
    let Borders { u0, u1, v0, v1 } = borders;
    let curves = [u0, u1, v0, v1];
    let magnitude = curves.iter().map(|curve| curve.magnitude()).fold(0.0, f64::max);
    let [u, v] = [[u0, u1], [v0, v1]].map(|pair| pair.map(|curve| curve.clamped().ends()));
    for corner in CORNERS {
        let (i, j) = (usize::from(corner.u), usize::from(corner.v));
        let [a, b] = [u[i][j], v[j][i]];
        let distance = a.distance(b);
        let agree = distance <= SAME_CORNER * magnitude; // false for NaN
        if !agree {
            return Err(ConstructError::Corner { corner, u: a, v: b, distance });
        }
    }
    Ok(())
}

/// Two opposite borders made compatible on `[0, 1]`, with weights 1 at all four ends.
fn unit_pair(pair: [&NurbsCurve; 2], name: &str) -> Result<[NurbsCurve; 2], ConstructError> {
    let which = |index| format!("border {name}{index}");
    let mut curves = Vec::with_capacity(2);
    for (index, curve) in pair.into_iter().enumerate() {
        let curve =
            curve.clamped().on_domain(0.0, 1.0).map_err(ConstructError::of(which(index)))?;
        curves.push(
            with_unit_ends(&curve)
                .map_err(|error| ConstructError::Curve { which: which(index), error })?,
        );
    }
    let both = compatible(&curves, &which)?;
    Ok([both[0].clone(), both[1].clone()])
}

/// The same clamped curve on `[0, 1]` with weights 1 at both ends.
///
/// With `D(s) = 1 − s + λ s` and `t = λ s / D(s)`, the blossom of `Dᵖ C(t(s))` at new knots
/// is that of `C` at the old ones times all `D` there: control points stay, weights change.
/// `λ` is chosen such that the last weight becomes 1 when the first is.
fn with_unit_ends(curve: &NurbsCurve) -> Result<NurbsCurve, crate::geometry::CurveError> {
    let (knots, control) = (curve.knots(), curve.control());
    let (p, values) = (knots.degree(), knots.values());
    let (first, last) = (control[0].w, control[control.len() - 1].w);
    let scaled = |factor: f64| control.iter().map(move |point| factor * *point);
    if (first - last).abs() <= SAME_WEIGHT * first {
        return NurbsCurve::from_homogeneous(
            knots.clone(),
            ends_at_one(scaled(1.0 / first).collect()),
        );
    }
    let lambda = (first / last).powf(1.0 / p as f64);
    let moved = |&t: &f64| if t == 1.0 { 1.0 } else { t / (lambda - (lambda - 1.0) * t) };
    let new: Vec<f64> = values.iter().map(moved).collect();
    let speed = |s: f64| 1.0 - s + lambda * s;
    let factor = |i: usize| new[i + 1..=i + p].iter().map(|&s| speed(s)).product::<f64>();
    let control = scaled(1.0 / first).enumerate().map(|(i, point)| factor(i) * point).collect();
    NurbsCurve::from_homogeneous(KnotVector::new(p, new)?, ends_at_one(control))
}

/// Sets end weights that are 1 up to rounding to exactly 1.
fn ends_at_one(mut control: Vec<DVec4>) -> Vec<DVec4> {
    let last = control.len() - 1;
    for index in [0, last] {
        let point = control[index];
        control[index] = (point.xyz() / point.w).extend(1.0);
    }
    control
}

/// The Greville abscissae `(t_{i+1} + … + t_{i+p}) / p`: the coefficients of the function
/// `t` itself, here on `[0, 1]`.
pub(crate) fn greville(knots: &KnotVector) -> Vec<f64> {
    let (p, values) = (knots.degree(), knots.values());
    (0..knots.point_count()).map(|i| values[i + 1..=i + p].iter().sum::<f64>() / p as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::knots::unit_knots;
    use crate::geometry::shapes::circle_arc;
    use glam::{DAffine3, DVec2, DVec3};

    fn bezier(points: &[[f64; 3]]) -> NurbsCurve {
        NurbsCurve::bezier(&points.iter().map(|&p| p.into()).collect::<Vec<_>>()).unwrap()
    }

    /// Polynomial borders of several degrees, one with knots of its own.
    fn polynomial(size: f64) -> Borders {
        let scale = DAffine3::from_scale(DVec3::splat(size));
        let knots = KnotVector::with_multiplicities(2, &[(1.0, 3), (2.5, 1), (3.0, 3)]).unwrap();
        let points = [[0.0, 2.0, 0.5], [1.0, 2.5, 1.0], [2.0, 1.5, 0.0], [3.0, 2.0, 0.0]];
        let v1 = NurbsCurve::new(knots, points.map(DVec3::from).to_vec(), None).unwrap();
        let all = [
            bezier(&[[0.0, 0.0, 0.0], [-0.5, 1.0, 1.0], [0.0, 1.5, 2.0], [0.0, 2.0, 0.5]]),
            bezier(&[[3.0, 0.0, 1.0], [3.0, 2.0, 0.0]]),
            bezier(&[[0.0, 0.0, 0.0], [1.0, -1.0, 1.0], [3.0, 0.0, 1.0]]),
            v1,
        ];
        let [u0, u1, v0, v1] = all.map(|curve| curve.transformed(&scale).unwrap());
        Borders { u0, u1, v0, v1 }
    }

    fn at(curve: &NurbsCurve, share: f64) -> DVec3 {
        let [a, b] = curve.domain();
        curve.point_at(a + share * (b - a))
    }

    #[test]
    fn polynomial_patches_are_coons_sum_at_any_size() {
        for size in [1e-8, 1.0, 1e8] {
            let borders = polynomial(size);
            let patch = coons(&borders).unwrap();
            let Borders { u0, u1, v0, v1 } = &borders;
            for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
                let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                let sum =
                    (1.0 - v) * at(v0, u) + v * at(v1, u) + (1.0 - u) * at(u0, v) + u * at(u1, v)
                        - (1.0 - u) * ((1.0 - v) * at(u0, 0.0) + v * at(u0, 1.0))
                        - u * ((1.0 - v) * at(u1, 0.0) + v * at(u1, 1.0));
                let off = patch.point_at(DVec2::new(u, v)).distance(sum);
                assert!(off < 1e-14 * size, "({u}, {v}): off by {off:e}");
            }
        }
    }

    #[test]
    fn rational_borders_are_met_in_shape() {
        // A disk between four quarters of its rim, one of them with weights 1, 1, 2.
        let quarter = |from: f64, turn: f64| circle_arc(2.0, from, turn).unwrap();
        let (u0, u1) = (quarter(180.0, -90.0), quarter(-90.0, 90.0));
        let v0 = quarter(180.0, 90.0);
        let uneven = [[0.0, 2.0, 1.0], [2.0, 2.0, 1.0], [4.0, 0.0, 2.0]];
        let control = uneven.map(|[x, y, w]| DVec4::new(x, y, 0.0, w)).to_vec();
        let v1 = NurbsCurve::from_homogeneous(unit_knots(2), control).unwrap();
        let disk = coons(&Borders { u0: u0.clone(), u1, v0: v0.clone(), v1 }).unwrap();
        for k in 0..=40 {
            let s = f64::from(k) / 40.0;
            for (u, v) in [(0.0, s), (1.0, s), (s, 0.0), (s, 1.0)] {
                let p = disk.point_at(DVec2::new(u, v));
                assert!((p.length() - 2.0).abs() < 2e-15 && p.z == 0.0, "({u}, {v}): {p}");
            }
            assert!(
                disk.point_at(DVec2::new(0.0, s)).distance(u0.point_at(s)) < 1e-15,
                "equal ends: speed"
            );
            assert!(disk.point_at(DVec2::new(s, 0.0)).distance(v0.point_at(s)) < 1e-15);
            assert!(disk.point_at(DVec2::new(s, 0.7)).length() <= 2.0 + 1e-14);
        }
    }

    #[test]
    fn any_weights_and_knots_keep_the_shape_of_a_border() {
        let knots = KnotVector::with_multiplicities(3, &[(0.0, 4), (0.3, 2), (0.8, 1), (1.0, 4)]);
        let knots = knots.unwrap();
        let points = (0..7).map(|k| DVec3::new(f64::from(k), f64::from(k % 3), 1.0)).collect();
        let weights = vec![3.0, 1.0, 2.0, 0.5, 1.0, 1.0, 0.2];
        let curve = NurbsCurve::new(knots, points, Some(weights)).unwrap();
        let unit = with_unit_ends(&curve).unwrap();
        assert_eq!((unit.control()[0].w, unit.control()[6].w), (1.0, 1.0));
        let lambda = 15_f64.powf(1.0 / 3.0);
        for k in 0..=50 {
            let s = f64::from(k) / 50.0;
            let t = lambda * s / (1.0 - s + lambda * s);
            assert!(unit.point_at(s).distance(curve.point_at(t)) < 1e-14, "{s}");
        }
    }

    /// Quadratic borders whose middle weights add up to less than those of the corners.
    #[test]
    fn small_weights_inside_borders_are_no_obstacle() {
        let arc = |[from, to]: [DVec3; 2], lift: f64, inside: &[f64]| {
            let middle = 0.5 * (from + to) + lift * DVec3::Z;
            let points = [&[from], &vec![middle; inside.len()][..], &[to]].concat();
            let weights = [&[1.0], inside, &[1.0]].concat();
            let knots = KnotVector::bezier(1 + inside.len()).unwrap();
            NurbsCurve::new(knots, points, Some(weights)).unwrap()
        };
        let [a, b, c, d] =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let borders = |inside: &[f64]| Borders {
            v0: arc([a, b], 0.4, inside),
            v1: arc([c, d], 0.3, inside),
            u0: arc([a, c], 0.2, inside),
            u1: arc([b, d], 0.1, inside),
        };
        for weight in [0.1, 0.3, 0.5, 0.7] {
            let all = borders(&[weight]);
            let patch = coons(&all).unwrap();
            assert_eq!(patch.knots_u().spans().count() == 1, weight > 0.5, "{weight}");
            for k in 0..=20 {
                let t = f64::from(k) / 20.0;
                for (uv, border) in [
                    (DVec2::new(t, 0.0), &all.v0),
                    (DVec2::new(t, 1.0), &all.v1),
                    (DVec2::new(0.0, t), &all.u0),
                    (DVec2::new(1.0, t), &all.u1),
                ] {
                    assert!(patch.point_at(uv).distance(border.point_at(t)) < 1e-14, "{uv}");
                }
            }
        }
        // Here the surface's own weight in the middle is 2 · 0.325 − 1.
        let error = coons(&borders(&[0.1; 2])).unwrap_err();
        let ConstructError::BorderWeights { point, weight } = error else { panic!("{error}") };
        assert_eq!((point, weight < -0.3), ([1, 1], true), "{weight}");
    }

    #[test]
    fn corners_that_do_not_agree_are_named_with_their_distance() {
        let mut borders = polynomial(1.0);
        let gap = DAffine3::from_translation(DVec3::new(0.0, 0.0, 0.25));
        borders.u1 = borders.u1.transformed(&gap).unwrap();
        assert_eq!(
            coons(&borders).unwrap_err().to_string(),
            "the corner of borders u1 and v0: they end at (3, 0, 1.25) and (3, 0, 1), 0.25 apart; \
             they must meet"
        );
    }
}
