//! Meaning of a suspect's values, if clear: a wrong sign, a wrong unit.

use super::conventions::{late, mistake};
use super::types::{FaultKind, Suspect};
use crate::fit::experiment::Experiment;
use crate::problem::parameters::UnknownKind;
use poinsot_telemetry::UNIT_FACTORS;

pub(super) fn near(value: f64, wanted: f64) -> bool {
    (value / wanted - 1.0).abs() < 0.2
}

/// Names the meaning of values, if clear: a wrong sign, a wrong unit.
pub(super) fn name(experiment: &Experiment, suspect: &mut Suspect) {
    let problem = experiment.problem;
    let Some((kind, value)) = suspect.first().map(|(kind, value)| (kind.clone(), value)) else {
        return;
    };
    suspect.repair = late(problem, &kind, value);
    match kind {
        UnknownKind::SpinInertia(wheel) => {
            let Some(wheel) = problem.model.wheels.get(wheel) else {
                return;
            };
            let ratio = value / wheel.spin_inertia;
            let mut known = std::iter::once(-1.0).chain(UNIT_FACTORS);
            if let Some(x) = known.find(|x| near(ratio, *x)) {
                (suspect.fault, suspect.name) = mistake(&wheel.name, "rad/s", x);
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
            // The gyro reads (1 + scale) w: the reading is 1/factor of what it should be.
            let all = |x: &f64| suspect.values.iter().all(|v| near(1.0 + v.value, 1.0 / x));
            if let Some(x) = UNIT_FACTORS.into_iter().find(all) {
                (suspect.fault, suspect.name) = mistake("the gyro", "rad/s", x);
            }
        }
        _ => {}
    }
}
