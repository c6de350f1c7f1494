//! Flexible modes: internal coordinates beside pose and momentum.
//!
//! A mode k of a body has an amplitude `y` and mass-normalised participations in translation and rotation. About the mass
//! centre c of the undeformed vehicle, in B, with `p` the momentum conjugate to `y`
//!
//! ```text
//! d = delta_R + (p_host - c) x delta_T,   G = 1 - delta_T^T delta_T / m,   J(y) = J + sum y S
//! h = J(y) w + h_joints + D y',           p = D^T w + G y' + c_y
//! (J(y) - D G^-1 D^T) w = h - h_joints - D G^-1 (p - c_y)
//! p' = -(2 pi f)^2 y - 2 zeta (2 pi f) y' - delta_T^T F / m + w^T S w / 2
//! ```
//!
//! where `c_y` is what joint rates add to `p`. The mass centre moves by `delta_T y / m`. No acceleration appears, and a uniform
//! drift changes nothing (Likins 1970 has the equations with accelerations). First order in the amplitude but for `J(y)`.
//!
//! A passive joint (`hinges.rs`) is the same with the coefficients of its placement: `J` then is that of the vehicle as it stands.

use super::hinges::{HeldChange, Hinge, PassiveJoints, Swinging};
use super::internal::{INTERNAL, Internal, MOST_MODES, PerMode};
use super::locked::{BaseMotion, LockedVehicle, stacked};
use super::rows::{StateRows, pose_change};
use super::state::{Moving, PoseMomentum, PoseMomentumRate};
use super::{Column, HALF, STATE};
use crate::algebra::{Real, V3};
use crate::joint_slopes::JointSlopes;
use crate::kinematics::Kinematics;
use crate::spring::SpringDamper;
use crate::symmetric::Symmetric;
use core::f64::consts::TAU;
use nalgebra::{Cholesky, Matrix3, SMatrix, Vector3, Vector6};
use poinsot_spatial::TENSOR;

const AXES: usize = 3;

/// A mode of a body, mass-normalised: the body held, its kinetic energy is `y'^2 / 2`. The mass properties of the body include
/// the undeformed appendage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mode {
    /// Index of the body.
    pub body: usize,
    /// Natural frequency with the body held, Hz.
    pub frequency_Hz: f64,
    /// Share of critical damping.
    pub damping_ratio: f64,
    /// Linear momentum per `y'`, in the body, kg^1/2.
    pub translation: Vector3<f64>,
    /// Angular momentum per `y'` about the body's origin, in the body, kg^1/2 m.
    pub rotation: Vector3<f64>,
    /// Slope of the inertia about the vehicle's mass centre over `y`, in the body, kg^1/2 m.
    pub inertia_slope: Matrix3<f64>,
}

/// Names of the elements of a slope, in the order of [`poinsot_spatial::TENSOR`].
const SLOPES: [&str; 6] = [
    "inertia_slope_xx",
    "inertia_slope_xy",
    "inertia_slope_yy",
    "inertia_slope_xz",
    "inertia_slope_yz",
    "inertia_slope_zz",
];

/// A number of a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModeNumber {
    /// Its frequency, Hz.
    Frequency,
    /// Its damping ratio.
    Damping,
    /// A component of its participation in translation.
    Translation(usize),
    /// A component of its participation in rotation.
    Rotation(usize),
    /// An element of its slope of inertia, in the order of [`poinsot_spatial::TENSOR`].
    InertiaSlope(usize),
}

impl Mode {
    /// One of its numbers.
    pub fn get(&self, number: ModeNumber) -> f64 {
        let mut own = *self;
        *own.of(number)
    }

    fn of(&mut self, number: ModeNumber) -> &mut f64 {
        match number {
            ModeNumber::Frequency => &mut self.frequency_Hz,
            ModeNumber::Damping => &mut self.damping_ratio,
            ModeNumber::Translation(axis) => &mut self.translation[axis],
            ModeNumber::Rotation(axis) => &mut self.rotation[axis],
            ModeNumber::InertiaSlope(k) => &mut self.inertia_slope[TENSOR[k]],
        }
    }

    /// Sets one of its numbers.
    pub fn set(&mut self, number: ModeNumber, value: f64) {
        *self.of(number) = value;
        if let ModeNumber::InertiaSlope(k) = number {
            let (i, j) = TENSOR[k];
            self.inertia_slope[(j, i)] = value;
        }
    }
}

