//! An input made ready, and how long that takes.

use std::path::Path;
use std::time::{Duration, Instant};

use glam::{DVec2, DVec3};
use nurbray::geometry::{Charts, KnotVector, Surface};
use nurbray::intersect::SurfaceBvh;
use nurbray::scene::{CameraSpec, Placed, Scene, World};

use super::super::failure::{Failure, OrFail};
use super::super::input;
use super::steps::{Preparation, repeat, repeat_preparing};

/// The factor by which the bounding sphere is wider than the farthest point found. Without it,
/// chords would start on a model that is a sphere, which is a class of its own (see `audit`).
const MARGIN: f64 = 1.01;

/// A model ready to trace.
#[derive(Debug)]
pub(crate) struct Model {
    /// The input as typed.
    pub(crate) name: String,
    /// The scene as it was read.
    pub(crate) scene: Scene,
    /// The scene, ready to render.
    pub(crate) world: World,
    /// Its surfaces in their places: what a rival starts from.
    pub(crate) surfaces: Vec<Surface>,
    /// How long it took to make it ready.
    pub(crate) preparation: Preparation,
    /// The middle of the bounding box.
    pub(crate) center: DVec3,
    /// The radius of a sphere about that middle which holds the surfaces.
    pub(crate) radius: f64,
    /// The diagonal of the hierarchy's box, up to some 2e-3 longer than that of the surfaces' own.
    pub(crate) diagonal: f64,
}

impl Model {
    /// What reports call the camera.
    pub(crate) fn camera(&self) -> &'static str {
        let CameraSpec { place, .. } = &self.scene.camera;
        let unsaid = CameraSpec { place: place.clone(), ..Default::default() };
        if self.scene.camera == unsaid {
            "A camera that shows all of the model"
        } else {
            "The scene's camera"
        }
    }

    /// The model with some of its surfaces only; prepares them again.
    ///
    /// # Errors
    /// When they cannot be prepared.
    pub(crate) fn keeping(mut self, kept: &[usize], budget: Duration) -> Result<Self, Failure> {
        let mut keep = vec![false; self.surfaces.len()];
        kept.iter().for_each(|&index| keep[index] = true);
        self.world = self.world.keeping(|index| keep[index]).or_bad_input()?;
        self.surfaces = in_their_places(&self.world);
        let build = || SurfaceBvh::build(&self.surfaces).or_bad_input();
        let (_, seconds) = repeat(budget, build)?;
        self.preparation.build = seconds;
        Ok(self)
    }

    /// Reads an input and prepares it, again and again for about as long as `budget`. A camera
    /// that nobody placed shows the whole model in pictures of this size or, without one, of the
    /// scene's.
    ///
    /// # Errors
    /// When the input is missing, damaged or wrong.
    pub(crate) fn load(
        path: &Path,
        size: Option<[u32; 2]>,
        budget: Duration,
    ) -> Result<Self, Failure> {
        let ((scene, world), preparation) = repeat_preparing(budget, || {
            let start = Instant::now();
            let mut scene = input::read(path)?;
            scene.settings.size = size.unwrap_or(scene.settings.size);
            let placed = Placed::new(&scene).or_bad_input()?;
            let read = start.elapsed();
            let world = placed.build().or_bad_input()?;
            let build = start.elapsed() - read;
            let [read, build] = [read, build].map(|time| time.as_secs_f64());
            Ok(((scene, world), Preparation { read, build }))
        })?;
        let surfaces = in_their_places(&world);
        // A world without surfaces cannot be made.
        let (low, high) = world.bvh().bounds().unwrap_or_default();
        let center = 0.5 * low + 0.5 * high;
        Ok(Self {
            name: path.display().to_string(),
            radius: MARGIN * farthest(&surfaces, center),
            surfaces,
            scene,
            world,
            preparation,
            center,
            diagonal: (high - low).length(),
        })
    }
}

/// The surfaces of a world.
fn in_their_places(world: &World) -> Vec<Surface> {
    world.surfaces().iter().map(|instance| instance.surface.clone()).collect()
}

/// The distance from a point to the farthest of some points of the surfaces: four a span and
/// direction, which miss little of a curve's bulge.
fn farthest(surfaces: &[Surface], from: DVec3) -> f64 {
    let charts: Vec<_> = surfaces.iter().flat_map(Charts::charts).collect();
    let distances = charts.iter().flat_map(|chart| {
        let surface = &chart.surface;
        let [us, vs] = [surface.knots_u(), surface.knots_v()].map(parameters);
        us.into_iter().map(move |u| {
            vs.iter()
                .map(|&v| surface.point_at(DVec2::new(u, v)).distance(from))
                .fold(0.0, f64::max)
        })
    });
    distances.fold(0.0, f64::max)
}

fn parameters(knots: &KnotVector) -> Vec<f64> {
    let within = |start: f64, end: f64| {
        [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|fraction| start + fraction * (end - start))
    };
    let spans = knots.spans().flat_map(|span| within(span.start, span.end));
    spans.chain([knots.domain()[1]]).collect()
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::shapes;

    use super::*;

    #[test]
    fn the_farthest_point_of_a_sphere_is_a_radius_away() {
        for radius in [1e-8, 1.0, 1e8] {
            let sphere = [shapes::sphere(radius).unwrap().into()];
            assert!((farthest(&sphere, DVec3::ZERO) / radius - 1.0).abs() < 1e-14);
        }
    }
}
