//! The threads a run works on.

use anyhow::Context;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::failure::{Failure, OrFail};
use super::table;

/// A pool of the number of threads asked for, or of one for each processor.
///
/// # Errors
/// When the system refuses to start them.
pub(crate) fn pool(threads: Option<u16>) -> Result<ThreadPool, Failure> {
    let count = threads.map_or(0, usize::from); // 0 lets rayon count the processors
    ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .with_context(|| match threads {
            Some(count) => format!("cannot start {}", table::count(count.into(), "thread")),
            None => "cannot start the threads".into(),
        })
        .or_failed()
}
