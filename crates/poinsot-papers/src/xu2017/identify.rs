//! The paper's sequence as an answer to a [`Problem`]: certificate first, then its own numbers.
//!
//! The paper says nothing of what the data leave open and nothing of uncertainty. The linear method of the
//! ladder, which sees all segments at once and weighs them by their noise, says both: what it certifies may stand
//! in the answer. Sigma of a number is `sqrt(sigma^2 + difference^2)` with the ladder's sigma and the difference
//! of both answers: the error of an estimator is that of an efficient one plus an independent difference
//! (Hausman 1978), which holds what the swarm misses, too.

use super::error::Xu2017Error;
use super::sequence::{Found, Searched, Solver, StepReport, sequence};
use super::words::{notes, warnings};
use super::{Kind, Variant};
use crate::method::Named;
use poinsot_dynamics::{Kinematics, composite};
use poinsot_identify::{
    BodyEstimate, Estimate, FitOptions, MethodReport, NamedNumber, Number, ParametersError,
    Problem, ProblemError, Source, Status, TENSOR, axis_name, linear, maximum_likelihood_with,
    tensor_name,
};
use poinsot_spatial::{InertialParameters, PARAMETER_NAMES};
use std::collections::HashMap;

/// Identifies the bodies of a robot by the paper's sequence.
///
/// # Errors
/// The question cannot be put to this method. What the data leave open is an answer.
pub fn identify(problem: &Problem, variant: Variant) -> Result<Estimate, Xu2017Error> {
    let solver = Solver {
        kind: variant.solver,
        ..Solver::default()
    };
    identify_with(problem, variant, &solver)
}

/// The same with a swarm of one's own.
///
/// # Errors
/// As [`identify`].
pub fn identify_with(
    problem: &Problem,
    variant: Variant,
    solver: &Solver,
) -> Result<Estimate, Xu2017Error> {
    // The paper's own checks come first: their messages name what it needs.
    let found = sequence(problem, variant.order, solver)?;
    let mut estimate = certificate(problem)?;
    estimate.method = "xu2017".to_owned();
    estimate.variant = Some(variant.name().to_owned());
    estimate.assumptions.extend(found.notes.iter().cloned());
    let withheld = !found.steps.iter().all(StepReport::arrived);
    let values = values(problem, &found);
    replace(problem, &mut estimate, &found, &values, withheld);
    estimate
        .warnings
        .extend(warnings(problem, &found, solver.share));
    estimate.iterations = iterations(&found);
    estimate.method_report = Some(MethodReport {
        note: notes(variant, &found, &estimate),
        numbers: found.steps.iter().flat_map(numbers).collect(),
    });
    if withheld && estimate.status != Status::Rejected {
        estimate.status = Status::IterationLimit;
    }
    Ok(estimate)
}

/// What the data determine, and how well: the linear method, or maximum likelihood where the thrust segments show
/// attitude alone and the linear method cannot write its equations.
fn certificate(problem: &Problem) -> Result<Estimate, Xu2017Error> {
    match linear(problem) {
        Err(ProblemError::Parameters(ParametersError::RotationOfTree { .. })) => {
            let options = FitOptions {
                undiagnosed: true,
                ..FitOptions::default()
            };
            Ok(maximum_likelihood_with(problem, options)?)
        }
        other => Ok(other?),
    }
}

fn iterations(found: &Found) -> usize {
    let flights = found.steps.iter().filter_map(|s| s.flight.as_ref());
    let flown: usize = flights.map(|f| f.0.history.len() - 1).sum();
    flown.max(1)
}

/// Every number of every body by the names of the unknowns and of the covariance.
fn values(problem: &Problem, found: &Found) -> HashMap<String, f64> {
    let mut all = HashMap::new();
    for (body, pi) in problem.model.bodies.iter().zip(&found.bodies) {
        let name = &body.name;
        let array = pi.to_array();
        all.insert(format!("{name}.m"), array[0]);
        all.insert(format!("{name}.mass"), array[0]);
        for k in 0..3 {
            all.insert(format!("{name}.{}", PARAMETER_NAMES[1 + k]), array[1 + k]);
        }
        for k in 0..6 {
            all.insert(format!("{name}.I_BBo_{}", tensor_name(k)), array[4 + k]);
        }
        if let Some(p) = pi.mass_properties() {
            for k in 0..3 {
                all.insert(format!("{name}.com_{}", axis_name(k)), p.p_BoBcm_B[k]);
            }
            for (k, e) in TENSOR.into_iter().enumerate() {
                all.insert(format!("{name}.I_BBcm_{}", tensor_name(k)), p.I_BBcm_B[e]);
                all.insert(format!("{name}.inertia_{}", tensor_name(k)), p.I_BBcm_B[e]);
            }
        }
    }
    all
}

