//! Files to write: found to be distinct and writable before the work begins.

use std::path::{Path, PathBuf};

use nurbray::io::{Quoted, check_writable, end_of_links};
use nurbray::scene::Scene;

use super::failure::{Failure, OrFail};

/// Refuses outputs that cannot be written, would overwrite an input, or each other.
///
/// # Errors
/// The first of these that is found: wrong use.
pub(crate) fn check(outputs: &[&Path], inputs: &[&Path]) -> Result<(), Failure> {
    for (index, output) in outputs.iter().enumerate() {
        if inputs.iter().any(|input| is_same_file(input, output)) {
            return Err(Failure::input(format!(
                "{} would be overwritten: it is an input of this run",
                Quoted(output)
            )));
        }
        if outputs[..index].iter().any(|other| is_same_place(other, output)) {
            return Err(Failure::input(format!("{} is given twice as output", Quoted(output))));
        }
        check_writable(output).or_bad_input()?;
    }
    Ok(())
}

/// Refuses outputs that would overwrite a model that a scene is made of: only once it is read, the
/// scene tells which these are.
///
/// # Errors
/// When one would: wrong use.
pub(crate) fn check_apart(outputs: &[&Path], scene: &Scene) -> Result<(), Failure> {
    for output in outputs {
        if let Some(file) = scene.files.iter().find(|file| is_same_file(file, output)) {
            return Err(Failure::input(format!(
                "{} would be overwritten: it is {}, an input of this run",
                Quoted(output),
                Quoted(file)
            )));
        }
    }
    Ok(())
}

/// Returns which of these extensions an output has, in upper or lower case: its format.
///
/// # Errors
/// When it has none of them: wrong use.
pub(crate) fn format(path: &Path, known: &[&'static str]) -> Result<&'static str, Failure> {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    let format = known.iter().find(|known| extension.as_deref() == Some(known.as_ref()));
    let bare = path.file_name().and_then(|name| name.to_str()?.strip_prefix('.'));
    if bare.is_some_and(|bare| known.iter().any(|known| known.eq_ignore_ascii_case(bare))) {
        let path = path.display();
        return Err(Failure::input(format!("{path}: a file name is needed before the extension")));
    }
    format.copied().ok_or_else(|| {
        let found = match &extension {
            Some(extension) => format!("cannot write .{} files", extension.display()),
            None if path.as_os_str() == "-" => {
                "it does not stand for standard output, and no extension says how to write it"
                    .into()
            }
            None => "no extension says how to write it".into(),
        };
        let known: Vec<_> = known.iter().map(|extension| format!(".{extension}")).collect();
        let be = if known.len() == 1 { "is" } else { "are" };
        Failure::input(format!("{}: {found}; known {be} {}", path.display(), known.join(" and ")))
    })
}

/// Refuses to write NumPy's format into a file whose name promises another. Devices and pipes
/// take it under any name.
///
/// # Errors
/// When the extension is not `.npy`: wrong use.
pub(crate) fn check_npy(path: &Path) -> Result<(), Failure> {
    check_only(path, "npy")
}

/// The same check for drawings.
///
/// # Errors
/// When the extension is not `.svg`: wrong use.
pub(crate) fn check_svg(path: &Path) -> Result<(), Failure> {
    check_only(path, "svg")
}

fn check_only(path: &Path, known: &'static str) -> Result<(), Failure> {
    let is_stream = path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir());
    if is_stream { Ok(()) } else { format(path, &[known]).map(drop) }
}

/// Whether standard output is a pipe or a file and a path leads there: anything else printed would
/// end up among the hits or rays, or, as a new file takes the old one's place, nowhere.
pub(crate) fn is_stdout(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{FileTypeExt, MetadataExt};
        let stream = |path: &Path| {
            let found = path.metadata().ok()?;
            let kind = found.file_type();
            let is_one = kind.is_fifo() || kind.is_socket() || kind.is_file();
            is_one.then(|| (found.dev(), found.ino()))
        };
        let found = stream(path);
        found.is_some() && found == stream(Path::new("/dev/stdout"))
    }
    #[cfg(not(unix))]
    {
        let _ = path;
        false
    }
}

/// Refuses to write a file into the pipe or the file that the results are printed into.
///
/// # Errors
/// When the path leads there: wrong use.
pub(crate) fn check_not_stdout(path: &Path) -> Result<(), Failure> {
    if is_stdout(path) {
        return Err(Failure::input(format!(
            "{} is standard output, where the results are printed: write to another file",
            Quoted(path)
        )));
    }
    Ok(())
}

