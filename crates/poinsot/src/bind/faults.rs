//! Unknown sensor errors that the model's other sensors do not determine.

use super::BindError;
use poinsot_model::{Model, Nuisance, SensorKind};

/// # Errors
/// A bias of the only sensor of translation.
pub(super) fn check_faults(model: &Model) -> Result<(), BindError> {
    for sensor in &model.sensors {
        let kind = sensor.kind;
        let moves = matches!(kind, SensorKind::Position | SensorKind::Velocity);
        let biased = sensor.bias != Nuisance::Known;
        if moves && biased && model.sensors_of(kind).nth(1).is_none() {
            return Err(BindError::Unsupported {
                what: format!(
                    "sensor '{}': a bias of the only sensor of type {} is not identifiable: it equals an offset and drift of N; take it out",
                    sensor.name,
                    kind.word()
                ),
            });
        }
    }
    Ok(())
}
