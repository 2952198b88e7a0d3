//! Rays in the packets Embree reads and writes.

use glam::{DVec2, DVec3, Vec3};

use super::mesh::{GridMesh, MeshPoint};
use crate::intersect::Coherence;
use crate::math::{Ray, rounding};
use crate::patch::ScaledFrame;

/// How meshes are given to Embree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmbreePrimitive {
    /// `RTC_GEOMETRY_TYPE_GRID`, Embree's compact form, and `RTC_GEOMETRY_TYPE_TRIANGLE` for the
    /// faces of a mesh, which belong to no grid.
    Grid,
    /// `RTC_GEOMETRY_TYPE_TRIANGLE`, two triangles a cell, as
    /// [`GridMesh::triangles`](super::mesh::GridMesh::triangles) lists them.
    Triangle,
}

/// How many rays Embree is given at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketWidth {
    /// `rtcIntersect1`, `rtcOccluded1`.
    One,
    /// `rtcIntersect8`, `rtcOccluded8`.
    Eight,
    /// `rtcIntersect16`, `rtcOccluded16`.
    Sixteen,
}

/// The first meeting of a ray and a mesh, as Embree reports it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmbreeHit {
    /// The ray parameter, in units of the direction given.
    pub t: f64,
    /// The ray parameter, in the same units, from which on Embree searched: `t − start` was found
    /// in f32.
    pub start: f64,
    /// Which mesh of the scene.
    pub mesh: u32,
    /// What of the mesh was hit.
    pub part: EmbreePart,
    /// Which one of these parts of the mesh.
    pub primitive: u32,
    /// On a grid: the place along the rows' and the columns' direction, each from 0 to 1.
    /// On a triangle: the barycentric coordinates of its second and third corner.
    pub place: DVec2,
    /// The normal of the triangle hit, of any length.
    pub geometric_normal: DVec3,
}

/// What of a mesh a hit is on; each is counted by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmbreePart {
    /// One of its [`grids`](GridMesh::grids).
    Grid,
    /// One of its [`faces`](GridMesh::faces), beside the grids.
    Face,
    /// One of all its [`triangles`](GridMesh::triangles).
    Triangle,
}

impl EmbreeHit {
    /// The point that was hit, of the meshes that the scene was made of; `None` if others are
    /// given that have no such part. Triangles are counted off, which takes as long as there are
    /// triangles.
    pub fn on(&self, meshes: &[GridMesh]) -> Option<MeshPoint> {
        let (mesh, primitive) = (meshes.get(self.mesh as usize)?, self.primitive as usize);
        let corners = match self.part {
            EmbreePart::Grid => {
                let exists = primitive < mesh.grids().len();
                return exists.then(|| mesh.at_grid(primitive, self.place));
            }
            EmbreePart::Face => *mesh.faces().get(primitive)?,
            EmbreePart::Triangle => mesh.triangles().nth(primitive)?,
        };
        Some(mesh.at_triangle(corners, self.place))
    }
}

/// Words after `geomID` that Embree may write: `instID`, in version 4 also `instPrimID`,
/// each as long as the build has instance levels (1 by default). Four levels fit, and the
/// structure of one ray is a multiple of 16 bytes, as its alignment demands.
const INSTANCE_WORDS: usize = 9;

/// `RTCRayHit`, `RTCRayHit8` or `RTCRayHit16` (N = 1, 8, 16), then two rows of ours.
///
/// Embree aligns them to 16, 32 and 64 bytes. The hit follows the ray without a gap: twelve
/// rows of N words are a multiple of each alignment.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub(super) struct RayHit<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    /// On return the hit's `t`; −∞ where an occlusion query found something.
    t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    u: [f32; N],
    v: [f32; N],
    primitive: [u32; N],
    geometry: [u32; N],
    instance: [[u32; N]; INSTANCE_WORDS],
    /// −1 for lanes in use, 0 for the rest: Embree's mask.
    pub(super) valid: [i32; N],
    /// The end of the range as given, so that a query can be repeated.
    limit: [f32; N],
}

/// All kinds of parts, in the order of their geometries.
const PARTS: [EmbreePart; 3] = [EmbreePart::Grid, EmbreePart::Face, EmbreePart::Triangle];

