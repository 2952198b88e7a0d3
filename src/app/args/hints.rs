//! Hints for slips on the command line that clap has no good advice for.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::Command;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

/// Extensions of what the program reads.
const INPUTS: [&str; 3] = ["toml", "json", "obj"];

/// Extensions of what it writes.
const OUTPUTS: [&str; 4] = ["exr", "png", "svg", "npy"];

/// Options of other programs, and those that stand for them here.
const NAMES: [(&str, &str); 2] = [("width", "size"), ("height", "size")];

/// Adds a hint to the error about a command line, and drops advice that cannot be meant.
pub(super) fn with_hint(mut error: Error, command: &Command, words: &[OsString]) -> Error {
    let found = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.clone()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let Some(word) = found(ContextKind::InvalidSubcommand) else { return error };
            if has_extension(&word, &INPUTS) {
                error.remove(ContextKind::SuggestedSubcommand);
                suggest(&mut error, format!("write `nurbray render {word} -o picture.png`"));
            }
        }
        ErrorKind::UnknownArgument => {
            let Some(word) = found(ContextKind::InvalidArg) else { return error };
            let name = words.get(1).and_then(|name| name.to_str());
            let subcommand = name.and_then(|name| command.find_subcommand(name));
            if let Some(option) = word.strip_prefix("--") {
                // No file is called so: clap's advice is how to give such a name.
                error.remove(ContextKind::Suggested);
                if let Some(meant) = subcommand.and_then(|command| meant(option, command)) {
                    let meant = ContextValue::String(format!("--{meant}"));
                    error.insert(ContextKind::SuggestedArg, meant);
                }
            } else if has_extension(&word, &OUTPUTS)
                && subcommand.is_some_and(|command| has_option(command, "output"))
            {
                suggest(&mut error, format!("to write this file, write `-o {word}`"));
            }
        }
        _ => {}
    }
    error
}

fn suggest(error: &mut Error, hint: String) {
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![hint.into()]));
}

fn has_extension(word: &str, known: &[&str]) -> bool {
    let extension = Path::new(word).extension().map(OsStr::to_ascii_lowercase);
    extension.is_some_and(|extension| known.iter().any(|known| extension == *known))
}

fn has_option(command: &Command, name: &str) -> bool {
    command.get_arguments().any(|argument| argument.get_long() == Some(name))
}

/// The option of a subcommand that another one stands for: in other letters, or elsewhere.
fn meant(option: &str, command: &Command) -> Option<String> {
    let lower = option.to_lowercase();
    let name = NAMES.iter().find(|(theirs, _)| *theirs == lower).map_or(&*lower, |(_, ours)| ours);
    has_option(command, name).then(|| name.to_owned())
}
