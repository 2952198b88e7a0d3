//! Sixty-four rays, coordinate by coordinate, and what has been found for each.

use glam::{DVec2, DVec3, Vec3};

use super::PACKET;
use super::load::END_SPARE;
use crate::intersect::{Hit, HitFlags, Root, Shot};
use crate::patch::Piece;

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
    /// `1 / |d|`.
    pub(super) t_from_z: [f64; PACKET],
    pub(super) z_min: [f64; PACKET],
    pub(super) z_max: [f64; PACKET],
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
    /// The largest of those ends.
    pub(super) farthest: f32,
    /// The leaf of the nearest hit; `u32::MAX` for none.
    pub(super) leaf: [u32; PACKET],
    pub(super) piece: [u32; PACKET],
    /// One bit a ray: whether its nearest hit may be within rounding of a border, or is near a pole.
    pub(super) near_border: u64,
    pub(super) s: [f64; PACKET],
    pub(super) t: [f64; PACKET],
    /// How far `z` may be off.
    pub(super) z_error: [f64; PACKET],
    pub(super) point: Lanes3,
    /// `S_s × S_t`, made a unit vector.
    pub(super) normal: Lanes3,
    pub(super) bounds: PacketBounds,
    /// Scene units to scaled coordinates.
    pub(super) scale: f64,
}

/// What all rays of a packet have in common, in scaled f32 coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PacketBounds {
    pub(super) origin_min: Vec3,
    pub(super) origin_max: Vec3,
    pub(super) axis_min: Vec3,
    pub(super) axis_max: Vec3,
    /// The inverse direction's range in each coordinate, for directions of one sign.
    pub(super) inverse_min: Vec3,
    pub(super) inverse_max: Vec3,
    /// Per coordinate: 1 or −1 where all directions have that sign, 0 where they differ.
    pub(super) sign: [i8; 3],
}

/// A hit as the packet holds it.
#[derive(Clone, Copy, Debug)]
pub(in crate::intersect) struct LaneHit {
    pub(in crate::intersect) piece: u32,
    /// The ray parameter, and how far the place along the ray may be off.
    pub(in crate::intersect) t: f64,
    pub(in crate::intersect) z_error: f64,
    pub(in crate::intersect) st: DVec2,
    pub(in crate::intersect) point: DVec3,
    /// NaN where there is none.
    pub(in crate::intersect) normal: DVec3,
    /// Whether it may be within rounding of a border of its surface, or is near a pole.
    pub(in crate::intersect) near_border: bool,
}

impl Packet {
    /// A packet without rays.
    pub(in crate::intersect) fn new() -> Self {
        Self {
            count: 0,
            origin: [[0.0; PACKET]; 3],
            axis: [[0.0; PACKET]; 3],
            normals: [[[0.0; PACKET]; 3]; 2],
            t_from_z: [0.0; PACKET],
            z_min: [0.0; PACKET],
            z_max: [0.0; PACKET],
            magnitude: [0.0; PACKET],
            magnitude_f: [0.0; PACKET],
            origin_f: [[0.0; PACKET]; 3],
            axis_f: [[0.0; PACKET]; 3],
            normals_f: [[[0.0; PACKET]; 3]; 2],
            shift: [0.0; PACKET],
            near_f: [0.0; PACKET],
            z: [0.0; PACKET],
            far_f: [0.0; PACKET],
            farthest: 0.0,
            leaf: [u32::MAX; PACKET],
            piece: [0; PACKET],
            near_border: 0,
            s: [0.0; PACKET],
            t: [0.0; PACKET],
            z_error: [0.0; PACKET],
            point: [[0.0; PACKET]; 3],
            normal: [[0.0; PACKET]; 3],
            bounds: PacketBounds::default(),
            scale: 1.0,
        }
    }

    /// Takes in up to [`PACKET`] rays as they are given; lanes left over repeat the first.
    pub(in crate::intersect) fn load<Q: Shot>(&mut self, shots: &[Q]) {
        self.count = shots.len();
        for k in 0..PACKET {
            let ray = shots[if k < shots.len() { k } else { 0 }].ray();
            let (origin, direction) = (ray.origin(), ray.direction());
            for i in 0..3 {
                self.origin[i][k] = origin[i];
                self.axis[i][k] = direction[i];
            }
            self.z_min[k] = ray.t_min();
            self.z[k] = ray.t_max();
        }
    }

    /// Brings the f32 end of ray `k` up to its nearest hit.
    pub(super) fn shorten(&mut self, k: usize) {
        self.far_f[k] = ((self.z[k] - self.shift[k]) * self.scale) as f32 + END_SPARE;
    }

    /// One bit a ray: whether its nearest hit needs a closer look: it may be within rounding of
    /// a border, be near a pole, or have no normal.
    pub(in crate::intersect) fn near_border(&self) -> u64 {
        self.near_border
    }

    /// How far along a ray anything is of interest: to its nearest hit, or its end.
    pub(in crate::intersect) fn end(&self, k: usize) -> f64 {
        self.z[k]
    }

    /// Whether a ray has met anything.
    #[inline]
    pub(in crate::intersect) fn has_hit(&self, k: usize) -> bool {
        self.leaf[k] != u32::MAX
    }

    /// The nearest hit of a ray, if it needs no closer look.
    #[inline]
    pub(in crate::intersect) fn plain_hit(&self, pieces: &[Piece], k: usize) -> Hit {
        let piece = &pieces[self.piece[k] as usize];
        let st = DVec2::new(self.s[k], self.t[k]);
        Hit {
            t: self.z[k] * self.t_from_z[k],
            surface: piece.surface,
            uv: piece.uv(st),
            point: gather(&self.point, k),
            normal: gather(&self.normal, k),
            flags: HitFlags::NONE,
            root: Root { piece: self.piece[k], st, error: self.z_error[k] },
        }
    }

    /// The nearest hit of a ray.
    pub(in crate::intersect) fn hit(&self, k: usize) -> Option<LaneHit> {
        self.has_hit(k).then(|| LaneHit {
            piece: self.piece[k],
            t: self.z[k] * self.t_from_z[k],
            z_error: self.z_error[k],
            st: DVec2::new(self.s[k], self.t[k]),
            point: gather(&self.point, k),
            normal: gather(&self.normal, k),
            near_border: self.near_border >> k & 1 != 0,
        })
    }
}

#[inline]
fn gather(lanes: &Lanes3, k: usize) -> DVec3 {
    DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k])
}

impl PacketBounds {
    /// Takes the range of a coordinate of all directions.
    pub(super) fn set_directions(&mut self, i: usize, low: f32, high: f32) {
        (self.axis_min[i], self.axis_max[i]) = (low, high);
        // Inverses are rounded outwards by two units.
        let (outer, inner) = (1.0 + 2.0 * f32::EPSILON, 1.0 - 2.0 * f32::EPSILON);
        let tiny = 1e-20;
        if low > tiny {
            self.sign[i] = 1;
            (self.inverse_min[i], self.inverse_max[i]) = (inner / high, outer / low);
        } else if high < -tiny {
            self.sign[i] = -1;
            (self.inverse_min[i], self.inverse_max[i]) = (inner / -low, outer / -high);
        }
    }
}
