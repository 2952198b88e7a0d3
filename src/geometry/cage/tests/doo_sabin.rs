//! Doo–Sabin patches against B-splines and brute-force refinement.

use glam::{DVec2, DVec3};

use super::*;
use crate::geometry::{KnotVector, LimitError};

#[test]
fn a_sheet_is_the_uniform_biquadratic_spline() {
    for scale in [1e-8, 1.0, 1e8] {
        let (nu, nv) = (5, 6);
        let at = |i: usize, j: usize| scale * bumpy(i, j);
        let cage = cage(&sheet_parts(nu, nv, at));
        let probe = Probe::new(cage.doo_sabin(1e-3 * scale).unwrap());
        assert_eq!(probe.limit.patches().len(), 4 * (nu - 2) * (nv - 2));
        assert_eq!(probe.limit.exact_count(), probe.limit.patches().len());
        let points = (0..nu * nv).map(|k| at(k / nv, k % nv)).collect();
        let knots = |n| KnotVector::uniform(2, n).unwrap();
        let spline = NurbsSurface::new(knots(nu), knots(nv), points, None).unwrap();
        let low = spline.domain().map(|[low, _]| low);
        for unit in 0..(nu - 1) * (nv - 1) {
            let (i, j) = ((unit / (nv - 1)) as f64, (unit % (nv - 1)) as f64);
            for k in 0..25 {
                let (u, v) = (f64::from(k / 5) / 4.0, f64::from(k % 5) / 4.0);
                // The spline begins half a face inside, and so do the patches.
                let Some((ours, _)) = probe.point(unit, [u, v]) else { continue };
                let theirs =
                    spline.point_at(DVec2::new(low[0] + i + u - 0.5, low[1] + j + v - 0.5));
                assert!(ours.distance(theirs) < 1e-13 * scale, "{unit} {u} {v}: {ours} {theirs}");
            }
        }
    }
}

/// The smallest distance of a point from the patches, by searching ever more finely around the
/// nearest of a few samples.
fn distance(probe: &Probe, point: DVec3) -> f64 {
    let samples = || (0..25).map(|k| [f64::from(k / 5) / 4.0, f64::from(k % 5) / 4.0]);
    let far =
        |patch: usize, at: [f64; 2]| probe.surface(patch).point_at(DVec2::from(at)).distance(point);
    let mut starts: Vec<(f64, usize, [f64; 2])> = (0..probe.limit.patches().len())
        .filter_map(|patch| {
            let all = samples().map(|at| (far(patch, at), patch, at));
            all.min_by(|a, b| a.0.total_cmp(&b.0))
        })
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let closest = starts.into_iter().take(8).map(|(mut nearest, patch, mut middle)| {
        let mut side = 0.25;
        while side > 1e-9 {
            for [i, j] in samples() {
                let at = [middle[0] + side * (2.0 * i - 1.0), middle[1] + side * (2.0 * j - 1.0)];
                let at = at.map(|t| t.clamp(0.0, 1.0));
                if far(patch, at) < nearest {
                    (nearest, middle) = (far(patch, at), at);
                }
            }
            side *= 0.7;
        }
        nearest
    });
    closest.fold(f64::INFINITY, f64::min)
}

#[test]
fn middles_of_faces_of_a_refined_cage_are_on_the_surface() {
    for (name, parts) in zoo() {
        let parts = CageParts { creases: Vec::new(), corners: Vec::new(), ..parts };
        let cage = cage(&parts);
        let tolerance = 1e-3;
        let probe = Probe::new(cage.doo_sabin(tolerance).unwrap());
        assert!(probe.limit.deviation() <= 0.5 * tolerance, "{name}");
        let mut refined = cage.clone();
        for _ in 0..6 {
            refined = refined.refined_doo_sabin();
        }
        // A face's centroid never moves; it is on the surface if the face has a vertex inside.
        let topology = &refined.mesh().topology;
        let inside =
            |face: &usize| topology.face(*face).iter().any(|&vertex| topology.star(vertex).closed);
        let limits = refined.doo_sabin_limits();
        let faces: Vec<usize> = (0..limits.len()).filter(inside).collect();
        for &face in faces.iter().step_by(faces.len() / 40 + 1) {
            let limit = limits[face];
            let far = distance(&probe, limit.point);
            assert!(far <= 0.5 * tolerance, "{name}: {far:e}");
        }
    }
}

