//! Numbers: rays, boxes, rounding, Bernstein polynomials. Depends on glam only.

mod aabb;
pub mod bernstein;
mod interval;
mod ray;
mod ray_frame;
pub mod rounding;

pub use aabb::Aabb;
pub use interval::Interval;
pub use ray::{Ray, RayError};
pub use ray_frame::RayFrame;
