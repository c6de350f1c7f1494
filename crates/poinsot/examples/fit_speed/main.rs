//! Time of a fit: compared with MuJoCo's toolbox on its own problem, and over the number of samples.
//!
//!     cargo run --release -p poinsot --example fit_speed -- payload telemetry.csv
//!     cargo run --release -p poinsot --example fit_speed -- growth 100000
//!
//! Prints `name,value,unit`. `scripts/bench-fit` runs both with MuJoCo.
#![allow(non_snake_case)]

use poinsot::bind::bind;
use poinsot::case::read_case;
use poinsot::identify::read_options;
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{Estimate, Settings, maximum_likelihood_with, tensor_index};
use poinsot_model::{Model, read_model};
use poinsot_telemetry::{Table, read};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Mass, mass centre, xx yy zz xy xz yz of the payload (`benches/peers/mujoco_sysid.py`).
const PAYLOAD: [f64; 10] = [60.0, 0.20, 0.05, -0.08, 6.0, 7.0, 8.0, 0.3, -0.2, 0.4];
/// Number of fits; the fastest counts, and CPU time is averaged.
const FITS: usize = 10;
/// Elements of a tensor in the order of `PAYLOAD`.
const ORDER: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["payload", telemetry] => payload(Path::new(telemetry)),
        ["growth", samples] => growth(samples.parse()?),
        _ => Err("known are: payload TELEMETRY.csv, growth SAMPLES".into()),
    }
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// From samples in memory to the estimate: binding, linear start if possible, fit, and diagnosis unless it is a trial.
fn estimate(
    model: &Model,
    tables: &[Table],
    trial: bool,
) -> Result<(Estimate, f64), Box<dyn Error>> {
    let began = Instant::now();
    let tree = Tree::new(model);
    let bound = bind(model, &tree, tables)?;
    let problem = bound.problem(model, &tree);
    let options = Settings {
        undiagnosed: trial,
        ..Settings::default()
    };
    let estimate = maximum_likelihood_with(&problem, options)?;
    Ok((estimate, began.elapsed().as_secs_f64()))
}

fn payload(telemetry: &Path) -> Result<(), Box<dyn Error>> {
    let model = read_model(repository().join("benches/peers/payload.toml"))?;
    let options = read_options(&model, &model.telemetry, false, false);
    let tables = [read(&[telemetry], &options)?];
    let mut seconds = f64::INFINITY;
    let mut answer = None;
    for (what, trial) in [("_trial", true), ("", false)] {
        let before = processor();
        seconds = f64::INFINITY;
        for _ in 0..FITS {
            let (estimate, once) = estimate(&model, &tables, trial)?;
            seconds = seconds.min(once);
            answer = Some(estimate);
        }
        if let (Some(before), Some(after)) = (before, processor()) {
            let each = (after - before) / FITS as f64;
            println!("poinsot_payload{what}_processor,{each:.4},s");
        }
    }
    let answer = answer.ok_or("no answer")?;
    let body = answer.bodies.last().ok_or("no body")?;
    let numbers: Option<Vec<f64>> = std::iter::once(body.mass.value)
        .chain(body.com.iter().map(|n| n.value))
        .chain(ORDER.map(|e| body.inertia[tensor_index(e)].value))
        .collect();
    println!("poinsot_payload,{seconds:.4},s");
    println!("poinsot_payload_iterations,{},1", answer.iterations);
    let Some(x) = numbers else {
        println!("poinsot_payload_status,{},word", answer.status.name());
        return Ok(());
    };
    let relative = |k: usize| 100.0 * (x[k] / PAYLOAD[k] - 1.0).abs();
    let com: f64 = (1..4).map(|k| (x[k] - PAYLOAD[k]).powi(2)).sum::<f64>();
    let worst = |range: std::ops::Range<usize>| range.map(relative).fold(0.0, f64::max);
    println!("poinsot_payload_mass_error,{:.4},%", relative(0));
    println!("poinsot_payload_com_error,{:.3},mm", 1.0e3 * com.sqrt());
    println!("poinsot_payload_moments_error,{:.3},%", worst(4..7));
    println!("poinsot_payload_products_error,{:.2},%", worst(7..10));
    Ok(())
}

/// The experiment of `data/cases/faults.toml` with this number of gyro samples.
fn growth(samples: usize) -> Result<(), Box<dyn Error>> {
    let path = repository().join("data/cases/faults.toml");
    let mut case = read_case(&path)?;
    case.rate_hz = samples as f64 / case.duration_s;
    let truth = read_model(&case.model)?;
    let study = Study::of_case(&case, &truth, truth.clone())?;
    let (tables, _) = study.draw(0);
    drop(study.exact);
    let before = memory("VmRSS");
    let busy = processor();
    let (estimate, seconds) = estimate(&truth, &tables, false)?;
    println!("poinsot_growth_{samples},{seconds:.4},s");
    if let (Some(busy), Some(after)) = (busy, processor()) {
        println!("poinsot_growth_{samples}_processor,{:.2},s", after - busy);
    }
    println!(
        "poinsot_growth_{samples}_iterations,{},1",
        estimate.iterations
    );
    if let (Some(before), Some(most)) = (before, memory("VmHWM")) {
        println!("poinsot_growth_{samples}_telemetry,{before:.1},MiB");
        println!("poinsot_growth_{samples}_peak,{most:.1},MiB");
    }
    Ok(())
}

/// CPU time of this program so far, all threads, s: `/proc/self/stat` has hundredths.
fn processor() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let after_name = stat.rsplit(')').next()?;
    let mut ticks = after_name.split_whitespace().skip(11);
    let user: f64 = ticks.next()?.parse().ok()?;
    let system: f64 = ticks.next()?.parse().ok()?;
    Some((user + system) / 100.0)
}

/// A value of `/proc/self/status`, MiB.
fn memory(key: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with(key))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}
