//! NumPy arrays of numbers: rays in, hits out.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use glam::DVec3;
use npyz::{Deserialize, NpyFile, NpyHeader, Order, WriterBuilder};

use super::atomic::BUFFER;
use super::nearby::nearest_file;
use super::npy_error::NpyError;
use super::npy_header::read_header;
use super::{WriteError, write_atomically};
use crate::math::Ray;

/// A table of numbers, row after row.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: usize,
    values: Vec<f64>,
}

impl Table {
    /// How many numbers a row has; at least 1.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many rows there are.
    pub fn row_count(&self) -> usize {
        self.values.len() / self.columns
    }

    /// The rows, from the first.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.columns)
    }
}

/// Reads rays: float64 or float32 of shape `(n, 6)`, origin and direction, or `(n, 8)` with
/// `t_min` and `t_max` after them.
///
/// # Errors
/// When the file is not such a table, or a row is not a ray.
pub fn read_rays(path: &Path) -> Result<Vec<Ray>, NpyError> {
    let table = read_table(path, &[6, 8])?;
    let ray = |row: &[f64]| {
        let (origin, direction) = (DVec3::from_slice(row), DVec3::from_slice(&row[3..]));
        match row.get(6..8) {
            Some(range) => Ray::with_range(origin, direction, range[0], range[1]),
            None => Ray::new(origin, direction),
        }
    };
    let mut rays = room(table.row_count(), path)?;
    for (row, numbers) in table.rows().enumerate() {
        let read = ray(numbers);
        rays.push(read.map_err(|reason| NpyError::Ray { path: path.to_owned(), row, reason })?);
    }
    Ok(rays)
}

/// An empty vector with room for so many items.
fn room<T>(count: usize, path: &Path) -> Result<Vec<T>, NpyError> {
    let mut items = Vec::new();
    let no_memory = |_| io::Error::from(io::ErrorKind::OutOfMemory);
    let reserved = items.try_reserve_exact(count).map_err(no_memory);
    reserved.map_err(|reason| NpyError::Io { path: path.to_owned(), nearest: None, reason })?;
    Ok(items)
}

/// Reads a table of float64 or float32 numbers, in either byte order and either order of
/// rows and columns, with one of the `columns` counts given.
///
/// Nothing is allocated on the word of the header alone: the size it gives must fit the file.
/// Bytes after the array are ignored, as in NumPy.
///
/// # Errors
/// When the file cannot be read, is damaged, or holds something else.
pub fn read_table(path: &Path, columns: &[usize]) -> Result<Table, NpyError> {
    let io_error = |reason| NpyError::Io { path: path.to_owned(), nearest: None, reason };
    let file = File::open(path).map_err(|reason| {
        let missing = reason.kind() == io::ErrorKind::NotFound;
        let nearest = if missing { nearest_file(path, &["npy"]) } else { None };
        NpyError::Io { path: path.to_owned(), nearest, reason }
    })?;
    let metadata = file.metadata().map_err(io_error)?;
    if metadata.is_dir() {
        return Err(io_error(io::ErrorKind::IsADirectory.into()));
    }
    // Pipes have no length; they are read until they end.
    let length = metadata.is_file().then_some(metadata.len());
    read_from(BufReader::with_capacity(BUFFER, file), length, path, columns)
}

/// As [`read_table`], from the bytes of a file; errors call it `path`.
///
/// # Errors
/// As [`read_table`].
pub fn table_from_bytes(bytes: &[u8], path: &Path, columns: &[usize]) -> Result<Table, NpyError> {
    read_from(bytes, Some(bytes.len() as u64), path, columns)
}

