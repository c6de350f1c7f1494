//! Momentum of the system about the base origin, the inverse map to the base twist, and the shift
//! between the base and the inertial frame.

use crate::algebra::{M3, Real, V3, stack};
use crate::inertial::Inertial;
use crate::kinematics::Kinematics;
use crate::tree::Tree;
use poinsot_spatial::{InertialParameters, Matrix3, UnitQuaternion, Vector3, Vector6};

/// Twist of the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist<T = f64> {
    /// `v_NBo_B`, m/s.
    pub v: nalgebra::Vector3<T>,
    /// `w_NB_B`, rad/s.
    pub w: nalgebra::Vector3<T>,
}

/// A force and the torque about a point that goes with it, in base axes, N and N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench<T = f64> {
    /// Force, N.
    pub force: nalgebra::Vector3<T>,
    /// Torque about the point of the context, N m.
    pub torque: nalgebra::Vector3<T>,
}

impl Wrench {
    /// Nothing.
    pub const ZERO: Self = Self {
        force: Vector3::new(0.0, 0.0, 0.0),
        torque: Vector3::new(0.0, 0.0, 0.0),
    };
}

/// Momentum `[l; h]` of one body about the base origin in B: linear N s, angular N m s.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // The base turns at 1 rad/s: the hinge moves along y.
/// let (R, p) = (&kinematics.R[1], &kinematics.p[1]);
/// let (l, h) = body_momentum(&bodies[1], R, p, &Vector3::y(), &Vector3::z());
/// // 1 kg at 2 m: l = m w r, h = I + m w r^2.
/// assert_eq!((l, h), (Vector3::y() * 2.0, Vector3::z() * 4.5));
/// ```
#[inline]
pub fn body_momentum(
    parameters: &InertialParameters,
    R: &Matrix3,
    p: &Vector3,
    v: &Vector3,
    w: &Vector3,
) -> (Vector3, Vector3) {
    let body = Inertial::of(parameters);
    let (p, v, w) = (V3::of(p), V3::of(v), V3::of(w));
    let (l, h) = of_body(&body, &M3::of(R), &p, &v, &w);
    (l.stored(), h.stored())
}

/// The same over any numbers.
#[inline(always)]
fn of_body<T: Real>(
    body: &Inertial<T>,
    R: &M3<T>,
    p: &V3<T>,
    v: &V3<T>,
    w: &V3<T>,
) -> (V3<T>, V3<T>) {
    let mc = R.times(&body.mc);
    let l = *v * body.mass + w.cross(&mc);
    let own = R.times(&body.I.times(&R.transpose_times(w)));
    (l, own + mc.cross(v) + p.cross(&l))
}

/// Momentum `[l; h]` of all bodies about the base origin in B (without wheels), at the kinematics given.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // The base turns at 1 rad/s with the arm locked.
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::z(), &[0.0]);
/// let found = momentum(&bodies, &kinematics);
/// assert_eq!(found, Vector6::new(0.0, 2.0, 0.0, 0.0, 0.0, 5.5));
/// ```
#[inline]
pub fn momentum(parameters: &[InertialParameters], kinematics: &Kinematics) -> Vector6 {
    let (l, h) = of_bodies(parameters.iter().map(Inertial::of), kinematics, 0.0);
    stack(&l, &h).into()
}

/// The same over any numbers.
#[inline(always)]
pub(crate) fn of_bodies<T: Real>(
    bodies: impl Iterator<Item = Inertial<T>>,
    kinematics: &Kinematics<T>,
    zero: T,
) -> (V3<T>, V3<T>) {
    let (mut l, mut h) = (V3::all(zero), V3::all(zero));
    for (i, body) in bodies.enumerate() {
        let k = kinematics;
        let (p, v, w) = (V3::of(&k.p[i]), V3::of(&k.v[i]), V3::of(&k.w[i]));
        let (dl, dh) = of_body(&body, &M3::of(&k.R[i]), &p, &v, &w);
        l += dl;
        h += dh;
    }
    (l, h)
}

/// Angular momentum of the wheels relative to their hosts, `sum Js Omega a`, in B, N m s.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let h = wheel_momentum(&tree, &kinematics, &[0.01], &[100.0]);
/// assert_eq!(h, Vector3::z());
/// ```
#[inline]
pub fn wheel_momentum(
    tree: &Tree,
    kinematics: &Kinematics,
    spin_inertia: &[f64],
    speed: &[f64],
) -> Vector3 {
    tree.rotors
        .iter()
        .zip(spin_inertia.iter().zip(speed))
        .map(|(rotor, (js, omega))| kinematics.R[rotor.body] * rotor.axis_B * (js * omega))
        .sum()
}

