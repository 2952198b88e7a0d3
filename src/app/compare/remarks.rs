//! What a reader should know of a model before the figures on its triangles.

use super::super::race::Model;
use super::super::table::count;

/// A line for each of these that holds: surfaces that approximate what the scene asks for, and
/// surfaces smaller than a tolerance.
pub(super) fn remarks(model: &Model, tolerances: impl Iterator<Item = f64>) -> String {
    let instances = model.world.surfaces();
    let mut lines = String::new();
    let off = instances.iter().filter(|instance| instance.deviation > 0.0);
    let off: Vec<f64> = off.map(|instance| instance.deviation / model.diagonal).collect();
    if !off.is_empty() {
        let most = off.iter().copied().fold(0.0, f64::max);
        lines += &format!(
            "- {} only near what the scene asks for, by up to {most:.1e} of the diagonal (`nurbray info` lists \
             them). Errors are those against the surfaces as they are.\n",
            are(off.len())
        );
    }
    let sizes = instances.iter().map(|instance| instance.surface.extent().size().length());
    let sizes: Vec<f64> = sizes.map(|size| size / model.diagonal).collect();
    for tolerance in tolerances {
        let small = sizes.iter().filter(|&&size| size < tolerance).count();
        if small > 0 {
            lines += &format!(
                "- At {tolerance:e}, {} smaller than the tolerance: triangles may not show anything \
                 of them, and what is seen behind them may count as the same place.\n",
                are(small)
            );
        }
    }
    if lines.is_empty() { lines } else { lines + "\n" }
}

/// `1 surface is`, `2 surfaces are`.
fn are(surfaces: usize) -> String {
    let verb = if surfaces == 1 { "is" } else { "are" };
    format!("{} {verb}", count(surfaces as u64, "surface"))
}
