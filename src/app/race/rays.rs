//! The rays that are timed: made once, for all competitors.

use glam::{DVec2, DVec3};
use nurbray::intersect::{Hit, Kernel, Neighbours, Query};
use nurbray::math::Ray;
use nurbray::scene::{Light, World};
use rayon::prelude::*;

use super::super::random::Random;
use super::model::Model;
use super::pixels::{TILE, tiled_pixels};
use super::ray_set::RaySet;

/// Rays a thread takes at a time: a tile of 64 × 64 pixels. Fixed, so that packets do not depend
/// on the number of threads. No thread should take more than one chunk (`with_max_len`): left to
/// itself, rayon hands out a quarter of all to each of two threads, and one waits for the other.
pub(crate) const CHUNK: usize = TILE * TILE;

/// How far ambient-occlusion rays reach, as a fraction of the model's diagonal: into the next
/// hollow, not across the model.
pub(crate) const REACH: f64 = 0.2;

/// The seed of the random rays: fixed, so that two runs trace the same ones.
const SEED: u64 = 1;

/// The streams of random numbers, one a purpose.
const CHORDS: u64 = 0;
const OCCLUSION: u64 = 1;

/// Rays to trace, in the order in which all competitors trace them.
#[derive(Debug)]
pub(crate) struct Rays {
    /// Which set this is.
    pub(crate) set: RaySet,
    /// The rays, with the roots they leave.
    pub(crate) queries: Vec<Query>,
    /// For rays that leave a surface, its unit normals there on their side; for others none.
    pub(crate) facing: Vec<DVec3>,
    /// The rays without the roots they leave: all that a query for a first hit consists of.
    pub(crate) alone: Vec<Ray>,
    /// How the coherent ones among them are best traced: as in pictures.
    pub(crate) neighbours: Neighbours,
}

impl Rays {
    /// Makes the rays of a set; `size` is the picture's width and height in pixels.
    ///
    /// There may be none: if a scene has no lamp, or the camera sees nothing of it.
    pub(crate) fn new(set: RaySet, model: &Model, size: [u32; 2]) -> Self {
        let leaving = |ray: &dyn Fn(usize, &Seen) -> Option<Query>| {
            let seen = seen(&model.world, size);
            let rays = seen.iter().enumerate();
            rays.filter_map(|(index, seen)| Some((ray(index, seen)?, seen.facing))).unzip()
        };
        let (queries, facing) = match set {
            RaySet::Primary | RaySet::Single => (primary(&model.world, size), Vec::new()),
            RaySet::Incoherent | RaySet::IncoherentSingle => {
                let count = u64::from(size[0]) * u64::from(size[1]);
                let chords = (0..count).into_par_iter().filter_map(|index| chord(model, index));
                (chords.collect(), Vec::new())
            }
            RaySet::AmbientOcclusion => {
                let reach = REACH * model.diagonal;
                leaving(&|index, seen| occlusion_ray(seen, reach, index as u64))
            }
            RaySet::Shadow => match model.world.lights().iter().find(|light| is_lamp(light)) {
                Some(lamp) => leaving(&|_, seen| shadow_ray(seen, lamp)),
                None => Default::default(),
            },
        };
        let alone = queries.iter().map(|query| *query.ray()).collect();
        let neighbours = model.world.neighbours(size);
        Self { set, queries, facing, alone, neighbours }
    }

    /// The number of rays.
    pub(crate) fn len(&self) -> usize {
        self.queries.len()
    }
}

/// The rays through the pixels' middles, in the order of [`tiled_pixels`].
fn primary(world: &World, size: [u32; 2]) -> Vec<Query> {
    let [width, height] = size.map(f64::from);
    let ray = |[x, y]: [usize; 2]| {
        let film = DVec2::new((x as f64 + 0.5) / width, (y as f64 + 0.5) / height);
        Query::primary(world.camera().ray(film, width / height))
    };
    tiled_pixels(size).map(ray).collect()
}

/// A chord of the bounding sphere: from one random point of it to another.
fn chord(model: &Model, index: u64) -> Option<Query> {
    let mut random = Random::new(SEED, CHORDS, index);
    let [from, to] = [random.direction(), random.direction()];
    let origin = model.center + model.radius * from;
    Ray::new(origin, (to - from).normalize_or_zero()).ok().map(Query::primary)
}

/// A point the camera sees.
struct Seen {
    hit: Hit,
    /// The unit normal on the camera's side.
    facing: DVec3,
}

/// What the camera sees, pixel by pixel in the order of [`primary`], as exact hits. Points
/// without a normal are left out.
fn seen(world: &World, size: [u32; 2]) -> Vec<Seen> {
    let queries = primary(world, size);
    let coherence = world.neighbours(size).first_hits;
    let chunks = queries.par_chunks(CHUNK).with_max_len(1).map(|queries| {
        let mut answers = Vec::new();
        let mut tracer = world.bvh().tracer_with(Kernel::default());
        tracer.first_hits(queries, coherence, &mut answers);
        let hits = answers.iter().zip(queries).filter_map(|(answer, query)| {
            let hit = answer.hit?;
            let away = hit.normal.dot(query.ray().direction()) > 0.0;
            let facing = if away { -hit.normal } else { hit.normal };
            facing.is_finite().then_some(Seen { hit, facing })
        });
        hits.collect::<Vec<_>>()
    });
    chunks.collect::<Vec<_>>().into_iter().flatten().collect()
}

