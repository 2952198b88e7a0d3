//! The bounds hold, and not by far.

use glam::DVec2;

use super::super::bicubic::NO_WEIGHT;
use super::*;
use crate::geometry::{KnotVector, shapes};
use crate::math::bernstein::{Basis, basis, derivative_from_lower};
use crate::patch::{Jet, Leaf, PatchSet, ScaledFrame, TensorPatch, WeightFit};

/// The leaves of a set.
fn leaves(set: &PatchSet, parts: &[crate::patch::Part]) -> Vec<(Leaf, WeightFit)> {
    let frame = ScaledFrame::around(&set.bounds());
    let leaf = |part: &crate::patch::Part| {
        let (leaf, weight, _) = Leaf::new(part, &set.pieces()[part.piece as usize], &frame);
        (leaf, weight)
    };
    parts.iter().map(leaf).collect()
}

/// The approximation's numerators less a point times its weight, and its first derivatives,
/// relative to the leaf's middle; and the weight.
fn approximation((leaf, weight): &(Leaf, WeightFit), point: DVec3, x: f64, y: f64) -> (Jet, f64) {
    let mut jet = Jet { point: DVec3::ZERO, ds: DVec3::ZERO, dt: DVec3::ZERO };
    let mut sum = 0.0;
    for k in 0..16 {
        let at = |axis: usize| f64::from(leaf.fit()[axis][k]);
        let (w, i, j) = (f64::from(weight[k]), k as i32 / 4, k as i32 % 4);
        let c = DVec3::new(at(0), at(1), at(2)) - w * point;
        jet.point += c * x.powi(i) * y.powi(j);
        jet.ds += c * f64::from(i) * x.powi((i - 1).max(0)) * y.powi(j);
        jet.dt += c * f64::from(j) * x.powi(i) * y.powi((j - 1).max(0));
        sum += w * x.powi(i) * y.powi(j);
    }
    (jet, sum)
}

#[test]
fn bounds_hold_on_the_widened_leaves() {
    check(shapes::sphere(1.0).unwrap());
    check(shapes::torus(1.0, 0.4).unwrap());
}

#[test]
fn bounds_hold_for_other_degrees() {
    for degree in [[1, 1], [1, 2], [2, 2], [3, 1], [3, 3], [2, 5], [5, 2], [1, 4], [3, 8], [12, 3]]
    {
        check(one_piece(degree, |k, x, y| {
            let k = k as f64;
            let weight = 1.0 + 0.3 * k.sin();
            weight * DVec3::new(x, y, 0.1 * (3.0 * k).cos()).extend(1.0)
        }));
    }
}

/// The rounding error of a net that is enlarged grows with the degree.
#[test]
fn bounds_hold_for_large_degrees() {
    for degree in [[24, 24], [28, 28], [32, 24], [32, 32]] {
        for bend in [0.0, 1e-11, 1e-3] {
            check(one_piece(degree, |_, x, y| DVec4::new(x, y, bend * x * x, 1.0)));
        }
    }
}

/// A piece of these degrees, whose control points are made from their index and their place in
/// a unit square.
fn one_piece(
    degree: [usize; 2],
    point: impl Fn(usize, f64, f64) -> DVec4,
) -> crate::geometry::NurbsSurface {
    let [p, q] = degree;
    let place = |k: usize| {
        let (i, j) = (k / (q + 1), k % (q + 1));
        point(k, i as f64 / p as f64, j as f64 / q as f64)
    };
    let net = (0..(p + 1) * (q + 1)).map(place).collect();
    let [u, v] = degree.map(|degree| KnotVector::bezier(degree).unwrap());
    crate::geometry::NurbsSurface::from_homogeneous(u, v, net).unwrap()
}

