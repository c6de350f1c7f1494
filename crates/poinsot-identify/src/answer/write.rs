//! From the solved system to the answer: numbers, combinations, fit, status.

use crate::answer::body::{QuantityEstimator, body, system};
use crate::answer::covariance::{covariance, covariance_rows};
use crate::answer::determined;
use crate::answer::known_numbers::{assumptions, known_numbers};
use crate::answer::momentum::{momentum, nuisances};
use crate::answer::nominal::distances_from_nominal;
use crate::answer::rejection::Rejection;
use crate::answer::reliability::{NOISE_FREE, Reliability};
use crate::answer::signatures::{at_origin, equal_scales};
use crate::certify::naming;
use crate::motion::joint_scales;
use crate::problem::Problem;
use crate::problem::parameters::Equations;
use crate::problem::parameters::UnknownKind;
use crate::remedies;
use crate::solution::estimate::{
    BodyEstimate, Estimate, Identifiability, NamedNumber, Number, Status,
};
use crate::solution::evidence::{self, Effect, Remark, RemarkKind};
use crate::solution::solved::Solution;

/// Bias of the linear answer, relative to nominal, below which no warning is given.
const NO_BIAS: f64 = 1.0e-6;

/// The answer with tested remedies, which the trials of a campaign do not need.
pub(crate) fn write_with_remedies(problem: &Problem, solution: &Solution) -> Estimate {
    let mut estimate = write(problem, solution);
    if estimate.status != Status::Rejected {
        remedies::try_changes(problem, solution, &mut estimate.identifiability.open);
    }
    estimate
}

pub(crate) fn write(problem: &Problem, solution: &Solution) -> Estimate {
    let Reliability { rows, coloured } = Reliability::of(solution);
    let sigma_factor = evidence::sigma_factor(&rows);
    let answered = |withheld: bool| {
        let estimator = QuantityEstimator::new(solution, sigma_factor, withheld);
        let bodies: Vec<BodyEstimate> = (0..problem.model.bodies.len())
            .map(|at| body(&estimator, at))
            .collect();
        (estimator, bodies)
    };
    let (estimator, bodies) = answered(false);
    let rejection = Rejection::of(solution, coloured, &bodies);
    // A rejected or unconverged answer has no numbers.
    let (estimator, bodies) = match rejection.is_some() || !solution.converged() {
        true => answered(true),
        false => (estimator, bodies),
    };
    let mut remarks = vec![Rejection::row(rejection, solution)];
    remarks.extend(rows);
    if rejection.is_none() {
        remarks.extend(distances_from_nominal(problem, &bodies));
    }
    remarks.extend(bodies.iter().filter_map(physical_tensor));
    let nominal = problem.model.bodies.iter().map(|b| &b.nominal);
    remarks.extend(
        bodies
            .iter()
            .zip(nominal)
            .filter_map(|(b, n)| at_origin(b, n)),
    );
    let nuisance = nuisances(&estimator);
    remarks.extend(equal_scales(problem, solution, &nuisance));
    let identifiability = identifiability(problem, &estimator);
    let effects = remarks.iter().map(|remark| remark.effect);
    let status = effects.fold(Status::of_numbers(&bodies, &identifiability), Status::after);
    let mut warnings = warnings(solution, &remarks, rejection);
    warnings.extend(said_of_numbers(solution, rejection, &bodies, &nuisance));
    warnings.extend(determined::withheld(&identifiability));
    let said = solution.remarks.iter();
    remarks.extend(said.filter(|r| r.kind != RemarkKind::Test).cloned());
    remarks.extend(warnings.into_iter().map(Remark::warning));
    let rows = covariance_rows(solution, &bodies, &nuisance);
    remarks.extend(assumptions(problem.model, solution, &rows));
    let own = solution.likelihood.as_ref();
    Estimate {
        method: solution.method.to_owned(),
        variant: None,
        status,
        iterations: own.map_or(1, |own| own.iterations),
        costs: own.map_or_else(Vec::new, |own| own.costs.clone()),
        remarks,
        system: whole(problem, &estimator, &bodies),
        bodies,
        momentum: solution
            .starts
            .iter()
            .map(|s| momentum(&estimator, s))
            .collect(),
        covariance: covariance(solution, &rows, sigma_factor * sigma_factor),
        covariance_names: rows.iter().map(|r| r.name.clone()).collect(),
        covariance_units: rows.iter().map(|r| r.unit).collect(),
        nuisance,
        identifiability,
        fit: match solution.is_found() {
            true => solution.fit.clone(),
            false => Vec::new(),
        },
        states_covariance: true,
        known_numbers: known_numbers(problem.model, solution, &rows),
        diagnostics: own.map(|own| own.diagnostics.clone()),
        method_report: None,
    }
}

