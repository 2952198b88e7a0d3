//! Sixty-four rays, coordinate by coordinate, and what has been found for each.

use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, SimdSplit, f32x8, f32x16, f64x8, mask32x8,
    mask64x8, u32x16,
};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3, Vec3};

use super::box_crossing::BoxCrossing;
use super::target::Target;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::BOX_SPARE;
use crate::intersect::wide::frames::END_SPARE;
use crate::intersect::wide::proof::departure::{Departure, Final, MAY_START};
use crate::intersect::wide::vectors::{Lanes3, Lanes3f, lane_bits, load3};
use crate::intersect::wide::wanted::Wanted;
use crate::intersect::{Answer, Hit, HitFlags, Root, Shot};
use crate::math::bits::{half_of_sixteen, has, set_bits};

/// Rays that are traced together, and the nearest hit of each.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(in crate::intersect) struct Packet {
    /// How many rays there are.
    pub(super) count: usize,
    pub(in crate::intersect::wide) origin: Lanes3,
    pub(super) axis: Lanes3,
    /// The normals of the two planes through each ray, and whether they have been computed.
    pub(in crate::intersect::wide) normals: [Lanes3; 2],
    pub(super) planes_known: bool,
    /// `1 / |d|`.
    pub(super) t_from_z: [f64; PACKET],
    pub(super) z_min: [f64; PACKET],
    pub(super) z_max: [f64; PACKET],
    /// The largest coordinate magnitude of the origins.
    pub(super) magnitude: [f64; PACKET],
    pub(super) magnitude_f: [f32; PACKET],
    /// The origins in scaled coordinates, moved along the rays by `shift`.
    pub(super) origin_f: Lanes3f,
    pub(super) axis_f: Lanes3f,
    pub(in crate::intersect::wide) normals_f: [Lanes3f; 2],
    /// The distance by which the f32 origin was moved along the ray, in scene units.
    pub(super) shift: [f64; PACKET],
    /// Where hits begin to count, in f32 coordinates.
    pub(super) near_f: [f32; PACKET],
    /// The nearest hit so far, or the end of the ray: in scene units, and in f32 coordinates
    /// rounded up.
    pub(super) z: [f64; PACKET],
    pub(super) far_f: [f32; PACKET],
    /// The largest of those ends.
    pub(super) farthest: f32,
    /// One bit a ray: whether it comes from too far away for the work in f32, and is left out.
    pub(super) far_off: u64,
    /// One bit a ray: whether it has met anything.
    pub(super) met: u64,
    /// The leaf of the nearest hit of rays that have one.
    pub(super) leaf: [u32; PACKET],
    pub(super) piece: [u32; PACKET],
    pub(super) surface: [u32; PACKET],
    /// One bit a ray: whether its nearest hit may be within rounding of a border, or its normal
    /// needs a closer look.
    pub(super) needs_look: u64,
    /// The ray parameter.
    pub(super) ray_t: [f64; PACKET],
    /// The place on the piece, and on its surface.
    pub(super) st: [[f64; PACKET]; 2],
    pub(super) uv: [[f64; PACKET]; 2],
    /// Error bound of `z`.
    pub(super) z_error: [f64; PACKET],
    pub(super) point: Lanes3,
    /// `S_s × S_t`, made a unit vector.
    pub(super) normal: Lanes3,
    pub(super) bounds: PacketBounds,
    /// Whether any hit will do: then a ray that has one ends before it begins.
    pub(in crate::intersect::wide) any: bool,
    /// Whether some rays start on a root; for each ray the root's piece (`u32::MAX` for none), its
    /// place there, and its error bound.
    pub(super) from_roots: bool,
    pub(super) from_piece: [u32; PACKET],
    pub(super) from_st: [[f64; PACKET]; 2],
    pub(super) from_error: [f64; PACKET],
    /// Scene units to scaled coordinates.
    pub(super) scale: f64,
}

/// Bounds shared by all rays of a packet, in scaled f32 coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PacketBounds {
    /// With a slack of [`BLUR`](crate::intersect::wide::box_ray::BLUR).
    pub(super) origin_min: Vec3,
    pub(super) origin_max: Vec3,
    pub(super) axis_min: Vec3,
    pub(super) axis_max: Vec3,
    /// The inverse direction's range in each coordinate, for directions of one sign.
    pub(super) inverse_min: Vec3,
    pub(super) inverse_max: Vec3,
    /// Where hits begin to count, at the earliest.
    pub(super) nearest: f32,
    /// Per coordinate: 1 or −1 where all directions have that sign, 0 where they differ.
    pub(super) sign: [i8; 3],
}

