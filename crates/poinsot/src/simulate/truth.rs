//! `truth.json`: the true values for an identification.

use super::record::Recorder;
use super::stream;
use crate::case::Case;
use crate::channel_names::position;
use crate::estimate_file::reference;
use indexmap::IndexMap;
use poinsot_dynamics::propagation::ModeNumber;
use poinsot_dynamics::{MotionSample, WheelUse, composite};
use poinsot_formats::{
    Axes, BarycentricFile, InitialFile, JointStateFile, MassFile, MomentumFile, PrincipalFile,
    TRUTH, TrueBodyFile, TrueNumberFile, TrueRunFile, TrueSensorFile, TruthFile, WheelUseFile,
    address,
};
use poinsot_identify::ErrorGroup;
use poinsot_model::{ErrorKey, JointKind, Model, Sensor, SensorKind};
use poinsot_spatial::{MassProperties, UnitQuaternion, Vector3};

/// The true values of what a recorder took; `used` is the use of the wheels by a controller, empty without one.
pub(super) fn truth(
    case: &Case,
    model: &Model,
    recorder: &Recorder,
    used: &[WheelUse],
) -> TruthFile {
    let first = recorder.first.as_ref();
    let bodies = model.bodies.iter();
    let sensors = model.sensors.iter().enumerate();
    let used = model.wheels.iter().zip(used);
    TruthFile {
        schema: TRUTH.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        model: model.name.clone(),
        reference: reference(model),
        run: Some(TrueRunFile {
            duration_s: case.duration_s,
            rate_hz: case.rate_hz,
            seed: case.seed,
            trial: recorder.trial,
        }),
        files: IndexMap::new(),
        initial: first.map(|s| initial(model, s)),
        bodies: bodies.map(|b| (b.name.clone(), body(&b.nominal))).collect(),
        system: first.map(|s| system(model, s)).into_iter().collect(),
        momentum: first.map(momentum).into_iter().collect(),
        nuisance: nuisance(model, recorder),
        sensors: sensors
            .map(|(i, s)| (s.name.clone(), sensor(case, model, recorder, i)))
            .collect(),
        wheel_use: used
            .map(|(wheel, used)| (wheel.name.clone(), wheel_use(used)))
            .collect(),
    }
}

/// Spin inertias, numbers of modes and the nonzero errors of sensors.
fn nuisance(model: &Model, recorder: &Recorder) -> IndexMap<String, TrueNumberFile> {
    let mut out = IndexMap::new();
    let mut put = |name: String, unit: &str, value: f64| {
        out.insert(address(&name, unit), TrueNumberFile { value });
    };
    for wheel in &model.wheels {
        let name = format!("{}.spin_inertia", wheel.name);
        put(name, "", wheel.spin_inertia);
    }
    for flexible in &model.modes {
        for number in ModeNumber::groups().into_iter().flatten() {
            let name = format!("{}.{}", flexible.name, number.name());
            put(name, number.unit(), flexible.mode.get(*number));
        }
    }
    for joint in model.joints.iter().filter(|j| j.is_passive()) {
        for (number, value) in joint.spring_numbers() {
            let name = format!("{}.{}", joint.name, number.name());
            put(name, number.unit(joint.slides()), value);
        }
    }
    for (i, sensor) in model.sensors.iter().enumerate() {
        let Some(instrument) = recorder.instrument(i) else {
            continue;
        };
        let name = &sensor.name;
        if sensor.kind.is_scalar() {
            let own = scalar_errors(model, sensor, instrument.bias(), instrument.scales());
            own.into_iter()
                .for_each(|(name, unit, value)| put(name, unit, value));
            if instrument.lag_s() != 0.0 {
                put(format!("{name}.lag"), "s", instrument.lag_s());
            }
        }
        for group in ErrorGroup::of(sensor.kind) {
            for error in group.errors() {
                let value = instrument.error(error);
                if value != 0.0 || group.key == ErrorKey::Bias {
                    let name = format!("{name}.{}", group.end(error));
                    put(name, group.unit(sensor.kind), value);
                }
            }
        }
    }
    out
}

