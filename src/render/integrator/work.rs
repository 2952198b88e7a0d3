//! Iterations: how much work each ray took, as a colour.

use super::Batch;
use crate::intersect::{Statistics, Tracer};
use crate::scene::Rgb;

/// The work whose colour is white, as a power of two. A certified hit takes a few steps, a
/// silhouette tens, the exact solver hundreds.
const WHITE: f64 = 10.0;

/// Traces ray by ray and turns the work of each into a colour.
pub(super) fn trace(tracer: &mut Tracer<'_>, batch: &mut Batch) {
    batch.answers.clear();
    for ray in &batch.rays {
        let before = work(&tracer.statistics());
        batch.answers.push(tracer.first_hit(ray));
        let work = work(&tracer.statistics()) - before;
        batch.radiance.push(color(work));
    }
}

/// Newton steps, and parameter boxes of the exact solver.
fn work(statistics: &Statistics) -> u64 {
    statistics.newton_iterations + statistics.exact_boxes
}

/// Black for no work, over red (9) and yellow (101) to white (1023 and more), by the
/// logarithm.
fn color(work: u64) -> Rgb {
    let heat = 3.0 * (1.0 + work as f64).log2() / WHITE;
    [0.0, 1.0, 2.0].map(|start| (heat - start).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_get_brighter_with_work() {
        assert_eq!(color(0), [0.0; 3]);
        assert_eq!(color(1023), [1.0; 3]);
        assert_eq!(color(u64::MAX), [1.0; 3]);
        let sum = |work| color(work).iter().sum::<f64>();
        assert!((0..1023).all(|work| sum(work) < sum(work + 1)));
        assert!((color(9)[0] - 1.0).abs() < 0.01 && color(9)[1] < 0.01);
    }
}
