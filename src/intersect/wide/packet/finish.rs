//! Sixteen rays against one leaf, in f64 on the true surface, as many at a time as fill a register.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3};

use super::hits::NearestHits;
use super::one_leaf::{OneLeaf, TrueLeaf, Uniqueness};
use super::rays::Packet;
use super::target::{LeafNumbers, Target};
use crate::geometry::RectSide;
use crate::geometry::trim::Side;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::nearest::comes_first;
use crate::intersect::wide::search::distances::part_in_f64;
use crate::intersect::wide::search::newton::{Converged, Ends, Rays, Verdict, newton};
use crate::intersect::wide::trimmed::{Places, kept_in_window};
use crate::intersect::wide::vectors::{Reals, dot_d, load, load3d};
use crate::intersect::wide::{PACKET, trimmed};
use crate::math::bits::{has, set_bits};
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
    /// The lanes whose nearest hit is new.
    pub(super) hits: u32,
    /// Those of them that need a closer look: see [`NearestHits::needs_look`].
    pub(super) close: u32,
    /// Newton's steps taken, over all lanes.
    pub(super) steps: u32,
}

impl Done {
    /// Adds the outcome for further lanes, from `lane` on.
    #[inline(always)]
    fn add(&mut self, other: &Self, lane: usize) {
        self.unconverged |= other.unconverged << lane;
        self.undecided |= other.undecided << lane;
        self.at_edge |= other.at_edge << lane;
        self.hits |= other.hits << lane;
        self.close |= other.close << lane;
        self.steps += other.steps;
    }
}

/// Takes Newton's steps in f64 for those of rays `base … base + 15` whose bit is set in `lanes`,
/// from the places `near` that the search in f32 has found; hits nearer than those known are put
/// into the packet.
///
/// Each of these rays has at most one root in the domain that `unique` gives. Also returns the
/// lanes that did not converge, and those that the scalar search must judge: whose hit lies outside
/// the piece, or too near an end of the ray or the root it starts on.
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
    let together = S::f64s::LEN;
    for first in (0..LANES).step_by(together) {
        let wanted = u64::from(lanes >> first) & ((1 << together) - 1);
        if wanted == 0 {
            continue;
        }
        let wanted = <S::mask64s as SimdMask<S>>::from_bitmask(simd, wanted);
        let near = [part_in_f64(simd, near[0], first), part_in_f64(simd, near[1], first)];
        all.add(&finish(simd, leaf, packet, base + first, wanted, unique, &near), first);
    }
    if all.hits == 0 {
        return all;
    }
    if packet.wanted == Wanted::Any {
        // Nothing more is asked of these rays.
        packet.meet(simd, base, all.hits);
        return all;
    }
    let Done { hits, close, .. } = all;
    packet.hits.met |= u64::from(hits) << base;
    packet.hits.needs_look &= !(u64::from(hits) << base);
    packet.hits.needs_look |= u64::from(close) << base;
    let Target { index, piece, leaf, .. } = *leaf.target;
    put_index(simd, hits, &mut packet.hits.leaf, base, index);
    put_index(simd, hits, &mut packet.hits.piece, base, leaf.piece);
    put_index(simd, hits, &mut packet.hits.surface, base, piece.surface);
    packet.shorten(simd, base, hits);
    all
}

