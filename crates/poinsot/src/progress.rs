//! Progress of a command as `tracing` events of one target; negligible cost without a listener.

/// Reports one finished step; `total` is 0 if unknown.
pub(crate) fn step(stage: &str, done: usize, total: usize) {
    tracing::info!(
        target: "poinsot::progress",
        stage = stage,
        done = done as u64,
        total = total as u64
    );
}
