//! Test of the declared priors against the data alone.
//!
//! With `theta` from prior and data together, chi-square of the priors and what chi-square of the readings would fall
//! by without them are together `d = (a - b)^T (A + B)^-1 (a - b)`, with `a`, `A` of the prior and `b`, `B` of the data
//! alone: chi-square distributed if both are correct. One row of variance one, whose value the answer determines to a
//! variance `s^2`, has a residual of variance `1 - s^2` (a smoothed innovation, Kalman 1960).

use crate::diagnosis::{Diagnostics, diagnose};
use crate::fit::degrees_of_freedom::{Loosened, fitted_numbers};
use crate::fit::experiment::Experiment;
use crate::fit::triangle::SharedTriangle;
use crate::fit::{Fitted, ITERATIONS, fit_from};
use crate::problem::prior::{self, Conflict, Declared, LEAST_SHARE, PriorRow, PriorTest};
use poinsot_model::rounded;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A declared number, its estimate from the data, and their difference in sigmas.
struct Discrepancy {
    declared: Declared,
    value: f64,
    sigma: f64,
    z: f64,
}

/// The tests of all priors, the contradiction that they find, and a diagnosis without the contradicted priors.
#[derive(Default)]
pub(crate) struct PriorsAgainstData {
    pub tests: Vec<PriorTest>,
    pub conflict: Option<Conflict>,
    /// `None` if the first diagnosis holds.
    pub freed: Option<Diagnostics>,
}

pub(crate) fn priors_against_data(
    experiment: &Experiment,
    fitted: &Fitted,
    wanted: bool,
) -> PriorsAgainstData {
    let mut out = PriorsAgainstData::default();
    let all = calibrations(experiment, fitted);
    let (count, largest) = (all.len(), all.iter().map(|a| a.z.abs()).reduce(f64::max));
    let limit = experiment.settings.contradiction_sigmas;
    let mut apart: Vec<Discrepancy> = all.into_iter().filter(|a| a.z.abs() > limit).collect();
    let mut unnamed = false;
    let mut moved = 0.0;
    if let Some((test, square)) = design(experiment, fitted) {
        out.tests.push(test);
        if let Some(square) = square {
            moved = square;
            unnamed = true;
            if let Some((list, diagnostics)) = without_priors(experiment, fitted, wanted) {
                apart.extend(list);
                out.freed = diagnostics;
            }
        }
    }
    let of_calibrations = largest.map(|z| PriorTest::of_largest("calibrations", z, count, limit));
    out.tests.extend(of_calibrations);
    apart.sort_by(|a, b| b.z.abs().total_cmp(&a.z.abs()));
    let text = match (apart.first(), unnamed) {
        (Some(first), _) => said(first, apart.len() - 1),
        (None, false) => return out,
        (None, true) => format!(
            "the priors of mass properties are together inconsistent with the data by more than {} sigma; correct their nominal numbers or sigmas",
            in_words(limit)
        ),
    };
    let ratio = 1.0 + moved;
    out.conflict = Some(Conflict { text, ratio });
    out
}

fn in_words(sigmas: f64) -> String {
    match sigmas == 5.0 {
        true => "five".to_owned(),
        false => sigmas.to_string(),
    }
}

fn said(a: &Discrepancy, more: usize) -> String {
    let Declared {
        name,
        unit,
        nominal,
        sigma,
    } = &a.declared;
    let unit = if *unit == "1" { "" } else { unit };
    let more = match more {
        0 => String::new(),
        1 => "; and one more".to_owned(),
        more => format!("; and {more} more"),
    };
    let [nominal, sigma, value, own] = [*nominal, *sigma, a.value, a.sigma].map(|x| rounded(x, 5));
    format!(
        "the prior of {name} is inconsistent with the data: declared {nominal} ± {sigma} {unit}, estimated {value} ± {own} {unit}, difference {:.0} sigma{more}; correct the nominal number or the sigma of the prior",
        a.z.abs()
    )
}

