//! Paths in messages.

use std::fmt::{self, Write};
use std::io;
use std::path::Path;

/// A path within a sentence: in quotes, with control characters escaped, so that it stands apart
/// from the words around it and the message stays on one line. (A path as the place in front of
/// a message, `scenes/teapot.toml:41:7: …`, has no quotes.)
#[derive(Clone, Copy, Debug)]
pub struct Quoted<'a>(pub &'a Path);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('"')?;
        for c in self.0.to_string_lossy().chars() {
            match c.is_control() {
                true => write!(f, "{}", c.escape_default())?,
                false => f.write_char(c)?,
            }
        }
        f.write_char('"')
    }
}

/// The reason why a file cannot be read, as messages word it.
pub(super) struct WhyUnread<'a>(pub(super) &'a io::Error);

impl fmt::Display for WhyUnread<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.kind() {
            io::ErrorKind::NotFound => f.write_str("there is no such file"),
            io::ErrorKind::IsADirectory => f.write_str("it is a folder"),
            _ => write!(f, "{}", self.0),
        }
    }
}

/// End of a message: the path that may have been meant instead of one that leads nowhere.
pub(super) struct DidYouMean<'a>(pub(super) Option<&'a Path>);

impl fmt::Display for DidYouMean<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |nearest| write!(f, "; did you mean {}?", Quoted(nearest)))
    }
}

/// End of a message: the path `-`, which stands for standard input elsewhere, is a file like any
/// other here.
pub(super) struct NoStandardInput<'a>(pub(super) &'a Path);

impl fmt::Display for NoStandardInput<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.as_os_str() == "-" {
            true => f.write_str("; \"-\" does not stand for standard input: name a file"),
            false => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_stays_on_its_line() {
        let quoted = |path: &str| Quoted(Path::new(path)).to_string();
        assert_eq!(quoted("a b/ü.npy"), "\"a b/ü.npy\"");
        assert_eq!(quoted("a\nb\u{7}"), "\"a\\nb\\u{7}\"");
        assert_eq!(quoted(""), "\"\"");
    }
}
