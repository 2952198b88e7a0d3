//! The progress of the work: a bar on a terminal, a few plain lines elsewhere.

use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::console;

/// Plain lines appear at each of `PARTS` equal parts of the work, but no more often than every
/// `PLAIN_INTERVAL`: work of seconds needs none, work of hours has ten.
const PARTS: u64 = 10;
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);

/// Who has waited longer than this for what tells nothing of its progress is told what it is.
pub(crate) const PATIENCE: Duration = Duration::from_secs(5);

/// The progress of the work; any thread may report it.
#[derive(Debug)]
pub(crate) struct Progress {
    what: &'static str,
    total: u64,
    done: AtomicU64,
    rays: Arc<AtomicU64>,
    start: Instant,
    display: Display,
}

#[derive(Debug)]
enum Display {
    Silent,
    Bar(ProgressBar),
    /// When the last line appeared, and how many parts were done then.
    Lines(Mutex<(Instant, u64)>),
}

impl Progress {
    /// Work of `total` rays or other units.
    pub(crate) fn new(what: &'static str, total: u64) -> Self {
        let rays = Arc::new(AtomicU64::new(0));
        let display = if io::stderr().is_terminal() {
            Display::Bar(bar(what, total, &rays))
        } else {
            Display::Lines(Mutex::new((Instant::now(), 0)))
        };
        Self { what, total, done: AtomicU64::new(0), rays, start: Instant::now(), display }
    }

    /// Shows nothing.
    pub(crate) fn silent() -> Self {
        let rays = Arc::default();
        let (done, start, display) = (AtomicU64::new(0), Instant::now(), Display::Silent);
        Self { what: "", total: 0, done, rays, start, display }
    }

    /// Reports that `count` more rays are traced, for work that is counted in rays.
    pub(crate) fn add_rays(&self, count: u64) {
        self.rays.fetch_add(count, Ordering::Relaxed);
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        self.show(done);
    }

    /// Reports that `done` units of the work are finished and this many rays traced in total; 0 if
    /// the work is not about rays.
    pub(crate) fn set(&self, done: u64, rays: u64) {
        self.rays.store(rays, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
        self.show(done);
    }

    /// The work is done: the bar goes, the lines stay.
    pub(crate) fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn show(&self, done: u64) {
        match &self.display {
            Display::Silent => {}
            Display::Bar(bar) => bar.set_position(done),
            Display::Lines(last) => self.maybe_line(last, done),
        }
    }

    fn maybe_line(&self, last: &Mutex<(Instant, u64)>, done: u64) {
        let part = done.saturating_mul(PARTS) / self.total.max(1);
        // While another thread writes a line, this thread need not.
        let Ok(mut last) = last.try_lock() else { return };
        let finished = done >= self.total; // the summary says so
        if part > last.1 && last.0.elapsed() >= PLAIN_INTERVAL && !finished {
            *last = (Instant::now(), part);
            console::say(&self.line(done, self.start.elapsed()));
        }
    }

    fn line(&self, done: u64, elapsed: Duration) -> String {
        let elapsed = elapsed.as_secs_f64();
        let share = done as f64 / self.total as f64;
        let left = duration(elapsed / share - elapsed);
        let rate = match self.rays.load(Ordering::Relaxed) {
            0 => String::new(),
            rays => format!(" {},", rate(rays, elapsed)),
        };
        format!("{}: {:.0} %,{rate} {left} left", self.what, 100.0 * share)
    }
}

/// Does work of which nobody knows how far it is; if it takes longer than [`PATIENCE`], a line says
/// what is being done.
pub(crate) fn patiently<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let (working, end) = channel::<()>();
    thread::scope(|scope| {
        let wait = move || {
            if end.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                console::say(what);
            }
        };
        // Without another thread, nothing is said.
        let _ = thread::Builder::new().spawn_scoped(scope, wait);
        let result = work();
        drop(working);
        result
    })
}

fn bar(what: &'static str, total: u64, rays: &Arc<AtomicU64>) -> ProgressBar {
    let rays = Arc::clone(rays);
    let rate = move |state: &ProgressState, text: &mut dyn std::fmt::Write| {
        let rays = rays.load(Ordering::Relaxed);
        if rays > 0 {
            let _ = text.write_str(&rate(rays, state.elapsed().as_secs_f64()));
        }
    };
    let eta = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
        // Before anything is done, nothing is known of the time it takes.
        if state.pos() > 0 {
            let _ = write!(text, "ETA {}", duration(state.eta().as_secs_f64()));
        }
    };
    let template = "{msg} {wide_bar} {percent:>3} %  {rate}  {eta}";
    let style = ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", rate)
        .with_key("eta", eta);
    ProgressBar::new(total).with_style(style).with_message(what)
}

/// Rays a second, in millions or thousands.
fn rate(rays: u64, seconds: f64) -> String {
    match rays as f64 / seconds.max(f64::MIN_POSITIVE) {
        slow @ ..1e5 => format!("{:.3} krays/s", slow * 1e-3),
        fast => format!("{:.3} Mrays/s", fast * 1e-6),
    }
}

/// Seconds as people say them: `7.10 s`, `25.3 s`, `3 min 20 s`, `2 h 5 min`.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_line_says_share_rate_and_time_left() {
        let progress = Progress { what: "rendering", total: 40, ..Progress::silent() };
        progress.set(10, 3_000_000);
        let line = progress.line(10, Duration::from_secs(30));
        assert_eq!(line, "rendering: 25 %, 0.100 Mrays/s, 1 min 30 s left");
        progress.set(20, 0);
        let line = progress.line(20, Duration::from_secs(30));
        assert_eq!(line, "rendering: 50 %, 30.0 s left");
    }

    #[test]
    fn slow_work_is_told_in_thousands() {
        assert_eq!(rate(2500, 1.0), "2.500 krays/s");
        assert_eq!(rate(25_000_000, 10.0), "2.500 Mrays/s");
    }

    #[test]
    fn durations() {
        let said = [0.256, 7.1, 59.4, 200.0, 7500.0].map(duration);
        assert_eq!(said, ["0.26 s", "7.10 s", "59.4 s", "3 min 20 s", "2 h 5 min"]);
    }
}
