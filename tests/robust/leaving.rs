//! Rays that leave a hit: it is not met again, and no other hit is lost with it.

use glam::{DAffine3, DVec3};
use nurbray::geometry::construct::{self, Axis};
use nurbray::geometry::{KnotVector, NurbsCurve, NurbsSurface, Surface, shapes};
use nurbray::intersect::{Coherence, Hit, HitFlags, Kernel, Occlusion, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;
use rayon::prelude::*;

use crate::judge::Judge;
use crate::model::Model;
use crate::models;
use crate::random::Random;
use crate::rays::{Class, Rays};
use crate::ways::{all_ways, kernels};

/// A ray that leaves a hit has this many times the promise as leeway around its origin before a
/// root counts as another one: the origin is off by the promise, and so is the root.
const START: f64 = 4.0;

#[derive(Clone, Debug, Default)]
struct Tally {
    rays: u64,
    hits: u64,
    doubtful: u64,
    all_doubtful: u64,
    faults: Vec<String>,
}

impl Tally {
    fn add(mut self, other: Self) -> Self {
        self.rays += other.rays;
        self.hits += other.hits;
        self.doubtful += other.doubtful;
        self.all_doubtful += other.all_doubtful;
        self.faults.extend(other.faults);
        self.faults.truncate(20);
        self
    }

    fn print(&self, name: &str) {
        let share = |count: u64| count as f64 / self.rays.max(1) as f64;
        println!(
            "{name:24} rays {:7} hit {:.2} doubtful {:.4} all {:.4} faults {}",
            self.rays,
            share(self.hits),
            share(self.doubtful),
            share(self.all_doubtful),
            self.faults.len()
        );
    }
}

/// A way to leave a surface.
#[derive(Clone, Copy, Debug)]
enum Departure {
    /// In any direction.
    Any,
    /// At an angle of about 10⁻ᵏ to the tangent plane, to either side.
    Grazing(i32),
}

impl Departure {
    fn direction(self, normal: DVec3, random: &mut Random) -> DVec3 {
        match self {
            Self::Any => random.direction(),
            Self::Grazing(k) => {
                let along = random.perpendicular(normal);
                let angle = random.sign() * random.between(0.5, 2.0) * f64::powi(10.0, -k);
                along + angle * normal
            }
        }
    }
}

/// Searches the whole line and returns all hits ahead except the root the ray starts on, found by
/// place alone: a hit of the same surface no farther from the origin than errors reach. Returns
/// `None` if other roots are as near, or anything is doubtful.
fn others(tracer: &mut Tracer<'_>, judge: &Judge<'_>, ray: &Ray, start: &Hit) -> Option<Vec<Hit>> {
    let (from, to) = (f64::NEG_INFINITY, f64::INFINITY);
    let line = Ray::with_range(ray.origin(), ray.direction(), from, to).unwrap();
    let mut hits = Vec::new();
    if tracer.exact_all_hits(&Query::primary(line), &mut hits) {
        return None;
    }
    let length = ray.direction().length();
    let reach = |hit: &Hit| {
        let measure = judge.measure(ray, hit);
        judge.slack(START * measure.promise, measure.incidence)
    };
    let (near, far): (Vec<Hit>, Vec<Hit>) = hits
        .into_iter()
        .partition(|hit| hit.surface == start.surface && hit.t.abs() * length <= reach(hit));
    let other_near = far.iter().any(|hit| hit.t.abs() * length <= 4.0 * reach(hit));
    (near.len() <= 1 && !other_near).then(|| far.into_iter().filter(|hit| hit.t > 0.0).collect())
}

fn leave(
    tracer: &mut Tracer<'_>,
    judge: &Judge<'_>,
    start: &Hit,
    direction: DVec3,
    tally: &mut Tally,
) -> Option<String> {
    let ray = Ray::new(start.point, direction).ok()?;
    let query = Query::leaving(ray, start);
    let first = tracer.first_hit(&query);
    let mut all = Vec::new();
    let all_doubtful = tracer.all_hits(&query, &mut all);
    tally.rays += 1;
    tally.hits += u64::from(first.hit.is_some());
    tally.doubtful += u64::from(first.doubtful);
    tally.all_doubtful += u64::from(all_doubtful);
    let expected = others(tracer, judge, &ray, start)?;

    let same = |a: &Hit, b: &Hit| judge.same_root(&ray, a, b);
    let due = |hit: &&Hit| judge.due(&ray, hit);
    if !first.doubtful {
        match (first.hit, expected.iter().find(due)) {
            (Some(hit), _)
                if !expected.iter().any(|other| same(&hit, other)) && judge.due(&ray, &hit) =>
            {
                return Some(format!(
                    "met {} {}, expected {:?}",
                    hit.t,
                    hit.uv,
                    expected.first().map(|h| (h.t, h.uv))
                ));
            }
            (Some(hit), Some(nearest)) if nearest.t < hit.t && !same(&hit, nearest) => {
                return Some(format!("lost {} {} before {}", nearest.t, nearest.uv, hit.t));
            }
            (None, Some(nearest)) => return Some(format!("lost {} {}", nearest.t, nearest.uv)),
            _ => {}
        }
    }
    if !all_doubtful {
        let lost =
            expected.iter().filter(due).find(|hit| !all.iter().any(|other| same(hit, other)));
        if let Some(hit) = lost {
            return Some(format!("all hits lost {} {}", hit.t, hit.uv));
        }
        let extra =
            all.iter().filter(due).find(|hit| !expected.iter().any(|other| same(hit, other)));
        if let Some(hit) = extra {
            return Some(format!("all hits met {} {} in vain", hit.t, hit.uv));
        }
    }
    None
}

/// `count` rays that leave hits of rays of some classes.
fn survey(model: &Model, departure: Departure, count: u64, seed: u64) -> Tally {
    let bvh = model.bvh();
    let judge = Judge::new(model);
    let rays = Rays::new(model);
    let mut tracer = bvh.tracer();
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    while tally.rays < count {
        let class = random.pick(&[Class::Aimed, Class::Lines, Class::Corners, Class::Borders]);
        let shot = rays.shot(class, &mut random);
        let Some(start) = tracer.first_hit(&Query::primary(shot.ray)).hit else { continue };
        let normal = if start.normal.is_nan() { random.direction() } else { start.normal };
        for _ in 0..4 {
            let direction = departure.direction(normal, &mut random);
            let fault = leave(&mut tracer, &judge, &start, direction, &mut tally);
            tally.faults.extend(fault.map(|fault| {
                format!(
                    "{} {departure:?} from {class} {} {:?} along {direction}: {fault}\n      {:?}",
                    model.name, start.uv, start.flags, shot.ray
                )
            }));
        }
    }
    tally
}

/// Curved surfaces of many kinds and sizes.
fn curved(seed: u64) -> Model {
    let mut random = Random::new(seed);
    let model = match seed % 4 {
        0 => models::random_rational(seed),
        1 => models::bezier([2 + random.below(3), 2 + random.below(3)], true, seed),
        2 => models::bezier([1 + random.below(3), 2 + random.below(3)], false, seed),
        _ => models::bezier([2, 2], true, seed),
    };
    model.placed(random.power_of_ten(-8.0, 8.0), DVec3::ZERO)
}

/// Rays that leave a thousand surfaces, `rays` each.
fn a_thousand_surfaces(rays: u64) {
    let count: u64 = std::env::var("N").map_or(1000, |n| n.parse().unwrap());
    let tallies: Vec<Tally> = (0..count)
        .into_par_iter()
        .map(|seed| survey(&curved(seed), Departure::Any, rays, seed))
        .collect();
    let tally = tallies.into_iter().fold(Tally::default(), Tally::add);
    tally.print("any direction");
    assert!(tally.faults.is_empty(), "{}", tally.faults.join("\n"));
}

#[test]
fn no_self_hit_and_no_lost_neighbour_on_a_thousand_surfaces() {
    a_thousand_surfaces(100);
}

/// The same with a thousand rays each.
#[test]
#[ignore = "takes minutes"]
fn no_self_hit_and_no_lost_neighbour_of_a_million_rays() {
    a_thousand_surfaces(1000);
}

#[test]
fn grazing_departures() {
    let count: u64 = std::env::var("N").map_or(200, |n| n.parse().unwrap());
    let mut faults = Vec::new();
    for k in 1..=10 {
        let mut all = vec![
            models::sphere(),
            models::torus(),
            models::cylinder(),
            models::cone(),
            models::teapot(),
            models::wavy_sheet(),
        ];
        all.extend((0..20).map(curved));
        let tallies: Vec<Tally> = all
            .into_par_iter()
            .map(|model| {
                let t = survey(&model, Departure::Grazing(k), count, k as u64);
                if k < 3 {
                    t.print(&model.name);
                }
                t
            })
            .collect();
        let tally = tallies.into_iter().fold(Tally::default(), Tally::add);
        tally.print(&format!("grazing 10^-{k}"));
        faults.extend(tally.faults);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// A ray whose origin was moved off the hit does not leave it: it meets the surface in between.
#[test]
fn origins_moved_off_the_hit_meet_it_again() {
    let model = models::sphere();
    let bvh = model.bvh();
    let mut random = Random::new(72);
    let mut tracer = bvh.tracer();
    for _ in 0..500 {
        let normal = random.direction();
        let seen = Query::primary(Ray::new(3.0 * normal, -normal).unwrap());
        let seen = tracer.first_hit(&seen).hit.unwrap();
        let aside = 0.3 * random.direction();
        for moved in [1e-12, 1e-6, 1e-3] {
            let origin = seen.point + moved * normal;
            let ray = Ray::new(origin, aside - normal).unwrap();
            let again = tracer.first_hit(&Query::leaving(ray, &seen));
            let near = again.hit.is_some_and(|hit| hit.point.distance(seen.point) < 2.0 * moved);
            assert!(near || again.doubtful, "{ray:?}: {again:?}");
        }
        let on = Query::leaving(Ray::new(seen.point, aside - normal).unwrap(), &seen);
        let across = tracer.first_hit(&on).hit.unwrap();
        assert!(across.point.distance(seen.point) > 0.5, "{on:?}");
    }
}

/// At a grazing hit the place along the ray is known a thousand or a million times less exactly
/// than the height over the surface: a ray that starts higher does not leave the hit.
#[test]
fn origins_moved_off_a_grazing_hit_meet_it_again() {
    let model = models::sphere();
    let bvh = model.bvh();
    let mut random = Random::new(75);
    let available = Kernel::ALL.iter().filter(|kernel| kernel.is_available());
    for mut tracer in available.map(|&kernel| bvh.tracer_with(kernel)) {
        for cosine in [1e-3, 1e-5, 1e-6] {
            for _ in 0..100 {
                let normal = random.direction();
                let along = (random.perpendicular(normal) - cosine * normal).normalize();
                let seen = Ray::new(normal - 3.0 * along, along).unwrap();
                let seen = tracer.first_hit(&Query::primary(seen)).hit.unwrap();
                assert!(seen.point.distance(normal) < 1e-7, "aimed there");
                for moved in [1e-12, 1e-10] {
                    let origin = seen.point + moved * seen.normal;
                    let ray = Ray::new(origin, -seen.normal).unwrap();
                    let mut answers = Vec::new();
                    tracer.first_hits(
                        &[Query::leaving(ray, &seen); 2],
                        Coherence::Incoherent,
                        &mut answers,
                    );
                    answers.push(tracer.first_hit(&Query::leaving(ray, &seen)));
                    for again in answers {
                        let near = again.hit.is_some_and(|hit| hit.t < 2.0 * moved);
                        assert!(near || again.doubtful, "{cosine}, {moved}: {again:?}");
                    }
                }
                // But a ray that starts at `o + t d` does leave it.
                let there = Ray::new(normal - 3.0 * along + seen.t * along, along).unwrap();
                assert!(Query::leaving(there, &seen).start_root().is_some());
            }
        }
    }
}

/// A ray that starts in a pole and hardly dips below the tangent plane there meets the sphere again
/// at `t = 2 cos`, which must not be taken for the pole itself.
#[test]
fn rays_along_the_tangent_plane_of_a_pole_are_no_certain_misses() {
    for model in [models::sphere(), models::sphere_biquadratic()] {
        let bvh = model.bvh();
        let mut random = Random::new(74);
        let mut found = 0;
        for pole in [DVec3::Z, DVec3::NEG_Z] {
            let seen = Query::primary(Ray::new(3.0 * pole, -pole).unwrap());
            let seen = bvh.tracer().first_hit(&seen).hit.unwrap();
            assert_eq!(seen.point, pole);
            let queries: Vec<Query> = (0..25)
                .map(|_| {
                    let dip = random.power_of_ten(-10.0, -4.0);
                    let along = random.perpendicular(pole) - dip * pole;
                    Query::leaving(Ray::new(seen.point, along.normalize()).unwrap(), &seen)
                })
                .collect();
            let met_again = |ray: &Ray| -2.0 * pole.dot(ray.direction());
            let available = Kernel::ALL.iter().filter(|kernel| kernel.is_available());
            for mut tracer in available.map(|&kernel| bvh.tracer_with(kernel)) {
                let mut said: Vec<_> = queries
                    .iter()
                    .flat_map(|query| [tracer.first_hit(query), tracer.exact_first_hit(query)])
                    .collect();
                let asked = queries.iter().flat_map(|query| [query; 2]).chain(&queries);
                for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                    let mut answers = Vec::new();
                    tracer.first_hits(&queries, coherence, &mut answers);
                    said.extend(answers);
                }
                for (query, answer) in asked.chain(&queries).zip(&said) {
                    let t = met_again(query.ray());
                    let near = answer.hit.is_some_and(|hit| (hit.t - t).abs() <= 0.01 * t);
                    assert!(near || answer.doubtful, "{query:?}: {answer:?}");
                    found += u32::from(near);
                }
                for query in &queries {
                    let mut hits = Vec::new();
                    let doubtful = tracer.all_hits(query, &mut hits);
                    assert!(doubtful || !hits.is_empty(), "{query:?}");
                    let occlusion = tracer.occluded(query);
                    assert!(occlusion.occluded || occlusion.doubtful, "{query:?}");
                }
            }
        }
        assert!(found > 100, "{found}");
    }
}

/// Where a surface crosses itself, the other sheet may or may not lie ahead of a ray that leaves
/// one sheet, whether both are of one piece or of two.
#[test]
fn where_a_surface_crosses_itself_the_other_sheet_is_doubtful() {
    // A ribbon along a line that crosses itself in the origin, in its first and its last piece.
    let line = [[-1.0, -1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0]];
    let points = line.iter().flat_map(|&[x, z]| [0.0, 1.0].map(|y| DVec3::new(x, y, z)));
    let [u, v] = [4, 2].map(|count| KnotVector::clamped_uniform(1, count).unwrap());
    let model = Model::new("ribbon", NurbsSurface::new(u, v, points.collect(), None).unwrap());
    let bvh = model.bvh();
    let mut tracer = bvh.tracer();
    let down = Ray::new(DVec3::new(0.0, 0.5, 2.0), DVec3::NEG_Z).unwrap();
    let seen = tracer.first_hit(&Query::primary(down)).hit.unwrap();
    // On the line in which the sheets cross; where along it does not matter.
    assert_eq!((seen.point.x, seen.point.z), (0.0, 0.0));
    for x in [-0.3, 0.2, 0.0] {
        let onward = Ray::new(seen.point, DVec3::new(x, 0.1, -1.0)).unwrap();
        let onward = Query::leaving(onward, &seen);
        let mut hits = Vec::new();
        assert!(tracer.all_hits(&onward, &mut hits) || !hits.is_empty(), "{onward:?}");
        let first = tracer.first_hit(&onward);
        assert!(first.hit.is_some() || first.doubtful, "{onward:?}: {first:?}");
    }
}

/// A body of revolution whose profile runs along the axis into a spike.
fn spike() -> Model {
    let profile = [[0.0, 1.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
    let points = profile.map(|[x, z]| DVec3::new(x, 0.0, z)).to_vec();
    let profile = NurbsCurve::new(KnotVector::bezier(3).unwrap(), points, None).unwrap();
    let axis = Axis::new(DVec3::ZERO, DVec3::Z).unwrap();
    Model::new("spike", construct::revolve(&profile, &axis, 360.0).unwrap())
}

/// How far along its ray the tip of a spike was met is not known, only where the tip is: a ray that
/// starts elsewhere does not leave it, and what else a ray from there meets is met or in doubt.
#[test]
fn a_ray_from_the_tip_of_a_spike_loses_nothing() {
    let bvh = spike().bvh();
    let down = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z).unwrap();
    let mut random = Random::new(5);
    // Of the rays that meet something ahead, those that are told so for certain, and the others.
    let mut asked = [0; 2];
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let mut tracer = bvh.tracer_with(kernel);
        let tip = tracer.first_hit(&down).hit.unwrap();
        assert!(tip.flags.contains(HitFlags::NO_NORMAL) && tip.point == DVec3::Z, "{tip:?}");
        for _ in 0..400 {
            let (way, off) = (random.direction(), random.between(1e-9, 0.3) * random.direction());
            assert_eq!(
                Query::leaving(Ray::new(tip.point + off, way).unwrap(), &tip).start_root(),
                None
            );
            let query = Query::leaving(Ray::new(tip.point, way).unwrap(), &tip);
            assert!(query.start_root().is_some());
            // What lies ahead, clear of the tip.
            let onward = Ray::with_range(tip.point, way, 1e-3, f64::INFINITY).unwrap();
            let expected = tracer.exact_first_hit(&onward);
            let answer = tracer.first_hit(&query);
            if expected.doubtful || expected.hit.is_none() {
                continue;
            }
            asked[usize::from(answer.doubtful)] += 1;
            let expected = expected.hit.unwrap();
            let met = answer.hit.is_some_and(|hit| hit.t <= expected.t + 1e-9);
            assert!(met || answer.doubtful, "{kernel}: {query:?}: {answer:?}, {expected:?}");
            let occlusion = tracer.occluded(&query);
            assert!(occlusion.occluded || occlusion.doubtful, "{kernel}: {query:?}");
        }
    }
    println!("certain and doubtful: {asked:?}");
    assert!(asked[0] + asked[1] > 500, "{asked:?}");
}

/// Chords of spheres of any size, from a hit inwards, however flat: each meets the sphere again.
#[test]
fn no_chord_is_lost_however_small_the_sphere() {
    let sphere: Surface = shapes::sphere(1.0).unwrap().into();
    for power in [0, -8, -10, -12, -13, -14, -16, -18, -19, -20, -21, -22, -30, 8, 14, 20] {
        let scale = 10f64.powi(power);
        let scaled = sphere.transformed(&DAffine3::from_scale(DVec3::splat(scale))).unwrap();
        let bvh = SurfaceBvh::build(&[scaled]).unwrap();
        let mut random = Random::new(75);
        let mut scalar = bvh.tracer_with(Kernel::Scalar);
        let queries: Vec<Query> = (0..200)
            .map(|_| {
                let from = random.direction();
                let ray = Ray::new(3.0 * scale * from, -from).unwrap();
                let seen = scalar.first_hit(&Query::primary(ray)).hit.unwrap();
                let dip = random.power_of_ten(-4.0, 0.0);
                let along = random.perpendicular(from) - dip * from;
                Query::leaving(Ray::new(seen.point, along).unwrap(), &seen)
            })
            .collect();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let (mut first, mut any) = (Vec::new(), Vec::new());
            for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                tracer.first_hits(&queries, coherence, &mut first);
                tracer.occlusions(&queries, coherence, &mut any);
            }
            first.extend(queries.iter().map(|query| tracer.first_hit(query)));
            any.extend(queries.iter().map(|query| tracer.occluded(query)));
            let lost = first.iter().filter(|answer| answer.hit.is_none() && !answer.doubtful);
            let free = any.iter().filter(|answer| !answer.occluded && !answer.doubtful);
            let lost = (lost.count(), free.count());
            assert_eq!(lost, (0, 0), "of 600, size 1e{power}, {kernel}");
        }
    }
}

