//! Files that are written whole or not at all.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

use super::Quoted;

/// Why a file cannot be written. An older file is left as it was.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The path does not end in a file's name.
    #[error("cannot write {}: it does not name a file", Quoted(.0))]
    NoName(PathBuf),
    /// There is a folder of that name.
    #[error("cannot write {}: it is a folder", Quoted(.0))]
    Folder(PathBuf),
    /// The folder to write into does not exist.
    #[error("cannot write {}: there is no folder {}", Quoted(path), Quoted(folder))]
    NoFolder {
        /// The file to be written.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// The folder takes no new files, though the file itself may be writable: what is written is a
    /// new file, which then takes the old one's place.
    #[error(
        "cannot write {}: no file can be made in the folder {}: {reason}",
        Quoted(path),
        Quoted(folder)
    )]
    InFolder {
        /// The file to be written.
        path: PathBuf,
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        #[source]
        reason: io::Error,
    },
    /// The system refuses, or the contents cannot be encoded.
    #[error("cannot write {}: {reason}", Quoted(path))]
    Io {
        /// The file to be written.
        path: PathBuf,
        /// What the system says.
        #[source]
        reason: io::Error,
    },
}

/// Where the bytes go.
enum Target {
    /// A file in a folder, existing or not: replaced by renaming.
    File { path: PathBuf, folder: PathBuf, old: Option<Permissions> },
    /// A device or a pipe (`/dev/null`): written into, for it must not be replaced.
    Stream,
}

/// Checks that a file can be written, before the work that fills it: the folder exists and takes
/// new files, and a file of that name may be replaced. A device or a pipe is not tried. Leaves no
/// trace.
///
/// # Errors
/// When [`write_atomically`] would fail for these reasons.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    match target(path)? {
        Target::File { folder, .. } => temporary(path, folder).map(drop),
        Target::Stream => Ok(()),
    }
}

/// Writes a file whole or not at all.
///
/// The bytes go to a temporary file in the same folder, which takes the file's place when
/// all are safely there. When anything fails, it is removed and an older file stays as it
/// was. (A run killed in between leaves the temporary file behind, named `.nurbray-….tmp`.)
/// A new file has the permissions the system gives to new files, a replaced one keeps
/// its own; links are followed.
///
/// # Errors
/// When the system refuses, or `write` fails.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    stage(path, write)?.put_in_place()
}

/// A file that is written, but not in its place yet. Dropped, it leaves no trace.
///
/// Files that belong together are all staged before the first is put in its place, so that none
/// is replaced if the contents of another cannot be written.
#[derive(Debug)]
#[must_use = "it is not there yet"]
pub struct StagedFile {
    /// As it was asked for.
    path: PathBuf,
    staged: Staged,
}

#[derive(Debug)]
enum Staged {
    /// A temporary file in the same folder, and the file it is to replace.
    File { temporary: NamedTempFile, file: PathBuf },
    /// A nameless file, to be copied into a device or a pipe. Encoders seek, which those may not
    /// support.
    Stream(File),
}

