//! How far the work is: a bar on a terminal, a few plain lines elsewhere.

use std::fmt::Write as _;
use std::io::{self, IsTerminal};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::console;

/// Plain lines appear at each of so many equal parts of the work, and no oftener than this:
/// work that takes seconds needs none, work of hours has ten.
const PARTS: u64 = 10;
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);

/// How far the work is; may be told from any thread.
#[derive(Debug)]
pub(crate) struct Progress {
    what: &'static str,
    total: u64,
    done: AtomicU64,
    rays: AtomicU64,
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
    /// Work counted in rays.
    pub(crate) fn of_rays(what: &'static str, total: u64) -> Self {
        let display = if io::stderr().is_terminal() {
            Display::Bar(bar(what, total))
        } else {
            Display::Lines(Mutex::new((Instant::now(), 0)))
        };
        let counter = AtomicU64::new(0);
        Self { what, total, done: counter, rays: AtomicU64::new(0), start: Instant::now(), display }
    }

    /// Shows nothing.
    pub(crate) fn silent() -> Self {
        Self { display: Display::Silent, ..Self::of_rays("", 0) }
    }

    /// `count` more rays are traced.
    pub(crate) fn add(&self, count: u64) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        match &self.display {
            Display::Silent => {}
            Display::Bar(bar) => bar.inc(count),
            Display::Lines(last) => self.maybe_line(last, done),
        }
    }

    /// The work is done: the bar goes, the lines stay.
    pub(crate) fn finish(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn maybe_line(&self, last: &Mutex<(Instant, u64)>, done: u64) {
        let part = done.saturating_mul(PARTS) / self.total.max(1);
        // Another thread is writing a line just now: this one is not needed.
        let Ok(mut last) = last.try_lock() else { return };
        let finished = done >= self.total; // the summary says so
        if part > last.1 && last.0.elapsed() >= PLAIN_INTERVAL && !finished {
            *last = (Instant::now(), part);
            console::say(&self.line(done));
        }
    }

    fn line(&self, done: u64) -> String {
        let elapsed = self.start.elapsed().as_secs_f64();
        let share = done as f64 / self.total as f64;
        let left = elapsed / share - elapsed;
        format!(
            "{}: {:.0} %, {:.3} Mrays/s, {} left",
            self.what,
            100.0 * share,
            done as f64 / elapsed * 1e-6,
            duration(left)
        )
    }
}

fn bar(what: &'static str, total: u64) -> ProgressBar {
    let template = "{msg} {wide_bar} {percent:>3} % {rate} ETA {eta}";
    let style = ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let _ = write!(text, "{:.3} Mrays/s", state.per_sec() * 1e-6);
        });
    ProgressBar::new(total).with_style(style).with_message(what)
}

/// Seconds as people say them: `7 s`, `3 min 20 s`, `2 h 5 min`.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    let mut text = String::new();
    let _ = match whole {
        0..60 => write!(text, "{whole} s"),
        60..3600 => write!(text, "{} min {} s", whole / 60, whole % 60),
        _ => write!(text, "{} h {} min", whole / 3600, whole / 60 % 60),
    };
    text
}