impl ModeNumber {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Damping => "damping_ratio",
            Self::Translation(k) => ["translation_x", "translation_y", "translation_z"][k],
            Self::Rotation(k) => ["rotation_x", "rotation_y", "rotation_z"][k],
            Self::InertiaSlope(k) => SLOPES[k],
        }
    }

    /// Its unit in results.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Frequency => "Hz",
            Self::Damping => "1",
            Self::Translation(_) => "kg05",
            Self::Rotation(_) | Self::InertiaSlope(_) => "kg05 m",
        }
    }

    /// All numbers of a mode; those of one group belong together.
    pub fn groups() -> [&'static [Self]; 5] {
        use ModeNumber::{Damping, Frequency, InertiaSlope, Rotation, Translation};
        [
            &[Frequency],
            &[Damping],
            &[Translation(0), Translation(1), Translation(2)],
            &[Rotation(0), Rotation(1), Rotation(2)],
            &[
                InertiaSlope(0),
                InertiaSlope(1),
                InertiaSlope(2),
                InertiaSlope(3),
                InertiaSlope(4),
                InertiaSlope(5),
            ],
        ]
    }
}

/// A number of a passive joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpringNumber {
    /// Stiffness, N m/rad or N/m.
    Stiffness,
    /// Damping, N m s/rad or N s/m.
    Damping,
    /// Position without force, rad or m.
    Rest,
}

impl SpringNumber {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Stiffness, Self::Damping, Self::Rest];

    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Damping => "damping",
            Self::Rest => "rest",
        }
    }

    /// Its unit in results, of a joint that slides or turns.
    pub fn unit(self, slides: bool) -> &'static str {
        match (self, slides) {
            (Self::Stiffness, false) => "N m/rad",
            (Self::Stiffness, true) => "N/m",
            (Self::Damping, false) => "N m s/rad",
            (Self::Damping, true) => "N s/m",
            (Self::Rest, false) => "rad",
            (Self::Rest, true) => "m",
        }
    }

    /// The number of a spring.
    pub fn of(self, spring: &mut SpringDamper) -> &mut f64 {
        match self {
            Self::Stiffness => &mut spring.stiffness,
            Self::Damping => &mut spring.damping,
            Self::Rest => &mut spring.rest,
        }
    }
}

/// A mode or passive joint at a placement of its vehicle, in B.
#[derive(Debug, Clone, Copy, Default)]
struct Placed {
    /// Axes of its host.
    R: Matrix3<f64>,
    /// The host's origin from the mass centre of the undeformed vehicle.
    arm: Vector3<f64>,
    translation: Vector3<f64>,
    d: Vector3<f64>,
    slope: Matrix3<f64>,
    /// Velocity and rate of its host while the base is still, less those of the mass centre.
    still: (Vector3<f64>, Vector3<f64>),
    /// Its momentum while base and rates are still.
    carried: f64,
    spring: SpringDamper,
}

/// A body that modes belong to: its axes and origin, and their motion while the base is still, in B.
struct Host {
    R: Matrix3<f64>,
    p: Vector3<f64>,
    v: Vector3<f64>,
    w: Vector3<f64>,
}

impl Host {
    const BASE: Self = Self {
        R: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        p: Vector3::new(0.0, 0.0, 0.0),
        v: Vector3::new(0.0, 0.0, 0.0),
        w: Vector3::new(0.0, 0.0, 0.0),
    };
}

/// The modes and passive joints of a vehicle at one placement.
#[derive(Debug, Clone, Copy, Default)]
pub struct Flexibility {
    count: usize,
    /// How many of them are modes.
    modes: usize,
    of: [Placed; MOST_MODES],
    /// The passive joints.
    hinges: [Hinge; MOST_MODES],
    /// `G` and `G^-1`.
    coupling: SMatrix<f64, MOST_MODES, MOST_MODES>,
    inverse: SMatrix<f64, MOST_MODES, MOST_MODES>,
    mass: f64,
    l_joints: Vector3<f64>,
}

/// Motion of a vehicle with modes.
#[derive(Debug, Clone, Copy)]
pub struct FlexibleMotion {
    /// Of the base; the mass centre is that of the deflected vehicle.
    pub base: BaseMotion,
    /// `y'` of each mode.
    pub rates: PerMode,
}

/// What an unknown does to a vehicle, in B, at the present motion.
#[derive(Debug, Clone, Copy, Default)]
pub struct BodyChange {
    /// Change of the mass centre.
    pub dc: Vector3<f64>,
    /// Change of the mass.
    pub dm: f64,
    /// Change of momenta, and of the push on passive joints.
    pub held: HeldChange,
}

