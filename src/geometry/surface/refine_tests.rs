//! The surface does not move: insertion, clamping, splitting, elevation, turning.

use glam::{DAffine3, DMat3, DVec2, DVec3};
use proptest::prelude::*;

use crate::geometry::*;

/// "Does not move": the distance between two nets' points, relative to the largest
/// coordinate of the net.
const STAYS: f64 = 1e-14;

fn magnitude(surface: &NurbsSurface) -> f64 {
    let [nu, nv] = surface.size();
    let points = (0..nu).flat_map(|i| (0..nv).map(move |j| surface.vertex(i, j).abs()));
    points.fold(0.0, |largest: f64, point| largest.max(point.max_element()))
}

/// Parameters over a domain: its ends, and places between that are no knots.
fn samples([a, b]: [f64; 2]) -> Vec<f64> {
    let at = |s: f64| (a + s * (b - a)).clamp(a, b);
    [0.0, 0.013, 0.207, 0.391, 0.483, 0.629, 0.777, 0.92, 0.999, 1.0].map(at).to_vec()
}

/// Asserts that two surfaces agree over the domain of the first, up to a map of parameters.
fn stays(a: &NurbsSurface, b: &NurbsSurface, map: impl Fn(f64, f64) -> (f64, f64)) {
    let most = STAYS * magnitude(a);
    let [domain_u, domain_v] = a.domain();
    for &u in &samples(domain_u) {
        for &v in &samples(domain_v) {
            let (s, t) = map(u, v);
            let off = (a.point_at(DVec2::new(u, v)) - b.point_at(DVec2::new(s, t))).length();
            assert!(off <= most, "at ({u}, {v}): off by {off:e} of {most:e}\n{a:?}\n{b:?}");
        }
    }
}

/// Knots of all kinds: clamped, unclamped, periodic, with repeated knots up to `p + 1`.
fn knots(degrees: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = KnotVector> {
    degrees
        .prop_flat_map(|p| {
            let steps = prop::collection::vec((0.05..2.0_f64, 1..=p + 1), 0..4);
            (Just(p), 0..3, steps, -3.0..3.0_f64)
        })
        .prop_map(|(p, kind, inner, first)| {
            let mut at = first;
            let mut values = match kind {
                0 => vec![at; p + 1],
                1 => (0..=p).map(|i| first - 0.3 * (p - i) as f64).collect(),
                _ => (0..=p).map(|i| first - 0.3 * ((p - i) / 2) as f64).collect(),
            };
            for (step, times) in inner {
                at += step;
                values.extend(std::iter::repeat_n(at, times));
            }
            at += 1.0;
            match kind {
                0 => values.extend(std::iter::repeat_n(at, p + 1)),
                1 => values.extend((0..=p).map(|i| at + 0.3 * i as f64)),
                _ => values.extend((0..=p).map(|i| at + 0.3 * (i / 2) as f64)),
            }
            KnotVector::new(p, values).unwrap()
        })
}

/// Surfaces with knots of all kinds, coordinates of one size from 1e-8 to 1e8.
fn surfaces(degrees: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = NurbsSurface> {
    (knots(degrees.clone()), knots(degrees), -8..=8, any::<bool>()).prop_flat_map(
        |(ku, kv, power, rational)| {
            let scale = 10.0_f64.powi(power);
            let count = ku.point_count() * kv.point_count();
            let points = prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), count);
            let weights = prop::collection::vec(0.05..4.0_f64, count);
            (points, weights).prop_map(move |(points, weights)| {
                let points = points.into_iter().map(|p| scale * DVec3::from(p)).collect();
                NurbsSurface::new(ku.clone(), kv.clone(), points, rational.then_some(weights))
                    .unwrap()
            })
        },
    )
}

fn few(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(few(64))]

    #[test]
    fn nothing_moves_a_surface(s in surfaces(1..=5), at in 0.0..1.0_f64, times in 1..5_usize) {
        let [[a, b], [c, d]] = s.domain();
        let (u, v) = (a + at * (b - a), c + at * (d - c));
        stays(&s, &s.clamped(), |u, v| (u, v));
        stays(&s, &s.bezier_form(), |u, v| (u, v));
        stays(&s, &s.insert_knot_u(u, times.min(s.knots_u().degree())).unwrap(), |u, v| (u, v));
        stays(&s, &s.insert_knot_v(v, times.min(s.knots_v().degree())).unwrap(), |u, v| (u, v));
        stays(&s, &s.elevated_u(times).unwrap(), |u, v| (u, v));
        stays(&s, &s.elevated_v(times).unwrap(), |u, v| (u, v));
        stays(&s, &s.swapped(), |u, v| (v, u));
    }
}

proptest! {
    #![proptest_config(few(64))]

    #[test]
    fn halves_are_the_whole_and_share_their_edge(s in surfaces(1..=5), at in 0.1..0.9_f64) {
        let [[a, b], [c, d]] = s.domain();
        let (u, v) = (a + at * (b - a), c + at * (d - c));
        let (below, above) = s.split_u(u).unwrap();
        prop_assert_eq!((below.domain()[0], above.domain()[0]), ([a, u], [u, b]));
        stays(&above, &s, |u, v| (u, v));
        let [n, _] = below.size();
        for j in 0..below.size()[1] {
            prop_assert_eq!(below.homogeneous(n - 1, j), above.homogeneous(0, j));
        }
        let (below, above) = s.split_v(v).unwrap();
        prop_assert_eq!((below.domain()[1], above.domain()[1]), ([c, v], [v, d]));
        stays(&above, &s, |u, v| (u, v));
        let [_, n] = below.size();
        for i in 0..below.size()[0] {
            prop_assert_eq!(below.homogeneous(i, n - 1), above.homogeneous(i, 0));
        }
    }

    #[test]
    fn maps_move_every_point_alike(
        s in surfaces(1..=4),
        m in prop::array::uniform9(-1.0..1.0_f64),
        shift in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let matrix = DMat3::from_cols_array(&m);
        prop_assume!(matrix.determinant().abs() > 1e-3);
        let map = DAffine3::from_mat3_translation(matrix, magnitude(&s) * DVec3::from(shift));
        let moved = s.transformed(&map).unwrap();
        let most = 4.0 * STAYS * magnitude(&s);
        for &u in &samples(s.domain()[0]) {
            for &v in &samples(s.domain()[1]) {
                let off = map.transform_point3(s.point_at(DVec2::new(u, v))) - moved.point_at(DVec2::new(u, v));
                prop_assert!(off.length() <= most, "at ({u}, {v}): off by {off}");
            }
        }
    }
}

proptest! {
    #![proptest_config(few(6))]

    #[test]
    fn nothing_moves_a_surface_of_high_degree(s in surfaces(12..=24), at in 0.1..0.9_f64) {
        let [a, b] = s.domain()[0];
        let u = a + at * (b - a);
        stays(&s, &s.clamped(), |u, v| (u, v));
        stays(&s, &s.bezier_form(), |u, v| (u, v));
        stays(&s, &s.insert_knot_u(u, s.knots_u().degree()).unwrap(), |u, v| (u, v));
        stays(&s, &s.elevated_u(3).unwrap(), |u, v| (u, v));
    }
}
