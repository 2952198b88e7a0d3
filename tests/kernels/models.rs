//! Surfaces that all kernels are asked about.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{KnotVector, NurbsSurface, Surface, TrimmedSurface, shapes};

use crate::patches;

/// A wavy sheet of any degrees, rational where asked.
pub(crate) fn sheet(degree: (usize, usize), points: usize, rational: bool) -> NurbsSurface {
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

/// The surface with some control points forty times as heavy as they were: the pieces that they
/// govern are badly conditioned in the power basis, their neighbours are not.
pub(crate) fn with_heavy_points(surface: &NurbsSurface) -> NurbsSurface {
    let control = surface.control().iter().enumerate();
    let control = control.map(|(k, &point)| if k % 97 == 50 { 40.0 * point } else { point });
    let (u, v) = (surface.knots_u().clone(), surface.knots_v().clone());
    NurbsSurface::from_homogeneous(u, v, control.collect()).unwrap()
}

/// A surface cut by a polygon, an island in it, a circle beyond the border, and a hole across
/// what may be a seam.
pub(crate) fn trimmed(surface: NurbsSurface) -> TrimmedSurface {
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

/// Surfaces, and what is known of their normals.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) surfaces: Vec<Surface>,
    /// Whether their patches meet at creases, where either normal may be named.
    pub(crate) creases: bool,
    /// The largest angle in radians at which patches meet elsewhere.
    pub(crate) turn_between_patches: f64,
}

impl Model {
    pub(crate) fn new(name: impl Into<String>, surfaces: Vec<Surface>) -> Self {
        Self { name: name.into(), surfaces, creases: false, turn_between_patches: 0.0 }
    }

    pub(crate) fn one(name: impl Into<String>, surface: impl Into<Surface>) -> Self {
        Self::new(name, vec![surface.into()])
    }

    /// A closed subdivision surface. Its patches meet smoothly to within its tolerance only: 1.7e-3
    /// was seen.
    fn body(name: &str, surface: Surface) -> Self {
        Self { turn_between_patches: 5e-3, ..Self::one(name, surface) }
    }

    fn creased(self) -> Self {
        Self { creases: true, ..self }
    }
}

pub(crate) fn models() -> Vec<Model> {
    let tin = vec![shapes::cylinder(1.0, 1.0).unwrap(), shapes::disk(1.0).unwrap()];
    let mut models = vec![
        Model::one("sphere", shapes::sphere(1.0).unwrap()),
        Model::one("biquadratic sphere", shapes::sphere_biquadratic(1.0).unwrap()),
        Model::one("torus", shapes::torus(1.0, 0.4).unwrap()),
        Model::new("cylinder and disk", tin.into_iter().map(Surface::from).collect()),
        Model::one("cone", shapes::cone(1.0, 1.5).unwrap()),
        Model::one("plane", shapes::plane(2.0, 2.0).unwrap()),
        Model::one("lecture patch", shapes::bicubic_hood_pinched()),
    ];
    for (degree, points, rational) in [
        ((3, 3), 12, false),
        ((2, 3), 9, true),
        ((5, 5), 8, false),
        ((7, 1), 9, true),
        ((24, 3), 25, false),
    ] {
        let name = format!("sheet {degree:?} {rational}");
        models.push(Model::one(name, sheet(degree, points, rational)));
    }
    for (name, surface) in [
        ("trimmed sphere", shapes::sphere(1.0).unwrap()),
        ("trimmed torus", shapes::torus(1.0, 0.4).unwrap()),
        ("trimmed plane", shapes::plane(2.0, 2.0).unwrap()),
        ("trimmed sheet", sheet((3, 2), 8, true)),
    ] {
        models.push(Model::one(name, trimmed(surface)));
    }
    // So many leaves that incoherent rays are traced side by side by all kernels.
    models.push(Model::one("dense sheet", sheet((3, 3), 131, false)));
    models.push(Model::new("strips", strip_and_elevated()));
    models.push(Model::new("octant sphere", patches::octants()));
    models.push(Model::body("body", patches::catmull_clark()));
    models.push(Model::body("creased body", patches::creased()).creased());
    models.push(Model::body("Doo–Sabin body", patches::doo_sabin()));
    models.push(Model::one("creased sheet", patches::creased_sheet()).creased());
    models
}

/// A flat rational strip of degree 3 × 1, and beside it the same strip with that degree raised to 4:
/// both are evaluated alike, but only the first has leaves that are approximated by quotients.
fn strip_and_elevated() -> Vec<Surface> {
    let knots = |degree| KnotVector::clamped_uniform(degree, degree + 1).unwrap();
    let points = (0..8).map(|k| DVec3::new((k / 2) as f64, 3.0 * (k % 2) as f64, 0.0));
    let weights = (0..8).map(|k| 1.0 + 0.25 * (k / 2) as f64).collect();
    let strip = NurbsSurface::new(knots(3), knots(1), points.collect(), Some(weights)).unwrap();
    let aside = DAffine3::from_translation(DVec3::new(4.0, 0.0, 0.0));
    let elevated = strip.elevated_u(1).unwrap().transformed(&aside).unwrap();
    [strip, elevated].map(Surface::from).into()
}

/// The size of the smallest body of [`small_in_large`].
pub(crate) const SMALL: f64 = 1e-7;

/// A floor, a sphere of 1e-4 of its size on it, and beside that a torus of 1e-7.
pub(crate) fn small_in_large() -> Vec<Surface> {
    let at = |z: f64, x: f64| DAffine3::from_translation(DVec3::new(0.3 + x, 0.2, z));
    let floor = shapes::plane(2.0, 2.0).unwrap();
    let sphere = shapes::sphere(1e-4).unwrap().transformed(&at(1e-4, 0.0)).unwrap();
    let torus = shapes::torus(SMALL, 0.4 * SMALL).unwrap();
    let torus = torus.transformed(&at(SMALL, 1.1e-4)).unwrap();
    [floor, sphere, torus].map(Surface::from).into()
}
