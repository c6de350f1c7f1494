//! Certifies the numbers of a published method by a method with uncertainty.
//!
//! The papers give neither uncertainty nor undetermined directions. A method of this project (the certificate)
//! computes both from the same data; only certified numbers enter the answer. Sigma is `sqrt(sigma^2 + difference^2)`,
//! with the certificate's sigma and the difference between both estimates. The error of an estimator is that of an
//! efficient one plus an independent difference (Hausman 1978).

use poinsot_dynamics::{Kinematics, composite};
use poinsot_files::Faults;
use poinsot_identify::refusal::NO_VELOCITY;
use poinsot_identify::{
    BodyEstimate, Effect, Estimate, Number, Problem, Remark, Settings, Source, linear,
    maximum_likelihood_with,
};
use poinsot_spatial::{InertialParameters, MASS_PROPERTY_NAMES, MassProperties, PARAMETER_NAMES};
use std::collections::HashMap;

/// Difference from the certificate, relative to the natural unit, that counts as evidence against the answer. A smaller
/// requested accuracy replaces it. The difference must also exceed [`APART_SIGMAS`].
const APART: f64 = 0.01;
/// Difference from the certificate in its sigmas.
const APART_SIGMAS: f64 = 5.0;

/// The certificate: the linear method, or maximum likelihood where it has no equations for want of a velocity.
pub(crate) fn certificate(problem: &Problem) -> Result<Estimate, Faults> {
    match linear(problem) {
        Err(faults) if faults.code() == NO_VELOCITY => {
            let options = Settings {
                undiagnosed: true,
                ..Settings::default()
            };
            maximum_likelihood_with(problem, options)
        }
        other => other,
    }
}

/// Replaces certified numbers of `estimate` by those of `bodies`; none with `withheld`.
pub(crate) fn put(
    problem: &Problem,
    estimate: &mut Estimate,
    bodies: &[InertialParameters],
    withheld: bool,
) {
    let values = values(problem, bodies);
    let differences = differences(&values, estimate);
    for (row, a) in estimate.covariance.iter_mut().zip(&differences) {
        for (c, b) in row.iter_mut().zip(&differences) {
            *c += a * b;
        }
    }
    let mut worst: Option<(f64, String)> = None;
    for (k, (body, pi)) in estimate.bodies.iter_mut().zip(bodies).enumerate() {
        let found = replaced(body, pi, withheld);
        let gaps = gaps(body, &found, &problem.model.bodies[k].nominal);
        let all = worst.into_iter().chain(gaps);
        worst = all.max_by(|a, b| a.0.total_cmp(&b.0));
        *body = found;
    }
    estimate.add(difference_row(worst, problem.relative_accuracy.min(APART)));
    if let Some((system, q)) = &mut estimate.system {
        let kinematics = Kinematics::at(problem.tree, q);
        *system = replaced(system, &composite(bodies, &kinematics), withheld);
    }
    for combination in &mut estimate.identifiability.determined {
        let value = |name: &String| values.get(name).copied().unwrap_or(f64::NAN);
        let terms = combination.coefficients.iter();
        let value: f64 = terms.map(|(name, c)| c * value(name)).sum();
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
        estimate.states_covariance = false;
    }
}

/// The row of the largest significant difference from the certificate.
fn difference_row(worst: Option<(f64, String)>, limit: f64) -> Remark {
    let test = "difference from the reference estimate";
    let Some((gap, name)) = worst else {
        let words = "no significant difference from the reference estimate";
        return Remark::test(test, Effect::None, words);
    };
    let tail = match gap > limit {
        true => ": the method's approximations do not hold here; use --method auto",
        false => "",
    };
    let words = format!(
        "{name} differs from the reference estimate of the same data by {:.1} % of its natural unit{tail}",
        100.0 * gap
    );
    let effect = Effect::AgainstAnswer.if_failed(gap > limit);
    Remark::test(test, effect, words).statistic("share of the natural unit", gap)
}

/// Numbers that differ significantly from the certificate, with the difference in natural units.
fn gaps(
    certified: &BodyEstimate,
    found: &BodyEstimate,
    nominal: &MassProperties,
) -> Vec<(f64, String)> {
    let (before, after, units) = (
        certified.numbers(),
        found.numbers(),
        nominal.natural_units(),
    );
    let gap = |k: usize| {
        let gap = (after[k].value? - before[k].value?).abs();
        let name = format!("{}.{}", found.name, MASS_PROPERTY_NAMES[k]);
        (gap > APART_SIGMAS * before[k].sigma?).then_some((gap / units[k], name))
    };
    (0..10).filter_map(gap).collect()
}

/// Difference of every number in the covariance from the certificate; zero without one.
fn differences(values: &HashMap<String, f64>, estimate: &Estimate) -> Vec<f64> {
    let of = |name: &String| {
        let (body, number) = name.rsplit_once('.')?;
        let body = estimate.bodies.iter().find(|b| b.name == body)?;
        let at = MASS_PROPERTY_NAMES.iter().position(|n| *n == number)?;
        Some(values.get(name)? - body.numbers()[at].value?)
    };
    let names = estimate.covariance_names.iter();
    names.map(|name| of(name).unwrap_or(0.0)).collect()
}

/// Names of the ten parameters as unknowns.
pub(crate) fn parameter_names() -> [String; 10] {
    std::array::from_fn(|k| PARAMETER_NAMES[k].replace("I_", "I_BBo_"))
}

/// Every number of every body, by its names as unknown and in the covariance.
fn values(problem: &Problem, bodies: &[InertialParameters]) -> HashMap<String, f64> {
    let mut all = HashMap::new();
    for (body, pi) in problem.model.bodies.iter().zip(bodies) {
        let mut add = |name: &str, value: f64| all.insert(format!("{}.{name}", body.name), value);
        add(MASS_PROPERTY_NAMES[0], pi.mass);
        for (name, value) in parameter_names().iter().zip(pi.to_array()) {
            add(name, value);
        }
        let properties = pi.mass_properties();
        for (name, value) in MASS_PROPERTY_NAMES
            .iter()
            .zip(properties.iter().flat_map(MassProperties::to_array))
        {
            add(name, value);
            add(&name.replace("inertia_", "I_BBcm_"), value);
        }
    }
    all
}

fn replaced(body: &BodyEstimate, pi: &InertialParameters, withheld: bool) -> BodyEstimate {
    let of = |number: &Number, value: Option<f64>| match (number.source, value) {
        (Source::Known | Source::Open, _) => *number,
        (_, None) => Number::undetermined(number.nominal),
        (_, Some(value)) => {
            let apart = value - number.value.unwrap_or(value);
            let sigma = number.sigma.unwrap_or(0.0).hypot(apart);
            Number::data(value, sigma, number.nominal)
        }
    };
    let given = (!withheld).then_some(pi);
    let properties = given.and_then(InertialParameters::mass_properties);
    let ten = properties.as_ref().map(MassProperties::to_array);
    let parameters = given.map(InertialParameters::to_array);
    let mut out = BodyEstimate::from_numbers(
        body.name.clone(),
        of(&body.mass, parameters.map(|p| p[0])),
        std::array::from_fn(|k| of(&body.com[k], ten.map(|t| t[1 + k]))),
        std::array::from_fn(|k| of(&body.inertia[k], ten.map(|t| t[4 + k]))),
        std::array::from_fn(|k| of(&body.barycentric[k], parameters.map(|p| p[k]))),
    );
    out.asked = body.asked;
    out
}
