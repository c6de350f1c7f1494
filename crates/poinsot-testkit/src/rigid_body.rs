//! Torque-free motions of one body in closed form.
//!
//! All attitudes come from the conservation of angular momentum, never from integrating `R' = R [w]x`.

use crate::elliptic::{complete_first_by_complement, first_by_sine_cosine, jacobi_by_complement};
use crate::quadrature::GaussLegendre;
use crate::{Matrix3, Vector3, turn};
use nalgebra::SymmetricEigen;

/// Attitude and angular velocity of body B in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spin {
    /// Rotation from B to N.
    pub R_NB: Matrix3,
    /// Angular velocity, in B, rad/s.
    pub w_NB_B: Vector3,
}

/// The torque-free asymmetric top (Landau and Lifshitz, Mechanics, section 37; Jacobi 1849).
///
/// Principal axes `a, b, c`: `b` has the middle moment. `c` is the axis about which the momentum circulates: that of
/// the largest moment if `h^2 > 2 T I_b`, otherwise that of the smallest. With `u = p t + u0` and parameter `m`,
///
/// `w_a = A cn u`, `w_b = s A sqrt(k) sn u`, `w_c = C dn u`, `s = sign((I_c - I_a) C)`,
/// `k = I_a (I_c - I_a) / (I_b (I_c - I_b))`.
///
/// The momentum `h`, fixed in N, gives two Euler angles (3-1-3 about `c`):
/// `h_B / h = (sin theta sin psi, sin theta cos psi, cos theta)`. The third is the integral of
/// `phi' = h (I_a w_a^2 + I_b w_b^2) / (I_a^2 w_a^2 + I_b^2 w_b^2)`, which is periodic in `u` with period `2 K(m)`.
/// Whole periods are counted, and the rest is integrated by 16-point Gauss-Legendre quadrature. Panels are shorter
/// than the distance to the nearest complex singularity. Angular velocity and attitude are accurate to about
/// `1e-15 (1 + p t)`, less near the separatrix `m = 1`.
pub struct AsymmetricTop {
    /// Columns: a, b, c in B.
    R_BA: Matrix3,
    /// I_a, I_b, I_c, kg m2.
    moments: [f64; 3],
    /// A >= 0, C of either sign, rad/s.
    A: f64,
    C: f64,
    k: f64,
    /// 1 - m.
    m1: f64,
    /// p, rad/s.
    pace: f64,
    u0: f64,
    /// |h|, kg m2/s.
    h: f64,
    /// Axes with the momentum along the third: rotation from H to N.
    R_NH: Matrix3,
    rule: GaussLegendre,
    /// Increase of phi over one period of its rate, rad.
    phi_per_period: f64,
}

