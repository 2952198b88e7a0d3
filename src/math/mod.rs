//! Numbers: rays, boxes, rounding, Bernstein polynomials; and how messages write them. Depends on
//! nothing else of the library.
//!
//! The promised accuracy comes from here: [`rounding::residual_factor`] is the error bound of a
//! computed point of a surface, in units of its coordinates. Places count as one, and rays as
//! touching, within multiples of that: [`intersect`](crate::intersect#errors-and-who-may-spend-them)
//! gives an account of these. Every other number that something is compared with is
//! explained where it stands.

mod aabb;
pub(crate) mod angle;
pub mod bernstein;
pub(crate) mod bits;
mod interval;
mod prefetch;
mod ray;
mod ray_frame;
pub(crate) mod rounded;
pub mod rounding;
mod shown;
mod split_mix;
#[cfg(test)]
pub(crate) mod testing;
mod twofold;
mod unit;

pub use aabb::Aabb;
pub(crate) use interval::Interval;
pub(crate) use prefetch::prefetch;
pub use ray::{Ray, RayError};
pub(crate) use ray_frame::PLAIN_SQUARES;
pub use ray_frame::RayFrame;
pub use shown::{AtLeast, Counted, Measured, MeasuredPoint, Shown, ShownVector};
pub use split_mix::SplitMix;
pub(crate) use twofold::Twofold;
pub(crate) use unit::unit;
