//! Every kernel gives the answers of the scalar one, whatever other rays a batch holds.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a failing test is a panic, also in its helpers"
)]

use glam::{DAffine3, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface, Surface, shapes};
use nurbray::intersect::{Answer, Coherence, HitFlags, Kernel, Occlusion, Query, SurfaceBvh};
use nurbray::math::{Ray, rounding};

mod answers;
mod coarse;
mod company;
mod models;
#[path = "../common/patches.rs"]
mod patches;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/random.rs"]
mod random;
mod rays;

use answers::{
    Asked, bits, compare, compare_all, everywhere, occlusions, one_by_one, trace, wide_kernels,
};
use models::{Model, models, sheet, trimmed, with_heavy_points};
use random::Random;
use rays::{leaving, past_pole, rays};

#[test]
fn packets_answer_as_the_scalar_kernel() {
    everywhere(|asked, queries, _| {
        let bvh = &asked.bvh;
        let scalar = one_by_one(bvh, Kernel::Scalar, queries);
        for kernel in wide_kernels() {
            let wide = trace(bvh, kernel, Coherence::Coherent, queries);
            compare_all(asked, kernel, queries, &wide, &scalar);
        }
    });
}

#[test]
fn streams_answer_as_the_scalar_kernel() {
    everywhere(|asked, queries, leaving| {
        let bvh = &asked.bvh;
        for queries in [queries, leaving] {
            let scalar = one_by_one(bvh, Kernel::Scalar, queries);
            for kernel in wide_kernels() {
                let wide = trace(bvh, kernel, Coherence::Incoherent, queries);
                compare_all(asked, kernel, queries, &wide, &scalar);
            }
        }
    });
}

#[test]
fn single_rays_are_answered_as_by_the_scalar_kernel() {
    everywhere(|asked, queries, leaving| {
        let bvh = &asked.bvh;
        for queries in [queries, leaving] {
            let scalar = one_by_one(bvh, Kernel::Scalar, queries);
            for kernel in wide_kernels() {
                let wide = one_by_one(bvh, kernel, queries);
                compare_all(asked, kernel, queries, &wide, &scalar);
            }
        }
    });
}

/// Replaces normals near a pole by those of the scalar kernel, if they differ by rounding only. The
/// derivative along a parallel is as short as the parallel, so towards the pole the rounding of its
/// coordinates turns the normal by that much more.
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
        // 31.3 % were seen, of rays that leave a cone.
        let asked = Asked { most_doubtful: 0.33, ..Asked::new(Model::one(name, surface), 1.0) };
        let bvh = &asked.bvh;
        let mut random = Random::new(3);
        let queries = past_pole(pole, &mut random);
        let hits = one_by_one(bvh, Kernel::Scalar, &queries);
        assert!(hits.iter().filter(|answer| answer.hit.is_some()).count() > 100, "{name}");
        let leaving = leaving(&hits, 1.0, &mut random);
        for queries in [queries, leaving] {
            let scalar = one_by_one(bvh, Kernel::Scalar, &queries);
            for kernel in wide_kernels() {
                for mut wide in [
                    one_by_one(bvh, kernel, &queries),
                    trace(bvh, kernel, Coherence::Coherent, &queries),
                    trace(bvh, kernel, Coherence::Incoherent, &queries),
                ] {
                    forgive_normals(pole, &mut wide, &scalar);
                    compare_all(&asked, kernel, &queries, &wide, &scalar);
                }
            }
        }
    }
}

/// The fast kernels find hits that are certain and away from borders, the scalar search finds the
/// others: so there is doubt about the same rays, and hits differ by rounding.
#[test]
fn all_hits_are_those_of_the_scalar_kernel() {
    everywhere(|asked, queries, leaving| {
        let mut scalar = asked.bvh.tracer_with(Kernel::Scalar);
        let mut kernels: Vec<_> =
            wide_kernels().map(|kernel| (kernel, asked.bvh.tracer_with(kernel))).collect();
        let (mut expected, mut hits) = (Vec::new(), Vec::new());
        for query in queries.iter().chain(leaving) {
            let doubtful = scalar.all_hits(query, &mut expected);
            for (kernel, tracer) in &mut kernels {
                let doubts = tracer.all_hits(query, &mut hits);
                let context = || format!("{}, {kernel}: {query:?}", asked.model.name);
                assert_eq!(doubts, doubtful, "{}: {hits:#?}, {expected:#?}", context());
                assert_eq!(hits.len(), expected.len(), "{}: {hits:#?}, {expected:#?}", context());
                // Rounding orders hits of two surfaces at one place.
                for hits in [&mut hits, &mut expected] {
                    hits.sort_by_key(|hit| hit.surface);
                }
                for (hit, expected) in hits.iter().zip(&expected) {
                    assert_eq!(hit.flags, expected.flags, "{}: {hits:#?}", context());
                    let [a, b] = [hit, expected].map(|&hit| {
                        let doubtful = hit.flags.contains(HitFlags::DOUBTFUL);
                        Answer { hit: Some(hit), doubtful }
                    });
                    compare(asked, *kernel, query, (&a, &b));
                }
            }
        }
    });
}

