//! From the solved system to the answer: numbers, combinations, fit, status.

use crate::answer::body::{Judge, body, system};
use crate::answer::covariance::{covariance, covariance_rows};
use crate::answer::determined;
use crate::answer::known_numbers::known_numbers;
use crate::answer::momentum::{momentum, nuisances};
use crate::answer::trust::{NOISE_FREE, Trust};
use crate::certify::words;
use crate::fit::degrees_of_freedom::MISFIT;
use crate::problem::Problem;
use crate::problem::parameters::Equations;
use crate::remedies;
use crate::solution::estimate::{
    BodyEstimate, Estimate, Identifiability, NamedNumber, Number, Source, Status,
};
use crate::solution::solved::Solved;
use poinsot_model::NOMINAL_WITHIN;
use poinsot_spatial::MassProperties;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chi-square per degree of freedom above which a model that explains little is rejected, and one whose residuals are
/// correlated in time: three times the noise at every reading, where no widened sigma bounds what the numbers err.
const REJECT: f64 = 9.0;
/// Probability that noise alone puts the data as far beyond the edge of the physical bodies, below which they
/// contradict the model: three sigma where one condition holds a body.
const PRESSED: f64 = 2.7e-3;
/// Share of the signal that a model must explain not to be rejected then.
const LEAST_EXPLAINED: f64 = 0.5;

/// The answer with remedies that were tried: for readers, not for the trials of a campaign.
pub(crate) fn write_with_remedies(problem: &Problem, solved: &Solved) -> Estimate {
    let mut estimate = write(problem, solved);
    if estimate.status != Status::Rejected {
        remedies::try_changes(problem, solved, &mut estimate.identifiability.open);
    }
    estimate
}

