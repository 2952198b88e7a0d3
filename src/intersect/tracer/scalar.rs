//! The scalar search: what it answers about a ray, and about leaves that another search has left
//! undecided.

use glam::DVec3;

use super::answer::answer_of;
use crate::intersect::roots::meeting::Meeting;
use crate::intersect::roots::placed_leaf::PlacedLeaf;
use crate::intersect::roots::question::Question;
use crate::intersect::scalar::findings::Findings;
use crate::intersect::scalar::leaf_search::{self, search};
use crate::intersect::wanted::Wanted;
use crate::intersect::{Answer, Occlusion, Query, Tracer};
use crate::math::RayFrame;
use crate::patch::{OrientedBox, Passage};

/// How a leaf is searched.
pub(super) type SearchLeaf = fn(&Question<'_>, &PlacedLeaf<'_>, &Passage, f64, &mut Findings);

impl Tracer<'_> {
    /// The first hit of a ray.
    pub(super) fn scalar_first(&mut self, query: &Query) -> Answer {
        self.first_by(search, query)
    }

    /// Whether anything lies on a ray.
    pub(super) fn scalar_any(&mut self, query: &Query) -> Occlusion {
        self.collect(search, (query, &RayFrame::new(&query.ray)), Wanted::Any);
        self.findings.occlusion()
    }

    /// Puts the meetings with all leaves into the findings; returns the ray's unit direction.
    pub(super) fn scalar_all(&mut self, query: &Query) -> DVec3 {
        self.all_by(search, query)
    }

    /// [`scalar_first`](Self::scalar_first) by any search of leaves.
    pub(super) fn first_by(&mut self, search: SearchLeaf, query: &Query) -> Answer {
        self.collect(search, (query, &RayFrame::new(&query.ray)), Wanted::First);
        let findings = &mut self.findings;
        let answer = answer_of(&self.bvh.set, findings.meetings.iter(), findings.doubt);
        findings.statistics.count_doubt(answer.doubtful);
        answer
    }

    /// [`scalar_all`](Self::scalar_all) by any search of leaves.
    pub(super) fn all_by(&mut self, search: SearchLeaf, query: &Query) -> DVec3 {
        let frame = RayFrame::new(&query.ray);
        self.collect(search, (query, &frame), Wanted::All);
        frame.axis
    }

    /// Searches all leaves the ray may meet, as far along it as anything matters.
    fn collect(&mut self, search: SearchLeaf, (query, ray): (&Query, &RayFrame), wanted: Wanted) {
        let bvh = self.bvh;
        let question = Question::new(&bvh.set, query, ray, wanted);
        let findings = &mut self.findings;
        findings.clear();
        findings.statistics.rays += 1;
        let mut limit = ray.z_range[1];
        let nodes = bvh.tree.traverse(ray, &mut self.stack, |index, (oriented, region)| {
            let placed = bvh.placed(index, oriented);
            let Some(passage) = placed.passage(ray, region, limit) else { return limit };
            let before = findings.meetings.len();
            search(&question, &placed, &passage, limit, findings);
            let new = &findings.meetings[before..];
            limit = limit.min(wanted.limit_after(new, ray.t_from_z));
            limit
        });
        findings.statistics.nodes += nodes;
    }

    /// Searches leaves that another search could not decide, as far as `limit` along the ray, which
    /// may be where that search has a hit: so each leaf is searched farther by its error.
    ///
    /// Near leaves come first, whatever the order they were found in: effort spent on one is not
    /// left for others.
    pub(super) fn search_undecided(
        &mut self,
        (query, ray): (&Query, &RayFrame),
        leaves: impl Iterator<Item = u32>,
        limit: f64,
        wanted: Wanted,
    ) {
        let bvh = self.bvh;
        let question = Question::new(&bvh.set, query, ray, wanted);
        self.findings.clear();
        let passage = |leaf: u32| {
            let oriented = bvh.tree.oriented(leaf);
            let passage =
                bvh.placed(leaf, &oriented).passage(ray, bvh.tree.frame_of(leaf), limit)?;
            Some((passage, leaf, oriented))
        };
        let mut met: Vec<(Passage, u32, OrientedBox)> = leaves.filter_map(passage).collect();
        met.sort_unstable_by(|a, b| a.0.entry.total_cmp(&b.0.entry).then(a.1.cmp(&b.1)));
        let mut limit = limit;
        for (passage, index, oriented) in met {
            let placed = bvh.placed(index, &oriented);
            let slack = placed.piece.patch.error_bound(ray.magnitude);
            if passage.entry > limit + slack {
                continue;
            }
            let before = self.findings.meetings.len();
            search(&question, &placed, &passage, limit + slack, &mut self.findings);
            let new = &self.findings.meetings[before..];
            limit = limit.min(wanted.limit_after(new, ray.t_from_z));
        }
    }
}

impl Wanted {
    /// How far along the ray anything matters once these are met; `t_from_z` is the ray's.
    fn limit_after(self, meetings: &[Meeting], t_from_z: f64) -> f64 {
        match self {
            // Up to the nearest meeting, plus its error bound.
            Self::First => {
                let ends = meetings.iter().map(|meeting| meeting.t + meeting.t_error());
                ends.fold(f64::INFINITY, f64::min) / t_from_z
            }
            // One certain hit is enough; a doubtful one keeps the search going.
            Self::Any if meetings.iter().any(Meeting::is_certain) => f64::NEG_INFINITY,
            Self::Any | Self::All => f64::INFINITY,
        }
    }
}

/// The exact solver as a way to search a leaf.
pub(super) fn exactly(
    question: &Question<'_>,
    placed: &PlacedLeaf<'_>,
    passage: &Passage,
    limit: f64,
    findings: &mut Findings,
) {
    findings.statistics.leaf_tests += 1;
    let nearest_z = leaf_search::met_from(placed, passage, question.ray);
    leaf_search::search_exactly(question, placed, nearest_z, limit, findings);
}
