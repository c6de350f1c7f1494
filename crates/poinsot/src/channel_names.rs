//! Standard names of the channels of a sensor.

use poinsot_model::{Joint, JointKind, Model, SensorKind};
use poinsot_telemetry::{Channel, Table};

pub(crate) const XYZ: [&str; 3] = ["x", "y", "z"];

/// Channel names of a sensor kind; `of` for scalars.
pub(crate) fn names(model: &Model, kind: SensorKind, of: &[usize]) -> Vec<String> {
    let joints = |rate: &str| {
        let own = of.iter().filter_map(|j| model.joints.get(*j));
        let moving = own.filter(|joint| joint.kind != JointKind::Fixed);
        moving
            .map(|joint| format!("{}{rate}", position(joint)))
            .collect()
    };
    match kind {
        SensorKind::JointPosition => joints(""),
        SensorKind::JointRate => joints("_s"),
        SensorKind::WheelSpeed => of
            .iter()
            .filter_map(|i| model.wheels.get(*i))
            .map(|wheel| format!("{}_rad_s", wheel.name))
            .collect(),
        SensorKind::Thrust => of
            .iter()
            .filter_map(|i| model.thrusters.get(*i))
            .map(|thruster| format!("{}_N", thruster.name))
            .collect(),
        kind => kind.columns().iter().map(|c| (*c).to_owned()).collect(),
    }
}

/// Channel names of a sensor of a kind that reads every joint, wheel or thruster.
pub(crate) fn of_all(model: &Model, kind: SensorKind) -> Vec<String> {
    let count = match kind {
        SensorKind::WheelSpeed => model.wheels.len(),
        SensorKind::Thrust => model.thrusters.len(),
        _ => model.joints.len(),
    };
    names(model, kind, &(0..count).collect::<Vec<_>>())
}

/// Names of the motor torques of all wheels.
pub(crate) fn wheel_torques(model: &Model) -> Vec<String> {
    let wheels = model.wheels.iter();
    wheels.map(|wheel| format!("{}_Nm", wheel.name)).collect()
}

/// Columns of all joints, wheels and thrusters of a model.
pub(crate) fn of_parts(model: &Model) -> Vec<String> {
    let kinds = SensorKind::ALL.into_iter().filter(|kind| kind.is_scalar());
    let read = kinds.flat_map(|kind| of_all(model, kind));
    read.chain(wheel_torques(model)).collect()
}

/// The three channels of a vector, of the sensor of this name.
pub(crate) fn axes<'t>(table: &'t Table, sensor: &str, vector: &str) -> Option<[&'t Channel; 3]> {
    let [x, y, z] = XYZ.map(|k| table.sensor_channel(sensor, &format!("{vector}_{k}")));
    Some([x?, y?, z?])
}

/// Unit of the position of a joint.
pub(crate) fn joint_unit(joint: &Joint) -> &'static str {
    SensorKind::JointPosition.unit(joint.slides())
}

/// Position, rate, acceleration and effort of a joint.
pub(crate) fn joint_channels(joint: &Joint) -> [String; 4] {
    let effort = if joint.slides() { "N" } else { "Nm" };
    let position = position(joint);
    let [rate, acceleration] = ["s", "s2"].map(|end| format!("{position}_{end}"));
    let effort = format!("{}_{effort}", joint.name);
    [position, rate, acceleration, effort]
}

/// Channel of the position of a joint.
pub(crate) fn position(joint: &Joint) -> String {
    format!("{}_{}", joint.name, joint_unit(joint))
}
