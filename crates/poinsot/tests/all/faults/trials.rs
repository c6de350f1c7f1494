//! A fault on a vehicle, in many trials: how often it is noticed and named.
//!
//! The chi-square that a fault leaves in a fit to samples without noise is its squared effect on the predictions,
//! projected clear of all fitted numbers. The smallest size detectable at five sigma reaches the chance of five sigma in
//! half of the records, with the numbers of its hypothesis and the times at which it is tried: 25 for one number. A
//! trial of drawn size draws it between once and ten times that, each as likely.

use crate::tables::processor_s;
use poinsot::bind::bind;
use poinsot::case::parse_case;
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{
    Diagnostics, Estimate, FaultKind, Modes, Settings, Suspect, maximum_likelihood_with,
};
use poinsot_model::{Model, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Table, check_conventions};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Chance of a deviation of five sigma, to either side.
const FIVE_SIGMA: f64 = 5.733e-7;
/// Chi-square from which the numbers of a hypothesis are sure to be printed.
const PLAIN: f64 = 400.0;
/// Largest size, relative to the smallest detectable one.
const LARGEST: f64 = 10.0;
/// Rate of a satellite's record, 1/s.
const RATE_HZ: f64 = 10.0;
/// Samples kept of a record at 50 Hz.
const STRIDE: usize = 5;

/// Vehicle of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Craft {
    /// One rigid body with three wheels and thrusters, 80 s.
    Satellite,
    /// The same, simulated at 50 Hz and thinned after the fault is planted.
    Fine,
    /// A base with a two-link arm and three wheels, 80 s.
    Arm,
    /// Four wheels in a pyramid, 900 s.
    LowOrbit,
    /// A pendulum in the truth, one rigid body in the model.
    Pendulum,
    /// A panel on a soft hinge in the truth, one rigid body in the model.
    Panel,
}

impl Craft {
    pub fn words(self) -> &'static str {
        match self {
            Self::Satellite | Self::Fine => "satellite",
            Self::Arm => "two-link arm",
            Self::LowOrbit => "low orbit",
            Self::Pendulum => "sloshing satellite",
            Self::Panel => "satellite with a panel",
        }
    }

    pub fn path(self) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join(match self {
            Self::Satellite | Self::Fine => "../../data/cases/faults.toml",
            Self::Arm => "tests/all/faults/cases/two_link_arm.toml",
            Self::LowOrbit => "tests/all/faults/cases/low_orbit.toml",
            Self::Pendulum => "../../data/cases/slosh.toml",
            Self::Panel => "../../data/cases/hinged_panel.toml",
        })
    }

    /// The experiment with a modified true vehicle; `from` is replaced by `to` in the case.
    fn study(self, change: impl Fn(&mut Model), (from, to): (&str, &str)) -> Study {
        let path = self.path();
        let text = std::fs::read_to_string(&path).unwrap();
        let mut case = parse_case(&path, text.replace(from, to)).unwrap();
        if self == Self::Satellite {
            case.rate_hz = RATE_HZ;
        }
        let mut truth = read_model(&case.model).unwrap();
        let model = match self {
            Self::Pendulum | Self::Panel => {
                read_model(path.with_file_name("rigid_bus.toml")).unwrap()
            }
            _ => off_nominal(truth.clone()),
        };
        change(&mut truth);
        Study::of_case(&case, &truth, model).unwrap()
    }
}

/// Errors of a few percent in what is estimated.
pub fn off_nominal(mut model: Model) -> Model {
    for body in &mut model.bodies {
        let asked = body.estimate;
        if asked.inertia {
            body.nominal.I_BBcm_B *= 0.93;
        }
        if asked.mass {
            body.nominal.mass *= 1.05;
        }
        if asked.com {
            body.nominal.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
        }
    }
    model
}

/// How a fault is introduced.
#[derive(Clone, Copy)]
pub enum Way {
    Nothing,
    /// In the true vehicle.
    Vehicle(fn(&mut Model, f64)),
    /// In the ideal measurements.
    Exact(fn(&mut Table, f64)),
    /// In the noisy measurements; of a fixed size.
    Read(fn(&mut Table, f64, &mut ChaCha8Rng)),
    /// In the ideal measurements, or in the sensors.
    Study(fn(&mut Study, f64)),
    /// The second half has the motion of another initial state.
    Joined,
    /// A wheel that stores momentum.
    Stored,
}

