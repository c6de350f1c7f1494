//! Texts about determined and undetermined directions, and warnings.

use super::both::NoisySolution;
use super::solve::Directions;
use super::ten::{MISFIT, Ten};
use crate::study::statistics::largest;
use poinsot_identify::{
    BodyEstimate, DeterminedCombination, Identifiability, Problem, UnobservableCombination,
};
use poinsot_model::{Nuisance, SensorKind};
use poinsot_spatial::{MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS};

/// Range of the ratio of arm mass to base mass in the paper.
const STUDIED: [f64; 2] = [0.005, 0.5];

/// Why a direction is not determined, and what to do.
#[derive(Clone, Copy)]
struct Cause {
    reason: &'static str,
    remedy: &'static str,
}

impl Cause {
    fn of(self, text: String, coefficients: Vec<(String, f64)>) -> UnobservableCombination {
        UnobservableCombination {
            text,
            coefficients,
            reason: self.reason.to_owned(),
            remedy: self.remedy.to_owned(),
            walk: Vec::new(),
        }
    }
}

const REJECTED: Cause = Cause {
    reason: "the answer is rejected",
    remedy: "see the warnings",
};
const HARDLY_TURNS: Cause = Cause {
    reason: "the base hardly turns: the mass centre enters only in w x rho_S",
    remedy: "give the vehicle a spin, or move the arm about two axes",
};
const HARDLY_MOVES: Cause = Cause {
    reason: "the velocities of the base change no more than their declared noise",
    remedy: "move the arm between configurations that differ as much as possible, or give the vehicle momentum (known-momentum)",
};
const FEW_DIRECTIONS: Cause = Cause {
    reason: "the angular velocity of the base does not span all directions (stopped joints need an initial spin; spin about one axis needs arm motion about two)",
    remedy: "spin about two axes, move the arm about two axes, or keep moving samples",
};

pub(super) fn identifiability(name: &str, solved: &NoisySolution, ten: &Ten) -> Identifiability {
    let names = MASS_PROPERTY_NAMES
        .map(|number| format!("{name}.{}", number.replace("inertia_", "I_BBcm_")));
    let mut found = Identifiability {
        parameters: 10,
        ..Identifiability::default()
    };
    let lone = solved.linear.usable == [true, false, false, false]
        || !ten.open[0] && ten.open[1..4].contains(&true);
    let cause = if lone { HARDLY_TURNS } else { HARDLY_MOVES };
    describe(&mut found, &solved.linear, &names[..4], ten, cause);
    if let Some((_, directions)) = &solved.angular {
        describe(&mut found, directions, &names[4..], ten, FEW_DIRECTIONS);
        return found;
    }
    let cause = Cause {
        reason: "step 2 needs mass and mass centre, which step 1 does not determine",
        ..cause
    };
    for name in &names[4..] {
        let open = cause.of(name.clone(), vec![(name.clone(), 1.0)]);
        found.open.push(open);
        found.sigmas_natural.push(f64::INFINITY);
    }
    found
}

/// Rank, sigmas, determined and undetermined directions of one step.
fn describe<const N: usize>(
    found: &mut Identifiability,
    d: &Directions<N>,
    names: &[String],
    ten: &Ten,
    cause: Cause,
) {
    // Index of its first unknown among the ten numbers.
    let at = if N == 4 { 0 } else { 4 };
    let complete = d.usable.iter().all(|u| *u);
    let floor = 32.0 * N as f64 * f64::EPSILON * d.singular[0].max(f64::MIN_POSITIVE);
    found.structural_rank += d.singular.iter().filter(|s| **s > floor).count();
    let mut natural = d.natural;
    if at == 0 {
        natural[0] = ten.value[0];
    }
    for j in 0..N {
        // The mass is the reciprocal of the first unknown.
        let sign = |i: usize| if at + i == 0 { -1.0 } else { 1.0 };
        let v: [f64; N] = std::array::from_fn(|i| sign(i) * d.V[(i, j)]);
        // Sigma along the direction: its diagonal element of the covariance in natural units.
        let scaled = |i: usize, k: usize| {
            v[i] * v[k] * ten.covariance[(at + i, at + k)] / (natural[i] * natural[k])
        };
        let pairs = (0..N).flat_map(|i| (0..N).map(move |k| (i, k)));
        let variance: f64 = pairs.map(|(i, k)| scaled(i, k)).sum();
        let usable = d.usable[j] && !ten.rejected;
        found.rank += usize::from(usable);
        found.sigmas_natural.push(match d.usable[j] {
            true => variance.sqrt(),
            false => f64::INFINITY,
        });
        if complete && !ten.rejected {
            continue;
        }
        let lead = (0..N).fold(0, |a, b| if v[b].abs() > v[a].abs() { b } else { a });
        let scale = natural[lead] / v[lead];
        // A determined combination has weights of the parameters, an undetermined one changes of them.
        let weigh = |i: usize| match usable {
            true => v[i] / natural[i] * scale,
            false => v[i] * natural[i],
        };
        let terms = || (0..N).filter(|&i| v[i].abs() > 1.0e-3);
        let coefficients = terms().map(|i| (names[i].clone(), weigh(i)));
        let coefficients: Vec<(String, f64)> = coefficients.collect();
        let text = sentence(&coefficients);
        if !usable {
            let cause = if ten.rejected { REJECTED } else { cause };
            found.open.push(cause.of(text, coefficients));
            continue;
        }
        found.determined.push(DeterminedCombination {
            text,
            coefficients,
            unit: MASS_PROPERTY_UNITS[at + lead],
            value: terms().map(|i| weigh(i) * ten.value[at + i]).sum(),
            sigma: ten.inflation * variance.sqrt() * scale.abs(),
        });
    }
}

