//! Surfaces that are hard in different ways.

use std::path::Path;

use glam::{DAffine3, DMat3, DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimCurve, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};
use nurbray::io::load_input;
use nurbray::scene::World;

use crate::model::{Model, nurbs};
use crate::patches;
use crate::random::Random;

pub(crate) fn sphere() -> Model {
    Model::closed("sphere", shapes::sphere(1.0).unwrap())
}

pub(crate) fn sphere_biquadratic() -> Model {
    Model::closed("biquadratic sphere", shapes::sphere_biquadratic(1.0).unwrap())
}

pub(crate) fn torus() -> Model {
    Model::closed("torus", shapes::torus(1.0, 0.3).unwrap())
}

pub(crate) fn cylinder() -> Model {
    Model::new("cylinder", shapes::cylinder(1.0, 2.0).unwrap())
}

pub(crate) fn cone() -> Model {
    Model::new("cone", shapes::cone(1.0, 2.0).unwrap())
}

pub(crate) fn disk() -> Model {
    Model::new("disk", shapes::disk(1.0).unwrap())
}

pub(crate) fn plane() -> Model {
    Model::new("plane", shapes::plane(1.0, 2.0).unwrap())
}

pub(crate) fn lecture() -> Vec<Model> {
    vec![
        Model::new("lecture 1", shapes::bicubic_graph()),
        Model::new("lecture 2", shapes::bicubic_hood()),
        Model::new("lecture 3", shapes::bicubic_hood_pinched()),
        Model::new("deck", shapes::red_book_patch()),
    ]
}

/// A clamped bicubic sheet of 12 × 12 points.
pub(crate) fn wavy_sheet() -> Model {
    let knots = || KnotVector::clamped_uniform(3, 12).unwrap();
    let height = |x: f64, y: f64| 0.9 * (1.7 * x + 0.3 * y).sin() * (1.3 * y - 0.2 * x).cos();
    let points = (0..144).map(|k| {
        let (x, y) = (f64::from(k / 12) - 5.5, f64::from(k % 12) - 5.5);
        DVec3::new(x, y, height(x, y))
    });
    let surface = NurbsSurface::new(knots(), knots(), points.collect(), None).unwrap();
    Model::new("wavy sheet", surface)
}

/// A square with its corners lifted in turn: two families of rulings.
pub(crate) fn saddle() -> Model {
    bilinear("saddle", [[0.0, 1.0], [1.0, 0.0]])
}

/// A quadrilateral that is no parallelogram, twisted by a right angle.
pub(crate) fn twisted() -> Model {
    let corners = vec![
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(0.1, 1.0, 0.9),
        DVec3::new(1.0, -0.2, 0.8),
        DVec3::new(1.3, 1.0, -0.7),
    ];
    let knots = || KnotVector::bezier(1).unwrap();
    Model::new("twisted", NurbsSurface::new(knots(), knots(), corners, None).unwrap())
}

fn bilinear(name: &str, heights: [[f64; 2]; 2]) -> Model {
    let corner = |i: usize, j: usize| DVec3::new(i as f64, j as f64, heights[i][j]);
    let corners = vec![corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)];
    let knots = || KnotVector::bezier(1).unwrap();
    Model::new(name, NurbsSurface::new(knots(), knots(), corners, None).unwrap())
}

/// One Bézier piece of these degrees, its net a jittered grid, rational or not.
pub(crate) fn bezier(degree: [usize; 2], rational: bool, seed: u64) -> Model {
    let [p, q] = degree;
    let mut random = Random::new(seed);
    let knots = degree.map(|degree| KnotVector::bezier(degree).unwrap());
    let points = net(&mut random, [p + 1, q + 1], 0.5);
    let weights = rational.then(|| weights(&mut random, points.len()));
    let [u, v] = knots;
    let surface = NurbsSurface::new(u, v, points, weights).unwrap();
    Model::new(format!("degree {p} × {q}{}", if rational { " rational" } else { "" }), surface)
}