pub struct Fault {
    pub words: &'static str,
    pub craft: Craft,
    /// Correct names; empty if no alarm is wanted.
    pub names: &'static [FaultKind],
    /// Text required in the sentence.
    pub culprit: &'static str,
    /// A small size, with its unit; random unless `fixed`.
    pub size: (f64, &'static str),
    pub fixed: bool,
    pub way: Way,
    /// Of 200 trials so many must be named correctly.
    pub least: u64,
}

/// Result of the trials of one fault.
#[derive(Default)]
pub struct Tally {
    /// Smallest size detectable at five sigma.
    pub noticeable: f64,
    pub trials: u64,
    pub noticed: u64,
    /// Named correctly, alone or with causes that the data cannot distinguish; then, alone.
    pub named: u64,
    pub alone: u64,
    /// Another cause was named.
    pub wrong: u64,
    /// Named correctly and all, of at least twice the smallest size.
    pub large: (u64, u64),
    /// Refused, rejected, or with an entry in `doubts`.
    pub doubted: u64,
    pub firsts: BTreeMap<String, usize>,
    /// Mean and largest processor time of a fit with its diagnosis, s; exact with one thread.
    pub seconds: (f64, f64),
}

impl Tally {
    pub const COLUMNS: [&str; 12] = [
        "planted",
        "vehicle",
        "noticeable at 5 sigma",
        "trials",
        "noticed",
        "named rightly",
        "alone",
        "wrongly",
        "rightly from twice the smallest",
        "not trusted",
        "mean, longest s",
        "first named",
    ];

    pub fn cells(&self, fault: &Fault) -> [String; 12] {
        let (size, unit) = fault.size;
        let firsts = self.firsts.iter().map(|(name, n)| format!("{name} {n}"));
        [
            fault.words.to_owned(),
            fault.craft.words().to_owned(),
            match self.noticeable.is_finite() {
                true => format!("{:.2e} {unit}", self.noticeable),
                false => format!("planted: {size} {unit}"),
            },
            self.trials.to_string(),
            self.noticed.to_string(),
            self.named.to_string(),
            self.alone.to_string(),
            self.wrong.to_string(),
            format!("{} of {}", self.large.0, self.large.1),
            self.doubted.to_string(),
            format!("{:.2}, {:.2}", self.seconds.0, self.seconds.1),
            firsts.collect::<Vec<_>>().join(", "),
        ]
    }

    fn add(&mut self, fault: &Fault, trial: &Trial) {
        self.trials += 1;
        self.seconds.0 += trial.seconds;
        self.seconds.1 = self.seconds.1.max(trial.seconds);
        self.doubted += u64::from(trial.doubted);
        let large = fault.fixed || trial.factor >= 2.0;
        self.large.1 += u64::from(large);
        let Some(first) = trial.said.first() else {
            return;
        };
        self.noticed += 1;
        *self.firsts.entry(first.names.join("|")).or_insert(0) += 1;
        let is = |name: &String| fault.names.iter().any(|f| f.name() == name);
        let right = first.names.iter().any(is) && first.text.contains(fault.culprit);
        self.named += u64::from(right);
        self.alone += u64::from(right && first.names.iter().all(is));
        self.large.0 += u64::from(right && large);
        self.wrong += u64::from(!right);
    }
}

/// One finding.
struct Said {
    names: Vec<String>,
    text: String,
}

impl Said {
    fn by(name: &str, text: String) -> Self {
        let names = vec![name.to_owned()];
        Self { names, text }
    }
}

struct Trial {
    /// Size, relative to the smallest detectable one.
    factor: f64,
    said: Vec<Said>,
    doubted: bool,
    seconds: f64,
}

/// Trials of one fault, in parallel.
pub fn tally(fault: &Fault, noticeable: f64, trials: u64) -> Tally {
    let fixed = fault.fixed.then(|| study_at(fault, fault.size.0));
    let run = |number: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(0x000d_4a31);
        rng.set_stream(number);
        let factor = 1.0 + (LARGEST - 1.0) * rng.random::<f64>();
        let drawn = fixed
            .is_none()
            .then(|| study_at(fault, noticeable * factor));
        let study = fixed.as_ref().or(drawn.as_ref()).unwrap();
        let (mut tables, _) = study.draw(number);
        if let Way::Read(plant) = fault.way {
            let tables = tables.iter_mut();
            tables.for_each(|t| plant(t, fault.size.0, &mut rng));
        }
        let start = processor_s();
        let (said, doubted) = diagnosed(&study.model, &tables);
        Trial {
            factor,
            said,
            doubted,
            seconds: processor_s() - start,
        }
    };
    let all: Vec<Trial> = (0..trials).into_par_iter().map(run).collect();
    let mut tally = Tally {
        noticeable,
        ..Tally::default()
    };
    all.iter().for_each(|trial| tally.add(fault, trial));
    tally.seconds.0 /= trials as f64;
    tally
}

/// Findings reported to a user, on reading or by the diagnosis, and whether the answer is marked unreliable.
fn diagnosed(model: &Model, tables: &[Table]) -> (Vec<Said>, bool) {
    if let Some(refusal) = tables.iter().find_map(|t| check_conventions(t).err()) {
        let text = refusal.to_string();
        // The check names the convention that fits best.
        let name = match text.contains("deg/s") {
            true => FaultKind::Units.name(),
            false => "conventions",
        };
        return (vec![Said::by(name, text)], true);
    }
    let estimate = match fit(model, tables) {
        Ok(estimate) => estimate,
        Err(error) => return (vec![Said::by("error", error)], true),
    };
    let doubted = !estimate.passes();
    let found = estimate.diagnostics.map(|d| d.findings).unwrap_or_default();
    let name = |f: &FaultKind| f.name().to_owned();
    let said = found.into_iter().map(|f| Said {
        names: std::iter::once(&f.fault).chain(&f.or).map(name).collect(),
        text: f.text,
    });
    (said.collect(), doubted)
}

