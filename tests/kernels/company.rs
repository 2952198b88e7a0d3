//! The answer for a ray does not depend on the other rays of a batch.

use glam::{DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
use nurbray::geometry::{KnotVector, NurbsSurface, Surface, TrimmedSurface};
use nurbray::intersect::{Coherence, Kernel, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::answers::{bits, one_by_one, trace};
use crate::models::{Model, models, sheet, with_heavy_points};
use crate::random::Random;
use crate::rays::{leaving, rays};

#[test]
fn an_answer_does_not_depend_on_the_company() {
    for Model { name, surfaces, .. } in models() {
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let (low, high) = bvh.bounds().unwrap();
        let mut random = Random::new(7);
        let (center, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
        let mut queries = rays(&surfaces, center, radius, &mut random);
        let hits = one_by_one(&bvh, Kernel::Scalar, &queries);
        queries.extend(leaving(&hits, radius, &mut random));
        in_any_company(&name, &bvh, &queries, &mut random);
    }
}

/// The same where nets are made from a spline's control points, one by one or eight side by side.
#[test]
fn nor_does_that_of_dense_sheets() {
    let mut random = Random::new(9);
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

/// The same where neighbouring weights differ by a factor of up to a million.
#[test]
fn nor_does_that_of_sheets_of_wild_weights() {
    let mut random = Random::new(11);
    for degree in [(3, 1), (5, 1), (2, 2)] {
        let control = sheet(degree, 24, false).control().to_vec();
        let mut wild = || 10f64.powf(6.0 * random.unit() - 3.0);
        let control = control.into_iter().map(|point| wild() * point).collect();
        let knots = |degree| KnotVector::clamped_uniform(degree, 24).unwrap();
        let surface =
            NurbsSurface::from_homogeneous(knots(degree.0), knots(degree.1), control).unwrap();
        let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
        let queries = rays(&[Surface::from(surface)], DVec3::ZERO, 1.5, &mut random);
        in_any_company(&format!("wild sheet {degree:?}"), &bvh, &queries, &mut random);
    }
}

/// Lines that touch a sheet in the shape of a cubic, to within rounding or a little more, and cross
/// the same leaf elsewhere: in some parts of the leaf one root is proved, in others nothing.
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
    let mut random = Random::new(8);
    let mut queries = Vec::new();
    for _ in 0..600 {
        let at = 0.9 * (random.unit() - 0.5);
        let slope = 3.0 * bend * at * at;
        let aside = 10f64.powf(-16.0 + 10.0 * random.unit()) * (random.unit() - 0.5);
        let direction = DVec3::new(1.0, 0.2 * (random.unit() - 0.5), slope);
        let touched = DVec3::new(at, 0.5 * (random.unit() - 0.5), bend * at.powi(3) + aside);
        let sign = if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let ray = Ray::new(touched - 3.0 * sign * direction, sign * direction).unwrap();
        queries.push(Query::primary(ray));
    }
    in_any_company("cubic sheet", &bvh, &queries, &mut random);
}

/// Chords of sheets that lie on each other, with one end at an edge of trims: whether that end counts
/// is known only once the nearer one is found, and on which sheet it is found first depends on the
/// other rays.
#[test]
fn nor_does_that_of_chords_that_end_at_a_trim_edge() {
    let mut random = Random::new(12);
    let knots = |degree| KnotVector::bezier(degree).unwrap();
    let point = |u: f64, v: f64| DVec3::new(u, 2.0 * v - 1.0, 2.4 * v * (1.0 - v));
    let arch = [(-1.0, 0.0), (0.0, 1.2), (1.0, 0.0)];
    let arch = [0.0, 1.0].map(|x| arch.map(|(y, z)| DVec3::new(x, y, z))).concat();
    let arch = NurbsSurface::new(knots(1), knots(2), arch, None).unwrap();
    for scene in 0..8 {
        let mut range = || {
            let [a, b] = [(); 2].map(|()| (random.unit() * 8.0).floor());
            [a.min(b) / 8.0, (a.max(b) + 1.0) / 8.0]
        };
        let holes: [UvBox; 4] = std::array::from_fn(|_| UvBox::new(range(), range()));
        let surfaces: Vec<Surface> = holes
            .iter()
            .enumerate()
            .map(|(k, &hole)| {
                let sheet = if k == 0 { arch.clone() } else { arch.elevated_v(k).unwrap() };
                let kept = if random.unit() < 0.5 { Kept::Even } else { Kept::Odd };
                let domain = TrimDomain::of(&sheet).unwrap();
                let trims =
                    Trims::new(domain, kept, &[TrimLoop::rectangle(hole).unwrap()]).unwrap();
                TrimmedSurface::new(sheet, trims).unwrap().into()
            })
            .collect();
        let queries: Vec<Query> = (0..600)
            .map(|k| {
                let UvBox { min, max } = holes[k % 4];
                let at = DVec2::new(random.unit(), random.unit());
                // A corner, or a point of a side.
                let side = DVec2::select(at.cmplt(DVec2::splat(0.5)), min, max);
                let within = min + at * (max - min);
                let end = match k % 3 {
                    0 => side,
                    1 => DVec2::new(side.x, within.y),
                    _ => DVec2::new(within.x, side.y),
                };
                let [from, to] =
                    [DVec2::new(random.unit(), random.unit()), end].map(|uv| point(uv.x, uv.y));
                let sign = if random.unit() < 0.5 { 1.0 } else { -1.0 };
                let direction = sign * (to - from);
                let origin = from - (1.0 + 4.0 * random.unit()) * direction.normalize();
                Query::primary(Ray::new(origin, direction).unwrap())
            })
            .collect();
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        in_any_company(&format!("arches {scene}"), &bvh, &queries, &mut random);
    }
}

/// Checks that all kernels give the same answers in another order and in batches of another size.
fn in_any_company(name: &str, bvh: &SurfaceBvh, queries: &[Query], random: &mut Random) {
    let kernels = Kernel::ALL.iter().filter(|kernel| kernel.is_available());
    let hints = [Coherence::Coherent, Coherence::Incoherent];
    for (&kernel, coherence) in kernels.flat_map(|kernel| hints.map(|hint| (kernel, hint))) {
        let together = trace(bvh, kernel, coherence, queries);
        let occlusions = |queries: &[Query]| {
            let mut occlusions = Vec::new();
            bvh.tracer_with(kernel).occlusions(queries, coherence, &mut occlusions);
            occlusions
        };
        let hidden = occlusions(queries);
        let mut order: Vec<usize> = (0..queries.len()).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, (random.unit() * (k + 1) as f64) as usize);
        }
        for company in order.chunks(23) {
            let mixed: Vec<Query> = company.iter().map(|&k| queries[k]).collect();
            let answers = trace(bvh, kernel, coherence, &mixed);
            for (&k, answer) in company.iter().zip(&answers) {
                assert_eq!(bits(answer), bits(&together[k]), "{name}, {kernel}: ray {k}");
            }
            let in_company = occlusions(&mixed);
            for (&k, occlusion) in company.iter().zip(&in_company) {
                assert_eq!(occlusion, &hidden[k], "{name}, {kernel}: occlusion of ray {k}");
            }
        }
    }
}