/// Writes a file as [`write_atomically`] does, but does not put it in its place yet.
///
/// # Errors
/// When the system refuses, or `write` fails.
pub fn stage(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<StagedFile, WriteError> {
    let staged = match target(path)? {
        Target::File { path: file, folder, old } => {
            let temporary = temporary(path, folder)?;
            filled(temporary, old, write).map(|temporary| Staged::File { temporary, file })
        }
        Target::Stream => tempfile::tempfile().and_then(|mut file| {
            fill(&mut file, write)?;
            file.rewind()?;
            Ok(Staged::Stream(file))
        }),
    };
    let failed = |reason| WriteError::Io { path: path.to_owned(), reason };
    Ok(StagedFile { path: path.to_owned(), staged: staged.map_err(failed)? })
}

impl StagedFile {
    /// Puts the file in its place.
    ///
    /// # Errors
    /// When the system refuses; an older file stays as it was.
    pub fn put_in_place(self) -> Result<(), WriteError> {
        let Self { path, staged } = self;
        let put = match staged {
            Staged::File { temporary, file } => {
                temporary.persist(file).map(drop).map_err(|error| error.error)
            }
            Staged::Stream(file) => pour(file, &path),
        };
        put.map_err(|reason| WriteError::Io { path, reason })
    }
}

/// Puts files that belong together in their places. Devices and pipes come first: they may be
/// full, and then no file is replaced.
///
/// # Errors
/// When the system refuses; the files before the refused one are in their places then.
pub fn put_all_in_place(files: Vec<StagedFile>) -> Result<(), WriteError> {
    let is_stream = |file: &StagedFile| matches!(file.staged, Staged::Stream(_));
    let (streams, files): (Vec<_>, Vec<_>) = files.into_iter().partition(is_stream);
    streams.into_iter().chain(files).try_for_each(StagedFile::put_in_place)
}

/// Finds out what a path names.
fn target(path: &Path) -> Result<Target, WriteError> {
    let failed = |reason| WriteError::Io { path: path.to_owned(), reason };
    let old = match fs::metadata(path) {
        Ok(metadata) => Some(metadata),
        Err(reason) if reason.kind() == io::ErrorKind::NotFound => None,
        Err(reason) => return Err(failed(reason)),
    };
    match &old {
        Some(old) if old.is_dir() => return Err(WriteError::Folder(path.to_owned())),
        Some(old) if !old.is_file() => return Ok(Target::Stream),
        Some(_) => {
            // A file that must not be written to must not be replaced either.
            OpenOptions::new().write(true).open(path).map_err(failed)?;
        }
        None if !names_file(path) => return Err(WriteError::NoName(path.to_owned())),
        None => {}
    }

    // A link stays; the file it points to is replaced, or made if it does not exist.
    let file = match &old {
        Some(_) => path.canonicalize().map_err(failed)?,
        None => end_of_links(path),
    };
    let folder = match file.parent() {
        Some(parent) if parent.as_os_str() != OsStr::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { path: path.to_owned(), folder });
    }
    let old = old.map(|old| old.permissions());
    Ok(Target::File { path: file, folder, old })
}

/// The most symbolic links that are followed one after the other: as many as Linux follows.
const MOST_LINKS: usize = 40;

/// Where a chain of symbolic links leads, which may be to a file that does not exist; other paths
/// as they are.
pub fn end_of_links(path: &Path) -> PathBuf {
    let mut end = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&end) else { break };
        end.pop();
        end.push(next); // replaces all if it is absolute
    }
    end
}

/// Whether a path ends in a file's name: not in `..`, nor in a slash, as a folder's may.
fn names_file(path: &Path) -> bool {
    let ends_open = path.to_string_lossy().ends_with(std::path::is_separator);
    path.file_name().is_some() && !ends_open
}

/// An empty file that disappears unless it is kept, with the permissions of a new file. It is to
/// take the place of `path`.
///
/// It is opened here because `tempfile` would add the file's name, which means nothing to anyone,
/// to the message of the system.
fn temporary(path: &Path, folder: PathBuf) -> Result<NamedTempFile, WriteError> {
    let open = |path: &Path| OpenOptions::new().read(true).write(true).create_new(true).open(path);
    let made = tempfile::Builder::new().prefix(".nurbray-").suffix(".tmp").make_in(&folder, open);
    made.map_err(|reason| WriteError::InFolder { path: path.to_owned(), folder, reason })
}

/// A temporary file with all bytes in it, ready to take the place of one of these permissions.
fn filled(
    mut temporary: NamedTempFile,
    old: Option<Permissions>,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> io::Result<NamedTempFile> {
    fill(temporary.as_file_mut(), write)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old)?;
    }
    // On the disk before the rename, so that a power cut cannot leave a name without contents.
    temporary.as_file().sync_all()?;
    Ok(temporary)
}

/// Copies a file into a device or a pipe.
fn pour(mut file: File, path: &Path) -> io::Result<()> {
    let mut stream = OpenOptions::new().write(true).open(path)?;
    io::copy(&mut file, &mut stream)?;
    stream.flush()
}

/// Bytes that are read or written at a time: a small part of what tables and pictures take.
pub(super) const BUFFER: usize = 1 << 18;

