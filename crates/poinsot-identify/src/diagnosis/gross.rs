//! Gross mistakes: a sign, a unit, a dead thruster. They put the fit so far off that no score of first order means anything, so
//! each is tried by a fit of its own from the nominal numbers.

use super::types::{FaultKind, Suspect};
use crate::fit::experiment::Experiment;
use crate::fit::{Fitted, fit_from};
use poinsot_solve::LeastSquares;

/// Chi-square per number from which gross mistakes are looked for.
const GROSS: f64 = 1.0e2;
/// Iterations of such a fit: enough to tell right from wrong.
const MISTAKE_ITERATIONS: usize = 8;
/// Share of the misfit that a gross mistake must explain.
const EXPLAINS: f64 = 0.99;

/// Excess of chi-square per number that a fit with the right reading may be left with.
const RIGHT: f64 = 10.0;

/// Factor on the speed of a wheel as read that would put it right, and what it means.
const WHEELS: [(f64, &str); 5] = [
    (-1.0, "sign"),
    (0.017_453_292_519_943_295, "degrees read as radians"),
    (
        0.104_719_755_119_659_77,
        "revolutions a minute read as rad/s",
    ),
    (std::f64::consts::TAU, "revolutions read as radians"),
    (57.295_779_513_082_32, "radians read as degrees"),
];

/// The same for the force of a thruster.
const THRUSTERS: [(f64, &str); 2] = [(0.0, "dead"), (-1.0, "direction")];

/// What the mistake may be with.
struct Culprit {
    name: String,
    wheels: Vec<usize>,
    thruster: Option<usize>,
}

/// The mistake with a wheel, with all of them, or with a thruster that explains nearly all of a very bad fit.
pub(super) fn gross(
    experiment: &Experiment,
    fitted: &Fitted,
    (excess, dof): (f64, f64),
) -> Option<Suspect> {
    let (wheels, thrusters) = (wheels(experiment), thrusters(experiment));
    if excess < GROSS * dof || wheels.is_empty() && thrusters.is_empty() {
        return None;
    }
    let before = experiment.chi2(&fitted.at, &fitted.evaluated)?;
    let nominal = experiment.cost(&experiment.nominal_point());
    let nominal = nominal.unwrap_or(f64::INFINITY);
    let mistakes = THRUSTERS.map(|m| (m, &thrusters)).into_iter();
    let mistakes = mistakes.chain(WHEELS.map(|m| (m, &wheels)));
    let mut best: Option<Suspect> = None;
    // The mistake outside, the culprit inside: large factors make wild motions, which are slow to compute.
    for ((factor, what), culprits) in mistakes {
        for (culprit, other) in promising(experiment, culprits, factor, nominal) {
            let Some(after) = cost(&other, before) else {
                continue;
            };
            let decrease = before - after;
            let better = best.as_ref().is_none_or(|b| decrease > b.decrease);
            if better && decrease > EXPLAINS * excess {
                best = Some(named(&culprit.name, factor, what, decrease, excess));
                // Right, not only better: the others need not be tried.
                if excess - decrease < RIGHT * dof {
                    return best;
                }
            }
        }
    }
    best
}

/// Each wheel, and all of them.
fn wheels(experiment: &Experiment) -> Vec<Culprit> {
    let wheels = &experiment.problem.model.wheels;
    let culprit = |name: &str, wheels| Culprit {
        name: name.to_owned(),
        wheels,
        thruster: None,
    };
    let mut list: Vec<Culprit> = wheels
        .iter()
        .enumerate()
        .map(|(k, w)| culprit(&w.name, vec![k]))
        .collect();
    if wheels.len() > 1 {
        list.push(culprit("all wheels", (0..wheels.len()).collect()));
    }
    list
}

/// Each thruster that fires.
fn thrusters(experiment: &Experiment) -> Vec<Culprit> {
    let segments = experiment.problem.segments;
    let fires = |k: usize| {
        let mut firings = segments.iter().flat_map(|s| &s.firings);
        firings.any(|f| f.thruster == k)
    };
    let all = experiment.thrusters.iter().enumerate();
    all.filter(|(k, _)| fires(*k))
        .map(|(k, t)| Culprit {
            name: t.name.clone(),
            wheels: Vec::new(),
            thruster: Some(k),
        })
        .collect()
}

/// The experiment with the speeds or the force of some culprits times the factor, for those with which the nominal numbers
/// fit better than `nominal`, without it; the best first. A mistake put right does not make them fit worse.
fn promising<'a>(
    experiment: &'a Experiment,
    culprits: &'a [Culprit],
    factor: f64,
    nominal: f64,
) -> Vec<(&'a Culprit, Experiment<'a>)> {
    let mut list = Vec::new();
    for culprit in culprits {
        let mut other = experiment.with_parameters(experiment.parameters);
        for (k, spin) in other.nominal_spin.iter_mut().enumerate() {
            *spin *= if culprit.wheels.contains(&k) {
                factor
            } else {
                1.0
            };
        }
        if let Some(thruster) = culprit.thruster.and_then(|k| other.thrusters.get_mut(k)) {
            thruster.direction_B *= factor;
        }
        let start = other.cost(&other.nominal_point());
        if let Some(start) = start.filter(|start| *start < nominal) {
            list.push((start, (culprit, other)));
        }
    }
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list.into_iter().map(|(_, one)| one).collect()
}

/// Chi-square that a fit from the nominal numbers leaves; given up where half of it has not come below what is to be
/// explained.
fn cost(other: &Experiment, before: f64) -> Option<f64> {
    let half = fit_from(other, other.nominal_point(), MISTAKE_ITERATIONS / 2)?;
    let after = other.chi2(&half.at, &half.evaluated)?;
    if half.settled || after > before {
        return Some(after);
    }
    let found = fit_from(other, half.at, MISTAKE_ITERATIONS / 2)?;
    other.chi2(&found.at, &found.evaluated)
}

fn named(owner: &str, factor: f64, what: &str, decrease: f64, excess: f64) -> Suspect {
    let (fault, name) = match what {
        "sign" => (FaultKind::WheelSign, format!("a wrong sign of {owner}")),
        "dead" => (FaultKind::Thrust, format!("no force of {owner}")),
        "direction" => (FaultKind::Thrust, format!("a wrong direction of {owner}")),
        _ => (
            FaultKind::Units,
            format!("a wrong unit of {owner} ({what})"),
        ),
    };
    Suspect {
        name,
        decrease,
        explains: (decrease / excess).clamp(0.0, 1.0),
        values: vec![(format!("{owner}.factor"), factor, "1")],
        fault,
        tied: false,
    }
}
