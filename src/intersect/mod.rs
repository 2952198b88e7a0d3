//! One ray, one answer: what a ray meets, proved or flagged.

mod bvh;
mod hit;
mod statistics;
mod tracer;

pub use bvh::{BuildError, BuildOptions, SurfaceBvh};
pub use hit::{Answer, Coherence, Hit, HitFlags, Occlusion, Query, Root};
pub use statistics::Statistics;
pub use tracer::{Kernel, Tracer};