/// A ray on the camera's side of a surface, its direction distributed as the cosine to the
/// normal: towards a random point of the unit sphere that touches the surface.
fn occlusion_ray(seen: &Seen, reach: f64, index: u64) -> Option<Query> {
    let mut random = Random::new(SEED, OCCLUSION, index);
    let direction = (seen.facing + random.direction()).normalize_or(seen.facing);
    let ray = Ray::with_range(seen.hit.point, direction, 0.0, reach).ok()?;
    Some(Query::leaving(ray, &seen.hit))
}

fn is_lamp(light: &Light) -> bool {
    !matches!(light, Light::Ambient { .. })
}

/// A ray to a lamp; `None` where the lamp stands behind the surface.
fn shadow_ray(seen: &Seen, lamp: &Light) -> Option<Query> {
    let origin = seen.hit.point;
    let ray = match *lamp {
        Light::Point { position, .. } => Ray::with_range(origin, position - origin, 0.0, 1.0),
        Light::Directional { to_light, .. } => Ray::new(origin, to_light),
        Light::Ambient { .. } => return None,
    };
    let ray = ray.ok()?;
    (seen.facing.dot(ray.direction()) > 0.0).then(|| Query::leaving(ray, &seen.hit))
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::fs;
    use std::time::Duration;

    use super::*;

    fn sphere() -> Model {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sphere.toml");
        fs::write(&path, "[[object]]\nshape = { sphere = { radius = 2 } }\n").unwrap();
        Model::load(&path, None, Duration::ZERO).unwrap()
    }

    #[test]
    fn every_pixel_has_one_ray_and_packets_are_squares() {
        let model = sphere();
        let rays = Rays::new(RaySet::Primary, &model, [100, 100]);
        assert_eq!(rays.len(), 100 * 100);
        let key = |query: &Query| query.ray().direction().to_array().map(f64::to_bits);
        assert_eq!(rays.queries.iter().map(key).collect::<HashSet<_>>().len(), 100 * 100);

        let pixel = |index: usize| {
            let camera = model.world.camera();
            let d = rays.queries[index].ray().direction();
            let right = camera.ray(DVec2::new(1.0, 0.5), 1.0).direction() - camera.forward();
            let x = d.dot(camera.right()) / right.length();
            let y = -d.dot(camera.up()) / right.length();
            [x, y].map(|s| (50.0 * s + 49.5).round() as i32)
        };
        for (packet, side) in [(16, 4), (64, 8)] {
            let pixels: Vec<_> = (3 * packet..4 * packet).map(pixel).collect();
            let widest = |axis: usize| {
                let along = pixels.iter().map(|pixel| pixel[axis]);
                along.clone().max().unwrap() - along.min().unwrap()
            };
            assert_eq!([widest(0), widest(1)], [side - 1, side - 1]);
        }
    }

    #[test]
    fn chords_cross_the_sphere_about_the_model() {
        let model = sphere();
        assert!((model.radius - 2.02).abs() < 1e-3, "{}", model.radius);
        let rays = Rays::new(RaySet::Incoherent, &model, [32, 32]);
        assert_eq!(rays.len(), 32 * 32);
        let mut meeting = 0;
        for query in &rays.queries {
            let ray = query.ray();
            let offset = ray.origin() - model.center;
            assert!((offset.length() - model.radius).abs() < 1e-14);
            let nearest = offset.reject_from_normalized(ray.direction()).length();
            meeting += u32::from(nearest < 2.0);
        }
        // The squared distance of such a chord from the centre is uniform: 1 - 2 % of them
        // pass within 2.00 of 2.02.
        assert!((970..=1024).contains(&meeting), "{meeting}");
        let again = Rays::new(RaySet::Incoherent, &model, [32, 32]);
        assert_eq!(rays.queries[5].ray(), again.queries[5].ray());
    }

    #[test]
    fn occlusion_rays_leave_the_side_that_is_seen() {
        let model = sphere();
        let rays = Rays::new(RaySet::AmbientOcclusion, &model, [24, 24]);
        assert!((200..24 * 24).contains(&rays.len()), "{}", rays.len());
        for query in &rays.queries {
            let (point, ray) = (query.ray().origin(), query.ray());
            assert!((point.length() - 2.0).abs() < 1e-14);
            assert!(point.dot(ray.direction()) >= 0.0);
            assert_eq!(ray.t_max(), REACH * model.diagonal);
            assert!(query.start_root().is_some());
        }
    }

    #[test]
    fn shadow_rays_go_to_the_lamp_in_front() {
        let model = sphere();
        let rays = Rays::new(RaySet::Shadow, &model, [24, 24]);
        let first = rays.queries[0].ray().direction();
        for query in &rays.queries {
            assert_eq!(query.ray().direction(), first); // the default lamp is far away
            assert!(query.ray().origin().dot(first) > 0.0);
        }
        let mut dark = sphere();
        dark.world.set_lights(vec![Light::Ambient { radiance: [1.0; 3] }]).unwrap();
        assert_eq!(Rays::new(RaySet::Shadow, &dark, [24, 24]).len(), 0);
    }
}
