//! Direct: lights, shadows and diffuse materials.

use std::f64::consts::PI;

use glam::DVec3;

use super::Batch;
use crate::intersect::{Coherence, Hit, Occlusion, Query, Tracer};
use crate::math::Ray;
use crate::render::Counters;
use crate::scene::{Light, Rgb, World};

/// Lambert's diffuse reflection of lights that are seen from the hit.
///
/// Surfaces have two sides, each lit by the lights on the viewer's side: the normal is
/// turned towards the viewer. A hit without a normal is taken to face the viewer.
/// Radiance: `albedo / π · Σ E cos θ` over the lights not hidden, plus ambient light.
#[derive(Debug, Default)]
pub(crate) struct Direct {
    /// The hits of a batch, with what shading needs to know.
    points: Vec<Shaded>,
    /// Shadow rays towards one light, and what each brings to which sample.
    shadows: Vec<Query>,
    brought: Vec<(usize, Rgb)>,
    hidden: Vec<Occlusion>,
}

/// A hit about to be lit.
#[derive(Clone, Copy, Debug)]
struct Shaded {
    /// Its place in the batch.
    index: usize,
    hit: Hit,
    /// The unit normal on the viewer's side.
    normal: DVec3,
    albedo: Rgb,
}

impl Direct {
    /// Finds the radiance of each camera ray from its first hit; returns what was traced. Shadow
    /// rays are traced with the coherence given with the tracer.
    pub(super) fn light(
        &mut self,
        world: &World,
        (tracer, coherence): (&mut Tracer<'_>, Coherence),
        batch: &mut Batch,
    ) -> Counters {
        self.points.clear();
        for (index, (ray, answer)) in batch.rays.iter().zip(&batch.answers).enumerate() {
            let Some(hit) = answer.hit else {
                batch.radiance.push(world.background);
                continue;
            };
            batch.radiance.push([0.0; 3]);
            let normal = facing(hit.normal, ray.direction());
            self.points.push(Shaded { index, hit, normal, albedo: world.albedo(&hit) });
        }

        let mut counters = Counters::default();
        for light in &world.lights {
            counters += self.add_light(light, (&mut *tracer, coherence), batch);
        }
        counters
    }

    /// Adds one light to the radiance of all hits that see it, and notes where that is in doubt.
    fn add_light(
        &mut self,
        light: &Light,
        (tracer, coherence): (&mut Tracer<'_>, Coherence),
        batch: &mut Batch,
    ) -> Counters {
        let Batch { radiance, doubtful, .. } = batch;
        self.shadows.clear();
        self.brought.clear();
        for point in &self.points {
            let origin = point.hit.point;
            let beam = match *light {
                Light::Ambient { radiance: ambient } => {
                    add(&mut radiance[point.index], product(point.albedo, ambient));
                    None
                }
                Light::Point { position, intensity } => from_point(position, intensity, origin),
                Light::Directional { to_light, irradiance } => {
                    Ray::new(origin, to_light).ok().map(|ray| (ray, irradiance))
                }
            };
            if let Some((ray, irradiance)) = beam.and_then(|beam| received(beam, point.normal)) {
                let diffuse = product(point.albedo, irradiance).map(|x| x / PI);
                self.shadows.push(Query::leaving(ray, &point.hit));
                self.brought.push((point.index, diffuse));
            }
        }

        // Rays towards one light are as close together as their hits are.
        tracer.occlusions(&self.shadows, coherence, &mut self.hidden);
        for (&(index, diffuse), hidden) in self.brought.iter().zip(&self.hidden) {
            if !hidden.occluded {
                add(&mut radiance[index], diffuse);
            }
            doubtful[index] |= hidden.doubtful;
        }
        Counters {
            rays: self.shadows.len() as u64,
            doubtful: self.hidden.iter().filter(|hidden| hidden.doubtful).count() as u64,
            ..Counters::default()
        }
    }
}

/// The shadow ray to a point light, and the irradiance of a surface that faces the light; `None` at
/// the light itself.
fn from_point(position: DVec3, intensity: Rgb, origin: DVec3) -> Option<(Ray, Rgb)> {
    // Up to the light and no farther; a light on the surface itself lights nothing.
    let to_light = position - origin;
    let ray = Ray::with_range(origin, to_light, 0.0, 1.0).ok()?;
    let distance = to_light.length();
    Some((ray, intensity.map(|x| x / distance / distance)))
}

/// The shadow ray, and the irradiance of a surface with this normal if nothing is in the ray's way;
/// `None` where the light stands behind the surface or sends nothing.
fn received((ray, irradiance): (Ray, Rgb), normal: DVec3) -> Option<(Ray, Rgb)> {
    let cosine = normal.dot(ray.direction().normalize_or_zero());
    let irradiance = irradiance.map(|x| x * cosine);
    let lit = cosine > 0.0 && irradiance.iter().any(|&x| x > 0.0); // false for NaN
    lit.then_some((ray, irradiance))
}

/// The unit normal on the side a ray comes from.
fn facing(normal: DVec3, direction: DVec3) -> DVec3 {
    if normal.is_nan() {
        -direction.normalize_or_zero()
    } else if normal.dot(direction) > 0.0 {
        -normal
    } else {
        normal
    }
}

fn product(a: Rgb, b: Rgb) -> Rgb {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

fn add(sum: &mut Rgb, more: Rgb) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}
