//! Texts about determined and undetermined directions, and warnings.

use super::both::NoisySolution;
use super::solution::Directions;
use super::ten::{MISFIT, Ten, unit};
use poinsot_identify::{
    DeterminedCombination, Identifiability, Problem, UnobservableCombination, axis_name,
    tensor_name,
};
use poinsot_model::{Nuisance, SensorKind};

/// Range of the ratio of arm mass to base mass in the paper.
const STUDIED: [f64; 2] = [0.005, 0.5];

pub(super) fn identifiability(
    name: &str,
    solved: &NoisySolution,
    ten: &Ten,
    rejected: bool,
) -> Identifiability {
    let names: [String; 10] = std::array::from_fn(|k| match k {
        0 => format!("{name}.mass"),
        1..=3 => format!("{name}.com_{}", axis_name(k - 1)),
        _ => format!("{name}.I_BBcm_{}", tensor_name(k - 4)),
    });
    let mut found = Identifiability {
        parameters: 10,
        ..Identifiability::default()
    };
    let lone = solved.linear.usable == [true, false, false, false]
        || !ten.open[0] && ten.open[1..4].contains(&true);
    let (why, remedy) = if lone {
        (
            "the base hardly turns: the mass centre enters only in w x rho_S",
            "give the vehicle a spin, or move the arm about two axes",
        )
    } else {
        (
            "the velocities of the base change no more than their declared noise",
            "move the arm between configurations that differ as much as possible, or give the vehicle momentum (known-momentum)",
        )
    };
    describe(
        &mut found,
        &solved.linear,
        &names[..4],
        ten,
        0,
        (why, remedy),
        rejected,
    );
    match &solved.angular {
        Some((_, directions)) => {
            let why = "the angular velocity of the base does not span all directions (stopped joints need an initial spin; spin about one axis needs arm motion about two)";
            let remedy = "spin about two axes, move the arm about two axes, or keep moving samples";
            describe(
                &mut found,
                directions,
                &names[4..],
                ten,
                4,
                (why, remedy),
                rejected,
            );
        }
        None => {
            for name in &names[4..] {
                found.open.push(UnobservableCombination {
                    text: name.clone(),
                    coefficients: vec![(name.clone(), 1.0)],
                    reason: "step 2 needs mass and mass centre, which step 1 does not determine"
                        .to_owned(),
                    remedy: remedy.to_owned(),
                    walk: Vec::new(),
                });
                found.sigmas_natural.push(f64::INFINITY);
            }
        }
    }
    found
}

/// Rank, sigmas, determined and undetermined directions of one step.
pub(super) fn describe<const N: usize>(
    found: &mut Identifiability,
    d: &Directions<N>,
    names: &[String],
    ten: &Ten,
    at: usize,
    (reason, remedy): (&str, &str),
    rejected: bool,
) {
    let complete = d.usable.iter().all(|u| *u);
    let floor = 32.0 * N as f64 * f64::EPSILON * d.singular[0].max(f64::MIN_POSITIVE);
    found.structural_rank += d.singular.iter().filter(|s| **s > floor).count();
    let natural: [f64; N] = std::array::from_fn(|i| {
        if at + i == 0 {
            ten.value[0]
        } else {
            d.natural[i]
        }
    });
    for j in 0..N {
        let sign = |i: usize| if at + i == 0 { -1.0 } else { 1.0 };
        // Sigma along the direction: its diagonal element of the covariance in natural units.
        let v: [f64; N] = std::array::from_fn(|i| sign(i) * d.V[(i, j)]);
        let variance: f64 = (0..N)
            .flat_map(|i| (0..N).map(move |k| (i, k)))
            .map(|(i, k)| {
                v[i] * v[k] * ten.covariance[(at + i, at + k)] / (natural[i] * natural[k])
            })
            .sum();
        let usable = d.usable[j] && !rejected;
        found.rank += usize::from(usable);
        found.sigmas_natural.push(if d.usable[j] {
            variance.sqrt()
        } else {
            f64::INFINITY
        });
        if complete && !rejected {
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
        let coefficients: Vec<(String, f64)> =
            terms().map(|i| (names[i].clone(), weigh(i))).collect();
        let text = sentence(&coefficients);
        if usable {
            found.determined.push(DeterminedCombination {
                text,
                coefficients,
                unit: unit(at + lead),
                value: terms().map(|i| weigh(i) * ten.value[at + i]).sum(),
                sigma: ten.inflation * variance.sqrt() * scale.abs(),
            });
            continue;
        }
        let (reason, remedy) = match rejected {
            true => ("the answer is rejected", "see the warnings"),
            false => (reason, remedy),
        };
        found.open.push(UnobservableCombination {
            text,
            coefficients,
            reason: reason.to_owned(),
            remedy: remedy.to_owned(),
            walk: Vec::new(),
        });
    }
}

pub(super) fn sentence(terms: &[(String, f64)]) -> String {
    let lead = terms
        .iter()
        .map(|t| t.1.abs())
        .fold(0.0, f64::max)
        .max(f64::MIN_POSITIVE);
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
    rejected: bool,
    base: &poinsot_identify::BodyEstimate,
) -> Vec<String> {
    let mut list = Vec::new();
    let chi2 = solved.chi2;
    list.extend(misfit(chi2, contradicted, rejected));
    let ratio = solved.x[0];
    if !ten.open[0] && !(STUDIED[0]..=STUDIED[1]).contains(&ratio) {
        list.push(format!(
            "the arm has {:.1} % of the base's mass; the paper studied 0.5 to 50 %",
            100.0 * ratio
        ));
    }
    if ratio <= 0.0 {
        list.push(
            "step 1 gives a negative mass: noise or a wrong model dominates it; no number is given"
                .to_owned(),
        );
    }
    let bias = problem
        .model
        .sensors_of(SensorKind::Gyro)
        .any(|s| s.bias != Nuisance::Known);
    if bias {
        list.push(
            "the gyro's bias is declared unknown: ma2008 assumes zero; --method auto estimates it"
                .to_owned(),
        );
    }
    if problem
        .model
        .bodies
        .first()
        .is_some_and(|b| b.prior.is_some())
    {
        list.push("the base's prior is not used by ma2008".to_owned());
    }
    let relative = ten
        .bias
        .iter()
        .zip(&ten.value)
        .take(1)
        .map(|(b, v)| (b / v).abs());
    let worst = relative
        .chain(
            (4..10).map(|k| (ten.bias[k] / solved.linear.natural[1].powi(2) / ten.value[0]).abs()),
        )
        .fold(0.0, f64::max);
    if worst > 1.0e-6 && !rejected {
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