/// Test of the priors of mass properties. Where they contradict the data, also the squared shift of the answer in its
/// sigmas, which bounds the shift of every number in its sigma.
fn design(experiment: &Experiment, fitted: &Fitted) -> Option<(PriorTest, Option<f64>)> {
    let alone = fitted.data_alone.as_ref()?;
    let design = prior::design(experiment.problem, experiment.parameters, &fitted.at.x)?;
    let stacked = experiment.stack(&fitted.at, &fitted.evaluated, false);
    let shared = SharedTriangle::new(experiment.parameters, &stacked);
    let fall = alone.decrease(&shared.rhs(), 0.0);
    let numbers = fitted_numbers(experiment, fitted);
    let dof = fitted.rows().saturating_sub(numbers).max(1);
    // Data that fit badly without any prior contradict it by less.
    let scale = ((fitted.chi2() - fall) / dof as f64).max(1.0);
    let count = design.rows.len().min(alone.rank);
    let square = (design.chi2 + fall) / scale;
    let chance = ChiSquared::new(count as f64).ok()?.sf(square);
    let contradicted = chance < experiment.settings.contradiction_p() || square.is_infinite();
    let moved = contradicted.then(|| {
        let step = alone.damped(&shared.rhs(), 0.0);
        let spectrum = &fitted.spectrum;
        let known = (0..spectrum.rank).map(|k| spectrum.singular[k] * spectrum.along(&step, k));
        known.map(|z| z.powi(2)).sum()
    });
    let test = PriorTest {
        of: "priors of mass properties",
        statistic: ("chi-square", square),
        count,
        p: chance,
        contradicted,
    };
    Some((test, moved))
}

/// The priors of mass properties that are far from a fit without them, started at the end of the fit with them, and its diagnosis
/// where that is wanted.
fn without_priors(
    experiment: &Experiment,
    fitted: &Fitted,
    wanted: bool,
) -> Option<(Vec<Discrepancy>, Option<Diagnostics>)> {
    let mut model = experiment.problem.model.clone();
    for body in &mut model.bodies {
        body.prior = None;
    }
    let problem = experiment.problem.with_model(&model);
    let free = experiment.with_problem(&problem);
    let end = fit_from(&free, fitted.at.clone(), ITERATIONS)?;
    let found = wanted.then(|| diagnose(&free, &end));
    Some((rows(experiment, &end), found))
}

/// Rows of the priors of mass properties that lie far from what the data alone say.
fn rows(experiment: &Experiment, free: &Fitted) -> Vec<Discrepancy> {
    let design = prior::design(experiment.problem, experiment.parameters, &free.at.x);
    let rows = design.map(|d| d.rows).unwrap_or_default();
    let used = free.spectrum.natural.len();
    let apart = |row: PriorRow| {
        let declared = row.about?;
        let own = free.spectrum.sigma(row.gradient.get(..used)?)?;
        let z = row.residual / (1.0 + own * own).sqrt();
        Some(Discrepancy {
            value: declared.nominal - row.residual * declared.sigma,
            sigma: own * declared.sigma,
            declared,
            z,
        })
    };
    let all = rows.into_iter().filter_map(apart);
    let limit = experiment.settings.contradiction_sigmas;
    all.filter(|a| a.z.abs() > limit).collect()
}

/// Rows of calibrations (biases, scales, thrust) against what the data alone say.
fn calibrations(experiment: &Experiment, fitted: &Fitted) -> Vec<Discrepancy> {
    let (parameters, x) = (experiment.parameters, &fitted.at.x);
    let rows = prior::calibration(experiment.problem, parameters, x).rows;
    if rows.iter().all(|r| r.about.is_none()) {
        return Vec::new();
    }
    let loosened = Loosened::new(fitted);
    let apart = |row: PriorRow| {
        let declared = row.about?;
        let at = row.gradient.iter().position(|g| *g != 0.0)?;
        let known = loosened.covariance(&[at])[(0, 0)] / (declared.sigma * declared.sigma);
        let left = (1.0 - known).max(LEAST_SHARE);
        let residual = row.residual - row.gradient[at] * loosened.moved(at);
        let z = residual / left.sqrt();
        // The answer without the declared number.
        Some(Discrepancy {
            value: declared.nominal - residual * declared.sigma / left,
            sigma: declared.sigma * (known / left).max(0.0).sqrt(),
            declared,
            z,
        })
    };
    rows.into_iter().filter_map(apart).collect()
}