/// Chords of a sheet that bends down, from a hit at one end away from the other one, along rays that
/// reach back: they go on over the sheet and never meet it ahead, but they do behind.
#[test]
fn what_lies_behind_the_start_is_met_by_rays_that_reach_back() {
    let knots = |degree| KnotVector::bezier(degree).unwrap();
    for bend in [0.3, 0.03, 0.003] {
        // z = −bend x², over the square with sides from −1 to 1.
        let height = |x: f64| -bend * x * x;
        let net = [(-1.0, -bend), (0.0, bend), (1.0, -bend)];
        let net = net.map(|(x, z)| [-1.0, 1.0].map(|y| DVec3::new(x, y, z))).concat();
        let sheet = NurbsSurface::new(knots(2), knots(1), net, None).unwrap();
        let bvh = SurfaceBvh::build(&[sheet]).unwrap();
        let mut scalar = bvh.tracer_with(Kernel::Scalar);
        let mut random = Random::new(76);
        let queries: Vec<Query> = (0..300)
            .map(|_| {
                let mut place = || {
                    let [x, y] = [(); 2].map(|()| random.between(-0.95, 0.95));
                    DVec3::new(x, y, height(x))
                };
                let (mut from, to) = (place(), place());
                while (from.x - to.x).abs() < 0.05 {
                    from = place();
                }
                let down = Ray::new(to + DVec3::Z, DVec3::NEG_Z).unwrap();
                let seen = scalar.first_hit(&Query::primary(down)).hit.unwrap();
                let along = seen.point - from;
                let ray = Ray::with_range(seen.point, along, -3.0, f64::INFINITY).unwrap();
                Query::leaving(ray, &seen)
            })
            .collect();
        for kernel in kernels() {
            let (answers, occlusions) = all_ways(&bvh, kernel, &queries);
            for answer in answers.concat() {
                let is_there = answer.hit.as_ref().is_some_and(|hit| (hit.t + 1.0).abs() < 1e-9);
                assert!(is_there || answer.doubtful, "{kernel}, {bend}: {answer:?}");
            }
            let is_free = |hidden: &Occlusion| !hidden.occluded && !hidden.doubtful;
            assert!(!occlusions.iter().flatten().any(is_free), "{kernel}, {bend}");
            let doubtful = answers.iter().flatten().filter(|answer| answer.doubtful).count();
            assert!(doubtful < 20, "{kernel}, {bend}: {doubtful} doubtful of 900");
        }
    }
}
