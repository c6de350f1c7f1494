//! Which columns are in the axes of a sensor that is turned on its body.

use super::base_sensor;
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::Matrix3;
use poinsot_telemetry::Mounting;

/// Kinds of sensors that measure in their own axes, and what their columns are called.
const KINDS: [(SensorKind, &str); 4] = [
    (SensorKind::Gyro, "omega"),
    (SensorKind::Gyro, "domega"),
    (SensorKind::Accelerometer, "acc"),
    (SensorKind::Attitude, "q"),
];

/// Every sensor of the model that is turned on its body.
pub fn mountings(model: &Model) -> Vec<Mounting> {
    let of_kind = |&(kind, prefix): &(SensorKind, &'static str)| {
        let alone = model.sensors_of(kind).nth(1).is_none();
        let turned = model
            .sensors_of(kind)
            .filter(|s| s.R_BS != Matrix3::identity());
        turned.map(move |sensor| Mounting {
            sensor: sensor.name.clone(),
            unnamed: alone || base_sensor(model, kind) == Some(sensor),
            prefix,
            R_BS: [0, 1, 2].map(|i| [0, 1, 2].map(|j| sensor.R_BS[(i, j)])),
        })
    };
    KINDS.iter().flat_map(of_kind).collect()
}
