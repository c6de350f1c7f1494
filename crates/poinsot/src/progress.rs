//! Progress of a command as `tracing` events of one target; negligible cost without a listener.

use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// Target of the events. The macro below and the library crates repeat it, because it must be a literal there.
const TARGET: &str = "poinsot::progress";

/// Stage of the trials of a campaign; what happens within a trial has its own stages.
pub const TRIALS: &str = "trials";

/// Reports one finished step; `total` is 0 if unknown.
pub(crate) fn step(stage: &str, done: usize, total: usize) {
    tracing::info!(
        target: "poinsot::progress",
        stage = stage,
        done = done as u64,
        total = total as u64
    );
}

/// One step of a command.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Step {
    /// What is done, without control characters.
    pub stage: String,
    /// Steps done.
    pub done: u64,
    /// All steps; 0 if unknown.
    pub total: u64,
    /// Whether `total` is an upper bound.
    pub at_most: bool,
}

/// Listens for progress: a subscriber that calls the function with every step.
pub struct Listener<F>(pub F);

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
            self.at_most = value;
        }
    }

    fn record_debug(&mut self, _: &Field, _: &dyn std::fmt::Debug) {}
}

impl<F: Fn(Step) + Send + Sync + 'static> Subscriber for Listener<F> {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && metadata.target() == TARGET
    }

    fn event(&self, event: &Event<'_>) {
        let mut step = Step::default();
        event.record(&mut step);
        (self.0)(step);
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}