#[test]
fn centroids_and_normals_of_faces_last() {
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        let refined = cage.refined_doo_sabin();
        let (before, after) = (cage.doo_sabin_limits(), refined.doo_sabin_limits());
        for (a, b) in before.iter().zip(&after) {
            assert!(a.point.distance(b.point) < 1e-14, "{name}");
            assert!(a.normal.unwrap().distance(b.normal.unwrap()) < 1e-12, "{name}");
        }
    }
    let cube = cage(&cube_parts());
    for limit in cube.doo_sabin_limits() {
        assert_eq!(limit.point.length(), 1.0);
        assert!(limit.normal.unwrap().distance(limit.point) < 1e-15);
    }
}

#[test]
fn squares_meet_where_those_of_the_cage_do() {
    for (name, parts) in zoo() {
        if parts.faces.iter().any(|face| face.len() != 4) {
            continue;
        }
        let parts = CageParts { creases: Vec::new(), corners: Vec::new(), ..parts };
        let cage = cage(&parts);
        let tolerance = 1e-4;
        let probe = Probe::new(cage.doo_sabin(tolerance).unwrap());
        let limits = cage.doo_sabin_limits();
        let edge = |face: usize, k: usize| [parts.faces[face][k], parts.faces[face][(k + 1) % 4]];
        let border = |k: usize, t: f64| [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][k];
        let all: Vec<_> =
            (0..parts.faces.len()).flat_map(|f| (0..4).map(move |k| (f, k))).collect();
        let mut seen = 0;
        for &(face, k) in &all {
            if let Some((middle, deviation)) = probe.point(face, [0.5, 0.5]) {
                assert!(middle.distance(limits[face].point) <= deviation + 1e-14, "{name}");
            }
            let [a, b] = edge(face, k);
            let Some(&(other, l)) = all.iter().find(|&&(f, k)| edge(f, k) == [b, a]) else {
                continue;
            };
            for step in 0..=64 {
                let t = f64::from(step) / 64.0;
                let (here, there) =
                    (probe.point(face, border(k, t)), probe.point(other, border(l, 1.0 - t)));
                let (Some(here), Some(there)) = (here, there) else { continue };
                assert!(here.0.distance(there.0) <= tolerance, "{name}");
                seen += 1;
            }
        }
        assert!(seen > 0, "{name}");
    }
}

#[test]
fn a_torus_is_exact_and_shares_its_borders() {
    let limit = cage(&torus_parts(6, 5)).doo_sabin(1e-3).unwrap();
    assert_eq!(limit.exact_count(), 4 * 6 * 5);
    let borders = [[0, 3, 6], [6, 7, 8], [8, 5, 2], [2, 1, 0]];
    let all: Vec<[DVec3; 3]> = (0..limit.patches().len())
        .flat_map(|k| borders.map(|border| border.map(|place| limit.control(k).unwrap()[place])))
        .collect();
    // Each border has exactly one other that runs along it the other way.
    for a in &all {
        let mates = all.iter().filter(|b| [b[2], b[1], b[0]] == *a);
        assert_eq!(mates.count(), 1);
    }
}

#[test]
fn what_the_scheme_does_not_know_is_refused() {
    let refuse = |parts: &CageParts| cage(parts).doo_sabin(1e-3).unwrap_err();
    let creased = CageParts { creases: vec![crease(0, 1, 2.0)], ..cube_parts() };
    assert_eq!(refuse(&creased), LimitError::Sharp { edges: 1, vertices: 0 });
    assert_eq!(refuse(&sheet_parts(2, 5, bumpy)), LimitError::NothingInside);
    // A tetrahedron with a vertex on one of its edges.
    let faces = [&[0, 4, 1, 2][..], &[1, 4, 0, 3], &[0, 2, 3], &[1, 3, 2]];
    let positions = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 0, 0]];
    let split = CageParts {
        positions: positions.map(|p| glam::IVec3::from_array(p).as_dvec3()).to_vec(),
        faces: faces.map(<[usize]>::to_vec).to_vec(),
        ..CageParts::default()
    };
    assert_eq!(refuse(&split), LimitError::TwoFaces { vertex: 4 });
}