/// Modes are searched but on the vehicles that have one, which are to be named as not rigid.
fn fit(model: &Model, tables: &[Table]) -> Result<Estimate, String> {
    let flexible = model.name == "satellite, rigid";
    let settings = Settings {
        modes: if flexible { Modes::None } else { Modes::Found },
        ..Settings::default()
    };
    let tree = Tree::new(model);
    let bound = bind(model, &tree, tables).map_err(|e| e.to_string())?;
    maximum_likelihood_with(&bound.problem(model, &tree), settings).map_err(|e| e.to_string())
}

/// The smallest size detectable at five sigma; not a number for one that no noise-free sample shows.
pub fn noticeable(fault: &Fault) -> f64 {
    let (small, _) = fault.size;
    if matches!(fault.way, Way::Read(_)) || fault.names.is_empty() {
        return f64::NAN;
    }
    let left = |size: f64| -> Diagnostics {
        let study = study_at(fault, size);
        let estimate = fit(&study.model, &study.exact).unwrap();
        estimate.diagnostics.unwrap_or_default()
    };
    let chi2 = left(small).chi2;
    let plain = left(small * (PLAIN / chi2).sqrt());
    let is = |s: &&Suspect| fault.names.contains(&s.fault) && s.name.contains(fault.culprit);
    let own = plain.suspects.iter().find(is);
    let (numbers, times) = own.map_or((1, 1), |s| (s.numbers, s.times));
    small * (detectable(numbers, times) / chi2).sqrt()
}

/// Chi-square without noise of a fault that reaches the chance of five sigma in half of the records.
fn detectable(numbers: usize, times: usize) -> f64 {
    let numbers = numbers as f64;
    let chi2 = ChiSquared::new(numbers).map(|c| c.inverse_cdf(1.0 - FIVE_SIGMA / times as f64));
    // Noise adds the degrees of freedom less one to the median, nearly.
    chi2.map_or(f64::NAN, |chi2| chi2 - (numbers - 1.0))
}

/// The experiment with a fault of this size, unless it is planted in noisy measurements.
fn study_at(fault: &Fault, size: f64) -> Study {
    let of = |change: &dyn Fn(&mut Model), replace| fault.craft.study(change, replace);
    let (plain, same) = (|_: &mut Model| {}, ("", ""));
    let mut study = match fault.way {
        Way::Vehicle(change) if size != 0.0 => of(&|m| change(m, size), same),
        Way::Stored => {
            let fast = "speed_rad_s = [500.0, 380.0, 560.0, 640.0, 500.0]";
            of(
                &plain,
                ("speed_rad_s = [0.0, -120.0, 60.0, 140.0, 0.0]", fast),
            )
        }
        _ => of(&plain, same),
    };
    match fault.way {
        Way::Exact(change) if size != 0.0 => study.exact.iter_mut().for_each(|t| change(t, size)),
        Way::Study(change) => change(&mut study, size),
        Way::Joined => {
            let start = format!("omega_rad_s = [{}, -0.015, 0.02]", 0.01 + size);
            let second = of(
                &plain,
                ("omega_rad_s = [0.01, -0.015, 0.02]", start.as_str()),
            );
            join(&mut study.exact, &second.exact);
        }
        _ => {}
    }
    if fault.craft == Craft::Fine {
        study.exact.iter_mut().for_each(thin);
    }
    study
}

/// Replaces the second half of every channel.
fn join(first: &mut [Table], second: &[Table]) {
    for (table, second) in first.iter_mut().zip(second) {
        for (channel, new) in table.channels.iter_mut().zip(&second.channels) {
            let half = channel.values.len() / 2;
            channel.values[half..].copy_from_slice(&new.values[half..]);
        }
    }
}

/// Fast channels at a fifth of their rate, on the times of the first of them; one that is late lacks a sample.
fn thin(table: &mut Table) {
    let fast = table.channels.iter().map(|c| c.time_s.len()).max().unwrap();
    let whole = table.channels.iter().find(|c| c.time_s.len() == fast);
    let times = whole.unwrap().time_s.iter().copied();
    let grid: Vec<f64> = times.skip(STRIDE).step_by(STRIDE).collect();
    let kept = |t: f64| {
        let at = grid.partition_point(|g| *g < t - 1.0e-6);
        grid.get(at).is_some_and(|g| (g - t).abs() < 1.0e-6)
    };
    let all = table.channels.iter_mut();
    for channel in all.filter(|c| c.time_s.len() + 1 >= fast) {
        let samples = channel.time_s.iter().zip(&channel.values);
        let (time_s, values): (Vec<f64>, Vec<f64>) = samples.filter(|(t, _)| kept(**t)).unzip();
        channel.time_s = Arc::from(time_s);
        channel.values = values;
    }
}
