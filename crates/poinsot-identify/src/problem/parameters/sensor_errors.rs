//! Which errors of which sensor can be unknown, how the model file declares them and what they are called.

use super::{Parameters, UnknownKind};
use poinsot_dynamics::{SensorError, SensorErrors};
use poinsot_model::{Nuisance, Sensor, SensorKind, printed_unit};

/// Errors of one sensor that are declared with one key of the model file, and unknown together.
#[derive(Debug, Clone, Copy)]
pub struct ErrorGroup {
    /// The key, also the word for it.
    pub key: &'static str,
    /// Its numbers, each with the end of its name.
    pub errors: &'static [(SensorError, &'static str)],
    /// How the model file declares it.
    pub declared: fn(&Sensor) -> Nuisance,
}

static BIAS: ErrorGroup = ErrorGroup {
    key: "bias",
    errors: &[
        (SensorError::Bias(0), "bias_x"),
        (SensorError::Bias(1), "bias_y"),
        (SensorError::Bias(2), "bias_z"),
    ],
    declared: |s| s.bias,
};
static SCALE: ErrorGroup = ErrorGroup {
    key: "scale",
    errors: &[
        (SensorError::Scale(0), "scale_x"),
        (SensorError::Scale(1), "scale_y"),
        (SensorError::Scale(2), "scale_z"),
    ],
    declared: |s| s.scale,
};
static MISALIGNMENT: ErrorGroup = ErrorGroup {
    key: "misalignment",
    errors: &[
        (SensorError::Misalignment(0), "misalignment_x"),
        (SensorError::Misalignment(1), "misalignment_y"),
        (SensorError::Misalignment(2), "misalignment_z"),
    ],
    declared: |s| s.misalignment,
};
static NONORTHOGONALITY: ErrorGroup = ErrorGroup {
    key: "nonorthogonality",
    errors: &[
        (SensorError::Nonorthogonality(0), "nonorthogonality_yz"),
        (SensorError::Nonorthogonality(1), "nonorthogonality_xz"),
        (SensorError::Nonorthogonality(2), "nonorthogonality_xy"),
    ],
    declared: |s| s.nonorthogonality,
};
static LAG: ErrorGroup = ErrorGroup {
    key: "lag",
    errors: &[(SensorError::Lag, "lag")],
    declared: |s| s.lag,
};

impl ErrorGroup {
    /// Possible errors of a sensor with axes of this kind; none of joint, wheel and thrust sensors.
    pub fn of(kind: SensorKind) -> impl Iterator<Item = &'static Self> {
        let all = [&BIAS, &SCALE, &MISALIGNMENT, &NONORTHOGONALITY, &LAG];
        let all = all.into_iter().filter(move |_| !kind.is_scalar());
        all.filter(move |group| kind.unknown_errors().contains(&group.key))
    }

    /// Unit of its numbers for a kind of sensor.
    pub fn unit(&self, kind: SensorKind) -> &'static str {
        match self.key {
            "bias" => printed_unit(kind.unit(false)),
            "scale" => "1",
            "lag" => "s",
            _ => "rad",
        }
    }
}

/// How a sensor declares the error that an unknown stands for.
pub(crate) fn declared(sensor: &Sensor, error: SensorError) -> Nuisance {
    let own = ErrorGroup::of(sensor.kind).find(|g| g.errors.iter().any(|e| e.0 == error));
    own.map_or(Nuisance::Known, |g| (g.declared)(sensor))
}

impl Parameters {
    /// The errors of a sensor of the model at one value of the unknowns; none of a sensor that no model declares.
    pub(crate) fn sensor_errors(&self, x: &[f64], sensor: Option<usize>) -> SensorErrors {
        let mut errors = SensorErrors::default();
        for (unknown, value) in self.unknowns.iter().zip(x) {
            match unknown.kind {
                UnknownKind::Sensor { sensor: of, error } if Some(of) == sensor => {
                    errors.add(error, *value);
                }
                _ => {}
            }
        }
        errors
    }
}