/// Files as words: `a.exr, b.exr and c.png`.
pub(crate) fn listed(paths: &[&Path]) -> String {
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    match names.as_slice() {
        [others @ .., last] if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        names => names.concat(),
    }
}

/// Whether two paths lead to one regular file. (Hard links are files of their own: a new file takes
/// the place of one of them, and the other stays.) Devices such as /dev/stdin and /dev/null are not
/// overwritten.
fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b && a.is_file(),
        _ => false, // one of them does not exist (yet)
    }
}

/// Whether two paths, of files that need not exist, name one place. Devices may take several
/// outputs, whatever they are called.
fn is_same_place(a: &Path, b: &Path) -> bool {
    let is_device = |path: &Path| path.exists() && !path.is_file();
    let place = |path: &Path| -> Option<PathBuf> {
        let path = end_of_links(path);
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder.canonicalize().ok()?,
            _ => Path::new(".").canonicalize().ok()?,
        };
        Some(folder.join(path.file_name()?))
    };
    let is_one = || a == b || is_same_file(a, b) || place(a).is_some_and(|a| Some(a) == place(b));
    !is_device(a) && !is_device(b) && is_one()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_say_how() {
        let message = |path: &str, known: &[&'static str]| {
            format(Path::new(path), known).unwrap_err().reason().to_string()
        };
        assert_eq!(format(Path::new("b/c.PNG"), &["exr", "png"]).unwrap(), "png");
        assert_eq!(
            message("a.jpg", &["exr", "png"]),
            "a.jpg: cannot write .jpg files; known are .exr and .png"
        );
        assert_eq!(
            message("a", &["exr", "png"]),
            "a: no extension says how to write it; known are .exr and .png"
        );
        assert_eq!(
            message("-", &["npy"]),
            "-: it does not stand for standard output, and no extension says how to write it; known \
             is .npy"
        );
        for bare in [".exr", "a/.EXR"] {
            let expected = format!("{bare}: a file name is needed before the extension");
            assert_eq!(message(bare, &["exr", "png"]), expected);
        }
        assert_eq!(message("h.csv", &["npy"]), "h.csv: cannot write .csv files; known is .npy");
        assert!(check_npy(Path::new("h.npy")).is_ok() && check_npy(Path::new("h.NPY")).is_ok());
        assert!(check_npy(Path::new("h.csv")).is_err() && check_npy(Path::new("h")).is_err());
        assert!(check_npy(Path::new("h.npy.gz")).is_err());
        assert!(check_svg(Path::new("h.svg")).is_ok() && check_svg(Path::new("h.png")).is_err());
        #[cfg(unix)]
        assert!(check_npy(Path::new("/dev/null")).is_ok());
    }

    #[test]
    fn an_output_is_neither_an_input_nor_given_twice() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.npy", "b.npy"].map(|name| folder.path().join(name));
        let a_again = folder.path().join(".").join("a.npy");
        std::fs::write(&a, "rays").unwrap();
        assert!(check(&[&b], &[&a]).is_ok());
        let overwritten = check(&[&a_again], &[&a]).unwrap_err();
        assert!(overwritten.reason().to_string().ends_with("it is an input of this run"));
        let b_again = folder.path().join(".").join("b.npy");
        let twice = check(&[&b, &b_again], &[]).unwrap_err();
        assert!(twice.reason().to_string().ends_with("is given twice as output"));
        assert!(check(&[&folder.path().join("none/a.npy")], &[]).is_err());
        assert_eq!(std::fs::read(&a).unwrap(), b"rays");
        assert!(!b.exists());

        #[cfg(unix)]
        {
            let link = folder.path().join("link.npy");
            std::os::unix::fs::symlink("b.npy", &link).unwrap();
            let twice = check(&[&link, &b], &[]).unwrap_err();
            assert!(twice.reason().to_string().ends_with("is given twice as output"));

            let nowhere = folder.path().join("nowhere.npy");
            std::os::unix::fs::symlink("/dev/null", &nowhere).unwrap();
            let again = folder.path().join(".").join("nowhere.npy");
            for other in [&nowhere, &again, Path::new("/dev/null")] {
                assert!(check(&[&nowhere, other], &[]).is_ok(), "{}", other.display());
            }
        }
    }
}
