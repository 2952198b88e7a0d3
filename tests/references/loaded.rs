//! Embree, or a good reason to go without.

use std::io::Write;

use nurbray::io::Embree;

/// Loads Embree. `None`, with a loud note, only where `NURBRAY_WITHOUT_EMBREE=1` allows it.
pub(crate) fn embree() -> Option<Embree> {
    if std::env::var_os("NURBRAY_WITHOUT_EMBREE").is_some_and(|value| value == "1") {
        // Written past the test harness, which swallows what passing tests print.
        let note = b"*** SKIPPED: not compared with Embree (NURBRAY_WITHOUT_EMBREE=1) ***\n";
        std::io::stderr().write_all(note).unwrap();
        return None;
    }
    match Embree::load() {
        Ok(embree) => Some(embree),
        Err(error) => panic!("{error}; or go without: NURBRAY_WITHOUT_EMBREE=1"),
    }
}
