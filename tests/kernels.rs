//! Every kernel gives the answers of the scalar one, whatever the company of a ray.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a failing test is a panic, also in its helpers"
)]

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{Charts, KnotVector, NurbsSurface, Surface, TrimmedSurface, shapes};
use nurbray::intersect::{Answer, Coherence, Kernel, Occlusion, Query, SurfaceBvh};
use nurbray::math::{Ray, rounding};
use nurbray::patch::Piece;

#[path = "common/patches.rs"]
mod patches;

/// Reproducible numbers in `[0, 1)` (xorshift64*, Vigna 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let p = 2.0 * DVec3::new(self.next(), self.next(), self.next()) - 1.0;
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

/// A wavy sheet of any degrees, rational where asked.
fn sheet(degree: (usize, usize), points: usize, rational: bool) -> NurbsSurface {
    let knots = |degree| KnotVector::clamped_uniform(degree, points).unwrap();
    let at = |k: usize| 2.0 * k as f64 / (points - 1) as f64 - 1.0;
    let grid = (0..points).flat_map(|i| (0..points).map(move |j| (i, j)));
    let net = grid.clone().map(|(i, j)| {
        let (x, y) = (at(i), at(j));
        DVec3::new(x, y, 0.4 * (3.0 * x).sin() * (2.0 * y + 1.0).cos())
    });
    let weights =
        rational.then(|| grid.map(|(i, j)| 1.0 + 0.5 * ((i + 2 * j) % 3) as f64).collect());
    NurbsSurface::new(knots(degree.0), knots(degree.1), net.collect(), weights).unwrap()
}

/// The surface with some control points forty times as heavy as they were: the pieces that they govern are badly
/// conditioned by powers, their neighbours are not.
fn with_heavy_points(surface: &NurbsSurface) -> NurbsSurface {
    let control = surface.control().iter().enumerate();
    let control = control.map(|(k, &point)| if k % 97 == 50 { 40.0 * point } else { point });
    let (u, v) = (surface.knots_u().clone(), surface.knots_v().clone());
    NurbsSurface::from_homogeneous(u, v, control.collect()).unwrap()
}

/// A surface cut by a polygon, an island in it, a circle beyond the border, and a hole across
/// what may be a seam.
fn trimmed(surface: NurbsSurface) -> TrimmedSurface {
    let domain = TrimDomain::with_seams_of(&surface).unwrap();
    let [u, v] = domain.range();
    let at = |a: f64, b: f64| DVec2::new(u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0]));
    let polygon = |corners: &[(f64, f64)]| {
        let corners: Vec<DVec2> = corners.iter().map(|&(a, b)| at(a, b)).collect();
        TrimLoop::polygon(&corners).unwrap()
    };
    let radius = 0.1 * (u[1] - u[0]).min(v[1] - v[0]);
    let loops = [
        polygon(&[(0.3, 0.2), (0.7, 0.3), (0.8, 0.6), (0.5, 0.5), (0.3, 0.75)]),
        polygon(&[(0.4, 0.35), (0.55, 0.4), (0.45, 0.45)]),
        TrimLoop::circle(at(0.5, 1.0), radius).unwrap(),
        polygon(&[(-0.05, 0.3), (0.05, 0.4), (-0.05, 0.6)]),
    ];
    TrimmedSurface::new(surface, Trims::new(domain, Kept::Even, &loops).unwrap()).unwrap()
}

fn models() -> Vec<(String, Vec<Surface>)> {
    let nurbs: Vec<(String, Vec<NurbsSurface>)> = vec![
        ("sphere".into(), vec![shapes::sphere(1.0).unwrap()]),
        ("biquadratic sphere".into(), vec![shapes::sphere_biquadratic(1.0).unwrap()]),
        ("torus".into(), vec![shapes::torus(1.0, 0.4).unwrap()]),
        (
            "cylinder and disk".into(),
            vec![shapes::cylinder(1.0, 1.0).unwrap(), shapes::disk(1.0).unwrap()],
        ),
        ("cone".into(), vec![shapes::cone(1.0, 1.5).unwrap()]),
        ("plane".into(), vec![shapes::plane(2.0, 2.0).unwrap()]),
        ("lecture patch".into(), vec![shapes::lecture_patch_3()]),
    ];
    let mut models: Vec<(String, Vec<Surface>)> = nurbs
        .into_iter()
        .map(|(name, surfaces)| (name, surfaces.into_iter().map(Surface::from).collect()))
        .collect();
    for (degree, points, rational) in [
        ((3, 3), 12, false),
        ((2, 3), 9, true),
        ((5, 5), 8, false),
        ((7, 1), 9, true),
        ((24, 3), 25, false),
    ] {
        models.push((
            format!("sheet {degree:?} {rational}"),
            vec![sheet(degree, points, rational).into()],
        ));
    }
    for (name, surface) in [
        ("trimmed sphere", shapes::sphere(1.0).unwrap()),
        ("trimmed torus", shapes::torus(1.0, 0.4).unwrap()),
        ("trimmed plane", shapes::plane(2.0, 2.0).unwrap()),
        ("trimmed sheet", sheet((3, 2), 8, true)),
    ] {
        models.push((name.into(), vec![trimmed(surface).into()]));
    }
    models.push(("octant sphere".into(), patches::octants()));
    models.push(("body".into(), vec![patches::catmull_clark()]));
    models.push(("creased body".into(), vec![patches::creased()]));
    models.push(("Doo–Sabin body".into(), vec![patches::doo_sabin()]));
    models.push(("creased sheet".into(), vec![patches::creased_sheet()]));
    models
}

