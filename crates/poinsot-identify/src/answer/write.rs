//! From the solved system to the answer: numbers, combinations, fit, status.

use crate::answer::body::{QuantityEstimator, body, system};
use crate::answer::covariance::{covariance, covariance_rows};
use crate::answer::determined;
use crate::answer::known_numbers::known_numbers;
use crate::answer::momentum::{momentum, nuisances};
use crate::answer::rejection::Rejection;
use crate::answer::reliability::{NOISE_FREE, Reliability};
use crate::certify::naming;
use crate::problem::Problem;
use crate::problem::parameters::Equations;
use crate::remedies;
use crate::solution::estimate::{
    BodyEstimate, Estimate, Identifiability, NamedNumber, Number, Source, Status,
};
use crate::solution::solved::Solution;
use poinsot_model::NOMINAL_WITHIN;
use poinsot_spatial::MassProperties;

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
    let mut reliability = Reliability::of(solution);
    let answered = |withheld: bool| {
        let estimator = QuantityEstimator::new(solution, reliability.sigma_factor, withheld);
        let bodies: Vec<BodyEstimate> = (0..problem.model.bodies.len())
            .map(|at| body(&estimator, solution, at))
            .collect();
        (estimator, bodies)
    };
    let (estimator, bodies) = answered(false);
    let rejection = Rejection::of(solution, &reliability, &bodies);
    // A rejected or unconverged answer has no numbers.
    let (estimator, bodies) = match rejection.is_some() || !solution.converged {
        true => answered(true),
        false => (estimator, bodies),
    };
    match rejection {
        Some(_) => {
            let why = "the data contradict the rigid model".to_owned();
            reliability.doubts.insert(0, why);
        }
        None => reliability
            .doubts
            .extend(all_far_from_nominal(problem, &bodies)),
    }
    let identifiability = identifiability(problem, solution, &estimator);
    let status = status(
        &bodies,
        &identifiability,
        rejection.is_some(),
        solution.converged,
    );
    let nuisance = nuisances(&estimator, solution);
    let mut warnings = warnings(solution, &reliability, rejection);
    warnings.extend(said_of_numbers(solution, rejection, &bodies, &nuisance));
    warnings.extend(determined::withheld(&identifiability));
    let rows = covariance_rows(solution, &bodies, &nuisance);
    Estimate {
        method: solution.method.to_owned(),
        variant: None,
        status,
        iterations: solution.iterations,
        assumptions: solution.assumptions.clone(),
        warnings,
        system: whole(problem, solution, (&estimator, &bodies)),
        bodies,
        momentum: solution
            .starts
            .iter()
            .map(|s| momentum(&estimator, s))
            .collect(),
        covariance: covariance(
            solution,
            &rows,
            reliability.sigma_factor * reliability.sigma_factor,
        ),
        covariance_names: rows.iter().map(|r| r.name.clone()).collect(),
        covariance_units: rows.iter().map(|r| r.unit).collect(),
        nuisance,
        identifiability,
        fit: solution.fit.clone(),
        covariance_trustworthy: reliability.doubts.is_empty(),
        doubts: reliability.doubts,
        known_numbers: known_numbers(problem.model, solution, &rows),
        diagnostics: solution.diagnostics.clone(),
        method_report: None,
    }
}

/// Properties of the bodies further from nominal than the model allows.
fn all_far_from_nominal(problem: &Problem, bodies: &[BodyEstimate]) -> Vec<String> {
    let given = problem.model.bodies.iter().map(|b| &b.nominal);
    let within = problem.model.knowledge.nominal_within;
    let within = within.unwrap_or(NOMINAL_WITHIN);
    let pairs = bodies.iter().zip(given);
    pairs
        .filter_map(|(found, given)| far_from_nominal(found, given, within))
        .collect()
}

/// Properties of a body further from nominal than the model allows, by more than two sigma.
fn far_from_nominal(found: &BodyEstimate, given: &MassProperties, within: f64) -> Option<String> {
    if !found.asked {
        return None;
    }
    let name = &found.name;
    let times = |value: f64, sigma: f64, nominal: f64| {
        lies_beyond(value, sigma, nominal, within).then(|| value / nominal)
    };
    let said = |what: &str, ratio: f64| {
        format!(
            "{what} of {name} is {ratio:.2} times nominal, beyond the factor {within} of nominal_within"
        )
    };
    if let (Some(m), Some(sigma)) = (found.mass.value, found.mass.sigma)
        && let Some(ratio) = times(m, sigma, given.mass)
    {
        return Some(said("the mass", ratio));
    }
    let sigmas = found.inertia.iter().filter_map(|n| n.sigma);
    let sigma = sigmas.fold(0.0, f64::max);
    if let Some(principal) = &found.principal {
        let pairs = principal.moments.into_iter().zip(given.principal().0);
        let mut far = pairs.filter_map(|(value, nominal)| times(value, sigma, nominal));
        if let Some(ratio) = far.next() {
            return Some(said("a principal moment", ratio));
        }
    }
    let apart = |k: usize| Some(found.com[k].value? - given.p_BoBcm_B[k]);
    let [x, y, z] = [apart(0)?, apart(1)?, apart(2)?];
    let sigma = found.com.iter().filter_map(|n| n.sigma).fold(0.0, f64::max);
    let (away, gyration) = (x.hypot(y).hypot(z), given.radius_of_gyration());
    (gyration > 0.0 && away - 2.0 * sigma > within * gyration).then(|| {
        format!(
            "the mass centre of {name} is {:.1} radii of gyration from nominal, beyond the {within} of nominal_within",
            away / gyration
        )
    })
}

