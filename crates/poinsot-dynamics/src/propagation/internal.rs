//! The internal state of a vehicle: numbers of its modes, then of its passive joints.

use nalgebra::SVector;

/// Most modes and passive joints of a vehicle.
pub const MOST_MODES: usize = 6;
/// Amplitude and conjugate momentum of every mode, one pair after the other: kg^1/2 m and kg^1/2 m/s; then position and momentum of
/// every passive joint: rad and N m s, or m and N s.
pub type Internal = SVector<f64, INTERNAL>;
/// Numbers of an [`Internal`].
pub const INTERNAL: usize = 2 * MOST_MODES;
/// One number for each mode.
pub type PerMode = SVector<f64, MOST_MODES>;
