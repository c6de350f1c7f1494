//! Progress bar on standard error, with the remaining time, for work longer than two seconds; only on a
//! terminal. Library crates report progress as `tracing` events of one target.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// `tracing` target of progress events.
const TARGET: &str = "poinsot::progress";
/// Delay before the bar appears.
const PATIENCE: Duration = Duration::from_secs(2);

/// The progress bar, or nothing without a terminal.
pub struct Progress {
    bar: Option<ProgressBar>,
    done: Arc<AtomicBool>,
}

impl Progress {
    /// Starts to listen for progress events.
    pub fn start(quiet: bool) -> Self {
        let done = Arc::new(AtomicBool::new(false));
        if quiet || !std::io::stderr().is_terminal() {
            return Self { bar: None, done };
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_style(open());
        bar.set_message("working");
        let listener = Listener { bar: bar.clone() };
        if tracing::subscriber::set_global_default(listener).is_err() {
            return Self { bar: None, done };
        }
        let (shown, over) = (bar.clone(), done.clone());
        // Without the thread no bar is shown.
        let _ = std::thread::Builder::new().spawn(move || {
            std::thread::sleep(PATIENCE);
            if !over.load(Ordering::Acquire) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(Duration::from_millis(120));
            }
        });
        Self {
            bar: Some(bar),
            done,
        }
    }

    /// Removes the bar from the screen.
    pub fn clear(&self) {
        self.done.store(true, Ordering::Release);
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("━╸─")
}

/// Style of a bar without a known total.
fn open() -> ProgressStyle {
    style("{spinner} {msg}, {elapsed}")
}

/// Style of a bar with a known total, or with an upper bound of it.
fn closed(bound: bool) -> ProgressStyle {
    style(if bound {
        "{spinner} {msg} {pos} of at most {len} {bar:24} at most {eta} left"
    } else {
        "{spinner} {msg} {pos} of {len} {bar:24} {eta} left"
    })
}

/// One progress event.
#[derive(Default)]
struct Step {
    stage: String,
    done: u64,
    total: u64,
    bound: bool,
}

impl Visit for Step {
    fn record_str(&mut self, field: &Field, value: &str) {
        if field.name() == "stage" {
            self.stage = value.chars().filter(|c| !c.is_control()).collect();
        }
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        match field.name() {
            "done" => self.done = value,
            "total" => self.total = value,
            _ => {}
        }
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        if field.name() == "at_most" {
            self.bound = value;
        }
    }

    fn record_debug(&mut self, _: &Field, _: &dyn std::fmt::Debug) {}
}

struct Listener {
    bar: ProgressBar,
}

impl Subscriber for Listener {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && metadata.target() == TARGET
    }

    fn event(&self, event: &Event<'_>) {
        let mut step = Step::default();
        event.record(&mut step);
        if self.bar.message() != step.stage {
            self.bar.reset();
            self.bar.set_message(step.stage);
            if step.total > 0 {
                self.bar.set_style(closed(step.bound));
            } else {
                self.bar.set_style(open());
            }
        }
        self.bar.set_length(step.total.max(1));
        self.bar.set_position(step.done);
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}
