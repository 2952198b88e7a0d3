//! Catmull–Clark patches against B-splines, limit masks, and brute-force refinement.

use glam::{DVec2, DVec3};

use super::*;
use crate::geometry::KnotVector;

/// The cage after this many steps of refinement, and the squares of its faces, which are quads from
/// the first step on.
fn refined_squares(cage: &Cage, steps: usize) -> (Cage, Vec<FaceRect>) {
    let sides: Vec<usize> = (0..cage.face_count()).map(|f| cage.face(f).unwrap().len()).collect();
    let mut squares = Vec::new();
    let mut unit = 0;
    for (face, &sides) in sides.iter().enumerate() {
        for k in 0..sides {
            squares.push(match sides {
                4 => FaceRect::whole(face, unit).quarter(k),
                _ => FaceRect::whole(face, unit + k),
            });
        }
        unit += if sides == 4 { 1 } else { sides };
    }
    let mut refined = cage.refined_catmull_clark();
    for _ in 1..steps {
        refined = refined.refined_catmull_clark();
        squares = squares.iter().flat_map(|s| (0..4).map(|k| s.quarter(k))).collect();
    }
    (refined, squares)
}

#[test]
fn patches_pass_where_the_masks_of_a_refined_cage_say() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        for tolerance in [1e-2, 1e-5] {
            let probe = Probe::new(cage.catmull_clark(tolerance).unwrap());
            assert!(probe.limit.deviation() <= 0.5 * tolerance, "{name}");
            let steps = if tolerance == 1e-2 { 6 } else { 4 };
            let (refined, squares) = refined_squares(&cage, steps);
            let limits = refined.catmull_clark_limits();
            let mut worst = 0.0_f64;
            for (face, square) in squares.iter().enumerate().step_by(7) {
                for (k, [u, v]) in
                    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].iter().enumerate()
                {
                    let at = square.unit_uv(DVec2::new(*u, *v)).to_array();
                    let (point, deviation) = probe.point(square.unit, at).unwrap();
                    let error = point.distance(limits[face][k].point);
                    worst = worst.max(error - deviation);
                }
            }
            assert!(worst < 1e-13, "{name} at {tolerance}: {worst:e} beyond the bound");
        }
    }
}

#[test]
fn bounds_are_not_idle() {
    // Somewhere the patches deviate by a good part of the reported bound.
    let cage = cage(&cube_parts());
    let probe = Probe::new(cage.catmull_clark(1e-2).unwrap());
    let (refined, squares) = refined_squares(&cage, 7);
    let limits = refined.catmull_clark_limits();
    let errors = squares.iter().enumerate().map(|(face, square)| {
        let (point, _) = probe.point(square.unit, square.low).unwrap();
        point.distance(limits[face][0].point)
    });
    let worst = errors.fold(0.0, f64::max);
    let reported = probe.limit.deviation();
    assert!(worst > 0.1 * reported && worst <= reported, "{worst:e} of {reported:e}");
}

#[test]
fn a_sheet_is_the_uniform_bicubic_spline() {
    for scale in [1e-8, 1.0, 1e8] {
        let (nu, nv) = (6, 5);
        let at = |i: usize, j: usize| scale * bumpy(i, j);
        let cage = cage(&sheet_parts(nu, nv, at));
        let probe = Probe::new(cage.catmull_clark(1e-3 * scale).unwrap());
        assert_eq!(probe.limit.exact_count(), (nu - 1) * (nv - 1));
        assert_eq!(probe.limit.patches().len(), (nu - 1) * (nv - 1));

        // The B-spline with mirrored points beyond the border.
        let mirrored = |k: usize, n: usize| -> Vec<(usize, f64)> {
            match k {
                0 => vec![(0, 2.0), (1, -1.0)],
                _ if k == n + 1 => vec![(n - 1, 2.0), (n - 2, -1.0)],
                _ => vec![(k - 1, 1.0)],
            }
        };
        let point = |k: usize| {
            let (rows, columns) = (mirrored(k / (nv + 2), nu), mirrored(k % (nv + 2), nv));
            let pairs = rows.iter().flat_map(|a| columns.iter().map(move |b| (a, b)));
            pairs.map(|(a, b)| a.1 * b.1 * at(a.0, b.0)).sum::<DVec3>()
        };
        let points = (0..(nu + 2) * (nv + 2)).map(point).collect();
        let knots = |n| KnotVector::uniform(3, n + 2).unwrap();
        let spline = NurbsSurface::new(knots(nu), knots(nv), points, None).unwrap();
        let low = spline.domain().map(|[low, _]| low);
        for unit in 0..(nu - 1) * (nv - 1) {
            let (i, j) = ((unit / (nv - 1)) as f64, (unit % (nv - 1)) as f64);
            for k in 0..25 {
                let (u, v) = (f64::from(k / 5) / 4.0, f64::from(k % 5) / 4.0);
                let (ours, _) = probe.point(unit, [u, v]).unwrap();
                let theirs = spline.point_at(DVec2::new(low[0] + i + u, low[1] + j + v));
                assert!(ours.distance(theirs) < 1e-14 * scale * 10.0, "{ours} {theirs}");
            }
        }
    }
}

