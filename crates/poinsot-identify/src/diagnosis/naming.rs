//! Meaning of a suspect's values, if clear: a wrong sign, a wrong unit.

use super::conventions::UNITS;
use super::types::{FaultKind, Suspect};
use crate::fit::experiment::Experiment;
use crate::problem::parameters::UnknownKind;

pub(super) fn near(value: f64, wanted: f64) -> bool {
    (value / wanted - 1.0).abs() < 0.2
}

/// Names the meaning of values, if clear: a wrong sign, a wrong unit.
pub(super) fn name(experiment: &Experiment, suspect: &mut Suspect) {
    let problem = experiment.problem;
    let Some((kind, value)) = suspect.first() else {
        return;
    };
    match *kind {
        UnknownKind::SpinInertia(wheel) => {
            let Some(wheel) = problem.model.wheels.get(wheel) else {
                return;
            };
            let ratio = value / wheel.spin_inertia;
            if near(ratio, -1.0) {
                suspect.fault = FaultKind::WheelSign;
                suspect.name = format!("a wrong sign of {}", wheel.name);
            } else if let Some((_, what)) = UNITS.iter().find(|(f, _)| near(ratio, *f)) {
                suspect.fault = FaultKind::Units;
                suspect.name = format!("a wrong unit of {} ({what})", wheel.name);
            }
        }
        UnknownKind::Firing {
            segment,
            firing,
            thruster,
        } if near(value - 1.0, -1.0) => {
            let firings = problem.segments.get(segment).map(|s| &s.firings);
            let start = firings.and_then(|f| f.get(firing)).map(|f| f.start_s);
            let thruster = problem.model.thrusters.get(thruster);
            if let (Some(start), Some(thruster)) = (start, thruster) {
                let firing = format!("{} at {start:.1} s", thruster.name);
                suspect.name = format!("a firing that did not happen, {firing},");
            }
        }
        UnknownKind::ThrusterLag(_) if value < 0.0 => {
            "delayed thrust samples".clone_into(&mut suspect.name);
        }
        UnknownKind::Sensor { .. } if suspect.fault == FaultKind::GyroScale => {
            for (factor, what) in UNITS {
                // The gyro reads (1 + scale) w: the reading is 1/factor of what it should be.
                let mut scales = suspect.values.iter().map(|v| 1.0 + v.value);
                if scales.all(|scale| near(scale, 1.0 / factor)) {
                    suspect.fault = FaultKind::Units;
                    suspect.name = format!("a wrong unit of the gyro ({what})");
                }
            }
        }
        _ => {}
    }
}
