//! Values that a mistaken reference gives to an answer, and hardly any vehicle does: each is evidence against it.

use crate::problem::Problem;
use crate::problem::parameters::UnknownKind;
use crate::solution::estimate::{BodyEstimate, NamedNumber, Number};
use crate::solution::evidence::{Effect, Remark};
use crate::solution::solved::Solution;
use poinsot_dynamics::SensorError;
use poinsot_spatial::{MassProperties, Vector3};

/// Sigmas within which values are equal.
const EQUAL: f64 = 3.0;
/// Sigmas from which a value is not what it would be without a mistake.
const APART: f64 = 20.0;
/// Distance from nominal, radii of gyration, that a drawing is hardly wrong by: a frame may have its origin in the mass centre.
const FAR: f64 = 0.1;

/// A mass centre that is the origin of its body although nominal is far from it: what a velocity or position of the mass centre
/// gives. Most drawings have their origin elsewhere.
pub(super) fn at_origin(body: &BodyEstimate, nominal: &MassProperties) -> Option<Remark> {
    let value = all(&body.com, |n| n.value)?;
    let sigma = all(&body.com, |n| n.sigma.filter(|s| *s > 0.0))?;
    let within = (0..3).all(|k| value[k].abs() < EQUAL * sigma[k]);
    let away = nominal.p_BoBcm_B.norm();
    let name = &body.name;
    let far = away > FAR * nominal.radius_of_gyration() && away > APART * sigma.max();
    (body.asked && within && far).then(|| {
        let words = format!(
            "the mass centre of {name} is the origin of its axes within {:.1e} m, and nominal is {away:.2} m away: a velocity or position of the mass centre, not of the origin, gives that",
            EQUAL * sigma.max()
        );
        Remark::test(format!("mass centre of {name} at the origin"), Effect::AgainstAnswer, words)
            .statistic("distance of nominal, sigma", away / sigma.max())
    })
}

/// Three scales of one sensor that are equal and not one: what a clock at another rate gives, or another unit.
pub(super) fn equal_scales(
    problem: &Problem,
    solution: &Solution,
    nuisances: &[NamedNumber],
) -> Vec<Remark> {
    let unknowns = solution.parameters.unknowns.iter();
    let reported = unknowns.filter(|u| u.kind.is_reported()).zip(nuisances);
    let scales: Vec<(usize, &Number)> = reported
        .filter_map(|(unknown, found)| match unknown.kind {
            UnknownKind::Sensor {
                sensor,
                error: SensorError::Scale(_),
            } => Some((sensor, &found.number)),
            _ => None,
        })
        .collect();
    let groups = scales.chunk_by(|a, b| a.0 == b.0);
    groups.filter_map(|of| equal(problem, of)).collect()
}

fn equal(problem: &Problem, scales: &[(usize, &Number)]) -> Option<Remark> {
    let [(sensor, x), (_, y), (_, z)] = scales else {
        return None;
    };
    let three = [**x, **y, **z];
    let (value, sigma) = (all(&three, |n| n.value)?, all(&three, |n| n.sigma)?);
    let mean = value.mean();
    let equal = (0..3).all(|k| (value[k] - mean).abs() < EQUAL * sigma[k]);
    let name = &problem.model.sensors.get(*sensor)?.name;
    (equal && mean.abs() > APART * sigma.max()).then(|| {
        let words = format!(
            "the three scales of {name} are equal, {:.3} %: a clock that runs fast or slow by that gives the same",
            100.0 * mean
        );
        Remark::test(format!("equal scales of {name}"), Effect::AgainstAnswer, words)
            .statistic("scale, sigma", mean / sigma.max())
    })
}

fn all(numbers: &[Number; 3], of: impl Fn(&Number) -> Option<f64>) -> Option<Vector3> {
    let [x, y, z] = numbers;
    Some(Vector3::new(of(x)?, of(y)?, of(z)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_spatial::Matrix3;

    /// A body whose mass centre is estimated at these multiples of sigma along x, and whose nominal one is that far away.
    fn doubt(sigmas: f64, away: f64) -> Option<Remark> {
        let nominal = MassProperties {
            mass: 120.0,
            p_BoBcm_B: Vector3::new(away, 0.0, 0.0),
            I_BBcm_B: Matrix3::from_diagonal(&Vector3::new(15.0, 16.0, 12.0)),
        };
        let sigma = 7.0e-5;
        let com = [sigmas, 0.5, -0.3].map(|z| Number::data(z * sigma, sigma, away));
        let known = Number::known(1.0);
        let body =
            BodyEstimate::from_numbers("bus".to_owned(), known, com, [known; 6], [known; 10]);
        at_origin(&body, &nominal)
    }

    #[test]
    fn unit_a_mass_centre_at_the_origin_is_doubted_where_nominal_is_far() {
        let found = doubt(0.2, 0.1).unwrap();
        assert_eq!(found.effect, Effect::AgainstAnswer);
        assert!(
            found.words.contains("nominal is 0.10 m away"),
            "{}",
            found.words
        );
        // Another place, and an origin that was put into the mass centre.
        assert_eq!(doubt(4.0, 0.1), None);
        assert_eq!(doubt(0.2, 0.02), None);
    }
}