/// The size of the smallest body of [`small_in_large`].
const SMALL: f64 = 1e-7;

/// A floor, a sphere of 1e-4 of its size on it, and beside that a torus of 1e-7.
fn small_in_large() -> Vec<Surface> {
    let at = |z: f64, x: f64| DAffine3::from_translation(DVec3::new(0.3 + x, 0.2, z));
    let floor = shapes::plane(2.0, 2.0).unwrap();
    let sphere = shapes::sphere(1e-4).unwrap().transformed(&at(1e-4, 0.0)).unwrap();
    let torus = shapes::torus(SMALL, 0.4 * SMALL).unwrap();
    let torus = torus.transformed(&at(SMALL, 1.1e-4)).unwrap();
    [floor, sphere, torus].map(Surface::from).into()
}

/// Rays from one eye through a grid, rays from everywhere, and rays at corners, knot lines,
/// poles and along axes.
fn rays(surfaces: &[Surface], center: DVec3, radius: f64, random: &mut Random) -> Vec<Query> {
    let mut rays = Vec::new();
    let eye = center + 2.5 * radius * random.direction();
    let forward = (center - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let up = forward.cross(right);
    for k in 0..32 * 32 {
        let (x, y) = ((k % 32) as f64 / 16.0 - 1.0, (k / 32) as f64 / 16.0 - 1.0);
        rays.push((eye, forward + 0.45 * (x * right + y * up)));
    }
    for _ in 0..600 {
        let origin = center + 1.5 * radius * random.direction();
        rays.push((origin, center + radius * random.next() * random.direction() - origin));
    }
    let charts: Vec<_> = surfaces.iter().flat_map(Surface::charts).collect();
    for k in 0..600 * surfaces.len() {
        // The charts in turn, and neighbours not one after the other.
        let surface = &charts[k * 7919 % charts.len()].surface;
        let [(u0, u1), (v0, v1)] = surface.domain();
        let grid = |random: &mut Random| (random.next() * 9.0).floor() / 8.0;
        let (a, b) = (grid(random), if random.next() < 0.5 { grid(random) } else { random.next() });
        let target = surface.point_at(u0 + a * (u1 - u0), v0 + b * (v1 - v0));
        let origin = target + 3.0 * radius * random.direction();
        rays.push((origin, target - origin));
    }
    for k in 0..150 {
        // From as far away as rays may be that small things in large scenes are still seen by in f32.
        let surface = &charts[k * 7919 % charts.len()].surface;
        let [(u0, u1), (v0, v1)] = surface.domain();
        let (a, b) = (random.next(), random.next());
        let target = surface.point_at(u0 + a * (u1 - u0), v0 + b * (v1 - v0));
        let origin = target + random.next() * 800.0 * radius * random.direction();
        rays.push((origin, target - origin));
    }
    for k in 0..150 {
        let axis = [DVec3::X, DVec3::Y, -DVec3::Z][k % 3];
        let at = (4.0 * random.direction()).round() / 4.0 * radius;
        rays.push((center + at - 3.0 * radius * axis, axis));
    }
    for _ in 0..150 {
        let origin = center + 1e6 * radius * random.direction();
        rays.push((origin, center + 0.9 * radius * random.direction() - origin));
    }
    let mut rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d).unwrap()).collect();
    // One in eight with its origin elsewhere on its line, and another range.
    for ray in rays.iter_mut().step_by(8) {
        let t = 3.0 * random.next();
        let from = if random.next() < 0.5 { -3.0 * random.next() } else { f64::NEG_INFINITY };
        let to = if random.next() < 0.5 { 0.1 + random.next() } else { f64::INFINITY };
        *ray = Ray::with_range(ray.at(t), ray.direction(), from, to).unwrap();
    }
    rays.into_iter().map(Query::primary).collect()
}