fn fill(
    file: &mut File,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffer = BufWriter::with_capacity(BUFFER, file);
    write(&mut buffer)?;
    buffer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(path: &Path, text: &str) -> Result<(), WriteError> {
        write_atomically(path, |file| file.write_all(text.as_bytes()))
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn writes_new_files_and_replaces_old_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        for text in ["first", "second, longer", "3"] {
            check_writable(&path).unwrap();
            put(&path, text).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn files_that_belong_together_are_all_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["a.txt", "b.txt"].map(|name| folder.path().join(name));
        put(&paths[0], "old").unwrap();
        let staged = |path: &Path| stage(path, |file| file.write_all(b"new")).unwrap();
        let full = Path::new("/dev/full");
        if full.exists() {
            let files = vec![staged(&paths[0]), staged(full), staged(&paths[1])];
            let error = put_all_in_place(files).unwrap_err().to_string();
            assert!(error.starts_with("cannot write \"/dev/full\""), "{error}");
        }
        drop([staged(&paths[0]), staged(&paths[1])]);
        assert_eq!(fs::read_to_string(&paths[0]).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.txt"]);
        put_all_in_place(vec![staged(&paths[0]), staged(&paths[1])]).unwrap();
        assert_eq!(fs::read_to_string(&paths[0]).unwrap(), "new");
        assert_eq!(names(folder.path()), ["a.txt", "b.txt"]);
    }

    #[test]
    fn a_failed_write_leaves_the_older_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        put(&path, "old").unwrap();
        let error = write_atomically(&path, |file| {
            file.write_all(b"half of the n")?;
            Err(io::Error::other("the disk is on fire"))
        });
        let message = format!("cannot write {}: the disk is on fire", Quoted(&path));
        assert_eq!(error.unwrap_err().to_string(), message);
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn checking_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        check_writable(&folder.path().join("new.exr")).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn says_what_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/a.exr");
        let error = check_writable(&missing).unwrap_err().to_string();
        let parent = folder.path().join("no/such");
        let expected =
            format!("cannot write {}: there is no folder {}", Quoted(&missing), Quoted(&parent));
        assert_eq!(error, expected);
        let error = put(folder.path(), "").unwrap_err().to_string();
        assert_eq!(error, format!("cannot write {}: it is a folder", Quoted(folder.path())));
        let error = check_writable(Path::new("")).unwrap_err().to_string();
        assert_eq!(error, "cannot write \"\": it does not name a file");
        let error = check_writable(Path::new("new.exr/")).unwrap_err().to_string();
        assert_eq!(error, "cannot write \"new.exr/\": it does not name a file");
        let file = folder.path().join("file");
        put(&file, "x").unwrap();
        assert!(matches!(check_writable(&file.join("below")), Err(WriteError::Io { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_file_and_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o7777;
        let (plain, path) = (folder.path().join("plain"), folder.path().join("a.txt"));
        File::create(&plain).unwrap();
        put(&path, "x").unwrap();
        assert_eq!(mode(&path), mode(&plain));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        put(&path, "y").unwrap();
        assert_eq!(mode(&path), 0o640);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_temporary_file_is_not_mentioned() {
        // Nobody, not even root, makes files in the kernel's tables.
        let error = check_writable(Path::new("/proc/a.exr")).unwrap_err().to_string();
        let start = "cannot write \"/proc/a.exr\": no file can be made in the folder \"/proc\": ";
        assert!(error.starts_with(start), "{error}");
        assert!(error.ends_with(')') && !error.contains("nurbray"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        put(&real, "old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        put(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");

        fs::remove_file(&real).unwrap(); // a link to a file that is not there yet
        std::os::unix::fs::symlink("link", folder.path().join("twice")).unwrap();
        check_writable(&folder.path().join("twice")).unwrap();
        put(&folder.path().join("twice"), "made").unwrap();
        assert_eq!(fs::read_to_string(&real).unwrap(), "made");
        assert_eq!(names(folder.path()), ["link", "real", "twice"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_into_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        put(Path::new("/dev/null"), "gone").unwrap();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        let error = put(Path::new("/dev/full"), "too much").unwrap_err().to_string();
        assert!(error.starts_with("cannot write \"/dev/full\": No space left"), "{error}");
    }
}
