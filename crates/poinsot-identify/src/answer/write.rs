//! From the solved system to the answer: numbers, combinations, fit, status.

use crate::answer::body::{Judge, body, system};
use crate::answer::covariance::{covariance, covariance_rows};
use crate::answer::determined;
use crate::answer::known_numbers::known_numbers;
use crate::answer::momentum::{momentum, nuisances};
use crate::answer::rejection::Rejection;
use crate::answer::trust::{NOISE_FREE, Trust};
use crate::certify::words;
use crate::problem::Problem;
use crate::problem::parameters::Equations;
use crate::remedies;
use crate::solution::estimate::{
    BodyEstimate, Estimate, Identifiability, NamedNumber, Number, Source, Status,
};
use crate::solution::solved::Solved;
use poinsot_model::NOMINAL_WITHIN;
use poinsot_spatial::MassProperties;

/// Bias of the linear answer, over the nominal, of which nothing is said.
const NO_BIAS: f64 = 1.0e-6;

/// The answer with remedies that were tried: for readers, not for the trials of a campaign.
pub(crate) fn write_with_remedies(problem: &Problem, solved: &Solved) -> Estimate {
    let mut estimate = write(problem, solved);
    if estimate.status != Status::Rejected {
        remedies::try_changes(problem, solved, &mut estimate.identifiability.open);
    }
    estimate
}

pub(crate) fn write(problem: &Problem, solved: &Solved) -> Estimate {
    let mut trust = Trust::of(solved);
    let answered = |withheld: bool| {
        let judge = Judge::new(solved, trust.widening, withheld);
        let bodies: Vec<BodyEstimate> = (0..problem.model.bodies.len())
            .map(|at| body(&judge, solved, at))
            .collect();
        (judge, bodies)
    };
    let (judge, bodies) = answered(false);
    let rejection = Rejection::of(solved, &trust, &bodies);
    // What is rejected, and what did not settle, gets no numbers.
    let (judge, bodies) = match rejection.is_some() || !solved.settled {
        true => answered(true),
        false => (judge, bodies),
    };
    match rejection {
        Some(_) => {
            let why = "the data contradict the rigid model".to_owned();
            trust.doubts.insert(0, why);
        }
        None => trust.doubts.extend(all_far_from_nominal(problem, &bodies)),
    }
    let identifiability = identifiability(problem, solved, &judge);
    let status = status(
        &bodies,
        &identifiability,
        rejection.is_some(),
        solved.settled,
    );
    let nuisance = nuisances(&judge, solved);
    let mut warnings = warnings(solved, &trust, rejection);
    warnings.extend(said_of_numbers(solved, rejection, &bodies, &nuisance));
    warnings.extend(determined::withheld(&identifiability));
    let rows = covariance_rows(solved, &bodies, &nuisance);
    Estimate {
        method: solved.method.to_owned(),
        variant: None,
        status,
        iterations: solved.iterations,
        assumptions: solved.assumptions.clone(),
        warnings,
        system: whole(problem, solved, (&judge, &bodies)),
        bodies,
        momentum: solved.starts.iter().map(|s| momentum(&judge, s)).collect(),
        covariance: covariance(solved, &rows, trust.widening * trust.widening),
        covariance_names: rows.iter().map(|r| r.name.clone()).collect(),
        covariance_units: rows.iter().map(|r| r.unit).collect(),
        nuisance,
        identifiability,
        fit: solved.fit.clone(),
        covariance_trustworthy: trust.doubts.is_empty(),
        doubts: trust.doubts,
        known_numbers: known_numbers(problem.model, solved, &rows),
        diagnostics: solved.diagnostics.clone(),
        method_report: None,
    }
}

/// What of the bodies lies further from nominal than the model allows.
fn all_far_from_nominal(problem: &Problem, bodies: &[BodyEstimate]) -> Vec<String> {
    let given = problem.model.bodies.iter().map(|b| &b.nominal);
    let within = problem.model.knowledge.nominal_within;
    let within = within.unwrap_or(NOMINAL_WITHIN);
    let pairs = bodies.iter().zip(given);
    pairs
        .filter_map(|(found, given)| far_from_nominal(found, given, within))
        .collect()
}

