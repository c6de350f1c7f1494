//! Error of a comparison.

use std::path::PathBuf;

/// Error of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ValidateError {
    /// The estimate.
    #[error("E0701 {}: this estimate cannot be simulated: {why}", path.display())]
    Estimate {
        /// File.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// A controller.
    #[error(
        "E0702 {}: [control] would command different torques on the two vehicles; prescribe wheel torques with [[wheel_motion]]",
        file.display()
    )]
    Control {
        /// The case file.
        file: PathBuf,
    },
    /// No channel or no time in common.
    #[error(
        "E0703 {}: the telemetry has no attitude, rate, position, velocity, acceleration or joint sample during the case; give telemetry with times from the start of the case",
        file.display()
    )]
    NothingInCommon {
        /// The case file.
        file: PathBuf,
    },
}
