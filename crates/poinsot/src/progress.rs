//! Progress of a verb: events of `tracing` under one target. Without a listener they cost a comparison.

/// One of a number of steps is done; `total` 0 where the number is not known.
pub(crate) fn step(stage: &str, done: usize, total: usize) {
    tracing::info!(
        target: "poinsot::progress",
        stage = stage,
        done = done as u64,
        total = total as u64
    );
}
