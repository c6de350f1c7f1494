//! Everything that may be wrong and was not unknown: each candidate is a group of unknowns.

use super::types::FaultKind;
use crate::information::Experiment;
use crate::likelihood::Sight;
use crate::parameters::{Unknown, UnknownKind, axis_name};
use crate::segment::InputErrors;
use poinsot_model::{JointKind, Model, SensorKind};

/// Candidate faults of one kind.
pub(super) struct Candidate {
    /// What it would be called.
    pub name: String,
    pub fault: FaultKind,
    pub unknowns: Vec<Unknown>,
}

impl Candidate {
    /// Whether it is a lag of what drives the vehicle.
    pub fn delays_inputs(&self) -> bool {
        let late = |kind: &UnknownKind| {
            kind.delays_inputs() || matches!(kind, UnknownKind::ThrusterLag(_))
        };
        self.unknowns.iter().any(|u| late(&u.kind))
    }
}

fn unknown(kind: UnknownKind, name: String, unit: &'static str) -> Unknown {
    Unknown {
        kind,
        name,
        unit,
        nominal: 0.0,
        natural: 1.0,
    }
}

fn triple(kind: fn(usize) -> UnknownKind, prefix: &str, unit: &'static str) -> Vec<Unknown> {
    (0..3)
        .map(|k| unknown(kind(k), format!("{prefix}_{}", axis_name(k)), unit))
        .collect()
}

/// Candidates that the fit did not have; the drift of momentum stands last.
pub(super) fn candidates(experiment: &Experiment) -> Vec<Candidate> {
    let mut list = of_sensors(experiment);
    list.extend(of_late_readings(experiment));
    list.extend(of_offsets(experiment));
    list.extend(of_surroundings());
    list.extend(of_actuators(experiment));
    if experiment.sight == Sight::Rotation {
        list.retain(|c| {
            !c.unknowns
                .iter()
                .any(|u| matches!(u.kind, UnknownKind::InertialForce(_)))
        });
    }
    let fitted = &experiment.parameters.unknowns;
    let has = |kind: &UnknownKind| fitted.iter().any(|u| u.kind == *kind);
    list.retain(|c| !c.unknowns.iter().any(|u| has(&u.kind)));
    list
}

fn of_sensors(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let name = |kind: SensorKind, otherwise: &'static str| {
        let own = model.sensors_of(kind).next();
        own.map_or(otherwise.to_owned(), |s| s.name.clone())
    };
    let gyro = name(SensorKind::Gyro, "gyro");
    let tracker = name(SensorKind::Attitude, "attitude");
    let new = |name: &str, fault, unknowns| Candidate {
        name: name.to_owned(),
        fault,
        unknowns,
    };
    vec![
        new(
            "a bias of the gyro",
            FaultKind::GyroBias,
            triple(UnknownKind::GyroBias, &format!("{gyro}.bias"), "rad/s"),
        ),
        new(
            "a scale error of the gyro",
            FaultKind::GyroScale,
            triple(UnknownKind::GyroScale, &format!("{gyro}.scale"), "1"),
        ),
        new(
            "a misalignment of the gyro",
            FaultKind::GyroMisalignment,
            triple(
                UnknownKind::GyroMisalignment,
                &format!("{gyro}.misalignment"),
                "rad",
            ),
        ),
        new(
            "a lag of the gyro",
            FaultKind::Lag,
            vec![unknown(UnknownKind::GyroLag, format!("{gyro}.lag"), "s")],
        ),
        new(
            "a lag of the attitude",
            FaultKind::Lag,
            vec![unknown(
                UnknownKind::AttitudeLag,
                format!("{tracker}.lag"),
                "s",
            )],
        ),
    ]
}

