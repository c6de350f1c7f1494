//! From the solved system to the answer: numbers, combinations, fit, status.

use crate::answer_body::{Judge, body, covariance_rows, system};
use crate::answer_momentum::{momentum, nuisances, start_values};
use crate::combination::split;
use crate::estimate::{
    BodyEstimate, DeterminedCombination, Estimate, Identifiability, NamedNumber, Number,
    SegmentFit, Source, Status,
};
use crate::linear::{LinearProblem, Solved};
use crate::parameters::Equations;
use crate::residual;
use crate::words;

/// Chi-square per degree of freedom above which the declared noise cannot be right.
const MISFIT: f64 = 1.5;
/// Chi-square per degree of freedom above which a model that explains little is rejected.
const REJECT: f64 = 9.0;
/// Share of the signal that a model must explain not to be rejected then.
const EXPLAINED: f64 = 0.5;

pub(crate) fn write(problem: &LinearProblem, solved: &Solved) -> Estimate {
    let chi2 = per_dof(solved.residual);
    let rejected = chi2 > REJECT && solved.explained.is_some_and(|share| share < EXPLAINED);
    let judge = Judge::new(solved, chi2.sqrt().max(1.0), rejected);
    let bodies: Vec<BodyEstimate> = (0..problem.model.bodies.len())
        .map(|at| body(&judge, solved, at))
        .collect();
    let identifiability = identifiability(problem, solved, &judge);
    let status = status(&bodies, &identifiability, rejected);
    let rows = covariance_rows(&solved.parameters, &bodies, &solved.x);
    let nuisance = nuisances(&judge, solved);
    let momentum = problem
        .segments
        .iter()
        .zip(&solved.reduced)
        .map(|(segment, reduced)| momentum(&judge, solved, problem.tree, segment, reduced))
        .collect();
    let system = (solved.parameters.equations == Equations::Momentum)
        .then(|| whole(problem, solved, &judge))
        .flatten();
    Estimate {
        method: "linear".to_owned(),
        variant: None,
        status,
        warnings: warnings(solved, chi2, rejected, &bodies, &nuisance),
        bodies,
        system,
        momentum,
        covariance: covariance(solved, &rows, chi2.max(1.0)),
        covariance_names: rows.iter().map(|r| r.0.clone()).collect(),
        covariance_units: rows.iter().map(|r| r.1).collect(),
        nuisance,
        identifiability,
        fit: fit(problem, solved),
        covariance_trustworthy: chi2 <= MISFIT && !rejected,
        method_report: Vec::new(),
    }
}

fn per_dof(residual: (f64, usize)) -> f64 {
    residual.0 / residual.1.max(1) as f64
}

fn whole(
    problem: &LinearProblem,
    solved: &Solved,
    judge: &Judge,
) -> Option<(BodyEstimate, Vec<f64>)> {
    let dof = problem.tree.dof();
    let position = problem
        .segments
        .first()?
        .samples
        .joint_position
        .get(..dof)?
        .to_vec();
    Some((system(judge, solved, problem.tree, &position), position))
}

fn status(bodies: &[BodyEstimate], found: &Identifiability, rejected: bool) -> Status {
    if rejected {
        return Status::Rejected;
    }
    let open = bodies
        .iter()
        .filter(|b| b.asked)
        .flat_map(|b| std::iter::once(&b.mass).chain(&b.com).chain(&b.inertia))
        .any(|n| n.source == Source::Open);
    match (found.rank, open) {
        (0, _) => Status::NotIdentifiable,
        (_, true) => Status::Partial,
        (_, false) => Status::Converged,
    }
}

