//! Least time of many short batches, in time of this thread on the processor: other users of the machine
//! disturb the least of it least.

use rustix::time::{ClockId, clock_gettime};

/// Batches per kernel and calls per batch.
const BATCHES: usize = 1000;
const CALLS: usize = 1024;

/// Time of this thread on the processor, s.
pub fn processor_seconds() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Prints least and median time of one call, or runs `POINSOT_BENCH_COUNT=<name>:<calls>` alone.
pub fn measure(name: &str, kernel: impl FnMut()) {
    timed(name, CALLS, 1, kernel);
}

/// The same for a call over many states: time of one state.
pub fn measure_batch(name: &str, states: usize, kernel: impl FnMut()) {
    timed(name, 1, states, kernel);
}

fn timed(name: &str, calls_per_batch: usize, states: usize, mut kernel: impl FnMut()) {
    if let Ok(count) = std::env::var("POINSOT_BENCH_COUNT") {
        if let Some((wanted, calls)) = count.split_once(':')
            && wanted == name
        {
            for _ in 0..calls.parse().unwrap_or(0) {
                kernel();
            }
        }
        return;
    }
    let mut times: Vec<f64> = (0..BATCHES)
        .map(|_| {
            let start = processor_seconds();
            for _ in 0..calls_per_batch {
                kernel();
            }
            (processor_seconds() - start) / (calls_per_batch * states) as f64 * 1e9
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("poinsot_{name},{:.1},ns_min", times[0]);
    println!("poinsot_{name},{:.1},ns_median", times[BATCHES / 2]);
}
