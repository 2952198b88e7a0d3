//! The same query has the same answer, bit for bit: from whatever tracer, in whatever order,
//! however the surfaces were prepared, and wherever they stand in the list.

use glam::{DAffine3, DVec3};
use nurbray::geometry::{Surface, shapes};
use nurbray::intersect::{Answer, Coherence, Hit, Kernel, Occlusion, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;

use crate::model::Model;
use crate::models;
use crate::random::Random;
use crate::rays::{Class, Rays};
use crate::ways::kernels;

/// Everything a hit says, as bits: NaN is equal to itself.
fn bits(hit: &Hit) -> Vec<u64> {
    let numbers = [&[hit.t][..], &hit.uv.to_array(), &hit.point.to_array(), &hit.normal.to_array()];
    let numbers = numbers.concat().into_iter().map(f64::to_bits);
    numbers.chain([u64::from(hit.surface), u64::from(hit.flags.bits())]).collect()
}

type Said = (Vec<Vec<u64>>, bool);

/// An answer as bits.
fn one(answer: &Answer) -> Said {
    (answer.hit.iter().map(bits).collect(), answer.doubtful)
}

/// All answers for a ray: first hit, exact first hit, all hits, occlusion.
fn said(bvh: &SurfaceBvh, queries: &[Query]) -> Vec<(Said, Said, Said, Occlusion)> {
    let mut tracer = bvh.tracer();
    queries
        .iter()
        .map(|query| {
            let mut hits = Vec::new();
            let doubtful = tracer.all_hits(query, &mut hits);
            let all = (hits.iter().map(bits).collect(), doubtful);
            let (first, exact) = (tracer.first_hit(query), tracer.exact_first_hit(query));
            (one(&first), one(&exact), all, tracer.occluded(query))
        })
        .collect()
}

/// Rays of every class, and rays that leave their hits.
fn queries(model: &Model, bvh: &SurfaceBvh, count: usize, seed: u64) -> Vec<Query> {
    let rays = Rays::new(model);
    let mut random = Random::new(seed);
    let mut tracer = bvh.tracer();
    let mut queries = Vec::new();
    for class in Class::all() {
        for _ in 0..count {
            let query = Query::primary(rays.shot(class, &mut random).ray);
            queries.push(query);
            if let Some(hit) = tracer.first_hit(&query).hit {
                let ray = Ray::new(hit.point, random.direction()).unwrap();
                queries.push(Query::leaving(ray, &hit));
            }
        }
    }
    queries
}

fn some_models() -> Vec<Model> {
    vec![models::sphere(), models::saddle(), models::random_rational(3), models::teapot()]
}

#[test]
fn whoever_asks_in_whatever_order() {
    for model in some_models() {
        let bvh = model.bvh();
        let queries = queries(&model, &bvh, 10, 51);
        let forward = said(&bvh, &queries);
        let reversed: Vec<Query> = queries.iter().rev().copied().collect();
        let mut backward = said(&bvh, &reversed);
        backward.reverse();
        assert_eq!(forward, backward, "{}", model.name);
        // A tracer that was never asked anything else.
        for (query, expected) in queries.iter().zip(&forward) {
            assert_eq!(said(&bvh, &[*query])[0], *expected, "{}: {query:?}", model.name);
        }
    }
}

/// The indices below `count` in random order.
fn shuffled(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for k in (1..count).rev() {
        order.swap(k, random.below(k + 1));
    }
    order
}

/// Answers to some queries in one batch.
fn batch(tracer: &mut Tracer<'_>, queries: &[Query], told: Coherence) -> Vec<(Said, Occlusion)> {
    let (mut answers, mut occlusions) = (Vec::new(), Vec::new());
    tracer.first_hits(queries, told, &mut answers);
    tracer.occlusions(queries, told, &mut occlusions);
    answers.iter().map(one).zip(occlusions).collect()
}

/// In packets and in streams an answer depends on the ray alone, not on those beside it.
#[test]
fn whatever_rays_are_in_the_batch() {
    for model in some_models() {
        let bvh = model.bvh();
        let queries = queries(&model, &bvh, 10, 52);
        for kernel in kernels().filter(|&kernel| kernel != Kernel::Scalar) {
            let mut tracer = bvh.tracer_with(kernel);
            for told in [Coherence::Coherent, Coherence::Incoherent] {
                let whole = batch(&mut tracer, &queries, told);
                for size in [1, 7, 33] {
                    let parts =
                        queries.chunks(size).flat_map(|part| batch(&mut tracer, part, told));
                    let parts: Vec<(Said, Occlusion)> = parts.collect();
                    assert_eq!(parts, whole, "{}, {kernel}, {told:?}, {size}", model.name);
                }
                let order = shuffled(queries.len(), &mut Random::new(57));
                let shuffled: Vec<Query> = order.iter().map(|&k| queries[k]).collect();
                for (said, &k) in batch(&mut tracer, &shuffled, told).iter().zip(&order) {
                    let context =
                        || format!("{}, {kernel}, {told:?}: {:?}", model.name, queries[k]);
                    assert_eq!(*said, whole[k], "{}", context());
                }
            }
        }
    }
}

/// Parallel builds of obvhs may differ from serial ones; answers must not.
#[test]
fn however_many_threads_built_the_tree() {
    for model in some_models() {
        let built = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| model.bvh())
        };
        let (one, two, five) = (built(1), built(2), built(5));
        // Rays that leave hits leave those of the same tree.
        let said_by = |bvh| said(bvh, &queries(&model, bvh, 10, 53));
        let expected = said_by(&one);
        assert_eq!(said_by(&two), expected, "{}", model.name);
        assert_eq!(said_by(&five), expected, "{}", model.name);
        for surface in 0..one.surface_count() {
            assert_eq!(one.leaf_count(surface), two.leaf_count(surface));
        }
    }
}