/// [`finish_all`] for as many rays, from `base` on, as a register holds, but for what can be noted
/// for all sixteen at once.
#[simd]
fn finish<S: Simd>(
    simd: S,
    leaf: TrueLeaf<'_>,
    packet: &mut Packet,
    base: usize,
    wanted: S::mask64s,
    unique: &Uniqueness<S>,
    near: &[S::f64s; 2],
) -> Done {
    let TrueLeaf { target, numbers, .. } = leaf;
    let (certified, domain) = match unique {
        Uniqueness::Certificate => (true, target.certified(simd)),
        Uniqueness::Own(rect) => {
            let part = |ends| part_in_f64(simd, ends, base % LANES);
            (false, target.parameters(simd, rect, part))
        }
    };
    let leaves = OneLeaf { on: leaf, domain, certified, places: packet.wanted != Wanted::Any };
    let rays: PacketRays<'_, S::f64s> =
        PacketRays::new(simd, packet, base, numbers.residual_factor, numbers.magnitude);
    let error = rays.error;
    let mut near_pole = <S::mask64s as SimdMask<S>>::splat(simd, false);
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
        root.inverse_det = S::f64s::splat(simd, 1.0) / dot_d(root.cross, rays.axis(simd));
    }
    let Converged { z, speed, .. } = root;
    let from_error = load(simd, &packet.starts.error, base);
    let ends = Ends {
        z: [load(simd, &packet.rays.z_min, base), load(simd, &packet.rays.z_max, base)],
        from_error: if packet.starts.exist { Some(from_error) } else { None },
    };
    let best: S::f64s = load(simd, &packet.hits.z, base);
    let verdict = root.verdict(simd, &ends, error, certified);
    let Verdict { size, z_error, mut undecided, at_end, acceptable, near_end } = verdict;
    let tie = acceptable & z.simd_eq(best);
    let mut hit = acceptable & z.simd_lt(best) | earlier(simd, tie, target, packet, base);
    let mut at_edge = 0;
    if target.leaf.is_trimmed() {
        // Also asks about roots that cannot be told from the nearest hit: these may lie at an edge.
        let from = z - near_end;
        let asked = acceptable & from.simd_le(best);
        let reach = S::f64s::splat(simd, trimmed::EDGE_REACH) * z_error * speed / size;
        let [kept, decided] = kept_by_trims(simd, target, numbers, asked | at_end, &root.st, reach);
        hit &= kept;
        undecided &= !(decided & !kept);
        at_edge = (asked & !decided).to_bitmask() as u32;
        if at_edge != 0 {
            from.store_slice(&mut packet.edges.0[base..base + S::f64s::LEN]);
        }
    }

    let mut close = 0;
    if hit.any_true() && packet.wanted != Wanted::Any {
        close = put_hits(simd, &leaves, packet, base, hit, &root, &verdict);
    }
    let [undecided, hits] = [undecided, hit].map(|lanes| lanes.to_bitmask() as u32);
    Done { unconverged, undecided, at_edge, hits, close, steps }
}

/// Puts hits into a packet: the roots of the lanes in `hit`, each its ray's nearest so far. Returns
/// those that need a closer look.
#[inline(always)] // what goes in are dozens of vectors
fn put_hits<S: Simd, V: Reals<S>>(
    simd: S,
    leaves: &OneLeaf<'_, V>,
    packet: &mut Packet,
    base: usize,
    hit: V::Mask,
    &Converged { st: [root_s, root_t], z, point, cross, speed, .. }: &Converged<S, V>,
    &Verdict { size, z_error, .. }: &Verdict<S, V>,
) -> u32 {
    let TrueLeaf { target, numbers, .. } = leaves.on;
    let high = V::splat(simd, 1.0);
    let t_from_z: V = load(simd, &packet.rays.t_from_z, base);
    let ray_t = z * t_from_z;
    let inverse = high / size;
    // A closer look is also due where the normal or `t` is not finite.
    let infinity = V::splat(simd, f64::INFINITY);
    let mut close = !(inverse.simd_lt(infinity) & ray_t.simd_lt(infinity));
    if target.leaf.has_short_tangents() {
        // It is also due where one tangent is far shorter than the other, where both have nearly one
        // direction, or where no certificate says how well they are known.
        let least = V::splat(simd, LEAST_SINE) * speed * speed;
        close |= !size.simd_gt(least) | V::Mask::splat(simd, !leaves.certified);
    }
    if numbers.has_near_sides {
        let distances = [root_s, high - root_s, root_t, high - root_t];
        for side in RectSide::ALL {
            close |= distances[side].simd_le(V::splat(simd, target.near_side(side)));
        }
    }
    let normal = [cross[0] * inverse, cross[1] * inverse, cross[2] * inverse];
    let uv = surface_parameters(simd, target.piece, [root_s, root_t]);
    let found = Found { z, z_error, t: ray_t, st: [root_s, root_t], uv, point, normal };
    // Where registers are narrow, processors may be slow to store some lanes only; most hits come
    // together. Measured on Zen 3 with AVX2: `finish_all` takes 0.83 of the time.
    if V::LEN < 8 && hit.all_true() {
        found.put::<S, true>(simd, hit, &mut packet.hits, base);
    } else {
        found.put::<S, false>(simd, hit, &mut packet.hits, base);
    }
    (close & hit).to_bitmask() as u32
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
    for first in (0..LANES).step_by(S::f64s::LEN) {
        let (factor, magnitude) = (patch.residual_factor(), patch.magnitude());
        let rays: PacketRays<'_, S::f64s> =
            PacketRays::new(simd, packet, base + first, factor, magnitude);
        let some = target.is_away_from_pole(simd, pole, &rays).to_bitmask();
        away |= (some as u32) << first;
    }
    away
}