/// The method's numbers where the certificate stands; none where a swarm did not arrive.
fn replace(
    problem: &Problem,
    estimate: &mut Estimate,
    found: &Found,
    values: &HashMap<String, f64>,
    withheld: bool,
) {
    let differences: Vec<f64> = estimate
        .covariance_names
        .iter()
        .map(|name| difference(estimate, values, name))
        .collect();
    for (i, row) in estimate.covariance.iter_mut().enumerate() {
        for (j, c) in row.iter_mut().enumerate() {
            *c += differences[i] * differences[j];
        }
    }
    for (body, pi) in estimate.bodies.iter_mut().zip(&found.bodies) {
        *body = replaced(body, pi, withheld);
    }
    if let Some((system, q)) = &mut estimate.system {
        let mut kinematics = Kinematics::new(problem.tree);
        kinematics.place(problem.tree, q);
        let c = composite(&found.bodies, &kinematics);
        let whole = InertialParameters {
            mass: c.mass,
            mc_B: c.mc,
            I_BBo_B: c.I_SBo_B,
        };
        *system = replaced(system, &whole, withheld);
    }
    for combination in &mut estimate.identifiability.determined {
        let terms = combination.coefficients.iter();
        let value: f64 = terms
            .map(|(name, c)| c * values.get(name).copied().unwrap_or(f64::NAN))
            .sum();
        if value.is_finite() {
            combination.sigma = combination.sigma.hypot(value - combination.value);
            combination.value = value;
        }
    }
    if withheld {
        estimate.identifiability.determined.clear();
        estimate.covariance_names.clear();
        estimate.covariance_units.clear();
        estimate.covariance.clear();
        estimate.covariance_trustworthy = false;
    }
}

/// How far the method's number lies from the ladder's.
fn difference(estimate: &Estimate, values: &HashMap<String, f64>, name: &str) -> f64 {
    let Some(value) = values.get(name) else {
        return 0.0;
    };
    let Some((body, what)) = name.rsplit_once('.') else {
        return 0.0;
    };
    let Some(body) = estimate.bodies.iter().find(|b| b.name == body) else {
        return 0.0;
    };
    let axis = (0..3).find(|&k| what == format!("com_{}", axis_name(k)));
    let element = (0..6).find(|&k| what == format!("inertia_{}", tensor_name(k)));
    let number = match (axis, element) {
        (Some(k), _) => &body.com[k],
        (_, Some(k)) => &body.inertia[k],
        _ => &body.mass,
    };
    number.value.map_or(0.0, |ladder| value - ladder)
}

fn replaced(body: &BodyEstimate, pi: &InertialParameters, withheld: bool) -> BodyEstimate {
    let p = pi.mass_properties().filter(|_| !withheld);
    let of = |number: &Number, value: Option<f64>| match (number.source, value) {
        (Source::Known | Source::Open, _) => *number,
        (_, None) => Number::open(number.nominal),
        (_, Some(value)) => {
            let apart = value - number.value.unwrap_or(value);
            let sigma = number.sigma.unwrap_or(0.0).hypot(apart);
            Number::data(value, sigma, number.nominal)
        }
    };
    let array = pi.to_array();
    let raw = |k: usize| (!withheld).then_some(array[k]);
    let mut out = BodyEstimate::from_numbers(
        body.name.clone(),
        of(&body.mass, raw(0)),
        [0, 1, 2].map(|k| of(&body.com[k], p.map(|p| p.p_BoBcm_B[k]))),
        [0, 1, 2, 3, 4, 5].map(|k| of(&body.inertia[k], p.map(|p| p.I_BBcm_B[TENSOR[k]]))),
        std::array::from_fn(|k| of(&body.barycentric[k], raw(k))),
    );
    out.asked = body.asked;
    out
}

/// What one step found, in the method's own terms.
fn numbers(step: &StepReport) -> Vec<NamedNumber> {
    let plain = |name: &str, unit: &'static str, value: f64| NamedNumber {
        name: format!("{}: {name}", step.name),
        unit,
        number: Number {
            value: value.is_finite().then_some(value),
            sigma: None,
            nominal: 0.0,
            source: Source::Data,
        },
    };
    let of = match step.part {
        Searched::Single => "cost (37)",
        _ => "cost (52)",
    };
    let mut list = vec![
        plain(
            &format!("{of} of the linear solution"),
            "mixed",
            step.cost_linear,
        ),
        plain(
            "directions of ten that this step shows",
            "1",
            step.rank as f64,
        ),
        plain("condition of these", "1", step.condition),
    ];
    if let Some((flight, _)) = &step.flight {
        list.push(plain(&format!("{of} of the swarm"), "mixed", flight.cost));
        let iterations = (flight.history.len() - 1) as f64;
        list.push(plain("iterations of the swarm", "1", iterations));
    }
    list
}

impl Kind {
    /// In words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Linear => "linear solution",
            Self::Swarm => "particle swarm",
        }
    }
}
