//! One leaf against the rays of a packet, sixteen at a time.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, mask64x8};
use fearless_simd_macros::simd;

use super::distances::{Approximate, LaneDistances};
use super::finish::finish;
use super::lane_proof::{LaneProof, Parts};
use super::load::{farthest, turn};
use super::packet::Packet;
use super::screen::{Screen, Screened};
use super::search::{bits, certify, cross_box, load3};
use super::single::Scene;
use super::single_proof::{REACH, START_REACH};
use super::single_ray::WIDENED;
use super::target::{Ground, Target};
use super::traverse::Work;
use super::{LANES, PACKET};
use crate::intersect::Statistics;
use crate::math::rounding;
use crate::patch::OrientedBox;

/// One leaf against the rays of the packet that may meet it, sixteen by sixteen: those whose bit is
/// set in `groups`.
#[simd]
pub(super) fn search_leaf<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    (index, oriented, groups): (u32, &OrientedBox, u32),
    packet: &mut Packet,
    work: &mut Work,
    statistics: &mut Statistics,
) {
    // The boxes of most leaves are missed by most rays: their data are only touched when they
    // are needed.
    let mut target = None;
    let mut found = false;
    let mut groups = groups;
    while groups != 0 {
        let base = LANES * groups.trailing_zeros() as usize;
        groups &= groups - 1;
        if base >= packet.count.min(PACKET) {
            break;
        }
        let crossing = cross_box(simd, oriented, packet, base);
        let met = bits(crossing.met);
        if met == 0 {
            continue;
        }
        if !packet.turned {
            turn(simd, packet);
        }
        let target = target.get_or_insert_with(|| Target::new(scene, oriented, index));
        let patch = &target.piece.patch;
        let factor = patch.residual_factor();
        statistics.leaf_tests += u64::from(met.count_ones());

        // The certificate, lane by lane.
        let magnitude = f32x16::from_slice(simd, &packet.magnitude_f[base..base + LANES])
            .max(f32x16::splat(simd, patch.magnitude() as f32));
        let certified = certify(simd, target.leaf, crossing.slopes, (magnitude, factor));
        let mut certain = met & bits(certified);
        let mut doubted = met & !certain;
        if packet.from_roots {
            // The one root of these is the one they start on.
            let certified = [target.certified(simd); 2];
            certain &= !packet.starts_in(simd, base, target.leaf.piece, &certified);
            if doubted != 0 {
                doubted &= !packet.departs_from(simd, base, target, (magnitude, factor));
            }
        }
        if certain | doubted == 0 {
            continue;
        }
        work.distances.take(simd, target.leaf, packet, base);
        let mut done = Done::default();
        if certain != 0 {
            let start = [crossing.x, crossing.y];
            let widened = f32x16::splat(simd, WIDENED as f32);
            let (near, step) = work.distances.newton(simd, start, [[-widened, widened]; 2]);
            let farthest = step.to[0].abs().max(step.to[1].abs());
            let outside = certain & !bits(farthest.simd_le(f32x16::splat(simd, 1.0)));
            if target.pole.is_none() && (outside != 0 || packet.any) {
                let screen = Screen {
                    target,
                    normals: [load3(simd, &packet.normals_f[0], base), load3(simd, &packet.normals_f[1], base)],
                    slope: crossing.slopes[2],
                    error: magnitude * f32x16::splat(simd, rounding::f32_above(factor)),
                };
                let Screened { missed, met } = screen.ask(simd, &step);
                certain &= !missed;
                if packet.any && !target.leaf.is_trimmed() {
                    let met = certain & met & packet.within_range(simd, base, &crossing);
                    packet.meet(simd, base, met);
                    certain &= !met;
                    doubted &= !met;
                    found |= met != 0;
                }
            }
            let lanes = (certain, Ground::Certificate);
            done = finish_all(simd, target, (&mut *packet, base), lanes, &near);
            doubted |= done.open;
        }
        let mut rest = done.judged;
        if doubted != 0 {
            let error = magnitude * f32x16::splat(simd, rounding::f32_above(factor));
            let lanes = (doubted, error);
            let proof = (&work.distances, &mut work.parts);
            let more = search_doubted(simd, target, (&mut *packet, base), proof, lanes);
            rest |= more.judged | more.open;
            done.found |= more.found;
            done.steps += more.steps;
        }
        found |= done.found;
        statistics.newton_iterations += u64::from(done.steps);
        work.leave(base, rest, index);
    }
    if found {
        packet.farthest = farthest(simd, packet);
    }
}

/// Sixteen rays against a leaf whose certificate does not speak of them, or whose one root was not
/// found: part by part, as far as their own proofs go. `error` is how far a point may be from the
/// ray. Lanes of which nothing is proved are open.
#[simd]
fn search_doubted<S: Simd>(
    simd: S,
    target: &Target<'_>,
    (packet, base): (&mut Packet, usize),
    (distances, parts): (&LaneDistances, &mut Parts),
    (lanes, error): (u32, f32x16<S>),
) -> Done {
    let mut all = Done::default();
    let rays = (&*packet, base);
    let mut proof = LaneProof::new(simd, (distances, parts), target.leaf, rays, (lanes, error));
    while let Some((part, lanes)) = proof.next() {
        let mut lanes = lanes & !all.judged;
        if packet.from_roots {
            // The one root of these is the one they start on.
            let start = part.widened(simd, START_REACH);
            let start = [target.parameters(simd, &start, 0), target.parameters(simd, &start, 1)];
            lanes &= !packet.starts_in(simd, base, target.leaf.piece, &start);
        }
        if lanes == 0 {
            continue;
        }
        let domain = part.widened(simd, REACH);
        let (near, _) = distances.newton(simd, part.middle, domain);
        let done =
            finish_all(simd, target, (&mut *packet, base), (lanes, Ground::Own(domain)), &near);
        // What leads out of the part may be missed by its halves.
        proof.go_on(&part, done.open);
        all.judged |= done.judged;
        all.found |= done.found;
        all.steps += done.steps;
    }
    all.open = proof.undecided;
    all
}

/// What became of sixteen rays.
#[derive(Clone, Copy, Default)]
struct Done {
    /// The lanes that did not converge.
    open: u32,
    /// The lanes whose root the scalar search must judge.
    judged: u32,
    /// Whether some ray's nearest hit is new.
    found: bool,
    /// Newton's steps taken, over all lanes.
    steps: u32,
}

/// [`finish`] for both halves of sixteen rays.
#[simd]
fn finish_all<S: Simd>(
    simd: S,
    target: &Target<'_>,
    (packet, base): (&mut Packet, usize),
    (lanes, ground): (u32, Ground<S>),
    near: &Approximate<f32x16<S>>,
) -> Done {
    let mut all = Done::default();
    for half in 0..2 {
        let wanted = u64::from(lanes >> (8 * half)) & 0xff;
        if wanted == 0 {
            continue;
        }
        let wanted = mask64x8::from_bitmask(simd, wanted);
        let (base, near) = (base + 8 * half, near.half(half));
        let done = finish(simd, target, packet, base, (wanted, &ground), &near);
        all.open |= (done.open as u32) << (8 * half);
        all.judged |= (done.judged as u32) << (8 * half);
        all.found |= done.found;
        all.steps += done.steps;
    }
    all
}