/// The vehicle as one rigid body at the placement given, about the base origin in B: its mass properties are those of the system.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let whole = composite(&bodies, &kinematics);
/// assert_eq!(whole.mass, 3.0);
/// assert_eq!(whole.p_BoScm_B(), Vector3::x() * (2.0 / 3.0));
/// // Two masses 2 m apart: their reduced mass of 2/3 kg adds 8/3 to their own 1.5.
/// assert!((whole.I_SScm_B()[(2, 2)] - (1.5 + 8.0 / 3.0)).abs() < 1.0e-12);
/// ```
pub fn composite(parameters: &[InertialParameters], kinematics: &Kinematics) -> InertialParameters {
    let mut whole = Inertial::nothing(0.0);
    for (i, body) in parameters.iter().enumerate() {
        let (R, p) = (M3::of(&kinematics.R[i]), V3::of(&kinematics.p[i]));
        whole += Inertial::of(body).turned(&R).seen_from(&p);
    }
    whole.stored()
}

/// [`composite`] and [`momentum`] in one pass: every tensor is turned to B once.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::z(), &[0.0]);
/// let (whole, found) = composite_and_momentum(&bodies, &kinematics);
/// assert_eq!(whole, composite(&bodies, &kinematics));
/// assert!((found - momentum(&bodies, &kinematics)).norm() < 1.0e-15);
/// ```
pub fn composite_and_momentum(
    parameters: &[InertialParameters],
    kinematics: &Kinematics,
) -> (InertialParameters, Vector6) {
    let mut whole = Inertial::nothing(0.0);
    let (mut l, mut h) = (V3::all(0.0), V3::all(0.0));
    let k = kinematics;
    let places = k.R.iter().zip(&k.p).zip(k.v.iter().zip(&k.w));
    for (body, ((R, p), (v, w))) in parameters.iter().zip(places) {
        let (p, v, w) = (V3::of(p), V3::of(v), V3::of(w));
        let own = Inertial::of(body).turned(&M3::of(R));
        let dl = v * own.mass + w.cross(&own.mc);
        l += dl;
        h += own.I.times(&w) + own.mc.cross(&v) + p.cross(&dl);
        whole += own.seen_from(&p);
    }
    (whole.stored(), stack(&l, &h).into())
}

/// The base twist that gives momentum `l`, `h` (about `Bo`, in B) after subtraction of the part of joint rates and
/// wheels, `l_joints`, `h_joints`: `V = H^-1 (momentum - c)`.
///
/// `None` where the composite has no mass or a singular central inertia.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // Without momentum the base turns back while the arm turns at 1 rad/s.
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::zeros(), &[1.0]);
/// let joints = momentum(&bodies, &kinematics);
/// let (l, h) = (joints.fixed_rows::<3>(0).into(), joints.fixed_rows::<3>(3).into());
/// let rest = Vector3::zeros();
/// let twist = twist_from_momentum(&composite(&bodies, &kinematics), &rest, &rest, &l, &h).unwrap();
/// // In the plane, about the mass centre: w = -(0.5 + 2/3 * 2) / (1.5 + 8/3).
/// assert!((twist.w.z + 0.44).abs() < 1.0e-12);
/// ```
#[inline]
pub fn twist_from_momentum(
    composite: &InertialParameters,
    l: &Vector3,
    h: &Vector3,
    l_joints: &Vector3,
    h_joints: &Vector3,
) -> Option<Twist> {
    let l_base = l - l_joints;
    let c = composite.p_BoScm_B();
    // About the mass centre the equations decouple: I_cm w = h - c x l, v = l / m - w x c.
    let h_cm = h - h_joints - c.cross(&l_base);
    let w = composite.I_SScm_B().cholesky()?.solve(&h_cm);
    let v = l_base / composite.mass - w.cross(&c);
    Some(Twist { v, w })
}

/// Momentum about `Bo` in B from momentum about the inertial origin in N: of `P = R l`, `H_N = R h + p x P`.
///
/// ```
/// use poinsot_dynamics::shift_to_body;
/// use poinsot_spatial::{UnitQuaternion, Vector3};
///
/// // 2 N s along x at y = 1 m: the moment about the origin of N is -2 N m s about z, and that about `Bo` zero.
/// let (P, H) = (Vector3::x() * 2.0, Vector3::z() * -2.0);
/// let (l, h) = shift_to_body(&UnitQuaternion::identity(), &Vector3::y(), &P, &H);
/// assert_eq!((l, h), (P, Vector3::zeros()));
/// ```
#[inline]
pub fn shift_to_body(
    R_NB: &UnitQuaternion,
    p_NoBo_N: &Vector3,
    P: &Vector3,
    H_N: &Vector3,
) -> (Vector3, Vector3) {
    let inverse = R_NB.inverse();
    (inverse * P, inverse * (H_N - p_NoBo_N.cross(P)))
}
