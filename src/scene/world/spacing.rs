//! The distance between neighbouring rays of a picture.

use glam::DVec2;

use super::World;
use crate::intersect::{Kernel, Neighbours};

/// The number of rays in each direction that find the distance of a picture's surfaces.
const PROBES: u32 = 8;

impl World {
    /// How the camera's rays, and the rays that leave their hits, are best traced in a picture of
    /// this size.
    ///
    /// It is judged by the distance between neighbouring rays at the median depth of the hits of a
    /// coarse grid of rays: the same for all of the picture, whichever part of it is made, with
    /// whichever kernel.
    pub fn neighbours(&self, size: [u32; 2]) -> Neighbours {
        self.bvh.neighbours(self.camera.pixel_width(size, self.depth(size)))
    }

    /// The median depth of the hits, or the distance of the bounding box if nothing is hit.
    fn depth(&self, [width, height]: [u32; 2]) -> f64 {
        let aspect = f64::from(width) / f64::from(height);
        let mut tracer = self.bvh.tracer_with(Kernel::Scalar);
        let mut depths = Vec::new();
        for k in 0..PROBES * PROBES {
            let cell = DVec2::new(f64::from(k % PROBES), f64::from(k / PROBES));
            let film = (cell + 0.5) / f64::from(PROBES);
            depths.extend(tracer.first_hit(&self.camera.ray(film, aspect)).hit.map(|hit| hit.t));
        }
        depths.sort_unstable_by(f64::total_cmp);
        let eye = self.camera.view().look_from;
        let (min, max) = self.bvh.bounds().unwrap_or((eye, eye));
        depths.get(depths.len() / 2).copied().unwrap_or(eye.distance(eye.clamp(min, max)))
    }
}
