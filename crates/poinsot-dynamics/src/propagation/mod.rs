//! One step of a vehicle's pose and momentum, with its linearisation.
//!
//! The state is the attitude `R_NB`, the position `p_NoBo`, the linear momentum `P` and the angular momentum `h` about the
//! system's mass centre, all of them in N: twelve numbers `[dphi_B, dp_N, dP_N, dh_N]` of a small change, with
//! `R -> R exp([dphi]x)`. Joint positions, joint rates and wheel speeds are inputs. With the vehicle locked at its joints
//!
//! ```text
//! w = I_Scm^-1 (h - h_joints - h_wheels),   v = (l - l_joints) / m - w x c
//! R' = R [w]x,   p' = R v,   P' = R F,   h' = R T
//! ```
//!
//! and about the mass centre the position enters nowhere. [`LockedVehicle`] gives the [`BaseMotion`] of a state,
//! [`runge_kutta_step`] follows it, and [`StepRows`] carries the columns of the sensitivity along.
//!
//! Everything works without the standard library. A step allocates nothing.

mod carry;
#[cfg(feature = "std")]
mod columns;
mod hinges;
mod internal;
mod locked;
mod modes;
mod rows;
mod state;

pub use carry::{Drives, StepRows};
#[cfg(feature = "std")]
pub use columns::ColumnDrives;
pub use hinges::{HeldChange, Hinge, PassiveJoint, PassiveJoints};
pub use internal::{INTERNAL, Internal, MOST_MODES, PerMode};
pub use locked::{BaseMotion, LockedVehicle, MassCentre};
pub use modes::{
    BodyChange, Flexibility, FlexibleChange, FlexibleMotion, FlexibleRate, FlexibleState, Mode,
    ModeNumber, ModeRows, OneBody, SpringNumber,
};
pub use rows::{Matrix6x12, StateRows, pose_change};
pub use state::{
    Moving, PoseMomentum, PoseMomentumRate, Rates, StepPoint, runge_kutta_step, state_in_middle,
};

/// Numbers of a small change of the state.
pub const STATE: usize = 12;
/// Numbers of a twist, or of half a change of the state.
pub const HALF: usize = 6;
/// Numbers of a [`Column`].
pub const COLUMN: usize = STATE + INTERNAL;
/// Change of the state with a number: of pose and momentum, then of the modes.
pub type Column = nalgebra::SVector<f64, COLUMN>;
