//! Eight rays against one leaf, in f64 on the true surface.

use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, f64x8, mask32x8, mask64x8, u32x8,
};
use fearless_simd_macros::simd;

use glam::{DVec2, DVec3};

use super::PACKET;
use super::distances::Approximate;
use super::jets::{jets, points};
use super::packet::{Lanes3, Packet};
use super::search::{dot_d, load3d};
use super::single::{Scene, comes_first};
use super::single_finish::COARSEST;
use super::trimmed;
use crate::geometry::trim::Side;
use crate::intersect::leaf_search;
use crate::intersect::newton::{CLEAR, SURELY};
use crate::patch::{LEAF_SLACK, Leaf, OrientedBox, Piece, WIDENING};

/// Steps in f64 with the surface's own tangents: one is usual.
const MOST_STEPS: usize = 4;

/// How much of the promised error a last step may leave behind.
pub(super) const PART_OF_ERROR: f64 = 0.125;

/// A bound of how far the normal may turn in the last step, in radians. It is some times as large
/// as the turn itself, of which second derivatives from the middle of the leaf's approximation
/// leave a tenth or so.
const MOST_TURN: f64 = 1e-10;

/// A leaf, its piece, and which leaf it is.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) leaf: &'a Leaf,
    pub(super) piece: &'a Piece,
    pub(super) index: u32,
    scene: &'a Scene<'a>,
    oriented: &'a OrientedBox,
    rect: [[f64; 2]; 2],
    /// Where the leaf's certificate holds.
    pub(super) domain: [[f64; 2]; 2],
    /// The point the leaf ends in, if it does.
    pole: Option<DVec3>,
    /// How near a side of the piece a hit may be at a border of the surface; `None` if the
    /// leaf is away from all borders.
    reach: Option<[f64; 4]>,
    /// See [`FitError`](crate::patch::FitError).
    bend: f64,
    /// The approximation's second derivatives in the middle, by box coordinates: twice by the
    /// first, by both, twice by the second.
    second: [DVec3; 3],
}

impl<'a> Target<'a> {
    pub(super) fn new(scene: &'a Scene<'a>, oriented: &'a OrientedBox, index: u32) -> Self {
        let leaf = &scene.leaves[index as usize];
        let piece = &scene.set.pieces()[leaf.piece as usize];
        let (rect, domain) = (leaf.rect(), leaf.widened(piece, WIDENING));
        let pole = leaf.pole(piece);
        // Normals near a pole are left to the scalar code: all of the leaf is a border to it.
        let reach = match pole {
            Some(_) => Some([f64::INFINITY; 4]),
            None => leaf_search::border_reach(leaf, piece),
        };
        let second = leaf.second_derivatives();
        let bend = f64::from(leaf.fit_bend());
        Self { leaf, piece, index, scene, oriented, rect, domain, pole, reach, bend, second }
    }

    /// A rectangle of box coordinates, in the piece's parameters.
    pub(super) fn parameters(&self, rect: [[f32; 2]; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|k| {
            let [from, to] = self.rect[k];
            rect[k].map(|x| 0.5 * (from + to) + f64::from(x) * 0.5 * (to - from))
        })
    }
}

/// Why there is one root at most, and where.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Ground {
    /// The leaf's certificate speaks of the ray: in the widened leaf.
    Certificate,
    /// The ray's own proof: in a rectangle of box coordinates.
    Own([[f32; 2]; 2]),
}

/// What became of eight rays.
#[derive(Clone, Copy)]
pub(super) struct Done {
    /// The lanes that did not converge.
    pub(super) open: u64,
    /// The lanes whose root the scalar search must judge.
    pub(super) judged: u64,
    /// Whether some ray's nearest hit is new.
    pub(super) found: bool,
    /// Newton's steps taken, over all lanes.
    pub(super) steps: u32,
}

