//! The program: what the user typed becomes calls of the library, one file a subcommand.
//!
//! Results go to stdout, everything else to stderr. The exit code is 0 when the work is
//! done, 1 when it failed, 2 when the command line or the input is wrong.

mod args;
mod audit;
mod bench;
mod border;
mod cast;
mod chart;
mod compare;
mod console;
mod failure;
mod info;
mod input;
mod output;
mod plot;
mod progress;
mod race;
mod random;
mod render;
mod table;
mod threads;

use std::process::ExitCode;

use args::{Arguments, Command};
use failure::Failure;

/// Runs the command line this process was started with.
pub(crate) fn run() -> ExitCode {
    let arguments = match Arguments::parse_words(std::env::args_os()) {
        Ok(arguments) => arguments,
        Err(message) => {
            // Help and version are answers (stdout, 0); anything else is wrong use (stderr, 2), and
            // if stderr is closed, there is nobody to tell.
            let printed = message.print();
            return match message.use_stderr() {
                true => ExitCode::from(failure::WRONG_USE),
                false => ended(console::printed(printed).map(|()| ExitCode::SUCCESS)),
            };
        }
    };
    ended(dispatch(&arguments.command))
}

/// The exit code of a run, whose error, if it has one, is told.
fn ended(run: Result<ExitCode, Failure>) -> ExitCode {
    match run {
        Ok(code) => code,
        Err(failure) => {
            console::error(failure.reason());
            failure.exit_code()
        }
    }
}

fn dispatch(command: &Command) -> Result<ExitCode, Failure> {
    match command {
        Command::Render(arguments) => render::run(arguments),
        Command::Cast(arguments) => cast::run(arguments),
        Command::Audit(arguments) => audit::run(arguments),
        Command::Bench(arguments) => bench::run(arguments),
        Command::Compare(arguments) => compare::run(arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Plot(arguments) => plot::run(arguments),
    }
}
