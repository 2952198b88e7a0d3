//! The question that a ray puts to leaves.

use super::start::StartRoot;
use crate::intersect::query::StartIn;
use crate::intersect::wanted::Wanted;
use crate::intersect::{Query, Root};
use crate::math::RayFrame;
use crate::patch::PatchSet;

/// Everything a search of leaves needs to know about a query.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<'a> {
    pub set: &'a PatchSet,
    pub ray: &'a RayFrame,
    pub t_range: [f64; 2],
    pub from: Option<&'a Root>,
    /// Whether all hits are wanted: then a root just beyond a trim edge, which another search may
    /// have found at the edge, is doubtful.
    pub all_hits: bool,
}

impl<'a> Question<'a> {
    /// A query about these pieces; `ray` is its frame.
    pub(crate) fn new(
        set: &'a PatchSet,
        query: &'a Query,
        ray: &'a RayFrame,
        wanted: Wanted,
    ) -> Self {
        let t_range = [query.ray.t_min(), query.ray.t_max()];
        Self { set, ray, t_range, from: query.start_in(set), all_hits: wanted == Wanted::All }
    }

    /// The place the ray starts at, if it leaves a root of these surfaces.
    pub(super) fn start(&self) -> Option<StartRoot<'a>> {
        Some(StartRoot::new(self.from?, self.set, self.ray))
    }
}
