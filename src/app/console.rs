//! The two streams: results on stdout, words about the work on stderr.

use std::io::{self, ErrorKind, Write};

use anyhow::{Context, Error};

use super::failure::{Failure, OrFail};

/// Writes results to stdout.
///
/// A reader that has closed the pipe (`nurbray info model.json | head -1`) has what it wants:
/// that is no failure.
///
/// # Errors
/// When stdout cannot take the results for any other reason, such as a full disk.
pub(crate) fn print(results: &str) -> Result<(), Failure> {
    printed(io::stdout().lock().write_all(results.as_bytes()))
}

/// What came of writing to stdout, once all of it is out.
///
/// # Errors
/// As [`print`].
pub(crate) fn printed(written: io::Result<()>) -> Result<(), Failure> {
    match written.and_then(|()| io::stdout().flush()) {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            Err(reason).context("cannot write to standard output").or_failed()
        }
        _ => Ok(()),
    }
}

/// One object of results on one line of stdout.
///
/// # Errors
/// As [`print`].
pub(crate) fn print_json(value: &serde_json::Value) -> Result<(), Failure> {
    print(&format!("{value}\n"))
}

/// The one error of a failed run.
pub(crate) fn error(reason: &Error) {
    say(&format!("error: {}", with_causes(reason)));
}

/// An error with its causes after colons, except those that it ends with itself.
fn with_causes(reason: &Error) -> String {
    reason.chain().fold(String::new(), |told, cause| match cause.to_string() {
        cause if told.is_empty() => cause,
        cause if told.ends_with(&cause) => told,
        cause => format!("{told}: {cause}"),
    })
}

/// Something the user should know, though the work goes on.
pub(crate) fn warning(message: &str) {
    say(&format!("warning: {message}"));
}

/// A line on stderr. If stderr is closed there is nobody to tell, which is no reason to stop.
pub(crate) fn say(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cause_is_told_twice() {
        let cause = || Error::msg("the disk is full");
        let silent = cause().context("cannot write a.exr");
        assert_eq!(with_causes(&silent), "cannot write a.exr: the disk is full");
        let telling = cause().context("cannot write a.exr: the disk is full");
        assert_eq!(with_causes(&telling), "cannot write a.exr: the disk is full");
        // A cause that only occurs in the name of a file has not been reported.
        let named = Error::msg("no").context("cannot write notes.exr");
        assert_eq!(with_causes(&named), "cannot write notes.exr: no");
        let deep = cause().context("cannot write a.exr: the disk is full").context("no picture");
        assert_eq!(with_causes(&deep), "no picture: cannot write a.exr: the disk is full");
    }
}
