//! One reading of two measurements of a motion, such as attitude and gyro: order, sense, unit and axes.

use super::change::{Change, Repair};
use crate::{Axes, Order, Sense};
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::PI;
use std::fmt;

/// What a gyro number of the table has to be multiplied by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GyroUnit {
    /// As declared.
    AsDeclared,
    /// The numbers are deg/s.
    DegPerS,
    /// The numbers are rpm.
    Rpm,
    /// Taken for deg/s and converted, though they were rad/s.
    RadPerSTakenForDeg,
    /// Taken for rpm and converted, though they were rad/s.
    RadPerSTakenForRpm,
    /// The times are ms and read as s: rates from the attitude are a thousandth. A gyro in mrad/s looks the same.
    TimeInMilliseconds,
    /// Times in s taken for ms and converted. A gyro in rad/s that is taken for mrad/s looks the same.
    TimeTakenForMilliseconds,
    /// The times are minutes and read as s.
    TimeInMinutes,
    /// Angles turned since the sample before, taken for rates.
    Increments,
}

impl GyroUnit {
    pub(super) const ALL: [Self; 9] = [
        Self::AsDeclared,
        Self::DegPerS,
        Self::Rpm,
        Self::RadPerSTakenForDeg,
        Self::RadPerSTakenForRpm,
        Self::TimeInMilliseconds,
        Self::TimeTakenForMilliseconds,
        Self::TimeInMinutes,
        Self::Increments,
    ];

    /// Those of the rate of an angle.
    pub(super) const OF_ANGLES: [Self; 3] =
        [Self::AsDeclared, Self::DegPerS, Self::RadPerSTakenForDeg];

    /// Those of a velocity: mm/s, or km/s taken for m/s; also of the position, or of the times.
    pub(super) const OF_PLACES: [Self; 3] = [
        Self::AsDeclared,
        Self::TimeInMilliseconds,
        Self::TimeTakenForMilliseconds,
    ];

    /// Factor from the table's values to the rate in rad/s, given its attitude, times and the step of the gyro, s.
    pub fn factor(self, step_s: f64) -> f64 {
        self.facts(step_s).0
    }

    /// What puts these rates right.
    pub(super) fn repair(self, rates: &[String]) -> Repair {
        let change = match self {
            Self::TimeInMilliseconds | Self::TimeTakenForMilliseconds | Self::TimeInMinutes => {
                return Repair::of("time_s", Change::Clock(self.factor(1.0)));
            }
            Self::Increments => Change::Increments,
            _ => Change::Factor(self.factor(1.0)),
        };
        Repair {
            channels: rates.to_vec(),
            change,
        }
    }

    /// The factor, and how the reading differs from the declared one.
    fn facts(self, step_s: f64) -> (f64, &'static str) {
        match self {
            Self::AsDeclared => (1.0, ""),
            Self::DegPerS => (PI / 180.0, "gyro in deg/s"),
            Self::Rpm => (PI / 30.0, "gyro in rpm"),
            Self::RadPerSTakenForDeg => (180.0 / PI, "gyro in rad/s (it is mapped as deg/s)"),
            Self::RadPerSTakenForRpm => (30.0 / PI, "gyro in rad/s (it is mapped as rpm)"),
            Self::TimeInMilliseconds => (1.0e-3, "times in ms used as s (or a gyro in mrad/s)"),
            Self::TimeTakenForMilliseconds => {
                (1.0e3, "times in s used as ms (or a gyro used as mrad/s)")
            }
            Self::TimeInMinutes => (60.0, "times in min used as s"),
            Self::Increments => (
                1.0 / step_s,
                "angles since the sample before in the columns of the gyro (increments = true)",
            ),
        }
    }
}

/// One reading of attitude and gyro together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Hypothesis {
    /// Order of the quaternion's numbers.
    pub order: Order,
    /// Sense of the quaternion.
    pub sense: Sense,
    /// Unit of the gyro.
    pub gyro_unit: GyroUnit,
    /// Axes of the gyro.
    pub gyro_axes: Axes,
    /// Root mean square of (rate from attitude - gyro), rad/s.
    pub residual_rad_s: f64,
}

