//! What a sweep can be asked for, and what it gives.

use glam::DVec3;

use crate::geometry::{MAX_DEGREE, NurbsSurface};

/// How a profile is carried along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepOptions {
    /// The direction of the profile's y axis at the start, as nearly as possible. The default is z,
    /// or y where the path begins steeply.
    pub up: Option<DVec3>,
    /// The angle in degrees by which the profile turns about the path, evenly in the path's
    /// parameter; counterclockwise as seen by one whom the path comes towards.
    pub twist: f64,
    /// The profile's size along the path: the coefficients of a Bézier polynomial over the path's
    /// domain, at most [`MAX_SCALES`] of them. `[1]` keeps the size, `[1, 0]` shrinks the profile
    /// to a point at the end.
    pub scale: Vec<f64>,
    /// The largest allowed distance of the surface from the true sweep where that is not rational,
    /// in scene units. The default is a millionth of [`sweep_size`](super::sweep_size) or, where
    /// that is less, a thousandth of the profile's size, but no finer than rounding allows: 1e-11
    /// of the path's size and coordinates.
    pub tolerance: Option<f64>,
}

impl Default for SweepOptions {
    /// Neither twisted nor scaled.
    fn default() -> Self {
        Self { up: None, twist: 0.0, scale: vec![1.0], tolerance: None }
    }
}

/// A swept surface, and a measured estimate of its distance from the true sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The surface: `u` runs along the profile, `v` along the path, on their own domains.
    pub surface: NurbsSurface,
    /// 0 where the surface is exact, else a measured estimate of its largest distance from the true
    /// sweep at the same parameters, in scene units: 9/8 of the largest distance found at seven
    /// places of each piece along the path (more, if path and scale have high degrees), for all of
    /// the profile's control points. It is not a proved bound. Never more than the tolerance.
    pub deviation: f64,
}

/// The most coefficients of a scale: those of a Bézier polynomial of the largest degree.
pub const MAX_SCALES: usize = MAX_DEGREE + 1;

/// The least number of steps in which a profile is sampled to find whether the sweep folds.
pub(crate) const FOLD_SAMPLES: usize = 64;
