//! Sensor errors that can be estimated; others give an error.

use super::BindError;
use poinsot_identify::ErrorGroup;
use poinsot_model::{Model, Nuisance, SensorKind};

/// Errors that the fit can estimate, by kind of sensor.
fn known(kind: SensorKind) -> Vec<&'static str> {
    match kind {
        SensorKind::JointPosition => vec!["bias", "lag"],
        SensorKind::WheelSpeed | SensorKind::Thrust => vec!["lag"],
        kind => ErrorGroup::of(kind).iter().map(|g| g.key).collect(),
    }
}

/// # Errors
/// The first sensor error that is declared unknown and that no method estimates.
pub(super) fn check_faults(model: &Model) -> Result<(), BindError> {
    for sensor in &model.sensors {
        let kind = sensor.kind;
        for (what, declared) in [
            ("bias", sensor.bias),
            ("scale", sensor.scale),
            ("misalignment", sensor.misalignment),
            ("nonorthogonality", sensor.nonorthogonality),
            ("lag", sensor.lag),
        ] {
            if declared == Nuisance::Known {
                continue;
            }
            let moves = matches!(kind, SensorKind::Position | SensorKind::Velocity);
            if moves && what == "bias" && model.sensors_of(kind).nth(1).is_none() {
                return Err(BindError::Unsupported {
                    what: format!(
                        "sensor '{}': a bias of the only sensor of type {} is not identifiable: it equals an offset and drift of N; take it out",
                        sensor.name,
                        kind.word()
                    ),
                });
            }
            if known(kind).contains(&what) {
                continue;
            }
            let instead = match (kind, what) {
                (SensorKind::Thrust, "scale") => "; write scale on the [[thruster]]",
                (SensorKind::JointRate, _) => "; declare it on the joint_position sensor",
                _ => "",
            };
            let can = match known(kind) {
                none if none.is_empty() => "nothing".to_owned(),
                list => list.join(", "),
            };
            return Err(BindError::Unsupported {
                what: format!(
                    "sensor '{}': {what} cannot be unknown for a sensor of type {} (of it can be: {can}){instead}; take it out",
                    sensor.name,
                    kind.word()
                ),
            });
        }
    }
    Ok(())
}
