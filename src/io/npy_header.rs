//! The header of a NumPy file, read with suspicion.

use std::io::{self, Read};
use std::path::Path;

use npyz::NpyHeader;

use super::NpyError;
use crate::math::Counted;

/// How a file begins.
const MAGIC: &[u8] = b"\x93NUMPY";

/// The longest header read, the limit of NumPy itself; the header of a table has about 100 bytes.
const MAX_HEADER: usize = 10_000;

/// The deepest nesting of brackets in a header; the header of a table has 2.
const MAX_DEPTH: usize = 8;

/// The most numbers in a file (8 TB of them): a header that gives more is damaged.
const MAX_COUNT: u64 = 1 << 40;

/// What to do about a file that begins like this, where it is known.
fn instead_of(start: &[u8]) -> &'static str {
    let is_text = |byte: &u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    if start.starts_with(b"PK") {
        " (if it is an .npz archive: numpy.load it, then numpy.save an array of it)"
    } else if start.iter().all(is_text) {
        " (if it is text: numpy.loadtxt it, then numpy.save the array)"
    } else {
        ""
    }
}

/// Reads the header; returns it with its length in bytes.
///
/// The parser in use trusts the header's length, its nesting and the product of its sizes,
/// so these are checked first.
pub(super) fn read_header(
    stream: &mut impl Read,
    path: &Path,
) -> Result<(NpyHeader, usize), NpyError> {
    let wrong = |found: &str| NpyError::Header { path: path.to_owned(), found: found.to_owned() };
    let short = |reason: io::Error| match reason.kind() {
        io::ErrorKind::UnexpectedEof => wrong("it ends within the header"),
        _ => NpyError::Io { path: path.to_owned(), nearest: None, reason },
    };

    // Magic, version, length of the text that follows: 2 bytes in version 1, else 4.
    let mut bytes = Vec::with_capacity(8);
    stream.take(8).read_to_end(&mut bytes).map_err(short)?;
    let magic = &bytes[..bytes.len().min(MAGIC.len())];
    if !MAGIC.starts_with(magic) {
        return Err(wrong(&format!("it does not begin with \\x93NUMPY{}", instead_of(&bytes))));
    }
    if bytes.is_empty() {
        return Err(wrong("the file is empty"));
    }
    if bytes.len() < 8 {
        return Err(short(io::ErrorKind::UnexpectedEof.into()));
    }
    let length_bytes = match bytes[6] {
        1 => 2,
        2 | 3 => 4,
        other => return Err(wrong(&format!("it is of version {other}, and 1 to 3 are known"))),
    };
    bytes.resize(8 + length_bytes, 0);
    stream.read_exact(&mut bytes[8..]).map_err(short)?;
    let length = bytes[8..].iter().rev().fold(0, |sum, &byte| sum << 8 | usize::from(byte));
    if length > MAX_HEADER {
        return Err(wrong(&format!("its header is said to have {}", Counted(length, "byte"))));
    }
    let start = bytes.len();
    bytes.resize(start + length, 0);
    stream.read_exact(&mut bytes[start..]).map_err(short)?;

    check_text(&bytes[start..], path)?;
    match NpyHeader::from_reader(bytes.as_slice()) {
        Ok(header) => Ok((header, bytes.len())),
        Err(error) => {
            let said = error.to_string();
            let unknown = said.contains("type string").then(|| kind(&bytes[start..])).flatten();
            Err(match unknown {
                Some(found) => NpyError::Kind { path: path.to_owned(), found },
                // The messages of a Python parser have several lines.
                None if said.contains('\n') => wrong("its header is no dictionary of Python"),
                None => wrong(&said),
            })
        }
    }
}

/// The type of the numbers that a header gives, in NumPy's notation.
fn kind(header: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(header);
    let (_, value) = text.split_once("descr")?;
    let (_, value) = value.split_once(':')?;
    let value = value.trim_start();
    let quote = value.chars().next().filter(|c| "'\"".contains(*c))?;
    let (kind, _) = value[1..].split_once(quote)?;
    Some(format!("'{}'", kind.escape_default()))
}

/// Refuses headers that would nest or multiply without bounds.
fn check_text(text: &[u8], path: &Path) -> Result<(), NpyError> {
    let wrong = |found: &str| NpyError::Header { path: path.to_owned(), found: found.to_owned() };
    let mut depth = 0_usize;
    let mut quote = None;
    for &byte in text {
        match byte {
            b'\\' => return Err(wrong("its header has backslashes")),
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ if quote == Some(byte) => quote = None,
            _ if quote.is_some() => {} // names of fields may have other characters
            b'\'' | b'"' => quote = Some(byte),
            b'+' | b'-' => return Err(wrong("its header has signs or sums for sizes")),
            b'L' => {
                return Err(wrong(
                    "its sizes are written as by Python 2 (60L): numpy.load it, then numpy.save the array",
                ));
            }
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(wrong("its header nests too many brackets"));
        }
    }

    // Every word that begins with a digit is a size; their product, zeros apart, is at
    // least the number of elements, whichever of them make up the shape.
    let words = text.split(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_');
    let sizes = words.filter(|word| word.first().is_some_and(u8::is_ascii_digit));
    let mut product = 1_u64;
    let mut found = Vec::new();
    for size in sizes.map(String::from_utf8_lossy) {
        let factor = size.parse::<u64>().ok().map(|size| size.max(1));
        let count = factor.and_then(|factor| product.checked_mul(factor));
        found.push(size.into_owned());
        match count.filter(|&count| count <= MAX_COUNT) {
            Some(count) => product = count,
            None => {
                let found = found.join(" × ");
                return Err(NpyError::Absurd { path: path.to_owned(), found });
            }
        }
    }
    Ok(())
}
