//! Eight rays against one leaf, in f64 on the true surface.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, f64x8, mask32x8, mask64x8, u32x8};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3};

use super::one_leaf::{OneLeaf, TrueLeaf, Uniqueness};
use super::rays::Packet;
use super::target::{LeafNumbers, Target};
use crate::geometry::RectSide;
use crate::geometry::trim::Side;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::nearest::comes_first;
use crate::intersect::wide::search::distances::widened;
use crate::intersect::wide::search::newton::{Converged, Ends, Rays, Verdict, newton};
use crate::intersect::wide::trimmed::{Places, kept_in_window};
use crate::intersect::wide::vectors::{Lanes3, dot_d, load3d};
use crate::intersect::wide::{PACKET, trimmed};
use crate::math::bits::{half_of_sixteen, has, set_bits};
use crate::patch::Piece;

/// In a leaf that ends in a pole, normals get a closer look where the length of the tangents' cross
/// product is less than this part of the square of the sum of their lengths: there the product
/// loses digits accordingly.
const LEAST_SINE: f64 = 1e-2;

/// The outcome for some rays, a lane each.
#[derive(Clone, Copy, Default)]
pub(super) struct Done {
    /// The lanes that did not converge.
    pub(super) unconverged: u32,
    /// The lanes whose root the scalar search must judge.
    pub(super) undecided: u32,
    /// The lanes whose root it must judge for being near an edge of trims: unless the ray's nearest
    /// hit turns out to be nearer than `packet.edges` says.
    pub(super) at_edge: u32,
    /// Whether some ray's nearest hit is new.
    pub(super) found: bool,
    /// Newton's steps taken, over all lanes.
    pub(super) steps: u32,
}

/// [`finish`] for both halves of sixteen rays.
#[simd]
pub(super) fn finish_all<S: Simd>(
    simd: S,
    leaf: TrueLeaf<'_>,
    packet: &mut Packet,
    base: usize,
    lanes: u32,
    unique: &Uniqueness<S>,
    near: &[f32x16<S>; 2],
) -> Done {
    let mut all = Done::default();
    for half in 0..2 {
        let wanted = half_of_sixteen(lanes, half);
        if wanted == 0 {
            continue;
        }
        let wanted = mask64x8::from_bitmask(simd, wanted);
        let (base, near) = (base + 8 * half, [widened(near[0], half), widened(near[1], half)]);
        let done = finish(simd, leaf, packet, base, wanted, unique, &near);
        all.unconverged |= done.unconverged << (8 * half);
        all.undecided |= done.undecided << (8 * half);
        all.at_edge |= done.at_edge << (8 * half);
        all.found |= done.found;
        all.steps += done.steps;
    }
    all
}

