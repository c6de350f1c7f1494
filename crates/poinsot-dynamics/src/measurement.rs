//! Measurement models: what an ideal sensor of each kind measures, with its derivatives. One file a kind.
//!
//! Simulator and estimator share them. A model is a function of the pose of the base and of one or two points fixed in
//! bodies. Errors of the sensor are added afterwards, by one model for all ([`crate::SensorErrors`]).

mod accelerometer;
mod attitude;
mod direction;
mod gyro;
mod position;
mod relative_attitude;
mod relative_position;
mod relative_velocity;
mod velocity;

use crate::algebra::{M3, V3};
use crate::kinematics::Kinematics;
use crate::momentum::Twist;
use crate::quaternion;
use crate::sensor::SensorKind;
use crate::tree::{Motion, Tree};
use nalgebra::{Matrix3, Rotation3, SMatrix, UnitQuaternion, Vector3};

/// Pose of the base.
#[derive(Debug, Clone, Copy)]
pub struct BasePose {
    /// `R_NB`.
    pub R_NB: UnitQuaternion<f64>,
    /// Position of the base origin in N, m.
    pub p_NoBo_N: Vector3<f64>,
}

impl BasePose {
    /// `R_NB` as a matrix.
    #[inline(always)]
    fn matrix(&self) -> M3<f64> {
        quaternion::rotation(&quaternion::numbers(&self.R_NB))
    }
}

/// A point P fixed in body i, as the base sees it: all in base axes.
#[derive(Debug, Clone, Copy)]
pub struct PointMotion {
    /// `R_BBi`.
    pub R: Matrix3<f64>,
    /// `p_BoP_B`, m.
    pub r: Vector3<f64>,
    /// `v_NP_B`, m/s.
    pub v: Vector3<f64>,
    /// `w_NBi_B`, rad/s.
    pub w: Vector3<f64>,
}

impl PointMotion {
    /// The point at `p_BioP_Bi` of a body, m, from its origin in its axes.
    #[inline(always)]
    pub fn new(kinematics: &Kinematics, body: usize, p_BioP_Bi: &Vector3<f64>) -> Self {
        let k = kinematics;
        let (p, v, w) = (V3::of(&k.p[body]), V3::of(&k.v[body]), V3::of(&k.w[body]));
        let arm = M3::of(&k.R[body]).times(&V3::of(p_BioP_Bi));
        Self {
            R: k.R[body],
            r: (p + arm).stored(),
            v: (v + w.cross(&arm)).stored(),
            w: k.w[body],
        }
    }

    /// `R_BiB`.
    #[inline(always)]
    fn R_BiB(&self) -> M3<f64> {
        M3::of(&self.R).transposed()
    }

    /// The point at `p_BoP_B` of the base, m.
    pub fn of_base(twist: &Twist, p_BoP_B: &Vector3<f64>) -> Self {
        Self {
            R: Matrix3::identity(),
            r: *p_BoP_B,
            v: twist.v + twist.w.cross(p_BoP_B),
            w: twist.w,
        }
    }
}

/// Derivatives of a point over one joint that carries its body, at a constant twist of the base. In base axes.
#[derive(Debug, Clone, Copy)]
pub struct JointEffect {
    /// Turn of the body over the joint's position, and `w` over its rate.
    pub turn: Vector3<f64>,
    /// Shift of the point over the joint's position, and `v` over its rate.
    pub shift: Vector3<f64>,
    /// `w` over the joint's position.
    pub w: Vector3<f64>,
    /// `v` over the joint's position.
    pub v: Vector3<f64>,
}

impl JointEffect {
    /// Effect of the joint of body `link`, which carries the point; zero where the joint is fixed. The kinematics move.
    #[inline(always)]
    pub fn new(tree: &Tree, kinematics: &Kinematics, link: usize, point: &PointMotion) -> Self {
        let (k, joint) = (kinematics, &tree.links[link]);
        let axis = joint.axis_in_base(&M3::of(&k.R[link]));
        let nothing = V3::default();
        let (r, w) = (V3::of(&point.r), V3::of(&k.w[joint.parent]));
        let [turn, shift, dw, dv] = match joint.motion {
            Motion::Revolute(_) => {
                let shift = axis.cross(&(r - V3::of(&k.p[link])));
                // What moves relative to the parent turns with the body.
                let carried = w.cross(&(r - V3::of(&k.p[joint.parent])));
                let relative = V3::of(&point.v) - (V3::of(&k.v[joint.parent]) + carried);
                let dw = axis.cross(&(V3::of(&point.w) - w));
                [axis, shift, dw, w.cross(&shift) + axis.cross(&relative)]
            }
            Motion::Prismatic(_) => [nothing, axis, nothing, w.cross(&axis)],
            Motion::Fixed | Motion::Free => [nothing; 4],
        };
        Self {
            turn: turn.stored(),
            shift: shift.stored(),
            w: dw.stored(),
            v: dv.stored(),
        }
    }
}