impl Hypothesis {
    /// A reading in which only the rates differ from what is declared.
    pub(super) fn of_rates(gyro_unit: GyroUnit, gyro_axes: Axes, residual_rad_s: f64) -> Self {
        Self {
            order: Order::Xyzw,
            sense: Sense::BodyToInertial,
            gyro_unit,
            gyro_axes,
            residual_rad_s,
        }
    }

    /// What makes it the declared one, given the first channel of the attitude and those of the rates.
    pub(super) fn repairs(&self, attitude: &str, rates: &[String]) -> Vec<Repair> {
        let turned = (self.order, self.sense) != (Order::Xyzw, Sense::BodyToInertial);
        let attitude = Repair::of(attitude, Change::Attitude(self.order, self.sense));
        let all = [
            (turned, attitude),
            (
                self.gyro_unit != GyroUnit::AsDeclared,
                self.gyro_unit.repair(rates),
            ),
            (self.gyro_axes != Axes::IDENTITY, self.axes_of(rates)),
        ];
        all.into_iter()
            .filter(|own| own.0)
            .map(|own| own.1)
            .collect()
    }

    /// Its axes as a repair of a vector.
    pub(super) fn axes_of(&self, channels: &[String]) -> Repair {
        Repair {
            channels: channels.to_vec(),
            change: Change::Axes(self.gyro_axes),
        }
    }

    /// Whether the gyro is in inertial axes: the inverse attitude turns by the opposite of that rate, and no gyro has all of its
    /// axes reversed.
    pub(super) fn is_inertial(&self) -> bool {
        self.sense == Sense::InertialToBody && self.gyro_axes == Axes::REVERSED
    }

    /// Number of changes from the declared convention; a permutation counts more than a sign.
    pub(super) fn departures(&self) -> usize {
        if self.is_inertial() {
            let as_declared = Self {
                sense: Sense::BodyToInertial,
                gyro_axes: Axes::IDENTITY,
                ..*self
            };
            return as_declared.departures() + 2;
        }
        let axes = self.gyro_axes.axis != Axes::IDENTITY.axis;
        let signs = self.gyro_axes.sign.iter().filter(|s| **s < 0).count();
        usize::from(self.order != Order::Xyzw) * 2
            + usize::from(self.sense != Sense::BodyToInertial) * 2
            + usize::from(self.gyro_unit != GyroUnit::AsDeclared) * 2
            + usize::from(axes) * 4
            + signs * 3
    }

    /// Whether this is the declared convention: xyzw, Hamilton, body to inertial; gyro in rad/s, body axes.
    pub fn is_declared(&self) -> bool {
        self.departures() == 0
    }
}

impl fmt::Display for Hypothesis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let jpl = "quaternion inertial to body (or body to inertial in JPL algebra)";
        let inverse = self.sense == Sense::InertialToBody && !self.is_inertial();
        let changes = [
            (self.order == Order::Wxyz, "quaternion scalar first (wxyz)"),
            (
                self.is_inertial(),
                "gyro in inertial axes, not in body axes",
            ),
            (inverse, jpl),
            (
                self.gyro_unit != GyroUnit::AsDeclared,
                self.gyro_unit.facts(1.0).1,
            ),
        ];
        let changes = changes.into_iter().filter(|change| change.0);
        let mut parts: Vec<String> = changes.map(|change| change.1.to_owned()).collect();
        if self.gyro_axes != Axes::IDENTITY && !self.is_inertial() {
            parts.push(format!("body rates = gyro {}", self.gyro_axes));
        }
        if parts.is_empty() {
            parts.push(DECLARED.to_owned());
        }
        f.write_str(&parts.join(", "))
    }
}

/// The declared convention.
pub(super) const DECLARED: &str = "xyzw, Hamilton, body to inertial, gyro in rad/s and body axes";
