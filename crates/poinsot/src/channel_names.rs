//! Standard names of the channels of a sensor.

use poinsot_model::{JointKind, Model, SensorKind};

pub(crate) const XYZ: [&str; 3] = ["x", "y", "z"];

/// Channel names of a sensor kind; `of` for scalars.
pub(crate) fn names(model: &Model, kind: SensorKind, of: &[usize]) -> Vec<String> {
    let xyz = |prefix: &str| XYZ.map(|axis| format!("{prefix}_{axis}")).to_vec();
    let joints = |suffix: &str| {
        of.iter()
            .filter_map(|j| model.joints.get(*j))
            .filter(|joint| joint.kind != JointKind::Fixed)
            .map(|joint| match joint.kind {
                JointKind::Prismatic => format!("{}_m{suffix}", joint.name),
                _ => format!("{}_rad{suffix}", joint.name),
            })
            .collect()
    };
    match kind {
        SensorKind::Gyro => xyz("omega"),
        SensorKind::Attitude => ["x", "y", "z", "w"]
            .map(|axis| format!("q_{axis}"))
            .to_vec(),
        SensorKind::Position => xyz("r"),
        SensorKind::Velocity => xyz("v"),
        SensorKind::VelocityIncrement => xyz("dv"),
        SensorKind::Accelerometer => xyz("acc"),
        SensorKind::JointPosition => joints(""),
        SensorKind::JointRate => joints("_s"),
        SensorKind::WheelSpeed => wheels(model, of, "rad_s"),
        SensorKind::Thrust => of
            .iter()
            .filter_map(|i| model.thrusters.get(*i))
            .map(|thruster| format!("{}_N", thruster.name))
            .collect(),
    }
}

pub(crate) fn wheels(model: &Model, of: &[usize], suffix: &str) -> Vec<String> {
    of.iter()
        .filter_map(|i| model.wheels.get(*i))
        .map(|wheel| format!("{}_{suffix}", wheel.name))
        .collect()
}
