//! Against Embree: the same rays on the surfaces and on triangles in their place.

use std::ops::ControlFlow;
use std::time::Duration;

use nurbray::intersect::Kernel;
use nurbray::io::mesh::{GridMesh, TessellationPlan};
use nurbray::io::{Embree, PacketWidth, put_all_in_place, stage_png};
use nurbray::render::{Film, RenderSettings, render};
use nurbray::scene::World;

use super::super::args::CompareArguments;
use super::super::failure::{Failure, OrFail};
use super::super::progress::Progress;
use super::super::race::{Entry, Measurement, Model, RaySet, Rays, Rival, tiled_pixels};
use super::super::{chart, console, input, threads};
use super::errors::Errors;
use super::folder::Folder;
use super::heat::{self, Color, Scale};
use super::report::{Findings, LEGEND, PICTURE, PLOT, REPORT, Report, normal_file, position_file};
use super::sight::{self, View, degrees};
use super::verdict::{Cause, Judge, Verdict};

/// Samples a pixel of the picture of the model: enough for smooth edges.
const PICTURE_SAMPLES: u32 = 16;

/// The colours of position errors: from the resolution of f32 to the coarsest tolerance in use.
pub(super) const POSITION: Scale =
    Scale { quantity: "position error / diagonal, along the ray", low: -8, high: -3 };
/// The colours of normal errors.
pub(super) const NORMAL: Scale = Scale { quantity: "normal error, degrees", low: -4, high: 1 };

/// The pictures of one tolerance, pixels row by row.
struct Pictures {
    position: Vec<Color>,
    normal: Vec<Color>,
}

/// Both sides, prepared and timed.
struct Race {
    model: Model,
    size: [u32; 2],
    rays: Rays,
    rivals: Vec<Rival>,
    /// How the rivals were made.
    plans: Vec<TessellationPlan>,
    measured: Measurement,
}

/// Runs the comparison and writes the report.
pub(super) fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    let tolerances = arguments.tolerances();
    let files = files(&tolerances);
    let folder = Folder::new(&arguments.output, &files, &[&arguments.input])?;
    folder.check_apart(&input::read(&arguments.input)?)?; // reports errors in the input first
    let embree = Embree::load_with_threads(arguments.threads).or_failed()?;
    let progress = Progress::new("comparing", tolerances.len() as u64 + 2);
    let race = threads::pool(Some(arguments.threads))?
        .install(|| Race::run(arguments, &embree, &progress))?;

    // Answers do not depend on the number of threads: all may work.
    let Race { model, size, rays, .. } = &race;
    let ours = sight::exact(model.world.bvh(), rays);
    let seen = || ours.iter().filter_map(View::sight);
    let compared = Compared { model, rays, size: *size, ours: &ours };
    let mut findings = Vec::new();
    let mut pictures = Vec::new();
    for (done, (rival, plan)) in (3..).zip(race.rivals.iter().zip(&race.plans)) {
        let meshes = plan.detailed_meshes().or_failed()?;
        let (found, drawn) = compared.look(rival, &meshes);
        findings.push(found);
        pictures.push(drawn);
        progress.set(done, 0);
    }
    progress.finish();

    let report = Report {
        model,
        size: *size,
        threads: arguments.threads,
        rival: &format!("Embree {}", embree.version().map(|number| number.to_string()).join(".")),
        measured: &race.measured,
        rivals: &race.rivals,
        findings: &findings,
        hits: seen().count(),
        residual: Errors::of(seen().map(|sight| sight.residual / model.diagonal)),
        doubtful: sight::doubtful(&ours),
        files: &files,
    };
    super::warn_if_empty(model, report.hits, report.doubtful);
    let film = picture(&model.world, report.size)?;
    write(&folder, &report, (&film, &pictures))?;
    console::print(&format!("{}\n", folder.at(REPORT).display()))
}

impl Race {
    /// Prepares and times both sides on the threads of the current pool.
    fn run(
        arguments: &CompareArguments,
        embree: &Embree,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let budget = Duration::from_secs_f64(arguments.seconds);
        let model = Model::load(&arguments.input, super::wanted_size(arguments), budget)?;
        input::warn_of_what_is_not_shown(&arguments.input, &model.scene);
        let size = super::size(&model.world)?;
        let rays = Rays::new(RaySet::Primary, &model, size);
        let mut rivals = Vec::new();
        let mut plans = Vec::new();
        for tolerance in arguments.tolerances() {
            let (rival, plan) = Rival::build(embree, &model, tolerance, budget)?;
            rivals.push(rival);
            plans.push(plan);
        }
        progress.set(1, 0);
        let kernels = [Kernel::default()];
        let measured = Measurement::new(&model, &kernels, &rivals, &rays, arguments.seconds);
        progress.set(2, 0);
        Ok(Self { model, size, rays, rivals, plans, measured })
    }
}

