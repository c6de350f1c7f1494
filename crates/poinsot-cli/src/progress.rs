//! Progress on standard error, for work longer than two seconds; only on a terminal, and never while the program waits for a
//! person. Library crates report progress as `tracing` events of one target.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use poinsot::{Listener, Step};
use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::Duration;

/// Delay before the bar appears.
const PATIENCE: Duration = Duration::from_secs(2);

/// The bar, where one is wanted; a process runs one command.
static BAR: OnceLock<ProgressBar> = OnceLock::new();

/// Listens for progress events on a terminal.
pub fn start(quiet: bool) {
    if quiet || !std::io::stderr().is_terminal() {
        return;
    }
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    bar.set_style(open());
    bar.set_message("working");
    let drawn = bar.clone();
    let listener = Listener(move |step| draw(&drawn, step));
    if tracing::subscriber::set_global_default(listener).is_err() {
        return;
    }
    let bar = BAR.get_or_init(|| bar);
    // Without the thread no bar is shown.
    let _ = std::thread::Builder::new().spawn(|| {
        std::thread::sleep(PATIENCE);
        if !bar.is_finished() {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.enable_steady_tick(Duration::from_millis(120));
        }
    });
}

/// Ends the progress, and removes it from the screen.
pub fn clear() {
    BAR.get().iter().for_each(|bar| bar.finish_and_clear());
}

/// Without progress on the screen for the moment, for lines beside it.
pub fn suspended<T>(act: impl FnOnce() -> T) -> T {
    match BAR.get() {
        Some(bar) => bar.suspend(act),
        None => act(),
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
