//! What unknowns change: inputs, thrusters, propellant, sensors.

use super::registry::{Acts, Taken};
use super::{KnownUnknown, Parameters, UnknownKind};
use crate::problem::segment::Segment;
use poinsot_dynamics::{SensorError, SensorErrors, point_mass};
use poinsot_spatial::{InertialParameters, Vector3};

/// A part of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Body(usize),
    Wheel(usize),
    Thruster(usize),
}

impl UnknownKind {
    /// Whether it is a nuisance of a sensor or the environment, which is projected out.
    pub fn is_nuisance(&self) -> bool {
        self.traits().1 != Taken::Main
    }

    /// Whether it has slopes but no value: a fit cannot take it as an unknown.
    pub(crate) fn is_only_tested(&self) -> bool {
        self.traits().1 == Taken::Tested
    }

    /// Whether the answer gives it as a separate number. Known numbers have a separate table.
    pub(crate) fn is_reported(&self) -> bool {
        !matches!(self, Self::Known(_)) && self.traits().0 != Acts::Bodies
    }

    /// Whether it is a force or torque from outside.
    pub(crate) fn is_external_wrench(&self) -> bool {
        self.traits().0 == Acts::Outside
    }

    /// Whether it is an error of a sensor that measures the motion: it moves nothing.
    pub(crate) fn is_of_sensor(&self) -> bool {
        matches!(self.traits().0, Acts::Sensor | Acts::SensorTimes)
    }

    /// Whether it delays the readings of a sensor, or the samples of joints or wheels.
    pub(crate) fn is_delay(&self) -> bool {
        matches!(self.traits().0, Acts::SensorTimes | Acts::InputTimes)
    }

    /// Whether it shifts the samples of joints or wheels in time.
    pub(crate) fn delays_inputs(&self) -> bool {
        self.traits().0 == Acts::InputTimes
    }

    /// Whether it shifts in time what drives the vehicle: joints, wheels or thrusters.
    pub(crate) fn delays_drives(&self) -> bool {
        matches!(self.traits().0, Acts::InputTimes | Acts::ThrustTimes)
    }

    /// Whether it changes joint or wheel motion.
    pub(crate) fn shifts_inputs(&self) -> bool {
        matches!(self.traits().0, Acts::Inputs | Acts::InputTimes)
    }

    /// The largest size that it can have, `natural` its natural scale; infinite where nothing is known of it.
    pub(crate) fn largest(&self, natural: f64, segments: &[Segment]) -> f64 {
        match self {
            // A shaft that turns does not seem to stand still.
            Self::WheelSpeedBias(wheel) => {
                let speeds = segments.iter().flat_map(|s| {
                    let o = &s.observations;
                    let wheels = o.wheel_speed.len() / o.time_s.len().max(1);
                    o.wheel_speed.iter().skip(*wheel).step_by(wheels.max(1))
                });
                speeds.fold(1.0, |largest, speed| largest.max(speed.abs()))
            }
            // Shares and small angles.
            Self::JointScale(_) | Self::JointRateScale(_) => 1.0,
            Self::Sensor { error, .. } => match error {
                SensorError::Scale(_)
                | SensorError::Misalignment(_)
                | SensorError::Nonorthogonality(_) => 1.0,
                SensorError::Bias(_) | SensorError::Lag => f64::INFINITY,
            },
            Self::Mode(..) => natural,
            _ => f64::INFINITY,
        }
    }

    /// The known number that it is.
    pub fn known(&self) -> Option<&KnownUnknown> {
        match self {
            Self::Known(known) => Some(known),
            _ => None,
        }
    }

    /// The part of which it is solved for with the mass properties.
    pub(crate) fn part(&self) -> Option<Part> {
        match self {
            Self::Barycentric(parts) => parts.first().map(|(at, _)| Part::Body(at / 10)),
            Self::CentralInertia(_) | Self::MassCentre(_) => Some(Part::Body(0)),
            Self::SpinInertia(k) => Some(Part::Wheel(*k)),
            Self::ThrusterScale(k) => Some(Part::Thruster(*k)),
            _ => None,
        }
    }

    /// The thruster whose force or place it changes.
    pub(crate) fn thruster(&self) -> Option<usize> {
        match self {
            Self::ThrusterScale(thruster)
            | Self::ThrusterPlace { thruster, .. }
            | Self::Firing { thruster, .. } => Some(*thruster),
            _ => None,
        }
    }

    /// Whether it changes what a thruster on a body uses.
    pub(crate) fn changes_use_of(&self, thruster: usize, on: usize) -> bool {
        match self {
            Self::PropellantUse {
                body, thruster: of, ..
            } => *body == on && of.is_none_or(|of| of == thruster),
            _ => false,
        }
    }

    /// What a body loses by it, per unit: the ten parameters of the body.
    pub(crate) fn lost(&self) -> Option<(usize, InertialParameters)> {
        let Self::PropellantUse {
            body,
            p_BoF_B,
            axis,
            ..
        } = self
        else {
            return None;
        };
        let here = point_mass(p_BoF_B);
        let part = match axis {
            None => here,
            // The slope of a quadratic, from both sides of it.
            Some(k) => {
                let e = Vector3::ith(*k, 1.0);
                let ends = [p_BoF_B + e, p_BoF_B - e].map(|p| point_mass(&p));
                InertialParameters::ZERO
                    .with_added(0.5, &ends[0])
                    .with_added(-0.5, &ends[1])
            }
        };
        Some((*body, part))
    }
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