impl AsymmetricTop {
    /// The top with the central inertia `I_BBcm_B` (any axes) with initial state `start`.
    ///
    /// `None` where two principal moments are within 1e-9 of each other ([`AxisymmetricGyrostat`] is the closed form
    /// there), a moment is not positive, or the body does not rotate.
    pub fn new(I_BBcm_B: &Matrix3, start: &Spin) -> Option<Self> {
        let eigen = SymmetricEigen::new(*I_BBcm_B);
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let I = order.map(|i| eigen.eigenvalues[i]);
        let close = |i: f64, j: f64| j - i < 1e-9 * j;
        let degenerate = close(I[0], I[1]) || close(I[1], I[2]);
        if !I.iter().all(|i| i.is_finite() && *i > 0.0) || degenerate || start.w_NB_B.norm() == 0.0
        {
            return None;
        }
        let axes = order.map(|i| eigen.eigenvectors.column(i).into_owned());
        let w = axes.map(|axis| axis.dot(&start.w_NB_B));
        // h^2 - 2 T I_b, with the middle terms cancelled analytically.
        let about_largest =
            I[2] * (I[2] - I[1]) * w[2].powi(2) > I[0] * (I[1] - I[0]) * w[0].powi(2);
        let (a, c) = if about_largest { (0, 2) } else { (2, 0) };
        let axis_c = axes[c];
        let axis_a = axes[1].cross(&axis_c); // right-handed
        let R_BA = Matrix3::from_columns(&[axis_a, axes[1], axis_c]);
        let (Ia, Ib, Ic) = (I[a], I[1], I[c]);
        let [wa, wb, wc]: [f64; 3] = (R_BA.transpose() * start.w_NB_B).into();

        let k = Ia * (Ic - Ia) / (Ib * (Ic - Ib));
        let A = (wa * wa + wb * wb / k).sqrt();
        let C_size = (wc * wc + Ib * (Ib - Ia) / (Ic * (Ic - Ia)) * wb * wb).sqrt();
        let C = C_size.copysign(wc);
        // 1 - m with m = (I_b - I_a) I_a A^2 / ((I_c - I_b) I_c C^2): the middle terms cancel again.
        let circulation = (Ic - Ib) * Ic * wc * wc - (Ib - Ia) * Ia * wa * wa;
        let m1 = (circulation / ((Ic - Ib) * Ic * C * C)).max(0.0);
        let pace = ((Ic - Ib) * (Ic - Ia) / (Ia * Ib)).sqrt() * C_size;
        let s = ((Ic - Ia) * C).signum();
        let u0 = if A > 0.0 {
            first_by_sine_cosine(s * wb / (k.sqrt() * A), wa / A, m1)
        } else {
            0.0
        };

        let mut top = Self {
            R_BA,
            moments: [Ia, Ib, Ic],
            A,
            C,
            k,
            m1,
            pace,
            u0,
            h: (I_BBcm_B * start.w_NB_B).norm(),
            R_NH: Matrix3::identity(),
            rule: GaussLegendre::new(),
            phi_per_period: 0.0,
        };
        top.R_NH = start.R_NB * (top.nutation_and_spin(u0) * R_BA.transpose()).transpose();
        let period = top.period();
        if period.is_finite() {
            top.phi_per_period = top.phi_from_start(period);
        }
        Some(top)
    }

    /// Period of `w_NB_B` up to the signs of `w_a`, `w_b`, s; infinite on the separatrix.
    pub fn period(&self) -> f64 {
        2.0 * complete_first_by_complement(self.m1) / self.pace
    }

    /// Attitude and angular velocity at time `t` (s, may be negative).
    pub fn at(&self, t: f64) -> Spin {
        let u = self.u0 + self.pace * t;
        let [sn, cn, dn] = jacobi_by_complement(u, self.m1);
        let wb = self.side() * self.A * self.k.sqrt() * sn;
        let w_A = Vector3::new(self.A * cn, wb, self.C * dn);
        let R_HA = turn(Vector3::z() * self.phi(t)) * self.nutation_and_spin(u);
        Spin {
            R_NB: self.R_NH * R_HA * self.R_BA.transpose(),
            w_NB_B: self.R_BA * w_A,
        }
    }

    fn side(&self) -> f64 {
        let [Ia, _, Ic] = self.moments;
        ((Ic - Ia) * self.C).signum()
    }

    /// `R_x(theta) R_z(psi)`; the amplitude `A` cancels in psi, so pure spin needs no special case.
    fn nutation_and_spin(&self, u: f64) -> Matrix3 {
        let [Ia, Ib, Ic] = self.moments;
        let [sn, cn, dn] = jacobi_by_complement(u, self.m1);
        let (x, y) = (Ia * cn, Ib * self.side() * self.k.sqrt() * sn);
        let across = x.hypot(y);
        let (sin_psi, cos_psi) = (x / across, y / across);
        let (sin, cos) = (self.A * across, self.C * Ic * dn);
        let size = sin.hypot(cos);
        let (sin_theta, cos_theta) = (sin / size, cos / size);
        let nutation = Matrix3::new(
            1.0, 0.0, 0.0, 0.0, cos_theta, -sin_theta, 0.0, sin_theta, cos_theta,
        );
        let spin = Matrix3::new(cos_psi, -sin_psi, 0.0, sin_psi, cos_psi, 0.0, 0.0, 0.0, 1.0);
        nutation * spin
    }