/// Rays of a packet.
struct PacketRays<'a, V> {
    packet: &'a Packet,
    base: usize,
    error: V,
}

impl<'a, V> PacketRays<'a, V> {
    /// The rays from `base` on, for points whose error bound is `factor` times the larger of two
    /// magnitudes: the patch's, and that of the ray's origin.
    #[inline(always)]
    fn new<S: Simd>(simd: S, packet: &'a Packet, base: usize, factor: f64, magnitude: f64) -> Self
    where
        V: Reals<S>,
    {
        let own: V = load(simd, &packet.rays.magnitude, base);
        let error = V::splat(simd, factor) * own.max(V::splat(simd, magnitude));
        Self { packet, base, error }
    }
}

impl<S: Simd, V: Reals<S>> Rays<S, V> for PacketRays<'_, V> {
    #[inline(always)]
    fn origin(&self, simd: S) -> [V; 3] {
        load3d(simd, &self.packet.rays.origin, self.base)
    }

    #[inline(always)]
    fn axis(&self, simd: S) -> [V; 3] {
        load3d(simd, &self.packet.rays.axis, self.base)
    }

    #[inline(always)]
    fn normals(&self, simd: S) -> [[V; 3]; 2] {
        let [first, second] = &self.packet.rays.normals;
        [load3d(simd, first, self.base), load3d(simd, second, self.base)]
    }

    #[inline(always)]
    fn error(&self) -> V {
        self.error
    }
}

/// Of the lanes that are asked for, those that the trims keep, and those not at an edge; for roots
/// known to within `reach` in each parameter.
#[simd]
fn kept_by_trims<S: Simd>(
    simd: S,
    target: &Target<'_>,
    numbers: &LeafNumbers,
    asked: S::mask64s,
    st: &[S::f64s; 2],
    reach: S::f64s,
) -> [S::mask64s; 2] {
    let window = target.view.windows.of(target.index);
    // The bits of lanes left over mean nothing.
    let mut places =
        Places { at: [f32x16::splat(simd, 0.0); 2], reach: [f32x16::splat(simd, 0.0); 2] };
    for k in 0..2 {
        let (middle, per_half) = (numbers.middle[k], numbers.per_half[k]);
        let at = (st[k] - S::f64s::splat(simd, middle)) * S::f64s::splat(simd, per_half);
        let in_box = reach * S::f64s::splat(simd, per_half);
        for lane in 0..S::f64s::LEN {
            (places.at[k][lane], places.reach[k][lane]) = (at[lane] as f32, in_box[lane] as f32);
        }
    }
    let asked = asked.to_bitmask();
    let [kept, decided] = kept_in_window(simd, window, &places, asked as u32).map(u64::from);
    let [mut kept, mut decided] = [kept & decided, decided];
    // The trims themselves tell where the window does not.
    for k in set_bits(asked & !decided) {
        let side = target.piece.side(DVec2::new(st[0][k], st[1][k]), DVec2::splat(reach[k]));
        kept |= u64::from(side == Side::Inside) << k;
        decided |= u64::from(matches!(side, Side::Inside | Side::Outside)) << k;
    }
    [kept, decided].map(|bits| <S::mask64s as SimdMask<S>>::from_bitmask(simd, bits))
}

