//! Direct: lights, shadows and diffuse materials.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::Batch;
use crate::intersect::{Coherence, Occlusion, Query, Tracer};
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
    brought: Vec<Brought>,
    hidden: Vec<Occlusion>,
}

/// A hit about to be lit.
#[derive(Clone, Copy, Debug)]
struct Shaded {
    /// The place of its answer in the batch.
    index: usize,
    /// The unit normal on the viewer's side.
    normal: DVec3,
    albedo: Rgb,
}

/// What a light brings if nothing is in the way.
#[derive(Clone, Copy, Debug)]
struct Brought {
    /// The place of the hit's answer in the batch.
    index: usize,
    radiance: Rgb,
}

/// What a light sends to a place if nothing is in the way.
struct Beam {
    /// From the place to the light, and no farther.
    ray: Ray,
    /// The unit direction of that ray.
    to_light: DVec3,
    /// The irradiance of a surface that faces the light.
    irradiance: Rgb,
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
            let Some(hit) = &answer.hit else {
                batch.radiance.push(world.background);
                continue;
            };
            batch.radiance.push([0.0; 3]);
            let normal = facing(hit.normal, ray.direction());
            self.points.push(Shaded { index, normal, albedo: world.albedo(hit) });
        }

        let mut counters = Counters::default();
        for light in &world.lights {
            let place = match *light {
                Light::Ambient { radiance: ambient } => {
                    for point in &self.points {
                        add(&mut batch.radiance[point.index], product(point.albedo, ambient));
                    }
                    continue;
                }
                Light::Point { position, intensity } => {
                    self.aim(batch, |origin| Beam::from_point(position, intensity, origin));
                    Some(position)
                }
                Light::Directional { to_light, irradiance } => {
                    let unit = to_light.normalize_or_zero();
                    self.aim(batch, |origin| {
                        let ray = Ray::new(origin, to_light).ok()?;
                        Some(Beam { ray, to_light: unit, irradiance })
                    });
                    None
                }
            };
            counters += self.add_seen((&mut *tracer, coherence), place, batch);
        }
        counters
    }

    /// Makes the shadow rays of all hits that a light, which sends `beam` to a place, may reach.
    fn aim(&mut self, batch: &Batch, beam: impl Fn(DVec3) -> Option<Beam>) {
        let Self { points, shadows, brought, .. } = self;
        shadows.clear();
        brought.clear();
        for &Shaded { index, normal, albedo } in points.iter() {
            let Some(hit) = &batch.answers[index].hit else { continue };
            let Some(Beam { ray, to_light, irradiance }) = beam(hit.point) else { continue };
            let cosine = normal.dot(to_light);
            let diffuse = product(albedo, irradiance).map(|x| x * (cosine * FRAC_1_PI));
            // Not where the light stands behind the surface, or sends nothing. False for NaN.
            if cosine > 0.0 && irradiance.iter().any(|&x| x > 0.0) {
                shadows.push(Query::leaving(ray, hit));
                brought.push(Brought { index, radiance: diffuse });
            }
        }
    }

    /// Adds a light, which may have a place, to the radiance of all hits that see it, and notes
    /// where that is in doubt.
    fn add_seen(
        &mut self,
        (tracer, coherence): (&mut Tracer<'_>, Coherence),
        place: Option<DVec3>,
        batch: &mut Batch,
    ) -> Counters {
        let Batch { answers, radiance, doubtful, .. } = batch;
        // Rays towards one light are as close together as their hits are.
        tracer.occlusions(&self.shadows, coherence, &mut self.hidden);
        for (&Brought { index, radiance: brought }, hidden) in
            self.brought.iter().zip(&mut self.hidden)
        {
            // A lamp may hang on a surface, which is not in its way.
            if hidden.doubtful
                && let (Some(place), Some(hit)) = (place, &answers[index].hit)
            {
                *hidden = tracer.occluded_up_to(hit, place);
            }
            if !hidden.occluded {
                add(&mut radiance[index], brought);
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

impl Beam {
    /// From a point light; `None` at the light itself.
    fn from_point(position: DVec3, intensity: Rgb, origin: DVec3) -> Option<Self> {
        // Up to the light and no farther; a light at the hit itself lights nothing.
        let way = position - origin;
        let ray = Ray::with_range(origin, way, 0.0, 1.0).ok()?;
        let nearness = way.length().recip();
        let irradiance = intensity.map(|x| x * nearness * nearness);
        Some(Self { ray, to_light: way * nearness, irradiance })
    }
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
