//! Files to write: told from one another and found writable before the work begins.

use std::path::{Path, PathBuf};

use nurbray::io::{Quoted, check_writable};

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

/// Whether two paths lead to one regular file. Devices such as /dev/stdin and /dev/null are
/// not overwritten.
fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b && a.is_file(),
        _ => false, // one of them does not exist (yet)
    }
}

/// Whether two paths, of files that need not exist, name one place.
fn is_same_place(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| -> Option<PathBuf> {
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder.canonicalize().ok()?,
            _ => Path::new(".").canonicalize().ok()?,
        };
        Some(folder.join(path.file_name()?))
    };
    a == b || is_same_file(a, b) || place(a).is_some_and(|a| Some(a) == place(b))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
