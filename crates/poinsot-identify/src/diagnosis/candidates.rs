//! Everything that may be wrong and was not unknown: each candidate is a group of unknowns.

use super::types::FaultKind;
use crate::information::Experiment;
use crate::likelihood::Sight;
use crate::parameters::{ErrorGroup, Unknown, UnknownKind, axis_name};
use crate::problem::Problem;
use crate::segment::InputErrors;
use poinsot_dynamics::SensorError;
use poinsot_model::{JointKind, KnownNumber, Model, SensorKind};

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
    // A known number within its uncertainty is an unknown already, and is tested against that.
    let known = |kind: &UnknownKind| {
        let number = known_number(experiment.problem.model, kind);
        let mut all = fitted.iter().filter_map(|u| u.kind.known());
        number.is_some_and(|n| all.any(|k| k.number == n))
    };
    list.retain(|c| !c.unknowns.iter().any(|u| known(&u.kind)));
    list
}

/// The number of the model that an unknown changes.
fn known_number(model: &Model, kind: &UnknownKind) -> Option<KnownNumber> {
    match kind {
        UnknownKind::SpinInertia(k) => Some(KnownNumber::SpinInertia(*k)),
        UnknownKind::WheelTilt(k, _) => Some(KnownNumber::WheelAxis(*k)),
        UnknownKind::ThrusterScale(k) => Some(KnownNumber::Force(*k)),
        UnknownKind::Sensor { sensor, error } => {
            let attitude = model.sensors.get(*sensor)?.kind == SensorKind::Attitude;
            let turns = match error {
                SensorError::Misalignment(_) => !attitude,
                SensorError::Bias(_) => attitude,
                _ => false,
            };
            turns.then_some(KnownNumber::Mounting(*sensor))
        }
        _ => None,
    }
}

/// Sensors of the model that have samples in any segment, with their names in results.
pub(super) fn sensors_read(problem: &Problem) -> Vec<(usize, String)> {
    let mut list: Vec<(usize, String)> = Vec::new();
    let segments = problem.segments.iter();
    for record in segments.flat_map(|s| &s.observations.sensors) {
        let known = |sensor: usize| list.iter().any(|s| s.0 == sensor);
        if let Some(sensor) = record.sensor.filter(|s| !known(*s))
            && !record.samples.is_empty()
            && !record.is_exact()
        {
            list.push((sensor, record.name.clone()));
        }
    }
    list
}

/// Every error of every sensor that is read. A bias, scale or turn of the only sensor of the pose, or of a velocity, is
/// the choice of a frame, or what another sensor of the same motion is said to have.
fn of_sensors(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let read = sensors_read(experiment.problem);
    let kind = |sensor: usize| model.sensors[sensor].kind;
    let mut list = Vec::new();
    for (sensor, name) in &read {
        let own = kind(*sensor);
        if experiment.sight == Sight::Rotation
            && matches!(own, SensorKind::Position | SensorKind::Velocity)
        {
            continue;
        }
        let framed = matches!(
            own,
            SensorKind::Attitude | SensorKind::Position | SensorKind::Velocity
        );
        let alone = read.iter().filter(|(s, _)| kind(*s) == own).count() == 1;
        for group in ErrorGroup::of(own) {
            if framed && alone && group.key != "lag" {
                continue;
            }
            let errors = group.errors.iter().map(|(error, what)| {
                let kind = UnknownKind::Sensor {
                    sensor: *sensor,
                    error: *error,
                };
                let name = format!("{}.{what}", model.sensors[*sensor].name);
                unknown(kind, name, group.unit(own))
            });
            let word = if group.key == "scale" {
                "scale error"
            } else {
                group.key
            };
            list.push(Candidate {
                name: format!("a {word} of the {}", name.replace('_', " ")),
                fault: fault_of(own, group),
                unknowns: errors.collect(),
            });
        }
    }
    list
}

fn fault_of(kind: SensorKind, group: &ErrorGroup) -> FaultKind {
    match (group.key, kind) {
        ("bias", SensorKind::Gyro) => FaultKind::GyroBias,
        ("bias", _) => FaultKind::SensorBias,
        ("scale", SensorKind::Gyro) => FaultKind::GyroScale,
        ("scale", _) => FaultKind::SensorScale,
        ("misalignment", SensorKind::Gyro) => FaultKind::GyroMisalignment,
        ("misalignment", _) => FaultKind::SensorMisalignment,
        ("nonorthogonality", _) => FaultKind::Nonorthogonality,
        _ => FaultKind::Lag,
    }
}

/// Lags of the readings of joints, wheels and thrusters that drive the motion, sensor by sensor where sensors are declared.
fn of_late_readings(experiment: &Experiment) -> Vec<Candidate> {
    let (model, tree) = (experiment.problem.model, experiment.problem.tree);
    let late = |what: &str, owner: &str, kind| Candidate {
        name: format!("a lag of the {what}"),
        fault: FaultKind::Lag,
        unknowns: vec![unknown(kind, format!("{owner}.lag"), "s")],
    };
    let mut list = Vec::new();
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