    fn phi_rate(&self, t: f64) -> f64 {
        let [Ia, Ib, _] = self.moments;
        let [sn, cn, _] = jacobi_by_complement(self.u0 + self.pace * t, self.m1);
        let (a, b) = (cn * cn, self.k * sn * sn);
        self.h * (Ia * a + Ib * b) / (Ia * Ia * a + Ib * Ib * b)
    }

    fn phi_from_start(&self, t: f64) -> f64 {
        // The rate is singular where (cn / sn)^2 = -(I_b / I_a)^2 k, or with sn at i K' (K' >= pi/2).
        let [Ia, Ib, _] = self.moments;
        let ratio = Ib / Ia * self.k.sqrt();
        let distance = ratio.min(1.0 / ratio).min(1.0);
        self.rule
            .integrate(|t| self.phi_rate(t), 0.0, t, distance / self.pace)
    }

    fn phi(&self, t: f64) -> f64 {
        let periods = (t / self.period()).trunc(); // towards zero, so that a short time loses no digits
        if periods == 0.0 {
            return self.phi_from_start(t);
        }
        periods * self.phi_per_period + self.phi_from_start(t - periods * self.period())
    }
}

/// The axisymmetric body with a wheel of constant relative speed along its symmetry axis `e`; without
/// wheel momentum it is the symmetric top.
///
/// The rate `s = e.w` is constant and `w = h_B / I_t + e (s - (I_s s + h_w) / I_t)`. The attitude is a rotation about
/// the fixed momentum times a rotation about the symmetry axis:
/// `R(t) = exp([h_N / I_t t]x) R(0) exp([e (s - (I_s s + h_w) / I_t) t]x)` (Hughes, Spacecraft Attitude Dynamics 1986,
/// chapters 4 and 6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisymmetricGyrostat {
    /// Unit symmetry axis and spin axis of the wheel, in B.
    pub axis_B: Vector3,
    /// Central moment across the axis, kg m2.
    pub transverse: f64,
    /// Central moment along the axis, kg m2, including the locked rotor.
    pub axial: f64,
    /// `Js Omega`, kg m2/s.
    pub wheel_momentum: f64,
}

impl AxisymmetricGyrostat {
    /// The central inertia tensor in B, kg m2.
    pub fn inertia(&self) -> Matrix3 {
        let along = self.axis_B * self.axis_B.transpose();
        Matrix3::identity() * self.transverse + along * (self.axial - self.transverse)
    }

    /// Attitude and angular velocity at time `t` (s, may be negative) after `start`.
    pub fn at(&self, start: &Spin, t: f64) -> Spin {
        let rate = self.axis_B.dot(&start.w_NB_B);
        let h_B = self.inertia() * start.w_NB_B + self.axis_B * self.wheel_momentum;
        let precession_N = start.R_NB * h_B / self.transverse;
        let excess = rate - (self.axial * rate + self.wheel_momentum) / self.transverse;
        let spin = turn(self.axis_B * (excess * t));
        Spin {
            R_NB: turn(precession_N * t) * start.R_NB * spin,
            w_NB_B: spin.transpose() * h_B / self.transverse + self.axis_B * excess,
        }
    }
}

/// `Js (Omega + a.w)`: the axial momentum of one rotor, constant without bearing torque.
pub fn rotor_axial_momentum(
    spin_inertia: f64,
    axis_B: &Vector3,
    speed: f64,
    w_NB_B: &Vector3,
) -> f64 {
    spin_inertia * (speed + axis_B.dot(w_NB_B))
}

/// Attitude after a wheel rotation by `wheel_angle` (rad, relative to the body) with any speed profile, for zero total
/// angular momentum including the wheel.
///
/// `I w + Js Omega a = 0` keeps `w` along the body-fixed direction `I^-1 a`:
/// `R = R(0) exp(-[I^-1 a]x Js wheel_angle)`. `None` if the inertia is singular.
pub fn zero_momentum_slew(
    I_BBcm_B: &Matrix3,
    axis_B: &Vector3,
    spin_inertia: f64,
    R_NB_0: &Matrix3,
    wheel_angle: f64,
) -> Option<Matrix3> {
    let direction = I_BBcm_B.try_inverse()? * axis_B;
    Some(R_NB_0 * turn(-direction * (spin_inertia * wheel_angle)))
}