/// Writes everything; then puts all of it in its place, the report last, so that a report has its
/// pictures.
fn write(
    folder: &Folder,
    report: &Report<'_>,
    (film, pictures): (&Film, &[Pictures]),
) -> Result<(), Failure> {
    folder.make()?;
    let mut files = Vec::new();
    for (rival, pictures) in report.rivals.iter().zip(pictures) {
        let stage = |file: String, pixels| heat::stage(&folder.at(&file), report.size, pixels);
        files.push(stage(position_file(rival.tolerance), &pictures.position).or_failed()?);
        files.push(stage(normal_file(rival.tolerance), &pictures.normal).or_failed()?);
    }
    let exposure = report.model.world.settings().exposure;
    files.push(stage_png(&folder.at(PICTURE), film, exposure).or_failed()?);
    files.push(folder.stage(LEGEND, &heat::legend(&[POSITION, NORMAL], &heat::WORDS))?);
    files.push(folder.stage(PLOT, &chart::svg(&report.panels()).or_failed()?)?);
    files.push(folder.stage(REPORT, &report.text())?);
    put_all_in_place(files).or_failed()
}

fn files(tolerances: &[f64]) -> Vec<String> {
    let fixed = [REPORT, PICTURE, LEGEND, PLOT].map(str::to_owned);
    let of_tolerances = tolerances.iter().flat_map(|&t| [position_file(t), normal_file(t)]);
    fixed.into_iter().chain(of_tolerances).collect()
}

/// Renders the camera's view with the scene's settings, but fewer samples.
fn picture(world: &World, size: [u32; 2]) -> Result<Film, Failure> {
    let settings = RenderSettings {
        size,
        samples: 0..PICTURE_SAMPLES,
        ..RenderSettings::from(world.settings())
    };
    render(world, &settings, &|_| ControlFlow::Continue(())).or_failed()
}

/// The model and the rays on which both sides are compared.
#[derive(Clone, Copy)]
struct Compared<'a> {
    model: &'a Model,
    rays: &'a Rays,
    size: [u32; 2],
    ours: &'a [View],
}

impl Compared<'_> {
    /// Compares the triangles of one tolerance with the surfaces, ray by ray.
    fn look(self, rival: &Rival, meshes: &[GridMesh]) -> (Findings, Pictures) {
        // One width for all runs, so that all give the same report.
        let mut entry = Entry::new(rival, self.rays, PacketWidth::Sixteen);
        entry.pass();
        let judge = Judge { bvh: self.model.world.bvh(), tolerance: rival.distance };

        let mut errors = [const { Vec::new() }; 4];
        let mut findings = Findings::default();
        let blank = || vec![heat::NOTHING; self.size[0] as usize * self.size[1] as usize];
        let mut pictures = Pictures { position: blank(), normal: blank() };
        let both = self.rays.queries.iter().zip(self.ours).zip(entry.hits());
        for (((query, ours), hit), [x, y]) in both.zip(tiled_pixels(self.size)) {
            let theirs = hit.map(|hit| sight::on_mesh(&hit, query.ray(), meshes));
            let verdict = judge.judge(query.ray(), ours, theirs.as_ref());
            findings.hits += usize::from(theirs.is_some() && verdict != Verdict::Open);
            findings.count(verdict);
            let mut colors = match verdict {
                Verdict::Lost(_) => [heat::LOST; 2],
                Verdict::Invented(_) => [heat::INVENTED; 2],
                Verdict::Open => [heat::DOUBTFUL; 2],
                Verdict::Same | Verdict::Nothing => [heat::NOTHING; 2],
            };
            if let (Verdict::Same, Some(ours), Some(theirs)) = (verdict, ours.sight(), theirs) {
                let along = (ours.distance - theirs.distance).abs() / self.model.diagonal;
                let normal = degrees(ours.normal, theirs.normal);
                errors[0].push(along);
                errors[1].push(along * ours.incidence(query.ray()));
                errors[2].push(normal);
                errors[3].push(degrees(ours.facet, theirs.facet));
                colors = [POSITION.color(along), NORMAL.color(normal)];
            }
            let pixel = y * self.size[0] as usize + x;
            [pictures.position[pixel], pictures.normal[pixel]] = colors;
        }
        let [along, across, normal, facet] = errors.map(Errors::of);
        (Findings { along, across, normal, facet, ..findings }, pictures)
    }
}

impl Findings {
    fn count(&mut self, verdict: Verdict) {
        let place = |cause| usize::from(cause == Cause::Gap);
        match verdict {
            Verdict::Nothing | Verdict::Open => {}
            Verdict::Same => self.same += 1,
            Verdict::Lost(cause) => self.lost[place(cause)] += 1,
            Verdict::Invented(cause) => self.invented[place(cause)] += 1,
        }
    }
}
