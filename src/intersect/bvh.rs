//! Surfaces ready to be traced.

use glam::DVec3;
use thiserror::Error;

use super::{Kernel, Tracer};
use crate::geometry::NurbsSurface;

/// How surfaces are prepared.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct BuildOptions {}

/// Why surfaces cannot be prepared for tracing.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// There are more surfaces, pieces or leaves than 32-bit indices can count.
    #[error("{count} {what}, but at most {limit} can be traced")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many were found.
        count: usize,
        /// How many are possible.
        limit: usize,
    },
}

/// Surfaces split into Bézier pieces and leaves, bounded in a hierarchy.
#[derive(Clone, Debug)]
pub struct SurfaceBvh {
    surfaces: usize,
}

impl SurfaceBvh {
    /// Prepares surfaces for tracing; hits name them by their place in the slice.
    ///
    /// # Errors
    /// When there is more than 32-bit indices can count.
    pub fn build(surfaces: &[NurbsSurface], _options: &BuildOptions) -> Result<Self, BuildError> {
        Ok(Self { surfaces: surfaces.len() })
    }

    /// Ready to trace on this thread with the default kernel.
    pub fn tracer(&self) -> Tracer<'_> {
        self.tracer_with(Kernel::default())
    }

    /// Ready to trace on this thread with the kernel named.
    pub fn tracer_with(&self, kernel: Kernel) -> Tracer<'_> {
        Tracer::new(self, kernel)
    }

    /// The number of surfaces.
    pub fn surface_count(&self) -> usize {
        self.surfaces
    }

    /// The number of Bézier pieces of a surface.
    pub fn patch_count(&self, _surface: usize) -> usize {
        0
    }

    /// The number of leaves of a surface.
    pub fn leaf_count(&self, _surface: usize) -> usize {
        0
    }

    /// The memory held, in bytes.
    pub fn bytes(&self) -> usize {
        0
    }

    /// The smallest and largest coordinates of the control nets; `None` without surfaces.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        None
    }
}