pub(crate) fn write(problem: &Problem, solved: &Solved) -> Estimate {
    let chi2 = solved.chi2_per_dof();
    let unexplained = solved
        .explained
        .is_some_and(|share| share < LEAST_EXPLAINED);
    let not_rigid = solved.not_rigid && chi2 > MISFIT;
    let mut trust = Trust::of(solved);
    let answered = |rejected: bool| {
        let judge = Judge::new(solved, trust.widening, rejected);
        let bodies: Vec<BodyEstimate> = (0..problem.model.bodies.len())
            .map(|at| body(&judge, solved, at))
            .collect();
        (judge, bodies)
    };
    let (judge, bodies) = answered(false);
    let impossible = bodies
        .iter()
        .any(|b| unphysical(b, chi2 > MISFIT || unexplained))
        || pressed(solved, chi2 > MISFIT || unexplained);
    let rejected = (chi2 > REJECT && unexplained)
        || not_rigid
        || impossible
        || contradicted(solved, &trust)
        || misled(solved);
    // What is rejected, and what did not settle, gets no numbers.
    let (judge, bodies) = if rejected || !solved.settled {
        answered(true)
    } else {
        (judge, bodies)
    };
    if rejected {
        let why = "the data contradict the rigid model".to_owned();
        trust.doubts.insert(0, why);
    }
    if !rejected {
        let given = problem.model.bodies.iter().map(|b| &b.nominal);
        let within = problem.model.knowledge.nominal_within;
        let within = within.unwrap_or(NOMINAL_WITHIN);
        let pairs = bodies.iter().zip(given);
        let far = pairs.filter_map(|(found, given)| far_from_nominal(found, given, within));
        trust.doubts.extend(far);
    }
    let identifiability = identifiability(problem, solved, &judge);
    let status = status(&bodies, &identifiability, rejected, solved.settled);
    let nuisance = nuisances(&judge, solved);
    let mut all = warnings(solved, &trust, (rejected, impossible), &bodies, &nuisance);
    all.extend(determined::withheld(&identifiability));
    let rows = covariance_rows(solved, &bodies, &nuisance);
    let momentum = solved.starts.iter().map(|s| momentum(&judge, s)).collect();
    let system = match solved.parameters.equations {
        Equations::Momentum => whole(problem, solved, &judge),
        // One body: the vehicle is that body.
        Equations::Rotation => bodies.first().map(|body| {
            let name = "system".to_owned();
            (
                BodyEstimate {
                    name,
                    ..body.clone()
                },
                Vec::new(),
            )
        }),
    };
    Estimate {
        method: solved.method.to_owned(),
        variant: None,
        status,
        iterations: solved.iterations,
        assumptions: solved.assumptions.clone(),
        warnings: all,
        bodies,
        system,
        momentum,
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

/// Whether residuals far beyond the noise are correlated in time: a wrong sign or unit, a dead wheel, a torque that
/// the model lacks. Only maximum likelihood compares readings one by one. Where a prior stands against the data, it and
/// not the vehicle is at fault.
fn contradicted(solved: &Solved, trust: &Trust) -> bool {
    solved.chi2_per_dof() > REJECT && trust.coloured && solved.conflict.is_none()
}

/// Whether noise that adds up under thrust shows in chi-square: sigmas that take it as fresh are then wrong by any
/// factor, and so are the numbers.
fn misled(solved: &Solved) -> bool {
    solved.adds_up && solved.chi2_per_dof() > MISFIT
}

/// Whether a body is no distribution of positive mass by more than three sigma, or at all where the fit is
/// bad besides.
fn unphysical(body: &BodyEstimate, bad_fit: bool) -> bool {
    if !body.asked || body.physically_consistent != Some(false) {
        return false;
    }
    let Some(principal) = &body.principal else {
        return false;
    };
    let [a, b, c] = principal.moments;
    let violation = (c - a - b).max(-a);
    let sigma = body
        .inertia
        .iter()
        .filter_map(|n| n.sigma)
        .fold(0.0, f64::max);
    bad_fit || violation > 3.0 * sigma
}

/// Whether the fit is held at the edge of the physical bodies although the data stand further beyond it than noise
/// explains, or at all where the fit is bad besides.
fn pressed(solved: &Solved, bad_fit: bool) -> bool {
    let held = solved.held.as_ref();
    held.is_some_and(|h| {
        let beyond = ChiSquared::new(h.conditions as f64);
        bad_fit || beyond.is_ok_and(|b| b.sf(h.cost) < PRESSED)
    })
}

/// What of a body lies further from nominal than the model allows, by more than two sigma.
fn far_from_nominal(found: &BodyEstimate, given: &MassProperties, within: f64) -> Option<String> {
    if !found.asked {
        return None;
    }
    let name = &found.name;
    let times = |value: f64, sigma: f64, nominal: f64| {
        let nearer = if value > nominal { -2.0 } else { 2.0 };
        let ratio = (value + nearer * sigma) / nominal;
        let far = nominal > 0.0 && (ratio > within || ratio < 1.0 / within);
        far.then(|| value / nominal)
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

fn whole(problem: &Problem, solved: &Solved, judge: &Judge) -> Option<(BodyEstimate, Vec<f64>)> {
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

fn warnings(
    solved: &Solved,
    trust: &Trust,
    (rejected, impossible): (bool, bool),
    bodies: &[BodyEstimate],
    nuisance: &[NamedNumber],
) -> Vec<String> {
    let chi2 = solved.chi2_per_dof();
    let mut list = solved.warnings.clone();
    if impossible {
        list.push(format!(
            "rigid model rejected: the answer is no distribution of positive mass, by more than its uncertainty; residuals are {:.1} times the declared noise (chi-square per degree of freedom {chi2:.1}); check units, signs, wheel axes, external torques",
            chi2.sqrt()
        ));
    } else if rejected && misled(solved) {
        list.push(format!(
            "linear method: under thrust the noise of measured positions and attitudes adds up from sample to sample (chi-square per degree of freedom {chi2:.1}), which its sigmas take as fresh: numbers are withheld; use --method auto"
        ));
    } else if rejected && solved.not_rigid {
        list.push(format!(
            "rigid model rejected: chi-square per degree of freedom {chi2:.1} with a line in the residual"
        ));
    } else if rejected && contradicted(solved, trust) {
        list.push(format!(
            "rigid model rejected: residuals are {:.1} times the declared noise (chi-square per degree of freedom {chi2:.1}) and correlated in time; check units, signs, wheel axes, external torques",
            chi2.sqrt()
        ));
    } else if rejected {
        let share = 100.0 * solved.explained.unwrap_or(0.0);
        list.push(format!(
            "rigid model rejected: it explains {share:.0} % of the measured change of momentum and misses the rest by {:.0} sigma; check units, signs, wheel axes, external torques",
            chi2.sqrt()
        ));
    } else if !trust.doubts.is_empty() {
        list.push(format!(
            "the covariance is not trustworthy (chi-square per degree of freedom {chi2:.2}): {}; sigmas are widened {:.1} times",
            trust.doubts.join("; "),
            trust.widening
        ));
    }
    if solved.adds_up && !rejected && chi2 > NOISE_FREE {
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
    let withheld = rejected || !solved.settled;
    let open = nuisance
        .iter()
        .filter(|n| n.number == Number::open(n.number.nominal));
    for item in open.filter(|_| !withheld) {
        list.push(format!("{} is not identifiable from these data", item.name));
    }
    list
}
