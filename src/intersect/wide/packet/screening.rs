//! What the search in f32 proves of sixteen rays of a packet, before anything is done in f64.

use fearless_simd::{Simd, SimdBase, f32x16};
use fearless_simd_macros::simd;

use super::box_passage::BoxPassage;
use super::rays::Packet;
use super::target::Target;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::proof::certified::upright;
use crate::intersect::wide::proof::screen::{INSIDE, Screen, Screened};
use crate::intersect::wide::search::distances::{NearRoots, terms};
use crate::intersect::wide::vectors::lane_bits;

/// Some of sixteen rays.
#[derive(Clone, Copy)]
pub(super) struct Asked<S: Simd> {
    /// A bit for each that is meant.
    pub(super) lanes: u32,
    /// The error bound of a point's distance from the ray.
    pub(super) error: f32x16<S>,
}

/// A leaf's distances from sixteen rays, and the places near roots that the search in f32 found.
pub(super) struct Searched<'a, S: Simd> {
    /// The distances in the leaf's middle.
    pub(super) middle: [f32x16<S>; 2],
    pub(super) near: &'a NearRoots<S>,
}

/// Returns what the last step of the search in f32 proves of the rays that cross the leaf's box,
/// for those that are asked for; the leaf's certificate holds for them.
#[simd]
pub(super) fn screen<S: Simd>(
    simd: S,
    target: &Target<'_>,
    packet: &Packet,
    passage: &BoxPassage<S>,
    Searched { middle, near }: Searched<'_, S>,
    Asked { lanes, error }: Asked<S>,
) -> Screened {
    // Rays that hit the leaf, as most do, are not worth screening if more is wanted of them; beside
    // others, those that trims cut off are told, too.
    let [x, y] = near.last.to;
    let farthest = x.abs().max(y.abs());
    let outside = lanes & !lane_bits(farthest.simd_le(f32x16::splat(simd, INSIDE)));
    if target.pole.is_some() || (outside == 0 && packet.wanted != Wanted::Any) {
        return Screened::default();
    }
    let rays = packet.sixteen(passage.base);
    let screen = Screen {
        leaf: target.leaf,
        oriented: target.oriented,
        normals: rays.normals(simd),
        upright: upright(simd, target.leaf, passage.slopes),
        terms: terms(simd, target.fitted(), middle, rays),
        error: error * f32x16::splat(simd, target.fitted().heaviest()),
        window: target.view.windows.of(target.index),
    };
    let Screened { missed, met } = screen.ask(simd, near, lanes);
    let met =
        if packet.wanted == Wanted::Any { met & packet.within_range(simd, passage) } else { 0 };
    Screened { missed, met }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::{DVec2, DVec3};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
    use crate::geometry::{NurbsSurface, TrimmedSurface, shapes};
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::packet::box_passage::pass_box;
    use crate::intersect::wide::packet::load::{find_planes, load};
    use crate::intersect::wide::proof::certified::certify;
    use crate::intersect::wide::reach::WIDENED;
    use crate::intersect::wide::search::distances::{LaneDistances, step_from_middle};
    use crate::intersect::wide::testing::weighted_hills;
    use crate::intersect::{Hit, Query, SurfaceBvh};
    use crate::math::bits::has;
    use crate::math::testing::same_cases;
    use crate::math::{Ray, rounding};
    use crate::patch::Leaf;

    /// What is proved of sixteen lines and a leaf. The bits returned last are those of the lines
    /// for which its certificate holds.
    fn said(bvh: &SurfaceBvh, index: u32, queries: &[Query]) -> (Screened, u32) {
        let view = bvh.view();
        let oriented = view.tree.oriented(index);
        let target = Target::new(&view, &oriented, index);
        let mut packet = Packet::default();
        packet.ask(Wanted::Any);
        dispatch!(Kernel::best_level(), simd => {
            load(simd, &mut packet, queries, &view);
            find_planes(simd, &mut packet);
            let passage = pass_box(simd, &oriented, &packet.scaled, 0);
            let factor = target.piece.patch.residual_factor();
            let magnitude = f32x16::splat(simd, 1e2);
            let certified = certify(simd, target.leaf, passage.slopes, magnitude, factor);
            let certified = lane_bits(passage.met & certified);
            let widened = f32x16::splat(simd, WIDENED as f32);
            let (middle, near) = if target.leaf.is_parallelogram() {
                let near = step_from_middle(simd, target.fitted(), packet.sixteen(0), widened);
                (near.last.distances, near)
            } else {
                let mut distances = LaneDistances::default();
                distances.take(simd, target.fitted(), packet.sixteen(0));
                let start = [passage.x, passage.y];
                let near = distances.newton(simd, start, [[-widened, widened]; 2]);
                (distances.in_middle(simd), near)
            };
            let error = magnitude * f32x16::splat(simd, rounding::f32_above(factor));
            let searched = Searched { middle, near: &near };
            let asked = Asked { lanes: certified, error };
            (screen(simd, &target, &packet, &passage, searched, asked), certified)
        })
    }

    /// Whether a line meets a leaf, as the exact solver finds it.
    fn meets(bvh: &SurfaceBvh, leaf: &Leaf, query: &Query) -> bool {
        let mut hits: Vec<Hit> = Vec::new();
        let _ = bvh.tracer().exact_all_hits(query, &mut hits);
        let rect = leaf.rect();
        let inside = |st: DVec2| (0..2).all(|k| rect[k][0] <= st[k] && st[k] <= rect[k][1]);
        hits.iter().any(|hit| hit.root.piece == leaf.piece && inside(hit.root.st))
    }

    /// A surface with round holes, near to each other.
    fn with_holes(surface: &NurbsSurface) -> SurfaceBvh {
        let domain = TrimDomain::of(surface).unwrap();
        let bounds = domain.bounds();
        let holes = (0..25).map(|k| {
            let place = DVec2::new((k % 5 - 2) as f64, (k / 5 - 2) as f64) / 6.0;
            let center = bounds.center() + bounds.size() * place;
            TrimLoop::circle(center, 0.07 * bounds.size().min_element()).unwrap()
        });
        let trims = Trims::new(domain, Kept::Even, &holes.collect::<Vec<_>>()).unwrap();
        let trimmed = TrimmedSurface::new(surface.clone(), trims).unwrap();
        SurfaceBvh::build(&[trimmed]).unwrap()
    }

    /// Lines through places of a leaf and just outside of it, at any angle for which its
    /// certificate holds.
    #[test]
    fn what_is_said_of_a_leaf_is_so() {
        // The last is flat.
        let [round, tube, plane] =
            [shapes::sphere(1.0), shapes::torus(1.0, 0.4), shapes::plane(2.0, 1.5)];
        let bodies = [round, tube, Ok(weighted_hills()), plane].map(Result::unwrap);
        let trimmed = bodies.clone().map(|body| with_holes(&body));
        let plain = bodies.map(|body| SurfaceBvh::build(&[body]).unwrap());
        let bodies: Vec<SurfaceBvh> = plain.into_iter().chain(trimmed).collect();
        let [asked, missed, met] = [Cell::new(0), Cell::new(0), Cell::new(0)];
        let config = same_cases(1_500);
        let place = || prop_oneof![-1.3..1.3f64, -1.03..-0.97f64, 0.97..1.03f64];
        let line = (place(), place(), -1.0..1.0f64, 0.0..6.3f64);
        let lines = (0usize.., prop::collection::vec(line, 16));
        proptest!(config, |((k, lines) in lines)| {
            for bvh in &bodies {
                let index = k % bvh.leaves.len();
                let leaf = &bvh.leaves[index];
                let piece = &bvh.patches().pieces()[leaf.piece as usize];
                let queries: Vec<Query> = lines
                    .iter()
                    .map(|&(x, y, height, turn)| {
                        let place = |k: usize, x: f64| {
                            let [from, to] = leaf.rect()[k];
                            0.5 * ((from + to) + x * (to - from))
                        };
                        let point = piece.patch.point(DVec2::new(place(0, x), place(1, y)));
                        let flat = (1.0 - height * height).sqrt();
                        let along = DVec3::new(flat * turn.cos(), flat * turn.sin(), height);
                        let (from, to) = (-6.0, 0.0);
                        let ray = Ray::with_range(point + 3.0 * along, along, from, to);
                        Query::primary(ray.unwrap())
                    })
                    .collect();
                let (said, certified) = said(bvh, index as u32, &queries);
                for (k, query) in queries.iter().enumerate() {
                    if has(said.missed, k) || has(said.met, k) {
                        let meets = meets(bvh, leaf, query);
                        prop_assert!(!(has(said.missed, k) && meets), "leaf {index}, line {k}");
                        prop_assert!(!has(said.met, k) || meets, "leaf {index}, line {k}");
                    }
                }
                asked.set(asked.get() + certified.count_ones());
                missed.set(missed.get() + said.missed.count_ones());
                met.set(met.get() + said.met.count_ones());
            }
        });
        // Most lines are decided: those left are near the leaf's sides, or at a small angle.
        let [asked, missed, met] = [asked.get(), missed.get(), met.get()];
        assert!(asked > 10_000 && missed > asked / 5 && met > asked / 5, "{asked} {missed} {met}");
        assert!(missed + met > 3 * asked / 4, "{asked} {missed} {met}");
    }
}
