//! Triangles: values and derivatives checked in other ways, splitting, and the sphere's octant.

use glam::{DAffine3, DVec2, DVec3};

use super::{TriangleError, TrianglePatch, TriangleSide};
use crate::geometry::NurbsCurve;
use crate::geometry::shapes::{QuarticConstants, octant_biquadratic, octant_quartic};

/// Parameters all over the triangle, its sides and corners included.
fn samples(steps: u32) -> impl Iterator<Item = (f64, f64)> {
    let share = move |k: u32| f64::from(k) / f64::from(steps);
    (0..=steps).flat_map(move |i| (0..=steps - i).map(move |j| (share(i), share(j))))
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// The definition: a sum over all Bernstein polynomials.
fn summed(patch: &TrianglePatch, u: f64, v: f64) -> DVec3 {
    let n = patch.degree();
    let (mut point, mut weight) = (DVec3::ZERO, 0.0);
    for i in 0..=n {
        for j in 0..=n - i {
            let k = n - i - j;
            let w = 1.0 - u - v;
            let b = factorial(n) / (factorial(i) * factorial(j) * factorial(k));
            let b = b * u.powi(i as i32) * v.powi(j as i32) * w.powi(k as i32);
            let control = patch.homogeneous(i, j).unwrap();
            point += b * control.truncate();
            weight += b * control.w;
        }
    }
    point / weight
}

/// A patch of this degree and size, with weights.
fn bumpy(degree: usize, size: f64) -> TrianglePatch {
    let exponents = (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j)));
    let at = |(i, j): (usize, usize)| {
        let (x, y) = (i as f64 / degree as f64, j as f64 / degree as f64);
        size * DVec3::new(x, y, 0.5 + 0.3 * (5.0 * x + 3.0 * y * y).sin())
    };
    let points: Vec<DVec3> = exponents.map(at).collect();
    let weights = (0..points.len()).map(|k| 1.0 + 0.4 * (k as f64 * 1.7).sin()).collect();
    TrianglePatch::new(degree, points, Some(weights)).unwrap()
}

#[test]
fn de_casteljau_is_the_sum_of_bernstein_polynomials() {
    for degree in 1..=9 {
        for size in [1e-8, 1.0, 1e8] {
            let patch = bumpy(degree, size);
            for (u, v) in samples(12) {
                let off = patch.point_at(DVec2::new(u, v)).distance(summed(&patch, u, v));
                assert!(off < 4e-15 * size, "degree {degree}, ({u}, {v}): off by {off:e}");
            }
        }
    }
}

/// A rational quadratic with known derivatives: the paraboloid piece
/// `(u, v, u² + 3uv − v²) / (1 + u)`.
#[test]
fn derivatives_are_those_of_the_closed_form() {
    // Coefficients of 1, u, v, … by polar forms: u ↦ means of u, u² and uv ↦ products.
    let blossom = |a: [f64; 2], b: [f64; 2]| {
        let x = 0.5 * (a[0] + b[0]);
        let y = 0.5 * (a[1] + b[1]);
        let z = a[0] * b[0] + 1.5 * (a[0] * b[1] + a[1] * b[0]) - a[1] * b[1];
        glam::DVec4::new(x, y, z, 1.0 + x)
    };
    let (u, v, w) = ([1.0, 0.0], [0.0, 1.0], [0.0, 0.0]);
    let control = [(w, w), (w, v), (v, v), (w, u), (u, v), (u, u)].map(|(a, b)| blossom(a, b));
    let patch = TrianglePatch::from_homogeneous(2, control.to_vec()).unwrap();
    for (u, v) in samples(10) {
        let s = 1.0 + u;
        let z = u * u + 3.0 * u * v - v * v;
        let at = patch.derivatives(DVec2::new(u, v));
        let expected = [
            (at.point, DVec3::new(u / s, v / s, z / s)),
            (at.du, DVec3::new(1.0, -v, (2.0 * u + 3.0 * v) * s - z) / (s * s)),
            (at.dv, DVec3::new(0.0, 1.0, 3.0 * u - 2.0 * v) / s),
            (at.dvv, DVec3::new(0.0, 0.0, -2.0) / s),
            (at.duv, DVec3::new(0.0, -1.0, 3.0 * s - (3.0 * u - 2.0 * v)) / (s * s)),
            (
                at.duu,
                DVec3::new(-2.0, 2.0 * v, 2.0 * s * s - 2.0 * (2.0 * u + 3.0 * v) * s + 2.0 * z)
                    / (s * s * s),
            ),
        ];
        for (found, expected) in expected {
            assert!(found.distance(expected) < 2e-14, "({u}, {v}): {found}, not {expected}");
        }
    }
}