/// Ties go to the surface, then the piece, that was given first; nothing else depends on where
/// a surface stands in the list.
#[test]
fn wherever_a_surface_stands_in_the_list() {
    let model = models::teapot();
    let bvh = model.bvh();
    let queries: Vec<Query> = queries(&model, &bvh, 10, 54)
        .into_iter()
        .filter(|query| query.start_root().is_none())
        .collect();
    let mut random = Random::new(55);
    let order = shuffled(model.surfaces.len(), &mut random);
    let shuffled: Vec<Surface> = order.iter().map(|&k| model.surfaces[k].clone()).collect();
    let shuffled = SurfaceBvh::build(&shuffled).unwrap();
    let (mut a, mut b) = (bvh.tracer(), shuffled.tracer());
    let mut ties = 0;
    for query in &queries {
        let (first, other) = (a.first_hit(query), b.first_hit(query));
        assert_eq!(first.doubtful, other.doubtful, "{query:?}");
        assert_eq!(first.hit.is_some(), other.hit.is_some(), "{query:?}");
        let (Some(first), Some(other)) = (first.hit, other.hit) else { continue };
        assert_eq!(first.t.to_bits(), other.t.to_bits(), "{query:?}");
        let same = order[other.surface as usize] == first.surface as usize;
        ties += u32::from(!same);
        if same {
            let mapped = Hit { surface: first.surface, ..other };
            assert_eq!(bits(&first), bits(&mapped), "{query:?}");
        }
    }
    // Where borders of two surfaces are met, either may be given first.
    assert!(ties < queries.len() as u32 / 4, "{ties} of {}", queries.len());
}

#[test]
fn ties_go_to_the_surface_given_first() {
    let sheet = models::wavy_sheet();
    let aside = DAffine3::from_translation(DVec3::X * 30.0);
    let other = sheet.surfaces[0].transformed(&aside).unwrap();
    let same = &sheet.surfaces[0];
    // Copies of one surface among others, in three orders.
    for (surfaces, first) in [
        (vec![same.clone(), same.clone(), other.clone(), same.clone()], 0),
        (vec![other.clone(), same.clone(), same.clone()], 1),
        (vec![other.clone(), other, same.clone(), same.clone()], 2),
    ] {
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let mut tracer = bvh.tracer();
        let rays = Rays::new(&sheet);
        let mut random = Random::new(56);
        for class in [Class::Aimed, Class::Lines, Class::Corners] {
            for _ in 0..50 {
                let query = Query::primary(rays.shot(class, &mut random).ray);
                let hit = tracer.first_hit(&query).hit.unwrap();
                assert_eq!(hit.surface, first, "{query:?}");
            }
        }
    }
}

/// Rounding decides which of two surfaces in one place is hit; that one is, is certain.
#[test]
fn one_of_two_coinciding_surfaces_is_hit_without_doubt() {
    let both = [shapes::sphere(1.0), shapes::sphere_biquadratic(1.0)].map(Result::unwrap);
    let bvh = SurfaceBvh::build(&both).unwrap();
    let (mut tracer, mut hits) = (bvh.tracer(), Vec::new());
    let mut random = Random::new(5);
    let mut seen = [0; 2];
    for _ in 0..500 {
        let target = 0.9 * random.unit() * random.direction();
        let origin = 3.0 * random.direction();
        let ray = Ray::new(origin, target - origin).unwrap();
        let answer = tracer.first_hit(&ray);
        assert!(!answer.doubtful, "{ray:?}");
        seen[answer.hit.unwrap().surface as usize] += 1;
        assert!(!tracer.all_hits(&ray, &mut hits));
        assert_eq!(hits.len(), 4, "{ray:?}");
    }
    assert!(seen[0] > 10 && seen[1] > 10, "{seen:?}");
}

/// Also for surfaces in the same place, whose hits are one crossing or two.
#[test]
fn all_hits_come_by_increasing_t() {
    let model =
        |name: &str, surfaces: Vec<Surface>| Model { name: name.into(), surfaces, closed: false };
    let [sphere, other] =
        [shapes::sphere(1.0), shapes::sphere_biquadratic(1.0)].map(Result::unwrap);
    let flat = DAffine3::from_scale(DVec3::new(1e-6, 1.0, 1.0));
    let disk = sphere.transformed(&flat).unwrap();
    let spheres = model("spheres", vec![sphere.clone().into(), sphere.into(), other.into()]);
    let rays = [
        (
            [-1391174213.4687676, 1024604228.3571112, -121867752.27154647],
            [0.8031906210960309, -0.5915524445770404, 0.0703600134899052],
        ),
        (
            [62251770.7981905, -64655184.3626128, 109290669.5050609],
            [-62251770.7981905, 64655184.3626128, -109290668.5050609],
        ),
    ];
    let mut hits = 0;
    for model in [spheres, model("disk", vec![disk.into()])] {
        let bvh = model.bvh();
        let mut queries = queries(&model, &bvh, 20, 73);
        let far = rays.map(|(o, d)| Query::primary(Ray::new(o.into(), d.into()).unwrap()));
        queries.extend(far);
        for query in queries {
            let mut all = Vec::new();
            let _ = bvh.tracer().all_hits(&query, &mut all);
            assert!(all.is_sorted_by(|a, b| a.t <= b.t), "{query:?}: {all:?}");
            hits += all.len();
        }
    }
    assert!(hits > 1000, "{hits}");
}
