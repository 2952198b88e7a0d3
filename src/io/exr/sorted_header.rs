//! The attributes of an EXR's header in the order of their names.

use std::io::{self, Seek, SeekFrom, Write};

/// Passes an EXR of one part on to a writer, with the attributes of its header sorted by name, as
/// the OpenEXR library writes them.
///
/// The encoder keeps attributes in a hash map, whose order differs from run to run. The header
/// comes first and keeps its length, so that no place in the file changes.
pub(super) struct SortedHeader<W> {
    inner: W,
    /// What has come of the header so far; nothing once it is passed on.
    header: Option<Vec<u8>>,
}

impl<W> SortedHeader<W> {
    pub(super) fn new(inner: W) -> Self {
        Self { inner, header: Some(Vec::new()) }
    }
}

impl<W: Write> Write for SortedHeader<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(header) = &mut self.header else { return self.inner.write(bytes) };
        header.extend_from_slice(bytes);
        if let Some(sorted) = sorted(header) {
            self.header = None;
            self.inner.write_all(&sorted)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Write + Seek> Seek for SortedHeader<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        // Encoders seek only behind the header; what is not one is passed on as it is.
        if let Some(header) = self.header.take() {
            self.inner.write_all(&header)?;
        }
        self.inner.seek(to)
    }
}

/// Magic number and version, before the attributes.
const START: usize = 8;

/// The beginning of a file with its attributes sorted, if they are all there.
///
/// An attribute is its name and its type, each with a zero behind it, the size of its value as an
/// `i32`, and the value. A zero ends the list.
fn sorted(bytes: &[u8]) -> Option<Vec<u8>> {
    let (start, mut rest) = bytes.split_at_checked(START)?;
    let mut attributes = Vec::new();
    while *rest.first()? != 0 {
        let name = rest.iter().position(|byte| *byte == 0)?;
        let kind = rest[name + 1..].iter().position(|byte| *byte == 0)?;
        let value = name + kind + 2;
        let size = rest.get(value..value + 4)?.try_into().ok().map(i32::from_le_bytes)?;
        let size = usize::try_from(size).ok()?;
        let (attribute, others) = rest.split_at_checked(value + 4 + size)?;
        attributes.push((&rest[..name], attribute));
        rest = others;
    }
    attributes.sort();
    let attributes = attributes.into_iter().map(|(_, attribute)| attribute);
    Some(std::iter::once(start).chain(attributes).chain([rest]).flatten().copied().collect())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn attributes_are_sorted_however_they_come() {
        let [a, ab, b] = [b"a\0int\0\x01\0\0\0\0", b"ab\0i\0\x02\0\0\0z\0", b"b\0text\0\0\0\0\0"];
        let (start, end) = (b"magicver", b"\0pixels");
        let whole = |attributes: [&[u8]; 3]| [&start[..], &attributes.concat(), &end[..]].concat();
        for piece in [1, 3, 100] {
            let mut writer = SortedHeader::new(Cursor::new(Vec::new()));
            for bytes in whole([b, ab, a]).chunks(piece) {
                writer.write_all(bytes).unwrap();
            }
            assert_eq!(writer.stream_position().unwrap(), 48, "pieces of {piece}");
            assert_eq!(writer.inner.into_inner(), whole([a, ab, b]), "pieces of {piece}");
        }
    }
}