#[test]
fn derivatives_of_any_degree_agree_with_differences() {
    let h = 1e-5;
    for degree in [1, 3, 4, 7] {
        let patch = bumpy(degree, 1.0);
        for (u, v) in samples(6) {
            let at = patch.derivatives(DVec2::new(u, v));
            let [east, west] = [h, -h].map(|h| patch.derivatives(DVec2::new(u + h, v)));
            let [north, south] = [h, -h].map(|h| patch.derivatives(DVec2::new(u, v + h)));
            let central = |a: DVec3, b: DVec3| (a - b) / (2.0 * h);
            assert!(at.du.distance(central(east.point, west.point)) < 1e-7);
            assert!(at.dv.distance(central(north.point, south.point)) < 1e-7);
            assert!(at.duu.distance(central(east.du, west.du)) < 1e-6);
            assert!(at.duv.distance(central(north.du, south.du)) < 1e-6);
            assert!(at.dvv.distance(central(north.dv, south.dv)) < 1e-6);
        }
    }
}

#[test]
fn quarters_are_the_patch_and_share_their_sides() {
    for degree in [1, 2, 4, 7] {
        let patch = bumpy(degree, 1.0);
        let quarters = patch.quarters();
        for quarter in &quarters {
            let [a, b, c] = quarter.corners;
            for (u, v) in samples(8) {
                let at: DVec2 = u * a + v * b + (1.0 - u - v) * c;
                let off = quarter.patch.point_at(DVec2::new(u, v)).distance(patch.point_at(at));
                assert!(off < 4e-15, "degree {degree}: off by {off:e}");
            }
            // Orientation: areas keep their sign.
            let turn = (a - c).perp_dot(b - c);
            assert!((turn - 0.25).abs() < 1e-15);
        }
        // The middle quarter's sides u = 0, v = 0, w = 0 are the corners' own, run backwards.
        let [at_u, at_v, at_w, middle] = quarters.map(|quarter| quarter.patch);
        let reversed =
            |curve: NurbsCurve| curve.control().iter().rev().copied().collect::<Vec<_>>();
        let side = |patch: &TrianglePatch, side| patch.side(side).control().to_vec();
        assert_eq!(side(&middle, TriangleSide::U), reversed(at_u.side(TriangleSide::U)));
        assert_eq!(side(&middle, TriangleSide::V), reversed(at_v.side(TriangleSide::V)));
        assert_eq!(side(&middle, TriangleSide::W), reversed(at_w.side(TriangleSide::W)));
    }
}

/// Neighbours that share a side share it after splitting, however it lies in each.
#[test]
fn parts_of_neighbours_agree_bit_for_bit() {
    let patch = octant_quartic(1.0).unwrap();
    let mirror = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let other = patch.transformed(&mirror).unwrap().swapped();
    let halves = |patch: &TrianglePatch, parts: [usize; 2]| {
        let quarters = patch.quarters();
        parts.map(|part| quarters[part].patch.side(TriangleSide::W).control().to_vec())
    };
    let [from_u, from_v] = halves(&patch, [0, 1]);
    let [to_v, to_u] = halves(&other, [0, 1]);
    let reversed = |line: Vec<_>| line.into_iter().rev().collect::<Vec<_>>();
    assert_eq!((from_u, from_v), (reversed(to_u), reversed(to_v)));
}