/// A hit as the packet holds it.
#[derive(Clone, Copy, Debug)]
pub(in crate::intersect) struct LaneHit {
    pub(in crate::intersect) piece: u32,
    /// The ray parameter, and the error bound of the place along the ray.
    pub(in crate::intersect) t: f64,
    pub(in crate::intersect) z_error: f64,
    pub(in crate::intersect) st: DVec2,
    pub(in crate::intersect) point: DVec3,
    /// NaN where there is none.
    pub(in crate::intersect) normal: DVec3,
    /// Whether it may be within rounding of a border of its surface, or its normal needs a closer
    /// look.
    pub(in crate::intersect) needs_look: bool,
}

impl Packet {
    /// A packet without rays.
    pub(in crate::intersect) fn new() -> Self {
        Self {
            count: 0,
            origin: [[0.0; PACKET]; 3],
            axis: [[0.0; PACKET]; 3],
            normals: [[[0.0; PACKET]; 3]; 2],
            planes_known: false,
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
            far_off: 0,
            met: 0,
            leaf: [0; PACKET],
            piece: [0; PACKET],
            surface: [0; PACKET],
            needs_look: 0,
            ray_t: [0.0; PACKET],
            st: [[0.0; PACKET]; 2],
            uv: [[0.0; PACKET]; 2],
            z_error: [0.0; PACKET],
            point: [[0.0; PACKET]; 3],
            normal: [[0.0; PACKET]; 3],
            bounds: PacketBounds::default(),
            any: false,
            from_roots: false,
            from_piece: [u32::MAX; PACKET],
            from_st: [[0.0; PACKET]; 2],
            from_error: [0.0; PACKET],
            scale: 1.0,
        }
    }

    /// Forgets all rays: now there are `count` rays that meet nothing.
    pub(in crate::intersect) fn clear(&mut self, count: usize) {
        self.count = count;
        (self.far_off, self.met, self.needs_look) = (0, 0, 0);
    }

    /// Says whether any hit will do for the rays to come.
    pub(in crate::intersect) fn ask(&mut self, wanted: Wanted) {
        self.any = wanted == Wanted::Any;
    }

    /// Shortens the f32 ends of rays to their nearest hits, for those of the eight rays from `base`
    /// on whose bit is set.
    #[simd]
    pub(super) fn shorten<S: Simd>(&mut self, simd: S, base: usize, hits: u64) {
        let eight = base..base + 8;
        let z = f64x8::from_slice(simd, &self.z[eight.clone()]);
        let shift = f64x8::from_slice(simd, &self.shift[eight.clone()]);
        let far = (z - shift) * f64x8::splat(simd, self.scale);
        let (far, _) = simd.narrow_f64x8(far, far).split();
        let far = far + f32x8::splat(simd, END_SPARE);
        let lanes = &mut self.far_f[eight];
        let old = f32x8::from_slice(simd, lanes);
        mask32x8::from_bitmask(simd, hits).select(far, old).store_slice(lanes);
    }

