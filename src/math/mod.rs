//! Numbers: rays, boxes, rounding, Bernstein polynomials. Depends on nothing else of the library.
//!
//! What is promised comes from here: [`rounding::residual_factor`] says how far a computed point of a
//! surface may be from the true one, in units of its coordinates. Places are taken for one, and rays for
//! touching, within multiples of that; whatever else is compared with a number says why where that stands.

mod aabb;
pub(crate) mod angle;
pub mod bernstein;
mod interval;
mod prefetch;
mod ray;
mod ray_frame;
pub mod rounding;
mod shown;
#[cfg(test)]
pub(crate) mod testing;
mod unit;

pub use aabb::Aabb;
pub use interval::Interval;
pub(crate) use prefetch::prefetch;
pub use ray::{Ray, RayError};
pub use ray_frame::RayFrame;
pub use shown::{AtLeast, Counted, Measured, MeasuredPoint, Shown, ShownVector};
pub(crate) use unit::unit;
