//! The answers of kernels, and how they may differ.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::intersect::{Answer, Coherence, Kernel, Occlusion, Query, SurfaceBvh};
use nurbray::math::rounding;
use nurbray::patch::Piece;

use crate::models::{SMALL, models, small_in_large};
use crate::random::Random;
use crate::rays::{leaving, rays};

pub(crate) fn trace(
    bvh: &SurfaceBvh,
    kernel: Kernel,
    coherence: Coherence,
    queries: &[Query],
) -> Vec<Answer> {
    let mut answers = Vec::new();
    bvh.tracer_with(kernel).first_hits(queries, coherence, &mut answers);
    answers
}

pub(crate) fn one_by_one(bvh: &SurfaceBvh, kernel: Kernel, queries: &[Query]) -> Vec<Answer> {
    let mut tracer = bvh.tracer_with(kernel);
    queries.iter().map(|query| tracer.first_hit(query)).collect()
}

pub(crate) fn occlusions(bvh: &SurfaceBvh, kernel: Kernel, queries: &[Query]) -> Vec<Occlusion> {
    let mut tracer = bvh.tracer_with(kernel);
    queries.iter().map(|query| tracer.occluded(query)).collect()
}

/// Everything that a hit says: its numbers as bits, its surface, its flags, and the debug text of
/// its root, which tells numbers apart.
pub(crate) type Said = (Vec<u64>, u32, u8, String);

/// What an answer says, to the bit.
pub(crate) fn bits(answer: &Answer) -> (Option<Said>, bool) {
    let hit = answer.hit.map(|hit| {
        let places = [vec![hit.t], hit.uv.to_array().to_vec()].concat();
        let vectors = [hit.point.to_array(), hit.normal.to_array()].concat();
        let values = places.into_iter().chain(vectors).map(f64::to_bits).collect();
        (values, hit.surface, hit.flags.bits(), format!("{:?}", hit.root))
    });
    (hit, answer.doubtful)
}

/// The pieces of a surface.
pub(crate) fn pieces_of(bvh: &SurfaceBvh, surface: u32) -> impl Iterator<Item = &Piece> {
    let pieces = bvh.patches().pieces_of(surface as usize);
    pieces.map(|piece| &bvh.patches().pieces()[piece])
}

/// Whether pieces of degree 1 follow one another: there may be a crease between them.
pub(crate) fn has_creases(bvh: &SurfaceBvh, surface: u32) -> bool {
    let first = pieces_of(bvh, surface).next().unwrap();
    (0..2).any(|k| {
        let follow = |piece: &Piece| piece.domain()[k] != first.domain()[k];
        first.patch.degree()[k] == 1 && pieces_of(bvh, surface).any(follow)
    })
}

/// Whether a place of a subdivision surface is where patches of up to seven halvings meet.
fn on_patch_border(uv: DVec2) -> bool {
    let lines = 128.0 * uv;
    (lines - lines.round()).abs().min_element() < 1e-3
}