/// Of hits at the same place, the one on the first piece counts, and there the one on its first
/// part, whichever was searched first: so the order of the search does not matter.
#[simd]
fn earlier<S: Simd, M: SimdMask<S>>(
    simd: S,
    tie: M,
    target: &Target<'_>,
    packet: &Packet,
    base: usize,
) -> M {
    if tie.all_false() {
        return tie;
    }
    let mut earlier = 0;
    for k in 0..M::LEN {
        let first = !has(packet.hits.met, base + k)
            || comes_first(target.view.leaves, target.index, packet.hits.leaf[base + k]);
        earlier |= u64::from(first) << k;
    }
    tie & M::from_bitmask(simd, earlier)
}

/// [`Piece::uv`] for some places.
#[inline(always)]
fn surface_parameters<S: Simd, V: Reals<S>>(simd: S, piece: &Piece, st: [V; 2]) -> [V; 2] {
    let mut uv = st;
    if piece.is_placed() {
        for lane in 0..V::LEN {
            let [u, v] = piece.uv(DVec2::new(st[0][lane], st[1][lane])).to_array();
            (uv[0][lane], uv[1][lane]) = (u, v);
        }
        return uv;
    }
    let domain = piece.domain();
    for k in 0..2 {
        let [from, to] = domain[k];
        let (from, to) = (V::splat(simd, from), V::splat(simd, to));
        let end = st[k].simd_eq(V::splat(simd, 1.0));
        uv[k] = end.select(to, from + st[k] * (to - from));
        if let Some(end) = piece.open_end(k) {
            let last = V::splat(simd, end.next_down());
            uv[k] = uv[k].simd_ge(to).select(last, uv[k]);
        }
    }
    uv
}

/// Hits, a lane each: see [`NearestHits`].
struct Found<V> {
    z: V,
    z_error: V,
    t: V,
    st: [V; 2],
    uv: [V; 2],
    point: [V; 3],
    normal: [V; 3],
}

impl<V> Found<V> {
    /// Puts the lanes in `hit`, `ALL` or some, into the nearest hits of the rays from `base` on.
    #[inline(always)]
    fn put<S: Simd, const ALL: bool>(
        &self,
        simd: S,
        hit: V::Mask,
        hits: &mut NearestHits,
        base: usize,
    ) where
        V: Reals<S>,
    {
        put::<S, V, ALL>(simd, hit, &mut hits.z, base, self.z);
        put::<S, V, ALL>(simd, hit, &mut hits.z_error, base, self.z_error);
        put::<S, V, ALL>(simd, hit, &mut hits.t, base, self.t);
        for k in 0..2 {
            put::<S, V, ALL>(simd, hit, &mut hits.st[k], base, self.st[k]);
            put::<S, V, ALL>(simd, hit, &mut hits.uv[k], base, self.uv[k]);
        }
        for i in 0..3 {
            put::<S, V, ALL>(simd, hit, &mut hits.point[i], base, self.point[i]);
            put::<S, V, ALL>(simd, hit, &mut hits.normal[i], base, self.normal[i]);
        }
    }
}

/// Replaces the lanes in `hit`, `ALL` or some.
#[inline(always)]
fn put<S: Simd, V: Reals<S>, const ALL: bool>(
    simd: S,
    hit: V::Mask,
    lanes: &mut [f64; PACKET],
    base: usize,
    value: V,
) {
    let lanes = &mut lanes[base..base + V::LEN];
    if ALL {
        return value.store_slice(lanes);
    }
    let old = V::from_slice(simd, lanes);
    hit.select(value, old).store_slice(lanes);
}

/// Replaces those of sixteen numbers whose bit is set.
#[simd]
fn put_index<S: Simd>(simd: S, hits: u32, lanes: &mut [u32; PACKET], base: usize, value: u32) {
    let lanes = &mut lanes[base..base + LANES];
    let (old, new) = (u32x16::from_slice(simd, lanes), u32x16::splat(simd, value));
    mask32x16::from_bitmask(simd, u64::from(hits)).select(new, old).store_slice(lanes);
}