/// Takes Newton's steps in f64 for those of rays `base … base + 7` that are `wanted`, from the
/// places `near` that the search in f32 has found; hits nearer than those known are put into the
/// packet.
///
/// Each of these rays has at most one root in the domain that `unique` gives. Also returns the
/// lanes that did not converge, and those that the scalar search must judge: whose hit lies outside
/// the piece, or too near an end of the ray or the root it starts on.
#[simd]
pub(super) fn finish<S: Simd>(
    simd: S,
    leaf: TrueLeaf<'_>,
    packet: &mut Packet,
    base: usize,
    wanted: mask64x8<S>,
    unique: &Uniqueness<S>,
    near: &[f64x8<S>; 2],
) -> Done {
    let TrueLeaf { target, numbers, .. } = leaf;
    let (certified, domain) = match unique {
        Uniqueness::Certificate => (true, target.certified(simd)),
        Uniqueness::Own(rect) => (false, target.parameters(simd, rect, base % LANES / 8)),
    };
    let leaves = OneLeaf { on: leaf, domain, certified, normals: packet.wanted != Wanted::Any };
    let rays = PacketRays::new(simd, packet, base, numbers.residual_factor, numbers.magnitude);
    let error = rays.error();
    let mut near_pole = simd.splat_mask64x8(false);
    if let (Some(pole), true) = (target.pole, certified) {
        near_pole = wanted & !target.is_away_from_pole(simd, pole, &rays);
    }

    let mut root = newton(simd, &leaves, &rays, wanted & !near_pole, near);
    let steps = root.steps;
    let unconverged = (root.unconverged | near_pole).to_bitmask() as u32;
    if root.found.all_false() {
        return Done { unconverged, steps, ..Done::default() };
    }
    if target.pole.is_some() {
        // Tangents vanish at a pole, and the determinant before the last step says nothing of the
        // one at the hit.
        root.inverse_det = f64x8::splat(simd, 1.0) / dot_d(root.cross, rays.axis(simd));
    }
    let Converged { z, speed, .. } = root;
    let from_error = eight(simd, &packet.starts.error, base);
    let ends = Ends {
        z: [eight(simd, &packet.rays.z_min, base), eight(simd, &packet.rays.z_max, base)],
        from_error: if packet.starts.exist { Some(from_error) } else { None },
    };
    let best = eight(simd, &packet.hits.z, base);
    let verdict = root.verdict(simd, &ends, error, certified);
    let Verdict { size, z_error, mut undecided, at_end, acceptable, near_end } = verdict;
    let tie = acceptable & z.simd_eq(best);
    let mut hit = acceptable & z.simd_lt(best) | earlier(simd, tie, target, packet, base);
    let mut at_edge = 0;
    if target.leaf.is_trimmed() {
        // Also asks about roots that cannot be told from the nearest hit: these may lie at an edge.
        let from = z - near_end;
        let asked = acceptable & from.simd_le(best);
        let reach = f64x8::splat(simd, trimmed::EDGE_REACH) * z_error * speed / size;
        let [kept, decided] = kept_by_trims(simd, target, numbers, asked | at_end, &root.st, reach);
        hit &= kept;
        undecided &= !(decided & !kept);
        at_edge = (asked & !decided).to_bitmask() as u32;
        if at_edge != 0 {
            from.store_slice(&mut packet.edges.0[base..base + 8]);
        }
    }

    let found = hit.any_true();
    if found && packet.wanted == Wanted::Any {
        // Nothing more is asked of these rays.
        packet.meet_eight(simd, base, hit.to_bitmask());
    } else if found {
        put_hits(simd, &leaves, packet, base, hit, &root, &verdict);
    }
    Done { unconverged, undecided: undecided.to_bitmask() as u32, at_edge, found, steps }
}

/// Puts the hits of eight rays into a packet: the roots of the lanes in `hit`, each its ray's
/// nearest so far.
#[inline(always)] // what goes in are dozens of vectors
fn put_hits<S: Simd>(
    simd: S,
    leaves: &OneLeaf<'_, S>,
    packet: &mut Packet,
    base: usize,
    hit: mask64x8<S>,
    &Converged { st: [root_s, root_t], z, point, cross, speed, .. }: &Converged<S>,
    &Verdict { size, z_error, .. }: &Verdict<S>,
) {
    let TrueLeaf { target, numbers, .. } = leaves.on;
    let high = f64x8::splat(simd, 1.0);
    let t_from_z = f64x8::from_slice(simd, &packet.rays.t_from_z[base..base + 8]);
    let ray_t = z * t_from_z;
    let inverse = high / size;
    // A closer look is also due where the normal or `t` is not finite.
    let infinity = f64x8::splat(simd, f64::INFINITY);
    let mut close = !(inverse.simd_lt(infinity) & ray_t.simd_lt(infinity));
    if target.pole.is_some() {
        // It is also due where both tangents have nearly one direction, or where no certificate
        // says how well they are known.
        let least = f64x8::splat(simd, LEAST_SINE) * speed * speed;
        close |= !size.simd_gt(least) | simd.splat_mask64x8(!leaves.certified);
    }
    if numbers.has_near_sides {
        let distances = [root_s, high - root_s, root_t, high - root_t];
        for side in RectSide::ALL {
            close |= distances[side].simd_le(f64x8::splat(simd, target.near_side(side)));
        }
    }
    let normal = [cross[0] * inverse, cross[1] * inverse, cross[2] * inverse];
    let uv = surface_parameters(simd, target.piece, [root_s, root_t]);
    put(simd, hit, &mut packet.hits.z, base, z);
    put(simd, hit, &mut packet.hits.t, base, ray_t);
    put(simd, hit, &mut packet.hits.z_error, base, z_error);
    for i in 0..2 {
        put(simd, hit, &mut packet.hits.st[i], base, [root_s, root_t][i]);
        put(simd, hit, &mut packet.hits.uv[i], base, uv[i]);
    }
    put3(simd, hit, &mut packet.hits.point, base, point);
    put3(simd, hit, &mut packet.hits.normal, base, normal);
    let hits = hit.to_bitmask();
    packet.hits.met |= hits << base;
    packet.hits.needs_look &= !(hits << base);
    packet.hits.needs_look |= (close & hit).to_bitmask() << base;
    put_index(simd, hits, &mut packet.hits.leaf, base, target.index);
    put_index(simd, hits, &mut packet.hits.piece, base, target.leaf.piece);
    put_index(simd, hits, &mut packet.hits.surface, base, target.piece.surface);
    packet.shorten(simd, base, hits);
}