/// What a measurement is a function of.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// Pose of the base.
    pub pose: &'a BasePose,
    /// Point of the sensor; for a relative kind the point that it sees.
    pub point: &'a PointMotion,
    /// Origin of the body from which a relative kind sees the point; the base for all other kinds.
    pub from: &'a PointMotion,
    /// Unit vector whose direction is measured, in N.
    pub reference_N: Option<Vector3<f64>>,
    /// Inertial acceleration of the point in base axes, m/s2. A caller that differentiates it otherwise leaves it out.
    pub a_NP_B: Option<Vector3<f64>>,
}

/// Ideal value of a measurement.
#[derive(Debug, Clone, Copy)]
pub enum Ideal {
    /// Three numbers in the unit of the kind.
    Vector(Vector3<f64>),
    /// A rotation. Its changes are small turns in the axes of the body whose attitude it is.
    Rotation(UnitQuaternion<f64>),
}

impl Ideal {
    #[inline(always)]
    fn vector(value: V3<f64>) -> Self {
        Self::Vector(value.stored())
    }
}

/// Ideal measurement with its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Measurement {
    /// `h`.
    pub value: Ideal,
    /// Its rate of change per second, where pose and twist determine it.
    pub rate: Option<Vector3<f64>>,
    /// Derivative over the pose of the base, `[dphi_B, dp_N]`.
    pub pose: SMatrix<f64, 3, 6>,
    /// Derivative over the twist of the base, `[dv_NBo_B, dw_NB_B]`.
    pub twist: SMatrix<f64, 3, 6>,
}

impl Measurement {
    /// A value that does not depend on the base.
    #[inline(always)]
    fn new(value: Ideal) -> Self {
        Self {
            value,
            rate: None,
            pose: SMatrix::zeros(),
            twist: SMatrix::zeros(),
        }
    }
}

/// Derivatives of a measurement over one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverJoint {
    /// Over its position.
    pub position: Vector3<f64>,
    /// Over its rate.
    pub rate: Vector3<f64>,
}

impl OverJoint {
    #[inline(always)]
    fn new(position: V3<f64>, rate: V3<f64>) -> Self {
        Self {
            position: position.stored(),
            rate: rate.stored(),
        }
    }

    #[inline(always)]
    fn position(position: V3<f64>) -> Self {
        Self::new(position, V3::default())
    }
}

/// Which body of a measurement a joint carries. A joint that carries both bodies of a relative kind changes nothing.
#[derive(Debug, Clone, Copy)]
pub enum Carried<'a> {
    /// That of the point.
    Point(&'a JointEffect),
    /// That from which the point is seen.
    From(&'a JointEffect),
}

impl SensorKind {
    /// Ideal measurement of a kind with axes; of a velocity increment the velocity, whose difference it is. `None` for
    /// other kinds, and where the scene lacks what the kind measures.
    #[inline(always)]
    pub fn measure(self, scene: &Scene) -> Option<Measurement> {
        match self {
            Self::Gyro => Some(gyro::measure(scene)),
            Self::Attitude => Some(attitude::measure(scene)),
            Self::Position => Some(position::measure(scene)),
            Self::Velocity | Self::VelocityIncrement => Some(velocity::measure(scene)),
            Self::Accelerometer => accelerometer::measure(scene),
            Self::Direction => direction::measure(scene),
            Self::RelativeAttitude => Some(relative_attitude::measure(scene)),
            Self::RelativePosition => Some(relative_position::measure(scene)),
            Self::RelativeVelocity => Some(relative_velocity::measure(scene)),
            Self::JointPosition | Self::JointRate | Self::WheelSpeed | Self::Thrust => None,
        }
    }

    /// Derivatives of [`Self::measure`] over a joint, at a constant twist of the base. `None` where there is no
    /// measurement, and for an accelerometer: its derivatives are those of the equation of motion.
    #[inline(always)]
    pub fn over_joint(self, scene: &Scene, joint: Carried) -> Option<OverJoint> {
        match (self, joint) {
            (Self::RelativeAttitude, joint) => Some(relative_attitude::over_joint(scene, joint)),
            (Self::RelativePosition, joint) => Some(relative_position::over_joint(scene, joint)),
            (Self::RelativeVelocity, joint) => Some(relative_velocity::over_joint(scene, joint)),
            (_, Carried::From(_)) => None,
            (Self::Gyro, Carried::Point(j)) => Some(gyro::over_joint(scene, j)),
            (Self::Attitude, Carried::Point(j)) => Some(attitude::over_joint(scene, j)),
            (Self::Position, Carried::Point(j)) => Some(position::over_joint(scene, j)),
            (Self::Velocity | Self::VelocityIncrement, Carried::Point(j)) => {
                Some(velocity::over_joint(scene, j))
            }
            (Self::Direction, Carried::Point(j)) => direction::over_joint(scene, j),
            _ => None,
        }
    }
}

/// A rotation matrix as a quaternion.
#[inline]
fn quaternion_of(R: &Matrix3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*R))
}

/// Two matrices side by side.
#[inline(always)]
fn beside(a: &M3<f64>, b: &M3<f64>) -> SMatrix<f64, 3, 6> {
    let ([a, b, c], [d, e, f]) = (a.0, b.0);
    SMatrix::from([a, b, c, d, e, f].map(|v| [v.x, v.y, v.z]))
}
