//! Diagnosis of a fit that is worse than the declared noise.
//!
//! Each candidate fault is a group of columns that the fit did not have. Its score is the first-order decrease of
//! chi-square with those columns added (score test). The best few are fitted fully. A spectral line in the gyro
//! residual indicates flexing or slosh; large white noise a wrong declaration; few bad samples outliers.

mod candidates;
mod channels;
pub(crate) mod conflict;
mod conventions;
pub(crate) mod deviance;
mod drift;
mod findings;
mod held_out;
mod line;
mod naming;
mod noise_models;
pub(crate) mod octaves;
mod onset;
pub(crate) mod oscillation;
mod projected;
mod pulse;
mod score;
mod shared_noise;
mod suspects;
mod table;
mod types;

pub(crate) use channels::{chi_square, power, whiteness};
pub(crate) use types::{Assumed, COLOURED, Deflection};
pub use types::{
    ChannelDiagnosis, Diagnostics, FaultKind, Finding, HeldOut, MomentumDrift, SensorLag,
    SpectralLine, Suspect, SuspectValue,
};

use crate::fit::Fitted;
use crate::fit::degrees_of_freedom::fitted_numbers;
use crate::fit::experiment::Experiment;
use crate::motion::{Motion, tilted};
use candidates::{assumptions, candidates};
use projected::Projected;
use suspects::{Misfit, Scored};
use table::{Table, WIDTH};

/// Excess of chi-square, in its own standard deviations, below which there is no misfit.
pub(super) const EXCESS: f64 = 6.0;
/// Mean rotation between samples, rad, from which single causes are not fitted: the integration needs too many steps.
const COARSE: f64 = 0.3;
/// Largest number of segments with separate drift tests.
const SEGMENTS: usize = 16;

impl Diagnostics {
    /// Whether chi-square is too large for the declared noise.
    pub(crate) fn is_misfit(&self) -> bool {
        self.excess_sigmas > EXCESS
    }

    /// Whether a convention of the channels explains the misfit.
    pub(crate) fn is_mistaken(&self) -> bool {
        let first = self.suspects.first();
        first.is_some_and(|s| s.repair.is_some() && s.explains >= conventions::EXPLAINS)
    }

    /// Whether the residuals were diagnosed.
    pub(crate) fn is_made(&self) -> bool {
        self.dof > 0 || !self.suspects.is_empty()
    }
}

/// Searches the cause of a misfit. Where the search for the minimum failed, columns there mean nothing, and only a mistake that a
/// fit of its own confirms is a cause.
pub(crate) fn diagnose(experiment: &Experiment, fitted: &Fitted) -> Diagnostics {
    tracing::info!(target: "poinsot::progress", stage = "diagnosing the residuals");
    let chi2 = fitted.chi2();
    let fitted_numbers = fitted_numbers(experiment, fitted);
    let dof = fitted.rows().saturating_sub(fitted_numbers);
    let excess = chi2 - dof as f64;
    let mean_square = (chi2 / dof.max(1) as f64).max(1.0);
    let mut out = Diagnostics {
        chi2,
        dof,
        deviance: crate::diagnosis::deviance::deviance(experiment, fitted),
        excess_sigmas: excess / (2.0 * dof.max(1) as f64).sqrt(),
        channels: channels::channels(fitted),
        ..Diagnostics::default()
    };
    let misfit = out.excess_sigmas > EXCESS;
    let turn = turn_between_readings(experiment);
    let affordable = turn < COARSE;
    let of = Misfit {
        excess,
        dof: dof as f64,
        misfit,
        affordable,
    };
    // A convention that explains chi-square needs no other cause; testing all is slow.
    let mistake = (affordable && misfit)
        .then(|| conventions::conventions(experiment, fitted, (excess, dof as f64)))
        .flatten();
    match mistake {
        Some(mistake) if excess - mistake.decrease < dof as f64 => {
            out.suspects = vec![mistake];
            if fitted.is_found() {
                out.held_out = held_out::held_out(experiment, fitted, None, fitted_numbers);
            }
        }
        mistake if !fitted.is_found() => out.suspects.extend(mistake),
        mistake => {
            let (candidates, held) = candidates(experiment, fitted);
            let table = Table::new(experiment, fitted, &candidates, (!held).then_some(WIDTH));
            let table = table.as_ref();
            let channels = &out.channels;
            let others = noise_models::noise_models(experiment, fitted, channels, table, of);
            out.deflections = deflections(experiment, fitted);
            if let Some(table) = table {
                weighed(table, of, mean_square, &mut out, others);
            }
            put_first(&mut out, mistake, of);
            out.held_out = held_out::held_out(experiment, fitted, table, fitted_numbers);
        }
    }
    if misfit && fitted.is_found() {
        out.lines = line::spectral_lines(experiment, fitted);
    }
    out.findings = findings::findings(&out);
    if misfit && !affordable && fitted.is_found() {
        let text = format!(
            "the vehicle turns by {turn:.1} rad between samples, too much to test causes; are the times in seconds?"
        );
        out.findings
            .push(Finding::new(FaultKind::Unexplained, text));
    }
    out
}