/// One bit for each of the sixteen rays from `base` on that passes the leaf's pole far enough away
/// for the leaf's certificate to hold.
#[cold]
#[simd]
pub(super) fn away_from_pole<S: Simd>(
    simd: S,
    target: &Target<'_>,
    pole: DVec3,
    packet: &Packet,
    base: usize,
) -> u32 {
    let patch = &target.piece.patch;
    let mut away = 0;
    for half in 0..2 {
        let base = base + 8 * half;
        let rays = PacketRays::new(simd, packet, base, patch.residual_factor(), patch.magnitude());
        let eight = target.is_away_from_pole(simd, pole, &rays).to_bitmask();
        away |= (eight as u32) << (8 * half);
    }
    away
}

/// Eight rays of a packet.
struct PacketRays<'a, S: Simd> {
    packet: &'a Packet,
    base: usize,
    error: f64x8<S>,
}

impl<'a, S: Simd> PacketRays<'a, S> {
    /// The rays from `base` on, for points whose error bound is `factor` times the larger of two
    /// magnitudes: the patch's, and that of the ray's origin.
    #[inline(always)]
    fn new(simd: S, packet: &'a Packet, base: usize, factor: f64, magnitude: f64) -> Self {
        let largest = eight(simd, &packet.rays.magnitude, base).max(f64x8::splat(simd, magnitude));
        Self { packet, base, error: f64x8::splat(simd, factor) * largest }
    }
}

impl<S: Simd> Rays<S> for PacketRays<'_, S> {
    #[inline(always)]
    fn origin(&self, simd: S) -> [f64x8<S>; 3] {
        load3d(simd, &self.packet.rays.origin, self.base)
    }

    #[inline(always)]
    fn axis(&self, simd: S) -> [f64x8<S>; 3] {
        load3d(simd, &self.packet.rays.axis, self.base)
    }

    #[inline(always)]
    fn normals(&self, simd: S) -> [[f64x8<S>; 3]; 2] {
        let [first, second] = &self.packet.rays.normals;
        [load3d(simd, first, self.base), load3d(simd, second, self.base)]
    }

    #[inline(always)]
    fn error(&self) -> f64x8<S> {
        self.error
    }
}

#[inline(always)]
fn eight<S: Simd>(simd: S, lanes: &[f64; PACKET], base: usize) -> f64x8<S> {
    f64x8::from_slice(simd, &lanes[base..base + 8])
}

