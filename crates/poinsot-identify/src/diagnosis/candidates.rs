//! The registry of hypotheses: every possible fault that was not among the unknowns. Each is a group of numbers with
//! columns.

use super::candidate::{Candidate, Columns, unknown};
use super::changes::changes;
use super::environment::environment_candidates;
use super::types::FaultKind;
use crate::fit::experiment::{Experiment, Iterate};
use crate::likelihood::MeasuredMotion;
use crate::problem::Problem;
use crate::problem::parameters::{ErrorGroup, UnknownKind, axis_name};
use crate::problem::segment::InputErrors;
use poinsot_dynamics::SensorError;
use poinsot_model::{JointKind, KnownNumber, Model, SensorKind};

/// Candidates that the fit did not have at its answer; those with slopes of their own first, those made of others last.
pub(super) fn candidates(experiment: &Experiment, at: &Iterate) -> Vec<Candidate> {
    let mut list = of_sensors(experiment);
    list.extend(of_late_readings(experiment));
    list.extend(of_offsets(experiment));
    list.extend(environment_candidates(experiment));
    list.extend(of_actuators(experiment));
    list.extend(of_propellant(experiment));
    if experiment.measured_motion == MeasuredMotion::Rotation {
        list.retain(|c| {
            !c.unknowns
                .iter()
                .any(|u| matches!(u.kind, UnknownKind::InertialForce(_) | UnknownKind::Tide(_)))
        });
    }
    let fitted = &experiment.parameters.unknowns;
    let has = |kind: &UnknownKind| fitted.iter().any(|u| u.kind == *kind);
    list.retain(|c| !c.unknowns.iter().any(|u| has(&u.kind)));
    // A known number with uncertainty is an unknown already and is tested against its sigma.
    let known = |kind: &UnknownKind| {
        let number = known_number(experiment.problem.model, kind);
        let mut all = fitted.iter().filter_map(|u| u.kind.known());
        number.is_some_and(|n| all.any(|k| k.number == n))
    };
    list.retain(|c| !c.unknowns.iter().any(|u| known(&u.kind)));
    list.extend(changes(experiment, at));
    list.extend(of_drifts(experiment));
    list
}

/// Drifts of biases: of rates, and of the attitude.
fn of_drifts(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let read = sensors_read(experiment.problem).into_iter();
    let drifts = |sensor: &usize| {
        let kind = model.sensors[*sensor].kind;
        matches!(kind, SensorKind::Gyro | SensorKind::Attitude)
    };
    read.filter(|(sensor, _)| drifts(sensor))
        .map(|(sensor, name)| {
            let own = &model.sensors[sensor];
            let unit = match own.kind {
                SensorKind::Gyro => "rad/s2",
                _ => "rad/s",
            };
            let number = |axis: usize| {
                let name = format!("{}.bias_drift_{}", own.name, axis_name(axis));
                unknown(UnknownKind::Changed, name, unit)
            };
            Candidate {
                name: format!("a drift of the bias of the {}", name.replace('_', " ")),
                fault: FaultKind::BiasDrift,
                unknowns: (0..3).map(number).collect(),
                columns: Columns::Ramp { sensor },
            }
        })
        .collect()
}

/// Mass that bodies lose as their thrusters fire: how much, and by the place that it comes from.
fn of_propellant(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let firings = experiment.problem.segments.iter().flat_map(|s| &s.firings);
    let mut hosts: Vec<usize> = firings
        .filter(|f| f.force != 0.0)
        .filter_map(|f| Some(model.thrusters.get(f.thruster)?.body))
        .collect();
    hosts.sort_unstable();
    hosts.dedup();
    let number = |body: usize, axis: Option<usize>| {
        let name = &model.bodies[body].name;
        let (what, unit) = match axis {
            None => ("propellant_use".to_owned(), "kg/(N s)"),
            Some(k) => (format!("propellant_moment_{}", axis_name(k)), "kg m/(N s)"),
        };
        let kind = UnknownKind::PropellantUse {
            body,
            thruster: None,
            p_BoF_B: model.bodies[body].nominal.p_BoBcm_B,
            axis,
        };
        unknown(kind, format!("{name}.{what}"), unit)
    };
    let candidate = |body: usize| Candidate {
        name: format!("the propellant that {} uses", model.bodies[body].name),
        fault: FaultKind::PropellantUse,
        unknowns: [None, Some(0), Some(1), Some(2)]
            .map(|axis| number(body, axis))
            .into(),
        columns: Columns::Slopes,
    };
    hosts.into_iter().map(candidate).collect()
}

