//! Limit surfaces as a whole: without gaps, evaluated by unit squares, reversed and moved.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DAffine3, DVec2};

use super::*;
use crate::geometry::{Charts, RectSide, Surface};

/// Both limit surfaces of all cages that have them.
fn limits(tolerance: f64) -> Vec<(String, Cage, LimitSurface)> {
    let mut limits = Vec::new();
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        limits.push((format!("{name} (cc)"), cage.clone(), cage.catmull_clark(tolerance).unwrap()));
        if let Ok(limit) = cage.doo_sabin(tolerance) {
            limits.push((format!("{name} (ds)"), cage, limit));
        }
    }
    limits
}

/// A point on a side of a patch, at a fraction of the side.
fn on_side(surface: &NurbsSurface, side: RectSide, share: f64) -> DVec3 {
    let domain = surface.domain();
    let [from, to] = domain[side.along()];
    let [u, v] = side.fixed().pair(side.value_in(&domain), from + share * (to - from));
    surface.point_at(DVec2::new(u, v))
}

/// The cell of a point in a grid much finer than patches and much coarser than rounding.
fn cell(point: DVec3) -> [i64; 3] {
    (point * 1e8 + DVec3::splat(0.3)).floor().to_array().map(|x| x as i64)
}

#[test]
fn every_side_that_is_no_border_meets_others_to_rounding_all_along() {
    for tolerance in [1e-2, 1e-3] {
        for (name, cage, limit) in limits(tolerance) {
            assert!(limit.deviation() <= 0.5 * tolerance, "{name}: {:e}", limit.deviation());
            let charts = limit.charts();
            // Where sides are halved up to six times, their quarters are at multiples of a 256th.
            let mut points: HashMap<[i64; 3], Vec<(usize, DVec3)>> = HashMap::new();
            for (k, chart) in charts.iter().enumerate() {
                let steps = |side| (0..=256).map(move |step| (side, f64::from(step) / 256.0));
                for (side, share) in RectSide::ALL.into_iter().flat_map(steps) {
                    let point = on_side(&chart.surface, side, share);
                    let near = points.entry(cell(point)).or_default();
                    // The same point of two patches is enough for all.
                    let mut known = near.iter().filter(|(_, known)| *known == point);
                    if known.clone().count() < 2 && known.all(|(other, _)| *other != k) {
                        near.push((k, point));
                    }
                }
            }
            let mut borders = 0;
            for (k, chart) in charts.iter().enumerate() {
                for side in RectSide::ALL {
                    borders += usize::from(chart.border[side]);
                    for step in 0..=4 {
                        let point = on_side(&chart.surface, side, f64::from(step) / 4.0);
                        let [x, y, z] = cell(point);
                        let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (a, b)));
                        let around = around.flat_map(|(a, b)| (-1..=1).map(move |c| [a, b, c]));
                        let near = around
                            .filter_map(|[a, b, c]| points.get(&[x + a, y + b, z + c]))
                            .flatten();
                        let met = near
                            .filter(|(other, _)| *other != k)
                            .map(|(_, other)| other.distance(point))
                            .fold(f64::INFINITY, f64::min);
                        let alone = chart.border[side];
                        assert!(alone || met < 1e-14, "{name} patch {k} {side:?}: {met:e}");
                    }
                }
            }
            assert_eq!(borders == 0, cage.is_closed(), "{name}");
        }
    }
}

