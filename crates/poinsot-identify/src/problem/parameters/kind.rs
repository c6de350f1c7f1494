//! What an unknown can be.

use poinsot_dynamics::{SensorError, point_mass};
use poinsot_model::KnownNumber;
use poinsot_spatial::{InertialParameters, Vector3};

/// What an unknown is.
#[derive(Debug, Clone, PartialEq)]
pub enum UnknownKind {
    /// A combination of barycentric parameters: the index `10 body + k` and its coefficient.
    Barycentric(Vec<(usize, f64)>),
    /// Element k (order xx, xy, yy, xz, yz, zz) of the base's central inertia, where only rotation is seen.
    CentralInertia(usize),
    /// Component of the base's mass centre, where only rotation is seen (thrusters turn about it).
    MassCentre(usize),
    /// Spin inertia of a wheel.
    SpinInertia(usize),
    /// Factor of a thruster, less one.
    ThrusterScale(usize),
    /// Direction and position of a thruster, with their slopes in the axes of its body. Tested only.
    ThrusterPlace {
        /// Index in the model's thrusters.
        thruster: usize,
        /// Slope of the unit direction.
        direction_B: Vector3,
        /// Slope of the position, m.
        p_BoT_B: Vector3,
    },
    /// Share of the force of one firing. Tested only.
    Firing {
        /// Index of the segment.
        segment: usize,
        /// Index of the firing in it.
        firing: usize,
        /// Index in the model's thrusters.
        thruster: usize,
    },
    /// Mass that a body loses per impulse of one or all of its thrusters, kg/(N s): from a place of it, or per m of another place
    /// along an axis. Tested only.
    PropellantUse {
        /// Index of the body.
        body: usize,
        /// Index of the thruster; `None`: all of the body.
        thruster: Option<usize>,
        /// The place, m.
        p_BoF_B: Vector3,
        /// The axis along which the place moves.
        axis: Option<usize>,
    },
    /// Play of a joint coordinate, rad or m: its link is half of it behind its drive. Tested only.
    JointPlay(usize),
    /// Origin and axis of a joint, with their slopes. Tested only.
    JointPlace {
        /// The body that the joint carries.
        link: usize,
        /// Slope of the origin in the parent, m.
        p_PoCo_P: Vector3,
        /// Slope of the unit axis in the body.
        axis_C: Vector3,
    },
    /// An error of a sensor with three axes.
    Sensor {
        /// Index in the model's sensors.
        sensor: usize,
        /// Which error.
        error: SensorError,
    },
    /// Component of a constant torque in body axes, N m.
    DisturbanceTorque(usize),
    /// Component of a constant torque in inertial axes, N m.
    InertialTorque(usize),
    /// Coefficient of the drag torque `-c |w| w` about a body axis, kg m2.
    DragTorque(usize),
    /// Constant error of the reading of a joint coordinate, rad or m.
    JointOffset(usize),
    /// Delay of the samples of these joint coordinates, s.
    JointLag(Vec<usize>),
    /// Delay of the samples of these wheels, s.
    WheelLag(Vec<usize>),
    /// Delay of these thrusters, s.
    ThrusterLag(Vec<usize>),
    /// Small tilt of a wheel's axis, rad, about the first or second of its tilt axes.
    WheelTilt(usize, usize),
    /// Component in N of a constant force, N. Tested only.
    InertialForce(usize),
    /// Component of the tensor of a gravity gradient in N, 1/s2: five of it, then five of how it grows with time, 1/s3.
    /// Tested only.
    GravityGradient(usize),
    /// Component in N of the gradient of a tide, 1/s2, then of a constant acceleration, m/s2. Tested only.
    Tide(usize),
    /// A number whose column is made of others. Tested only.
    Changed,
    /// A known number of the model within its uncertainty.
    Known(KnownUnknown),
}

/// A component of a known number with its uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownUnknown {
    /// Which number.
    pub number: KnownNumber,
    /// Which component of it.
    pub component: usize,
    /// One sigma, in the unit of the component.
    pub sigma: f64,
    /// Slope of the barycentric parameters: index `10 body + k` and slope.
    pub slopes: Vec<(usize, f64)>,
}

impl UnknownKind {
    /// Whether it is a nuisance of a sensor or the environment, which is projected out.
    pub fn is_nuisance(&self) -> bool {
        matches!(
            self,
            Self::ThrusterPlace { .. }
                | Self::JointPlace { .. }
                | Self::JointPlay(_)
                | Self::PropellantUse { .. }
                | Self::Firing { .. }
                | Self::Sensor { .. }
                | Self::DisturbanceTorque(_)
                | Self::InertialTorque(_)
                | Self::DragTorque(_)
                | Self::JointOffset(_)
                | Self::JointLag(_)
                | Self::WheelLag(_)
                | Self::ThrusterLag(_)
                | Self::WheelTilt(..)
                | Self::InertialForce(_)
                | Self::GravityGradient(_)
                | Self::Tide(_)
                | Self::Changed
                | Self::Known(_)
        )
    }

    /// The known number that it is.
    pub fn known(&self) -> Option<&KnownUnknown> {
        match self {
            Self::Known(known) => Some(known),
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
                let mut e = Vector3::zeros();
                e[*k] = 1.0;
                let ends = [p_BoF_B + e, p_BoF_B - e].map(|p| point_mass(&p));
                InertialParameters::ZERO
                    .with_added(0.5, &ends[0])
                    .with_added(-0.5, &ends[1])
            }
        };
        Some((*body, part))
    }

    /// Whether it is a force or torque from outside.
    pub(crate) fn is_external_wrench(&self) -> bool {
        matches!(
            self,
            Self::DisturbanceTorque(_)
                | Self::InertialTorque(_)
                | Self::DragTorque(_)
                | Self::InertialForce(_)
                | Self::GravityGradient(_)
                | Self::Tide(_)
        )
    }

    /// Whether it has slopes but no value: a fit cannot take it as an unknown.
    pub(crate) fn is_only_tested(&self) -> bool {
        matches!(
            self,
            Self::ThrusterPlace { .. }
                | Self::JointPlace { .. }
                | Self::JointPlay(_)
                | Self::PropellantUse { .. }
                | Self::Firing { .. }
                | Self::InertialForce(_)
                | Self::GravityGradient(_)
                | Self::Tide(_)
                | Self::Changed
        )
    }

    /// Whether it delays the readings of a sensor, or the samples of joints or wheels.
    pub(crate) fn is_delay(&self) -> bool {
        let own = matches!(self, Self::Sensor { error, .. } if *error == SensorError::Lag);
        own || self.delays_inputs()
    }

    /// Whether it shifts the samples of joints or wheels in time.
    pub(crate) fn delays_inputs(&self) -> bool {
        matches!(self, Self::JointLag(_) | Self::WheelLag(_))
    }

    /// Whether it changes joint or wheel motion.
    pub(crate) fn shifts_inputs(&self) -> bool {
        matches!(
            self,
            Self::JointOffset(_)
                | Self::JointLag(_)
                | Self::WheelLag(_)
                | Self::JointPlay(_)
                | Self::JointPlace { .. }
        )
    }
}
