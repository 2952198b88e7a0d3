//! All the ways in which rays can be traced.

use nurbray::intersect::{Answer, Coherence, Kernel, Occlusion, Query, SurfaceBvh};

/// Everything a kernel can be asked of rays: first hits, then whether they are occluded.
pub(crate) fn all_ways(
    bvh: &SurfaceBvh,
    kernel: Kernel,
    queries: &[Query],
) -> (Vec<Vec<Answer>>, Vec<Vec<Occlusion>>) {
    let mut tracer = bvh.tracer_with(kernel);
    let mut answers = vec![queries.iter().map(|query| tracer.first_hit(query)).collect()];
    let mut occlusions = vec![queries.iter().map(|query| tracer.occluded(query)).collect()];
    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
        let (mut hits, mut occluded) = (Vec::new(), Vec::new());
        tracer.first_hits(queries, coherence, &mut hits);
        tracer.occlusions(queries, coherence, &mut occluded);
        answers.push(hits);
        occlusions.push(occluded);
    }
    (answers, occlusions)
}

/// The kernels that this processor has.
pub(crate) fn kernels() -> impl Iterator<Item = Kernel> {
    Kernel::ALL.iter().copied().filter(|kernel| kernel.is_available())
}

/// Asserts that every ray meets something, or is doubtful, in every way and by every kernel.
pub(crate) fn assert_met_or_doubted(context: &str, bvh: &SurfaceBvh, rays: &[Query]) {
    for kernel in kernels() {
        let (answers, occlusions) = all_ways(bvh, kernel, rays);
        for (query, answer) in answers.iter().flat_map(|way| rays.iter().zip(way)) {
            let known = answer.hit.is_some() || answer.doubtful;
            assert!(known, "{context}, {kernel}: {:?}", query.ray());
        }
        for (query, occlusion) in occlusions.iter().flat_map(|way| rays.iter().zip(way)) {
            let known = occlusion.occluded || occlusion.doubtful;
            assert!(known, "{context}, {kernel}: {:?}", query.ray());
        }
    }
}
