//! Progress on standard error, for work longer than two seconds; only on a terminal, and never while the program waits for a
//! person. Library crates report progress as `tracing` events of one target.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use poinsot::{Listener, Step, TRIALS};
use std::io::IsTerminal;
use std::sync::{Mutex, OnceLock, PoisonError};
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
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
        bar.set_style(style);
    }
    bar.set_message("working");
    let (drawn, shown) = (bar.clone(), Mutex::new(Shown::default()));
    let listener = Listener(move |step| {
        let mut shown = shown.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(line) = shown.line(step, drawn.elapsed()) {
            drawn.set_message(line);
        }
    });
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

/// The step that is shown.
#[derive(Default)]
struct Shown {
    step: Step,
    /// Steps done when the stage was first reported, and the time, since the start.
    first: (u64, Duration),
}

impl Shown {
    /// The line after a step at a time since the start; none for a step within a trial, or one that was overtaken.
    fn line(&mut self, step: Step, now: Duration) -> Option<String> {
        let last = &self.step;
        let counted = last.stage == TRIALS && last.done < last.total;
        let same = last.stage == step.stage && last.total == step.total && last.done < last.total;
        if counted && !(same && last.done < step.done) {
            return None;
        }
        if !same {
            self.first = (step.done, now);
        }
        let mut line = match (step.total, step.at_most) {
            (0, _) => step.stage.clone(),
            (total, true) => format!("{} {} of at most {total}", step.stage, step.done),
            (total, false) => format!("{} {} of {total}", step.stage, step.done),
        };
        let taken = step.done.saturating_sub(self.first.0);
        // The time of one step is no measure, and how many of "at most" will be needed is not known.
        if taken > 0 && step.done > 1 && step.done < step.total && !step.at_most {
            let steps = (step.total - step.done) as f64 / taken as f64;
            let left = steps * now.saturating_sub(self.first.1).as_secs_f64();
            let left = Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX);
            line += &format!(", {} left", HumanDuration(left));
        }
        self.step = step;
        Some(line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of events (stage, done, total, whether total is a bound), one a second; `None` leaves the line as it is.
    fn lines(events: &[(&str, u64, u64, bool)]) -> Vec<Option<String>> {
        let mut shown = Shown::default();
        let line = |(k, &(stage, done, total, at_most)): (u64, &(&str, u64, u64, bool))| {
            let stage = stage.to_owned();
            let step = Step {
                stage,
                done,
                total,
                at_most,
            };
            shown.line(step, Duration::from_secs(k))
        };
        (0..).zip(events).map(line).collect()
    }

    fn some(line: &str) -> Option<String> {
        Some(line.to_owned())
    }

    #[test]
    fn unit_a_bound_gives_no_estimate_and_the_diagnosis_is_a_stage() {
        let found = lines(&[
            ("reading segments", 0, 1, false),
            ("preparing", 0, 0, false),
            ("fitting, iteration", 1, 60, true),
            ("fitting, iteration", 2, 60, true),
            ("diagnosing", 0, 0, false),
            ("fitting, iteration", 1, 60, true),
        ]);
        let wanted = [
            "reading segments 0 of 1",
            "preparing",
            "fitting, iteration 1 of at most 60",
            "fitting, iteration 2 of at most 60",
            "diagnosing",
            "fitting, iteration 1 of at most 60",
        ];
        assert_eq!(found, wanted.map(some));
    }

    #[test]
    fn unit_steps_within_trials_change_neither_their_count_nor_its_estimate() {
        let found = lines(&[
            ("simulating samples", 1000, 4000, false),
            ("simulating samples", 2000, 4000, false),
            (TRIALS, 0, 4, false),
            ("fitting, iteration", 1, 60, true),
            (TRIALS, 1, 4, false),
            ("diagnosing", 0, 0, false),
            (TRIALS, 3, 4, false),
            (TRIALS, 2, 4, false),
            ("fitting, iteration", 7, 60, true),
            (TRIALS, 4, 4, false),
            (TRIALS, 0, 4, false),
            (TRIALS, 1, 4, false),
        ]);
        let wanted = [
            some("simulating samples 1000 of 4000"),
            some("simulating samples 2000 of 4000, 2 seconds left"),
            some("trials 0 of 4"),
            None,
            some("trials 1 of 4"),
            None,
            // Three in four seconds.
            some("trials 3 of 4, 1 second left"),
            None,
            None,
            some("trials 4 of 4"),
            some("trials 0 of 4"),
            some("trials 1 of 4"),
        ];
        assert_eq!(found, wanted);
    }
}
