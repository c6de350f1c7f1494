//! Tests whether unmodelled slosh or flexibility is detected.
//!
//!     cargo run --release -p poinsot --example hidden_oscillator -- [TRIALS [JOINT MASS_KG|locked]]
//!
//! The true vehicle has a pendulum, or a panel on a hinge, with spring and damper; the model does not. Each trial
//! draws new sensor noise. A trial counts as detected if the answer is rejected, its covariance is marked unreliable,
//! and the reported line is within 5 % of the hidden joint's frequency in the exact motion. In the last rows the hinge
//! is locked, and nothing may be reported.

use poinsot::case::{Case, read_case};
use poinsot::simulate::{SimulateError, simulate_case};
use poinsot::trials::Study;
use poinsot::{Question, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{Model, read_model};
use rayon::prelude::*;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Case, hidden joint, and masses of the moving body, kg.
const HIDDEN: [(&str, &str, &[f64]); 2] = [
    ("slosh.toml", "slosh", &[0.75, 1.5, 3.0, 6.0]),
    ("hinged_panel.toml", "hinge", &[1.0, 2.0, 4.0]),
];

/// Result of the trials of one set-up.
#[derive(Default)]
struct Count {
    rejected: usize,
    untrustworthy: usize,
    line: usize,
    detected: usize,
    silent: usize,
    /// Sum over the trials.
    chi2: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let trials = match words.first() {
        Some(n) => n.parse()?,
        None => 100,
    };
    let wanted = |joint: &str, mass: &str| match &words[1.min(words.len())..] {
        [] => true,
        [own] => own == joint,
        [own, only, ..] => own == joint && only == mass,
    };
    println!(
        "{trials} trials each; line: within 5 % of the frequency of the hidden joint; silent: converged, trustworthy"
    );
    println!(
        "case                 swings     of mass  frequency  chi2/dof  rejected  untrustworthy  line  detected  silent"
    );
    for (name, joint, masses) in HIDDEN {
        for mass in masses.iter().filter(|m| wanted(joint, &m.to_string())) {
            row(name, joint, Some(*mass), trials)?;
        }
        if wanted(joint, "locked") {
            row(name, joint, None, trials)?;
        }
    }
    Ok(())
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases")
}

/// One set-up; without a mass the hinge is locked.
fn row(name: &str, joint: &str, mass: Option<f64>, trials: u64) -> Result<(), Box<dyn Error>> {
    let case = read_case(&folder().join(name)).map_err(SimulateError::from)?;
    let mut truth = read_model(&case.model)?;
    let at = truth.joint(joint).ok_or("no such joint")?;
    let child = truth.joints[at].child;
    if let Some(mass) = mass {
        let body = &mut truth.bodies[child].nominal;
        // Equal shape and stiffness per mass: equal frequency, smaller effect.
        let factor = mass / body.mass;
        body.mass = mass;
        body.I_BBcm_B *= factor;
        if let Some(spring) = &mut truth.joints[at].spring_damper {
            spring.stiffness *= factor;
            spring.damping *= factor;
        }
    } else {
        truth.joints[at].spring_damper = None;
    }
    let whole: f64 = truth.bodies.iter().map(|b| b.nominal.mass).sum();
    let share = truth.bodies[child].nominal.mass / whole;
    let frequency = match mass {
        Some(_) => Some(swing(&case, &truth, joint)?),
        None => None,
    };
    let count = run(&case, &truth, frequency, trials)?;
    let hz = frequency.map_or("locked".to_owned(), |f| format!("{f:.3} Hz"));
    println!(
        "{name:<20} {joint:<8} {:>8.2} %  {hz:>9}  {:>8.2}  {:>8}  {:>13}  {:>4}  {:>8}  {:>6}",
        100.0 * share,
        count.chi2 / trials as f64,
        count.rejected,
        count.untrustworthy,
        count.line,
        count.detected,
        count.silent
    );
    Ok(())
}

/// Frequency of the joint in the exact motion after the last torque, from its crossings of the mean, Hz.
fn swing(case: &Case, truth: &Model, joint: &str) -> Result<f64, Box<dyn Error>> {
    let mut exact = truth.clone();
    exact.sensors.clear();
    let text = std::fs::read_to_string(case.path())?.replace("sensors_only = true", "");
    let case = poinsot::case::parse_case(case.path(), text).map_err(SimulateError::from)?;
    let table = simulate_case(&case, &exact)?.table;
    let angle = table.channel(&format!("{joint}_rad")).ok_or("no angle")?;
    let free: Vec<(f64, f64)> = angle
        .time_s
        .iter()
        .zip(&angle.values)
        .map(|(t, q)| (*t, *q))
        .filter(|(t, _)| *t > 176.0)
        .collect();
    let mean = free.iter().map(|(_, q)| q).sum::<f64>() / free.len() as f64;
    let crossings: Vec<f64> = free
        .windows(2)
        .filter(|w| w[0].1 < mean && w[1].1 >= mean)
        .map(|w| w[0].0 + (w[1].0 - w[0].0) * (mean - w[0].1) / (w[1].1 - w[0].1))
        .collect();
    match crossings.as_slice() {
        [first, .., last] => Ok((crossings.len() - 1) as f64 / (last - first)),
        _ => Err("the joint does not swing".into()),
    }
}

fn run(
    case: &Case,
    truth: &Model,
    frequency: Option<f64>,
    trials: u64,
) -> Result<Count, Box<dyn Error>> {
    let model = read_model(folder().join("rigid_bus.toml"))?;
    let study = Study::of_case(case, truth, model.clone())?;
    let request = Question::default();
    let answers: Result<Vec<_>, _> = (0..trials)
        .into_par_iter()
        .map(|trial| identify_tables(model.clone(), study.draw(trial).0, &request))
        .collect();
    let mut count = Count::default();
    for answer in answers? {
        let e = answer.estimate;
        let lines = e.warnings.iter().filter_map(|w| line(w));
        let near = |hz: f64| frequency.is_none_or(|f| (hz / f - 1.0).abs() < 0.05);
        let found = lines.into_iter().any(near);
        let rejected = e.status == Status::Rejected;
        count.rejected += usize::from(rejected);
        count.untrustworthy += usize::from(!e.covariance_trustworthy());
        count.line += usize::from(found);
        count.detected += usize::from(rejected && !e.covariance_trustworthy() && found);
        count.silent += usize::from(e.status == Status::Converged && e.covariance_trustworthy());
        count.chi2 += e.fit.first().map_or(f64::NAN, |f| f.chi2_per_dof);
    }
    Ok(count)
}

/// The frequency named in a warning, Hz.
fn line(warning: &str) -> Option<f64> {
    let rest = warning.split("a line at ").nth(1)?;
    rest.split(' ').next()?.parse().ok()
}
