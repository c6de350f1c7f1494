//! Meaning of a suspect's values, if clear: a wrong sign, a wrong unit.

use super::types::{FaultKind, Suspect};
use crate::fit::experiment::Experiment;

/// Name of the candidate that thrusters act at other times than their columns say.
pub(super) const LATE_THRUST: &str = "a lag of the thrust";
/// Factors of common unit errors.
const MISTAKEN: [(f64, &str); 4] = [
    (57.295_779_5, "radians used as degrees"),
    (0.017_453_293, "degrees used as radians"),
    (0.104_719_755, "revolutions per minute used as rad/s"),
    (std::f64::consts::TAU, "revolutions used as radians"),
];

pub(super) fn near(value: f64, wanted: f64) -> bool {
    (value / wanted - 1.0).abs() < 0.2
}

/// Names the meaning of values, if clear: a wrong sign, a wrong unit.
pub(super) fn name(experiment: &Experiment, suspect: &mut Suspect) {
    let model = experiment.problem.model;
    match suspect.fault {
        FaultKind::WheelScale => {
            let Some((owner, value, _)) = suspect.values.first() else {
                return;
            };
            let wheel = model
                .wheels
                .iter()
                .find(|w| *owner == format!("{}.spin_inertia", w.name));
            let Some(wheel) = wheel else { return };
            let ratio = value / wheel.spin_inertia;
            if near(ratio, -1.0) {
                suspect.fault = FaultKind::WheelSign;
                suspect.name = format!("a wrong sign of {}", wheel.name);
            } else if let Some((_, what)) = MISTAKEN.iter().find(|(f, _)| near(ratio, *f)) {
                suspect.fault = FaultKind::Units;
                suspect.name = format!("a wrong unit of {} ({what})", wheel.name);
            }
        }
        FaultKind::Firing => {
            if let Some((owner, factor, _)) = suspect.values.first()
                && near(factor - 1.0, -1.0)
            {
                let firing = owner.replace(".firing_at_", " at ").replace("_s", " s");
                suspect.name = format!("a firing that did not happen, {firing},");
            }
        }
        FaultKind::Lag
            if suspect.name == LATE_THRUST && suspect.values.first().is_some_and(|v| v.1 < 0.0) =>
        {
            "delayed thrust samples".clone_into(&mut suspect.name);
        }
        FaultKind::GyroScale => {
            for (factor, what) in MISTAKEN {
                // The gyro reads (1 + scale) w: the reading is 1/factor of what it should be.
                if suspect
                    .values
                    .iter()
                    .all(|(_, s, _)| near(1.0 + s, 1.0 / factor))
                {
                    suspect.fault = FaultKind::Units;
                    suspect.name = format!("a wrong unit of the gyro ({what})");
                }
            }
        }
        _ => {}
    }
}
