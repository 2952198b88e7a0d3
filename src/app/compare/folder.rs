//! The folder a report goes to.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use nurbray::io::{Quoted, StagedFile, check_writable, stage};
use nurbray::scene::Scene;

use super::super::failure::{Failure, OrFail};
use super::super::output;

/// A folder that exists, or can be made when its files are ready.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// The files that are to be written there.
    files: Vec<PathBuf>,
}

fn paths(files: &[PathBuf]) -> Vec<&Path> {
    files.iter().map(AsRef::as_ref).collect()
}

impl Folder {
    /// Checks that these files can be written there, and that none of them is an input. Makes
    /// nothing yet.
    ///
    /// # Errors
    /// When one cannot be written or is an input: wrong use.
    pub(super) fn new(path: &Path, files: &[String], inputs: &[&Path]) -> Result<Self, Failure> {
        // Without a slash at the end, which no file's name has.
        let path: PathBuf = path.components().collect();
        let files: Vec<_> = files.iter().map(|file| path.join(file)).collect();
        if path.is_dir() {
            output::check(&paths(&files), inputs)?;
        } else if path.exists() {
            return Err(Failure::input(format!("{} is a file, not a folder", Quoted(&path))));
        } else {
            check_writable(&path).or_bad_input()?;
        }
        Ok(Self { path, files })
    }

    /// Checks that no file to be written is a model that the scene is made of.
    ///
    /// # Errors
    /// When one is: wrong use.
    pub(super) fn check_apart(&self, scene: &Scene) -> Result<(), Failure> {
        output::check_apart(&paths(&self.files), scene)
    }

    /// Makes the folder, unless it exists.
    ///
    /// # Errors
    /// When the system refuses.
    pub(super) fn make(&self) -> Result<(), Failure> {
        if self.path.is_dir() {
            return Ok(());
        }
        let context = || format!("cannot make the folder {}", Quoted(&self.path));
        fs::create_dir(&self.path).with_context(context).or_failed()
    }

    /// Where a file goes.
    pub(super) fn at(&self, file: &str) -> PathBuf {
        self.path.join(file)
    }

    /// Writes a text, but does not put it in its place yet.
    ///
    /// # Errors
    /// When the system refuses.
    pub(super) fn stage(&self, file: &str, text: &str) -> Result<StagedFile, Failure> {
        stage(&self.at(file), |file| file.write_all(text.as_bytes())).or_failed()
    }
}

/// The end of a report: which files of the folder belong to it.
pub(super) fn files_written(files: &[String]) -> String {
    let list: String = files.iter().map(|file| format!("- {file}\n")).collect();
    format!(
        "\n## Files\n\nWritten with this report; others in its folder are not part of it.\n\n{list}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_checked_before_and_made_after_the_work() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("report");
        let files = ["a.md".to_owned()];
        let folder = Folder::new(&home.path().join("report/"), &files, &[]).unwrap();
        assert!(!path.exists());
        folder.make().unwrap();
        folder.make().unwrap();
        folder.stage("a.md", "words").unwrap().put_in_place().unwrap();
        assert_eq!(fs::read_to_string(path.join("a.md")).unwrap(), "words");

        // Now the file is an input, a folder in the way, or no folder at all.
        let message = |path: &Path, inputs: &[&Path]| {
            Folder::new(path, &files, inputs).unwrap_err().reason().to_string()
        };
        let input = path.join("a.md");
        assert!(message(&path, &[&input]).ends_with("it is an input of this run"));
        assert!(message(&input, &[]).ends_with("a.md\" is a file, not a folder"));
        assert!(message(&home.path().join("no/report"), &[]).contains("there is no folder"));
    }
}