fn sentence(terms: &[(String, f64)]) -> String {
    let lead = largest(terms.iter().map(|t| t.1.abs())).max(f64::MIN_POSITIVE);
    let mut text = String::new();
    for (name, c) in terms {
        let c = c / lead;
        let sign = match (text.is_empty(), c < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text.push_str(&format!("{sign}{:.3} {name}", c.abs()));
    }
    text
}

/// What a chi-square per degree of freedom says against the answer; `contradicted` is that without the declared momentum.
fn misfit(chi2: f64, contradicted: Option<f64>, rejected: bool) -> Option<String> {
    let times = chi2.sqrt();
    if let Some(free) = contradicted {
        return Some(format!(
            "the declared momentum contradicts the data: residuals are {times:.1} times the declared noise with it and {:.1} times without; give linear_N_s and angular_N_m_s in N, angular about the system mass centre, at the first sample, or use --variant unknown-momentum",
            free.sqrt()
        ));
    }
    if rejected {
        return Some(format!(
            "rigid model rejected: residuals are {times:.1} times the declared noise and the model explains less than half of the data; check units, signs, joint axes, external forces"
        ));
    }
    (chi2 > MISFIT).then(|| {
        format!(
            "residuals are {times:.1} times the declared noise: sigmas are widened by that factor and the covariance is not trustworthy"
        )
    })
}

pub(super) fn warnings(
    problem: &Problem,
    solved: &NoisySolution,
    ten: &Ten,
    contradicted: Option<f64>,
    base: &BodyEstimate,
) -> Vec<String> {
    let mut list = Vec::new();
    list.extend(misfit(solved.chi2, contradicted, ten.rejected));
    let ratio = solved.x[0];
    if !ten.open[0] && !(STUDIED[0]..=STUDIED[1]).contains(&ratio) {
        list.push(format!(
            "the arm has {:.1} % of the base's mass; the paper studied 0.5 to 50 %",
            100.0 * ratio
        ));
    }
    let mut gyros = problem.model.sensors_of(SensorKind::Gyro);
    let prior = problem
        .model
        .bodies
        .first()
        .is_some_and(|b| b.prior.is_some());
    for (holds, words) in [
        (
            ratio <= 0.0,
            "step 1 gives a negative mass: noise or a wrong model dominates it; no number is given",
        ),
        (
            gyros.any(|s| s.bias != Nuisance::Known),
            "the gyro's bias is declared unknown: ma2008 assumes zero; --method auto estimates it",
        ),
        (prior, "the base's prior is not used by ma2008"),
    ] {
        list.extend(holds.then(|| words.to_owned()));
    }
    let unit = solved.linear.natural[1].powi(2);
    let tensor = (4..10).map(|k| ten.bias[k] / unit / ten.value[0]);
    let relative = std::iter::once(ten.bias[0] / ten.value[0]).chain(tensor);
    let worst = largest(relative.map(f64::abs));
    if worst > 1.0e-6 && !ten.rejected {
        list.push(format!(
            "noise in the regressor biases the two steps by up to {worst:.1e} of the nominal; the sigmas include that; maximum likelihood has no such bias"
        ));
    }
    if base.physically_consistent == Some(false) {
        list.push(format!(
            "{}: no distribution of positive mass has this inertia tensor",
            base.name
        ));
    }
    list
}
