//! Error of a simulation.

use super::CaseError;
use poinsot_dynamics::MotionError;
use poinsot_model::ModelError;
use std::path::PathBuf;

/// Error of a simulation.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// Invalid case file.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Invalid model file.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A driven joint without outboard inertia: the mass matrix is singular.
    #[error(
        "E0509 {}: joint \"{joint}\" moves by torque or spring, but its outboard bodies have no inertia about its axis (singular mass matrix); give them mass off the axis or inertia about it, or prescribe its motion with [[joint_motion]]",
        file.display()
    )]
    Singular {
        /// The case file.
        file: PathBuf,
        /// Name of the joint.
        joint: String,
    },
    /// The motion cannot be computed.
    #[error("E0509 {}: {error}", file.display())]
    Motion {
        /// The case file.
        file: PathBuf,
        /// Reason.
        error: MotionError,
    },
}

impl SimulateError {
    /// Whether the system (disk, permission) failed, not the input.
    pub fn is_environment(&self) -> bool {
        match self {
            Self::Case(e) => e.environment,
            Self::Model(e) => e.environment,
            Self::Motion { .. } | Self::Singular { .. } => false,
        }
    }
}
