//! How a run can end badly, and the exit code that says so.

use std::process::ExitCode;

use anyhow::Error;

/// Exit code 2: the command line or the input is wrong; nothing was written.
pub(crate) const WRONG_USE: u8 = 2;

/// Exit code 1: the input was fine, the work was not.
const FAILED: u8 = 1;

/// Why a subcommand did not do its work.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong use or bad input: the user has something to change.
    Input(Error),
    /// The work itself failed: a full disk, no memory for threads.
    Work(Error),
}

impl Failure {
    /// Wrong use, in the program's own words.
    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self::Input(Error::msg(message.into()))
    }

    /// The work failed, in the program's own words.
    pub(crate) fn work(message: impl Into<String>) -> Self {
        Self::Work(Error::msg(message.into()))
    }

    /// What to tell the user.
    pub(crate) fn reason(&self) -> &Error {
        match self {
            Self::Input(reason) | Self::Work(reason) => reason,
        }
    }

    /// What to tell the shell.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Input(_) => WRONG_USE,
            Self::Work(_) => FAILED,
        })
    }
}

/// Says whose fault an error is. There is no `From`: each `?` has to decide.
pub(crate) trait OrFail<T> {
    /// The user has something to change (exit code 2).
    fn or_bad_input(self) -> Result<T, Failure>;
    /// The work failed (exit code 1).
    fn or_failed(self) -> Result<T, Failure>;
}

impl<T, E: Into<Error>> OrFail<T> for Result<T, E> {
    fn or_bad_input(self) -> Result<T, Failure> {
        self.map_err(|reason| Failure::Input(reason.into()))
    }

    fn or_failed(self) -> Result<T, Failure> {
        self.map_err(|reason| Failure::Work(reason.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_side_decides_the_code() {
        let error = || std::io::Error::other("no");
        let input: Result<(), Failure> = Err::<(), _>(error()).or_bad_input();
        let work: Result<(), Failure> = Err::<(), _>(error()).or_failed();
        assert_eq!(input.unwrap_err().exit_code(), ExitCode::from(2));
        assert_eq!(work.unwrap_err().exit_code(), ExitCode::from(1));
        assert_eq!(Failure::input("use -o").reason().to_string(), "use -o");
    }
}