fn sensor(case: &Case, model: &Model, recorder: &Recorder, i: usize) -> TrueSensorFile {
    let sensor = &model.sensors[i];
    let axes = if sensor.kind.is_scalar() { 1 } else { 3 };
    let covariance = sensor.covariance().map(|c| {
        let row = |r: usize| (0..axes).map(|k| c[(r, k)]).collect();
        (0..axes).map(row).collect()
    });
    TrueSensorFile {
        kind: sensor.kind.word().to_owned(),
        unit: model.unit_of(sensor).to_owned(),
        stream: stream(recorder.trial, i),
        rate_hz: case.rate_hz / recorder.every(i) as f64,
        covariance,
        quantisation: sensor.quantisation,
    }
}

/// Name, unit and value of each bias, and of each scale that is not zero, of a sensor of joints, wheels or thrusters: those of an
/// estimate.
pub(crate) fn scalar_errors(
    model: &Model,
    sensor: &Sensor,
    biases: &[f64],
    scales: &[f64],
) -> Vec<(String, &'static str, f64)> {
    let [of_bias, of_scale] = match sensor.kind {
        SensorKind::JointPosition => ["offset", "position_scale"],
        SensorKind::JointRate => ["rate_bias", "rate_scale"],
        SensorKind::WheelSpeed => ["speed_bias", "speed_scale"],
        _ => ["thrust_bias", "thrust_scale"],
    };
    let unit = model.unit_of(sensor);
    let names = sensor.of.iter().filter_map(|k| model.measured(sensor, *k));
    let bias = names.clone().zip(biases);
    let bias = bias.map(|(name, x)| (format!("{name}.{of_bias}"), unit, *x));
    let scale = names.zip(scales).filter(|(_, x)| **x != 0.0);
    let scale = scale.map(|(name, x)| (format!("{name}.{of_scale}"), "", *x));
    bias.chain(scale).collect()
}

fn number(value: f64) -> TrueNumberFile {
    TrueNumberFile { value }
}

fn axes(v: &Vector3) -> Axes<TrueNumberFile> {
    Axes::of([v.x, v.y, v.z].map(number))
}

pub(crate) fn mass(p: &MassProperties) -> MassFile<TrueNumberFile> {
    MassFile::of(p.to_array().map(number))
}

fn body(properties: &MassProperties) -> TrueBodyFile {
    let (moments_kg_m2, axes_of) = properties.principal();
    let axes_of = nalgebra::Rotation3::from_matrix_unchecked(axes_of);
    let parameters = properties.parameters().to_array();
    TrueBodyFile {
        principal: Some(PrincipalFile {
            moments_kg_m2,
            axes_xyzw: UnitQuaternion::from_rotation_matrix(&axes_of).coords.into(),
        }),
        barycentric: Some(BarycentricFile::of(parameters.map(number))),
        physically_consistent: Some(properties.check_physical(1e-9).is_ok()),
        ..TrueBodyFile::of(mass(properties))
    }
}

/// Pose and motion of the base and the joints at time zero.
fn initial(model: &Model, s: &MotionSample) -> InitialFile {
    let joints = model.moving_joints().zip(s.q.iter().zip(&s.rates));
    let joints = joints.map(|(joint, (q, rate))| {
        let state = match joint.kind {
            JointKind::Prismatic => JointStateFile::Prismatic {
                position_m: *q,
                rate_m_s: *rate,
            },
            _ => JointStateFile::Revolute {
                position_rad: *q,
                rate_rad_s: *rate,
            },
        };
        (joint.name.clone(), state)
    });
    InitialFile {
        q_xyzw: s.R_NB.coords.into(),
        omega_rad_s: s.w_NB_B.into(),
        r_m: s.p_NoBo_N.into(),
        v_m_s: s.v_NBo_N.into(),
        joints: joints.collect(),
    }
}

/// The vehicle as one body at the first sample, about the base origin and in base axes.
fn system(model: &Model, s: &MotionSample) -> TrueBodyFile {
    let whole = composite(&model.nominal_parameters(), &s.kinematics).mass_properties();
    let joints = model.moving_joints().zip(&s.q);
    TrueBodyFile {
        joint_positions: joints.map(|(j, q)| (position(j), *q)).collect(),
        ..TrueBodyFile::of(mass(&whole.unwrap_or(MassProperties::ZERO)))
    }
}

fn momentum(s: &MotionSample) -> MomentumFile<TrueNumberFile> {
    MomentumFile {
        linear_N_s: axes(&s.l_S_N),
        angular_N_m_s: axes(&s.h_SScm_N),
    }
}

fn wheel_use(used: &WheelUse) -> WheelUseFile {
    WheelUseFile {
        largest_speed_rad_s: used.speed,
        largest_torque_N_m: used.torque,
        saturated: used.limited,
    }
}