fn identifiability(problem: &LinearProblem, solved: &Solved, judge: &Judge) -> Identifiability {
    let spectrum = &solved.spectrum;
    let m = spectrum.natural.len();
    let combinations = split(
        &spectrum.open_directions(),
        &spectrum.natural,
        &words::weights(solved),
    );
    let determined = combinations
        .determined
        .iter()
        .filter_map(|c| {
            let gradient = c.gradient(m);
            let mut full = gradient.clone();
            full.resize(solved.parameters.len(), 0.0);
            let lead = c.terms.first()?.0;
            Some(DeterminedCombination {
                text: words::sentence(solved, c),
                coefficients: words::named(solved, &gradient),
                unit: solved.parameters.unknowns[lead].unit,
                value: c.value(&solved.x),
                sigma: judge.sigma(&full)?,
            })
        })
        .collect();
    Identifiability {
        parameters: m,
        rank: spectrum.rank,
        structural_rank: spectrum.structural_rank,
        sigmas_natural: spectrum.sigmas_natural(),
        determined,
        open: words::open_directions(problem, solved),
    }
}

fn covariance(
    solved: &Solved,
    rows: &[(String, &'static str, Vec<f64>)],
    scale: f64,
) -> Vec<Vec<f64>> {
    let c = solved.spectrum.covariance();
    let m = c.nrows();
    let apply = |g: &[f64]| -> Vec<f64> {
        (0..m)
            .map(|i| (0..m).map(|j| c[(i, j)] * g[j]).sum())
            .collect()
    };
    rows.iter()
        .map(|a| {
            let image = apply(&a.2);
            rows.iter()
                .map(|b| scale * b.2.iter().zip(&image).map(|(x, y)| x * y).sum::<f64>())
                .collect()
        })
        .collect()
}

fn fit(problem: &LinearProblem, solved: &Solved) -> Vec<SegmentFit> {
    let n = solved.parameters.len();
    let spin: Vec<f64> = problem
        .model
        .wheels
        .iter()
        .map(|w| w.spin_inertia)
        .collect();
    problem
        .segments
        .iter()
        .zip(&solved.reduced)
        .map(|(segment, reduced)| {
            let h = reduced.start.columns();
            let r = &reduced.triangle.r;
            let left: f64 = (h..r.nrows())
                .map(|i| {
                    let predicted: f64 = (0..n).map(|j| r[(i, h + j)] * solved.x[j]).sum();
                    (r[(i, h + n)] - predicted).powi(2)
                })
                .sum();
            let per_sample = match solved.parameters.equations {
                Equations::Momentum => 6,
                Equations::Rotation => 3,
            };
            let samples = segment.samples.time_s.len();
            let start = start_values(solved, reduced);
            let rms = residual::twist(solved, problem.tree, &spin, segment, start);
            SegmentFit {
                label: segment.label.clone(),
                samples,
                chi2_per_dof: left / (per_sample * samples - h).max(1) as f64,
                rms_rate: rms.map(|r| r.rate),
                rms_velocity: rms.and_then(|r| r.velocity),
            }
        })
        .collect()
}

fn warnings(
    solved: &Solved,
    chi2: f64,
    rejected: bool,
    bodies: &[BodyEstimate],
    nuisance: &[NamedNumber],
) -> Vec<String> {
    let mut list = Vec::new();
    if rejected {
        let share = 100.0 * solved.explained.unwrap_or(0.0);
        list.push(format!(
            "rigid model rejected: it explains {share:.0} % of the measured change of momentum and misses the rest by {:.0} sigma; check units, signs, wheel axes, external torques",
            chi2.sqrt()
        ));
    } else if chi2 > MISFIT {
        list.push(format!(
            "residuals are {:.1} times the declared noise (chi-square per degree of freedom {chi2:.1}): sigmas are widened by that factor and the covariance is not trustworthy",
            chi2.sqrt()
        ));
    }
    let z_bias = solved
        .spectrum
        .bias
        .iter()
        .fold(0.0_f64, |worst, b| worst.max(b.abs()));
    if z_bias > 1.0e-6 {
        list.push(format!(
            "linear method: noise in the regressor biases the answer by up to {z_bias:.1e} of the nominal; that is inside the sigmas, and maximum likelihood is free of it"
        ));
    }
    for body in bodies
        .iter()
        .filter(|b| b.physically_consistent == Some(false))
    {
        list.push(format!(
            "{}: no distribution of positive mass has this inertia tensor",
            body.name
        ));
    }
    for item in nuisance {
        if item.number == Number::open(item.number.nominal) {
            list.push(format!("{} is not identifiable from these data", item.name));
        }
    }
    list
}
