//! Instruments fixed at a point of a body, accelerometers and velocity increments, and what may be wrong
//! with an instrument of three axes.

use crate::parameters::{Parameters, UnknownKind};
use poinsot_spatial::{Matrix3, Vector3, skew};

/// What an instrument at a point measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// Specific force in the body's axes, m/s2.
    SpecificForce,
    /// Change of the point's velocity over an interval, in N, m/s.
    VelocityIncrement,
}

/// One reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointReading {
    /// Grid time at which the interval begins; that of the reading itself for a specific force.
    pub from: usize,
    /// Grid time of the reading.
    pub to: usize,
    /// Value, SI.
    pub value: Vector3,
}

/// The readings of one instrument in one segment.
#[derive(Debug, Clone, PartialEq)]
pub struct PointReadings {
    /// Index of the sensor in the model.
    pub sensor: usize,
    /// Kind.
    pub kind: PointKind,
    /// Index of the body that carries it.
    pub body: usize,
    /// Place from the body's origin, in the body, m.
    pub p_BoS_B: Vector3,
    /// Covariance of one reading, SI squared: in the body's axes for a specific force, in N for an increment.
    pub covariance: Matrix3,
    /// Readings in the order of `to`.
    pub readings: Vec<PointReading>,
}

/// What may be wrong with an instrument of three axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Component of a constant error, in the unit of the channel.
    Bias(usize),
    /// Relative error of an axis.
    Scale(usize),
    /// Component of the small rotation between true and assumed axes, rad.
    Misalignment(usize),
    /// How late it reads, s.
    Lag,
}

/// The errors of one instrument: it reads `(1 + turn) x(t - lag) + bias`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct InstrumentErrors {
    bias: Vector3,
    /// Scale errors on the diagonal, misalignment beside it.
    turn: Matrix3,
    lag: f64,
}

impl InstrumentErrors {
    /// The errors of a sensor of the model at one value of the unknowns.
    pub fn of(parameters: &Parameters, x: &[f64], sensor: usize) -> Self {
        let mut errors = Self::default();
        for (unknown, value) in parameters.unknowns.iter().zip(x) {
            let UnknownKind::Instrument { sensor: of, fault } = unknown.kind else {
                continue;
            };
            if of != sensor {
                continue;
            }
            match fault {
                Fault::Bias(k) => errors.bias[k] += *value,
                Fault::Scale(k) => errors.turn[(k, k)] += *value,
                Fault::Misalignment(k) => errors.turn += skew(&unit(k)) * *value,
                Fault::Lag => errors.lag = *value,
            }
        }
        errors
    }

    /// What it reads where a perfect one reads `x`, which changes by `rate` a second.
    pub fn reading(&self, x: &Vector3, rate: &Vector3) -> Vector3 {
        let then = x - rate * self.lag;
        then + self.turn * then + self.bias
    }

    /// Change of the reading with that of a perfect one, `dx`, and with one of its own faults.
    pub fn change(
        &self,
        x: &Vector3,
        rate: &Vector3,
        dx: &Vector3,
        fault: Option<Fault>,
    ) -> Vector3 {
        let mut change = dx + self.turn * dx;
        match fault {
            Some(Fault::Bias(k)) => change[k] += 1.0,
            Some(Fault::Scale(k)) => change[k] += x[k],
            Some(Fault::Misalignment(k)) => change += unit(k).cross(x),
            Some(Fault::Lag) => change -= rate + self.turn * rate,
            None => {}
        }
        change
    }
}

/// The fault of this sensor that an unknown stands for.
pub(crate) fn fault_of(kind: &UnknownKind, sensor: usize) -> Option<Fault> {
    match kind {
        UnknownKind::Instrument { sensor: of, fault } if *of == sensor => Some(*fault),
        _ => None,
    }
}

fn unit(k: usize) -> Vector3 {
    let mut e = Vector3::zeros();
    e[k] = 1.0;
    e
}
