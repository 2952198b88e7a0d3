//! Runs the program POV-Ray and reads its output.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Error, anyhow};

/// The environment variable that names another program.
pub(super) const OVERRIDE: &str = "POVRAY";

/// What its version begins with, as POV-Ray prints it.
const NAME: &str = "POV-Ray ";

/// The oldest version that understands the scenes.
const OLDEST: [u32; 2] = [3, 7];

/// What POV-Ray made of a scene.
#[derive(Clone, Debug)]
pub(super) struct Rendering {
    /// For each pixel, row by row from the top, the cosine between ray and normal, or `None`
    /// where nothing is hit.
    pub(super) cosines: Vec<Option<f64>>,
    /// Seconds to read the scene and prepare it, as POV-Ray says.
    pub(super) prepare_seconds: f64,
    /// Seconds to trace, as POV-Ray says.
    pub(super) trace_seconds: f64,
    /// Seconds from start to end of the program.
    pub(super) total_seconds: f64,
}

/// POV-Ray as found on this machine.
#[derive(Clone, Debug)]
pub(super) struct Povray {
    program: OsString,
    /// Its name and version as it prints them.
    pub(super) name: String,
}

impl Povray {
    /// Finds the program and asks for its version.
    ///
    /// # Errors
    /// When there is none, or it is not POV-Ray 3.7 or later.
    pub(super) fn find() -> Result<Self, Error> {
        let named = env::var_os(OVERRIDE).filter(|name| !name.is_empty());
        let program = named.unwrap_or_else(|| "povray".into());
        let shown = program.to_string_lossy().into_owned();
        let answer = Command::new(&program)
            .arg("--version")
            .stdin(Stdio::null())
            .output()
            .map_err(|reason| {
                anyhow!(
                    "cannot run {shown} ({reason}); install it (apt install povray), or say where \
                     it is: {OVERRIDE}=/path/to/povray"
                )
            })?;
        let text = [answer.stdout, answer.stderr]
            .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
            .concat();
        let Some((name, version)) = name_and_version(&text) else {
            return Err(anyhow!("{shown} --version does not tell of POV-Ray 3"));
        };
        if version < OLDEST {
            let [major, minor] = OLDEST;
            return Err(anyhow!("{shown} is {name}: version {major}.{minor} or later is needed"));
        }
        Ok(Self { program, name })
    }

    /// Renders a scene, one ray through the middle of each pixel.
    ///
    /// # Errors
    /// When POV-Ray cannot render it; the error holds the end of POV-Ray's output.
    pub(super) fn render(
        &self,
        text: &str,
        size: [u32; 2],
        threads: u16,
    ) -> Result<Rendering, Error> {
        // By default POV-Ray has permission for the current folder.
        let folder = tempfile::tempdir().context("cannot make a folder for POV-Ray")?;
        let picture = folder.path().join("picture.png");
        fs::write(folder.path().join("scene.pov"), text).context("cannot write for POV-Ray")?;
        let [width, height] = size;
        let start = Instant::now();
        let run = Command::new(&self.program)
            .current_dir(folder.path())
            .args(["+Iscene.pov", "+Opicture.png", "-D", "-A", "+FN16", "File_Gamma=1.0"])
            .args([format!("+W{width}"), format!("+H{height}"), format!("+WT{threads}")])
            .stdin(Stdio::null())
            .output()
            .context("cannot run POV-Ray")?;
        let total_seconds = start.elapsed().as_secs_f64();
        let words = String::from_utf8_lossy(&run.stderr);
        if !run.status.success() {
            return Err(anyhow!("POV-Ray fails ({}): {}", run.status, ending(&words)));
        }
        if !picture.exists() {
            return Err(anyhow!("POV-Ray makes no picture: {}", ending(&words)));
        }
        let seconds =
            |what| seconds(&words, what).with_context(|| format!("POV-Ray tells no {what}"));
        Ok(Rendering {
            cosines: cosines(&picture, size)?,
            prepare_seconds: seconds("Parse Time")? + seconds("Bounding Time")?,
            trace_seconds: seconds("Trace Time")?,
            total_seconds,
        })
    }
}

/// POV-Ray's name and version in what it says, and the version's first two numbers.
fn name_and_version(words: &str) -> Option<(String, [u32; 2])> {
    words.lines().find_map(|line| {
        let name = line[line.find(NAME)?..].trim();
        let (major, rest) = name.strip_prefix(NAME)?.split_once('.')?;
        let minor = rest.split(|c: char| !c.is_ascii_digit()).next()?;
        Some((name.to_owned(), [major.parse().ok()?, minor.parse().ok()?]))
    })
}

/// The number in `Trace Time:  0 hours  0 minutes  1 seconds (1.234 seconds)`.
fn seconds(words: &str, what: &str) -> Option<f64> {
    let line = words.lines().find(|line| line.trim_start().starts_with(what))?;
    line.split_once('(')?.1.split_whitespace().next()?.parse().ok()
}

/// The last lines with words, for an error.
fn ending(words: &str) -> String {
    let lines: Vec<_> = words.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    match lines.len() {
        0 => "it says nothing".to_owned(),
        count => lines[count.saturating_sub(4)..].join(" | "),
    }
}

/// Reads a linear picture of 16 bits: grey is a hit, pure blue is none.
fn cosines(path: &Path, [width, height]: [u32; 2]) -> Result<Vec<Option<f64>>, Error> {
    let picture = image::open(path).context("cannot read POV-Ray's picture")?.into_rgb16();
    if picture.dimensions() != (width, height) {
        return Err(anyhow!("POV-Ray's picture has {:?} pixels", picture.dimensions()));
    }
    let full = f64::from(u16::MAX);
    let pixel = |rgb: &image::Rgb<u16>| match rgb.0 {
        [0, 0, u16::MAX] => None,
        [red, ..] => Some(f64::from(red) / full),
    };
    Ok(picture.pixels().map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_version_is_found_in_what_it_says() {
        let words = "Persistence of Vision(tm) Ray Tracer\nPOV-Ray v.\n POV-Ray 3.10.0-x.y : g++\n";
        assert_eq!(name_and_version(words), Some(("POV-Ray 3.10.0-x.y : g++".to_owned(), [3, 10])));
        assert_eq!(name_and_version("POV-Ray 3.6.1"), Some(("POV-Ray 3.6.1".to_owned(), [3, 6])));
        assert!([3, 6] < OLDEST && [3, 7] >= OLDEST && [3, 10] > OLDEST && [4, 0] > OLDEST);
        for none in ["", "POV-Ray", "POV-Ray ", "POV-Ray 3", "POV-Ray 3.x", "POV-Ray three.7"] {
            assert_eq!(name_and_version(none), None, "{none}");
        }
    }

    #[test]
    fn times_are_found_in_what_it_says() {
        let words = "Render Time:\n  Photon Time:      No photons\n  \
                     Trace Time:       0 hours  1 minutes  1 seconds (61.234 seconds)\n";
        assert_eq!(seconds(words, "Trace Time"), Some(61.234));
        assert_eq!(seconds(words, "Parse Time"), None);
        assert_eq!(ending("a\n\n b \nc\nd\ne\n"), "b | c | d | e");
        assert_eq!(ending("\n \n"), "it says nothing");
    }
}
