//! Checks of a configuration.

use crate::configuration::{Configuration, HELD_BACK, JOINTS, Wheel};
use crate::layout::required_capacity;
use crate::numbers::{AXES, MOUNTING, WHEELS, of_wheel};
use poinsot_dynamics::propagation::{MOST_MODES, Mode};

/// Why a configuration is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Invalid {
    /// The filter is built with too few columns; this many are needed.
    Capacity(usize),
    /// A number is NaN or infinite.
    NotFinite,
    /// More wheels than [`WHEELS`], joints than [`JOINTS`], modes than 6 or samples held back than 4, a link that no joint before it
    /// moves, or an uncertain number of no wheel.
    Count,
    /// A noise, a limit or a spin inertia is negative, or the noise of gyro or attitude is zero.
    Noise,
    /// The axis of a wheel or joint, or a quaternion, has not length one.
    Axis,
    /// A diagonal number of the prior is not positive.
    Prior,
    /// The nominal vehicle has no positive mass or inertia, or less than its modes carry.
    Unphysical,
    /// A mode has no positive frequency, a damping below zero or above that which is critical, or a slope of inertia that is not
    /// symmetric.
    Mode,
    /// Mass or first moment is unknown, but no position is measured and no joint moves.
    NeedsPosition,
}

impl Configuration {
    // Its copy is not on the stack of what follows.
    #[inline(never)]
    fn is_finite(&self) -> bool {
        let mut copy = *self;
        copy.numbers().all(|x| x.is_finite())
    }

    /// Checks all numbers, for a filter of `capacity` columns.
    ///
    /// # Errors
    /// The first condition that fails.
    pub fn check(&self, capacity: usize) -> Result<(), Invalid> {
        let noise = &self.noise;
        if !self.is_finite() {
            return Err(Invalid::NotFinite);
        }
        let counts = [
            (self.wheel_count, WHEELS),
            (self.joint_count, JOINTS),
            (self.reorder, HELD_BACK),
            (self.mode_count, MOST_MODES),
            (self.unknown_link, self.joint_count),
        ];
        let mut joints = self.joints().iter().enumerate();
        if counts.iter().any(|(n, most)| n > most) || joints.any(|(k, j)| j.parent > k) {
            return Err(Invalid::Count);
        }
        let of_wheels = self.wheels().iter().flat_map(|w| [w.spin_inertia, w.noise]);
        let of_joints = self.joints().iter();
        let of_joints = of_joints.flat_map(|j| [j.position_noise, j.rate_noise]);
        let positive = [noise.gyro, noise.attitude, self.longest_gap_s, self.stale_s];
        let limits = [self.longest_gap_s, self.stale_s];
        let mut noises = self.noise;
        let levels = noises.numbers().map(|x| *x).into_iter().chain(limits);
        let levels = levels.chain([self.forget_s]);
        let mut all = levels.chain(of_wheels).chain(of_joints);
        if !all.all(|x| x >= 0.0) || positive.contains(&0.0) {
            return Err(Invalid::Noise);
        }
        let long = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1.0e-6;
        let wheels = self.wheels().iter().all(|w: &Wheel| long(&w.axis_B));
        let mut joints = self.joints().iter();
        let joints = joints.all(|j| long(&j.axis) && long(&j.rotation));
        if !wheels || !joints || !long(&self.unknown_rotation) {
            return Err(Invalid::Axis);
        }
        let of_none = of_wheel(self.wheel_count)..MOUNTING;
        if self.uncertain[of_none].contains(&true) {
            return Err(Invalid::Count);
        }
        let mut diagonal = (0..self.uncertain().count()).map(|k| self.prior[(k, k)]);
        if !diagonal.all(|x| x > 0.0) {
            return Err(Invalid::Prior);
        }
        let swings = |m: &Mode| {
            let symmetric = m.inertia_slope == m.inertia_slope.transpose();
            symmetric && m.frequency_Hz > 0.0 && (0.0..1.0).contains(&m.damping_ratio)
        };
        if !self.modes().iter().all(swings) {
            return Err(Invalid::Mode);
        }
        if !self.is_possible(&self.nominal) {
            return Err(Invalid::Unphysical);
        }
        let tells = self.translates() || self.joint_count > 0;
        if !tells && self.uncertain[..=AXES].contains(&true) {
            return Err(Invalid::NeedsPosition);
        }
        match required_capacity(self) {
            needed if needed > capacity => Err(Invalid::Capacity(needed)),
            _ => Ok(()),
        }
    }
}