/// What an unknown does to one body, in B.
#[derive(Debug, Clone, Copy)]
pub struct OneBody {
    /// [`PassiveJoints::over`] of the body.
    pub over: u8,
    /// Change of its momentum about the base's origin.
    pub momentum: Vector6<f64>,
    /// Change of its mass.
    pub dm: f64,
    /// Change of its first moment about the base's origin.
    pub dmc: Vector3<f64>,
}

/// A change of a motion.
#[derive(Debug, Clone, Copy)]
pub struct FlexibleChange {
    /// Of the twist `[v; w]` of the base.
    pub twist: Vector6<f64>,
    /// Of `y'`.
    pub rates: PerMode,
    /// Of the rate of the momenta of passive joints, but for springs and forces.
    push: PerMode,
}

/// Pose and momentum with the modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlexibleState {
    /// Pose and momentum.
    pub rigid: PoseMomentum,
    /// The modes.
    pub internal: Internal,
}

/// Time derivative of a [`FlexibleState`].
#[derive(Debug, Clone, Copy)]
pub struct FlexibleRate {
    /// Of pose and momentum.
    pub rigid: PoseMomentumRate,
    /// Of the modes.
    pub internal: Internal,
}

impl From<BaseMotion> for FlexibleMotion {
    fn from(base: BaseMotion) -> Self {
        let rates = PerMode::zeros();
        Self { base, rates }
    }
}

impl core::ops::Deref for FlexibleMotion {
    type Target = BaseMotion;

    fn deref(&self) -> &BaseMotion {
        &self.base
    }
}

impl FlexibleChange {
    /// The modes go on as before.
    pub fn of_twist(twist: Vector6<f64>) -> Self {
        Self {
            twist,
            rates: PerMode::zeros(),
            push: PerMode::zeros(),
        }
    }
}

impl From<PoseMomentum> for FlexibleState {
    fn from(rigid: PoseMomentum) -> Self {
        let internal = Internal::zeros();
        Self { rigid, internal }
    }
}

impl core::ops::Deref for FlexibleState {
    type Target = PoseMomentum;

    fn deref(&self) -> &PoseMomentum {
        &self.rigid
    }
}

impl core::ops::DerefMut for FlexibleState {
    fn deref_mut(&mut self) -> &mut PoseMomentum {
        &mut self.rigid
    }
}

impl Moving for FlexibleState {
    type Rate = FlexibleRate;

    #[inline(always)]
    fn after(&self, rate: &FlexibleRate, dt: f64) -> Self {
        Self {
            rigid: self.rigid.after(&rate.rigid, dt),
            internal: self.internal + rate.internal * dt,
        }
    }

    #[inline(always)]
    fn sum(rate: &FlexibleRate, other: &FlexibleRate, factor: f64) -> FlexibleRate {
        FlexibleRate {
            rigid: PoseMomentum::sum(&rate.rigid, &other.rigid, factor),
            internal: rate.internal + other.internal * factor,
        }
    }

    #[inline(always)]
    fn until(&self, to: &Self) -> FlexibleRate {
        FlexibleRate {
            rigid: self.rigid.until(&to.rigid),
            internal: to.internal - self.internal,
        }
    }
}

impl Flexibility {
    /// Places the modes on a vehicle; `kinematics` has the velocities of its bodies while the base is still. `None` where the modes
    /// carry more than the vehicle weighs.
    pub fn new(modes: &[Mode], kinematics: &Kinematics, locked: &LockedVehicle) -> Option<Self> {
        let none = (&PassiveJoints::default(), &JointSlopes::default());
        Self::with_joints(modes, none, kinematics, locked)
    }

    /// The same with passive joints; `still` has the vehicle while base and passive joints are at rest.
    pub fn with_joints(
        modes: &[Mode],
        passive: (&PassiveJoints, &JointSlopes),
        kinematics: &Kinematics,
        locked: &LockedVehicle,
    ) -> Option<Self> {
        let mut out = Self::default();
        out.place(modes, passive, kinematics, locked)?;
        Some(out)
    }

