//! Sixty-four rays in lanes, coordinate by coordinate: as they are given, and scaled for the work
//! in f32.

use fearless_simd::{Simd, f32x16};
use glam::Vec3;

use super::PACKET;
use super::vectors::{Lanes3, Lanes3f, load3};

/// The rays in f64, in scene units, with unit directions.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct LaneRays {
    pub origin: Lanes3,
    pub axis: Lanes3,
    /// The normals of the two planes through each ray.
    pub normals: [Lanes3; 2],
    /// Whether these have been computed, here and in f32.
    pub planes_known: bool,
    /// `1 / |d|`.
    pub t_from_z: [f64; PACKET],
    pub z_min: [f64; PACKET],
    pub z_max: [f64; PACKET],
    /// The largest coordinate magnitude of the origins.
    pub magnitude: [f64; PACKET],
}

/// The rays in f32, in scaled coordinates.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct ScaledRays {
    /// Scene units to scaled coordinates.
    pub scale: f64,
    /// The distance by which the origins were moved along the rays, in scene units.
    pub shift: [f64; PACKET],
    pub origin: Lanes3f,
    pub axis: Lanes3f,
    pub normals: [Lanes3f; 2],
    pub magnitude: [f32; PACKET],
    /// Where hits begin to count.
    pub near: [f32; PACKET],
    /// The nearest hit so far, or the end of the ray, rounded up.
    pub far: [f32; PACKET],
    /// The largest of those ends.
    pub farthest: f32,
    pub bounds: PacketBounds,
}

/// Bounds shared by all rays of a packet, in scaled f32 coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PacketBounds {
    /// With a slack of [`BLUR`](super::box_ray::BLUR).
    pub origin_min: Vec3,
    pub origin_max: Vec3,
    pub axis_min: Vec3,
    pub axis_max: Vec3,
    /// The inverse direction's range in each coordinate, for directions of one sign.
    pub inverse_min: Vec3,
    pub inverse_max: Vec3,
    /// Where hits begin to count, at the earliest.
    pub nearest: f32,
    /// Per coordinate: 1 or −1 where all directions have that sign, 0 where they differ.
    pub sign: [i8; 3],
}

impl Default for LaneRays {
    fn default() -> Self {
        Self {
            origin: [[0.0; PACKET]; 3],
            axis: [[0.0; PACKET]; 3],
            normals: [[[0.0; PACKET]; 3]; 2],
            planes_known: false,
            t_from_z: [0.0; PACKET],
            z_min: [0.0; PACKET],
            z_max: [0.0; PACKET],
            magnitude: [0.0; PACKET],
        }
    }
}

impl Default for ScaledRays {
    fn default() -> Self {
        Self {
            scale: 1.0,
            shift: [0.0; PACKET],
            origin: [[0.0; PACKET]; 3],
            axis: [[0.0; PACKET]; 3],
            normals: [[[0.0; PACKET]; 3]; 2],
            magnitude: [0.0; PACKET],
            near: [0.0; PACKET],
            far: [0.0; PACKET],
            farthest: 0.0,
            bounds: PacketBounds::default(),
        }
    }
}

/// Sixteen of the rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RaySixteen<'a> {
    pub rays: &'a LaneRays,
    pub scaled: &'a ScaledRays,
    /// The first of them.
    pub base: usize,
}

impl RaySixteen<'_> {
    /// The normals of the rays' planes, in f32.
    #[inline(always)]
    pub(crate) fn normals<S: Simd>(&self, simd: S) -> [[f32x16<S>; 3]; 2] {
        let of = |plane: usize| load3(simd, &self.scaled.normals[plane], self.base);
        [of(0), of(1)]
    }
}

/// Direction components this near to zero decide nothing: their inverses, times distances, must not
/// overflow f32.
const TINY: f32 = 1e-20;

impl PacketBounds {
    /// Sets the range of one coordinate of all directions.
    pub(crate) fn set_directions(&mut self, i: usize, low: f32, high: f32) {
        (self.axis_min[i], self.axis_max[i]) = (low, high);
        // Inverses are rounded outwards by two units.
        let (outer, inner) = (1.0 + 2.0 * f32::EPSILON, 1.0 - 2.0 * f32::EPSILON);
        if low > TINY {
            self.sign[i] = 1;
            (self.inverse_min[i], self.inverse_max[i]) = (inner / high, outer / low);
        } else if high < -TINY {
            self.sign[i] = -1;
            (self.inverse_min[i], self.inverse_max[i]) = (inner / -low, outer / -high);
        }
    }
}
