//! The models, the views of them, and how finely they are cut.

use std::path::Path;

use glam::DVec3;
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::io::load_input;
use nurbray::math::Ray;
use nurbray::scene::World;

/// A model, a view of it, and rising counts of cells for each knot span.
pub(crate) struct Model {
    pub(crate) name: &'static str,
    pub(crate) surfaces: Vec<NurbsSurface>,
    pub(crate) view: View,
    pub(crate) cells: [usize; 4],
}

/// A pinhole camera.
pub(crate) struct View {
    from: DVec3,
    at: DVec3,
    up: DVec3,
    /// The height of the picture at distance 1.
    height: f64,
}

/// Pixels across and down.
pub(crate) const SIZE: [usize; 2] = [320, 240];

impl View {
    /// One unit ray through the middle of each pixel, row by row from the top.
    pub(crate) fn rays(&self) -> Vec<Ray> {
        let ahead = (self.at - self.from).normalize();
        let right = ahead.cross(self.up).normalize();
        let up = right.cross(ahead);
        let [width, height] = SIZE;
        let ray = |x: usize, y: usize| {
            let across = (x as f64 + 0.5 - 0.5 * width as f64) * self.pixel();
            let down = (y as f64 + 0.5 - 0.5 * height as f64) * self.pixel();
            Ray::new(self.from, (ahead + across * right - down * up).normalize()).unwrap()
        };
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| ray(x, y)).collect()
    }

    /// The width of a pixel at distance 1.
    pub(crate) fn pixel(&self) -> f64 {
        self.height / SIZE[1] as f64
    }
}

pub(crate) fn sphere() -> Model {
    let view = View { from: DVec3::new(2.4, 1.6, 1.1), at: DVec3::ZERO, up: DVec3::Z, height: 0.8 };
    let surfaces = vec![shapes::sphere(1.0).unwrap()];
    Model { name: "sphere", surfaces, view, cells: [16, 32, 64, 128] }
}

pub(crate) fn torus() -> Model {
    let view = View {
        from: DVec3::new(3.1, -2.2, 2.9),
        at: DVec3::new(0.0, 0.0, -0.1),
        up: DVec3::Z,
        height: 0.62,
    };
    let surfaces = vec![shapes::torus(1.0, 0.4).unwrap()];
    Model { name: "torus", surfaces, view, cells: [8, 16, 32, 64] }
}

/// A clamped bicubic B-spline, 5 × 5 spans of hills and valleys.
pub(crate) fn wavy() -> Model {
    let knots = || KnotVector::clamped_uniform(3, 8).unwrap();
    let points = (0..64).map(|k| {
        let (x, y) = (f64::from(k / 8), f64::from(k % 8));
        DVec3::new(x - 3.5, y - 3.5, 1.2 * (1.9 * x + 0.4 * y).sin() * (1.4 * y).cos())
    });
    let surface = NurbsSurface::new(knots(), knots(), points.collect(), None).unwrap();
    let view = View {
        from: DVec3::new(6.5, -9.0, 7.0),
        at: DVec3::new(0.2, 0.1, 0.0),
        up: DVec3::Z,
        height: 0.66,
    };
    Model { name: "wavy", surfaces: vec![surface], view, cells: [8, 16, 32, 64] }
}

/// The teapot of the first scene, without its table: 32 Bézier patches, with poles at lid and
/// bottom, and a spout and a handle that run into the body.
pub(crate) fn teapot() -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/teapot.json");
    let world = World::new(&load_input(&path).unwrap()).unwrap();
    let surfaces: Vec<_> =
        world.surfaces().iter().filter_map(|one| one.surface.nurbs().cloned()).collect();
    assert_eq!(surfaces.len(), 32);
    let view = View {
        from: DVec3::new(4.5, -9.0, 5.6),
        at: DVec3::new(0.25, 0.0, 1.4),
        up: DVec3::Z,
        height: 0.5,
    };
    Model { name: "teapot", surfaces, view, cells: [6, 12, 24, 48] }
}
