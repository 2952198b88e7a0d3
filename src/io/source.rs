//! Text with its file's name: turns byte offsets into lines and columns.

use std::ops::Range;

use crate::scene::Place;

/// The text of a file, prepared to turn offsets into places.
///
/// A JSON model is often a single line of many megabytes with thousands of surfaces, so
/// lines and columns are counted once, with a mark every [`MARK_EVERY`] bytes.
#[derive(Debug)]
pub(super) struct Source<'a> {
    text: &'a str,
    file: Place,
    marks: Vec<Position>,
}

/// A line and a column, counted from 1; the column counts characters.
#[derive(Clone, Copy, Debug)]
struct Position {
    line: usize,
    column: usize,
}

/// Bytes between marks: looking up a place reads at most this many, and the marks take
/// 1/256 of the text's size.
const MARK_EVERY: usize = 4096;

impl<'a> Source<'a> {
    /// The text of the file with this label.
    pub(super) fn new(text: &'a str, label: &str) -> Self {
        let mut marks = Vec::with_capacity(text.len() / MARK_EVERY + 1);
        let mut position = Position { line: 1, column: 1 };
        for (offset, byte) in text.bytes().enumerate() {
            if offset % MARK_EVERY == 0 {
                marks.push(position);
            }
            position.pass(byte);
        }
        Self { text, file: Place::file(label), marks }
    }

    /// The whole text.
    pub(super) fn text(&self) -> &'a str {
        self.text
    }

    /// The file as a whole.
    pub(super) fn file(&self) -> &Place {
        &self.file
    }

    /// The place of the byte at an offset; the end of the text for offsets beyond it.
    pub(super) fn place(&self, offset: usize) -> Place {
        let offset = offset.min(self.text.len());
        let mark = (offset / MARK_EVERY).min(self.marks.len().saturating_sub(1));
        let mut position = self.marks.get(mark).copied().unwrap_or(Position { line: 1, column: 1 });
        for &byte in &self.text.as_bytes()[mark * MARK_EVERY..offset] {
            position.pass(byte);
        }
        self.file.at_line(position.line, position.column)
    }

    /// The text in a range; empty if there is no such range.
    pub(super) fn slice(&self, range: Range<usize>) -> &'a str {
        self.text.get(range).unwrap_or("")
    }

    /// The offset of a part of this text within it.
    pub(super) fn offset_of(&self, part: &str) -> usize {
        (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize)
    }
}

impl Position {
    /// Moves past a byte: a character counts when its first byte is passed.
    fn pass(&mut self, byte: u8) {
        let continues_character = byte & 0b1100_0000 == 0b1000_0000;
        if byte == b'\n' {
            *self = Self { line: self.line + 1, column: 1 };
        } else if !continues_character {
            self.column += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_characters_from_one() {
        let text = "a\nüü = 3\r\nend";
        let source = Source::new(text, "x.toml");
        let show = |offset| source.place(offset).to_string();
        assert_eq!(show(0), "x.toml:1:1");
        assert_eq!(show(2), "x.toml:2:1");
        assert_eq!(show(text.find('3').unwrap()), "x.toml:2:6");
        assert_eq!(show(text.find("end").unwrap()), "x.toml:3:1");
        assert_eq!(show(text.len()), "x.toml:3:4");
        assert_eq!(show(999), "x.toml:3:4");
        assert_eq!(Source::new("", "e").place(0).to_string(), "e:1:1");
        assert_eq!(source.offset_of(&text[4..]), 4);
    }

    #[test]
    fn marks_agree_with_counting() {
        let text: String = (0..3000).map(|i| if i % 97 == 0 { "ß\n" } else { "xyz, " }).collect();
        let source = Source::new(&text, "long");
        for (offset, _) in text.char_indices().step_by(11) {
            let before = &text[..offset];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
            assert_eq!(source.place(offset).position(), Some((line, column)), "offset {offset}");
        }
    }
}
