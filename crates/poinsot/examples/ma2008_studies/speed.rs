//! Trials per second of both steps on one core, beside a NumPy program that prints its own.

use crate::setup::{Experiment, Run, readings};
use poinsot_papers::ma2008::Trials;
use std::process::Command;
use std::time::Instant;

/// Prints trials per second; `numpy` is the Python interpreter and the script of the peer.
pub fn run(numpy: Option<(&str, &str)>) {
    let experiment = Experiment::new(1, [0.0, 0.0, 5.0]);
    let Run { raws, known, .. } = experiment.run();
    let samples = readings(&experiment.model, &raws);
    let peer = numpy.and_then(|(python, script)| peer(python, script));
    for (name, option) in [("option 1", Some(known)), ("option 2", None)] {
        let trials = Trials::new(&samples, option, [1.0e-4; 3], [1.0e-4; 3]);
        let mut best = f64::INFINITY;
        let mut sum = 0.0;
        let groups = 2_000;
        for round in 0..100 {
            let start = Instant::now();
            trials.run(1, round * groups..(round + 1) * groups, |r| {
                sum += r[0].iter().sum::<f64>() / 8.0
            });
            best = best.min(start.elapsed().as_secs_f64());
        }
        let rate = 8.0 * groups as f64 / best;
        let ratio = peer.map_or_else(String::new, |p| {
            format!(", {:.1} times NumPy's {p:.0}", rate / p)
        });
        println!(
            "{name}: {rate:.0} trials/s on one core{ratio} (mean mass {:.1} kg)",
            sum / (100.0 * groups as f64)
        );
    }
}

/// The best vectorised rate that the peer prints.
fn peer(python: &str, script: &str) -> Option<f64> {
    let out = Command::new(python)
        .arg(script)
        .env("OPENBLAS_NUM_THREADS", "1")
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    text.lines()
        .filter(|l| l.contains("mc_two_step_vectorised"))
        .filter_map(|l| l.split(',').nth(2)?.parse::<f64>().ok())
        .fold(None, |best, x| Some(best.map_or(x, |b: f64| b.max(x))))
}