#[test]
fn the_cubes_limit_points() {
    let cage = cage(&cube_parts());
    for corner in cage.catmull_clark_limits().iter().flatten() {
        assert!((corner.point.abs() - 0.5).abs().max_element() < 1e-15);
        let outward = corner.point.signum() / 3_f64.sqrt();
        assert!(corner.normal.unwrap().distance(outward) < 1e-14);
    }
    let probe = Probe::new(cage.catmull_clark(1e-6).unwrap());
    for unit in 0..6 {
        // Masks worked out by hand: 68/81 above the middle of a face, 395/648 above an edge.
        let (middle, _) = probe.point(unit, [0.5, 0.5]).unwrap();
        assert!((middle.length() - 68.0 / 81.0).abs() < 1e-14);
        let (edge, _) = probe.point(unit, [0.5, 0.0]).unwrap();
        assert!((edge.abs().max_element() - 395.0 / 648.0).abs() < 1e-14, "{edge}");
    }
}

#[test]
fn creases_and_borders_are_cubic_splines() {
    // The rim of the cube's face 1, which runs 4, 5, 7, 6.
    let (_, rim) = zoo().swap_remove(1);
    let probe = Probe::new(cage(&rim).catmull_clark(1e-4).unwrap());
    let ring = [4, 5, 7, 6].map(|k| rim.positions[k]);
    let spline = |k: usize, t: f64| {
        let [a, b, c, d] = [3, 0, 1, 2].map(|offset| ring[(k + offset) % 4]);
        let s = 1.0 - t;
        let [wa, wd] = [s * s * s / 6.0, t * t * t / 6.0];
        let wb = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
        wa * a + wb * b + (1.0 - wa - wb - wd) * c + wd * d
    };
    for k in 0..4 {
        for step in 0..=32 {
            let t = f64::from(step) / 32.0;
            let at = [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][k];
            let (point, deviation) = probe.point(1, at).unwrap();
            assert!(point.distance(spline(k, t)) <= deviation + 1e-14);
        }
    }
}

/// The place at `t` along the border of a quad, starting at its corner k.
fn on_border(k: usize, t: f64) -> [f64; 2] {
    [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][k]
}

#[test]
fn closed_cages_are_watertight_to_the_tolerance() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        if parts.faces.iter().any(|face| face.len() != 4) {
            continue;
        }
        let tolerance = 1e-4;
        let probe = Probe::new(cage.catmull_clark(tolerance).unwrap());
        let edge = |face: usize, k: usize| [parts.faces[face][k], parts.faces[face][(k + 1) % 4]];
        let mut widest = 0.0_f64;
        for (face, k) in (0..parts.faces.len()).flat_map(|f| (0..4).map(move |k| (f, k))) {
            let [a, b] = edge(face, k);
            let mut others = (0..parts.faces.len()).flat_map(|f| (0..4).map(move |k| (f, k)));
            let Some((other, l)) = others.find(|&(f, k)| edge(f, k) == [b, a]) else { continue };
            for step in 0..=64 {
                let t = f64::from(step) / 64.0;
                let here = probe.point(face, on_border(k, t)).unwrap().0;
                let there = probe.point(other, on_border(l, 1.0 - t)).unwrap().0;
                widest = widest.max(here.distance(there));
            }
        }
        assert!(widest <= tolerance, "{name}: a gap of {widest:e}");
    }
}

#[test]
fn exact_neighbours_share_their_border_bit_for_bit() {
    let (nu, nv) = (7, 5);
    let limit = cage(&torus_parts(nu, nv)).catmull_clark(1e-3).unwrap();
    assert_eq!(limit.exact_count(), nu * nv);
    let net = |i: usize, j: usize| limit.control((i % nu) * nv + j % nv).unwrap();
    for (i, j) in (0..nu * nv).map(|k| (k / nv, k % nv)) {
        for k in 0..4 {
            assert_eq!(net(i, j)[12 + k], net(i + 1, j)[k]); // u = 1 and u = 0
            assert_eq!(net(i, j)[4 * k + 3], net(i, j + 1)[4 * k]); // v = 1 and v = 0
        }
    }
    // Wherever two patches around an extraordinary vertex have the same two ends of a border.
    let limit = cage(&cube_parts()).catmull_clark(1e-3).unwrap();
    let borders = [[0, 4, 8, 12], [12, 13, 14, 15], [15, 11, 7, 3], [3, 2, 1, 0]];
    let all: Vec<[DVec3; 4]> = (0..limit.patches().len())
        .flat_map(|k| borders.map(|border| border.map(|place| limit.control(k).unwrap()[place])))
        .collect();
    let mut shared = 0;
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            if a[0].distance(b[3]) < 1e-9 && a[3].distance(b[0]) < 1e-9 {
                assert_eq!(*a, [b[3], b[2], b[1], b[0]]);
                shared += 1;
            }
        }
    }
    assert!(shared > limit.patches().len(), "{shared}");
}

