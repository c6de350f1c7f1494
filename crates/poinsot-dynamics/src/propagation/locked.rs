//! The vehicle as one body at its joints' positions, and the motion of its base that pose and momentum give.

use super::state::PoseMomentum;
use crate::algebra::{M3, Real, V3, parts, stack};
use crate::inertial::Inertial;
use crate::momentum::Twist;
use crate::quaternion;
use crate::symmetric::Symmetric;
use nalgebra::{Matrix3, Vector3, Vector6};
use poinsot_spatial::InertialParameters;

/// The vehicle as one body at its joints' positions, with the momentum of its joints and wheels, in B.
#[derive(Debug, Clone, Copy)]
pub struct LockedVehicle<T = f64> {
    mass: T,
    c: V3<T>,
    I_SScm: Symmetric<T>,
    /// Without the axial inertia of wheels of which the axial momentum is given.
    turning: Symmetric<T>,
    inverse: Symmetric<T>,
    l_joints: V3<T>,
    /// About the mass centre.
    h_joints: V3<T>,
}

/// The system's mass centre with the momentum in B.
#[derive(Debug, Clone, Copy)]
pub struct MassCentre {
    /// Its position from the base's origin, m.
    pub p_BoScm_B: Vector3<f64>,
    /// Linear momentum, N s.
    pub l_B: Vector3<f64>,
    /// Angular momentum about it, N m s.
    pub h_SScm_B: Vector3<f64>,
    /// Mass of the system, kg.
    pub mass: f64,
    /// Inertia about it, rotors as if locked, kg m2.
    pub I_SScm_B: Matrix3<f64>,
}

/// Twist of the base with what it takes to differentiate it.
#[derive(Debug, Clone, Copy)]
pub struct BaseMotion {
    /// Velocity of the base.
    pub twist: Twist,
    /// The mass centre.
    pub centre: MassCentre,
    /// Of the inertia about it.
    inverse: Symmetric,
}

impl LockedVehicle {
    /// `joints` is the momentum `[l; h]` about `Bo` of joint rates and wheels while the base is at rest. `turning` is `whole`
    /// without the axial inertia of wheels whose axial momentum is given, not their speed. `None` without positive mass or inertia.
    pub fn new(
        whole: &InertialParameters,
        turning: &InertialParameters,
        joints: &Vector6<f64>,
    ) -> Option<Self> {
        let [whole, turning] = [whole, turning].map(Inertial::of);
        let (l, h) = parts(&joints.data.0[0]);
        Self::over(&whole, &turning, (&l, &h))
    }

    /// The vehicle with deflected modes: its mass centre moves by `dc`, its inertia by `dI`; `turning` is what of it follows the base
    /// at once, and the modes have the momentum `h`.
    pub(super) fn deflected(
        &self,
        dc: &V3<f64>,
        dI: &Symmetric,
        (held, h): (&Symmetric, &V3<f64>),
    ) -> Option<Self> {
        let turning = self.turning.plus(dI).minus(held);
        Some(Self {
            c: self.c + *dc,
            I_SScm: self.I_SScm.plus(dI),
            turning,
            inverse: turning.inverse()?,
            h_joints: self.h_joints + *h - dc.cross(&self.l_joints),
            ..*self
        })
    }

    /// Inverse of the inertia that turns with the base.
    pub(super) fn turned(&self) -> M3<f64> {
        self.inverse.full()
    }

    /// Mass, mass centre and momentum of the joints.
    pub(super) fn parts(&self) -> (f64, V3<f64>, V3<f64>) {
        (self.mass, self.c, self.l_joints)
    }

    /// The motion of the base that a state gives.
    #[inline(always)]
    pub fn base_motion(&self, state: &PoseMomentum) -> BaseMotion {
        let R_NB = quaternion::rotation(&quaternion::numbers(&state.R_NB));
        let l = R_NB.transpose_times(&V3::of(&state.P));
        let h = R_NB.transpose_times(&V3::of(&state.h_SScm_N));
        BaseMotion {
            twist: self.twist(&l, &h),
            centre: MassCentre {
                p_BoScm_B: self.c.stored(),
                l_B: l.stored(),
                h_SScm_B: h.stored(),
                mass: self.mass,
                I_SScm_B: self.I_SScm.full().stored(),
            },
            inverse: self.inverse,
        }
    }
}