    /// The same in place.
    pub fn place(
        &mut self,
        modes: &[Mode],
        (passive, still): (&PassiveJoints, &JointSlopes),
        kinematics: &Kinematics,
        locked: &LockedVehicle,
    ) -> Option<()> {
        let host = |body: usize| Host {
            R: kinematics.R[body],
            p: kinematics.p[body],
            v: kinematics.v[body],
            w: kinematics.w[body],
        };
        self.place_modes(modes, host, locked);
        let (mass, c, l_joints) = locked.parts();
        let (c, l_joints) = (c.stored(), l_joints.stored());
        for (hinge, spring) in passive.placed(still, kinematics) {
            let Some(out) = self.of.get_mut(self.count) else {
                break;
            };
            let [l, h] = [0, 3].map(|at| hinge.swing.fixed_rows::<3>(at).into_owned());
            out.translation = l;
            out.d = h - c.cross(&l);
            out.carried = hinge.still() - l.dot(&l_joints) / mass;
            out.spring = spring;
            self.hinges[self.count - self.modes] = hinge;
            self.count += 1;
        }
        self.couple()
    }

    /// Places modes of the base alone, whose body counts for nothing; `None` where they carry more than the vehicle weighs.
    pub fn place_on_base(&mut self, modes: &[Mode], locked: &LockedVehicle) -> Option<()> {
        self.place_modes(modes, |_| Host::BASE, locked);
        self.couple()
    }

    fn place_modes(
        &mut self,
        modes: &[Mode],
        host: impl Fn(usize) -> Host,
        locked: &LockedVehicle,
    ) {
        let (mass, c, l_joints) = locked.parts();
        (self.mass, self.l_joints) = (mass, l_joints.stored());
        self.modes = modes.len().min(MOST_MODES);
        self.count = self.modes;
        for (out, mode) in self.of.iter_mut().zip(modes) {
            let Host { R, p, v, w } = host(mode.body);
            let arm = p - c.stored();
            let (translation, rotation) = (R * mode.translation, R * mode.rotation);
            let v = v - self.l_joints / mass;
            let omega = TAU * mode.frequency_Hz;
            *out = Placed {
                R,
                arm,
                translation,
                d: rotation + arm.cross(&translation),
                slope: R * mode.inertia_slope * R.transpose(),
                still: (v, w),
                carried: translation.dot(&v) + rotation.dot(&w),
                spring: SpringDamper {
                    stiffness: omega * omega,
                    damping: 2.0 * mode.damping_ratio * omega,
                    rest: 0.0,
                },
            };
        }
    }

    /// What the rates have in common.
    fn couple(&mut self) -> Option<()> {
        self.coupling = SMatrix::identity();
        for i in 0..self.count {
            for j in 0..=i {
                let shared = self.of[i].translation.dot(&self.of[j].translation);
                let own = self.shared(i, j) - shared / self.mass;
                (self.coupling[(i, j)], self.coupling[(j, i)]) = (own, own);
            }
        }
        self.inverse = Cholesky::new(self.coupling)?.inverse();
        Some(())
    }

    /// Element of the mass matrix of rates while the base is held.
    fn shared(&self, i: usize, j: usize) -> f64 {
        match (i.checked_sub(self.modes), j.checked_sub(self.modes)) {
            (Some(i), Some(j)) => self.hinges[i].shared(&self.hinges[j], (i, j)),
            _ => f64::from(u8::from(i == j)),
        }
    }

    fn modes(&self) -> &[Placed] {
        &self.of[..self.count]
    }

    fn hinges(&self) -> &[Hinge] {
        &self.hinges[..self.count - self.modes]
    }

    /// What moves the mass centre: amplitudes of modes. Passive joints are placed where they are.
    fn amplitudes(&self, internal: &Internal) -> PerMode {
        PerMode::from_fn(|k, _| if k < self.modes { internal[2 * k] } else { 0.0 })
    }

