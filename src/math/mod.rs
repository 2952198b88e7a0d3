//! Numbers: rays, intervals, Bernstein polynomials. Depends on glam only.

mod ray;

pub use ray::{Ray, RayError};
