//! Hypotheses of external forces and torques.

use super::candidate::{Candidate, Columns, triple, unknown};
use super::types::FaultKind;
use crate::fit::experiment::Experiment;
use crate::motion::GRADIENT;
use crate::problem::parameters::UnknownKind;

/// Duration, s, of a tenth of a radian in low orbit.
const ORBITING: f64 = 100.0;

/// External forces and torques. A gravity gradient has unknown size and direction: a constant tensor in N, or one that
/// grows with time along the orbit.
pub(super) fn environment_candidates(experiment: &Experiment) -> Vec<Candidate> {
    let candidate = |name: &str, fault, unknowns| Candidate {
        name: name.to_owned(),
        fault,
        unknowns,
        columns: Columns::Slopes,
    };
    let tensor =
        |kind: fn(usize) -> UnknownKind, prefix: &str, of: std::ops::Range<usize>, unit| {
            let one = |k: usize| unknown(kind(k), format!("{prefix}_{}", k + 1), unit);
            of.map(one).collect::<Vec<_>>()
        };
    let mut tidal_force = tensor(UnknownKind::Tide, "tide.gradient", 0..GRADIENT, "1/s2");
    tidal_force.extend(tensor(
        UnknownKind::Tide,
        "tide.acceleration",
        GRADIENT..GRADIENT + 3,
        "m/s2",
    ));
    let mut list = vec![
        candidate(
            "a constant external torque",
            FaultKind::Torque,
            triple(UnknownKind::DisturbanceTorque, "environment.torque", "N m"),
        ),
        candidate(
            "drag",
            FaultKind::Drag,
            triple(UnknownKind::DragTorque, "environment.drag", "kg m2"),
        ),
        candidate(
            "a drift of the angular momentum",
            FaultKind::MomentumDrift,
            triple(UnknownKind::InertialTorque, "drift.torque", "N m"),
        ),
        candidate(
            "a drift of the linear momentum",
            FaultKind::ForceDrift,
            triple(UnknownKind::InertialForce, "drift.force", "N"),
        ),
        candidate("a tide", FaultKind::Tide, tidal_force),
    ];
    if experiment.parameters.gm.is_none() {
        let segments = experiment.problem.segments.iter();
        let span = segments.filter_map(|s| {
            let t = &s.observations.time_s;
            Some(t.last()? - t.first()?)
        });
        let numbers = match span.fold(0.0, f64::max) > ORBITING {
            true => 2 * GRADIENT,
            false => GRADIENT,
        };
        let gradient = UnknownKind::GravityGradient;
        list.push(candidate(
            "the gravity gradient",
            FaultKind::GravityGradient,
            tensor(gradient, "gravity_gradient.tensor", 0..numbers, "1/s2"),
        ));
    }
    list
}