/// Newton's steps in f64 for rays `base … base + 7`, of which `wanted` take part, from what the
/// search in f32 has found; hits nearer than those known are put into the packet.
///
/// All of these rays have one root at most in the domain that `ground` tells. So a lane that
/// converges has found its one root: it is a hit if it lies in the leaf or its slack, else
/// that part of the leaf is proved to be missed; so it is where a step surely leads away, as the
/// certificate says. Also returns the lanes that did not converge, and those the scalar search must
/// judge: whose hit lies outside the piece or too near an end of the ray or the root it starts on.
///
/// The first step takes the true surface's point but the approximation's tangents: it leaves
/// about 1e-11 half sides, for little more than half of what a step with its own tangents costs.
#[simd]
pub(super) fn finish<S: Simd>(
    simd: S,
    target: &Target<'_>,
    packet: &mut Packet,
    base: usize,
    (wanted, ground): (mask64x8<S>, Ground),
    near: &Approximate<f64x8<S>>,
) -> Done {
    let [s_range, t_range] = target.rect;
    let half_s = f64x8::splat(simd, 0.5 * (s_range[1] - s_range[0]));
    let half_t = f64x8::splat(simd, 0.5 * (t_range[1] - t_range[0]));
    let sides_s = f64x8::splat(simd, 2.0 / (s_range[1] - s_range[0]));
    let sides_t = f64x8::splat(simd, 2.0 / (t_range[1] - t_range[0]));
    let middle_s = f64x8::splat(simd, 0.5 * (s_range[0] + s_range[1]));
    let middle_t = f64x8::splat(simd, 0.5 * (t_range[0] + t_range[1]));
    let [[s_low, s_high], [t_low, t_high]] = match ground {
        Ground::Certificate => target.domain,
        Ground::Own(rect) => target.parameters(rect),
    };
    let domain = [
        f64x8::splat(simd, s_low),
        f64x8::splat(simd, s_high),
        f64x8::splat(simd, t_low),
        f64x8::splat(simd, t_high),
    ];
    let reach = f64x8::splat(simd, 1.0 + 2.0 * LEAF_SLACK);
    let (outer_s, outer_t) = (half_s * reach, half_t * reach);

    let origin = load3d(simd, &packet.origin, base);
    let axis = load3d(simd, &packet.axis, base);
    let n1 = load3d(simd, &packet.normals[0], base);
    let n2 = load3d(simd, &packet.normals[1], base);
    let magnitude = f64x8::from_slice(simd, &packet.magnitude[base..base + 8]);
    let patch = &target.piece.patch;
    let error = f64x8::splat(simd, patch.residual_factor())
        * magnitude.max(f64x8::splat(simd, patch.magnitude()));

    let zero = f64x8::splat(simd, 0.0);
    let mut open = wanted;
    let mut near_pole = simd.splat_mask64x8(false);
    if let (Some(pole), Ground::Certificate) = (target.pole, ground) {
        let offset = [
            f64x8::splat(simd, pole.x) - origin[0],
            f64x8::splat(simd, pole.y) - origin[1],
            f64x8::splat(simd, pole.z) - origin[2],
        ];
        let (f1, f2) = (dot_d(n1, offset), dot_d(n2, offset));
        let distance = f1.mul_add(f1, f2 * f2).sqrt();
        let [_, _, normal] = target.oriented.directions();
        let steep = dot_d(splat3(simd, normal), axis).abs();
        let needed = f64::from(target.leaf.certificate.pole_per_error());
        let away = (error * f64x8::splat(simd, needed)).simd_le(steep * distance);
        near_pole = open & !away;
        open &= away;
    }

    // The step with the approximation's tangents; NaN becomes a bound.
    let mut s = near.x.mul_add(half_s, middle_s).max(domain[0]).min(domain[1]);
    let mut t = near.y.mul_add(half_t, middle_t).max(domain[2]).min(domain[3]);
    let place = points(simd, patch, s, t);
    let from_origin = [place[0] - origin[0], place[1] - origin[1], place[2] - origin[2]];
    let (f1, f2) = (dot_d(n1, from_origin), dot_d(n2, from_origin));
    let [[xx, xy], [yx, yy]] = near.inverse;
    s = (s - half_s * xx.mul_add(f1, xy * f2)).max(domain[0]).min(domain[1]);
    t = (t - half_t * yx.mul_add(f1, yy * f2)).max(domain[2]).min(domain[3]);

    let mut found = simd.splat_mask64x8(false);
    let (mut root_s, mut root_t, mut z, mut inverse_det) = (zero, zero, zero, zero);
    let mut speed = zero;
    let mut point = [zero; 3];
    let mut cross = [zero; 3];
    let mut steps = open.to_bitmask().count_ones();
    let bend = f64x8::splat(simd, target.bend);
    let least = error * f64x8::splat(simd, PART_OF_ERROR);
    for _ in 0..MOST_STEPS {
        steps += open.to_bitmask().count_ones();
        let jets = jets(simd, patch, s, t);
        let from_origin =
            [jets.point[0] - origin[0], jets.point[1] - origin[1], jets.point[2] - origin[2]];
        let (f1, f2) = (dot_d(n1, from_origin), dot_d(n2, from_origin));
        let (a1, a2) = (dot_d(n1, jets.ds), dot_d(n2, jets.ds));
        let (b1, b2) = (dot_d(n1, jets.dt), dot_d(n2, jets.dt));
        let inverse = f64x8::splat(simd, 1.0) / (a1 * b2 - a2 * b1);
        let step_s = (f1 * b2 - f2 * b1) * inverse;
        let step_t = (a1 * f2 - a2 * f1) * inverse;
        let new_s = s - step_s;
        let new_t = t - step_t;
        // The normal after the step.
        let (move_x, move_y) = (step_s * sides_s, step_t * sides_t);
        let mut tangents = [jets.ds, jets.dt];
        for i in 0..3 {
            let [xx, xy, yy] = target.second;
            let (xx, xy) = (f64x8::splat(simd, xx[i]), f64x8::splat(simd, xy[i]));
            let yy = f64x8::splat(simd, yy[i]);
            tangents[0][i] -= xx.mul_add(move_x, xy * move_y) * sides_s;
            tangents[1][i] -= xy.mul_add(move_x, yy * move_y) * sides_t;
        }
        let mut across = [zero; 3];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            across[i] = tangents[0][j] * tangents[1][k] - tangents[0][k] * tangents[1][j];
        }

        // Converged where the residual is within the error; or will be after this step, which
        // the bend bounds, as it does the turn of the normal.
        let residual = f1.mul_add(f1, f2 * f2);
        let close = residual.simd_le(error * error);
        let longest = move_x.abs().max(move_y.abs());
        let bent = bend * longest;
        let (speed_s, speed_t) = (sum_of_sizes(jets.ds), sum_of_sizes(jets.dt));
        let sides = half_s * speed_s + half_t * speed_t;
        let turn = (bent + bent) * sides;
        let least_turn = f64x8::splat(simd, MOST_TURN) * half_s * half_t;
        let straight = (turn * turn).simd_le(least_turn * least_turn * dot_d(across, across));
        let inside = new_s.simd_ge(domain[0])
            & new_s.simd_le(domain[1])
            & new_t.simd_ge(domain[2])
            & new_t.simd_le(domain[3]);
        let done = close | ((bent * longest).simd_le(least) & straight & inside);

        // What is left of the distance is taken off along the tangent plane.
        let new = done & open;
        root_s = new.select(new_s, root_s);
        root_t = new.select(new_t, root_t);
        inverse_det = new.select(inverse, inverse_det);
        speed = new.select(speed_s + speed_t, speed);
        let mut along = zero;
        for i in 0..3 {
            let moved = jets.point[i] - jets.ds[i] * step_s - jets.dt[i] * step_t;
            point[i] = new.select(moved, point[i]);
            along = axis[i].mul_add(moved - origin[i], along);
            cross[i] = new.select(across[i], cross[i]);
        }
        z = new.select(along, z);
        found |= new;
        open &= !new;
        if open.all_false() {
            break;
        }
        if ground == Ground::Certificate {
            open &= !surely_away(simd, target, (s, t), (step_s, step_t), (f1, f2), n1, n2, error);
            if open.all_false() {
                break;
            }
        }
        // Steps stay where the certificate holds; NaN becomes a bound.
        s = new_s.max(domain[0]).min(domain[1]);
        t = new_t.max(domain[2]).min(domain[3]);
    }

    // The leaf and its slack.
    let inside =
        (root_s - middle_s).abs().simd_le(outer_s) & (root_t - middle_t).abs().simd_le(outer_t);
    found &= inside;
    let open = (open | near_pole).to_bitmask();
    if found.all_false() {
        return Done { open, judged: 0, found: false, steps };
    }

    // Roots outside the piece, and those too near the ray's ends, are judged elsewhere.
    let (low, high) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
    let on_piece =
        root_s.simd_ge(low) & root_s.simd_le(high) & root_t.simd_ge(low) & root_t.simd_le(high);
    let z_min = f64x8::from_slice(simd, &packet.z_min[base..base + 8]);
    let best = f64x8::from_slice(simd, &packet.z[base..base + 8]);
    let size = dot_d(cross, cross).sqrt();
    // One over the cosine is `|a × b| / det`.
    let steepest = f64x8::splat(simd, 1.0 / f64::EPSILON);
    let z_error = error * (size * inverse_det.abs()).min(steepest);
    let mut near_end = z_error + z_error;
    let mut clear = wanted;
    if packet.from_roots {
        near_end += f64x8::from_slice(simd, &packet.from_error[base..base + 8]);
        clear = z.abs().simd_gt(near_end);
    }
    let z_max = f64x8::from_slice(simd, &packet.z_max[base..base + 8]);
    clear &= (z.simd_ge(z_min + near_end) | z.simd_le(z_min - near_end))
        & (z.simd_le(z_max - near_end) | z.simd_ge(z_max + near_end));
    let mut judged = found & (!on_piece | !clear);
    if ground != Ground::Certificate {
        // Rounding of a parameter must be small against the error: no certificate has looked at it.
        judged |= found & !(f64x8::splat(simd, COARSEST) * speed).simd_le(error);
    }
    let acceptable = found & !judged & z.simd_gt(z_min);
    let tie = acceptable & z.simd_eq(best);
    let mut hit = acceptable & z.simd_lt(best) | earlier(simd, tie, target, packet, base);
    if target.leaf.is_trimmed() {
        // Also what is as near as the nearest, as far as can be known: it may be an edge.
        let asked = acceptable & z.simd_le(best + near_end);
        let reach = f64x8::splat(simd, trimmed::REACH) * z_error * speed / size;
        let sides = trim_sides(target, asked, (root_s, root_t), reach);
        hit &= mask64x8::from_bitmask(simd, sides.inside);
        judged |= mask64x8::from_bitmask(simd, sides.edge);
    }

    let any = hit.any_true();
    if any && packet.any {
        // Nothing more is asked of these rays.
        let hits = hit.to_bitmask();
        put(simd, hit, &mut packet.z, base, f64x8::splat(simd, f64::NEG_INFINITY));
        put_index(simd, hits, &mut packet.leaf, base, target.index);
        packet.shorten(simd, base, hits);
    } else if any {
        let t_from_z = f64x8::from_slice(simd, &packet.t_from_z[base..base + 8]);
        let ray_t = z * t_from_z;
        let inverse = high / size;
        // A closer look is also due where the normal is not a number, or there is none for `t`.
        let infinity = f64x8::splat(simd, f64::INFINITY);
        let mut close = !(inverse.simd_lt(infinity) & ray_t.simd_lt(infinity));
        if let Some(reach) = target.reach {
            let distances = [root_s, high - root_s, root_t, high - root_t];
            for side in 0..4 {
                close |= distances[side].simd_le(f64x8::splat(simd, reach[side]));
            }
        }
        let normal = [cross[0] * inverse, cross[1] * inverse, cross[2] * inverse];
        let uv = surface_parameters(simd, target.piece, [root_s, root_t]);
        put(simd, hit, &mut packet.z, base, z);
        put(simd, hit, &mut packet.ray_t, base, ray_t);
        put(simd, hit, &mut packet.z_error, base, z_error);
        for i in 0..2 {
            put(simd, hit, &mut packet.st[i], base, [root_s, root_t][i]);
            put(simd, hit, &mut packet.uv[i], base, uv[i]);
        }
        put3(simd, hit, &mut packet.point, base, point);
        put3(simd, hit, &mut packet.normal, base, normal);
        let hits = hit.to_bitmask();
        packet.near_border &= !(hits << base);
        packet.near_border |= (close & hit).to_bitmask() << base;
        put_index(simd, hits, &mut packet.leaf, base, target.index);
        put_index(simd, hits, &mut packet.piece, base, target.leaf.piece);
        put_index(simd, hits, &mut packet.surface, base, target.piece.surface);
        packet.shorten(simd, base, hits);
    }
    Done { open, judged: judged.to_bitmask(), found: any, steps }
}

