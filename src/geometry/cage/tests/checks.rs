//! Invalid cages, with one message each.

use super::*;

fn refuse(parts: CageParts) -> String {
    Cage::new(parts).unwrap_err().to_string()
}

fn with_faces(faces: &[&[usize]], vertices: usize) -> CageParts {
    let faces = faces.iter().map(|face| face.to_vec()).collect();
    CageParts { positions: (0..vertices).map(noisy).collect(), faces, ..CageParts::default() }
}

#[test]
fn faces_at_fault() {
    assert_eq!(refuse(with_faces(&[], 3)), "the cage has no faces");
    assert_eq!(
        refuse(with_faces(&[&[0, 1, 2], &[0, 2]], 3)),
        "face 1 has 2 corners: it needs 3 or more"
    );
    assert_eq!(
        refuse(with_faces(&[&[0, 1, 9]], 3)),
        "face 0 names vertex 9, but there are only 3 vertices"
    );
    assert_eq!(
        refuse(with_faces(&[&[0, 1, 2, 1]], 3)),
        "face 0 names vertex 1 twice: its corners must differ"
    );
}

#[test]
fn edges_and_vertices_at_fault() {
    assert_eq!(
        refuse(with_faces(&[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]], 5)),
        "the edge between vertices 0 and 1 belongs to faces 0, 1 and 2: at most two may share \
         an edge"
    );
    assert_eq!(
        refuse(with_faces(&[&[0, 1, 2], &[0, 1, 3]], 4)),
        "faces 0 and 1 both run from vertex 0 to vertex 1: one of them is inside out"
    );
    for back in [[2, 1, 0], [0, 1, 2]] {
        assert_eq!(
            refuse(with_faces(&[&[0, 1, 2], &back], 3)),
            "faces 0 and 1 have the same vertices: they would cover each other"
        );
    }
    assert_eq!(refuse(with_faces(&[&[0, 1, 2]], 4)), "vertex 3 belongs to no face");
    assert_eq!(
        refuse(with_faces(&[&[0, 1, 2], &[0, 3, 4]], 5)),
        "vertex 0: its 2 faces form separate fans (one of 1) that touch in this vertex only"
    );
}

#[test]
fn numbers_at_fault() {
    for (bad, shown) in [(f64::NAN, "NaN"), (f64::NEG_INFINITY, "-inf"), (1e71, "1e71")] {
        let mut parts = cube_parts();
        parts.positions[5].y = bad;
        assert_eq!(
            refuse(parts),
            format!("vertex 5 is (1, {shown}, 1): coordinates must be finite (up to 1e70)")
        );
    }
    let creased = |creases: &[Crease]| CageParts { creases: creases.to_vec(), ..cube_parts() };
    assert_eq!(
        refuse(creased(&[crease(0, 1, 1.0), crease(0, 3, 1.0)])),
        "crease 1: there is no edge between vertices 0 and 3"
    );
    for bad in [-1.0, 10.5, f64::NAN] {
        assert_eq!(
            refuse(creased(&[crease(0, 1, bad)])),
            format!("crease 0 has sharpness {bad}: it must be from 0 to 10, or infinite")
        );
    }
    assert_eq!(
        refuse(creased(&[crease(0, 1, 1.0), crease(1, 0, 2.0)])),
        "crease 1 gives sharpness 2 to what has sharpness 1 already"
    );
    let corners = vec![Corner { vertex: 8, sharpness: 1.0 }];
    assert_eq!(
        refuse(CageParts { corners, ..cube_parts() }),
        "corner 0 names vertex 8, but there are only 8 vertices"
    );
}

#[test]
fn tolerances_that_cannot_be() {
    let cube = cage(&cube_parts());
    for (bad, shown) in
        [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf"), (1e-12, "1e-12")]
    {
        assert_eq!(
            cube.catmull_clark(bad).unwrap_err().to_string(),
            format!(
                "tolerance {shown}: for a cage of this size with coordinates up to 1 it must be finite and at \
                 least 1e-9"
            )
        );
        assert!(cube.doo_sabin(bad).is_err());
    }
    assert!(cube.catmull_clark(cube.default_tolerance()).is_ok());
}

#[test]
fn cages_in_a_point_or_on_a_line_have_no_surface() {
    let message = |at: &dyn Fn(DVec3) -> DVec3| {
        let parts = cube_parts();
        let positions = parts.positions.iter().map(|&p| at(p)).collect();
        let cage = cage(&CageParts { positions, ..parts });
        let tolerance = cage.default_tolerance();
        let [a, b] = [cage.catmull_clark(tolerance), cage.doo_sabin(tolerance)];
        let [a, b] = [a, b].map(|limit| limit.unwrap_err().to_string());
        assert_eq!(a.split(' ').take(4).last(), b.split(' ').take(4).last());
        b
    };
    assert_eq!(
        message(&|_| DVec3::new(1.0, 2.0, 3.0)),
        "all control points are (1, 2, 3): the surface has no extent"
    );
    assert_eq!(
        message(&|_| DVec3::ZERO),
        "all control points are (0, 0, 0): the surface has no extent"
    );
    assert!(message(&|p| p.x * DVec3::X).contains("lie on the line from"));
}

#[test]
fn cages_tell_what_they_are() {
    let cube = cage(&cube_parts());
    assert_eq!((cube.face_count(), cube.edge_count(), cube.positions().len()), (6, 12, 8));
    assert!(cube.is_closed() && cube.edge_sharpness().iter().all(|&s| s == 0.0));
    assert_eq!((cube.face(0), cube.face(6)), (Some(&[0, 2, 3, 1][..]), None));
    let sheet = cage(&sheet_parts(2, 2, bumpy));
    assert!(!sheet.is_closed());
    assert_eq!(sheet.edge_sharpness(), [SHARP; 4]);
    assert_eq!(sheet.vertex_sharpness(), [SHARP; 4]);
    let once = cube.refined_catmull_clark();
    assert_eq!((once.face_count(), once.edge_count(), once.positions().len()), (24, 48, 26));
    let once = pyramid_cage().refined_doo_sabin();
    assert_eq!((once.face_count(), once.positions().len()), (6 + 10 + 6, 20));
}

fn pyramid_cage() -> Cage {
    cage(&pyramid_parts(5))
}

#[test]
fn cages_far_from_the_origin_are_known_as_well_as_near_it() {
    let far = DVec3::new(5e5, 4.6e6, 100.0);
    for (half, share) in [(1.0, 1e-4), (0.05, 1e-4), (0.01, 2.5e-4), (1e-4, 2.5e-2)] {
        let parts = cube_parts();
        let moved = |offset: DVec3| {
            let positions = parts.positions.iter().map(|&p| half * p + offset).collect();
            cage(&CageParts { positions, ..parts.clone() })
        };
        let (here, there) = (moved(DVec3::ZERO), moved(far));
        let tolerance = there.default_tolerance();
        assert!(tolerance <= 1.001 * share * 2.0 * half, "{tolerance:e} for {half}");
        let limits = [&here, &there].map(|cage| cage.catmull_clark(tolerance).unwrap());
        let [here, there] = limits.each_ref().map(|limit| limit.patches());
        assert_eq!(here.len(), there.len(), "{half}");
        assert!(limits[1].deviation() <= 0.5 * tolerance);
    }
}
