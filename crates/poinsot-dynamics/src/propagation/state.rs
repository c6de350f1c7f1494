//! Pose and momentum, their rate, and the classical Runge-Kutta step.

use crate::algebra::{Real, V3};
use crate::momentum::Twist;
use crate::quaternion;
use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};

/// Pose of the base and momentum of the whole vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseMomentum {
    /// Attitude of the base.
    pub R_NB: UnitQuaternion<f64>,
    /// Position of the base's origin, m.
    pub p_NoBo_N: Vector3<f64>,
    /// Linear momentum in N, N s.
    pub P: Vector3<f64>,
    /// Angular momentum about the system's mass centre, N m s.
    pub h_SScm_N: Vector3<f64>,
}

/// Time derivative of a [`PoseMomentum`].
#[derive(Debug, Clone, Copy)]
pub struct PoseMomentumRate {
    q: [f64; 4],
    p: V3<f64>,
    P: V3<f64>,
    h: V3<f64>,
}

impl PoseMomentumRate {
    /// `twist` is that of the base; force (N) and torque about the system's mass centre (N m) are those from outside, in B.
    #[inline(always)]
    pub fn new(
        state: &PoseMomentum,
        twist: &Twist,
        (force_B, torque_B): (&Vector3<f64>, &Vector3<f64>),
    ) -> Self {
        let q = quaternion::numbers(&state.R_NB);
        let R = quaternion::rotation(&q);
        Self {
            q: quaternion::rate(&q, &V3::of(&twist.w)),
            p: R.times(&V3::of(&twist.v)),
            P: R.times(&V3::of(force_B)),
            h: R.times(&V3::of(torque_B)),
        }
    }
}

/// The three times of a step at which its inputs count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepPoint {
    /// At its start.
    Begin,
    /// After half of it.
    Middle,
    /// At its end.
    End,
}

/// A state that moves along its rate.
pub trait Moving: Copy {
    /// Its time derivative.
    type Rate: Copy;

    /// The state after `dt` seconds at a constant rate.
    fn after(&self, rate: &Self::Rate, dt: f64) -> Self;

    /// `rate + other * factor`.
    fn sum(rate: &Self::Rate, other: &Self::Rate, factor: f64) -> Self::Rate;

    /// `to - self`.
    fn until(&self, to: &Self) -> Self::Rate;
}

impl Moving for PoseMomentum {
    type Rate = PoseMomentumRate;

    /// The quaternion keeps length one.
    #[inline(always)]
    fn after(&self, rate: &Self::Rate, dt: f64) -> Self {
        let [x, y, z, w] = quaternion::numbers(&self.R_NB);
        let [a, b, c, d] = rate.q;
        let q = quaternion::unit([x + a * dt, y + b * dt, z + c * dt, w + d * dt]);
        Self {
            R_NB: Unit::new_unchecked(Quaternion::from(q)),
            p_NoBo_N: (V3::of(&self.p_NoBo_N) + rate.p * dt).stored(),
            P: (V3::of(&self.P) + rate.P * dt).stored(),
            h_SScm_N: (V3::of(&self.h_SScm_N) + rate.h * dt).stored(),
        }
    }

    #[inline(always)]
    fn sum(rate: &Self::Rate, other: &Self::Rate, factor: f64) -> Self::Rate {
        let ([x, y, z, w], [a, b, c, d]) = (rate.q, other.q);
        PoseMomentumRate {
            q: [
                x + a * factor,
                y + b * factor,
                z + c * factor,
                w + d * factor,
            ],
            p: rate.p + other.p * factor,
            P: rate.P + other.P * factor,
            h: rate.h + other.h * factor,
        }
    }

    /// The quaternions in one hemisphere.
    #[inline(always)]
    fn until(&self, to: &Self) -> Self::Rate {
        let [x, y, z, w] = quaternion::numbers(&self.R_NB);
        let [a, b, c, d] = quaternion::numbers(&to.R_NB);
        let cosine = x * a + y * b + z * c + w * d;
        let side = cosine / cosine.magnitude();
        PoseMomentumRate {
            q: [a * side - x, b * side - y, c * side - z, d * side - w],
            p: V3::of(&to.p_NoBo_N) - V3::of(&self.p_NoBo_N),
            P: V3::of(&to.P) - V3::of(&self.P),
            h: V3::of(&to.h_SScm_N) - V3::of(&self.h_SScm_N),
        }
    }
}

/// What moves a vehicle within a step.
pub trait Rates<S: Moving = PoseMomentum> {
    /// Rate of a state at a time of the step; `None` ends the step.
    fn rate(&mut self, at: StepPoint, state: &S) -> Option<S::Rate>;
}

/// One step of the classical Runge-Kutta rule of fourth order. `rate` is that of `start`; the rates in the middle are asked for
/// twice, that at the end once, in this order.
///
/// ```
/// use poinsot_dynamics::Twist;
/// use poinsot_dynamics::propagation::*;
/// use poinsot_spatial::{UnitQuaternion, Vector3};
///
#[doc = include_str!("../../doc/pushed.txt")]
/// let rate = Pushed.rate(StepPoint::Begin, &start).unwrap();
/// let end = runge_kutta_step(&start, &rate, 3.0, &mut Pushed).unwrap();
/// // 2 m/s2 over 3 s.
/// assert!((end.p_NoBo_N.x - 9.0).abs() < 1.0e-12);
/// assert!((end.P.x - 12.0).abs() < 1.0e-12);
/// ```
#[inline(always)]
pub fn runge_kutta_step<S: Moving>(
    start: &S,
    rate: &S::Rate,
    dt: f64,
    rates: &mut impl Rates<S>,
) -> Option<S> {
    let b = rates.rate(StepPoint::Middle, &start.after(rate, 0.5 * dt))?;
    let c = rates.rate(StepPoint::Middle, &start.after(&b, 0.5 * dt))?;
    let d = rates.rate(StepPoint::End, &start.after(&c, dt))?;
    let sum = S::sum(&S::sum(rate, &b, 2.0), &c, 2.0);
    Some(start.after(&S::sum(&sum, &d, 1.0), dt / 6.0))
}

/// The state in the middle of a step: on the cubic through states and rates at both ends, as good as the step itself.
///
/// ```
/// use poinsot_dynamics::Twist;
/// use poinsot_dynamics::propagation::*;
/// use poinsot_spatial::{UnitQuaternion, Vector3};
///
#[doc = include_str!("../../doc/pushed.txt")]
/// let rate = Pushed.rate(StepPoint::Begin, &start).unwrap();
/// let end = runge_kutta_step(&start, &rate, 4.0, &mut Pushed).unwrap();
/// let rate_at_end = Pushed.rate(StepPoint::End, &end).unwrap();
/// let middle = state_in_middle((&start, &rate), (&end, &rate_at_end), 4.0);
/// // 2 m/s2 over 2 s.
/// assert!((middle.p_NoBo_N.x - 4.0).abs() < 1.0e-12);
/// ```
#[inline(always)]
pub fn state_in_middle<S: Moving>(
    (start, rate_at_start): (&S, &S::Rate),
    (end, rate_at_end): (&S, &S::Rate),
    dt: f64,
) -> S {
    let half = start.until(end);
    let bend = S::sum(&half, rate_at_start, 0.25 * dt);
    start.after(&S::sum(&bend, rate_at_end, -0.25 * dt), 0.5)
}