fn check(surface: crate::geometry::NurbsSurface) {
    let (set, parts) = PatchSet::new(&[surface]).unwrap();
    for fitted in leaves(&set, parts.all()).iter().step_by(7) {
        let leaf = &fitted.0;
        let patch = &set.pieces()[leaf.piece as usize].patch;
        let half = leaf.rect().map(|[from, to]| 0.5 * (to - from));
        let middle = leaf.rect().map(|[from, to]| 0.5 * (from + to));
        let true_jet = |x: f64, y: f64| {
            let st = DVec2::new(middle[0] + x * half[0], middle[1] + y * half[1]);
            let jet = patch.jet(st);
            let point = jet.point - leaf.middle;
            Jet { point, ds: jet.ds * half[0], dt: jet.dt * half[1] }
        };
        let bound = |value: f32| f64::from(value) + 1e-15;
        for (x, y) in [(0.0, 0.0), (-1.2, 1.2), (1.1, 0.3), (0.4, -0.9)] {
            let s = true_jet(x, y);
            // Minus the surface's own point times the weight, nothing should be left.
            let (q, weight) = approximation(fitted, s.point, x, y);
            assert!(q.point.length() <= bound(leaf.fit_error()));
            assert!((weight * s.ds).distance(q.ds) <= bound(leaf.slope_error()));
            assert!((weight * s.dt).distance(q.dt) <= bound(leaf.slope_error()));
            for step in [1.0, 0.1, 0.01] {
                let (dx, dy) = (-step * x.signum(), 0.5 * step * y.signum());
                let (there, _) = approximation(fitted, s.point, x + dx, y - dy);
                let left = there.point - q.point - q.ds * dx + q.dt * dy;
                let rounding = 2.0 * leaf.fit_error() + 3.0 * leaf.slope_error();
                assert!(left.length() <= bound(leaf.fit_bend()) * step * step + bound(rounding));
            }
            for step in [1.0, 0.1, 0.01] {
                let (dx, dy) = (-step * x.signum(), 0.5 * step * y.signum());
                let left = true_jet(x + dx, y - dy).point - s.point - s.ds * dx + s.dt * dy;
                assert!(left.length() <= bound(leaf.fit_bend()) * step * step);
            }
            let st = DVec2::new(middle[0] + x * half[0], middle[1] + y * half[1]);
            let at = patch.derivatives(st);
            let (bend, third) = (f64::from(leaf.fit_bend()), leaf.fit_third());
            for step in [1.0, 0.1, 0.01] {
                let (dx, dy) = (-step * x.signum(), -0.7 * step * y.signum());
                let (ds, dt) = (dx * half[0], dy * half[1]);
                let (turn_s, turn_t) = (at.duu * ds + at.duv * dt, at.duv * ds + at.dvv * dt);
                let next = patch.jet(st + DVec2::new(ds, dt));
                let along = (at.du + 0.5 * turn_s) * ds + (at.dv + 0.5 * turn_t) * dt;
                let left = (next.point - at.point - along).length();
                assert!(left <= third * step.powi(3) + patch.noise(), "{left:e}");
                let (turned_s, turned_t) = (next.ds - at.du, next.dt - at.dv);
                let left =
                    (turned_s - turn_s).length() * half[0] + (turned_t - turn_t).length() * half[1];
                let most = 3.0 * third * step * step;
                assert!(left <= most + 8.0 * patch.noise(), "{left:e}");
                let turn = turn_s.length() * half[0] + turn_t.length() * half[1];
                assert!(turn <= 2.0 * bend * step + 8.0 * patch.noise(), "{turn:e}");
            }
        }
    }
}

/// `X − W o` of a piece, relative to a point, and its derivatives in `s` and in `t`, with a
/// weight of 1 at `middle`: from the control points.
fn true_form(patch: &TensorPatch, at: DVec2, middle: DVec2, origin: DVec3) -> [DVec3; 3] {
    let [p, q] = patch.degree();
    let net = patch.control_net();
    let sums = |st: DVec2| {
        let [s, t]: [Basis; 2] = [basis(p, st.x), basis(q, st.y)];
        let ds: Basis = derivative_from_lower(p, &basis(p - 1, st.x));
        let dt: Basis = derivative_from_lower(q, &basis(q - 1, st.y));
        [(s, t), (ds, t), (s, dt)].map(|(s, t)| {
            let term = |(k, &c): (usize, &DVec4)| s[k / (q + 1)] * t[k % (q + 1)] * c;
            net.iter().enumerate().map(term).sum::<DVec4>()
        })
    };
    let one = sums(middle)[0].w;
    sums(at).map(|sum| (sum.truncate() - sum.w * origin) / one)
}