/// The number of the geometry of a mesh's parts of this kind: each mesh may have one of each.
pub(super) fn geometry_id(mesh: u32, part: EmbreePart) -> u32 {
    PARTS.len() as u32 * mesh + part as u32
}

/// The mesh and the kind of its parts that a geometry's number tells.
fn of_geometry(id: u32) -> (u32, EmbreePart) {
    let count = PARTS.len() as u32;
    (id / count, PARTS[(id % count) as usize])
}

/// `RTC_INVALID_GEOMETRY_ID`: nothing hit.
const NOTHING: u32 = u32::MAX;

impl<const N: usize> RayHit<N> {
    fn new(rays: &[FramedRay]) -> Self {
        let mut packet = Self {
            origin: [[0.0; N]; 3],
            t_near: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            t_far: [0.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [NOTHING; N],
            geometry: [NOTHING; N],
            instance: [[NOTHING; N]; INSTANCE_WORDS],
            valid: [0; N],
            limit: [0.0; N],
        };
        for (lane, ray) in rays.iter().enumerate().take(N) {
            for axis in 0..3 {
                packet.origin[axis][lane] = ray.origin[axis];
                packet.direction[axis][lane] = ray.direction[axis];
            }
            [packet.t_near[lane], packet.limit[lane]] = ray.range;
            packet.valid[lane] = -1;
        }
        packet
    }

    /// Forgets the last answer.
    pub(super) fn reset(&mut self) {
        self.t_far = self.limit;
        self.geometry = [NOTHING; N];
    }

    fn lanes(&self) -> impl Iterator<Item = usize> {
        (0..N).filter(|&lane| self.valid[lane] != 0)
    }

    fn hits(&self) -> impl Iterator<Item = Option<EmbreeHit>> {
        self.lanes().map(|lane| {
            (self.geometry[lane] != NOTHING).then(|| {
                let (mesh, part) = of_geometry(self.geometry[lane]);
                EmbreeHit {
                    t: f64::from(self.t_far[lane]),
                    start: 0.0,
                    mesh,
                    part,
                    primitive: self.primitive[lane],
                    place: DVec2::new(f64::from(self.u[lane]), f64::from(self.v[lane])),
                    geometric_normal: Vec3::from_array(self.normal.map(|row| row[lane])).as_dvec3(),
                }
            })
        })
    }

    fn occlusions(&self) -> impl Iterator<Item = bool> {
        self.lanes().map(|lane| self.t_far[lane] == f32::NEG_INFINITY)
    }
}

/// Distance of origins from the middle of the scene, in scaled coordinates, from which on they are
/// moved nearer. The scene lies within √3 of its middle.
const FAR: f64 = 3.0;

/// The distance from the middle to which they are moved, at most: still outside the scene.
const BESIDE: f64 = 2.0;

/// A ray in the coordinates of a scene's frame, with a direction of length about 1: there
/// Embree's absolute constants do the least harm.
///
/// Origins that are far away are moved along the ray to beside the scene, in f64, as f32 would lose
/// digits to the distance.
struct FramedRay {
    origin: Vec3,
    direction: Vec3,
    range: [f32; 2],
    /// What a `t` of 1 of this ray is, in units of the direction given.
    unit: f64,
    /// Where this ray begins, in units of the direction given.
    start: f64,
}

impl FramedRay {
    /// All factors are powers of two, so only moving the origin and converting to f32 round.
    fn new(ray: &Ray, frame: &ScaledFrame) -> Self {
        let factor = rounding::power_of_two_below(1.0 / ray.direction().length());
        let unit = factor / frame.scale;
        let direction = ray.direction() * factor;
        let mut origin = frame.scaled(ray.origin());
        // Rays that go away from the scene miss it wherever they begin.
        let distance = origin.length();
        let mut moved = 0.0;
        if distance > FAR && origin.dot(direction) < 0.0 {
            moved = (distance - BESIDE) / direction.length();
            origin += moved * direction;
        }
        let end = ray.t_max() / unit - moved;
        // Any range that ends before the origin is empty. Its end must not be −∞, as that of a far
        // one would be in f32: that reads as an occlusion that was found.
        let end = if end < 0.0 { -1.0 } else { end };
        Self {
            origin: origin.as_vec3(),
            direction: direction.as_vec3(),
            range: [(ray.t_min().max(0.0) / unit - moved).max(0.0), end].map(|t| t as f32),
            unit,
            start: moved * unit,
        }
    }
}

/// Rays by packet width.
#[derive(Clone, Debug)]
pub(super) enum Packets {
    One(Vec<RayHit<1>>),
    Eight(Vec<RayHit<8>>),
    Sixteen(Vec<RayHit<16>>),
}

/// Rays prepared for one Embree scene, and its last answer.
///
/// Preparing them is not part of tracing, so that a race between Embree and us measures
/// neither side's copying.
#[derive(Clone, Debug)]
pub struct EmbreeRays {
    packets: Packets,
    coherence: Coherence,
    /// For each ray where it begins and what a `t` of 1 is, in units of the direction given.
    units: Vec<[f64; 2]>,
}

impl EmbreeRays {
    pub(super) fn new(
        rays: &[Ray],
        frame: &ScaledFrame,
        width: PacketWidth,
        coherence: Coherence,
    ) -> Self {
        fn packets<const N: usize>(rays: &[FramedRay]) -> Vec<RayHit<N>> {
            rays.chunks(N).map(RayHit::new).collect()
        }
        let rays: Vec<_> = rays.iter().map(|ray| FramedRay::new(ray, frame)).collect();
        let packets = match width {
            PacketWidth::One => Packets::One(packets(&rays)),
            PacketWidth::Eight => Packets::Eight(packets(&rays)),
            PacketWidth::Sixteen => Packets::Sixteen(packets(&rays)),
        };
        Self { packets, coherence, units: rays.iter().map(|ray| [ray.start, ray.unit]).collect() }
    }