/// Of the lanes that are asked for, those that the trims keep, and those not at an edge; for roots
/// known to within `reach` in each parameter.
#[simd]
fn kept_by_trims<S: Simd>(
    simd: S,
    target: &Target<'_>,
    numbers: &LeafNumbers,
    asked: mask64x8<S>,
    st: &[f64x8<S>; 2],
    reach: f64x8<S>,
) -> [mask64x8<S>; 2] {
    let window = target.view.windows.of(target.index);
    // The same eight twice; the bits of the second half mean nothing.
    let narrow = |lanes: f64x8<S>| simd.narrow_f64x8(lanes, lanes);
    let at = |k: usize| {
        let (middle, per_half) = (numbers.middle[k], numbers.per_half[k]);
        narrow((st[k] - f64x8::splat(simd, middle)) * f64x8::splat(simd, per_half))
    };
    let in_box = |k: usize| narrow(reach * f64x8::splat(simd, numbers.per_half[k]));
    let places = Places { at: [at(0), at(1)], reach: [in_box(0), in_box(1)] };
    let asked = asked.to_bitmask();
    let [kept, decided] = kept_in_window(simd, window, &places, asked as u32).map(u64::from);
    let [mut kept, mut decided] = [kept & decided, decided];
    // The trims themselves tell where the window does not.
    for k in set_bits(asked & !decided) {
        let side = target.piece.side(DVec2::new(st[0][k], st[1][k]), DVec2::splat(reach[k]));
        kept |= u64::from(side == Side::Inside) << k;
        decided |= u64::from(matches!(side, Side::Inside | Side::Outside)) << k;
    }
    [kept, decided].map(|bits| mask64x8::from_bitmask(simd, bits))
}

/// Of hits at the same place, the one on the first piece counts, and there the one on its first
/// part, whichever was searched first: so the order of the search does not matter.
#[simd]
fn earlier<S: Simd>(
    simd: S,
    tie: mask64x8<S>,
    target: &Target<'_>,
    packet: &Packet,
    base: usize,
) -> mask64x8<S> {
    if tie.all_false() {
        return tie;
    }
    let mut earlier = 0;
    for k in 0..8 {
        let first = !has(packet.hits.met, base + k)
            || comes_first(target.view.leaves, target.index, packet.hits.leaf[base + k]);
        earlier |= u64::from(first) << k;
    }
    tie & mask64x8::from_bitmask(simd, earlier)
}

/// [`Piece::uv`] for eight places.
#[inline(always)]
fn surface_parameters<S: Simd>(simd: S, piece: &Piece, st: [f64x8<S>; 2]) -> [f64x8<S>; 2] {
    let mut uv = st;
    if piece.is_placed() {
        for lane in 0..8 {
            let [u, v] = piece.uv(DVec2::new(st[0][lane], st[1][lane])).to_array();
            (uv[0][lane], uv[1][lane]) = (u, v);
        }
        return uv;
    }
    let domain = piece.domain();
    for k in 0..2 {
        let [from, to] = domain[k];
        let (from, to) = (f64x8::splat(simd, from), f64x8::splat(simd, to));
        let end = st[k].simd_eq(f64x8::splat(simd, 1.0));
        uv[k] = end.select(to, from + st[k] * (to - from));
        if let Some(end) = piece.open_end(k) {
            let last = f64x8::splat(simd, end.next_down());
            uv[k] = uv[k].simd_ge(to).select(last, uv[k]);
        }
    }
    uv
}

/// Replaces the lanes that `mask` selects.
#[simd]
fn put<S: Simd>(
    simd: S,
    mask: mask64x8<S>,
    lanes: &mut [f64; PACKET],
    base: usize,
    value: f64x8<S>,
) {
    let lanes = &mut lanes[base..base + 8];
    let old = f64x8::from_slice(simd, lanes);
    mask.select(value, old).store_slice(lanes);
}

#[simd]
fn put3<S: Simd>(
    simd: S,
    mask: mask64x8<S>,
    lanes: &mut Lanes3,
    base: usize,
    value: [f64x8<S>; 3],
) {
    for i in 0..3 {
        put(simd, mask, &mut lanes[i], base, value[i]);
    }
}

#[simd]
fn put_index<S: Simd>(simd: S, hits: u64, lanes: &mut [u32; PACKET], base: usize, value: u32) {
    let lanes = &mut lanes[base..base + 8];
    let (old, new) = (u32x8::from_slice(simd, lanes), u32x8::splat(simd, value));
    mask32x8::from_bitmask(simd, hits).select(new, old).store_slice(lanes);
}
