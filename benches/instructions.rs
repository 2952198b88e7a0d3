//! Counts the instructions of the kernels with valgrind. Counts repeat to a thousandth, so a step
//! of a few per cent is seen that a clock would hide.
//!
//! ```sh
//! cargo install gungraun-runner --version 0.20.0      # once; and valgrind, of your distribution
//! cargo bench --bench instructions -- --save-baseline=before
//! # … a change …
//! cargo bench --bench instructions -- --baseline=before
//! ```
//!
//! The last command fails where a part takes over 5 % more instructions than before. Counts hold
//! for one compiler on one kind of processor: they are compared on the machine that made them, and
//! none are kept in the repository. Without valgrind or the runner, the benchmark says so and
//! counts nothing. AVX-512 is left out, as valgrind does not know it.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    missing_docs,
    reason = "a benchmark that cannot be set up has nothing to say; what is not counted is told \
              on stderr; gungraun's macros make undocumented functions"
)]

#[allow(dead_code, reason = "not all models are counted")]
mod models;
mod subject;

use std::process::{Command, Stdio};

/// The models: a rational one with poles, and a polynomial one of many pieces. Larger ones
/// take valgrind too long to build.
const SPHERE: &str = "sphere";
const TEAPOT: &str = "teapot.json";

fn main() {
    let given = |argument: &str| std::env::args().any(|one| one == argument);
    // Valgrind runs this program again.
    if given("--gungraun-run") {
        return counts::run();
    }
    // `cargo test` has no use for counts, and no time for them.
    if !given("--bench") {
        eprintln!("instruction counts: not taken in tests; run cargo bench --bench instructions");
        return;
    }
    let absent: Vec<&str> =
        ["valgrind", "gungraun-runner"].into_iter().filter(|program| !answers(program)).collect();
    if absent.is_empty() {
        counts::run();
    } else {
        eprintln!("instruction counts: not taken, {} is not installed", absent.join(" and "));
    }
}

/// Whether a program can be run.
fn answers(program: &str) -> bool {
    let mut command = Command::new(program);
    command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok()
}

/// The parts that are counted. A module, since gungraun makes a `main` of its own.
mod counts {
    use std::hint::black_box;

    use gungraun::{
        Callgrind, EventKind, LibraryBenchmarkConfig, library_benchmark, library_benchmark_group,
    };
    use nurbray::intersect::{Answer, Coherence, Kernel, Query, Tracer};

    use super::subject::Subject;
    use super::{SPHERE, TEAPOT};

    /// The increase allowed for a part, in per cent.
    const LIMIT: f64 = 5.0;

