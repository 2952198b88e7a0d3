//! Properties of a hit as colours.

use glam::DVec3;

use crate::intersect::Hit;
use crate::math::Ray;
use crate::scene::{Projection, Rgb, World, share};

/// Which property of a hit is shown.
#[derive(Clone, Copy, Debug)]
pub(crate) enum HitColor {
    /// The normal `n`, as oriented by the surface, as `(n + 1) / 2`; grey without one.
    Normal,
    /// `u` as red and `v` as green, each from 0 to 1 over the surface's domain.
    Uv,
    /// The distance along the ray, from white (nearest) to dark grey (farthest the model
    /// can be).
    Depth {
        /// The distance no hit is nearer than.
        near: f64,
        /// The distance no hit is farther than.
        far: f64,
    },
    /// A colour for each surface.
    Id,
}

/// The grey of the farthest hit: dark, but on no screen the black of no hit (sRGB 39).
const FARTHEST: f64 = 0.02;

/// The golden ratio's fractional part: its multiples, modulo 1, keep the largest distances
/// from each other (Knuth, TAOCP vol. 3, 6.4), so neighbouring ids get unlike hues.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// How far an id's colour is from grey (0) towards the pure hue (1).
const SATURATION: f64 = 0.9;

impl HitColor {
    /// Depth over the distances the world's bounding box allows.
    pub(super) fn depth(world: &World) -> Self {
        let Some((min, max)) = world.bvh.bounds() else {
            return Self::Depth { near: 0.0, far: 0.0 };
        };
        let eye = world.camera.view().look_from;
        let corners = (0..8).map(|bits| {
            let pick = |axis: usize| if bits >> axis & 1 == 0 { min[axis] } else { max[axis] };
            DVec3::from_array([0, 1, 2].map(pick)) - eye
        });
        let (near, far): (f64, f64) = match world.camera.projection() {
            // From the eye to the box's nearest point and its farthest corner.
            Projection::Perspective { .. } => (
                (eye.clamp(min, max) - eye).length(),
                corners.map(DVec3::length).fold(0.0, f64::max),
            ),
            // From the film, along the view.
            Projection::Orthographic { .. } => {
                let along = corners.map(|corner| corner.dot(world.camera.forward()));
                along.fold((f64::INFINITY, 0.0), |(near, far), x| (near.min(x), far.max(x)))
            }
        };
        Self::Depth { near: near.max(0.0), far }
    }

    /// The colour of a hit.
    pub(super) fn of(self, world: &World, ray: &Ray, hit: &Hit) -> Rgb {
        match self {
            Self::Normal => {
                let normal = if hit.normal.is_nan() { DVec3::ZERO } else { hit.normal };
                (0.5 * (normal + 1.0)).to_array()
            }
            Self::Uv => {
                let domain = world.surfaces[hit.surface as usize].surface.tile(hit.uv);
                [share(hit.uv.x, domain[0]), share(hit.uv.y, domain[1]), 0.0]
            }
            Self::Depth { near, far } => {
                let distance = hit.t * ray.direction().length();
                // Where there is no room between them (0 / 0), all is near.
                let share = ((distance - near) / (far - near)).clamp(0.0, 1.0);
                let share = if share.is_nan() { 0.0 } else { share };
                [1.0 - (1.0 - FARTHEST) * share; 3]
            }
            Self::Id => hue((f64::from(hit.surface) * GOLDEN).fract()),
        }
    }
}

/// A bright colour of a hue in [0, 1): red, yellow, green, cyan, blue, magenta.
fn hue(hue: f64) -> Rgb {
    [0.0, 2.0 / 3.0, 1.0 / 3.0].map(|shift| {
        let pure = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        1.0 + SATURATION * (pure.clamp(0.0, 1.0) - 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_of_neighbouring_ids_differ() {
        assert_eq!(hue(0.0).map(|x| (10.0 * x).round()), [10.0, 1.0, 1.0]);
        let color = |id: u32| hue((f64::from(id) * GOLDEN).fract());
        for id in 0..1000 {
            for next in id + 1..id + 5 {
                let distance: f64 = (0..3).map(|k| (color(id)[k] - color(next)[k]).abs()).sum();
                assert!(distance > 0.3, "{id} and {next}: {distance}");
            }
        }
    }
}