/// Reads a table from a stream whose whole length may be known.
fn read_from(
    mut stream: impl Read,
    length: Option<u64>,
    path: &Path,
    columns: &[usize],
) -> Result<Table, NpyError> {
    let (header, header_bytes) = read_header(&mut stream, path)?;
    let (rows, width) = shape(&header, path, columns)?;
    let count = header.len();
    let kind = header.dtype();
    let wrong_kind = || NpyError::Kind { path: path.to_owned(), found: kind.descr() };
    // The kind is checked before its size is used: other kinds may have any size.
    let item = match (f64::reader(&kind), f32::reader(&kind)) {
        (Ok(_), _) => 8,
        (_, Ok(_)) => 4,
        _ => return Err(wrong_kind()),
    };
    let needed = count * item; // at most 2^40 · 8
    if let Some(found) = length.map(|length| length.saturating_sub(header_bytes as u64))
        && found < needed
    {
        return Err(NpyError::Truncated { path: path.to_owned(), found, needed });
    }

    // If the length is known, the numbers are there; else memory grows as they are read.
    let mut values = room(if length.is_some() { count as usize } else { 0 }, path)?;
    let order = header.order();
    let file = NpyFile::with_header(header, stream);
    let read = if item == 8 {
        fill(&mut values, file.data::<f64>().map_err(|_| wrong_kind())?)
    } else {
        let data = file.data::<f32>().map_err(|_| wrong_kind())?;
        fill(&mut values, data.map(|x| x.map(f64::from)))
    };
    read.map_err(|reason| match reason.kind() {
        io::ErrorKind::UnexpectedEof => {
            let found = values.len() as u64 * item;
            NpyError::Truncated { path: path.to_owned(), found, needed }
        }
        _ => NpyError::Io { path: path.to_owned(), nearest: None, reason },
    })?;
    if order == Order::Fortran {
        values = transposed(&values, [rows, width], room(values.len(), path)?);
    }
    Ok(Table { columns: width, values })
}

fn fill(values: &mut Vec<f64>, data: impl Iterator<Item = io::Result<f64>>) -> io::Result<()> {
    for value in data {
        values.push(value?);
    }
    Ok(())
}

/// Reorders values from column after column to row after row, which are added to `values`.
fn transposed(columns: &[f64], [rows, width]: [usize; 2], mut values: Vec<f64>) -> Vec<f64> {
    for row in 0..rows {
        values.extend((0..width).map(|column| columns[column * rows + row]));
    }
    values
}

/// The numbers of rows and columns, if the array has two dimensions and one of the accepted widths.
fn shape(header: &NpyHeader, path: &Path, columns: &[usize]) -> Result<(usize, usize), NpyError> {
    if let &[rows, width] = header.shape()
        && let Some(&width) =
            columns.iter().find(|&&columns| columns > 0 && columns as u64 == width)
    {
        return Ok((rows as usize, width));
    }
    let sizes: Vec<_> = header.shape().iter().map(u64::to_string).collect();
    let found = match sizes.as_slice() {
        [one] => format!("({one},)"),
        sizes => format!("({})", sizes.join(", ")),
    };
    let needed: Vec<_> = columns.iter().map(|columns| format!("(n, {columns})")).collect();
    Err(NpyError::Shape { path: path.to_owned(), found, needed: needed.join(" or ") })
}

/// Writes rows of `N` numbers as a float64 array of shape `(rows.len(), N)`.
///
/// # Errors
/// When the file cannot be written; an older one then stays as it was.
pub fn write_rows<const N: usize>(path: &Path, rows: &[[f64; N]]) -> Result<(), WriteError> {
    write_parts(path, &[rows])
}