/// Ranks the causes that a table tells of, with others that were scored elsewhere.
fn weighed(
    table: &Table,
    of: Misfit,
    mean_square: f64,
    out: &mut Diagnostics,
    mut others: Vec<Scored>,
) {
    let projected = table.projected(None);
    out.assumed = assumed(table, &projected);
    others.extend(onset::onsets(table, of.misfit));
    out.suspects = suspects::suspects(table, &projected, others, of);
    out.lags = drift::lags(table, &projected, mean_square);
    let drift = |label, projected: &Projected| {
        drift::drift(label, table.candidates, projected, mean_square)
    };
    out.drift.extend(drift(None, &projected));
    let segments = table.experiment.problem.segments;
    if (2..=SEGMENTS).contains(&segments.len()) {
        for (at, segment) in segments.iter().enumerate() {
            let alone = table.projected(Some(at));
            out.drift.extend(drift(Some(segment.label.clone()), &alone));
        }
    }
}

/// A gross error that does not explain all is first, unless another cause does.
fn put_first(out: &mut Diagnostics, mistake: Option<Suspect>, of: Misfit) {
    let converged = |s: &Suspect| !s.fault.is_noise_fault() && of.excess - s.decrease < of.dof;
    if let Some(mistake) = mistake.filter(|_| !out.suspects.first().is_some_and(converged)) {
        // Ties were found relative to the best of the others.
        out.suspects.iter_mut().for_each(|s| s.tied = false);
        out.suspects.insert(0, mistake);
    }
}

/// How the answer moves where an assumption fails.
fn assumed(table: &Table, projected: &Projected) -> Vec<Assumed> {
    let mut list = assumptions(table.experiment.problem, table.candidates);
    // What the samples tell as well is no assumption.
    list.retain(|one| {
        let told = || projected.score(&[one.place], None).covariance[(0, 0)].sqrt() < one.step;
        !one.is_tested || !told()
    });
    let places: Vec<usize> = list.iter().map(|a| a.place).collect();
    let shifts = table.shifts(&places);
    let pairs = list.into_iter().zip(shifts.into_iter().flatten());
    let of = |(assumption, slope): (candidates::Assumption, Vec<f64>)| Assumed {
        what: assumption.what,
        change: assumption.change,
        shift: slope.iter().map(|s| s * assumption.step).collect(),
    };
    pairs.map(of).collect()
}

/// How far the modes move; empty without any, or without a motion.
fn deflections(experiment: &Experiment, fitted: &Fitted) -> Vec<Deflection> {
    let mut all = vec![Deflection::default(); experiment.problem.model.modes.len()];
    let mut instants = 0_u32;
    let (x, setting) = (&fitted.at.x, experiment.setting());
    let tree = tilted(experiment.problem.tree, experiment.parameters, x);
    if all.is_empty() {
        return all;
    }
    for (s, segment) in experiment.problem.segments.iter().enumerate() {
        let vehicle = setting.vehicle(&tree, (s, segment), x);
        let mut state = fitted.at.initial_states[s];
        let mut motion = Motion::new(&vehicle, segment, Vec::new(), 0);
        for k in 0..segment.observations.time_s.len() {
            for (own, y) in all.iter_mut().zip(state.internal.iter().step_by(2)) {
                own.largest = own.largest.max(y.abs());
                own.mean_square += y * y;
            }
            instants += 1;
            match motion.advance(&state, k) {
                Some(next) => state = next,
                None => break,
            }
        }
    }
    all.iter_mut()
        .for_each(|own| own.mean_square /= f64::from(instants.max(1)));
    all
}

/// Mean turn between grid times by the gyro, rad.
fn turn_between_readings(experiment: &Experiment) -> f64 {
    let (mut turn, mut intervals) = (0.0, 0);
    for segment in experiment.problem.segments {
        turn += segment.observations.turned();
        intervals += segment.observations.time_s.len().saturating_sub(1);
    }
    turn / intervals.max(1) as f64
}
