//! The answers of kernels, and how they may differ.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::intersect::{Answer, Coherence, Hit, Kernel, Occlusion, Query, SurfaceBvh};
use nurbray::math::rounding;
use nurbray::patch::Piece;

use crate::models::{Model, SMALL, models, small_in_large};
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
    (answer.hit.as_ref().map(said), answer.doubtful)
}

fn said(hit: &Hit) -> Said {
    let places = [vec![hit.t], hit.uv.to_array().to_vec()].concat();
    let vectors = [hit.point.to_array(), hit.normal.to_array()].concat();
    let values = places.into_iter().chain(vectors).map(f64::to_bits).collect();
    (values, hit.surface, hit.flags.bits(), format!("{:?}", hit.root))
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

/// A model ready to be traced, of which kernels are asked.
pub(crate) struct Asked {
    pub(crate) model: Model,
    pub(crate) bvh: SurfaceBvh,
    /// The size of its smallest body.
    pub(crate) scale: f64,
    /// The largest share of rays whose answers are in doubt, so that nothing is compared.
    pub(crate) most_doubtful: f64,
}

impl Asked {
    pub(crate) fn new(model: Model, scale: f64) -> Self {
        let bvh = SurfaceBvh::build(&model.surfaces).unwrap();
        // Hardly more than was seen, most of it of rays that leave hits along the surface.
        let most_doubtful = match model.name.as_str() {
            "sheet (24, 3) false" => 0.14,
            "dense sheet" => 0.1,
            "sheet (7, 1) true" | "cylinder and disk" => 0.065,
            _ => 0.05,
        };
        Self { bvh, model, scale, most_doubtful }
    }
}

/// How far two answers could be compared.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compared {
    /// One of them is doubtful.
    Doubtful,
    /// Both are misses.
    Misses,
    /// Both are hits of a surface with creases, where normals may differ.
    Creased,
    /// Both are hits, but at two places that are one, or at a grazing angle: normals may differ.
    Points,
    /// Both are hits in the same place, with normals.
    Normals,
}

pub(crate) fn compare(
    asked: &Asked,
    kernel: Kernel,
    query: &Query,
    (wide, scalar): (&Answer, &Answer),
) -> Compared {
    let Asked { model, bvh, scale, .. } = asked;
    let ray = query.ray();
    let context = || format!("{}, {kernel}: {ray:?}\n{wide:?}\n{scalar:?}", model.name);
    if wide.doubtful || scalar.doubtful {
        return Compared::Doubtful;
    }
    match (&wide.hit, &scalar.hit) {
        (Some(a), Some(b)) => {
            let direction = ray.direction().normalize();
            let control = pieces_of(bvh, a.surface).map(|piece| piece.patch.magnitude());
            let control = control.fold(0.0, f64::max);
            let magnitude = ray.origin().abs().max(a.point.abs()).max_element().max(1e-2 * control);
            let [p, q] = pieces_of(bvh, a.surface).next().unwrap().patch.degree();
            // Twice the promise, as either answer may use all of it; made as if no control point
            // were farther out than origin and hit. (But a hit in the midst of control points, near
            // the origin, is not that much more exact: in a sheet of degree 24, with control points
            // at 1, one at 0.006 was off by 1.7e-16.)
            let twice = 2.0 * rounding::residual_factor(p, q) * magnitude;
            let tips = pieces_of(bvh, a.surface).flat_map(Piece::collapsed_sides);
            let to_tip = tips.map(|(_, tip)| a.point.distance(tip)).fold(f64::INFINITY, f64::min);
            // Beside a pole either answer may be off by twice the promise, and control points
            // count: those of a sphere reach to 4.
            let farthest = control.max(magnitude) / magnitude;
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
            if model.creases || has_creases(bvh, a.surface) {
                return Compared::Creased;
            }
            let same = a.surface == b.surface && a.uv.distance(b.uv) < 1e-3;
            if !same || cosine < 1e-3 {
                return Compared::Points;
            }
            // Near the tip of a cone, normals turn the faster the nearer the tip is.
            let is_cone = p.min(q) == 1 && to_tip > twice;
            let at_tip = if is_cone { 2.0 * a.point.distance(b.point) / to_tip } else { 0.0 };
            let between = if on_patch_border(a.uv) { model.turn_between_patches } else { 0.0 };
            let turn = 1e2 * error / scale + at_tip + between;
            assert!(turned <= 1e-12 + turn, "normals differ by {turned}: {}", context());
            Compared::Normals
        }
        (None, None) => Compared::Misses,
        _ => panic!("only one kernel hits: {}", context()),
    }
}

/// A check of a model, with rays at it and rays that leave it.
pub(crate) type Check = fn(&Asked, &[Query], &[Query]);

/// All models, at several sizes and places.
pub(crate) fn everywhere(check: Check) {
    for (scale, shift) in
        [(1.0, DVec3::ZERO), (1e-8, DVec3::ZERO), (1.0, DVec3::new(1e6, 2e6, -1e6))]
    {
        let mut models: Vec<_> = models().into_iter().map(|model| (model, scale)).collect();
        if shift == DVec3::ZERO {
            // Far from the origin there are not enough numbers for something so small.
            models.push((Model::new("small in large", small_in_large()), SMALL * scale));
        }
        for (mut model, scale_of_least) in models {
            let placed =
                DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
            for surface in &mut model.surfaces {
                *surface = surface.transformed(&placed).unwrap();
            }
            let asked = Asked::new(model, scale_of_least);
            let (low, high) = asked.bvh.bounds().unwrap();
            let mut random = Random::new(3);
            let (center, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
            let queries = rays(&asked.model.surfaces, center, radius, &mut random);
            let hits = one_by_one(&asked.bvh, Kernel::Scalar, &queries);
            let leaving = leaving(&hits, radius, &mut random);
            check(&asked, &queries, &leaving);
        }
    }
}

pub(crate) fn wide_kernels() -> impl Iterator<Item = Kernel> {
    let kernels = Kernel::ALL.iter().copied();
    kernels.filter(|&kernel| kernel.is_available() && kernel != Kernel::Scalar)
}

/// Compares all answers, and the numbers of doubtful ones.
pub(crate) fn compare_all(
    asked: &Asked,
    kernel: Kernel,
    queries: &[Query],
    wide: &[Answer],
    scalar: &[Answer],
) {
    assert_eq!(wide.len(), queries.len());
    let pairs = queries.iter().zip(wide.iter().zip(scalar));
    let compared: Vec<Compared> =
        pairs.map(|(query, pair)| compare(asked, kernel, query, pair)).collect();
    let count = |kind| compared.iter().filter(|one| **one == kind).count();
    let [doubtful, points, normals] =
        [Compared::Doubtful, Compared::Points, Compared::Normals].map(count);
    let name = &asked.model.name;
    let share = doubtful as f64 / queries.len() as f64;
    assert!(share <= asked.most_doubtful, "{name}, {kernel}: {share} in doubt");
    // 3.8 % were seen, of rays past the poles of a sphere.
    let most = (points + normals) / 25 + 2;
    assert!(points <= most, "{name}, {kernel}: {points} normals not compared, {normals} compared");
    let doubts = |answers: &[Answer]| answers.iter().filter(|a| a.doubtful).count();
    let (a, b) = (doubts(wide), doubts(scalar));
    assert!(a <= b + b / 10 + 2, "{name}, {kernel}: {a} doubtful, scalar {b}");
}