/// Lanes by their side of the trims.
#[derive(Clone, Copy, Default)]
struct Sides {
    inside: u64,
    edge: u64,
}

/// The sides of the lanes that are asked for, of roots known to `reach` in each parameter.
#[inline(always)]
fn trim_sides<S: Simd>(
    target: &Target<'_>,
    asked: mask64x8<S>,
    (s, t): (f64x8<S>, f64x8<S>),
    reach: f64x8<S>,
) -> Sides {
    let mut sides = Sides::default();
    let mut lanes = asked.to_bitmask();
    while lanes != 0 {
        let k = lanes.trailing_zeros() as usize;
        lanes &= lanes - 1;
        match target.piece.side(DVec2::new(s[k], t[k]), DVec2::splat(reach[k])) {
            Side::Inside => sides.inside |= 1 << k,
            Side::Outside => {}
            Side::Edge { .. } => sides.edge |= 1 << k,
        }
    }
    sides
}

/// Where a step from beyond the leaf surely leads away from it, so that it is missed, as in the
/// scalar search.
#[simd]
#[expect(clippy::too_many_arguments, reason = "what a Newton step has at hand")]
fn surely_away<S: Simd>(
    simd: S,
    target: &Target<'_>,
    (s, t): (f64x8<S>, f64x8<S>),
    (step_s, step_t): (f64x8<S>, f64x8<S>),
    (f1, f2): (f64x8<S>, f64x8<S>),
    n1: [f64x8<S>; 3],
    n2: [f64x8<S>; 3],
    error: f64x8<S>,
) -> mask64x8<S> {
    let [outer_s, outer_t] = target.rect.map(|[from, to]| {
        let reach = 1.0 + 2.0 * LEAF_SLACK;
        f64x8::splat(simd, 0.5 * (to - from) * reach)
    });
    let [middle_s, middle_t] = target.rect.map(|[from, to]| f64x8::splat(simd, 0.5 * (from + to)));
    let (from_middle_s, from_middle_t) = (s - middle_s, t - middle_t);
    let beyond_s = from_middle_s.abs().simd_gt(outer_s);
    let beyond_t = from_middle_t.abs().simd_gt(outer_t);
    if (beyond_s | beyond_t).all_false() {
        return beyond_s;
    }
    let zero = f64x8::splat(simd, 0.0);
    let residual = f1.mul_add(f1, f2 * f2);
    let g = [f1 * n2[0] - f2 * n1[0], f1 * n2[1] - f2 * n1[1], f1 * n2[2] - f2 * n1[2]];
    let [a, b, n] = target.oriented.unit_axes();
    let across_a = dot_d(splat3(simd, a), g).abs();
    let across_b = dot_d(splat3(simd, b), g).abs();
    let normal = dot_d(splat3(simd, n), g).abs();
    let rest = residual.sqrt() * f64x8::splat(simd, SURELY);
    let [[other_s, out_s], [other_t, out_t]] = target.leaf.certificate.bend();
    let turned_s = across_a
        .mul_add(f64x8::splat(simd, other_s), normal.mul_add(f64x8::splat(simd, out_s), rest));
    let turned_t = across_b
        .mul_add(f64x8::splat(simd, other_t), normal.mul_add(f64x8::splat(simd, out_t), rest));
    // The step leads away where it has the sign of the place's side.
    let away_s = beyond_s & (from_middle_s * step_s).simd_lt(zero);
    let away_t = beyond_t & (from_middle_t * step_t).simd_lt(zero);
    let (sure_s, sure_t) = (across_b.simd_gt(turned_s), across_a.simd_gt(turned_t));
    let clear = residual.simd_gt(error * error * f64x8::splat(simd, CLEAR * CLEAR));
    clear & (away_s & sure_s | away_t & sure_t)
}