/// Writes the rows of several parts, one part after the other, as [`write_rows`] does.
///
/// # Errors
/// As [`write_rows`].
pub fn write_parts<const N: usize>(
    path: &Path,
    parts: &[impl AsRef<[[f64; N]]>],
) -> Result<(), WriteError> {
    let parts = || parts.iter().map(AsRef::as_ref);
    let count: usize = parts().map(<[_]>::len).sum();
    write_atomically(path, |file| {
        let mut array = npyz::WriteOptions::new()
            .default_dtype()
            .shape(&[count as u64, N as u64])
            .writer(file)
            .begin_nd()?;
        array.extend(parts().flatten().flatten().copied())?;
        array.finish()
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// A file of version 1.0 with this text for a header.
    fn file(text: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn header(kind: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    }

    fn read(bytes: &[u8], columns: &[usize]) -> Result<Table, NpyError> {
        table_from_bytes(bytes, Path::new("rays.npy"), columns)
    }

    fn message(bytes: &[u8]) -> String {
        read(bytes, &[6, 8]).unwrap_err().to_string()
    }

    /// The numbers 0.5, 1.5 … as bytes.
    fn numbers<const N: usize>(count: usize, bytes_of: impl Fn(f64) -> [u8; N]) -> Vec<u8> {
        (0..count).flat_map(|i| bytes_of(i as f64 + 0.5)).collect()
    }

    #[test]
    fn reads_both_precisions_in_both_byte_orders() {
        let rows: Vec<_> = (0..12).map(|i| f64::from(i) + 0.5).collect();
        let shape = header("KIND", "False", "(2, 6)");
        for (kind, data) in [
            ("<f8", numbers(12, f64::to_le_bytes)),
            (">f8", numbers(12, f64::to_be_bytes)),
            ("<f4", numbers(12, |x| (x as f32).to_le_bytes())),
            (">f4", numbers(12, |x| (x as f32).to_be_bytes())),
        ] {
            let table = read(&file(&shape.replace("KIND", kind), &data), &[6]).unwrap();
            assert_eq!((table.columns(), table.row_count()), (6, 2));
            assert_eq!(table.values, rows, "{kind}");
            assert_eq!(table.rows().nth(1).unwrap(), &rows[6..]);
        }
    }

    #[test]
    fn reads_columns_first() {
        let bytes = file(&header("<f8", "True", "(2, 6)"), &numbers(12, f64::to_le_bytes));
        let table = read(&bytes, &[6]).unwrap();
        assert_eq!(table.rows().next().unwrap(), [0.5, 2.5, 4.5, 6.5, 8.5, 10.5]);
        assert_eq!(table.rows().nth(1).unwrap(), [1.5, 3.5, 5.5, 7.5, 9.5, 11.5]);
    }

    #[test]
    fn reads_versions_2_and_3_empty_tables_and_pipes() {
        let text = header("<f8", "False", "(1, 6)");
        for version in [2, 3] {
            let mut bytes = b"\x93NUMPY".to_vec();
            bytes.extend([version, 0]);
            bytes.extend((text.len() as u32).to_le_bytes());
            bytes.extend(text.as_bytes());
            bytes.extend(numbers(6, f64::to_le_bytes));
            assert_eq!(read(&bytes, &[6]).unwrap().row_count(), 1);
            let piped = read_from(bytes.as_slice(), None, Path::new("-"), &[6]).unwrap();
            assert_eq!(piped, read(&bytes, &[6]).unwrap());
        }
        let empty = read(&file(&header("<f8", "False", "(0, 6)"), &[]), &[6]).unwrap();
        assert_eq!(empty.row_count(), 0);
    }

    /// Names of fields may have signs in them; sizes may not. Nothing hides brackets, which the parser
    /// would take forever for.
    #[test]
    fn what_headers_are_made_of() {
        let fields = "{'descr': [('d-x (', '<f8', (6,))], 'fortran_order': False, 'shape': (2,)}\n";
        let found = message(&file(fields, &numbers(12, f64::to_le_bytes)));
        assert!(found.starts_with("rays.npy: found "), "{found}");
        let data = numbers(12, f64::to_le_bytes);
        for (hidden, expected) in
            [("'\\''", "its header has backslashes"), ("'a", "its header nests too many brackets")]
        {
            let (open, close) = ("{".repeat(26), "}".repeat(26));
            let text = format!("{{'descr': {hidden}, 'x': {open}1{close}, 'shape': (2, 6)}}\n");
            let found = message(&file(&text, &data));
            assert_eq!(found, format!("rays.npy: not a NumPy .npy file: {expected}"));
        }
        for (shape, expected) in [
            (
                "(2L, 6L)",
                "its sizes are written as by Python 2 (60L): numpy.load it, then numpy.save the array",
            ),
            ("(-1, 6)", "its header has signs or sums for sizes"),
        ] {
            let found = message(&file(&header("<f8", "False", shape), &data));
            assert_eq!(found, format!("rays.npy: not a NumPy .npy file: {expected}"));
        }
    }

    #[test]
    fn says_what_is_wrong_with_an_array() {
        let data = numbers(12, f64::to_le_bytes);
        let with = |kind, shape| file(&header(kind, "False", shape), &data);
        // Kinds whose size, or whose shape in the header, is absurd.
        for (kind, shape) in [("|V9999999999", "(183251937962, 6)"), ("<f2", "(100000000, 6)")] {
            let found = format!("rays.npy: found numbers of type '{kind}', needed ");
            assert!(message(&with(kind, shape)).starts_with(&found), "{kind}");
        }
        assert_eq!(
            message(&with("<i8", "(2, 6)")),
            "rays.npy: found numbers of type '<i8', needed float64 or float32 (array.astype('f8'))"
        );
        for unknown in ["|O", "=f8", "f8", "<M8[ns]"] {
            assert_eq!(
                message(&with(unknown, "(2, 6)")),
                format!(
                    "rays.npy: found numbers of type '{unknown}', needed float64 or float32 \
                     (array.astype('f8'))"
                )
            );
        }
        for garbage in ["garbage", "", "{'descr'", "{'shape': (2, 6)}"] {
            let message = message(&file(garbage, &data));
            assert!(message.starts_with("rays.npy: not a NumPy .npy file: "), "{message}");
            assert_eq!(message.lines().count(), 1, "{message}");
        }
        assert_eq!(
            message(&with("<f8", "(12,)")),
            "rays.npy: found an array of shape (12,), needed (n, 6) or (n, 8)"
        );
        assert_eq!(
            message(&with("<f8", "(4, 3)")),
            "rays.npy: found an array of shape (4, 3), needed (n, 6) or (n, 8)"
        );
        assert_eq!(
            message(&with("<f8", "(3, 6)")),
            "rays.npy: found 96 bytes of data, needed 144: the file is cut short"
        );
        assert_eq!(
            message(b"PK\x03\x04 something else"),
            "rays.npy: not a NumPy .npy file: it does not begin with \\x93NUMPY (if it is an .npz \
             archive: numpy.load it, then numpy.save an array of it)"
        );
        assert!(message(b"\x00 something else").ends_with("it does not begin with \\x93NUMPY"));
        // However short it is.
        for text in ["h", "hello", "hello, world"] {
            assert!(
                message(text.as_bytes()).ends_with(
                    "\\x93NUMPY (if it is text: numpy.loadtxt it, then numpy.save the array)"
                ),
                "{text}"
            );
        }
        assert!(message(&[]).ends_with("the file is empty"));
        for cut in ["\u{93}NUM", "\u{93}NUMPY\u{1}"] {
            let bytes: Vec<u8> = cut.chars().map(|c| c as u8).collect();
            assert!(message(&bytes).ends_with("it ends within the header"), "{cut}");
        }
        // Rows of no numbers are refused, even where they are asked for.
        let empty = file(&header("<f8", "False", "(3, 0)"), &[]);
        assert!(read(&empty, &[0]).is_err());
        let error = read_table(Path::new("/no/such.npy"), &[6]).unwrap_err().to_string();
        assert_eq!(error, "cannot read \"/no/such.npy\": there is no such file");
        assert!(matches!(read_table(Path::new("/"), &[6]), Err(NpyError::Io { .. })));
    }

    #[test]
    fn refuses_absurd_headers_before_allocating() {
        let refused = |shape: &str| message(&file(&header("<f8", "False", shape), &[]));
        assert_eq!(
            refused("(18446744073709551615, 6)"),
            "rays.npy: the header tells of an array of 18446744073709551615 numbers: it is damaged"
        );
        // Products that overflow, with or without a zero, in any notation.
        for shape in [
            "(4294967296, 4294967296)",
            "(0, 99999999999, 99999999999)",
            "(99999999999999999999999999, 6)",
            "(0xffffffffffff, 6)",
            "(1_000_000_000_000_000, 6)",
            "(1+1, 6)",
            "(--1, 6)",
            "(-5, 6)",
        ] {
            assert!(refused(shape).contains("header"), "{shape}");
        }
        assert!(refused(&"(".repeat(5000)).ends_with("nests too many brackets"));
        // A trillion numbers are possible, but they are not in the file.
        assert!(refused("(10000000000, 6)").ends_with("the file is cut short"));
        let mut bytes = b"\x93NUMPY\x02\x00".to_vec();
        bytes.extend(u32::MAX.to_le_bytes());
        assert!(message(&bytes).ends_with("its header is said to have 4294967295 bytes"));
        bytes[6] = 9;
        assert!(message(&bytes).ends_with("it is of version 9, and 1 to 3 are known"));
    }

    #[test]
    fn every_cut_and_every_damaged_byte_is_an_error_or_a_table() {
        let whole = file(&header("<f8", "False", "(2, 6)"), &numbers(12, f64::to_le_bytes));
        for length in 0..whole.len() {
            assert!(read(&whole[..length], &[6]).is_err(), "cut at {length}");
            let pipe = read_from(&whole[..length], None, Path::new("-"), &[6]);
            assert!(pipe.is_err(), "pipe cut at {length}");
        }
        for place in 0..whole.len() {
            for flip in [1, 4, 16, 128, 255] {
                let mut damaged = whole.clone();
                damaged[place] ^= flip;
                let _ = read(&damaged, &[6, 8]); // no panic, no abort
            }
        }
    }

    #[test]
    fn rows_come_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hits.npy");
        let rows: Vec<[f64; 11]> =
            (0..5).map(|i| std::array::from_fn(|j| f64::from(i).sin() / (j as f64))).collect();
        write_rows(&path, &rows).unwrap();
        let whole = fs::read(&path).unwrap();
        let table = read_table(&path, &[11]).unwrap();
        for (read, row) in table.rows().zip(&rows) {
            let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(read), bits(row));
        }
        write_parts(&path, &[&rows[..2], &[], &rows[2..]]).unwrap();
        assert_eq!(fs::read(&path).unwrap(), whole);
        write_rows::<12>(&path, &[]).unwrap();
        assert_eq!(read_table(&path, &[12]).unwrap().row_count(), 0);
        let bytes = fs::read(&path).unwrap();
        assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
    }

    #[test]
    fn rays_are_checked_row_by_row() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.npy");
        let good = [0.0, 1.0, 2.0, 0.0, 0.0, 2.0, -1.0, f64::INFINITY];
        write_rows(&path, &[good]).unwrap();
        let rays = read_rays(&path).unwrap();
        assert_eq!(rays[0].direction(), DVec3::new(0.0, 0.0, 2.0));
        assert_eq!((rays[0].t_min(), rays[0].t_max()), (-1.0, f64::INFINITY));
        write_rows(&path, &[[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0; 6]]).unwrap();
        assert_eq!(
            read_rays(&path).unwrap_err().to_string(),
            format!(
                "{}: row 1, counted from 0: the direction is zero: \
                 a ray needs one that points somewhere",
                path.display()
            )
        );
        write_rows(&path, &[[f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0]]).unwrap();
        assert!(matches!(read_rays(&path), Err(NpyError::Ray { row: 0, .. })));
    }
}
