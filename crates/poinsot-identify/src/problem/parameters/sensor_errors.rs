//! The errors of a sensor that are unknown together, and what they are called.

use crate::problem::fault::FaultKind;
use poinsot_dynamics::SensorError;
use poinsot_model::{ErrorKey, SensorKind, printed_unit};

/// Errors of one sensor that are declared with one key of the model file, and unknown together.
#[derive(Debug, Clone, Copy)]
pub struct ErrorGroup {
    /// The key.
    pub key: ErrorKey,
    /// Its numbers, each with the end of its name.
    pub errors: &'static [(SensorError, &'static str)],
}

static BIAS: ErrorGroup = ErrorGroup {
    key: ErrorKey::Bias,
    errors: &[
        (SensorError::Bias(0), "bias_x"),
        (SensorError::Bias(1), "bias_y"),
        (SensorError::Bias(2), "bias_z"),
    ],
};
static SCALE: ErrorGroup = ErrorGroup {
    key: ErrorKey::Scale,
    errors: &[
        (SensorError::Scale(0), "scale_x"),
        (SensorError::Scale(1), "scale_y"),
        (SensorError::Scale(2), "scale_z"),
    ],
};
static MISALIGNMENT: ErrorGroup = ErrorGroup {
    key: ErrorKey::Misalignment,
    errors: &[
        (SensorError::Misalignment(0), "misalignment_x"),
        (SensorError::Misalignment(1), "misalignment_y"),
        (SensorError::Misalignment(2), "misalignment_z"),
    ],
};
static NONORTHOGONALITY: ErrorGroup = ErrorGroup {
    key: ErrorKey::Nonorthogonality,
    errors: &[
        (SensorError::Nonorthogonality(0), "nonorthogonality_yz"),
        (SensorError::Nonorthogonality(1), "nonorthogonality_xz"),
        (SensorError::Nonorthogonality(2), "nonorthogonality_xy"),
    ],
};
static LAG: ErrorGroup = ErrorGroup {
    key: ErrorKey::Lag,
    errors: &[(SensorError::Lag, "lag")],
};

impl ErrorGroup {
    /// Possible errors of a sensor with axes of this kind; none of joint, wheel and thrust sensors.
    pub fn of(kind: SensorKind) -> impl Iterator<Item = &'static Self> {
        let all = [&BIAS, &SCALE, &MISALIGNMENT, &NONORTHOGONALITY, &LAG];
        let all = all.into_iter().filter(move |_| !kind.is_scalar());
        all.filter(move |group| kind.unknown_errors().contains(&group.key))
    }

    /// The group of an error of a sensor with three axes.
    pub(super) fn holding(kind: SensorKind, error: SensorError) -> Option<&'static Self> {
        let mut groups = Self::of(kind);
        groups.find(|g| g.errors.iter().any(|e| e.0 == error))
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