    /// One bit for each of sixteen rays whose crossing of a box lies in the range in which hits
    /// count, and ahead of the root it starts on. The box was grown by more than the errors of its
    /// leaf or of the ray.
    #[simd]
    pub(in crate::intersect::wide) fn within_range<S: Simd>(
        &self,
        simd: S,
        base: usize,
        crossing: &BoxCrossing<S>,
    ) -> u32 {
        let sixteen = base..base + LANES;
        let near = f32x16::from_slice(simd, &self.near_f[sixteen.clone()]);
        let far = f32x16::from_slice(simd, &self.far_f[sixteen]);
        // The ends are known with some slack to the other side.
        let spare = f32x16::splat(simd, 2.0 * END_SPARE + BOX_SPARE);
        let within = crossing.entry.simd_gt(near + spare) & crossing.exit.simd_lt(far - spare);
        if !self.from_roots {
            return lane_bits(within);
        }
        let scale = f64x8::splat(simd, self.scale);
        let mut start = [scale; 2];
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let error = f64x8::from_slice(simd, &self.from_error[eight.clone()]);
            start[half] = (error - f64x8::from_slice(simd, &self.shift[eight])) * scale;
        }
        let ahead = simd.narrow_f64x8(start[0], start[1]) + spare;
        lane_bits(within & crossing.entry.simd_gt(ahead))
    }

    /// Notes a hit for those of the sixteen rays from `base` on whose bit is set: nothing more is
    /// asked of them.
    #[simd]
    pub(super) fn meet<S: Simd>(&mut self, simd: S, base: usize, hits: u32) {
        for half in 0..2 {
            let hits = half_of_sixteen(hits, half);
            if hits != 0 {
                self.meet_eight(simd, base + 8 * half, hits);
            }
        }
    }

    /// The same for eight rays.
    #[inline(always)]
    pub(super) fn meet_eight<S: Simd>(&mut self, simd: S, base: usize, hits: u64) {
        self.met |= hits << base;
        let lanes = &mut self.z[base..base + 8];
        let (old, none) = (f64x8::from_slice(simd, lanes), f64x8::splat(simd, f64::NEG_INFINITY));
        mask64x8::from_bitmask(simd, hits).select(none, old).store_slice(lanes);
        self.shorten(simd, base, hits);
    }

    /// One bit a ray: whether its nearest hit needs a closer look, because it may be within
    /// rounding of a border, be near a pole, or have no normal.
    pub(in crate::intersect) fn needs_look(&self) -> u64 {
        self.needs_look
    }

    /// How far along a ray anything matters: to its nearest hit, or its end.
    pub(in crate::intersect) fn end(&self, k: usize) -> f64 {
        self.z[k]
    }

    /// One bit a ray: whether it was left out, for others to trace.
    pub(in crate::intersect) fn far_off(&self) -> u64 {
        self.far_off
    }

    /// One bit a ray: whether it has met anything.
    pub(in crate::intersect) fn met(&self) -> u64 {
        self.met
    }

    /// Takes in the roots that rays start on.
    pub(super) fn start_on_roots<Q: Shot>(&mut self, shots: &[Q]) {
        self.from_roots = shots.iter().any(|shot| shot.start_root().is_some());
        if !self.from_roots {
            return;
        }
        self.from_piece = [u32::MAX; PACKET];
        self.from_error = [0.0; PACKET];
        for (k, shot) in shots.iter().enumerate() {
            if let Some(root) = shot.start_root() {
                self.from_piece[k] = root.piece;
                (self.from_st[0][k], self.from_st[1][k]) = (root.st.x, root.st.y);
                self.from_error[k] = root.error;
            }
        }
    }

    /// One bit for each of the sixteen rays from `base` on that starts in its part of a piece;
    /// `parts` holds from and to in `s`, then in `t`, for each half of the rays.
    #[simd]
    pub(super) fn starts_in<S: Simd>(
        &self,
        simd: S,
        base: usize,
        piece: u32,
        parts: &[[f64x8<S>; 4]; 2],
    ) -> u32 {
        let from = u32x16::from_slice(simd, &self.from_piece[base..base + LANES]);
        let on_piece = from.simd_eq(u32x16::splat(simd, piece)).to_bitmask() as u32;
        if on_piece == 0 {
            return 0;
        }
        let mut inside = 0;
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let at_s = f64x8::from_slice(simd, &self.from_st[0][eight.clone()]);
            let at_t = f64x8::from_slice(simd, &self.from_st[1][eight]);
            let [s0, s1, t0, t1] = parts[half];
            let within = at_s.simd_ge(s0) & at_s.simd_le(s1) & at_t.simd_ge(t0) & at_t.simd_le(t1);
            inside |= (within.to_bitmask() as u32) << (8 * half);
        }
        inside & on_piece
    }

    /// One bit for each of the sixteen rays from `base` on that starts on a leaf, or near it on its
    /// piece, and is proved not to have that leaf ahead of it again. The error bound of a point's
    /// distance from a ray is the ray's magnitude times `factor`.
    #[simd]
    pub(super) fn departs_from<S: Simd>(
        &self,
        simd: S,
        base: usize,
        target: &Target<'_>,
        (magnitude, factor): (f32x16<S>, f64),
    ) -> u32 {
        let leaf = target.leaf;
        let nearby = [f32x16::splat(simd, -MAY_START), f32x16::splat(simd, MAY_START)];
        let here =
            self.starts_in(simd, base, leaf.piece, &[target.parameters(simd, &[nearby; 2], 0); 2]);
        if here == 0 {
            return 0;
        }
        let mut ahead = 0;
        let zero = f64x8::splat(simd, 0.0);
        let (mut place, mut origin, mut known) = ([[zero; 2]; 2], [[zero; 2]; 3], [zero; 2]);
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let z_min = f64x8::from_slice(simd, &self.z_min[eight.clone()]);
            ahead |= (z_min.simd_ge(zero).to_bitmask() as u32) << (8 * half);
            for k in 0..2 {
                let [from, to] = leaf.rect()[k];
                let at = f64x8::from_slice(simd, &self.from_st[k][eight.clone()]);
                let twice = at + at - f64x8::splat(simd, from + to);
                place[k][half] = twice * f64x8::splat(simd, 1.0 / (to - from));
            }
            for k in 0..3 {
                let at = f64x8::from_slice(simd, &self.origin[k][eight.clone()]);
                origin[k][half] = at - f64x8::splat(simd, leaf.middle[k]);
            }
            known[half] = f64x8::from_slice(simd, &self.from_error[eight]);
        }
        if here & ahead == 0 {
            return 0;
        }
        let narrow = |[low, high]: [f64x8<S>; 2]| simd.narrow_f64x8(low, high);
        // Both are rounded up by more than their rounding errors.
        let error = magnitude * f32x16::splat(simd, 1.001 * factor as f32);
        let departure = Departure {
            place: [narrow(place[0]), narrow(place[1])],
            origin: [narrow(origin[0]), narrow(origin[1]), narrow(origin[2])],
            axis: load3(simd, &self.axis_f, base),
            reach: narrow(known).mul_add(f32x16::splat(simd, 1.001), error),
        };
        let Final { mut surely, if_near } = departure.is_final(simd, target.fitted());
        for k in set_bits(here & ahead & if_near & !surely) {
            let at = base + k;
            let point = target.piece.patch.point(pair(&self.from_st, at));
            let reach = self.from_error[at] + factor * f64::from(magnitude[k]);
            surely |= u32::from(point.distance(gather(&self.origin, at)) <= reach) << k;
        }
        here & ahead & surely
    }

    /// The answer to a ray whose nearest hit needs no closer look.
    #[inline]
    pub(in crate::intersect) fn plain_answer(&self, k: usize) -> Answer {
        if !has(self.met, k) {
            return Answer::default();
        }
        let normal = gather(&self.normal, k);
        let cosine = Root::kept_cosine(normal.dot(gather(&self.axis, k)));
        let (piece, st, error) = (self.piece[k], pair(&self.st, k), self.z_error[k]);
        let root = Root { piece, cosine, st, error };
        let hit = Hit {
            t: self.ray_t[k],
            surface: self.surface[k],
            uv: pair(&self.uv, k),
            point: gather(&self.point, k),
            normal,
            flags: HitFlags::NONE,
            root,
        };
        Answer { hit: Some(hit), doubtful: false }
    }

    /// The nearest hit of a ray.
    pub(in crate::intersect) fn hit(&self, k: usize) -> Option<LaneHit> {
        has(self.met, k).then(|| LaneHit {
            piece: self.piece[k],
            t: self.ray_t[k],
            z_error: self.z_error[k],
            st: pair(&self.st, k),
            point: gather(&self.point, k),
            normal: gather(&self.normal, k),
            needs_look: has(self.needs_look, k),
        })
    }
}

#[inline]
fn gather(lanes: &Lanes3, k: usize) -> DVec3 {
    DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k])
}

#[inline]
fn pair(lanes: &[[f64; PACKET]; 2], k: usize) -> DVec2 {
    DVec2::new(lanes[0][k], lanes[1][k])
}

/// Direction components this near to zero decide nothing: their inverses, times distances, must not
/// overflow f32.
const TINY: f32 = 1e-20;

impl PacketBounds {
    /// Sets the range of one coordinate of all directions.
    pub(super) fn set_directions(&mut self, i: usize, low: f32, high: f32) {
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