fn trace(bvh: &SurfaceBvh, kernel: Kernel, coherence: Coherence, queries: &[Query]) -> Vec<Answer> {
    let mut answers = Vec::new();
    bvh.tracer_with(kernel).first_hits(queries, coherence, &mut answers);
    answers
}

fn one_by_one(bvh: &SurfaceBvh, kernel: Kernel, queries: &[Query]) -> Vec<Answer> {
    let mut tracer = bvh.tracer_with(kernel);
    queries.iter().map(|query| tracer.first_hit(query)).collect()
}

fn occlusions(bvh: &SurfaceBvh, kernel: Kernel, queries: &[Query]) -> Vec<Occlusion> {
    let mut tracer = bvh.tracer_with(kernel);
    queries.iter().map(|query| tracer.occluded(query)).collect()
}

/// Rays that leave the hits of others: in any direction, and at small angles to the surface.
fn leaving(answers: &[Answer], radius: f64, random: &mut Random) -> Vec<Query> {
    let hits = answers.iter().filter_map(|answer| answer.hit);
    let regular = hits.filter(|hit| hit.normal.is_finite());
    regular
        .enumerate()
        .map(|(k, hit)| {
            let any = random.direction();
            let direction = match k % 3 {
                0 => any,
                _ => {
                    let along = (any - any.dot(hit.normal) * hit.normal).normalize();
                    let angle = 10f64.powf(-3.0 * random.next());
                    along + if k % 3 == 1 { angle } else { -angle } * hit.normal
                }
            };
            let end = if k % 2 == 0 { f64::INFINITY } else { radius * random.next() };
            Query::leaving(Ray::with_range(hit.point, direction, 0.0, end).unwrap(), &hit)
        })
        .collect()
}

/// Everything a hit says: its numbers as bits, its surface, its flags, and of its root what it shows,
/// which tells numbers apart.
type Said = (Vec<u64>, u32, u8, String);

/// What an answer says, to the bit.
fn bits(answer: &Answer) -> (Option<Said>, bool) {
    let hit = answer.hit.map(|hit| {
        let places = [vec![hit.t], hit.uv.to_array().to_vec()].concat();
        let vectors = [hit.point.to_array(), hit.normal.to_array()].concat();
        let values = places.into_iter().chain(vectors).map(f64::to_bits).collect();
        (values, hit.surface, hit.flags.bits(), format!("{:?}", hit.root))
    });
    (hit, answer.doubtful)
}

/// The pieces of a surface.
fn pieces_of(bvh: &SurfaceBvh, surface: u32) -> impl Iterator<Item = &Piece> {
    let pieces = bvh.patches().pieces_of(surface as usize);
    pieces.map(|piece| &bvh.patches().pieces()[piece])
}

/// Whether pieces of degree 1 follow one another: there may be a crease between them.
fn has_creases(bvh: &SurfaceBvh, surface: u32) -> bool {
    let first = pieces_of(bvh, surface).next().unwrap();
    (0..2).any(|k| {
        let follow = |piece: &Piece| piece.domain()[k] != first.domain()[k];
        first.patch.degree()[k] == 1 && pieces_of(bvh, surface).any(follow)
    })
}