    /// The passive joints in a change of the motion, or in all of it, with the change `dl` of the momentum otherwise.
    fn swinging(
        &self,
        w: Vector3<f64>,
        rates: &PerMode,
        c: &Vector3<f64>,
        l: &Vector3<f64>,
    ) -> Swinging<'_> {
        let v = -w.cross(c) - (self.shifted(rates) + l) / self.mass;
        Swinging {
            hinges: self.hinges(),
            twist: Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z),
            rates: PerMode::from_fn(|k, _| rates.get(self.modes + k).copied().unwrap_or(0.0)),
        }
    }

    /// The passive joints in a motion.
    fn in_motion(&self, motion: &FlexibleMotion) -> Swinging<'_> {
        let c = &motion.base.centre.p_BoScm_B;
        self.swinging(motion.base.twist.w, &motion.rates, c, &self.l_joints)
    }

    /// `D x`.
    fn spun(&self, x: &PerMode) -> Vector3<f64> {
        let each = self.modes().iter().zip(x.iter());
        each.map(|(mode, x)| mode.d * *x).sum()
    }

    /// `sum delta_T x`.
    fn shifted(&self, x: &PerMode) -> Vector3<f64> {
        let each = self.modes().iter().zip(x.iter());
        each.map(|(mode, x)| mode.translation * *x).sum()
    }

    /// `D^T w`.
    fn along(&self, w: &Vector3<f64>) -> PerMode {
        let mut out = PerMode::zeros();
        for (out, mode) in out.iter_mut().zip(self.modes()) {
            *out = mode.d.dot(w);
        }
        out
    }

    /// Motion of a vehicle, which `locked` describes without its modes; `None` where the deflected vehicle has no positive inertia.
    pub fn motion(&self, locked: &LockedVehicle, state: &FlexibleState) -> Option<FlexibleMotion> {
        let (y, mut free) = (self.amplitudes(&state.internal), momenta(&state.internal));
        for (free, mode) in free.iter_mut().zip(self.modes()) {
            *free -= mode.carried;
        }
        let free = self.inverse * free;
        let mut held = Matrix3::zeros();
        let mut slope = Matrix3::zeros();
        for (i, a) in self.modes().iter().enumerate() {
            slope += a.slope * y[i];
            for (j, b) in self.modes().iter().enumerate() {
                held += a.d * b.d.transpose() * self.inverse[(i, j)];
            }
        }
        let dc = self.shifted(&y) / self.mass;
        let own = (&Symmetric::of(&held), &V3::of(&self.spun(&free)));
        let deflected = locked.deflected(&V3::of(&dc), &Symmetric::of(&slope), own)?;
        let mut base = deflected.base_motion(&state.rigid);
        let rates = free - self.inverse * self.along(&base.twist.w);
        base.twist.v -= self.shifted(&rates) / self.mass;
        Some(FlexibleMotion { base, rates })
    }

    /// Bound of the frequencies of the passive joints, and of modes where they count, on the free vehicle, rad/s.
    pub fn fastest(&self, locked: &LockedVehicle, with_modes: bool) -> f64 {
        let first = if with_modes { 0 } else { self.modes };
        let turning: Matrix3<f64> = locked.turned().stored();
        let follows = SMatrix::<f64, MOST_MODES, MOST_MODES>::from_fn(|i, j| {
            self.of[i].d.dot(&(turning * self.of[j].d))
        });
        let Some(free) = Cholesky::new(self.coupling - follows) else {
            return 0.0;
        };
        let inverse = free.inverse();
        let springs = self.of.iter().enumerate().skip(first);
        let squares = springs.map(|(k, own)| own.spring.stiffness * inverse[(k, k)]);
        squares.fold(0.0, f64::max).root()
    }

    /// Change of the momenta of modes, twist and rates held, where bodies have so much more linear momentum relative to the mass
    /// centre's velocity.
    pub fn momenta_change(&self, l: &Vector3<f64>) -> PerMode {
        let mut out = PerMode::zeros();
        for (out, mode) in out.iter_mut().zip(self.modes()) {
            *out = -mode.translation.dot(l) / self.mass;
        }
        out
    }

    /// Modes at rest without deflection while the base turns, rad/s in B: `p = D^T w + c_y`.
    pub fn at_rest(&self, w: &Vector3<f64>) -> Internal {
        let mut out = Internal::zeros();
        for (k, mode) in self.modes().iter().enumerate() {
            out[2 * k] = mode.spring.rest;
            out[2 * k + 1] = mode.d.dot(w) + mode.carried;
        }
        out
    }

    /// Rate of the modes under a force on the vehicle, N, in B.
    pub fn rate(
        &self,
        motion: &FlexibleMotion,
        internal: &Internal,
        force_B: &Vector3<f64>,
    ) -> Internal {
        let w = &motion.base.twist.w;
        let mut out = Internal::zeros();
        for (k, mode) in self.modes().iter().enumerate() {
            let (y, rate) = (internal[2 * k], motion.rates[k]);
            out[2 * k] = rate;
            out[2 * k + 1] = 0.5 * w.dot(&(mode.slope * w)) + mode.spring.force(y, rate)
                - mode.translation.dot(force_B) / self.mass;
        }
        let swinging = self.in_motion(motion);
        for (k, hinge) in self.hinges().iter().enumerate() {
            out[2 * (self.modes + k) + 1] += swinging.push(hinge);
        }
        out
    }

    /// The change of a motion where pose and momenta stay. `twist` is its change if `y'` did not follow, by
    /// [`BaseMotion::twist_slope`] or [`Self::turned`]; `dp` and what `held` does is what the internal momenta would lack then.
    fn answer(
        &self,
        motion: &FlexibleMotion,
        twist: &Vector6<f64>,
        dp: &PerMode,
        held: Option<&HeldChange>,
    ) -> FlexibleChange {
        let mut dp = *dp;
        if let Some(held) = held {
            for (dp, mode) in dp.iter_mut().zip(self.modes()) {
                *dp += mode.translation.dot(&held.l) / self.mass;
            }
            for (k, hinge) in self.hinges().iter().enumerate() {
                dp[self.modes + k] -= hinge.along(&held.carried[k]);
            }
        }
        let free = self.inverse * dp;
        let (none, h) = (Vector3::zeros(), -self.spun(&free));
        let turn = motion.base.of_central(&V3::of(&none), &V3::of(&h));
        let mut twist = twist + stacked(&turn);
        let w: Vector3<f64> = twist.fixed_rows::<3>(3).into();
        let rates = free - self.inverse * self.along(&w);
        let v = self.shifted(&rates) / self.mass;
        twist.fixed_rows_mut::<3>(0).zip_apply(&v, |a, b| *a -= b);
        let mut push = PerMode::zeros();
        if !self.hinges().is_empty() {
            let l = held.map_or_else(Vector3::zeros, |held| held.l);
            let change = self.swinging(w, &rates, &motion.base.centre.p_BoScm_B, &l);
            let own = self.in_motion(motion).push_change(&change, held);
            let last = push.iter_mut().skip(self.modes);
            last.zip(&own).for_each(|(push, own)| *push = *own);
        }
        FlexibleChange { twist, rates, push }
    }

    /// Change of the twist where the momentum at the present motion changes by these, the angular one about the mass centre.
    fn turned(motion: &FlexibleMotion, l: &Vector3<f64>, h: &Vector3<f64>) -> Vector6<f64> {
        let held = motion.base.of_central(&V3::of(&-l), &V3::of(&-h));
        stacked(&held)
    }

    /// The change of a motion with an unknown that moves the momentum at the present twist: `held` is its
    /// [`BaseMotion::twist_slope`], `of` what it does to the bodies.
    pub fn with_bodies(
        &self,
        (motion, internal): (&FlexibleMotion, &Internal),
        held: &Vector6<f64>,
        of: &BodyChange,
    ) -> FlexibleChange {
        let (w, m) = (&motion.base.twist.w, self.mass);
        let deflection = self.shifted(&self.amplitudes(internal)) / m;
        let dc = of.dc + deflection * (of.dm / m);
        // `held` takes the deflected mass centre, the inertia is that about the other one.
        let turn = dc.cross(&w.cross(&deflection)) + deflection.cross(&w.cross(&dc));
        let along = self.shifted(&motion.rates) / m;
        let h = turn * m - deflection.cross(&(w.cross(&deflection) + along)) * of.dm;
        let held = held + Self::turned(motion, &Vector3::zeros(), &h);
        self.answer(motion, &held, &PerMode::zeros(), Some(&of.held))
    }

    /// Adds what an unknown does to one body under a force on the vehicle, N, in B.
    pub fn add_body(
        &self,
        motion: &FlexibleMotion,
        (out, body): (&mut HeldChange, &OneBody),
        force_B: &Vector3<f64>,
    ) {
        let u = motion.base.centre.l_B / self.mass;
        // Relative to the mass centre.
        let own = body.momentum - stacked(&(V3::of(&(u * body.dm)), V3::of(&body.dmc.cross(&u))));
        let l: Vector3<f64> = own.fixed_rows::<3>(0).into();
        out.l += l;
        for (k, hinge) in self.hinges().iter().enumerate() {
            if body.over & (1 << k) != 0 {
                out.carried[k] += own;
                out.push[k] -= hinge.pull(body.dm, &body.dmc).dot(force_B) / self.mass;
            }
        }
    }

    /// Adds what a change of position and rate of a joint does that is not passive.
    pub fn add_joint(
        &self,
        motion: &FlexibleMotion,
        (out, joint): (&mut HeldChange, &Hinge),
        [position, rate]: [f64; 2],
        force_B: &Vector3<f64>,
    ) {
        let swinging = self.in_motion(motion);
        let (moved, _) = swinging.moved(joint, &(force_B / self.mass));
        out.add(&moved, position);
        out.add(&swinging.driven(joint), rate);
    }

    /// The change of a motion with one number of the modes' state.
    fn with_internal(
        &self,
        motion: &FlexibleMotion,
        number: usize,
        force_B: &Vector3<f64>,
    ) -> FlexibleChange {
        let (k, is_momentum) = (number / 2, number % 2 == 1);
        let (mode, w) = (&self.of[k], &motion.base.twist.w);
        let mut dp = PerMode::zeros();
        if is_momentum {
            dp[k] = 1.0;
            return self.answer(motion, &Vector6::zeros(), &dp, None);
        }
        if let Some(hinge) = k.checked_sub(self.modes).map(|k| &self.hinges[k]) {
            let (moved, whole) = self.in_motion(motion).moved(hinge, &(force_B / self.mass));
            let held = -motion.base.twist_of(&whole);
            return self.answer(motion, &held, &dp, Some(&moved));
        }
        let h = mode.slope * w - mode.translation.cross(&self.l_joints) / self.mass;
        let held = Self::turned(motion, &w.cross(&mode.translation), &h);
        self.answer(motion, &held, &dp, None)
    }

    /// What a number of passive joint k adds to the rate of its momentum, with the place of that.
    pub fn with_spring(
        &self,
        (motion, internal): (&FlexibleMotion, &Internal),
        (k, number): (usize, SpringNumber),
    ) -> (usize, f64) {
        let at = self.modes + k;
        let spring = &self.of[at].spring;
        let push = match number {
            SpringNumber::Stiffness => spring.rest - internal[2 * at],
            SpringNumber::Damping => -motion.rates[at],
            SpringNumber::Rest => spring.stiffness,
        };
        (2 * at + 1, push)
    }

    /// The change of a motion with a number of mode k, and what it adds to the rate of the mode's momentum under a force, N, in B.
    pub fn with_number(
        &self,
        (motion, internal): (&FlexibleMotion, &Internal),
        (k, number): (usize, ModeNumber),
        force_B: &Vector3<f64>,
    ) -> (FlexibleChange, f64) {
        let (mode, w) = (&self.of[k], &motion.base.twist.w);
        let (y, rate) = (internal[2 * k], motion.rates[k]);
        let omega = mode.spring.stiffness.root();
        let mut dp = PerMode::zeros();
        let (mut l, mut h, mut push) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        match number {
            ModeNumber::Frequency => {
                let ratio = 0.5 * mode.spring.damping / omega;
                push = -2.0 * TAU * (omega * y + ratio * rate);
            }
            ModeNumber::Damping => push = -2.0 * omega * rate,
            ModeNumber::Translation(axis) => {
                let dt: Vector3<f64> = mode.R.column(axis).into();
                let dd = mode.arm.cross(&dt);
                l = dt * rate + w.cross(&dt) * y;
                h = dd * rate - dt.cross(&self.l_joints) * (y / self.mass);
                push = -dt.dot(force_B) / self.mass;
                for (j, other) in self.modes().iter().enumerate() {
                    dp[j] += dt.dot(&other.translation) * rate / self.mass;
                }
                dp[k] += dt.dot(&self.shifted(&motion.rates)) / self.mass;
                dp[k] -= dd.dot(w) + dt.dot(&mode.still.0);
            }
            ModeNumber::Rotation(axis) => {
                let dd: Vector3<f64> = mode.R.column(axis).into();
                h = dd * rate;
                dp[k] = -dd.dot(&(w + mode.still.1));
            }
            ModeNumber::InertiaSlope(element) => {
                let (i, j) = TENSOR[element];
                let (a, b) = (mode.R.column(i), mode.R.column(j));
                let share = if i == j { 0.5 } else { 1.0 };
                let turned = (a * b.dot(w) + b * a.dot(w)) * share;
                (h, push) = (turned * y, 0.5 * turned.dot(w));
            }
        }
        let held = Self::turned(motion, &l, &h);
        (self.answer(motion, &held, &dp, None), push)
    }

    /// How far the mass centre moves with a participation in translation, per unit of it, in B.
    pub fn centre_change(&self, internal: &Internal, k: usize, axis: usize) -> Vector3<f64> {
        self.of[k].R.column(axis) * (internal[2 * k] / self.mass)
    }

    /// Change of the modes' rates with a change of the motion and of the force, the modes' state held.
    pub fn rate_change(
        &self,
        motion: &FlexibleMotion,
        change: &FlexibleChange,
        dF_B: &Vector3<f64>,
    ) -> Internal {
        let dw: Vector3<f64> = change.twist.fixed_rows::<3>(3).into();
        let mut out = Internal::zeros();
        for (k, mode) in self.modes().iter().enumerate() {
            let rate = change.rates[k];
            out[2 * k] = rate;
            out[2 * k + 1] = (mode.slope * motion.base.twist.w).dot(&dw)
                - mode.spring.damping * rate
                - mode.translation.dot(dF_B) / self.mass
                + change.push[k];
        }
        out
    }

    /// Fills the linearised equations of the modes about a motion under a force, N, in B. `map` is [`BaseMotion::twist_rows`], and
    /// holds what becomes of it as the modes follow.
    pub fn rows(
        &self,
        motion: &FlexibleMotion,
        state: &PoseMomentum,
        (map, rows): (&mut StateRows, &mut ModeRows),
        force_B: &Vector3<f64>,
    ) {
        let (none, no_force) = (PerMode::zeros(), Vector3::zeros());
        rows.count = 2 * self.count;
        let follow = |held: &mut [f64; HALF]| {
            let change = self.answer(motion, &Vector6::from(*held), &none, None);
            *held = change.twist.into();
            self.rate_change(motion, &change, &no_force)
        };
        let outs = rows.attitude.iter_mut().chain(&mut rows.momentum);
        for (out, held) in outs.zip(map.attitude.iter_mut().chain(&mut map.momentum)) {
            *out = follow(held).into();
        }
        let R = *state.R_NB.to_rotation_matrix().matrix();
        for number in 0..rows.count {
            let mode = &self.of[number / 2];
            let change = self.with_internal(motion, number, force_B);
            let mut rate = self.rate_change(motion, &change, &no_force);
            if number.is_multiple_of(2) {
                rate[number + 1] -= mode.spring.stiffness;
                let torque = R * force_B.cross(&mode.translation) / self.mass;
                rows.push[number][AXES..].copy_from_slice(torque.as_slice());
            }
            rows.internal[number] = rate.into();
            rows.twist[number] = change.twist.into();
            rows.pose[number] = pose_change(&R, &change.twist).into();
        }
    }
}