#[test]
fn the_octant_s_constants_are_the_note_s() {
    let patch = octant_quartic(1.0).unwrap();
    let [a0, a1, a2] = [0.422_649_730_810_374_2, 0.788_675_134_594_812_9, 0.589_353_461_558_106];
    let b = [5.071_796_769_724_491, 4.242_640_687_119_285, 4.0, 3.344_677_257_168_586];
    // Exponents (i, j, k), the point, the weight: the note's two tables.
    let table = [
        (0, 4, [0.0, 1.0, 0.0], b[0]),
        (0, 3, [0.0, 1.0, a0], b[1]),
        (1, 3, [a0, 1.0, 0.0], b[1]),
        (0, 2, [0.0, a1, a1], b[2]),
        (1, 2, [a2, 1.0, a2], b[3]),
        (2, 2, [a1, a1, 0.0], b[2]),
        (0, 1, [0.0, a0, 1.0], b[1]),
        (1, 1, [a2, a2, 1.0], b[3]),
        (2, 1, [1.0, a2, a2], b[3]),
        (3, 1, [1.0, a0, 0.0], b[1]),
        (0, 0, [0.0, 0.0, 1.0], b[0]),
        (1, 0, [a0, 0.0, 1.0], b[1]),
        (2, 0, [a1, 0.0, a1], b[2]),
        (3, 0, [1.0, 0.0, a0], b[1]),
        (4, 0, [1.0, 0.0, 0.0], b[0]),
    ];
    assert_eq!(patch.control().len(), table.len());
    for (i, j, point, weight) in table {
        let found = patch.point(i, j).unwrap();
        assert!(found.distance(DVec3::from(point)) < 1e-15, "({i}, {j}): {found}");
        assert!((patch.homogeneous(i, j).unwrap().w - weight).abs() < 2e-15, "({i}, {j})");
    }
    assert_eq!(patch.point(3, 2), None);
}

#[test]
fn the_octant_is_round_faces_outward_and_has_its_middle_in_the_middle() {
    for radius in [1e-8, 1.0, 1e8] {
        let patch = octant_quartic(radius).unwrap();
        for (u, v) in samples(20) {
            let p = patch.point_at(DVec2::new(u, v)) / radius;
            assert!((p.length() - 1.0).abs() < 1e-15, "({u}, {v}): {}", p.length() - 1.0);
            // The corners too.
            let normal = patch.normal(DVec2::new(u, v)).unwrap();
            assert!(normal.distance(p) < 4e-15, "({u}, {v}): {normal}");
            // Both tangents are tangent, and second derivatives bend as the sphere does:
            // p·S_uu = −S_u·S_u, and so on.
            let at = patch.derivatives(DVec2::new(u, v));
            assert!(p.dot(at.du).abs() < 2e-15 * at.du.length());
            let bends = [(at.duu, at.du, at.du), (at.duv, at.du, at.dv), (at.dvv, at.dv, at.dv)];
            for (second, a, b) in bends {
                let off = (p.dot(second) * radius + a.dot(b)).abs();
                assert!(off < 1e-13 * second.length() * radius, "({u}, {v}): {off:e}");
            }
        }
        let middle = patch.point_at(DVec2::new(1.0 / 3.0, 1.0 / 3.0)) / radius;
        assert!(middle.distance(DVec3::splat(3.0_f64.sqrt().recip())) < 2e-16);
    }
    assert!(octant_quartic(0.0).is_err() && octant_quartic(f64::NAN).is_err());
}

/// The side `w = 0` is such a quarter circle, as far from the origin as a side of the biquadratic
/// octant.
#[test]
fn the_octant_s_sides_are_quarter_circles_of_degree_4() {
    let patch = octant_quartic(1.0).unwrap();
    let weights: Vec<f64> = patch.side(TriangleSide::W).control().iter().map(|p| p.w).collect();
    let [w1, w2] = [weights[1] / weights[0], weights[2] / weights[0]];
    assert!((w1 - 0.836_516_303_737_808).abs() < 1e-15);
    let y1 = patch.point(3, 1).unwrap().y;
    let x2 = patch.point(2, 2).unwrap().x;
    let arc = QuarticConstants::new([w1, w2], y1, x2).unwrap().curve();
    let biquadratic = octant_biquadratic(1.0).unwrap();
    for k in 0..=40 {
        let t = f64::from(k) / 40.0;
        // From v = 1, on the y axis, to u = 1, on the x axis.
        let on_side = patch.side(TriangleSide::W).point_at(t);
        assert!(on_side.distance(arc.point_at(1.0 - t)) < 1e-15);
        assert!(on_side.distance(patch.point_at(DVec2::new(t, 1.0 - t))) < 1e-15);
        assert!(
            (biquadratic.point_at(DVec2::new(t, 0.0)).length() - on_side.length()).abs() < 1e-15
        );
    }
}