fn compare(
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
            // Twice the promise, as if no control point were farther out: either answer may use all of it.
            let twice = 2.0 * rounding::residual_factor(p, q) * magnitude;
            let tips = pieces_of(bvh, a.surface).flat_map(Piece::collapsed_sides);
            let to_tip = tips.map(|(_, tip)| a.point.distance(tip)).fold(f64::INFINITY, f64::min);
            // In a pole hits may be off by more, and there the control points count: a sphere's reach to 4.
            let error = if to_tip <= twice { 3.0 * twice } else { twice };
            let cosine = a.normal.dot(direction).abs().min(b.normal.dot(direction).abs());
            // Without a normal, as at a tip, nothing is known of the angle.
            let cosine = if cosine.is_nan() { 0.1 } else { cosine };
            let apart = (a.t - b.t).abs() * ray.direction().length();
            assert!(apart <= error / cosine, "{}", context());
            assert!(a.point.distance(ray.at(a.t)) <= error, "{}", context());
            let turned = a.normal.distance(b.normal);
            assert_eq!(a.normal.is_nan(), b.normal.is_nan(), "{}", context());
            let turned = if turned.is_nan() { 0.0 } else { turned };
            // Where surfaces, or all sides of a tip, or those of a crease meet either may be named.
            let has_creases = name.starts_with("creased") || has_creases(bvh, a.surface);
            let same = a.surface == b.surface && a.uv.distance(b.uv) < 1e-3 && !has_creases;
            // Towards the tip of a cone normals turn as fast as it comes nearer.
            let is_cone = p.min(q) == 1 && to_tip > twice;
            let at_tip = if is_cone { 2.0 * a.point.distance(b.point) / to_tip } else { 0.0 };
            let turn = 1e2 * error / scale + at_tip;
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

/// What is done with a model, rays at it, and rays that leave it.
type Check = fn(&str, f64, &SurfaceBvh, &[Query], &[Query]);

/// All models, at several sizes and places.
fn everywhere(check: Check) {
    for (scale, shift) in
        [(1.0, DVec3::ZERO), (1e-8, DVec3::ZERO), (1.0, DVec3::new(1e6, 2e6, -1e6))]
    {
        let mut models: Vec<_> = models().into_iter().map(|(n, s)| (n, s, scale)).collect();
        if shift == DVec3::ZERO {
            // Elsewhere there are not enough numbers for something so small.
            models.push(("small in large".into(), small_in_large(), SMALL * scale));
        }
        for (name, surfaces, scale_of_least) in models {
            let placed =
                DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
            let surfaces: Vec<_> =
                surfaces.iter().map(|surface| surface.transformed(&placed).unwrap()).collect();
            let bvh = SurfaceBvh::build(&surfaces).unwrap();
            let (low, high) = bvh.bounds().unwrap();
            let mut random = Random(0x9E37_79B9_7F4A_7C15);
            let (center, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
            let queries = rays(&surfaces, center, radius, &mut random);
            let hits = one_by_one(&bvh, Kernel::Scalar, &queries);
            let leaving = leaving(&hits, radius, &mut random);
            check(&name, scale_of_least, &bvh, &queries, &leaving);
        }
    }
}

fn wide_kernels() -> impl Iterator<Item = Kernel> {
    let kernels = Kernel::ALL.iter().copied();
    kernels.filter(|&kernel| kernel.is_available() && kernel != Kernel::Scalar)
}

/// Compares all answers, and how many are doubtful.
fn compare_all(
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

#[test]
fn packets_answer_as_the_scalar_kernel() {
    everywhere(|name, scale, bvh, queries, _| {
        let scalar = one_by_one(bvh, Kernel::Scalar, queries);
        for kernel in wide_kernels() {
            let wide = trace(bvh, kernel, Coherence::Coherent, queries);
            compare_all((name, kernel, scale), bvh, queries, &wide, &scalar);
        }
    });
}

#[test]
fn streams_answer_as_the_scalar_kernel() {
    everywhere(|name, scale, bvh, queries, leaving| {
        for queries in [queries, leaving] {
            let scalar = one_by_one(bvh, Kernel::Scalar, queries);
            for kernel in wide_kernels() {
                let wide = trace(bvh, kernel, Coherence::Incoherent, queries);
                compare_all((name, kernel, scale), bvh, queries, &wide, &scalar);
            }
        }
    });
}

#[test]
fn single_rays_are_answered_as_by_the_scalar_kernel() {
    everywhere(|name, scale, bvh, queries, leaving| {
        for queries in [queries, leaving] {
            let scalar = one_by_one(bvh, Kernel::Scalar, queries);
            for kernel in wide_kernels() {
                let wide = one_by_one(bvh, kernel, queries);
                compare_all((name, kernel, scale), bvh, queries, &wide, &scalar);
            }
        }
    });
}

/// Rays past a pole in distances from 1e-13 to 1e-2, steep ones and others, some of which end near where they hit.
fn past_pole(pole: DVec3, random: &mut Random) -> Vec<Query> {
    let ray = |k: usize| {
        let aside = 10f64.powf(-2.0 - 11.0 * random.next());
        // Every third in a plane of symmetry.
        let side = if k.is_multiple_of(3) { DVec3::X } else { random.direction() };
        let flat = 10f64.powf(-2.0 * random.next());
        let from =
            random.direction() * DVec3::new(1.0, if k.is_multiple_of(3) { 0.0 } else { 1.0 }, flat);
        let direction = -from * (1.0 + random.next());
        let origin = pole + aside * side - direction;
        let spare = [f64::INFINITY, 1e-15, -1e-15, 1e-13][k % 4] * random.next();
        Query::primary(Ray::with_range(origin, direction, 0.0, 1.0 + spare).unwrap())
    };
    (0..2000).map(ray).collect()
}

/// Takes over normals near a pole: the derivative along a parallel is as short as the parallel, so towards the pole the
/// rounding of its coordinates turns the normal by that much more.
fn forgive_normals(pole: DVec3, wide: &mut [Answer], scalar: &[Answer]) {
    for (a, b) in wide.iter_mut().zip(scalar) {
        let (Some(a), Some(b)) = (&mut a.hit, &b.hit) else { continue };
        let parallel = a.point.distance(pole);
        if a.normal.distance(b.normal) < 1e-14 / parallel {
            a.normal = b.normal;
        }
    }
}

#[test]
fn rays_past_poles_are_answered_as_by_the_scalar_kernel() {
    let surfaces = [
        ("sphere", shapes::sphere(1.0).unwrap(), DVec3::Z),
        ("biquadratic sphere", shapes::sphere_biquadratic(1.0).unwrap(), -DVec3::Z),
        ("cone", shapes::cone(1.0, 1.5).unwrap(), DVec3::new(0.0, 0.0, 1.5)),
        ("disk", shapes::disk(1.0).unwrap(), DVec3::ZERO),
    ];
    for (name, surface, pole) in surfaces {
        let bvh = SurfaceBvh::build(&[Surface::from(surface)]).unwrap();
        let mut random = Random(0x9E37_79B9_7F4A_7C15);
        let queries = past_pole(pole, &mut random);
        let hits = one_by_one(&bvh, Kernel::Scalar, &queries);
        assert!(hits.iter().filter(|answer| answer.hit.is_some()).count() > 100, "{name}");
        let leaving = leaving(&hits, 1.0, &mut random);
        for queries in [queries, leaving] {
            let scalar = one_by_one(&bvh, Kernel::Scalar, &queries);
            for kernel in wide_kernels() {
                for mut wide in [
                    one_by_one(&bvh, kernel, &queries),
                    trace(&bvh, kernel, Coherence::Coherent, &queries),
                    trace(&bvh, kernel, Coherence::Incoherent, &queries),
                ] {
                    forgive_normals(pole, &mut wide, &scalar);
                    compare_all((name, kernel, 1.0), &bvh, &queries, &wide, &scalar);
                }
            }
        }
    }
}

#[test]
fn occlusion_is_that_of_the_scalar_kernel() {
    everywhere(|name, _, bvh, queries, leaving| {
        for queries in [queries, leaving] {
            let scalar = occlusions(bvh, Kernel::Scalar, queries);
            for kernel in wide_kernels() {
                let mut packets = Vec::new();
                let mut tracer = bvh.tracer_with(kernel);
                tracer.occlusions(queries, Coherence::Coherent, &mut packets);
                for wide in [occlusions(bvh, kernel, queries), packets] {
                    assert_eq!(wide.len(), queries.len());
                    for ((query, a), b) in queries.iter().zip(&wide).zip(&scalar) {
                        let same = a.doubtful || b.doubtful || a.occluded == b.occluded;
                        assert!(same, "{name}, {kernel}: {query:?}\n{a:?}\n{b:?}");
                    }
                    let doubts = |o: &[Occlusion]| o.iter().filter(|o| o.doubtful).count();
                    let (a, b) = (doubts(&wide), doubts(&scalar));
                    assert!(a <= b + b / 10 + 2, "{name}, {kernel}: {a} doubtful, scalar {b}");
                }
            }
        }
    });
}

#[test]
fn incoherent_rays_are_occluded_alike_alone_and_in_batches() {
    for (name, surfaces) in models() {
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let (low, high) = bvh.bounds().unwrap();
        let mut random = Random(11);
        let (center, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
        let mut queries = rays(&surfaces, center, radius, &mut random);
        let hits = one_by_one(&bvh, Kernel::Scalar, &queries);
        queries.extend(leaving(&hits, radius, &mut random));
        for kernel in wide_kernels() {
            let mut together = Vec::new();
            let mut tracer = bvh.tracer_with(kernel);
            tracer.occlusions(&queries, Coherence::Incoherent, &mut together);
            assert_eq!(occlusions(&bvh, kernel, &queries), together, "{name}, {kernel}");
        }
    }
}

/// Of dense surfaces the Bézier points are not kept; of the same surfaces given in Bézier form they are. The
/// scalar kernel has the same numbers of both, up to degree three; else they are the same but for rounding.
#[test]
fn it_is_the_same_whether_bezier_points_are_kept_or_made() {
    let mut random = Random(17);
    let build = |surface: Surface| SurfaceBvh::build(&[surface]).unwrap();
    let sheets = [
        ((3, 3), 40, false),
        ((3, 3), 40, true),
        ((3, 2), 60, false),
        ((2, 2), 60, true),
        ((3, 3), 40, true),
        ((5, 5), 30, false),
        ((4, 7), 24, true),
    ];
    for (k, (degree, points, rational)) in sheets.into_iter().enumerate() {
        let own = sheet(degree, points, rational);
        let own = if k == 4 { with_heavy_points(&own) } else { own };
        let low = degree.0.max(degree.1) <= 3;
        let bezier = own.bezier_form();
        let [own, bezier] = [own, bezier].map(|surface| {
            if k == 1 { Surface::from(trimmed(surface)) } else { Surface::from(surface) }
        });
        let queries = rays(std::slice::from_ref(&own), DVec3::ZERO, 1.5, &mut random);
        let [made, kept] = [own, bezier].map(build);
        let hits = |answers: &[Answer]| answers.iter().filter(|a| a.hit.is_some()).count();
        assert!(made.bytes() + 200_000 < kept.bytes(), "{} of {}", made.bytes(), kept.bytes());
        assert_eq!(made.leaves().len(), kept.leaves().len());
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let same = |queries: &[Query], what: &str| {
                let answers = [&made, &kept].map(|bvh| {
                    let mut answers = one_by_one(bvh, kernel, queries);
                    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                        answers.extend(trace(bvh, kernel, coherence, queries));
                    }
                    answers
                });
                let [a, b] = &answers;
                for (k, (a, b)) in a.iter().zip(b).enumerate() {
                    if kernel == Kernel::Scalar && low {
                        assert_eq!(bits(a), bits(b), "{degree:?}: {what}");
                    } else {
                        let name = format!("{degree:?}, {what}");
                        compare((&name, &made), kernel, 1.0, &queries[k % queries.len()], (a, b));
                    }
                }
                let [a, b] = [&made, &kept].map(|bvh| occlusions(bvh, kernel, queries));
                for ((query, a), b) in queries.iter().zip(&a).zip(&b) {
                    let same = a == b || !low && (a.doubtful || b.doubtful);
                    assert!(same, "{degree:?}, {kernel}, {what}: {query:?}\n{a:?}\n{b:?}");
                }
                answers
            };
            let [answers, _] = same(&queries, "rays from outside");
            assert!(hits(&answers) > 1000);
            same(&leaving(&answers[..queries.len()], 1.5, &mut random), "rays that leave a hit");
        }
    }
}

#[test]
fn an_answer_does_not_depend_on_the_company() {
    for (name, surfaces) in models() {
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let (low, high) = bvh.bounds().unwrap();
        let mut random = Random(7);
        let (center, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
        let mut queries = rays(&surfaces, center, radius, &mut random);
        let hits = one_by_one(&bvh, Kernel::Scalar, &queries);
        queries.extend(leaving(&hits, radius, &mut random));
        in_any_company(&name, &bvh, &queries, &mut random);
    }
}

/// Nor does it where nets are made of a spline's control points, one by one or eight side by side.
#[test]
fn nor_does_that_of_dense_sheets() {
    let mut random = Random(9);
    for (degree, points, rational) in [((5, 5), 30, true), ((4, 7), 26, false), ((3, 2), 60, true)]
    {
        let own = sheet(degree, points, rational);
        for surface in [own.clone(), with_heavy_points(&own)] {
            let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
            let queries = rays(&[Surface::from(surface)], DVec3::ZERO, 1.5, &mut random);
            in_any_company(&format!("dense sheet {degree:?}"), &bvh, &queries, &mut random);
        }
    }
}

/// Nor where neighbouring weights differ by up to a million times.
#[test]
fn nor_does_that_of_sheets_of_wild_weights() {
    let mut random = Random(11);
    for degree in [(3, 1), (5, 1), (2, 2)] {
        let control = sheet(degree, 24, false).control().to_vec();
        let mut wild = || 10f64.powf(6.0 * random.next() - 3.0);
        let control = control.into_iter().map(|point| wild() * point).collect();
        let knots = |degree| KnotVector::clamped_uniform(degree, 24).unwrap();
        let surface =
            NurbsSurface::from_homogeneous(knots(degree.0), knots(degree.1), control).unwrap();
        let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
        let queries = rays(&[Surface::from(surface)], DVec3::ZERO, 1.5, &mut random);
        in_any_company(&format!("wild sheet {degree:?}"), &bvh, &queries, &mut random);
    }
}

/// Lines that touch a sheet in the shape of a cubic, to within rounding or a little more, and cross the same
/// leaf elsewhere: of some of its parts one root is proved, of others nothing.
#[test]
fn nor_does_that_of_a_ray_of_which_not_all_is_proved() {
    let bend = 0.012;
    let knots = |degree| KnotVector::clamped_uniform(degree, degree + 1).unwrap();
    let net = [(-1.0, -bend), (-1.0 / 3.0, bend), (1.0 / 3.0, -bend), (1.0, bend)]
        .into_iter()
        .flat_map(|(x, z)| [-1.0, 1.0].map(|y| DVec3::new(x, y, z)))
        .collect();
    let sheet = NurbsSurface::new(knots(3), knots(1), net, None).unwrap();
    let bvh = SurfaceBvh::build(&[sheet]).unwrap();
    assert_eq!(bvh.leaves().len(), 1);
    let mut random = Random(8);
    let mut queries = Vec::new();
    for _ in 0..600 {
        let at = 0.9 * (random.next() - 0.5);
        let slope = 3.0 * bend * at * at;
        let aside = 10f64.powf(-16.0 + 10.0 * random.next()) * (random.next() - 0.5);
        let direction = DVec3::new(1.0, 0.2 * (random.next() - 0.5), slope);
        let touched = DVec3::new(at, 0.5 * (random.next() - 0.5), bend * at.powi(3) + aside);
        let sign = if random.next() < 0.5 { 1.0 } else { -1.0 };
        let ray = Ray::new(touched - 3.0 * sign * direction, sign * direction).unwrap();
        queries.push(Query::primary(ray));
    }
    in_any_company("cubic sheet", &bvh, &queries, &mut random);
}

/// All kernels' answers to rays, and again in another order and in batches of another size.
fn in_any_company(name: &str, bvh: &SurfaceBvh, queries: &[Query], random: &mut Random) {
    let kernels = Kernel::ALL.iter().filter(|kernel| kernel.is_available());
    let hints = [Coherence::Coherent, Coherence::Incoherent];
    for (&kernel, coherence) in kernels.flat_map(|kernel| hints.map(|hint| (kernel, hint))) {
        let together = trace(bvh, kernel, coherence, queries);
        let mut order: Vec<usize> = (0..queries.len()).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, (random.next() * (k + 1) as f64) as usize);
        }
        for company in order.chunks(23) {
            let mixed: Vec<Query> = company.iter().map(|&k| queries[k]).collect();
            let answers = trace(bvh, kernel, coherence, &mixed);
            for (&k, answer) in company.iter().zip(&answers) {
                assert_eq!(bits(answer), bits(&together[k]), "{name}, {kernel}: ray {k}");
            }
        }
    }
}

/// Sides that are nearly parallel say little of where across them a step leads: its rounding must not be left in a hit.
#[test]
fn parallelograms_of_nearly_parallel_sides_are_met_on_the_rays() {
    let mut random = Random(11);
    for slant in [1e-2, 1e-3, 1e-4, 1e-5] {
        let a = random.direction();
        let b = 0.98 * a + slant * random.direction();
        let knots = KnotVector::bezier(1).unwrap();
        let net = vec![-a - b, -a + b, a - b, a + b];
        let surface = NurbsSurface::new(knots.clone(), knots, net, None).unwrap();
        let bvh = SurfaceBvh::build(&[surface]).unwrap();
        let queries: Vec<Query> = std::iter::repeat_with(|| {
            let target = (2.0 * random.next() - 1.0) * a + (2.0 * random.next() - 1.0) * b;
            let direction = random.direction();
            Query::primary(Ray::new(target - 2.0 * direction, direction).unwrap())
        })
        .take(4000)
        .collect();
        for kernel in wide_kernels() {
            let coherent = trace(&bvh, kernel, Coherence::Coherent, &queries);
            let incoherent = trace(&bvh, kernel, Coherence::Incoherent, &queries);
            let alone = one_by_one(&bvh, kernel, &queries);
            for answers in [coherent, incoherent, alone] {
                let mut hits = 0;
                for (answer, query) in answers.iter().zip(&queries) {
                    let Some(hit) = answer.hit else { continue };
                    let (origin, direction) = (query.ray().origin(), query.ray().direction());
                    let off = (hit.point - origin).cross(direction).length();
                    let error = rounding::residual_factor(1, 1) * 4.0;
                    assert!(answer.doubtful || off <= error, "{kernel:?}, {slant}: {off:e}");
                    hits += 1;
                }
                assert!(hits > 3500, "{kernel:?}, {slant}: {hits} hits");
            }
        }
    }
}

#[test]
fn incoherent_rays_get_the_normals_of_the_sphere_to_the_last_digits() {
    let surfaces: [Surface; 1] = [shapes::sphere(1.0).unwrap().into()];
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let mut random = Random(5);
    let chord = |_| {
        let (from, to) = (1.5 * random.direction(), 0.9 * random.direction());
        Query::primary(Ray::new(from, to - from).unwrap())
    };
    let queries: Vec<Query> = (0..20_000).map(chord).collect();
    for kernel in wide_kernels() {
        let alone = one_by_one(&bvh, kernel, &queries);
        for answer in trace(&bvh, kernel, Coherence::Incoherent, &queries).iter().chain(&alone) {
            let hit = answer.hit.unwrap();
            // The derivative along a parallel is as short as the parallel: towards a pole the
            // rounding of its coordinates turns the normal by that much more.
            let off = hit.normal.distance(hit.point.normalize());
            let parallel = hit.point.truncate().length();
            assert!(off < 1e-15 + 1e-15 / parallel, "{kernel}: {off}: {hit:?}");
        }
    }
}

/// Leaves looked at by all kernels for rays that are aimed at a body.
fn leaf_tests(bvh: &SurfaceBvh, queries: &[Query]) -> Vec<u64> {
    let count = |kernel: Kernel, coherence: Option<Coherence>| {
        let (mut tracer, mut answers) = (bvh.tracer_with(kernel), Vec::new());
        match coherence {
            Some(coherence) => tracer.first_hits(queries, coherence, &mut answers),
            None => answers.extend(queries.iter().map(|query| tracer.first_hit(query))),
        }
        assert!(answers.iter().all(|answer| answer.hit.is_some() && !answer.doubtful));
        tracer.statistics().leaf_tests
    };
    let company = [None, Some(Coherence::Coherent), Some(Coherence::Incoherent)];
    let asked = wide_kernels().flat_map(|kernel| company.map(|c| count(kernel, c)));
    asked.collect()
}

#[test]
fn small_bodies_cost_what_they_cost_alone() {
    let built = |surfaces: &[NurbsSurface]| SurfaceBvh::build(surfaces).unwrap();
    let ball = shapes::sphere(1.0).unwrap();
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    // Seen from near by, through a square of pixels.
    let eye = 4.0 * random.direction();
    let right = eye.any_orthonormal_vector();
    let up = eye.cross(right).normalize();
    let rays = (0..1024).map(|k| {
        let (x, y) = ((k % 32) as f64 / 32.0 - 0.5, (k / 32) as f64 / 32.0 - 0.5);
        Query::primary(Ray::new(eye, x * right + y * up - eye).unwrap())
    });
    let queries: Vec<Query> = rays.collect();
    let alone = leaf_tests(&built(std::slice::from_ref(&ball)), &queries);
    for size in [1e4, 1e6, 1e8] {
        let floor = shapes::plane(size, size).unwrap();
        let below = DAffine3::from_translation(DVec3::new(0.3 * size, 0.2 * size, -20.0));
        let scene = built(&[ball.clone(), floor.transformed(&below).unwrap()]);
        for (with, alone) in leaf_tests(&scene, &queries).iter().zip(&alone) {
            // The floor is looked at, too.
            let most = 2 * alone + queries.len() as u64;
            assert!(with <= &most, "{size}: {with} leaf tests instead of {alone}");
        }
    }
}

/// Most of a picture may be background, and what is seen small in it: rays that pass the whole scene by are told in
/// packets from what they have in common.
#[test]
fn packets_meet_a_ball_that_is_small_in_the_picture_where_its_lines_do() {
    let bvh = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()]).unwrap();
    let mut random = Random(0x2545_F491_4F6C_DD1D);
    let mut queries = Vec::new();
    for _ in 0..600 {
        let eye = 40.0 * random.next() * random.direction();
        let right = eye.any_orthonormal_vector();
        let up = eye.normalize().cross(right);
        let aside = 6.0 * random.next().powi(2);
        let pixel = 0.1 * random.next();
        for k in 0..64 {
            let (x, y) = (aside + pixel * f64::from(k % 8), pixel * f64::from(k / 8));
            queries.push(Query::primary(Ray::new(eye, x * right + y * up - eye).unwrap()));
        }
    }
    for kernel in wide_kernels() {
        let answers = trace(&bvh, kernel, Coherence::Coherent, &queries);
        let (mut hits, mut misses) = (0, 0);
        for (query, answer) in queries.iter().zip(&answers) {
            let (o, d) = (query.ray().origin(), query.ray().direction().normalize());
            let distance = o.cross(d).length();
            let ahead = o.length() < 1.0 || o.dot(d) < 0.0;
            if !ahead || distance > 1.0 + 1e-9 {
                assert!(answer.hit.is_none(), "{kernel:?}: {query:?}");
                misses += 1;
            } else if distance < 1.0 - 1e-9 {
                assert!(answer.hit.is_some(), "{kernel:?}: {query:?}");
                hits += 1;
            }
        }
        assert!(hits > 10_000 && misses > 10_000, "{hits} hits, {misses} misses");
    }
}
