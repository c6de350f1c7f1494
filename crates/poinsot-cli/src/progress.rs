//! Progress bar on standard error, with the remaining time, for work longer than two seconds; only on a
//! terminal. Library crates report progress as `tracing` events of one target.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use poinsot::{Listener, Step};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

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
        let drawn = bar.clone();
        let listener = Listener(move |step| draw(&drawn, step));
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
    style("{spinner} {elapsed} {wide_msg}")
}

/// Style of a bar with a known total, or with an upper bound of it.
fn closed(bound: bool) -> ProgressStyle {
    style(if bound {
        "{spinner} {msg} {pos} of at most {len} {bar:24} at most {eta} left"
    } else {
        "{spinner} {msg} {pos} of {len} {bar:24} {eta} left"
    })
}

/// Draws one step.
fn draw(bar: &ProgressBar, step: Step) {
    if step.total == 0 {
        bar.set_style(open());
        bar.set_message(step.stage);
        return;
    }
    if bar.message() != step.stage {
        bar.reset();
        bar.set_message(step.stage);
        bar.set_style(closed(step.at_most));
    }
    bar.set_length(step.total.max(1));
    bar.set_position(step.done);
}