/// The number of the model that an unknown changes.
fn known_number(model: &Model, kind: &UnknownKind) -> Option<KnownNumber> {
    match kind {
        UnknownKind::SpinInertia(k) => Some(KnownNumber::SpinInertia(*k)),
        UnknownKind::WheelTilt(k, _) => Some(KnownNumber::WheelAxis(*k)),
        UnknownKind::ThrusterScale(k) => Some(KnownNumber::Force(*k)),
        UnknownKind::Sensor { sensor, error } => {
            let attitude = model.sensors.get(*sensor)?.kind.is_rotation();
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
/// the choice of a frame, or equals the opposite error of another sensor of the same motion.
fn of_sensors(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let read = sensors_read(experiment.problem);
    let kind = |sensor: usize| model.sensors[sensor].kind;
    let mut list = Vec::new();
    for (sensor, name) in &read {
        let own = kind(*sensor);
        if experiment.measured_motion == MeasuredMotion::Rotation
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
            // A misaligned tracker is more than a choice of N.
            let turned = own.is_rotation() && group.key == "bias";
            if framed && alone && group.key != "lag" && !turned {
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
            let word = match group.key {
                "scale" => "scale error",
                "bias" if turned => "misalignment",
                key => key,
            };
            list.push(Candidate {
                name: format!("a {word} of the {}", name.replace('_', " ")),
                fault: fault_of(own, group),
                unknowns: errors.collect(),
                columns: Columns::Slopes,
            });
        }
    }
    list
}

fn fault_of(kind: SensorKind, group: &ErrorGroup) -> FaultKind {
    match (group.key, kind) {
        ("bias", SensorKind::Gyro) => FaultKind::GyroBias,
        ("bias", SensorKind::Attitude) => FaultKind::TrackerMisalignment,
        ("bias", kind) if kind.is_rotation() => FaultKind::SensorMisalignment,
        ("bias", _) => FaultKind::SensorBias,
        ("scale", SensorKind::Gyro) => FaultKind::GyroScale,
        ("scale", _) => FaultKind::SensorScale,
        ("misalignment", SensorKind::Gyro) => FaultKind::GyroMisalignment,
        ("misalignment", _) => FaultKind::SensorMisalignment,
        ("nonorthogonality", _) => FaultKind::Nonorthogonality,
        _ => FaultKind::Lag,
    }
}

/// Lags of the samples of joints, wheels and thrusters that drive the motion, sensor by sensor where sensors are
/// declared.
fn of_late_readings(experiment: &Experiment) -> Vec<Candidate> {
    let (model, tree) = (experiment.problem.model, experiment.problem.tree);
    let late = |what: &str, owner: &str, kind| Candidate {
        name: format!("a lag of the {what}"),
        fault: FaultKind::Lag,
        unknowns: vec![unknown(kind, format!("{owner}.lag"), "s")],
        columns: Columns::Slopes,
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
                columns: Columns::Slopes,
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
            columns: Columns::Slopes,
        });
        let tilt = |i: usize| {
            let name = format!("{}.misalignment_{}", wheel.name, i + 1);
            unknown(UnknownKind::WheelTilt(k, i), name, "rad")
        };
        list.push(Candidate {
            name: format!("a tilt of {}", wheel.name),
            fault: FaultKind::WheelTilt,
            unknowns: vec![tilt(0), tilt(1)],
            columns: Columns::Slopes,
        });
    }
    for (k, thruster) in model.thrusters.iter().enumerate() {
        let name = format!("{}.scale", thruster.name);
        list.push(Candidate {
            name: format!("another thrust of {}", thruster.name),
            fault: FaultKind::Thrust,
            unknowns: vec![unknown(UnknownKind::ThrusterScale(k), name, "1")],
            columns: Columns::Slopes,
        });
    }
    list
}
