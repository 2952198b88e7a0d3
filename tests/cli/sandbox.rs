//! A folder of its own for each test, with scenes in it, and the program run there.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use nurbray::io::{Table, read_table, write_rows};
use serde_json::Value;
use tempfile::TempDir;

/// A unit sphere, seen from afar.
pub(crate) const SPHERE: &str = "\
[render]
size = [24, 16]
spp = 2

[[object]]
name = \"ball\"
shape = { sphere = { radius = 1 } }
";

/// Two sheets of two by two; the second begins a little beyond the first's right border.
pub(crate) const SHEETS_WITH_A_GAP: &str = "\
[[object]]
name = \"left\"
shape = { plane = { width = 2, height = 2 } }

[[object]]
name = \"right\"
shape = { plane = { width = 2, height = 2 } }
transform = [{ translate = [2.0000001, 0, 0] }]
";

/// A bilinear square as a bare geomdl model.
pub(crate) const SQUARE: &str = r#"{
  "shape": {
    "type": "surface",
    "data": [
      {
        "degree_u": 1, "degree_v": 1, "size_u": 2, "size_v": 2,
        "knotvector_u": [0, 0, 1, 1], "knotvector_v": [0, 0, 1, 1],
        "control_points": { "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]] }
      }
    ]
  }
}
"#;

/// The same square with `reversed`, which is not imported.
pub(crate) fn turned_square() -> String {
    SQUARE.replace("[1, 1, 0]] }", "[1, 1, 0]] },\n        \"reversed\": true")
}

/// A square with a hole, and a triangle in it.
pub(crate) const TRIMMED: &str = r#"
[[object]]
name = "sheet"
shape = { plane = { width = 2, height = 2 } }
[object.trims]
keep = "outside"
loops = [
    { circle = { center = [0.5, 0.5], radius = 0.3 } },
    { polygon = [[0.4, 0.4], [0.6, 0.4], [0.5, 0.6]] },
]
"#;

/// A temporary folder.
pub(crate) struct Sandbox {
    folder: TempDir,
}

/// How a run ended.
pub(crate) struct Run {
    /// The exit code; -1 for an end by a signal.
    pub(crate) code: i32,
    /// Everything on stdout.
    pub(crate) stdout: String,
    /// Everything on stderr.
    pub(crate) stderr: String,
}

impl Run {
    pub(crate) fn from_output(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// Asserts that the work was done, whatever the results.
    #[track_caller]
    pub(crate) fn succeeded(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    /// Asserts that the run ended with this code and this one error, and no results.
    #[track_caller]
    pub(crate) fn failed(self, code: i32, error: &str) {
        assert_eq!(self.stderr, format!("error: {error}\n"));
        assert_eq!((self.code, self.stdout.as_str()), (code, ""));
    }

    /// As [`Run::failed`], after one warning.
    #[track_caller]
    pub(crate) fn failed_with_warning(self, code: i32, warning: &str, error: &str) {
        assert_eq!(self.stderr, format!("warning: {warning}\nerror: {error}\n"));
        assert_eq!((self.code, self.stdout.as_str()), (code, ""));
    }

    /// As [`Run::failed`], where the parser adds usage behind the first line.
    #[track_caller]
    pub(crate) fn misused(self, first_line: &str) {
        assert_eq!(self.stderr.lines().next().unwrap_or(""), format!("error: {first_line}"));
        assert_eq!((self.code, self.stdout.as_str()), (2, ""));
    }

    /// The one object on stdout.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.stdout.lines().count(), 1, "{}", self.stdout);
        serde_json::from_str(&self.stdout).unwrap()
    }
}

impl Sandbox {
    /// An empty folder.
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A folder with these files.
    pub(crate) fn with(files: &[(&str, &str)]) -> Self {
        let sandbox = Self::new();
        for (name, contents) in files {
            fs::write(sandbox.path(name), contents).unwrap();
        }
        sandbox
    }

    /// The path of a file in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program, about to start in the folder with the words of a line.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nurbray"));
        command.current_dir(self.folder.path()).args(line.split_whitespace());
        command.env_remove("SOURCE_DATE_EPOCH"); // tests set it themselves
        command
    }

    /// Runs the program in the folder with the words of a line.
    #[track_caller]
    pub(crate) fn run(&self, line: &str) -> Run {
        Run::from_output(self.command(line).output().unwrap())
    }

    /// Whether there is such a file.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// The bytes of a file.
    #[track_caller]
    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// The names of all files.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Writes a NumPy file.
    pub(crate) fn write_rows<const N: usize>(&self, name: &str, rows: &[[f64; N]]) {
        write_rows(&self.path(name), rows).unwrap();
    }

    /// Reads a NumPy file.
    #[track_caller]
    pub(crate) fn table(&self, name: &str, columns: usize) -> Table {
        read_table(&self.path(name), &[columns]).unwrap()
    }
}
