//! Builds and runs a program that intersects lines with surfaces by another library, and reads
//! its answers.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::{DVec2, DVec3};
use nurbray::math::Ray;

use crate::model::{Model, nurbs};

/// A library, and how to build the program that asks it.
#[derive(Debug)]
pub(crate) struct Library {
    pub(crate) name: &'static str,
    source: &'static str,
    flags: &'static [&'static str],
    packages: &'static str,
    /// The environment variable that allows going without it.
    without: &'static str,
}

pub(crate) const SISL: Library = Library {
    name: "SISL",
    source: "sisl.cpp",
    flags: &["-lsisl", "-lm"],
    packages: "libsisl-dev",
    without: "NURBRAY_WITHOUT_SISL",
};

pub(crate) const OPENCASCADE: Library = Library {
    name: "OpenCASCADE",
    source: "opencascade.cpp",
    flags: &[
        "-I/usr/include/opencascade",
        "-w",
        "-lTKTopAlgo",
        "-lTKBRep",
        "-lTKG3d",
        "-lTKMath",
        "-lTKernel",
    ],
    packages: "libocct-modeling-algorithms-dev libocct-modeling-data-dev",
    without: "NURBRAY_WITHOUT_OPENCASCADE",
};

/// A hit as a library reports it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TheirHit {
    pub(crate) ray: usize,
    pub(crate) surface: usize,
    pub(crate) uv: DVec2,
    pub(crate) point: DVec3,
}

/// All answers of a library for some rays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    pub(crate) hits: Vec<TheirHit>,
    /// Rays that run inside a surface, according to the library.
    pub(crate) curves: Vec<usize>,
    /// Rays the library gives up on.
    pub(crate) failed: Vec<usize>,
}

/// A program ready to run.
#[derive(Debug)]
pub(crate) struct Program {
    library: &'static Library,
    path: PathBuf,
    folder: PathBuf,
}

impl Library {
    /// Builds the program. `None`, with a loud note, only where the variable allows it.
    pub(crate) fn program(&'static self) -> Option<Program> {
        if std::env::var_os(self.without).is_some_and(|value| value == "1") {
            let note =
                format!("*** SKIPPED: not compared with {} ({}=1) ***\n", self.name, self.without);
            // Written past the test harness, which swallows what passing tests print.
            std::io::stderr().write_all(note.as_bytes()).unwrap();
            return None;
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("independent").join(self.name);
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("program");
        let source =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/independent").join(self.source);
        let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".into());
        let mut command = Command::new(&compiler);
        command.args(["-std=c++14", "-O2", "-o"]).arg(&path).arg(&source).args(self.flags);
        let failure = match command.output() {
            Ok(output) if output.status.success() => {
                return Some(Program { library: self, path, folder });
            }
            Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
            Err(error) => format!("{compiler}: {error}"),
        };
        panic!(
            "the program that asks {} cannot be built: apt install g++ {}; or go without: {}=1\n{}",
            self.name, self.packages, self.without, failure
        );
    }
}

impl Program {
    /// Asks for all hits of the rays on the surfaces of a model, from `t = 0` on.
    pub(crate) fn ask(&self, model: &Model, rays: &[Ray]) -> Report {
        let input = self.folder.join("input");
        fs::write(&input, question(model, rays)).unwrap();
        let output = Command::new(&self.path).stdin(File::open(&input).unwrap()).output().unwrap();
        let words = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success(),
            "{} on {}: {} {words}",
            self.library.name,
            model.name,
            output.status
        );
        report(&String::from_utf8(output.stdout).unwrap())
    }
}

/// The program's input, in the format that exchange.hpp describes.
fn question(model: &Model, rays: &[Ray]) -> String {
    let mut text = format!("surfaces {}\n", model.surfaces.len());
    for surface in model.surfaces.iter().map(nurbs) {
        // Both expect knots of full multiplicity at the ends of the domain.
        let surface = surface.clamped();
        let (u, v) = (surface.knots_u(), surface.knots_v());
        let [nu, nv] = surface.size();
        writeln!(text, "{} {} {nu} {nv}", u.degree(), v.degree()).unwrap();
        for knot in u.values().iter().chain(v.values()) {
            write!(text, "{knot:e} ").unwrap();
        }
        for p in surface.control() {
            write!(text, "\n{:e} {:e} {:e} {:e}", p.x, p.y, p.z, p.w).unwrap();
        }
        text.push('\n');
    }
    writeln!(text, "rays {}", rays.len()).unwrap();
    for ray in rays {
        let (o, d) = (ray.origin(), ray.direction().normalize());
        writeln!(text, "{:e} {:e} {:e} {:e} {:e} {:e}", o.x, o.y, o.z, d.x, d.y, d.z).unwrap();
    }
    text
}

fn report(text: &str) -> Report {
    let mut report = Report::default();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let ray = words[1].parse().unwrap();
        match words[0] {
            "curve" => report.curves.push(ray),
            "failed" => report.failed.push(ray),
            _ => {
                let number = |k: usize| words[k].parse::<f64>().unwrap();
                report.hits.push(TheirHit {
                    ray,
                    surface: words[2].parse().unwrap(),
                    uv: DVec2::new(number(3), number(4)),
                    point: DVec3::new(number(5), number(6), number(7)),
                });
            }
        }
    }
    report
}
