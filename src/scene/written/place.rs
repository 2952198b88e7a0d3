//! Where something was written.

use std::fmt;
use std::sync::Arc;

/// Where something was written: a file, and the line and column where they are known.
///
/// Shown as `scenes/teapot.toml:41:7`, or as nothing at all for things made in code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    file: Option<Arc<str>>,
    /// Line and column, counted from 1; the column counts characters.
    position: Option<(usize, usize)>,
}

impl Place {
    /// Somewhere in a file.
    pub fn file(label: &str) -> Self {
        Self { file: Some(label.into()), position: None }
    }

    /// The place in the same file at a line and column, counted from 1.
    #[must_use]
    pub fn at_line(&self, line: usize, column: usize) -> Self {
        Self { file: self.file.clone(), position: Some((line, column)) }
    }

    /// The label of the file, if the place is in one.
    pub fn label(&self) -> Option<&str> {
        self.file.as_deref()
    }

    /// Line and column, counted from 1, where they are known.
    pub fn position(&self) -> Option<(usize, usize)> {
        self.position
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(file) = &self.file else { return Ok(()) };
        f.write_str(file)?;
        match self.position {
            Some((line, column)) => write!(f, ":{line}:{column}"),
            None => Ok(()),
        }
    }
}

/// A message with its place in front, as `path:line:column: message`.
pub(crate) fn with_place(
    f: &mut fmt::Formatter<'_>,
    place: &Place,
    message: &dyn fmt::Display,
) -> fmt::Result {
    if place.file.is_some() {
        write!(f, "{place}: ")?;
    }
    write!(f, "{message}")
}

/// A value and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written<T> {
    /// The value.
    pub value: T,
    /// Where it was written.
    pub place: Place,
}

impl<T> Written<T> {
    /// A value written somewhere.
    pub fn new(value: T, place: Place) -> Self {
        Self { value, place }
    }
}

impl<T> From<T> for Written<T> {
    /// A value made in code.
    fn from(value: T) -> Self {
        Self { value, place: Place::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_as_much_as_is_known() {
        let file = Place::file("x.toml");
        assert_eq!(file.to_string(), "x.toml");
        assert_eq!(file.at_line(3, 14).to_string(), "x.toml:3:14");
        assert_eq!(Place::default().to_string(), "");
        assert_eq!(Place::default().at_line(1, 1).to_string(), "", "no file, no line");
    }
}