/// Lags of what is not gyro or attitude: position and velocity of the base, and the readings of joints and wheels
/// that drive the motion, sensor by sensor where sensors are declared.
fn of_late_readings(experiment: &Experiment) -> Vec<Candidate> {
    let (model, tree) = (experiment.problem.model, experiment.problem.tree);
    let late = |what: &str, owner: &str, kind| Candidate {
        name: format!("a lag of the {what}"),
        fault: FaultKind::Lag,
        unknowns: vec![unknown(kind, format!("{owner}.lag"), "s")],
    };
    let mut list = Vec::new();
    if experiment.sight != Sight::Rotation {
        for (kind, lag) in [
            (SensorKind::Velocity, UnknownKind::VelocityLag),
            (SensorKind::Position, UnknownKind::PositionLag),
        ] {
            let own = model.sensors_of(kind).find(|s| s.body == 0);
            list.push(late(kind.word(), own.map_or(kind.word(), |s| &s.name), lag));
        }
    }
    let joints = readers(model, SensorKind::JointPosition, model.joints.len());
    for (owner, of) in joints {
        let coordinates = (0..tree.dof())
            .filter(|k| of.contains(&tree.coordinates[*k]))
            .collect();
        list.push(late("joints", &owner, UnknownKind::JointLag(coordinates)));
    }
    for (owner, of) in readers(model, SensorKind::WheelSpeed, model.wheels.len()) {
        list.push(late("wheels", &owner, UnknownKind::WheelLag(of)));
    }
    let mut firings = experiment.problem.segments.iter().flat_map(|s| &s.firings);
    if firings.next().is_some() {
        for (owner, of) in readers(model, SensorKind::Thrust, model.thrusters.len()) {
            list.push(late("thrust", &owner, UnknownKind::ThrusterLag(of)));
        }
    }
    list.retain(|c| {
        !c.unknowns.iter().any(|u| match &u.kind {
            UnknownKind::JointLag(of)
            | UnknownKind::WheelLag(of)
            | UnknownKind::ThrusterLag(of) => of.is_empty(),
            _ => false,
        })
    });
    list
}

/// Offsets of the joints that are read, one by one.
fn of_offsets(experiment: &Experiment) -> Vec<Candidate> {
    let (model, tree) = (experiment.problem.model, experiment.problem.tree);
    let read = |k: usize| {
        let mut segments = experiment.problem.segments.iter();
        segments.any(|s| {
            let o = &s.observations;
            let given = o.joint_errors.get(k) == Some(&InputErrors::None);
            !given
                && o.joint_rate
                    .iter()
                    .skip(k)
                    .step_by(tree.dof())
                    .any(|r| *r != 0.0)
        })
    };
    let moving = (0..tree.dof()).filter(|k| read(*k));
    moving
        .map(|k| {
            let joint = &model.joints[tree.coordinates[k]];
            let unit = match joint.kind {
                JointKind::Prismatic => "m",
                _ => "rad",
            };
            let name = format!("{}.offset", joint.name);
            Candidate {
                name: format!("an offset of {}", joint.name),
                fault: FaultKind::JointOffset,
                unknowns: vec![unknown(UnknownKind::JointOffset(k), name, unit)],
            }
        })
        .collect()
}

/// Sensors of joints, wheels or thrusters with what each reads; all `count` of them as one where none is declared.
fn readers(model: &Model, kind: SensorKind, count: usize) -> Vec<(String, Vec<usize>)> {
    let own: Vec<_> = model
        .sensors_of(kind)
        .map(|s| (s.name.clone(), s.of.clone()))
        .collect();
    match own.is_empty() {
        true => vec![(kind.word().to_owned(), (0..count).collect())],
        false => own,
    }
}

fn of_surroundings() -> Vec<Candidate> {
    let mut drift = triple(UnknownKind::InertialTorque, "drift.torque", "N m");
    drift.extend(triple(UnknownKind::InertialForce, "drift.force", "N"));
    let force = drift.split_off(3);
    vec![
        Candidate {
            name: "a constant torque of the surroundings".to_owned(),
            fault: FaultKind::Torque,
            unknowns: triple(UnknownKind::DisturbanceTorque, "environment.torque", "N m"),
        },
        Candidate {
            name: "drag".to_owned(),
            fault: FaultKind::Drag,
            unknowns: triple(UnknownKind::DragTorque, "environment.drag", "kg m2"),
        },
        Candidate {
            name: "a drift of the angular momentum".to_owned(),
            fault: FaultKind::MomentumDrift,
            unknowns: drift,
        },
        Candidate {
            name: "a drift of the linear momentum".to_owned(),
            fault: FaultKind::MomentumDrift,
            unknowns: force,
        },
    ]
}

fn of_actuators(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let mut list = Vec::new();
    for (k, wheel) in model.wheels.iter().enumerate() {
        let mut spin = unknown(
            UnknownKind::SpinInertia(k),
            format!("{}.spin_inertia", wheel.name),
            "kg m2",
        );
        (spin.nominal, spin.natural) = (wheel.spin_inertia, wheel.spin_inertia);
        list.push(Candidate {
            name: format!("another spin inertia of {}", wheel.name),
            fault: FaultKind::WheelScale,
            unknowns: vec![spin],
        });
    }
    for (k, thruster) in model.thrusters.iter().enumerate() {
        let name = format!("{}.scale", thruster.name);
        list.push(Candidate {
            name: format!("another thrust of {}", thruster.name),
            fault: FaultKind::Thrust,
            unknowns: vec![unknown(UnknownKind::ThrusterScale(k), name, "1")],
        });
    }
    list
}
