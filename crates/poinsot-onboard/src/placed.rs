//! The vehicle at one motion, and what changes of it do.

use crate::configuration::{Configuration, INPUTS, JOINTS};
use crate::numbers::WHEELS;
use crate::posture::{Held, Posture};
use poinsot_dynamics::propagation::{
    BodyChange, Flexibility, FlexibleChange, FlexibleMotion, Internal, OneBody,
};
use poinsot_spatial::{Vector3, Vector6, stacked};

/// The vehicle at one position and rate of its joints, the motion of its base, and its modes with their state.
#[derive(Clone, Copy)]
pub struct Placed<'a> {
    pub posture: &'a Posture,
    pub motion: &'a FlexibleMotion,
    pub modes: Option<(&'a Flexibility, &'a Internal)>,
}

impl Placed<'_> {
    /// Change of the motion, pose and momenta held.
    pub fn answer(&self, held: &Held) -> FlexibleChange {
        let twist = self.motion.twist_slope(&held.momentum, &held.centre);
        let Some((flexible, internal)) = self.modes else {
            return FlexibleChange::of_twist(twist);
        };
        let mut of = BodyChange {
            dc: held.centre,
            dm: held.mass,
            ..BodyChange::default()
        };
        let body = OneBody {
            over: 0,
            momentum: held.momentum,
            dm: held.mass,
            dmc: held.first_moment,
        };
        flexible.add_body(self.motion, (&mut of.held, &body), &Vector3::zeros());
        flexible.with_bodies((self.motion, internal), &twist, &of)
    }

    /// Change of the rates of the modes' state with such a change.
    pub fn mode_rates(&self, change: &FlexibleChange, force: &Vector3) -> Internal {
        self.modes.map_or_else(Internal::zeros, |(flexible, _)| {
            flexible.rate_change(self.motion, change, force)
        })
    }

    /// Change of the motion per unit of an input that the vehicle has.
    pub fn input_slope(&self, configuration: &Configuration, k: usize) -> FlexibleChange {
        let held = match k.checked_sub(WHEELS) {
            None => {
                let wheel = configuration.wheels().get(k);
                let h = wheel.map(|w| Vector3::from(w.axis_B) * w.spin_inertia);
                let h = stacked(&Vector3::zeros(), &h.unwrap_or_default());
                Held::of_motion(h, Vector3::zeros())
            }
            Some(j) if j < JOINTS => self.posture.of_position(j, self.motion),
            Some(j) => self.posture.of_rate(j - JOINTS),
        };
        self.answer(&held)
    }

    /// Change of the base's twist with one sigma of each input.
    pub fn input_twists(&self, configuration: &Configuration) -> [Vector6; INPUTS] {
        core::array::from_fn(|k| match configuration.input_noise(k) {
            0.0 => Vector6::zeros(),
            noise => self.input_slope(configuration, k).twist * noise,
        })
    }
}
