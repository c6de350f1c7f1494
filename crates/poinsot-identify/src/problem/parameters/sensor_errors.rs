//! The errors of a sensor that are unknown together, and what they are called.

use super::axis_name;
use crate::problem::fault::FaultKind;
use poinsot_dynamics::SensorError;
use poinsot_model::{ErrorKey, SensorKind, printed_unit};

/// Errors of one sensor that are declared with one key of the model file, and unknown together.
#[derive(Debug, Clone, Copy)]
pub struct ErrorGroup {
    /// The key.
    pub key: ErrorKey,
}

impl ErrorGroup {
    /// Possible errors of a sensor with axes of this kind; none of joint, wheel and thrust sensors.
    pub fn of(kind: SensorKind) -> impl Iterator<Item = Self> {
        let all = ErrorKey::ALL.into_iter().filter(move |_| !kind.is_scalar());
        let own = all.filter(move |key| kind.unknown_errors().contains(key));
        own.map(|key| Self { key })
    }

    /// The group of an error of a sensor with three axes.
    pub(super) fn holding(kind: SensorKind, error: SensorError) -> Option<Self> {
        let mut groups = Self::of(kind);
        groups.find(|g| g.errors().contains(&error))
    }

    /// Its numbers.
    pub fn errors(&self) -> Vec<SensorError> {
        let three = |error: fn(usize) -> SensorError| (0..3).map(error).collect();
        match self.key {
            ErrorKey::Bias => three(SensorError::Bias),
            ErrorKey::Scale => three(SensorError::Scale),
            ErrorKey::Misalignment => three(SensorError::Misalignment),
            ErrorKey::Nonorthogonality => three(SensorError::Nonorthogonality),
            ErrorKey::Lag => vec![SensorError::Lag],
        }
    }

    /// End of the name of one of them.
    pub fn end(&self, error: SensorError) -> String {
        let word = self.key.word();
        match error {
            SensorError::Bias(k) | SensorError::Scale(k) | SensorError::Misalignment(k) => {
                format!("{word}_{}", axis_name(k))
            }
            SensorError::Nonorthogonality(k) => format!("{word}_{}", ["yz", "xz", "xy"][k % 3]),
            SensorError::Lag => word.to_owned(),
        }
    }

    /// Unit of its numbers for a kind of sensor.
    pub fn unit(&self, kind: SensorKind) -> &'static str {
        match self.key {
            ErrorKey::Bias => printed_unit(kind.unit(false)),
            ErrorKey::Scale => "1",
            ErrorKey::Lag => "s",
            ErrorKey::Misalignment | ErrorKey::Nonorthogonality => "rad",
        }
    }

    /// Word for it as a fault: the bias of an attitude is a misalignment.
    pub(super) fn word(&self, kind: SensorKind) -> &'static str {
        match self.key {
            ErrorKey::Scale => "scale error",
            ErrorKey::Bias if kind.is_rotation() => ErrorKey::Misalignment.word(),
            key => key.word(),
        }
    }

    /// The fault that it is.
    pub(super) fn fault(&self, kind: SensorKind) -> FaultKind {
        match (self.key, kind) {
            (ErrorKey::Bias, SensorKind::Gyro) => FaultKind::GyroBias,
            (ErrorKey::Bias, SensorKind::Attitude) => FaultKind::TrackerMisalignment,
            (ErrorKey::Bias, kind) if kind.is_rotation() => FaultKind::SensorMisalignment,
            (ErrorKey::Bias, _) => FaultKind::SensorBias,
            (ErrorKey::Scale, SensorKind::Gyro) => FaultKind::GyroScale,
            (ErrorKey::Scale, _) => FaultKind::SensorScale,
            (ErrorKey::Misalignment, SensorKind::Gyro) => FaultKind::GyroMisalignment,
            (ErrorKey::Misalignment, _) => FaultKind::SensorMisalignment,
            (ErrorKey::Nonorthogonality, _) => FaultKind::Nonorthogonality,
            (ErrorKey::Lag, _) => FaultKind::Lag,
        }
    }
}