/// A rational surface of degrees 2 to 6 with some kind of knots in each direction.
pub(crate) fn random_rational(seed: u64) -> Model {
    let mut random = Random::new(seed);
    let mut name = format!("random {seed}:");
    let knots = [0, 1].map(|_| {
        let degree = 2 + random.below(5);
        let kind = random.pick(&Knots::ALL);
        name += &format!(" {degree} {kind:?}");
        kind.knots(&mut random, degree)
    });
    let counts = [knots[0].point_count(), knots[1].point_count()];
    let points = net(&mut random, counts, 0.35);
    let weights = weights(&mut random, points.len());
    let [u, v] = knots;
    Model::new(name, NurbsSurface::new(u, v, points, Some(weights)).unwrap())
}

/// A closed tube about the z axis, its knots around periodic and unclamped, open at its ends.
pub(crate) fn periodic_tube() -> Model {
    let (around, wrapped) = (7, 3);
    let u = KnotVector::uniform(3, around + wrapped).unwrap();
    let v = KnotVector::clamped_uniform(2, 5).unwrap();
    let points = (0..around + wrapped).flat_map(|i| {
        (0..5).map(move |j| {
            let angle = (i % around) as f64 / around as f64 * std::f64::consts::TAU;
            let radius = 1.0 + 0.3 * (2.0 * j as f64 + angle).sin();
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.6 * j as f64)
        })
    });
    Model::new("periodic tube", NurbsSurface::new(u, v, points.collect(), None).unwrap())
}

/// The 32 pieces of the teapot.
pub(crate) fn teapot() -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/teapot.json");
    let world = World::new(&load_input(&path).unwrap()).unwrap();
    let surfaces = world.surfaces().iter().map(|one| one.surface.clone());
    Model { name: "teapot".into(), surfaces: surfaces.collect(), closed: false }
}

/// A model cut by a curved loop, an island in it, a circle beyond the border, and a hole across
/// what may be a seam.
pub(crate) fn trimmed(mut model: Model) -> Model {
    let surface = nurbs(&model.surfaces[0]).clone();
    let domain = TrimDomain::with_seams_of(&surface).unwrap();
    let [u, v] = domain.range();
    let at = |a: f64, b: f64| DVec2::new(u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0]));
    let polygon = |corners: &[[f64; 2]]| {
        let corners: Vec<DVec2> = corners.iter().map(|&[a, b]| at(a, b)).collect();
        TrimLoop::polygon(&corners).unwrap()
    };
    let bent = [at(0.7, 0.3), at(0.9, 0.7), at(0.4, 0.4), at(0.3, 0.8)];
    let bent = TrimCurve::bezier(&bent, Some(&[1.0, 2.0, 0.5, 1.0])).unwrap();
    let straight = TrimCurve::polyline(&[at(0.3, 0.8), at(0.25, 0.2), at(0.7, 0.3)]).unwrap();
    let radius = 0.1 * (u[1] - u[0]).min(v[1] - v[0]);
    let loops = [
        TrimLoop::new(&[bent, straight]).unwrap(),
        polygon(&[[0.4, 0.35], [0.5, 0.38], [0.42, 0.45]]),
        TrimLoop::circle(at(0.5, 1.0), radius).unwrap(),
        polygon(&[[-0.05, 0.3], [0.05, 0.4], [-0.05, 0.6]]),
    ];
    model.name = format!("trimmed {}", model.name);
    let trims = Trims::new(domain, Kept::Even, &loops).unwrap();
    model.surfaces[0] = TrimmedSurface::new(surface, trims).unwrap().into();
    model.closed = false;
    model
}

/// A sphere of eight quartic triangles.
pub(crate) fn octants() -> Model {
    Model { name: "octant sphere".into(), surfaces: patches::octants(), closed: true }
}

