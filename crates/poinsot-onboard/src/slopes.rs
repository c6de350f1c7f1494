//! What the uncertain numbers do.

use crate::configuration::Configuration;
use crate::excitation::Excitation;
use crate::numbers::{AXES, PARAMETERS};
use crate::placed::Placed;
use crate::posture::Held;
use nalgebra::SMatrix;
use poinsot_dynamics::propagation::{FlexibleChange, PerMode};
use poinsot_spatial::{Vector3, Vector6, angular, linear, stacked, tensor_regressor};

/// What one number does at the present motion.
#[derive(Debug, Clone, Copy)]
pub struct NumberSlope {
    /// To the motion, pose and momenta held.
    pub change: FlexibleChange,
    /// To the momentum about the mass centre in B, pose and rates held, and to the momenta of the modes.
    pub momentum: Vector6,
    pub of_modes: PerMode,
    /// To the mass centre in B, and to the mass.
    pub centre: Vector3,
    pub mass: f64,
}

/// At one motion.
pub struct Slopes<'a> {
    configuration: &'a Configuration,
    placed: Placed<'a>,
    /// Its origin's velocity, and its rate along what was shown.
    v: Vector3,
    w: Vector3,
    tensor: SMatrix<f64, 3, 6>,
    rest: Vector3,
    shares: [f64; 6],
}

impl<'a> Slopes<'a> {
    pub fn new(configuration: &'a Configuration, placed: Placed<'a>, shown: &Excitation) -> Self {
        let (posture, motion) = (placed.posture, placed.motion);
        let centre = &motion.centre;
        let (R, p) = (&posture.unknown.R, &posture.unknown.p);
        let shown_w = shown.projector * motion.twist.w;
        let not_shown = motion.twist.w - shown_w;
        let by_joints = linear(&posture.of_unknown);
        let w = shown_w + angular(&posture.of_unknown);
        Self {
            configuration,
            placed,
            v: motion.twist.v + not_shown.cross(&centre.p_BoScm_B) + by_joints + w.cross(p),
            w,
            tensor: R * tensor_regressor(&(R.transpose() * w)),
            rest: centre.I_SScm_B * not_shown,
            shares: shown.shares(&centre.I_SScm_B, R),
        }
    }

    /// Of one number.
    pub fn of(&self, k: usize) -> NumberSlope {
        match k.checked_sub(PARAMETERS) {
            None => self.of_parameter(k),
            Some(place) => {
                let speeds = &self.placed.posture.speeds;
                self.of_momentum(&self.configuration.wheel_slope(place, speeds))
            }
        }
    }

    /// Of one that changes the angular momentum alone, by this in B.
    pub fn of_momentum(&self, h: &Vector3) -> NumberSlope {
        let momentum = stacked(&Vector3::zeros(), h);
        let held = Held::of_motion(momentum, Vector3::zeros());
        NumberSlope {
            change: self.placed.answer(&held),
            momentum,
            of_modes: PerMode::default(),
            centre: Vector3::zeros(),
            mass: 0.0,
        }
    }

    fn of_parameter(&self, k: usize) -> NumberSlope {
        let (placed, v) = (&self.placed, &self.v);
        let (posture, motion) = (placed.posture, placed.motion);
        let (c, l_B) = (motion.centre.p_BoScm_B, motion.centre.l_B);
        let (R, p) = (&posture.unknown.R, &posture.unknown.p);
        let none = Vector3::zeros();
        let (l, h, mass, first_moment) = match k {
            0 => (*v, none, 1.0, *p),
            1..=AXES => {
                let axis = R.column(k - 1).into_owned();
                (self.w.cross(&axis), axis.cross(v), 0.0, axis)
            }
            _ => {
                let element = k - AXES - 1;
                let h = self.tensor.column(element) + self.rest * self.shares[element];
                (none, h, 0.0, none)
            }
        };
        let h = h + p.cross(&l);
        let centre = motion.mass_centre_slope(R, p, k);
        let about_centre = h - c.cross(&l) - centre.cross(&l_B);
        let held = Held {
            momentum: stacked(&l, &h),
            centre,
            mass,
            first_moment,
        };
        let relative = l - l_B * (mass / motion.centre.mass);
        let of_modes = placed.modes.map(|(f, _)| f.momenta_change(&relative));
        NumberSlope {
            change: placed.answer(&held),
            momentum: stacked(&l, &about_centre),
            of_modes: of_modes.unwrap_or_default(),
            centre,
            mass,
        }
    }
}
