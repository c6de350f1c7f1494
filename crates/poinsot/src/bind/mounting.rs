//! Sensors whose columns are in sensor axes rotated from body axes.

use poinsot_model::{Axes, Model, SensorKind};
use poinsot_spatial::Matrix3;
use poinsot_telemetry::Mounting;

/// Mountings of all rotated sensors of the model.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// // Its gyro measures in the axes of its body.
/// assert!(bind::mountings(&model).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mountings(model: &Model) -> Vec<Mounting> {
    let of_columns = |(kind, prefix): (SensorKind, &'static str)| {
        let alone = model.sensors_of(kind).nth(1).is_none();
        let first = model.sensors_of(kind).find(|s| s.body == 0);
        let turned = model
            .sensors_of(kind)
            .filter(|s| s.R_BS != Matrix3::identity());
        turned.map(move |sensor| Mounting {
            sensor: sensor.name.clone(),
            unnamed: alone || first == Some(sensor),
            prefix,
            R_BS: [0, 1, 2].map(|i| [0, 1, 2].map(|j| sensor.R_BS[(i, j)])),
        })
    };
    let in_own_axes = SensorKind::with_axes().filter(|kind| kind.axes() == Axes::Sensor);
    let prefixed = in_own_axes.flat_map(|kind| {
        let prefix = kind.columns().first().and_then(|c| c.strip_suffix("_x"));
        // Angular acceleration has no sensor type and uses the gyro's mounting.
        let more = (kind == SensorKind::Gyro).then_some("domega");
        prefix.into_iter().chain(more).map(move |p| (kind, p))
    });
    prefixed.flat_map(of_columns).collect()
}
