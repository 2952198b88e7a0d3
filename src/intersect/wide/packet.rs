//! Sixty-four rays, coordinate by coordinate, and what has been found for each.

use glam::{DVec2, DVec3, Vec3};

use super::PACKET;
use crate::intersect::hierarchy::Hierarchy;
use crate::math::RayFrame;

/// Origins farther than this from the scene, in its half sizes, are moved nearer for the
/// work in f32: it would otherwise lose digits to the distance.
const NEAR: f64 = 3.0;

/// A vector of f64 for each ray, by coordinate.
pub(super) type Lanes3 = [[f64; PACKET]; 3];

/// The same in f32.
pub(super) type Lanes3f = [[f32; PACKET]; 3];

/// Rays that are traced together, and the nearest hit of each.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(in crate::intersect) struct Packet {
    /// How many rays there are.
    pub(super) count: usize,
    pub(super) origin: Lanes3,
    pub(super) axis: Lanes3,
    pub(super) normals: [Lanes3; 2],
    pub(super) z_min: [f64; PACKET],
    /// The largest coordinate magnitude of the origins.
    pub(super) magnitude: [f64; PACKET],
    pub(super) magnitude_f: [f32; PACKET],
    /// In scaled coordinates, moved along the ray by `shift`.
    pub(super) origin_f: Lanes3f,
    pub(super) axis_f: Lanes3f,
    pub(super) normals_f: [Lanes3f; 2],
    /// The distance by which the f32 origin was moved along the ray, in scene units.
    pub(super) shift: [f64; PACKET],
    /// From where on hits count, in f32 coordinates.
    pub(super) near_f: [f32; PACKET],
    /// The nearest hit so far, or the end of the ray: in scene units, and in f32 coordinates
    /// rounded up.
    pub(super) z: [f64; PACKET],
    pub(super) far_f: [f32; PACKET],
    /// The leaf of the nearest hit; `u32::MAX` for none.
    pub(super) leaf: [u32; PACKET],
    pub(super) s: [f64; PACKET],
    pub(super) t: [f64; PACKET],
    pub(super) point: Lanes3,
    /// `S_s × S_t`, of any length.
    pub(super) cross: Lanes3,
    pub(super) bounds: PacketBounds,
    /// Scene units to scaled coordinates.
    pub(super) scale: f64,
}

/// What all rays of a packet have in common, in scaled f32 coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PacketBounds {
    pub(super) origin_min: Vec3,
    pub(super) origin_max: Vec3,
    /// The inverse direction's range in each coordinate, for directions of one sign.
    pub(super) inverse_min: Vec3,
    pub(super) inverse_max: Vec3,
    /// Per coordinate: 1 or −1 where all directions have that sign, 0 where they differ.
    pub(super) sign: [i8; 3],
}

/// A hit as the packet holds it.
#[derive(Clone, Copy, Debug)]
pub(in crate::intersect) struct LaneHit {
    pub(in crate::intersect) leaf: u32,
    pub(in crate::intersect) z: f64,
    pub(in crate::intersect) st: DVec2,
    pub(in crate::intersect) point: DVec3,
    pub(in crate::intersect) cross: DVec3,
}

impl Packet {
    /// A packet without rays.
    pub(in crate::intersect) fn new() -> Self {
        Self {
            count: 0,
            origin: [[0.0; PACKET]; 3],
            axis: [[0.0; PACKET]; 3],
            normals: [[[0.0; PACKET]; 3]; 2],
            z_min: [0.0; PACKET],
            magnitude: [0.0; PACKET],
            magnitude_f: [0.0; PACKET],
            origin_f: [[0.0; PACKET]; 3],
            axis_f: [[0.0; PACKET]; 3],
            normals_f: [[[0.0; PACKET]; 3]; 2],
            shift: [0.0; PACKET],
            near_f: [0.0; PACKET],
            z: [0.0; PACKET],
            far_f: [0.0; PACKET],
            leaf: [u32::MAX; PACKET],
            s: [0.0; PACKET],
            t: [0.0; PACKET],
            point: [[0.0; PACKET]; 3],
            cross: [[0.0; PACKET]; 3],
            bounds: PacketBounds::default(),
            scale: 1.0,
        }
    }

