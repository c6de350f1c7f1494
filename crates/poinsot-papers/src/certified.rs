//! Certifies the numbers of a published method by a method with uncertainty.
//!
//! The papers give neither uncertainty nor undetermined directions. A method of this project (the certificate)
//! computes both from the same data; only certified numbers enter the answer. Sigma is `sqrt(sigma^2 + difference^2)`,
//! with the certificate's sigma and the difference between both estimates. The error of an estimator is that of an
//! efficient one plus an independent difference (Hausman 1978).

use crate::answered::as_one;
use poinsot_dynamics::Kinematics;
use poinsot_identify::{
    BodyEstimate, Effect, Estimate, Number, Problem, Remark, Source, TENSOR, axis_name, tensor_name,
};
use poinsot_spatial::{InertialParameters, MassProperties, PARAMETER_NAMES};
use std::collections::HashMap;

/// Difference from the certificate, relative to the natural unit, that counts as evidence against the answer. A smaller
/// requested accuracy replaces it. The difference must also exceed [`APART_SIGMAS`].
const APART: f64 = 0.01;
/// Difference from the certificate in its sigmas.
const APART_SIGMAS: f64 = 5.0;

/// Replaces certified numbers of `estimate` by those of `bodies`; none with `withheld`.
pub(crate) fn put(
    problem: &Problem,
    estimate: &mut Estimate,
    bodies: &[InertialParameters],
    withheld: bool,
) {
    let values = values(problem, bodies);
    let certified = self::certified(estimate);
    let difference = |name: &String| match (values.get(name), certified.get(name)) {
        (Some(value), Some(certified)) => value - certified,
        _ => 0.0,
    };
    let differences: Vec<f64> = estimate.covariance_names.iter().map(difference).collect();
    for (row, a) in estimate.covariance.iter_mut().zip(&differences) {
        for (c, b) in row.iter_mut().zip(&differences) {
            *c += a * b;
        }
    }
    let limit = problem.relative_accuracy.min(APART);
    let mut worst: Option<(f64, String)> = None;
    for (k, (body, pi)) in estimate.bodies.iter_mut().zip(bodies).enumerate() {
        let found = replaced(body, pi, withheld);
        let gap = apart(body, &found, &problem.model.bodies[k].nominal);
        worst = worst
            .into_iter()
            .chain(gap)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        *body = found;
    }
    estimate.add(difference_row(worst, limit));
    if let Some((system, q)) = &mut estimate.system {
        let mut kinematics = Kinematics::new(problem.tree);
        kinematics.place(problem.tree, q);
        let whole = as_one(bodies, &kinematics);
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

/// The number with the largest difference from the certificate, in natural units, among those that differ
/// significantly.
fn apart(
    certified: &BodyEstimate,
    found: &BodyEstimate,
    nominal: &MassProperties,
) -> Option<(f64, String)> {
    let (m, L) = (nominal.mass, nominal.radius_of_gyration());
    let pairs = numbers(certified).into_iter().zip(numbers(found));
    let gaps = pairs.filter_map(|((name, a), (_, b))| {
        let gap = (b.value? - a.value?).abs();
        let unit = match name.split('_').next() {
            Some("mass") => m,
            Some("com") => L,
            _ => m * L * L,
        };
        (gap > APART_SIGMAS * a.sigma?).then(|| (gap / unit, format!("{}.{name}", found.name)))
    });
    gaps.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The ten numbers of a body, by their names in the covariance.
fn numbers(body: &BodyEstimate) -> Vec<(String, &Number)> {
    let com = (0..3).map(|k| (format!("com_{}", axis_name(k)), &body.com[k]));
    let inertia = (0..6).map(|k| (format!("inertia_{}", tensor_name(k)), &body.inertia[k]));
    let mass = std::iter::once(("mass".to_owned(), &body.mass));
    mass.chain(com).chain(inertia).collect()
}

/// Certified values, by their names in the covariance.
fn certified(estimate: &Estimate) -> HashMap<String, f64> {
    let of = |b: &BodyEstimate| {
        let all = numbers(b).into_iter();
        let given = all.filter_map(|(name, n)| Some((format!("{}.{name}", b.name), n.value?)));
        given.collect::<Vec<_>>()
    };
    estimate.bodies.iter().flat_map(of).collect()
}

/// Every number of every body, by its names as unknown and in the covariance.
fn values(problem: &Problem, bodies: &[InertialParameters]) -> HashMap<String, f64> {
    let mut all = HashMap::new();
    for (body, pi) in problem.model.bodies.iter().zip(bodies) {
        let mut add = |name: String, value: f64| all.insert(format!("{}.{name}", body.name), value);
        let array = pi.to_array();
        add("mass".to_owned(), array[0]);
        for (k, value) in array.into_iter().enumerate() {
            match k {
                0..=3 => add(PARAMETER_NAMES[k].to_owned(), value),
                _ => add(format!("I_BBo_{}", tensor_name(k - 4)), value),
            };
        }
        if let Some(p) = pi.mass_properties() {
            for k in 0..3 {
                add(format!("com_{}", axis_name(k)), p.p_BoBcm_B[k]);
            }
            for (k, e) in TENSOR.into_iter().enumerate() {
                add(format!("I_BBcm_{}", tensor_name(k)), p.I_BBcm_B[e]);
                add(format!("inertia_{}", tensor_name(k)), p.I_BBcm_B[e]);
            }
        }
    }
    all
}

fn replaced(body: &BodyEstimate, pi: &InertialParameters, withheld: bool) -> BodyEstimate {
    let p = pi.mass_properties().filter(|_| !withheld);
    let of = |number: &Number, value: Option<f64>| match (number.source, value) {
        (Source::Known | Source::Open, _) => *number,
        (_, None) => Number::undetermined(number.nominal),
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