/// What of a body lies further from nominal than the model allows, by more than two sigma.
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
            "{what} of {name} is {ratio:.2} times the nominal one, beyond the factor {within} that the model allows (nominal_within)"
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
            "the mass centre of {name} is {:.1} radii of gyration from the nominal one, beyond the {within} that the model allows (nominal_within)",
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
    solved: &Solved,
    (judge, bodies): (&Judge, &[BodyEstimate]),
) -> Option<(BodyEstimate, Vec<f64>)> {
    if solved.parameters.equations == Equations::Rotation {
        // One body: the vehicle is that body.
        let name = "system".to_owned();
        let body = bodies.first()?.clone();
        return Some((BodyEstimate { name, ..body }, Vec::new()));
    }
    let samples = &problem.segments.first()?.samples;
    let position = samples.joint_position.get(..problem.tree.dof())?.to_vec();
    Some((system(judge, solved, problem.tree, &position), position))
}

fn status(
    bodies: &[BodyEstimate],
    found: &Identifiability,
    rejected: bool,
    settled: bool,
) -> Status {
    if rejected {
        return Status::Rejected;
    }
    if !settled {
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

fn identifiability(problem: &Problem, solved: &Solved, judge: &Judge) -> Identifiability {
    let spectrum = solved.of_data();
    let m = spectrum.natural.len();
    let mut determined = determined::combinations(solved, judge);
    determined.extend(determined::functions(problem, solved, judge));
    let absent = words::absent(&solved.parameters);
    let mut open = words::open_directions(problem, solved);
    if solved.data_alone.is_none() {
        let walks = open.iter_mut().zip(&solved.open_set.walks);
        walks.for_each(|(open, walk)| open.walk = words::walked(solved, walk));
    }
    let numbers: usize = absent.iter().map(|c| c.coefficients.len()).sum();
    open.extend(absent);
    Identifiability {
        parameters: m + numbers,
        rank: spectrum.rank,
        structural_rank: spectrum.structural_rank,
        sigmas_natural: spectrum.certificate.clone(),
        ranks: solved.open_set.ranks(),
        determined,
        open,
    }
}

/// What is said of the fit as a whole.
fn warnings(solved: &Solved, trust: &Trust, rejection: Option<Rejection>) -> Vec<String> {
    let chi2 = solved.chi2_per_dof();
    let mut list = solved.warnings.clone();
    match rejection {
        Some(rejection) => list.push(rejection.words(solved)),
        None if trust.doubts.is_empty() => {}
        None => list.push(format!(
            "the covariance is not trustworthy (chi-square per degree of freedom {chi2:.2}): {}; sigmas are widened {:.1} times",
            trust.doubts.join("; "),
            trust.widening
        )),
    }
    if solved.adds_up && rejection.is_none() && chi2 > NOISE_FREE {
        list.push(
            "linear method: under thrust the noise of measured positions and attitudes adds up from sample to sample, which its sigmas take as fresh: the covariance is not trustworthy; use --method auto"
                .to_owned(),
        );
    }
    if let Some(held) = &solved.held {
        list.push(format!(
            "{}: the data alone would put the inertia beyond what positive mass can have; it is held at the edge of that (beyond it chi-square would fall by {:.1}), where an interval has one side only and the covariance is not trustworthy; --coordinates linear lets it pass",
            held.bodies.join(", "),
            held.cost
        ));
    }
    let biases = solved.spectrum.bias.iter();
    let bias = biases.fold(0.0_f64, |worst, b| worst.max(b.abs()));
    if bias > NO_BIAS {
        list.push(format!(
            "linear method: noise in the regressor biases the answer by up to {bias:.1e} of the nominal; that is inside the sigmas, and maximum likelihood is free of it"
        ));
    }
    list
}

/// What is said of single bodies and numbers.
fn said_of_numbers(
    solved: &Solved,
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
    if rejection.is_none() && solved.settled {
        let open = nuisance
            .iter()
            .filter(|n| n.number == Number::open(n.number.nominal));
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