    /// Takes in up to [`PACKET`] rays; lanes left over get a ray that is over before it
    /// begins.
    pub(in crate::intersect) fn load(&mut self, frames: &[RayFrame], hierarchy: &Hierarchy) {
        self.count = frames.len();
        self.leaf = [u32::MAX; PACKET];
        let (center, scale) = hierarchy.frame();
        self.scale = scale;
        for k in 0..PACKET {
            // Idle lanes repeat the first ray, with an empty range.
            let frame = frames.get(k).unwrap_or(&frames[0]);
            for i in 0..3 {
                self.origin[i][k] = frame.origin[i];
                self.axis[i][k] = frame.axis[i];
                self.normals[0][i][k] = frame.normals[0][i];
                self.normals[1][i][k] = frame.normals[1][i];
            }
            self.magnitude[k] = frame.magnitude;
            self.z_min[k] = frame.z_range[0];
            self.z[k] = if k < frames.len() { frame.z_range[1] } else { f64::NEG_INFINITY };
        }
        self.narrow(center);
        self.bounds = PacketBounds::around(self);
    }

    /// Fills the f32 coordinates from the f64 ones.
    fn narrow(&mut self, center: DVec3) {
        let mut scaled = [[0.0; PACKET]; 3];
        for i in 0..3 {
            for k in 0..PACKET {
                scaled[i][k] = (self.origin[i][k] - center[i]) * self.scale;
                self.axis_f[i][k] = self.axis[i][k] as f32;
                self.normals_f[0][i][k] = self.normals[0][i][k] as f32;
                self.normals_f[1][i][k] = self.normals[1][i][k] as f32;
            }
        }
        let [x, y, z] = &scaled;
        for k in 0..PACKET {
            let distance = (x[k] * x[k] + y[k] * y[k] + z[k] * z[k]).sqrt();
            let shift = if distance > NEAR { distance - NEAR + 1.0 } else { 0.0 };
            self.shift[k] = shift / self.scale;
            for i in 0..3 {
                self.origin_f[i][k] = (scaled[i][k] + shift * self.axis[i][k]) as f32;
            }
            self.magnitude_f[k] = self.magnitude[k] as f32 * (1.0 + f32::EPSILON);
            self.near_f[k] = ((self.z_min[k] - self.shift[k]) * self.scale) as f32 - 1e-5;
            self.far_f[k] = ((self.z[k] - self.shift[k]) * self.scale) as f32 + 1e-5;
        }
    }

    /// A distance along ray `k` in f32 coordinates.
    fn scaled_z(&self, k: usize, z: f64) -> f32 {
        ((z - self.shift[k]) * self.scale) as f32
    }

    /// Brings the f32 end of ray `k` up to its nearest hit.
    pub(super) fn shorten(&mut self, k: usize) {
        // Rounded up by some units of f32 for distances of a few scene sizes.
        self.far_f[k] = self.scaled_z(k, self.z[k]) + 1e-5;
    }

    /// The largest end of the rays that still look for hits.
    pub(super) fn farthest(&self) -> f32 {
        // Eight running maxima, written so that the compiler can use lanes.
        let mut most = [f32::NEG_INFINITY; 8];
        for eight in self.far_f.as_chunks::<8>().0 {
            for (most, &far) in most.iter_mut().zip(eight) {
                *most = if far > *most { far } else { *most };
            }
        }
        most.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    /// The nearest hit of a ray.
    pub(in crate::intersect) fn hit(&self, k: usize) -> Option<LaneHit> {
        let gather = |lanes: &Lanes3| DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k]);
        (self.leaf[k] != u32::MAX).then(|| LaneHit {
            leaf: self.leaf[k],
            z: self.z[k],
            st: DVec2::new(self.s[k], self.t[k]),
            point: gather(&self.point),
            cross: gather(&self.cross),
        })
    }
}

impl PacketBounds {
    fn around(packet: &Packet) -> Self {
        let mut bounds = Self::default();
        for i in 0..3 {
            let live = &packet.axis_f[i][..packet.count];
            let origins = &packet.origin_f[i][..packet.count];
            let range = |values: &[f32]| {
                values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &value| {
                    (low.min(value), high.max(value))
                })
            };
            (bounds.origin_min[i], bounds.origin_max[i]) = range(origins);
            let (low, high) = range(live);
            // Inverses are rounded outwards by two units.
            let (outer, inner) = (1.0 + 2.0 * f32::EPSILON, 1.0 - 2.0 * f32::EPSILON);
            let tiny = 1e-20;
            if low > tiny {
                bounds.sign[i] = 1;
                (bounds.inverse_min[i], bounds.inverse_max[i]) = (inner / high, outer / low);
            } else if high < -tiny {
                bounds.sign[i] = -1;
                (bounds.inverse_min[i], bounds.inverse_max[i]) = (inner / -low, outer / -high);
            }
        }
        bounds
    }
}