#[test]
fn the_squares_of_a_surface_cover_each_face_once() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        let limit = cage.catmull_clark(1e-4).unwrap();
        let mut area = vec![0.0; units(&cage).len()];
        for patch in limit.patches() {
            area[patch.rect.unit] += patch.rect.size[0] * patch.rect.size[1];
            assert_eq!(patch.rect.face, units(&cage)[patch.rect.unit].0, "{name}");
        }
        assert!(area.iter().all(|&area| area == 1.0), "{name}: {area:?}");
    }
}

#[test]
fn straight_semi_sharp_creases_are_a_few_strips() {
    let (nu, nv) = (6, 5);
    let rings = |creases: &[(usize, f64)]| {
        let around = |&(j, sharpness): &(usize, f64)| {
            (0..nu).map(move |i| crease(i * nv + j, (i + 1) % nu * nv + j, sharpness))
        };
        let creases = creases.iter().flat_map(around).collect();
        cage(&CageParts { creases, ..torus_parts(nu, nv) })
    };
    let count = |creases: &[(usize, f64)]| {
        let cage = rings(creases);
        let limit = cage.catmull_clark(1e-6).unwrap();
        assert_eq!(limit.exact_count(), limit.patches().len());
        limit.patches().len()
    };
    let plain = nu * nv;
    assert_eq!(count(&[]), plain);
    assert_eq!(count(&[(1, SHARP)]), plain);
    // A strip more for each step, on each side.
    assert_eq!(count(&[(1, 1.0)]), plain + 2 * nu);
    assert_eq!(count(&[(1, 5.0)]), plain + 2 * 5 * nu);
    assert_eq!(count(&[(1, 5.1)]), plain + 2 * 6 * nu);
    // Between two creases the first halves serve both.
    assert_eq!(count(&[(1, 3.0), (2, 4.0)]), plain + (3 + 6 + 4) * nu);
    assert_eq!(count(&[(1, 3.0), (2, SHARP)]), plain + 2 * 3 * nu);
    // One patch is near enough to stand for all.
    let rounded = rings(&[(1, 6.0)]);
    let count = |tolerance| rounded.catmull_clark(tolerance).unwrap().patches().len();
    assert_eq!([1e-2, 3e-2].map(count), [plain + 2 * 6 * nu, plain]);
    // Every strip lies where it should: compare with masks.
    let cage = rings(&[(1, 2.3), (2, 1.0), (4, 0.4)]);
    let probe = Probe::new(cage.catmull_clark(1e-6).unwrap());
    let (refined, squares) = refined_squares(&cage, 5);
    let limits = refined.catmull_clark_limits();
    for (face, square) in squares.iter().enumerate() {
        let (point, _) = probe.point(square.unit, square.low).unwrap();
        assert!(point.distance(limits[face][0].point) < 1e-14);
    }
}

#[test]
fn scaled_cages_have_scaled_patches() {
    let parts = pyramid_parts(5);
    let plain = cage(&parts).catmull_clark(1e-4).unwrap();
    for scale in [1e-8, 1e8] {
        let positions = parts.positions.iter().map(|p| scale * *p).collect();
        let scaled = cage(&CageParts { positions, ..parts.clone() });
        let scaled = scaled.catmull_clark(1e-4 * scale).unwrap();
        assert_eq!(scaled.patches().len(), plain.patches().len());
        for patch in 0..plain.patches().len() {
            let (a, b) = (plain.control(patch).unwrap(), scaled.control(patch).unwrap());
            for (a, b) in a.iter().zip(b) {
                assert!((scale * *a).distance(*b) < 1e-14 * scale);
            }
        }
    }
}

#[test]
fn a_smaller_tolerance_costs_a_few_patches_more() {
    let cage = cage(&cube_parts());
    let counts = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8].map(|tolerance| {
        let limit = cage.catmull_clark(tolerance).unwrap();
        let exact = limit.exact_count();
        assert_eq!(limit.patches().len() - exact, 24, "one beside each corner of each face");
        exact
    });
    // Three more around each of the 24 corners for each step of refinement; one or two steps more
    // where borders moved to meet would otherwise be too far off.
    assert!(counts.iter().all(|count| count % 72 == 0));
    assert_eq!(counts, [216, 432, 864, 792, 936, 1368]);
}