#[test]
fn what_is_no_triangle() {
    let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let message = |result: Result<TrianglePatch, TriangleError>| result.unwrap_err().to_string();
    assert_eq!(
        message(TrianglePatch::new(2, points.clone(), None)),
        "3 control points, but a triangle of degree 2 needs 6"
    );
    assert_eq!(
        message(TrianglePatch::new(1, points.clone(), Some(vec![1.0, 0.0, 1.0]))),
        "the weight of control point (0, 1, 0) is 0: it must be positive and finite (from 1e-70 to 1e70)"
    );
    assert_eq!(
        message(TrianglePatch::new(1, vec![DVec3::ONE; 3], None)),
        "all control points are (1, 1, 1): the patch has no extent"
    );
    assert_eq!(
        message(TrianglePatch::new(1, vec![DVec3::NAN; 3], None)),
        "control point (0, 0, 1) is (NaN, NaN, NaN): coordinates must be finite (up to 1e70)"
    );
    assert_eq!(
        message(TrianglePatch::new(33, Vec::new(), None)),
        "degree 33: degrees from 1 to 32 are supported"
    );
    assert!(TrianglePatch::new(1, points.clone(), Some(vec![1.0])).is_err());
    assert_eq!(
        message(TrianglePatch::new(1, vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], None)),
        "all control points lie on the line from (0, 0, 0) to (2, 0, 0), to within rounding: the \
         patch has no area"
    );
    assert_eq!(
        message(TrianglePatch::new(1, points.iter().map(|p| 1e-80 * p).collect(), None)),
        "the control points span 1e-80: at least 1e-70 is needed"
    );
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let patch = TrianglePatch::new(1, points, None).unwrap();
    assert_eq!(
        message(patch.transformed(&flat)),
        "the transform's determinant is 0: it must be neither 0 nor infinite"
    );
    let nowhere = DAffine3::from_translation(DVec3::new(0.0, f64::NAN, 0.0));
    assert_eq!(
        message(patch.transformed(&nowhere)),
        "the transform is not finite: all of its numbers must be"
    );
    // w = 1 at the origin, v = 1 at x, u = 1 at y.
    assert_eq!(patch.normal(DVec2::new(1.0, 0.0)), Some(DVec3::NEG_Z));
    assert_eq!(patch.swapped().normal(DVec2::new(1.0, 0.0)), Some(DVec3::Z));
}

#[test]
fn lines_of_constant_parameter_are_the_patch_s_own() {
    for degree in [1, 2, 4, 7] {
        let patch = bumpy(degree, 1.0);
        for at in [0.0, 0.1, 0.5, 0.875] {
            for side in [TriangleSide::U, TriangleSide::V, TriangleSide::W] {
                let curve = patch.curve_at(side, at).unwrap();
                for k in 0..=16 {
                    let t = f64::from(k) / 16.0;
                    let along = t * (1.0 - at);
                    let (u, v) = match side {
                        TriangleSide::U => (at, along),
                        TriangleSide::V => (along, at),
                        TriangleSide::W => (along, 1.0 - at - along),
                    };
                    let off = curve.point_at(t).distance(patch.point_at(DVec2::new(u, v)));
                    assert!(off < 1e-14, "degree {degree}, {side:?} = {at}, {t}: {off:e}");
                }
            }
        }
        for side in [TriangleSide::U, TriangleSide::V, TriangleSide::W] {
            assert_eq!(patch.curve_at(side, 0.0).unwrap(), patch.side(side), "{side:?}");
            assert!(patch.curve_at(side, 1.0).unwrap().is_point());
        }
        for off in [-0.1, 1.1, f64::NAN] {
            assert!(patch.curve_at(TriangleSide::W, off).is_none());
        }
    }
}
