//! Limit masks against refinement.

use super::*;

#[test]
fn refinement_keeps_limit_points_and_normals() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        let refined = cage.refined_catmull_clark();
        let (before, after) = (cage.catmull_clark_limits(), refined.catmull_clark_limits());
        let corners =
            (0..cage.face_count()).flat_map(|f| (0..before[f].len()).map(move |k| (f, k)));
        for (child, (face, k)) in corners.enumerate() {
            // The quad of a corner, and the position of the corner in it.
            let place = if before[face].len() == 4 { k } else { 0 };
            let (a, b) = (before[face][k], after[child][place]);
            assert!(a.point.distance(b.point) < 1e-14, "{name}, face {face}, corner {k}");
            match (a.normal, b.normal) {
                (Some(a), Some(b)) => assert!(a.distance(b) < 1e-9, "{name}, {face}, {k}: {a} {b}"),
                (a, b) => assert_eq!(a.is_some(), b.is_some(), "{name}, face {face}, corner {k}"),
            }
        }
    }
}

#[test]
fn vertices_of_much_refined_cages_are_near_their_limits() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        let mut refined = cage.clone();
        for _ in 0..5 {
            refined = refined.refined_catmull_clark();
        }
        let limits = cage.catmull_clark_limits();
        for (face, vertices) in parts.faces.iter().enumerate() {
            for (k, &vertex) in vertices.iter().enumerate() {
                // Each step leaves at most about 0.4 of the way: 0.4⁵ is 0.01.
                let left = refined.positions()[vertex].distance(limits[face][k].point);
                let way = cage.positions()[vertex].distance(limits[face][k].point);
                assert!(left <= 0.05 * way + 2e-3, "{name}, vertex {vertex}: {left} of {way}");
            }
        }
    }
}

#[test]
fn normals_are_those_of_the_patches() {
    for (name, parts) in zoo() {
        let cage = cage(&parts).refined_catmull_clark();
        let probe = Probe::new(cage.catmull_clark(1e-3).unwrap());
        let limits = cage.catmull_clark_limits();
        let mut seen = 0;
        for unit in 0..cage.face_count() {
            for (k, at) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].into_iter().enumerate()
            {
                let (patch, u, v) = probe.patch(unit, at).unwrap();
                if !probe.limit.patches()[patch].exact {
                    continue;
                }
                let by_patch = probe.surface(patch).normal(DVec2::new(u, v)).unwrap();
                let by_mask = limits[unit][k].normal.unwrap();
                assert!(by_patch.distance(by_mask) < 1e-12, "{name}: {by_patch} {by_mask}");
                seen += 1;
            }
        }
        assert!(seen > 0, "{name}");
    }
}

#[test]
fn normals_at_extraordinary_vertices_are_those_of_small_faces_there() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        let limits = cage.catmull_clark_limits();
        let mut refined = cage.clone();
        for _ in 0..6 {
            refined = refined.refined_catmull_clark();
        }
        let at = |vertex: u32| refined.positions()[vertex as usize];
        for (face, vertices) in parts.faces.iter().enumerate() {
            for (k, &vertex) in vertices.iter().enumerate() {
                let Some(normal) = limits[face][k].normal else { continue };
                // All small faces there are nearly in the tangent plane, or beyond a crease; around
                // smooth border vertices of a single face they approach it only as slowly as 1/6.
                let small = (0..refined.face_count()).map(|f| refined.face(f).unwrap());
                let touching = small.filter(|quad| quad.contains(&(vertex as u32)));
                let nearest = touching.map(|quad| {
                    let diagonals = [at(quad[2]) - at(quad[0]), at(quad[3]) - at(quad[1])];
                    diagonals[0].cross(diagonals[1]).normalize().distance(normal)
                });
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest < 0.17, "{name}, face {face}, corner {k}: {nearest}");
            }
        }
    }
}

/// Also where a crease ends, at every corner of faces refined five times: a patch that is near
/// enough may be turned, the more the smaller it is.
#[test]
fn normals_of_surfaces_for_pictures_are_near_everywhere() {
    const LEVELS: u32 = 5;
    let creases = vec![crease(61, 65, 5.0), crease(65, 69, 5.0)];
    let short = CageParts { creases, ..sheet_parts(32, 4, bumpy) };
    for (name, parts) in zoo().into_iter().chain([("short crease", short)]) {
        let cage = cage(&parts).refined_catmull_clark(); // all quads
        let probe = Probe::new(cage.catmull_clark(cage.default_tolerance()).unwrap());
        let mut refined = cage.clone();
        for _ in 0..LEVELS {
            refined = refined.refined_catmull_clark();
        }
        let (mut worst, mut compared) = (0.0_f64, 0);
        for (face, corners) in refined.catmull_clark_limits().iter().enumerate() {
            // The face's square in that of its unit: the quads of a quad keep its directions.
            let (mut unit, mut low, mut side) = (face, [0.0, 0.0], 1.0);
            for _ in 0..LEVELS {
                let [upper_u, upper_v] = [[0, 0], [1, 0], [1, 1], [0, 1]][unit % 4];
                low = [low[0] + side * f64::from(upper_u), low[1] + side * f64::from(upper_v)];
                (unit, side) = (unit / 4, 2.0 * side);
            }
            for (corner, [u, v]) in corners.iter().zip([[0., 0.], [1., 0.], [1., 1.], [0., 1.]]) {
                let at = [(low[0] + u) / side, (low[1] + v) / side];
                let (patch, u, v) = probe.patch(unit, at).unwrap();
                let normals = corner.normal.zip(probe.surface(patch).normal(DVec2::new(u, v)));
                // At the corner of a single face on a smooth border no two sides span a plane.
                let is_loose = name == "loose sheet" && at.iter().all(|x| x.fract() == 0.0);
                if let (Some((expected, found)), false) = (normals, is_loose) {
                    worst = worst.max(found.distance(expected));
                    compared += 1;
                }
            }
        }
        assert!(worst < 0.01, "{name}: {worst}");
        assert!(compared > 3 * refined.face_count(), "{name}: {compared}");
    }
}
