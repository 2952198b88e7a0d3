//! Points and normals of limit surfaces, computed directly from the cage by limit masks.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Cage;
use super::catmull_clark::refined;
use super::ring::Ring;

/// A point of a limit surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPoint {
    /// The position.
    pub point: DVec3,
    /// The unit normal at the point, outward for a cage oriented outward; `None` where the surface
    /// has no tangent plane.
    pub normal: Option<DVec3>,
}

impl Cage {
    /// The points of the Catmull–Clark limit surface for the vertices, by limit masks. They are
    /// listed per face, in the order of its corners, with the normal as seen from that face: the
    /// faces beside a crease see different normals.
    ///
    /// Source: Halstead, Kass & DeRose 1993; Biermann, Levin & Zorin 2000 for creases. At
    /// sharp corners where more than one face meets there is no tangent plane, as Biermann and
    /// others remark, and so no normal.
    pub fn catmull_clark_limits(&self) -> Vec<Vec<LimitPoint>> {
        let mesh = self.mesh();
        let topology = &mesh.topology;
        let all_quads = (0..topology.face_count()).all(|face| topology.face(face).len() == 4);
        let once = if all_quads { None } else { Some(refined(mesh)) };
        let ring = |vertex| Ring::of(mesh, vertex).or_else(|| Ring::of(once.as_ref()?, vertex));
        // One ring per vertex; its quads have the order of the corners of the vertex's star.
        let mut limits = vec![None; topology.corner_count()];
        for vertex in 0..topology.vertex_count() as u32 {
            let Some(ring) = ring(vertex) else { continue };
            let point = ring.limit();
            for (quad, &corner) in topology.star(vertex).corners.iter().enumerate() {
                limits[corner as usize] = Some(LimitPoint { point, normal: ring.normal(quad) });
            }
        }
        // None is missing: every corner is in the star of its vertex, and every vertex has a ring,
        // if not among its faces, then among the quads they are cut into.
        debug_assert!(limits.iter().all(Option::is_some));
        let of_face = |face| limits[topology.face_range(face)].iter().flatten().copied().collect();
        (0..topology.face_count()).map(of_face).collect()
    }

    /// The point of the Doo–Sabin limit surface for the middle of each face: the face's centroid,
    /// with the normal of the face's first Fourier mode (Doo & Sabin 1978).
    pub fn doo_sabin_limits(&self) -> Vec<LimitPoint> {
        let mesh = self.mesh();
        let of_face = |face: usize| {
            let vertices = mesh.topology.face(face);
            let angle = TAU / vertices.len() as f64;
            let mut tangents = [DVec3::ZERO; 2];
            let center = mesh.centroid(face);
            for (i, &vertex) in vertices.iter().enumerate() {
                let (sin, cos) = (angle * i as f64).sin_cos();
                let offset = mesh.positions[vertex as usize] - center;
                tangents[0] += cos * offset;
                tangents[1] += sin * offset;
            }
            let extent = tangents[0].length().max(tangents[1].length());
            let normal = super::ring::unit_normal(tangents[0], tangents[1], extent);
            LimitPoint { point: center, normal }
        };
        (0..mesh.topology.face_count()).map(of_face).collect()
    }
}
