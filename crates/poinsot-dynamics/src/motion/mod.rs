//! Motion of a vehicle in time: what drives it, one evaluation of its equations, integration, samples.

pub(crate) mod attitude_control;
pub(crate) mod controller;
pub(crate) mod dop853;
pub(crate) mod dop853_table;
pub(crate) mod flexing;
pub(crate) mod flight;
pub(crate) mod integrate;
pub(crate) mod joint_drive;
pub(crate) mod joint_motion;
pub(crate) mod piecewise;
pub(crate) mod plan;
pub(crate) mod rates_momentum;
pub(crate) mod reaction_wheel;
pub(crate) mod run;
pub(crate) mod runge_kutta;
pub(crate) mod sample;
pub(crate) mod stage;
pub(crate) mod times;
pub(crate) mod wheel_motion;

pub use attitude_control::{AttitudeControl, Target, WheelDrive};
pub use controller::WheelUse;
pub use dop853::DormandPrince8;
pub use flight::{Flight, MotionError};
pub use integrate::{Flow, Halt, Tolerance};
pub use joint_drive::{ForceProfile, JointDrive};
pub use joint_motion::{Fourier, JointMotion};
pub use piecewise::{Jet, NodeError, PiecewisePolynomial};
pub use plan::{Plan, SmoothIntervals, Start, StartVelocity};
pub use reaction_wheel::WheelLimits;
pub use run::Integrator;
pub use runge_kutta::RungeKutta4;
pub use sample::MotionSample;
pub use times::Times;
pub use wheel_motion::WheelMotion;