pub(crate) fn compare(
    (name, bvh): (&str, &SurfaceBvh),
    kernel: Kernel,
    scale: f64,
    query: &Query,
    (wide, scalar): (&Answer, &Answer),
) {
    let ray = query.ray();
    let context = || format!("{name}, {kernel}: {ray:?}\n{wide:?}\n{scalar:?}");
    if wide.doubtful || scalar.doubtful {
        return; // counted by the caller
    }
    match (&wide.hit, &scalar.hit) {
        (Some(a), Some(b)) => {
            let direction = ray.direction().normalize();
            let magnitude = ray.origin().abs().max(a.point.abs()).max_element();
            let [p, q] = pieces_of(bvh, a.surface).next().unwrap().patch.degree();
            // Twice the promise, as either answer may use all of it; made as if no control point
            // were farther out than origin and hit.
            let twice = 2.0 * rounding::residual_factor(p, q) * magnitude;
            let tips = pieces_of(bvh, a.surface).flat_map(Piece::collapsed_sides);
            let to_tip = tips.map(|(_, tip)| a.point.distance(tip)).fold(f64::INFINITY, f64::min);
            // Beside a pole either answer may be off by twice the promise, and control points
            // count: those of a sphere reach to 4.
            let control = pieces_of(bvh, a.surface).map(|piece| piece.patch.magnitude());
            let farthest = control.fold(magnitude, f64::max) / magnitude;
            let error = if to_tip <= 1e-2 * scale { 2.0 * farthest * twice } else { twice };
            let cosine = a.normal.dot(direction).abs().min(b.normal.dot(direction).abs());
            // Without a normal, as at a tip, nothing is known of the angle.
            let cosine = if cosine.is_nan() { 0.1 } else { cosine };
            let apart = (a.t - b.t).abs() * ray.direction().length();
            assert!(apart <= error / cosine, "{}", context());
            assert!(a.point.distance(ray.at(a.t)) <= error, "{}", context());
            let turned = a.normal.distance(b.normal);
            assert_eq!(a.normal.is_nan(), b.normal.is_nan(), "{}", context());
            let turned = if turned.is_nan() { 0.0 } else { turned };
            // Where surfaces, the sides of a tip or those of a crease meet, any may be named.
            let has_creases = name.starts_with("creased") || has_creases(bvh, a.surface);
            let same = a.surface == b.surface && a.uv.distance(b.uv) < 1e-3 && !has_creases;
            // Near the tip of a cone, normals turn the faster the nearer the tip is.
            let is_cone = p.min(q) == 1 && to_tip > twice;
            let at_tip = if is_cone { 2.0 * a.point.distance(b.point) / to_tip } else { 0.0 };
            // Patches of a limit surface meet smoothly to within its tolerance only: 1.7e-3 was seen.
            let between = if name.ends_with("body") && on_patch_border(a.uv) { 5e-3 } else { 0.0 };
            let turn = 1e2 * error / scale + at_tip + between;
            assert!(
                !same || turned <= 1e-12 + turn || cosine < 1e-3,
                "normals differ by {turned}: {}",
                context()
            );
        }
        (None, None) => {}
        _ => panic!("only one kernel hits: {}", context()),
    }
}

/// A check of a model, with rays at it and rays that leave it.
pub(crate) type Check = fn(&str, f64, &SurfaceBvh, &[Query], &[Query]);

/// All models, at several sizes and places.
pub(crate) fn everywhere(check: Check) {
    for (scale, shift) in
        [(1.0, DVec3::ZERO), (1e-8, DVec3::ZERO), (1.0, DVec3::new(1e6, 2e6, -1e6))]
    {
        let mut models: Vec<_> = models().into_iter().map(|(n, s)| (n, s, scale)).collect();
        if shift == DVec3::ZERO {
            // Far from the origin there are not enough numbers for something so small.
            models.push(("small in large".into(), small_in_large(), SMALL * scale));
        }
        for (name, surfaces, scale_of_least) in models {
            let placed =
                DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
            let surfaces: Vec<_> =
                surfaces.iter().map(|surface| surface.transformed(&placed).unwrap()).collect();
            let bvh = SurfaceBvh::build(&surfaces).unwrap();
            let (low, high) = bvh.bounds().unwrap();
            let mut random = Random::new(3);
            let (center, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
            let queries = rays(&surfaces, center, radius, &mut random);
            let hits = one_by_one(&bvh, Kernel::Scalar, &queries);
            let leaving = leaving(&hits, radius, &mut random);
            check(&name, scale_of_least, &bvh, &queries, &leaving);
        }
    }
}

pub(crate) fn wide_kernels() -> impl Iterator<Item = Kernel> {
    let kernels = Kernel::ALL.iter().copied();
    kernels.filter(|&kernel| kernel.is_available() && kernel != Kernel::Scalar)
}

/// Compares all answers, and the numbers of doubtful ones.
pub(crate) fn compare_all(
    (name, kernel, scale): (&str, Kernel, f64),
    bvh: &SurfaceBvh,
    queries: &[Query],
    wide: &[Answer],
    scalar: &[Answer],
) {
    assert_eq!(wide.len(), queries.len());
    for ((query, a), b) in queries.iter().zip(wide).zip(scalar) {
        compare((name, bvh), kernel, scale, query, (a, b));
    }
    let doubts = |answers: &[Answer]| answers.iter().filter(|a| a.doubtful).count();
    let (a, b) = (doubts(wide), doubts(scalar));
    assert!(a <= b + b / 10 + 2, "{name}, {kernel}: {a} doubtful, scalar {b}");
}