/// Position `p_NBo_N` (m) and velocity `v_NBo_B` (m/s, in B) of the frame origin of a free body at time `t` with
/// attitude `spin`. The mass centre moves uniformly from `p_NBcm_N_0` with `v_NBcm_N`.
pub fn coasting_origin(
    p_NBcm_N_0: &Vector3,
    v_NBcm_N: &Vector3,
    p_BoBcm_B: &Vector3,
    spin: &Spin,
    t: f64,
) -> (Vector3, Vector3) {
    (
        p_NBcm_N_0 + v_NBcm_N * t - spin.R_NB * p_BoBcm_B,
        spin.R_NB.transpose() * v_NBcm_N - spin.w_NB_B.cross(p_BoBcm_B),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{apart, apart_relative, attitude_apart};
    use crate::trees::rotation_from_xyzw;

    const START: [f64; 4] = [
        0.10259783520851541,
        0.20519567041703082,
        0.3077935056255462,
        0.9233805168766387,
    ];

    /// Invariants of a gyrostat of any shape without external torque.
    struct GyrostatInvariants {
        /// Angular momentum `R (I w + h_w)` in N, kg m2/s: constant for any wheel motion.
        h_N: Vector3,
        /// `w.I w / 2`, J, with locked rotors. It is constant at constant relative wheel speeds, because
        /// `I w' = -w x (I w + h_w)` has no component along `w`.
        energy_at_held_speed: f64,
    }

    /// The invariants of a body with central inertia `I_BBcm_B` (rotors locked) and wheel momentum `h_w_B`, the sum of
    /// `Js Omega a`.
    fn gyrostat_invariants(I_BBcm_B: &Matrix3, h_w_B: &Vector3, spin: &Spin) -> GyrostatInvariants {
        let bare = I_BBcm_B * spin.w_NB_B;
        GyrostatInvariants {
            h_N: spin.R_NB * (bare + h_w_B),
            energy_at_held_speed: 0.5 * spin.w_NB_B.dot(&bare),
        }
    }

    fn bus() -> Matrix3 {
        Matrix3::new(30.0, 0.26, 0.37, 0.26, 28.0, -0.29, 0.37, -0.29, 32.0)
    }

    fn start(w: [f64; 3]) -> Spin {
        Spin {
            R_NB: rotation_from_xyzw(START),
            w_NB_B: w.into(),
        }
    }

    /// Largest over smallest principal moment: bounds the rates of the motion over |w|.
    fn spread(I: &Matrix3) -> f64 {
        let moments = SymmetricEigen::new(*I).eigenvalues;
        moments.max() / moments.min()
    }

    /// Time derivative of the motion by sixth-order central differences (Richardson, twice), compared with
    /// `R' = R [w]x` and `w' = -I^-1 (w x (I w + h_w))`.
    fn equation_of_motion_error(
        at: impl Fn(f64) -> Spin,
        I: &Matrix3,
        h_w: &Vector3,
        t: f64,
    ) -> f64 {
        let step = 2e-2 / (at(t).w_NB_B.norm() * spread(I));
        let slope = |h: f64| {
            let (a, b) = (at(t + h), at(t - h));
            let (dR, dw) = (a.R_NB - b.R_NB, a.w_NB_B - b.w_NB_B);
            (dR / (2.0 * h), dw / (2.0 * h))
        };
        let ((R1, w1), (R2, w2), (R3, w3)) = (slope(step), slope(step / 2.0), slope(step / 4.0));
        let dR = (R1 - R2 * 20.0 + R3 * 64.0) / 45.0;
        let dw = (w1 - w2 * 20.0 + w3 * 64.0) / 45.0;
        let now = at(t);
        let w = now.w_NB_B;
        let expected = -I.try_inverse().unwrap() * w.cross(&(I * w + h_w));
        let size = w.norm();
        apart(&dR, &(now.R_NB * w.cross_matrix()), size) + apart(&dw, &expected, size * size)
    }

    #[test]
    #[allow(clippy::unreadable_literal)]
    fn xval_scipy_asymmetric_top() {
        // DOP853, rtol 1e-13, steps at most t/2000; both regimes.
        for (w, t, q, expected) in [
            (
                [0.1, -0.05, 0.3],
                7.5,
                [
                    0.5317430915804263,
                    -0.03843578227844623,
                    0.8438944915074754,
                    0.06011707245428506,
                ],
                [
                    0.10953338497209306,
                    -0.03974886772920734,
                    0.29819004044138653,
                ],
            ),
            (
                [0.1, -0.05, 0.3],
                120.0,
                [
                    0.2021978279496485,
                    0.2985876168335303,
                    0.5847073938036722,
                    0.7266902621319723,
                ],
                [-0.01348674300084357, -0.0199458533982, 0.319230365755404],
            ),
            (
                [0.02, 0.3, -0.05],
                7.5,
                [
                    -0.1759357510470169,
                    0.9535313910466706,
                    0.06171312406628942,
                    0.2366769699613849,
                ],
                [
                    0.03919163516058572,
                    0.29932261182795805,
                    -0.041910321093158905,
                ],
            ),
            (
                [0.02, 0.3, -0.05],
                120.0,
                [
                    0.024432318986952025,
                    -0.28405696911050776,
                    0.024757862819314733,
                    0.9581762616122839,
                ],
                [
                    -0.10930192509864847,
                    0.2683338599457705,
                    0.09457243771269219,
                ],
            ),
            (
                [-0.3, 0.1, 0.03],
                7.5,
                [
                    -0.8531989951376886,
                    0.06806774478736058,
                    0.37484205869469917,
                    0.3562466671410706,
                ],
                [
                    -0.298694196601538,
                    0.10764241461588497,
                    0.010468842679397707,
                ],
            ),
            (
                [-0.3, 0.1, 0.03],
                120.0,
                [
                    -0.00132158996485062,
                    0.6550818387848603,
                    0.7362176305677004,
                    0.1698518128707847,
                ],
                [0.17655462993036986, 0.2274721779533833, -0.1346032012927325],
            ),
            (
                [0.1, 0.35, 0.1],
                7.5,
                [
                    0.02080290405011394,
                    0.9073397320359922,
                    0.3863270455698801,
                    -0.16447876371490516,
                ],
                [
                    0.06598358458351672,
                    0.35000551448329265,
                    0.12523424853703616,
                ],
            ),
            (
                [0.1, 0.35, 0.1],
                120.0,
                [
                    0.020553456030848124,
                    -0.9130665328780996,
                    -0.0570220312320004,
                    -0.4032809813732,
                ],
                [
                    -0.08650912642855145,
                    0.3545085699132774,
                    -0.09708536558353745,
                ],
            ),
        ] {
            let spin = AsymmetricTop::new(&bus(), &start(w)).unwrap().at(t);
            let w_apart = apart_relative(&spin.w_NB_B, &Vector3::from(expected));
            let R_apart = attitude_apart(&spin.R_NB, &rotation_from_xyzw(q));
            assert!(w_apart < 1e-12, "{w:?} {t}: {w_apart:e}");
            assert!(R_apart < 1e-11, "{w:?} {t}: {R_apart:e}");
        }
    }

    /// Spins in both regimes, pure spins about every principal axis, and some nearly pure ones.
    fn spins(I: &Matrix3) -> Vec<[f64; 3]> {
        let eigen = SymmetricEigen::new(*I);
        let mut list = vec![
            [0.1, -0.05, 0.3],
            [-0.3, 0.1, 0.03],
            [0.1, 0.35, 0.1],
            [-0.4, -0.2, -0.9],
            [3.0, 0.2, 0.1],
        ];
        for i in 0..3 {
            let axis = eigen.eigenvectors.column(i).into_owned();
            list.push((axis * 0.7).into());
            list.push((axis * -0.7 + Vector3::new(1e-7, 2e-7, -1e-7)).into());
        }
        list
    }

    #[test]
    fn exact_asymmetric_top_obeys_euler_and_keeps_its_momentum() {
        let slender = Matrix3::from_diagonal(&Vector3::new(50.0, 2.0, 49.9));
        for I in [bus(), slender, bus() * 1e-3] {
            for w in spins(&I) {
                let first = start(w);
                let top = AsymmetricTop::new(&I, &first).unwrap();
                assert!(attitude_apart(&top.at(0.0).R_NB, &first.R_NB) < 1e-14);
                let w_apart = apart_relative(&top.at(0.0).w_NB_B, &first.w_NB_B);
                assert!(w_apart < 1e-14, "{w:?}: {w_apart:e}");
                let h_N = first.R_NB * I * first.w_NB_B;
                for t in [-37.0, -0.3, 0.0, 1.7, 22.0, 400.0] {
                    let spin = top.at(t);
                    let turns = 1.0 + t.abs() * first.w_NB_B.norm();
                    let kept = apart_relative(&(spin.R_NB * I * spin.w_NB_B), &h_N);
                    assert!(kept < 1e-14, "{w:?} {t}: {kept:e}");
                    let wrong = equation_of_motion_error(|t| top.at(t), &I, &Vector3::zeros(), t);
                    assert!(
                        wrong < 1e-12 * spread(&I) * (10.0 + turns),
                        "{w:?} {t}: {wrong:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn exact_asymmetric_top_may_be_restarted() {
        let first = start([0.1, -0.05, 0.3]);
        let top = AsymmetricTop::new(&bus(), &first).unwrap();
        let again = AsymmetricTop::new(&bus(), &top.at(61.0))
            .unwrap()
            .at(1234.5 - 61.0);
        let direct = top.at(1234.5);
        assert!(attitude_apart(&direct.R_NB, &again.R_NB) < 1e-12);
        assert!(apart_relative(&direct.w_NB_B, &again.w_NB_B) < 1e-12);
    }

    #[test]
    fn exact_separatrix_is_hyperbolic() {
        // h^2 = 2 T I_2: w_1^2 I_1 (I_2 - I_1) = w_3^2 I_3 (I_3 - I_2).
        let I = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0));
        let top = AsymmetricTop::new(&I, &start([3.0_f64.sqrt(), 0.0, 1.0])).unwrap();
        let size = 2.0;
        for t in [0.0_f64, 0.4, 1.1] {
            // w_2 = W tanh(n t), W = h / I_2, n = W sqrt((I_3 - I_2)(I_2 - I_1) / (I_1 I_3)).
            let W = 12.0_f64.sqrt() / 2.0;
            let n = W / 3.0_f64.sqrt();
            let expected = Vector3::new(
                3.0_f64.sqrt() / (n * t).cosh(),
                W * (n * t).tanh(),
                1.0 / (n * t).cosh(),
            );
            assert!(apart(&top.at(t).w_NB_B, &expected, size) < 1e-13, "{t}");
            let wrong = equation_of_motion_error(|t| top.at(t), &I, &Vector3::zeros(), t);
            assert!(wrong < 1e-11, "{t}: {wrong:e}");
        }
    }

    #[test]
    fn unit_asymmetric_top_declines_what_it_cannot_do() {
        let ball = Matrix3::from_diagonal(&Vector3::new(2.0, 2.0, 3.0));
        assert!(AsymmetricTop::new(&ball, &start([0.1, 0.2, 0.3])).is_none());
        assert!(AsymmetricTop::new(&bus(), &start([0.0; 3])).is_none());
        assert!(AsymmetricTop::new(&(bus() * f64::NAN), &start([0.1, 0.2, 0.3])).is_none());
        assert!(AsymmetricTop::new(&-bus(), &start([0.1, 0.2, 0.3])).is_none());
    }

    #[test]
    #[allow(clippy::unreadable_literal)]
    fn xval_scipy_axisymmetric_gyrostat() {
        let body = AxisymmetricGyrostat {
            axis_B: Vector3::z(),
            transverse: 10.0,
            axial: 6.0,
            wheel_momentum: 3.7,
        };
        let spin = body.at(&start([0.2, -0.1, 0.5]), 50.0);
        let q = [
            0.37524885070252023,
            0.28909470215370425,
            0.8308087287147572,
            0.29218044001005244,
        ];
        let w = Vector3::new(-0.04055366927461597, 0.21989861279318068, 0.5);
        assert!(attitude_apart(&spin.R_NB, &rotation_from_xyzw(q)) < 1e-11);
        assert!(apart_relative(&spin.w_NB_B, &w) < 1e-11);
    }

    #[test]
    fn exact_axisymmetric_gyrostat_obeys_euler_about_any_axis() {
        for wheel_momentum in [0.0, -4.1, 25.0] {
            let body = AxisymmetricGyrostat {
                axis_B: Vector3::new(2.0, -1.0, 2.0) / 3.0,
                transverse: 10.0,
                axial: 16.0,
                wheel_momentum,
            };
            let (I, h_w) = (body.inertia(), body.axis_B * wheel_momentum);
            let first = start([0.2, -0.1, 0.5]);
            let kept = gyrostat_invariants(&I, &h_w, &first);
            for t in [-20.0, 0.0, 3.0, 77.0] {
                let spin = body.at(&first, t);
                let now = gyrostat_invariants(&I, &h_w, &spin);
                assert!(apart_relative(&now.h_N, &kept.h_N) < 1e-14);
                assert!((now.energy_at_held_speed - kept.energy_at_held_speed).abs() < 1e-14);
                let wrong = equation_of_motion_error(|t| body.at(&first, t), &I, &h_w, t);
                assert!(wrong < 1e-11, "{wheel_momentum} {t}: {wrong:e}");
            }
        }
    }

    #[test]
    fn exact_axisymmetric_top_is_the_limit_of_the_asymmetric_top() {
        let body = AxisymmetricGyrostat {
            axis_B: Vector3::z(),
            transverse: 10.0,
            axial: 16.0,
            wheel_momentum: 0.0,
        };
        let nearly = Matrix3::from_diagonal(&Vector3::new(10.0, 10.0 + 2e-8, 16.0));
        let first = start([0.2, -0.1, 0.5]);
        let (a, b) = (
            body.at(&first, 9.0),
            AsymmetricTop::new(&nearly, &first).unwrap().at(9.0),
        );
        assert!(attitude_apart(&a.R_NB, &b.R_NB) < 2e-8);
        assert!(apart_relative(&a.w_NB_B, &b.w_NB_B) < 2e-8);
    }

    #[test]
    fn exact_zero_momentum_slew_keeps_zero_momentum() {
        let (axis, Js) = (Vector3::new(0.6, 0.0, 0.8), 0.02);
        let R0 = rotation_from_xyzw(START);
        // Wheel angle 40 sin(t/3): speed 40/3 cos(t/3), body rate -I^-1 a Js Omega.
        let at =
            |t: f64| zero_momentum_slew(&bus(), &axis, Js, &R0, 40.0 * (t / 3.0).sin()).unwrap();
        for t in [0.0_f64, 1.3, 4.0] {
            let step = 1e-2;
            let rate = |h: f64| (at(t + h) - at(t - h)) / (2.0 * h);
            let turning = at(t).transpose() * (rate(0.5 * step) * 4.0 - rate(step)) / 3.0;
            let w = Vector3::new(turning[(2, 1)], turning[(0, 2)], turning[(1, 0)]);
            let h = bus() * w + axis * (Js * 40.0 / 3.0 * (t / 3.0).cos());
            assert!(h.norm() < 1e-9, "{t}: {:e}", h.norm());
        }
    }

    #[test]
    fn exact_rotor_and_coasting_origin_by_hand() {
        let momentum = rotor_axial_momentum(0.5, &Vector3::x(), 4.0, &Vector3::new(2.0, 7.0, 7.0));
        assert_eq!(momentum, 3.0);
        let spin = Spin {
            R_NB: Matrix3::identity(),
            w_NB_B: Vector3::new(0.0, 0.0, 2.0),
        };
        let (p, v) = coasting_origin(
            &Vector3::x(),
            &Vector3::y(),
            &Vector3::new(0.5, 0.0, 0.0),
            &spin,
            3.0,
        );
        assert_eq!(p, Vector3::new(0.5, 3.0, 0.0));
        assert_eq!(v, Vector3::new(0.0, 0.0, 0.0));
    }
}
