//! Numbers that stay while the vehicle moves, and their places.

/// Most wheels.
pub const WHEELS: usize = 8;
/// Inertial parameters of a body.
pub(crate) const PARAMETERS: usize = 10;
/// Numbers of an attitude, a bias or another vector.
pub(crate) const AXES: usize = 3;
/// Numbers that stay: the parameters of the unknown body; of each wheel the relative error of its spin inertia and two tilts of its axis,
/// rad; the turn of the attitude sensor against the gyro, rad; the curve of the wheels' speeds between samples.
pub const NUMBERS: usize = CURVE + 1;
/// First place of the turn of the attitude sensor among them.
pub const MOUNTING: usize = PARAMETERS + AXES * WHEELS;
/// Place of the curve of the wheels' speeds among them: 0 where they are straight between samples, as torques that change at samples
/// make them, 1 where they have the bend of the last three samples.
pub const CURVE: usize = MOUNTING + AXES;
/// One value of each of them.
pub(crate) type Numbers = [f64; NUMBERS];
/// First place of a wheel among the numbers.
///
/// ```
/// use poinsot_onboard::{MOUNTING, WHEELS, of_wheel};
///
/// assert_eq!((of_wheel(0), of_wheel(WHEELS)), (10, MOUNTING));
/// ```
pub const fn of_wheel(k: usize) -> usize {
    PARAMETERS + AXES * k
}