    /// A tracer and its rays, ready to go: making them is not counted.
    type Ready = (Tracer<'static>, Vec<Query>);

    fn ready(kernel: Kernel, name: &str, rays: fn(&Subject) -> Vec<Query>) -> Ready {
        let subject: &'static Subject = Box::leak(Box::new(Subject::new(name)));
        (subject.bvh.tracer_with(kernel), rays(subject))
    }

    fn picture(kernel: Kernel, name: &str) -> Ready {
        ready(kernel, name, |subject| subject.rays.clone())
    }

    fn silhouettes(kernel: Kernel, name: &str) -> Ready {
        ready(kernel, name, Subject::silhouette)
    }

    fn shadow_rays(kernel: Kernel, name: &str) -> Ready {
        ready(kernel, name, Subject::shadow_rays)
    }

    fn misses(kernel: Kernel, name: &str) -> Ready {
        ready(kernel, name, |subject| subject.rays_with(false))
    }

    fn few_hits(name: &str) -> Ready {
        let few = |subject: &Subject| subject.rays_with(true).into_iter().step_by(16).collect();
        ready(Kernel::Scalar, name, few)
    }

    fn first_hits((mut tracer, rays): Ready, coherence: Coherence) {
        let mut answers = Vec::with_capacity(rays.len());
        tracer.first_hits(black_box(&rays), coherence, &mut answers);
        black_box(answers);
    }

    #[library_benchmark(setup = picture)]
    #[bench::portable_sphere(Kernel::Portable, SPHERE)]
    #[bench::portable_teapot(Kernel::Portable, TEAPOT)]
    #[bench::avx2_sphere(Kernel::Avx2, SPHERE)]
    #[bench::avx2_teapot(Kernel::Avx2, TEAPOT)]
    fn packets(ready: Ready) {
        first_hits(ready, Coherence::Coherent);
    }

    #[library_benchmark(setup = picture)]
    #[bench::scalar_sphere(Kernel::Scalar, SPHERE)]
    #[bench::scalar_teapot(Kernel::Scalar, TEAPOT)]
    #[bench::portable_sphere(Kernel::Portable, SPHERE)]
    #[bench::portable_teapot(Kernel::Portable, TEAPOT)]
    #[bench::avx2_sphere(Kernel::Avx2, SPHERE)]
    #[bench::avx2_teapot(Kernel::Avx2, TEAPOT)]
    fn single((mut tracer, rays): Ready) {
        let mut answers: Vec<Answer> = Vec::with_capacity(rays.len());
        answers.extend(black_box(&rays).iter().map(|query| tracer.first_hit(query)));
        black_box(answers);
    }

    #[library_benchmark(setup = picture)]
    #[bench::portable_sphere(Kernel::Portable, SPHERE)]
    #[bench::portable_teapot(Kernel::Portable, TEAPOT)]
    #[bench::avx2_sphere(Kernel::Avx2, SPHERE)]
    #[bench::avx2_teapot(Kernel::Avx2, TEAPOT)]
    fn streams(ready: Ready) {
        first_hits(ready, Coherence::Incoherent);
    }

    #[library_benchmark(setup = shadow_rays)]
    #[bench::scalar_teapot(Kernel::Scalar, TEAPOT)]
    #[bench::portable_teapot(Kernel::Portable, TEAPOT)]
    #[bench::avx2_teapot(Kernel::Avx2, TEAPOT)]
    fn shadows((mut tracer, rays): Ready) {
        let mut answers = Vec::with_capacity(rays.len());
        tracer.occlusions(black_box(&rays), Coherence::Coherent, &mut answers);
        black_box(answers);
    }

    #[library_benchmark(setup = silhouettes)]
    #[bench::scalar_teapot(Kernel::Scalar, TEAPOT)]
    #[bench::portable_teapot(Kernel::Portable, TEAPOT)]
    #[bench::avx2_teapot(Kernel::Avx2, TEAPOT)]
    fn silhouette(ready: Ready) {
        first_hits(ready, Coherence::Coherent);
    }

    #[library_benchmark(setup = misses)]
    #[bench::scalar_teapot(Kernel::Scalar, TEAPOT)]
    #[bench::portable_teapot(Kernel::Portable, TEAPOT)]
    #[bench::avx2_teapot(Kernel::Avx2, TEAPOT)]
    fn hierarchy(ready: Ready) {
        first_hits(ready, Coherence::Coherent);
    }

    #[library_benchmark(setup = few_hits)]
    #[bench::sphere(SPHERE)]
    #[bench::teapot(TEAPOT)]
    fn exact((mut tracer, rays): Ready) {
        for ray in black_box(&rays) {
            let _ = black_box(tracer.exact_first_hit(ray));
        }
    }

    library_benchmark_group!(
        name = kernels,
        benchmarks = [packets, single, streams, shadows, silhouette, hierarchy, exact]
    );

    gungraun::main!(
        config = LibraryBenchmarkConfig::default().tool(
            Callgrind::with_args(["--cache-sim=no"]).soft_limits([(EventKind::Ir, LIMIT)])
        );
        library_benchmark_groups = kernels
    );

    pub(super) fn run() {
        main();
    }
}