/// The vehicle as one body, at its joints' first positions.
fn whole(
    problem: &Problem,
    estimator: &QuantityEstimator,
    bodies: &[BodyEstimate],
) -> Option<(BodyEstimate, Vec<f64>)> {
    let solution = estimator.solution;
    if solution.parameters.equations == Equations::Rotation {
        // One body: the vehicle is that body.
        let name = "system".to_owned();
        let body = bodies.first()?.clone();
        return Some((BodyEstimate { name, ..body }, Vec::new()));
    }
    let samples = &problem.segments.first()?.samples;
    let mut position = samples.joint_position.get(..problem.tree.dof())?.to_vec();
    // A sample is (1 + scale) truth + offset.
    for (unknown, offset) in solution.parameters.unknowns.iter().zip(&solution.x) {
        if let UnknownKind::JointOffset(k) = unknown.kind {
            position[k] -= offset;
        }
    }
    for own in joint_scales(&solution.parameters, &solution.x) {
        position[own.joint] *= own.factor();
    }
    let all = system(estimator, problem.tree, &position);
    Some((all, position))
}

/// A body whose inertia no distribution of positive mass has makes the answer partial.
fn physical_tensor(body: &BodyEstimate) -> Option<Remark> {
    let physical = body.physically_consistent.filter(|_| body.asked)?;
    let some = if physical { "a" } else { "no" };
    let name = &body.name;
    Some(Remark::test(
        format!("inertia of {name} against a positive mass distribution"),
        Effect::MakesPartial.if_failed(!physical),
        format!("{name}: {some} distribution of positive mass has this inertia tensor"),
    ))
}

fn identifiability(problem: &Problem, estimator: &QuantityEstimator) -> Identifiability {
    let solution = estimator.solution;
    let spectrum = solution.of_data();
    let m = spectrum.natural.len();
    let absent = naming::absent(&solution.parameters);
    let numbers: usize = absent.iter().map(|c| c.coefficients.len()).sum();
    if !solution.is_found() {
        return Identifiability {
            parameters: m + numbers,
            ..Identifiability::default()
        };
    }
    let mut determined = determined::combinations(estimator);
    determined.extend(determined::functions(problem, estimator));
    let allowed = spectrum.experiment();
    let mut open = naming::unobservable_directions(problem, solution);
    if solution.data_alone().is_none() {
        let walks = open.iter_mut().zip(&solution.unobservable_set.walks);
        walks.for_each(|(open, walk)| open.walk = naming::values_along_path(solution, walk));
    }
    open.extend(naming::inaccurate_directions(problem, solution));
    open.extend(absent);
    Identifiability {
        parameters: m + numbers,
        rank: allowed.accurate,
        structural_rank: spectrum.structural_rank,
        sigmas_natural: allowed.sigmas(),
        ranks: solution.unobservable_set.ranks(),
        determined,
        open,
    }
}

/// Warnings of the fit as a whole.
fn warnings(solution: &Solution, evidence: &[Remark], rejection: Option<Rejection>) -> Vec<String> {
    let chi2 = solution.chi2_per_dof();
    let mut list = Vec::new();
    let doubts = evidence::doubts(evidence);
    match rejection {
        Some(rejection) => list.push(rejection.message(solution)),
        None if doubts.is_empty() => {}
        None => {
            let factor = evidence::sigma_factor(evidence);
            let widened = match factor > 1.0 {
                true => format!("; sigmas are widened {factor:.1} times"),
                false => String::new(),
            };
            list.push(format!(
                "the covariance is not trustworthy (chi-square per degree of freedom {chi2:.2}): {}{widened}",
                doubts.join("; ")
            ));
        }
    }
    if solution.noise_accumulates && rejection.is_none() && chi2 > NOISE_FREE {
        list.push(
            "linear method: under thrust, position and attitude noise accumulates over samples, which its sigmas ignore: the covariance is not trustworthy; use --method auto"
                .to_owned(),
        );
    }
    let own = solution.likelihood.as_ref();
    if let Some(held) = own.and_then(|own| own.held.as_ref()) {
        list.push(format!(
            "{}: the inertia is at the limit of physical values (beyond it chi-square would fall by {:.1}). There the covariance is not trustworthy; --coordinates linear removes the limit",
            held.bodies.join(", "),
            held.cost
        ));
    }
    let biases = solution.spectrum.bias.iter();
    let bias = biases.fold(0.0_f64, |worst, b| worst.max(b.abs()));
    if bias > NO_BIAS {
        list.push(format!(
            "linear method: noise in the regressor biases the estimate by up to {bias:.1e} of nominal; the sigmas include that; maximum likelihood has no such bias"
        ));
    }
    list
}

/// Warnings of single bodies and numbers.
fn said_of_numbers(
    solution: &Solution,
    rejection: Option<Rejection>,
    bodies: &[BodyEstimate],
    nuisance: &[NamedNumber],
) -> Vec<String> {
    let impossible = bodies
        .iter()
        .filter(|b| b.physically_consistent == Some(false));
    let mut list: Vec<String> = impossible
        .map(|body| {
            format!(
                "{}: no distribution of positive mass has this inertia tensor",
                body.name
            )
        })
        .collect();
    if rejection.is_none() && solution.converged() {
        let open = nuisance
            .iter()
            .filter(|n| n.number == Number::undetermined(n.number.nominal));
        list.extend(open.map(|n| format!("{} is not identifiable from these data", n.name)));
    }
    list
}