#[test]
fn surfaces_are_their_charts() {
    let map = DAffine3::from_rotation_x(0.7) * DAffine3::from_scale(DVec3::new(2.0, -1.0, 0.5));
    for (name, cage, limit) in limits(1e-3) {
        let limit = Arc::new(limit);
        let plain = Surface::from(limit.clone());
        assert_eq!(Arc::strong_count(&limit), 2, "patches are shared");
        let units: usize = (0..cage.face_count())
            .map(|face| cage.face(face).map_or(0, |f| if f.len() == 4 { 1 } else { f.len() }))
            .sum();
        assert_eq!(plain.domain(), [[0.0, units as f64], [0.0, 1.0]]);
        let moved = plain.transformed(&map).unwrap();
        for (surface, map) in [(&plain, DAffine3::IDENTITY), (&moved, map)] {
            for chart in surface.charts() {
                let [u, v] = chart.surface.domain();
                for (s, t) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5), (0.6, 1.0), (1.0, 1.0)] {
                    let at = DVec2::new(u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0]));
                    let uv = chart.uv(at);
                    let (a, b) = (chart.surface.derivatives(at), surface.derivatives(uv));
                    let near = |a: DVec3, b: DVec3, bound: f64| {
                        assert!(a.distance(b) < bound, "{name} {uv}: {a} {b}");
                    };
                    near(a.point, b.point, 1e-13);
                    near(a.point, surface.point_at(uv), 1e-13);
                    near(a.du, b.du, 1e-9);
                    near(a.dv, b.dv, 1e-9);
                    near(a.duv, b.duv, 1e-5);
                    near(map.transform_point3(plain.point_at(uv)), a.point, 1e-13);
                    let distances = RectSide::distances(DVec2::new(s, t));
                    let mut sides = RectSide::ALL.into_iter();
                    let on_border = sides.any(|side| distances[side] == 0.0 && chart.border[side]);
                    assert_eq!(surface.on_border(uv), on_border, "{name} {uv}");
                }
            }
        }
        // Places a little off the surface belong to the patch beside them.
        for k in 0..64 {
            let (at, off, end) = (f64::from(k) / 64.0 + 0.003, -1e-17, units as f64);
            for [on, beside] in [
                [[at, 0.0], [at, off]],
                [[0.0, at], [off, at]],
                [[end.next_down(), at], [end, at]],
                [[at, 1.0], [at, 1.0_f64.next_up()]],
            ] {
                let [a, b] = [on, beside].map(|uv| plain.derivatives(DVec2::from_array(uv)));
                assert!(a.point.distance(b.point) < 1e-13, "{name} {beside:?}");
                assert!(a.du.distance(b.du).max(a.dv.distance(b.dv)) < 1e-9, "{name} {beside:?}");
            }
        }
        // Reversal exchanges u and v within each unit square.
        let turned = plain.reversed();
        assert_eq!(turned.reversed(), plain);
        for k in 0..64 {
            let (u, v) = (f64::from(k % 8) / 8.0 + 0.01, f64::from(k / 8) / 8.0 + 0.02);
            let unit = (k as usize % units) as f64;
            let [here, there] = [DVec2::new(unit + u, v), DVec2::new(unit + v, u)];
            if plain.point_at(here).distance(turned.point_at(there)) < 1e-13 {
                let normals = plain.normal(here).zip(turned.normal(there));
                assert!(normals.is_none_or(|(a, b)| a.distance(-b) < 1e-9));
            } else {
                // Only where there is no surface: a Doo–Sabin surface ends inside its cage.
                assert!(name.contains("(ds)") && !cage.is_closed(), "{name} {here}");
            }
        }
    }
}

#[test]
fn what_becomes_of_a_cage_that_is_moved_too_far() {
    let limit = cage(&cube_parts()).catmull_clark(1e-3).unwrap();
    let message = |map: DAffine3| limit.transformed(&map).unwrap_err().to_string();
    assert_eq!(
        message(DAffine3::from_scale(DVec3::new(1e71, 1.0, 1.0))),
        "vertex 0 is (-1e71, -1, -1): coordinates must be finite (up to 1e70)"
    );
    assert_eq!(
        message(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))),
        "the transform's determinant is 0: it must be neither 0 nor infinite"
    );
    assert_eq!(
        message(DAffine3::from_translation(DVec3::splat(1e20))),
        "all control points are (1e20, 1e20, 1e20): the surface has no extent"
    );
}