/// Whether a value is beyond a factor of the nominal one by more than two sigma.
fn lies_beyond(value: f64, sigma: f64, nominal: f64, factor: f64) -> bool {
    // Two sigma towards nominal, and not past it.
    let nearest = match value > nominal {
        true => (value - 2.0 * sigma).max(nominal),
        false => (value + 2.0 * sigma).min(nominal),
    };
    nominal > 0.0 && (nearest > factor * nominal || nearest < nominal / factor)
}

/// The vehicle as one body, at its joints' first positions.
fn whole(
    problem: &Problem,
    solution: &Solution,
    (estimator, bodies): (&QuantityEstimator, &[BodyEstimate]),
) -> Option<(BodyEstimate, Vec<f64>)> {
    if solution.parameters.equations == Equations::Rotation {
        // One body: the vehicle is that body.
        let name = "system".to_owned();
        let body = bodies.first()?.clone();
        return Some((BodyEstimate { name, ..body }, Vec::new()));
    }
    let samples = &problem.segments.first()?.samples;
    let position = samples.joint_position.get(..problem.tree.dof())?.to_vec();
    Some((
        system(estimator, solution, problem.tree, &position),
        position,
    ))
}

fn status(
    bodies: &[BodyEstimate],
    found: &Identifiability,
    rejected: bool,
    converged: bool,
) -> Status {
    if rejected {
        return Status::Rejected;
    }
    if !converged {
        return Status::IterationLimit;
    }
    let unphysical = bodies
        .iter()
        .any(|b| b.asked && b.physically_consistent == Some(false));
    let open = bodies
        .iter()
        .filter(|b| b.asked)
        .flat_map(|b| std::iter::once(&b.mass).chain(&b.com).chain(&b.inertia))
        .any(|n| n.source == Source::Open);
    match (found.rank, open || unphysical) {
        (0, _) => Status::NotIdentifiable,
        (_, true) => Status::Partial,
        (_, false) => Status::Converged,
    }
}

fn identifiability(
    problem: &Problem,
    solution: &Solution,
    estimator: &QuantityEstimator,
) -> Identifiability {
    let spectrum = solution.of_data();
    let m = spectrum.natural.len();
    let mut determined = determined::combinations(solution, estimator);
    determined.extend(determined::functions(problem, solution, estimator));
    let absent = naming::absent(&solution.parameters);
    let allowed = spectrum.experiment();
    let mut open = naming::unobservable_directions(problem, solution);
    if solution.data_alone.is_none() {
        let walks = open.iter_mut().zip(&solution.unobservable_set.walks);
        walks.for_each(|(open, walk)| open.walk = naming::values_along_path(solution, walk));
    }
    open.extend(naming::inaccurate_directions(problem, solution));
    let numbers: usize = absent.iter().map(|c| c.coefficients.len()).sum();
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
fn warnings(
    solution: &Solution,
    reliability: &Reliability,
    rejection: Option<Rejection>,
) -> Vec<String> {
    let chi2 = solution.chi2_per_dof();
    let mut list = solution.warnings.clone();
    match rejection {
        Some(rejection) => list.push(rejection.message(solution)),
        None if reliability.doubts.is_empty() => {}
        None => list.push(format!(
            "the covariance is not trustworthy (chi-square per degree of freedom {chi2:.2}): {}; sigmas are widened {:.1} times",
            reliability.doubts.join("; "),
            reliability.sigma_factor
        )),
    }
    if solution.noise_accumulates && rejection.is_none() && chi2 > NOISE_FREE {
        list.push(
            "linear method: under thrust, position and attitude noise accumulates over samples, which its sigmas ignore: the covariance is not trustworthy; use --method auto"
                .to_owned(),
        );
    }
    if let Some(held) = &solution.held {
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
    if rejection.is_none() && solution.converged {
        let open = nuisance
            .iter()
            .filter(|n| n.number == Number::undetermined(n.number.nominal));
        list.extend(open.map(|n| format!("{} is not identifiable from these data", n.name)));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::lies_beyond;

    #[test]
    fn regress_an_uncertain_value_near_nominal_lies_within() {
        // Two of these sigmas would take 1,050 past nominal to a negative mass.
        assert!(!lies_beyond(1050.0, 660.0, 1000.0, 3.0));
        assert!(!lies_beyond(4000.0, 660.0, 1000.0, 3.0));
        assert!(lies_beyond(4500.0, 660.0, 1000.0, 3.0));
        assert!(lies_beyond(200.0, 50.0, 1000.0, 3.0));
        assert!(!lies_beyond(200.0, 100.0, 1000.0, 3.0));
    }
}
