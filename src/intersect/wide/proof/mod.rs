//! Why fast answers are certain: three proofs, beside that of a leaf's certificate.
//!
//! 1. Where the certificate holds for a ray (`certified`), there is one root at most. Often it is
//!    enough to prove that it is not on the leaf or, if any hit will do, that it is (`screen`).
//! 2. Where it does not hold: what the leaf's approximation says of that ray's roots (`one_ray`).
//!    `lanes` does this for sixteen rays and leaves at a time, which packets collect; `lane_parts`
//!    has the parts of leaves that are examined.
//! 3. A ray that leaves a leaf does not come back to it (`departure`).
//!
//! They share `bounds`: parts of leaves, and rounding errors. The second needs cubics over
//! parts of their range, and in Bernstein form (`cubic`). What is not proved is left to the scalar
//! search.

pub(super) mod bounds;
pub(super) mod certified;
mod cubic;
pub(super) mod departure;
pub(super) mod lane_parts;
pub(super) mod lanes;
pub(super) mod one_ray;
pub(super) mod screen;
