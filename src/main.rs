//! The program `nurbray`: parse, run, print one error, say how it went.

mod app;

use std::process::ExitCode;

fn main() -> ExitCode {
    app::run()
}
