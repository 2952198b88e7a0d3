//! The limit surface of a cage as Bézier patches.

use glam::DVec3;

use crate::geometry::{KnotVector, NurbsSurface, SurfaceError};

/// The limit surface of a cage as polynomial Bézier patches, bicubic for Catmull–Clark,
/// biquadratic for Doo–Sabin: most of them exact, those near extraordinary points within a
/// bound that is proved for each (see [`LimitPatch::deviation`]).
///
/// Patches of one size that are both exact share their border's control points bit for bit;
/// where sizes differ they agree to rounding. Where one is not exact, the gap is at most the
/// sum of their deviations, and never more than the tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitSurface {
    degree: usize,
    tolerance: f64,
    patches: Vec<LimitPatch>,
    control: Vec<DVec3>,
}

/// Which part of the surface a patch is, and how well it fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitPatch {
    /// The part of the cage.
    pub square: FaceSquare,
    /// At no (u, v) is the patch farther from the limit surface than this, in scene units
    /// (but for rounding, some ulps of the coordinates); 0 if it is exact.
    pub deviation: f64,
    /// Whether the patch is the limit surface, to rounding.
    pub exact: bool,
}

/// A part of a face of a cage: a square of its unit square.
///
/// Quads have one unit square, with corner 0 at (0, 0), corner 1 at (1, 0), corner 2 at
/// (1, 1). A face of n ≠ 4 corners has n, one for each corner: that corner at (0, 0), the
/// face's middle at (1, 1), the edge that leaves the corner along u. They are counted face
/// after face, as Ptex does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceSquare {
    /// The face of the cage.
    pub face: usize,
    /// The unit square, counted through all faces.
    pub unit: usize,
    /// The smallest u and v.
    pub low: [f64; 2],
    /// The side: a power of ½, so that low and low + side are exact.
    pub side: f64,
}

impl FaceSquare {
    /// The whole unit square of that number.
    pub(super) fn whole(face: usize, unit: usize) -> Self {
        Self { face, unit, low: [0.0; 2], side: 1.0 }
    }

    /// The quarter at corner k.
    pub(super) fn quarter(&self, k: usize) -> Self {
        let side = 0.5 * self.side;
        let (u, v) = (f64::from(u8::from(k == 1 || k == 2)), f64::from(u8::from(k >= 2)));
        Self { low: [self.low[0] + u * side, self.low[1] + v * side], side, ..*self }
    }

    /// The place in the unit square of a patch's (u, v) in [0, 1]².
    pub fn unit_uv(&self, u: f64, v: f64) -> [f64; 2] {
        [self.low[0] + self.side * u, self.low[1] + self.side * v]
    }
}

impl LimitSurface {
    pub(super) fn empty(degree: usize, tolerance: f64) -> Self {
        Self { degree, tolerance, patches: Vec::new(), control: Vec::new() }
    }

    pub(super) fn push(&mut self, patch: LimitPatch, net: &[DVec3]) {
        self.patches.push(patch);
        self.control.extend_from_slice(net);
    }

    /// The degree in u and in v: 3 or 2.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The patches, those of a face together, faces in the order of the cage.
    pub fn patches(&self) -> &[LimitPatch] {
        &self.patches
    }

    /// The `(degree + 1)²` control points of a patch, v fastest; `None` beyond the last.
    pub fn control(&self, patch: usize) -> Option<&[DVec3]> {
        let count = (self.degree + 1) * (self.degree + 1);
        self.control.get(patch.checked_mul(count)?..)?.get(..count)
    }

    /// A patch as a surface with the domain [0, 1]²; `None` beyond the last.
    ///
    /// # Errors
    /// When its control points all coincide.
    pub fn surface(&self, patch: usize) -> Option<Result<NurbsSurface, SurfaceError>> {
        let points = self.control(patch)?.to_vec();
        let knots = KnotVector::bezier(self.degree);
        let knots = knots.map_err(|error| SurfaceError::Knots {
            direction: crate::geometry::Direction::U,
            error,
        });
        Some(knots.and_then(|knots| NurbsSurface::new(knots.clone(), knots, points, None)))
    }

    /// What was asked for, in scene units: no gap between patches is wider.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The largest deviation of a patch; at most half the tolerance.
    pub fn deviation(&self) -> f64 {
        self.patches.iter().map(|patch| patch.deviation).fold(0.0, f64::max)
    }

    /// The number of patches that are the limit surface to rounding.
    pub fn exact_count(&self) -> usize {
        self.patches.iter().filter(|patch| patch.exact).count()
    }
}
