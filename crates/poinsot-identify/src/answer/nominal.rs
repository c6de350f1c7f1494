//! Distance of the estimated properties of a body from nominal.

use crate::problem::Problem;
use crate::solution::estimate::BodyEstimate;
use crate::solution::evidence::{Effect, Remark};
use poinsot_model::NOMINAL_WITHIN;
use poinsot_spatial::MassProperties;

/// One row per requested body with a determined property. Against the answer is one that is further from nominal than
/// the model allows.
pub(super) fn distances_from_nominal(problem: &Problem, bodies: &[BodyEstimate]) -> Vec<Remark> {
    let given = problem.model.bodies.iter().map(|b| &b.nominal);
    let within = problem.model.knowledge.nominal_within;
    let within = within.unwrap_or(NOMINAL_WITHIN);
    let pairs = bodies.iter().zip(given).filter(|(found, _)| found.asked);
    pairs
        .filter_map(|(found, given)| row(found, given, within))
        .collect()
}

/// One property relative to nominal.
struct Distance {
    statistic: (&'static str, f64),
    /// How far it is, to compare properties.
    size: f64,
    /// Whether it is beyond what the model allows by more than two sigma.
    beyond: bool,
    words: String,
}

/// The furthest property beyond the allowed distance, or else the furthest of all.
fn furthest(all: &[Distance]) -> Option<&Distance> {
    all.iter().max_by(|a, b| {
        let beyond = a.beyond.cmp(&b.beyond);
        beyond.then(a.size.total_cmp(&b.size))
    })
}

fn row(found: &BodyEstimate, given: &MassProperties, within: f64) -> Option<Remark> {
    let all = distances(found, given, within);
    let shown = furthest(&all)?;
    let effect = Effect::AgainstAnswer.if_failed(shown.beyond);
    let test = format!("distance of {} from nominal", found.name);
    let (statistic, value) = shown.statistic;
    Some(Remark::test(test, effect, &*shown.words).statistic(statistic, value))
}

fn distances(found: &BodyEstimate, given: &MassProperties, within: f64) -> Vec<Distance> {
    let name = &found.name;
    let ratio = |what: &str, value: f64, sigma: f64, nominal: f64| {
        let ratio = value / nominal;
        let beyond = lies_beyond(value, sigma, nominal, within);
        let limit = beyond.then(|| format!(", beyond the factor {within} of nominal_within"));
        let limit = limit.unwrap_or_default();
        (nominal > 0.0).then(|| Distance {
            statistic: ("ratio to nominal", ratio),
            size: ratio.abs().max(1.0 / ratio.abs()),
            beyond,
            words: format!("{what} of {name} is {ratio:.2} times nominal{limit}"),
        })
    };
    let mut list = Vec::new();
    if let (Some(m), Some(sigma)) = (found.mass.value, found.mass.sigma) {
        list.extend(ratio("the mass", m, sigma, given.mass));
    }
    let largest = |numbers: &[crate::solution::estimate::Number]| {
        let sigmas = numbers.iter().filter_map(|n| n.sigma);
        sigmas.fold(0.0, f64::max)
    };
    if let Some(principal) = &found.principal {
        let sigma = largest(&found.inertia);
        let pairs = principal.moments_kg_m2.into_iter().zip(given.principal().0);
        list.extend(
            pairs.filter_map(|(value, nominal)| ratio("a principal moment", value, sigma, nominal)),
        );
    }
    list.extend(centre(found, given, within, largest(&found.com)));
    list
}

fn centre(
    found: &BodyEstimate,
    given: &MassProperties,
    within: f64,
    sigma: f64,
) -> Option<Distance> {
    let apart = |k: usize| Some(found.com[k].value? - given.p_BoBcm_B[k]);
    let [x, y, z] = [apart(0)?, apart(1)?, apart(2)?];
    let (away, gyration) = (x.hypot(y).hypot(z), given.radius_of_gyration());
    let beyond = away - 2.0 * sigma > within * gyration;
    let limit = beyond.then(|| format!(", beyond the {within} of nominal_within"));
    let limit = limit.unwrap_or_default();
    let radii = away / gyration;
    (gyration > 0.0).then(|| Distance {
        statistic: ("radii of gyration", radii),
        size: radii,
        beyond,
        words: format!(
            "the mass centre of {} is {radii:.1} radii of gyration from nominal{limit}",
            found.name
        ),
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

#[cfg(test)]
mod tests {
    use super::{Distance, furthest, lies_beyond};

    /// The first of two moments beyond the factor was named, and a larger factor by it met the other one.
    #[test]
    fn regress_the_furthest_property_beyond_the_factor_is_named() {
        let of = |size: f64, beyond: bool| Distance {
            statistic: ("ratio to nominal", size),
            size,
            beyond,
            words: String::new(),
        };
        let all = [of(3.7, true), of(5.6, true), of(9.0, false)];
        assert_eq!(furthest(&all).map(|d| d.size), Some(5.6));
        assert_eq!(furthest(&all[2..]).map(|d| d.size), Some(9.0));
        assert!(furthest(&[]).is_none());
    }

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
