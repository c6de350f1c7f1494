//! Finding the channels of a sensor in a table.

use super::{BindError, base_sensor};
use poinsot_model::{JointKind, Model, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table};
use std::collections::BTreeSet;

/// A table with its name for messages.
pub(super) struct Channels<'a> {
    pub table: &'a Table,
    pub label: &'a str,
}

/// The three channels of a vector sensor, with where it sits. Tables are in body or inertial axes: columns of a
/// sensor that is turned on its body were turned as they were read.
pub(super) struct VectorChannels<'a> {
    pub axes: [&'a Channel; 3],
    pub p_BoS_B: Vector3,
}

impl VectorChannels<'_> {
    /// Times of its first axis, s.
    pub fn time_s(&self) -> &[f64] {
        &self.axes[0].time_s
    }
}

impl<'a> Channels<'a> {
    /// A channel of the sensor named, or of no sensor.
    pub fn find(&self, sensor: Option<&str>, name: &str) -> Option<&'a Channel> {
        sensor
            .and_then(|s| self.table.sensor_channel(s, name))
            .or_else(|| self.table.sensor_channel("", name))
    }

    /// The channels `<prefix>_x`, `_y`, `_z` of the base's sensor of this kind.
    pub fn vector(
        &self,
        model: &Model,
        kind: SensorKind,
        prefix: &str,
    ) -> Option<VectorChannels<'a>> {
        let sensor = base_sensor(model, kind);
        let name = sensor.map(|s| s.name.as_str());
        let axis = |k: &str| self.find(name, &format!("{prefix}_{k}"));
        Some(VectorChannels {
            axes: [axis("x")?, axis("y")?, axis("z")?],
            p_BoS_B: sensor.map_or_else(Vector3::zeros, |s| s.p_BoS_B),
        })
    }

    /// The gyro: the clock of the linear method.
    pub fn gyro(&self, model: &Model) -> Result<VectorChannels<'a>, BindError> {
        let gyro = self.vector(model, SensorKind::Gyro, "omega");
        gyro.filter(|g| !g.time_s().is_empty())
            .ok_or_else(|| self.missing("omega_x omega_y omega_z", "every method starts from measured body rates; add a gyro, or map its columns in [telemetry.columns]"))
    }

    pub fn missing(&self, channel: &str, why: &str) -> BindError {
        BindError::Missing {
            file: self.label.to_owned(),
            channel: channel.to_owned(),
            why: why.to_owned(),
        }
    }
}

/// Names of all channels that a model can use; translation and specific force only where the model has a sensor for it.
pub fn wanted_channels(model: &Model) -> BTreeSet<String> {
    let mut wanted: BTreeSet<String> =
        ["q_x", "q_y", "q_z", "q_w", "omega_x", "omega_y", "omega_z"]
            .map(str::to_owned)
            .into();
    // Translation counts only where a sensor declares how well it is known.
    for (kind, prefix) in [
        (SensorKind::Position, "r"),
        (SensorKind::Velocity, "v"),
        (SensorKind::VelocityIncrement, "dv"),
        (SensorKind::Accelerometer, "acc"),
    ] {
        if model.sensors_of(kind).next().is_some() {
            wanted.extend(["x", "y", "z"].map(|k| format!("{prefix}_{k}")));
        }
    }
    if model.environment.gravity_gradient {
        wanted.extend(["x", "y", "z"].map(|k| format!("orbit_{k}")));
    }
    for joint in &model.joints {
        let (position, rate) = joint_columns(&joint.name, joint.kind);
        wanted.insert(position);
        wanted.insert(rate);
    }
    wanted.extend(model.wheels.iter().map(|w| format!("{}_rad_s", w.name)));
    wanted.extend(model.thrusters.iter().map(|t| format!("{}_N", t.name)));
    wanted
}

/// Columns of a joint's position and rate.
pub(super) fn joint_columns(name: &str, kind: JointKind) -> (String, String) {
    match kind {
        JointKind::Prismatic => (format!("{name}_m"), format!("{name}_m_s")),
        JointKind::Revolute | JointKind::Fixed => (format!("{name}_rad"), format!("{name}_rad_s")),
    }
}
