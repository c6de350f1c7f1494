//! What an unknown can be.

use poinsot_dynamics::SensorError;

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
    /// What may be wrong with a sensor of three axes.
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
    /// How late the readings of these joint coordinates are, s.
    JointLag(Vec<usize>),
    /// How late the readings of these wheels are, s.
    WheelLag(Vec<usize>),
    /// How late these thrusters act, s.
    ThrusterLag(Vec<usize>),
    /// Small tilt of a wheel's axis, rad, about the first or second of its tilt axes.
    WheelTilt(usize, usize),
    /// Component in N of a constant force, N. Only tested for.
    InertialForce(usize),
}

impl UnknownKind {
    /// Whether it belongs to a sensor or the surroundings: projected out before anything is judged.
    pub fn is_nuisance(&self) -> bool {
        matches!(
            self,
            Self::Sensor { .. }
                | Self::DisturbanceTorque(_)
                | Self::InertialTorque(_)
                | Self::DragTorque(_)
                | Self::JointOffset(_)
                | Self::JointLag(_)
                | Self::WheelLag(_)
                | Self::ThrusterLag(_)
                | Self::WheelTilt(..)
                | Self::InertialForce(_)
        )
    }

    /// Whether it is a force or torque from outside.
    pub(crate) fn pushes(&self) -> bool {
        matches!(
            self,
            Self::DisturbanceTorque(_)
                | Self::InertialTorque(_)
                | Self::DragTorque(_)
                | Self::InertialForce(_)
        )
    }

    /// Whether it shifts the readings of joints or wheels in time.
    pub(crate) fn delays_inputs(&self) -> bool {
        matches!(self, Self::JointLag(_) | Self::WheelLag(_))
    }

    /// Whether it changes what joints and wheels do.
    pub(crate) fn shifts_inputs(&self) -> bool {
        matches!(
            self,
            Self::JointOffset(_) | Self::JointLag(_) | Self::WheelLag(_)
        )
    }
}
