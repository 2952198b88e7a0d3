//! Speed over tolerance: our speed does not depend on the tolerance and is a flat line.

use std::path::Path;

use super::super::chart::Panel;
use super::super::race::Measurement;
use super::super::table::count;

/// The panel of a measurement; the rival is named with its version.
pub(super) fn speed(model: &str, threads: u16, (rival, measured): (&str, &Measurement)) -> Panel {
    let name = Path::new(model).file_name().map_or(model.into(), |name| name.to_string_lossy());
    let ours = measured.kernels.iter();
    let theirs = measured.rivals.iter();
    Panel {
        title: format!("{name}, {}, {}", measured.set, count(threads.into(), "thread")),
        quantity: "Mrays/s",
        levels: ours
            .map(|ours| (format!("nurbray {}", ours.kernel), ours.speed.mrays_per_s))
            .collect(),
        curves: vec![(
            rival.to_owned(),
            theirs.map(|theirs| (theirs.tolerance, theirs.speed.mrays_per_s)).collect(),
        )],
    }
}