/// Of hits at the same place the piece that comes first counts, and its first part, whichever
/// was searched first: so the order of the search does not matter.
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
        let known = packet.leaf[base + k];
        let first = known == u32::MAX || comes_first(target.scene.leaves, target.index, known);
        earlier |= u64::from(first) << k;
    }
    tie & mask64x8::from_bitmask(simd, earlier)
}

/// [`Piece::uv`] for eight places.
#[simd]
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
        let [from, to] = domain[k].map(|end| f64x8::splat(simd, end));
        let end = st[k].simd_eq(f64x8::splat(simd, 1.0));
        uv[k] = end.select(to, from + st[k] * (to - from));
        if let Some(end) = piece.open_end(k) {
            let last = f64x8::splat(simd, end.next_down());
            uv[k] = uv[k].simd_ge(to).select(last, uv[k]);
        }
    }
    uv
}

/// The sum of the components' sizes: no less than the length.
#[inline(always)]
fn sum_of_sizes<S: Simd>([x, y, z]: [f64x8<S>; 3]) -> f64x8<S> {
    x.abs() + y.abs() + z.abs()
}

#[simd]
fn splat3<S: Simd>(simd: S, v: DVec3) -> [f64x8<S>; 3] {
    [f64x8::splat(simd, v.x), f64x8::splat(simd, v.y), f64x8::splat(simd, v.z)]
}

/// Replaces the lanes of a mask.
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