    pub(super) fn coherence(&self) -> Coherence {
        self.coherence
    }

    pub(super) fn packets_mut(&mut self) -> &mut Packets {
        &mut self.packets
    }

    /// What [`intersect`](super::EmbreeScene::intersect) found, ray by ray.
    pub fn hits(&self) -> Vec<Option<EmbreeHit>> {
        let mut hits: Vec<_> = match &self.packets {
            Packets::One(packets) => packets.iter().flat_map(RayHit::hits).collect(),
            Packets::Eight(packets) => packets.iter().flat_map(RayHit::hits).collect(),
            Packets::Sixteen(packets) => packets.iter().flat_map(RayHit::hits).collect(),
        };
        for (hit, [start, unit]) in hits.iter_mut().zip(&self.units) {
            if let Some(hit) = hit {
                hit.start = *start;
                hit.t = start + hit.t * unit;
            }
        }
        hits
    }

    /// What [`occluded`](super::EmbreeScene::occluded) found, ray by ray.
    pub fn occlusions(&self) -> Vec<bool> {
        match &self.packets {
            Packets::One(packets) => packets.iter().flat_map(RayHit::occlusions).collect(),
            Packets::Eight(packets) => packets.iter().flat_map(RayHit::occlusions).collect(),
            Packets::Sixteen(packets) => packets.iter().flat_map(RayHit::occlusions).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;

    /// Row numbers of Embree's headers: `org_x` 0, `tnear` 3, `dir_x` 4, `tfar` 8, `Ng_x` 12,
    /// `u` 15, `primID` 17, `geomID` 18, `instID` 19.
    fn check_layout<const N: usize>() {
        let row = 4 * N;
        assert_eq!(offset_of!(RayHit<N>, origin), 0);
        assert_eq!(offset_of!(RayHit<N>, t_near), 3 * row);
        assert_eq!(offset_of!(RayHit<N>, direction), 4 * row);
        assert_eq!(offset_of!(RayHit<N>, time), 7 * row);
        assert_eq!(offset_of!(RayHit<N>, t_far), 8 * row);
        assert_eq!(offset_of!(RayHit<N>, mask), 9 * row);
        assert_eq!(offset_of!(RayHit<N>, flags), 11 * row);
        assert_eq!(offset_of!(RayHit<N>, normal), 12 * row);
        assert_eq!(offset_of!(RayHit<N>, u), 15 * row);
        assert_eq!(offset_of!(RayHit<N>, v), 16 * row);
        assert_eq!(offset_of!(RayHit<N>, primitive), 17 * row);
        assert_eq!(offset_of!(RayHit<N>, geometry), 18 * row);
        assert_eq!(offset_of!(RayHit<N>, instance), 19 * row);
        assert_eq!(offset_of!(RayHit<N>, valid), 28 * row);
        assert_eq!(align_of::<RayHit<N>>(), 64);
    }

    #[test]
    fn packets_are_laid_out_as_embree_reads_them() {
        check_layout::<1>();
        check_layout::<8>();
        check_layout::<16>();
    }

    #[test]
    fn geometries_tell_mesh_and_part() {
        for mesh in [0, 1, 7, 1 << 28] {
            for part in PARTS {
                assert_eq!(of_geometry(geometry_id(mesh, part)), (mesh, part));
            }
        }
    }

    #[test]
    fn the_last_packet_may_be_part_full() {
        let ray = Ray::new(DVec3::ONE, DVec3::X).unwrap();
        let frame = ScaledFrame { center: DVec3::X, scale: 1.0 };
        let rays = EmbreeRays::new(&[ray; 11], &frame, PacketWidth::Eight, Coherence::Coherent);
        let Packets::Eight(packets) = &rays.packets else { panic!("packets of eight") };
        assert_eq!(packets.len(), 2);
        assert_eq!(packets[1].valid, [-1, -1, -1, 0, 0, 0, 0, 0]);
        assert_eq!(packets[1].origin[0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(packets[1].origin[1][..4], [1.0, 1.0, 1.0, 0.0]);
        assert_eq!(rays.hits().len(), 11);
        assert!(rays.occlusions().iter().all(|&occluded| !occluded));
    }

    #[test]
    fn rays_keep_their_bits_at_every_scale() {
        let (origin, direction) = (DVec3::new(0.3, -0.7, 2.5), DVec3::new(0.1, 0.2, -0.9));
        let framed = |size: f64, length: f64| {
            let frame = ScaledFrame { center: DVec3::ZERO, scale: 1.0 / size };
            let range = [0.5, 3.0].map(|t| t * size / length);
            let ray = Ray::with_range(size * origin, length * direction, range[0], range[1]);
            FramedRay::new(&ray.unwrap(), &frame)
        };
        let plain = framed(1.0, 1.0);
        assert_eq!(plain.range.map(f64::from).map(|t| t * plain.unit), [0.5, 3.0]);
        for size in [-60, 60].map(|power| 2_f64.powi(power)) {
            for length in [-50, 0, 50].map(|power| 2_f64.powi(power)) {
                let far = framed(size, length);
                assert_eq!((far.origin, far.direction), (plain.origin, plain.direction));
                assert_eq!((far.range, far.unit), (plain.range, plain.unit * size / length));
            }
        }
    }

    #[test]
    fn far_rays_begin_beside_the_scene_and_keep_their_ranges() {
        let frame = ScaledFrame { center: DVec3::new(7.0, 0.0, 0.0), scale: 0.25 };
        let direction = DVec3::new(0.03, -0.05, 0.02); // towards a point near the middle
        let near = frame.center + DVec3::new(0.1, 0.2, -0.3);
        for steps in [1e3, 1e6, 1e9] {
            let origin = near - steps * direction;
            let ray = |range: [f64; 2]| {
                let ray = Ray::with_range(origin, direction, range[0], range[1]).unwrap();
                FramedRay::new(&ray, &frame)
            };
            let framed = ray([0.0, f64::INFINITY]);
            let start = frame.scaled(origin + framed.start * direction);
            assert!((start - framed.origin.as_dvec3()).length() < 1e-6 + 1e-15 * steps);
            assert!((3_f64.sqrt()..3.1).contains(&start.length()), "{start}");
            assert_eq!(framed.range, [0.0, f32::INFINITY]);

            // Ranges are those of the ray as given, to f32 of a few scene sizes.
            let given = [steps - 2.0, steps + 3.0];
            let framed = ray(given);
            let found = framed.range.map(|t| framed.start + f64::from(t) * framed.unit);
            assert!((found[0] - given[0]).abs() < 1e-4, "{found:?}");
            assert!((found[1] - given[1]).abs() < 1e-4, "{found:?}");
            // One that ends before the scene meets nothing, one that begins before it is whole.
            assert_eq!(ray([0.0, 0.3 * steps]).range, [0.0, -1.0]);
            assert_eq!(ray([0.3 * steps, f64::INFINITY]).range, [0.0, f32::INFINITY]);
        }
        let away = Ray::new(DVec3::splat(1e6), DVec3::ONE).unwrap();
        assert_eq!(FramedRay::new(&away, &frame).start, 0.0);
    }
}