impl ModeRows {
    /// Change of the rate of the internal state with a number of the change of pose and momentum; the position enters nowhere.
    pub fn rate_over_state(&self, column: usize) -> [f64; INTERNAL] {
        match column {
            0..AXES => self.attitude[column],
            HALF.. => self.momentum[column - HALF],
            _ => [0.0; INTERNAL],
        }
    }

    /// Change of the rate of a number of pose, momenta and internal state with another of them, where one of the two is internal.
    pub fn slope(&self, row: usize, column: usize) -> f64 {
        match (row.checked_sub(STATE), column.checked_sub(STATE)) {
            (Some(row), Some(column)) => self.internal[column][row],
            (Some(row), None) => self.rate_over_state(column)[row],
            (None, Some(column)) if row < HALF => self.pose[column][row],
            (None, Some(column)) => self.push[column][row - HALF],
            (None, None) => 0.0,
        }
    }

    /// Change of the rate of a number of the internal state with a column.
    pub fn rate_times(&self, number: usize, x: &Column) -> f64 {
        let used = STATE + self.count;
        let each = x.iter().take(used).enumerate();
        each.map(|(column, x)| self.slope(STATE + number, column) * x)
            .sum()
    }

    /// Change of the twist with the modes of a column.
    pub fn twist_times(&self, x: &Column) -> Vector6<f64> {
        let own = x.iter().skip(STATE).zip(&self.twist).take(self.count);
        own.map(|(x, twist)| Vector6::from(*twist) * *x).sum()
    }
}

fn momenta(internal: &Internal) -> PerMode {
    PerMode::from_fn(|k, _| internal[2 * k + 1])
}

/// The linearised equations of the modes at one instant, column by column.
#[derive(Debug, Clone, Copy, Default)]
pub struct ModeRows {
    /// Numbers of the modes' state that are used.
    pub count: usize,
    /// Change of the twist with each of them.
    pub twist: [[f64; HALF]; INTERNAL],
    /// Change of the pose's rate, and of that of the momenta.
    pub(super) pose: [[f64; HALF]; INTERNAL],
    pub(super) push: [[f64; HALF]; INTERNAL],
    /// Change of the rate of the modes' state with attitude, momenta and itself.
    pub(super) attitude: [[f64; INTERNAL]; AXES],
    pub(super) momentum: [[f64; INTERNAL]; HALF],
    pub(super) internal: [[f64; INTERNAL]; INTERNAL],
}
