//! When the searches end: how many steps they take, and when a place in f64 is as near to the root
//! as it is promised to be.

use crate::math::rounding::UNIT_ROUNDOFF;

/// Steps in f32: from the middle of a flat leaf, the first leaves an error of about 1e-2 of the
/// leaf, the second 1e-4 or the fit's error.
pub(crate) const STEPS_IN_F32: usize = 2;

/// The largest number of steps in f64: one or two are usual after the search in f32.
pub(crate) const MOST_STEPS: u32 = 4;

/// The part of the promised error that a last step may leave behind by curvature, and as much again
/// by rounding; of the surface's own error, the part that it may leave of the point.
pub(crate) const PART_OF_ERROR: f64 = 0.125;

/// Rounding error that a step leaves in the distances `f`, as a part of `|f| |a| |b| / |det|`,
/// where `a` and `b` are the tangents' components across the ray: numerators are off by four units
/// of that, the determinant by two, products with the tangents by two. (Components are off by some
/// units of the tangents' lengths themselves, which is more only for rays almost along a tangent.)
/// This error matters where tangents are nearly parallel.
const ROUNDING_OF_STEP: f64 = 8.0 * UNIT_ROUNDOFF;

/// The largest square of `|f| |a| |b| / |det|`, over that of the error, at which the rounding of a
/// step leaves no more than [`PART_OF_ERROR`].
pub(crate) const MOST_ROUNDED: f64 = {
    let most = PART_OF_ERROR / ROUNDING_OF_STEP;
    most * most
};

/// The sum of both speeds times this must not exceed the promised error: then the rounding of
/// parameters, by half a unit, moves a point by at most a quarter of that error.
pub(crate) const COARSEST: f64 = 2.0 * UNIT_ROUNDOFF;
