//! The program `nurbray`: parse, run, print one error, return the exit code.

mod app;

use std::process::ExitCode;

fn main() -> ExitCode {
    app::run()
}
