//! One ray, one answer: what a ray meets, proved or flagged.

mod bvh;
mod crossings;
mod exact;
mod hierarchy;
mod hit;
mod kernel;
mod leaf_search;
mod newton;
mod packets;
mod statistics;
mod tracer;
mod wide;

pub use bvh::{BuildError, BuildOptions, SurfaceBvh};
pub use hit::{Answer, Coherence, Hit, HitFlags, Occlusion, Query, Root};
pub use kernel::Kernel;
pub use statistics::Statistics;
pub use tracer::Tracer;