/// The bounds of quotients are for all rays that may meet the leaf's box: also for points as far
/// from its middle as these pass, at which the weights matter most.
#[test]
fn bounds_of_quotients_hold_as_far_off_as_rays_may_pass() {
    let bends = |k: usize, x: f64, y: f64| {
        let weight = 1.0 + 0.5 * (2.4 * k as f64).sin();
        weight * DVec3::new(x, y, 0.2 * (3.0 * k as f64).cos()).extend(1.0)
    };
    let (mut asked, mut tightest) = (0, 0.0f64);
    for degree in [[1, 2], [2, 2], [3, 2], [3, 3]] {
        let (set, parts) = PatchSet::new(&[one_piece(degree, bends)]).unwrap();
        let frame = ScaledFrame::around(&set.bounds());
        for part in parts.all() {
            let patch = &set.pieces()[0].patch;
            let (leaf, weight, oriented) = Leaf::new(part, &set.pieces()[0], &frame);
            if weight == NO_WEIGHT {
                continue;
            }
            let reach = oriented.farthest_from(leaf.middle, &frame);
            let half = leaf.rect().map(|[from, to]| 0.5 * (to - from));
            let middle = DVec2::from_array(leaf.rect().map(|[from, to]| 0.5 * (from + to)));
            let st = |x: f64, y: f64| middle + DVec2::new(x * half[0], y * half[1]);
            let fitted = (leaf, weight);
            let bound = |value: f32| f64::from(value) + 1e-14;
            for toward in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.6, -0.8, 0.0)] {
                let off = reach * toward;
                let truth = |x, y| {
                    let [f, s, t] = true_form(patch, st(x, y), middle, fitted.0.middle + off);
                    [f, s * half[0], t * half[1]]
                };
                for (x, y) in [(0.0, 0.0), (-1.2, 1.2), (1.1, 0.3), (0.4, -0.9)] {
                    let [f, along_x, along_y] = truth(x, y);
                    let (near, _) = approximation(&fitted, off, x, y);
                    assert!(near.point.distance(f) <= bound(fitted.0.fit_error()));
                    assert!(near.ds.distance(along_x) <= bound(fitted.0.slope_error()));
                    assert!(near.dt.distance(along_y) <= bound(fitted.0.slope_error()));
                    let (dx, dy) = (-x.signum(), y.signum());
                    let [there, ..] = truth(x + dx, y - dy);
                    let left = (there - f - along_x * dx + along_y * dy).length();
                    let most = f64::from(fitted.0.fit_bend());
                    assert!(left <= most + 1e-14, "{degree:?}: {left} of {most}");
                    tightest = tightest.max(left / most);
                    asked += 1;
                }
            }
        }
    }
    assert!(asked > 500 && tightest > 0.2, "{asked} places, {tightest} of the bound");
}

#[test]
fn bounds_are_of_the_size_of_what_they_bound() {
    // A leaf of the sphere is rounded to f32.
    let (set, parts) = PatchSet::new(&[shapes::sphere(1.0).unwrap()]).unwrap();
    let leaves = leaves(&set, parts.all());
    let mut errors: Vec<f32> = leaves.iter().map(|(leaf, _)| leaf.fit_error()).collect();
    errors.sort_by(f32::total_cmp);
    let median = errors[errors.len() / 2];
    assert!((1e-9..1e-7).contains(&median), "{median}");
}

/// Nothing is known for rays whose distance from the middle is not known.
#[test]
fn nothing_is_known_without_a_reach() {
    let sizes = [[[0.1; 4]; 4]; 2];
    let error = |reach: f64| FitError::of_quotient(&sizes, ([0.1; 4], 0.5), reach, 1e-15);
    assert!(error(1.0).value < 1e-5);
    for reach in [f64::NAN, f64::INFINITY] {
        assert_eq!(error(reach).value, f64::INFINITY);
    }
}