#[test]
fn occlusion_is_that_of_the_scalar_kernel() {
    everywhere(|asked, queries, leaving| {
        let (name, bvh) = (&asked.model.name, &asked.bvh);
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
    for Model { name, surfaces, .. } in models() {
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let (low, high) = bvh.bounds().unwrap();
        let mut random = Random::new(11);
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

/// The Bézier points of dense surfaces are not kept; those of the same surfaces given in Bézier
/// form are. Up to degree three, the scalar kernel has the same numbers for both; otherwise they
/// are the same except for rounding.
#[test]
fn it_is_the_same_whether_bezier_points_are_kept_or_made() {
    let mut random = Random::new(17);
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
        let name = format!("{degree:?}");
        let build = |surface| Asked::new(Model::one(&name, surface), 1.0);
        let [made, kept] = [own, bezier].map(build);
        let hits = |answers: &[Answer]| answers.iter().filter(|a| a.hit.is_some()).count();
        let [less, more] = [&made, &kept].map(|asked| asked.bvh.bytes());
        assert!(less + 200_000 < more, "{less} of {more}");
        assert_eq!(made.bvh.leaves().len(), kept.bvh.leaves().len());
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            // The same rays for both; those that leave a hit leave one of the same hierarchy.
            let same = |of_both: [&[Query]; 2], what: &str| {
                let both = || [(&made.bvh, of_both[0]), (&kept.bvh, of_both[1])];
                let answers = both().map(|(bvh, queries)| {
                    let mut answers = one_by_one(bvh, kernel, queries);
                    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                        answers.extend(trace(bvh, kernel, coherence, queries));
                    }
                    answers
                });
                let queries = of_both[0];
                let [a, b] = &answers;
                for (k, (a, b)) in a.iter().zip(b).enumerate() {
                    if kernel == Kernel::Scalar && low {
                        assert_eq!(bits(a), bits(b), "{degree:?}: {what}");
                    } else {
                        compare(&made, kernel, &queries[k % queries.len()], (a, b));
                    }
                }
                let [a, b] = both().map(|(bvh, queries)| occlusions(bvh, kernel, queries));
                for ((query, a), b) in queries.iter().zip(&a).zip(&b) {
                    let same = a == b || !low && (a.doubtful || b.doubtful);
                    assert!(same, "{degree:?}, {kernel}, {what}: {query:?}\n{a:?}\n{b:?}");
                }
                answers
            };
            let [of_made, of_kept] = same([&queries, &queries], "rays from outside");
            assert!(hits(&of_made) > 1000);
            let is_left = |a: &Answer| a.hit.is_some_and(|hit| hit.normal.is_finite());
            let (of_made, of_kept): (Vec<Answer>, Vec<Answer>) = of_made[..queries.len()]
                .iter()
                .zip(&of_kept)
                .filter(|(a, b)| is_left(a) && is_left(b))
                .unzip();
            let leaving = leaving(&of_made, 1.5, &mut random);
            let (of_made, of_kept): (Vec<Query>, Vec<Query>) = leaving
                .iter()
                .zip(&of_kept)
                .map(|(query, other)| (*query, Query::leaving(*query.ray(), &other.hit.unwrap())))
                .filter(|(a, b)| a.start_root().is_some() && b.start_root().is_some())
                .unzip();
            assert!(of_made.len() > 1000);
            same([&of_made, &of_kept], "rays that leave a hit");
        }
    }
}

/// Nearly parallel sides leave a step across them poorly determined: the step's rounding must not
/// be left in a hit.
#[test]
fn parallelograms_of_nearly_parallel_sides_are_met_on_the_rays() {
    let mut random = Random::new(11);
    for slant in [1e-2, 1e-3, 1e-4, 1e-5] {
        let a = random.direction();
        let b = 0.98 * a + slant * random.direction();
        let knots = KnotVector::bezier(1).unwrap();
        let net = vec![-a - b, -a + b, a - b, a + b];
        let surface = NurbsSurface::new(knots.clone(), knots, net, None).unwrap();
        let bvh = SurfaceBvh::build(&[surface]).unwrap();
        let queries: Vec<Query> = std::iter::repeat_with(|| {
            let target = (2.0 * random.unit() - 1.0) * a + (2.0 * random.unit() - 1.0) * b;
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
    let mut random = Random::new(5);
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

/// The leaf tests of each wide kernel, one by one and in batches, for rays aimed at a body.
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
    let mut random = Random::new(3);
    // Seen from near by, through a square of pixels.
    let eye = 4.0 * random.direction();
    let right = eye.normalize().any_orthonormal_vector();
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
            // The floor is tested, too.
            let most = 2 * alone + queries.len() as u64;
            assert!(with <= &most, "{size}: {with} leaf tests instead of {alone}");
        }
    }
}

/// Most of a picture may be background, and what is seen in it small: bounds shared by all rays of
/// a packet tell which rays pass the whole scene by.
#[test]
fn packets_meet_a_ball_that_is_small_in_the_picture_where_its_lines_do() {
    let bvh = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()]).unwrap();
    let mut random = Random::new(4);
    let mut queries = Vec::new();
    for _ in 0..600 {
        let eye = 40.0 * random.unit() * random.direction();
        let right = eye.any_orthonormal_vector();
        let up = eye.normalize().cross(right);
        let aside = 6.0 * random.unit().powi(2);
        let pixel = 0.1 * random.unit();
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