/// Six rectangles around a volume.
pub(crate) fn cuboid() -> Model {
    let (low, size) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.0, 0.7, 1.3));
    let face = |corner: DVec3, along_u: DVec3, along_v: DVec3| {
        let corners = [DVec3::ZERO, along_v, along_u, along_u + along_v];
        let corners = corners.map(|from| low + size * (corner + from)).to_vec();
        let knots = || KnotVector::bezier(1).unwrap();
        NurbsSurface::new(knots(), knots(), corners, None).unwrap().into()
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let surfaces = [(x, y, z), (y, z, x), (z, x, y)];
    let surfaces = surfaces
        .into_iter()
        .flat_map(|(a, b, across)| [face(DVec3::ZERO, b, a), face(across, a, b)]);
    Model { name: "cuboid".into(), surfaces: surfaces.collect(), closed: true }
}

/// A cylinder with a disk at each end.
pub(crate) fn can() -> Model {
    let half_turn = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let at_end = |height: f64, turn: DMat3| {
        let map = DAffine3::from_translation(height * DVec3::Z) * DAffine3::from_mat3(turn);
        shapes::disk(1.0).unwrap().transformed(&map).unwrap().into()
    };
    let wall = shapes::cylinder(1.0, 2.0).unwrap().into();
    let surfaces = vec![wall, at_end(2.0, DMat3::IDENTITY), at_end(0.0, half_turn)];
    Model { name: "can".into(), surfaces, closed: true }
}

/// Limit surfaces of cages: closed ones by both schemes, a creased one, a sheet with a hole.
pub(crate) fn limits() -> Vec<Model> {
    vec![
        Model::closed("Catmull–Clark body", patches::catmull_clark()),
        Model::closed("creased body", patches::creased()),
        Model::closed("Doo–Sabin body", patches::doo_sabin()),
        Model::new("creased sheet", patches::creased_sheet()),
    ]
}

/// How the knots of a random surface are made.
#[derive(Clone, Copy, Debug)]
enum Knots {
    Clamped,
    Unclamped,
    Uneven,
    Repeated,
    Split,
}

impl Knots {
    const ALL: [Self; 5] =
        [Self::Clamped, Self::Unclamped, Self::Uneven, Self::Repeated, Self::Split];

    fn knots(self, random: &mut Random, degree: usize) -> KnotVector {
        let inner = |times: usize| [(0.0, degree + 1), (0.4, times), (0.7, 1), (1.0, degree + 1)];
        let knots = match self {
            Self::Clamped => KnotVector::clamped_uniform(degree, degree + 3),
            Self::Unclamped => KnotVector::uniform(degree, degree + 3),
            Self::Uneven => {
                let mut at = -3.0;
                let mut step = || {
                    at += random.between(0.05, 1.0);
                    at
                };
                KnotVector::new(degree, (0..2 * degree + 4).map(|_| step()).collect())
            }
            Self::Repeated => {
                KnotVector::with_multiplicities(degree, &inner(1 + random.below(degree)))
            }
            Self::Split => KnotVector::with_multiplicities(degree, &inner(degree + 1)),
        };
        knots.unwrap()
    }
}

/// A grid over `[−1, 1]²`, each point moved by up to `jitter` in every direction.
fn net(random: &mut Random, counts: [usize; 2], jitter: f64) -> Vec<DVec3> {
    let at = |k: usize, count: usize| 2.0 * k as f64 / (count - 1) as f64 - 1.0;
    let places = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
    places
        .map(|(i, j)| {
            let grid = DVec3::new(at(i, counts[0]), at(j, counts[1]), 0.0);
            grid + jitter * random.cube() * DVec3::new(0.6, 0.6, 1.5)
        })
        .collect()
}

fn weights(random: &mut Random, count: usize) -> Vec<f64> {
    (0..count).map(|_| random.power_of_ten(-0.5, 0.5)).collect()
}
