//! Numbers of the bodies in an answer, and of the report of a method.

use poinsot_formats::finite;
use poinsot_identify::{BodyEstimate, Estimate, ReportedNumber};
use poinsot_model::{Body, Model};
use poinsot_spatial::{MASS_PROPERTY_NAMES, MassProperties};

/// A number of a method's report, without sigma.
pub(crate) fn printed(name: String, unit: &str, value: f64, nominal: f64) -> ReportedNumber {
    ReportedNumber {
        name,
        unit: unit.to_owned(),
        value: finite(value),
        sigma: None,
        nominal: finite(nominal),
    }
}

/// Bodies by a published method: its determined numbers, otherwise the numbers that it prints, otherwise nominal ones.
///
/// ```
#[doc = include_str!("../doc/record.txt")]
/// let input = record("linear", "ma2008/model.toml", "ma2008/traj1/telemetry.parquet")?;
/// let estimate = poinsot_identify::linear(&problem(&input))?;
/// let bodies = answered(&input.model, &estimate);
/// // The base was unknown, the arm keeps its nominal numbers.
/// assert!((bodies[0].mass - 1000.0).abs() < 1.0);
/// assert_eq!(bodies[1], input.model.bodies[1].nominal);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn answered(model: &Model, estimate: &Estimate) -> Vec<MassProperties> {
    let report = estimate.method_report.as_ref();
    let printed = |name: &str| {
        let report = report.filter(|_| model.bodies.len() == 1)?;
        report.numbers.iter().find(|n| n.name == name)?.value
    };
    let bodies = model.bodies.iter().zip(&estimate.bodies);
    let best = |(model, answer): (&Body, &BodyEstimate)| {
        let numbers = answer.numbers();
        let number = |k: usize| {
            let value = numbers[k].value.or_else(|| printed(MASS_PROPERTY_NAMES[k]));
            value.unwrap_or(numbers[k].nominal)
        };
        match answer.asked {
            true => MassProperties::from_array(&std::array::from_fn(number)),
            false => model.nominal,
        }
    };
    bodies.map(best).collect()
}