impl<T: Real> LockedVehicle<T> {
    #[inline(always)]
    pub(crate) fn over(
        whole: &Inertial<T>,
        turning: &Inertial<T>,
        (l_joints, h_joints): (&V3<T>, &V3<T>),
    ) -> Option<Self> {
        let mass = whole.mass;
        if !mass.exceeds(mass.all(0.0)) {
            return None;
        }
        let c = whole.centre();
        let turning = turning.about_centre(&c);
        Some(Self {
            mass,
            c,
            I_SScm: whole.about_centre(&c),
            turning,
            inverse: turning.inverse()?,
            l_joints: *l_joints,
            h_joints: *h_joints - c.cross(l_joints),
        })
    }

    /// The twist of the base at the momentum `l` and, about the mass centre, `h`, both in B. There the equations decouple:
    /// `I w = h - h_joints`, `v = (l - l_joints) / m - w x c`.
    #[inline(always)]
    pub(crate) fn twist(&self, l: &V3<T>, h: &V3<T>) -> Twist<T> {
        let turn = *h - self.h_joints;
        let w = self.inverse.times(&turn);
        // One refinement: errors of the inverse would accumulate and make unobservable directions observable.
        let w = w + self.inverse.times(&(turn - self.turning.times(&w)));
        let v = (*l - self.l_joints) / self.mass - w.cross(&self.c);
        Twist {
            v: v.stored(),
            w: w.stored(),
        }
    }
}

impl BaseMotion {
    /// `H^-1 [l; h]`: the base twist `(v, w)` that a momentum about the mass centre gives.
    #[inline(always)]
    pub(super) fn of_central(&self, l: &V3<f64>, h_Scm: &V3<f64>) -> (V3<f64>, V3<f64>) {
        let w = self.inverse.times(h_Scm);
        let c = V3::of(&self.centre.p_BoScm_B);
        (*l / self.centre.mass - w.cross(&c), w)
    }

    /// `H^-1 [l; h]`: the base twist `[v; w]` that a momentum about `Bo` gives, both in B.
    #[inline]
    pub fn twist_of(&self, momentum: &Vector6<f64>) -> Vector6<f64> {
        let (l, h) = parts(&momentum.data.0[0]);
        let c = V3::of(&self.centre.p_BoScm_B);
        stacked(&self.of_central(&l, &(h - c.cross(&l))))
    }

    /// Change of the twist `[v; w]`, pose and momentum held, where the momentum `[l; h]` about `Bo` at the present twist changes by
    /// `momentum` and the system's mass centre by `dp_BoScm_B`: `-H^-1 ([dl; dh] - [0; dc x l])`.
    #[inline]
    pub fn twist_slope(&self, momentum: &Vector6<f64>, dp_BoScm_B: &Vector3<f64>) -> Vector6<f64> {
        let ((l, h), dc) = (parts(&momentum.data.0[0]), V3::of(dp_BoScm_B));
        let (c, l_B) = (V3::of(&self.centre.p_BoScm_B), V3::of(&self.centre.l_B));
        stacked(&self.of_central(&-l, &(dc.cross(&l_B) - (h - c.cross(&l)))))
    }

    /// Change of the system's mass centre, in B, with one of the ten parameters of a body of which the rotation `R_BC` and
    /// the origin `p_BoCo_B` are given, in the order of `poinsot_spatial::PARAMETER_NAMES`.
    #[inline]
    pub fn mass_centre_slope(
        &self,
        R_BC: &Matrix3<f64>,
        p_BoCo_B: &Vector3<f64>,
        parameter: usize,
    ) -> Vector3<f64> {
        let centre = &self.centre;
        match parameter {
            0 => (p_BoCo_B - centre.p_BoScm_B) / centre.mass,
            k @ 1..=3 => R_BC.column(k - 1) / centre.mass,
            _ => Vector3::zeros(),
        }
    }
}

#[inline(always)]
pub(super) fn stacked((l, h): &(V3<f64>, V3<f64>)) -> Vector6<f64> {
    Vector6::from(stack(l, h))
}
