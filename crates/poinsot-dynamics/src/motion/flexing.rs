//! Accelerations of a vehicle with modes, from those that its bodies would have without them.
//!
//! With `u` the velocity of a host from the mass centre, both undeformed, the rates of `h` and `p` (`propagation/modes.rs`) in N are
//!
//! ```text
//! [ J(y)  D ] [ alpha - alpha_0 ]   [ -dc x F - (S y w + D y' - dc x l_joints)'                            ]
//! [ D^T   G ] [       y''       ] = [ p' - delta_T . (a_0 - F / m - w_host x u) - delta_R . alpha_0 - G' y' ]
//! ```
//!
//! where the right side has the accelerations `a_0`, `alpha_0` without modes and no `y''`, and shapes turn with their hosts.

use crate::acceleration::Accelerations;
use crate::kinematics::Kinematics;
use crate::momentum::Wrench;
use crate::propagation::{FlexibleMotion, Internal, MOST_MODES, Mode};
use nalgebra::{Cholesky, SMatrix, SVector};
use poinsot_spatial::{Matrix3, Vector3};

const AXES: usize = 3;
const SIZE: usize = AXES + MOST_MODES;

/// A vehicle with modes at one instant.
pub(crate) struct Flexing<'a> {
    pub modes: &'a [Mode],
    /// With the velocities of the motion.
    pub kinematics: &'a Kinematics,
    pub motion: &'a FlexibleMotion,
    pub internal: &'a Internal,
    /// Its rate.
    pub rate: &'a Internal,
    /// On the vehicle, N, in B.
    pub force: Vector3,
}

/// A mode where its host is, in base axes.
#[derive(Clone, Copy, Default)]
struct Placed {
    body: usize,
    translation: Vector3,
    rotation: Vector3,
    slope: Matrix3,
    y: f64,
    rate: f64,
    /// Angular velocity of the host.
    w: Vector3,
    /// The host's origin from the mass centre, and its velocity from there.
    arm: Vector3,
    u: Vector3,
}

impl Placed {
    fn d(&self) -> Vector3 {
        self.rotation + self.arm.cross(&self.translation)
    }

    /// Rate of `translation y`.
    fn shift(&self) -> Vector3 {
        self.w.cross(&self.translation) * self.y + self.translation * self.rate
    }

    /// Rate of `S y w + D y'` without `y''`, for a base that turns at `w` and `alpha`.
    fn turn(&self, w: &Vector3, alpha: &Vector3) -> Vector3 {
        let (S, host) = (&self.slope, &self.w);
        let slope = host.cross(&(S * w)) - S * host.cross(w) + S * alpha;
        let across = self.u.cross(&self.translation);
        let d =
            host.cross(&self.rotation) + across + self.arm.cross(&host.cross(&self.translation));
        S * w * self.rate + slope * self.y + d * self.rate
    }

    /// What the mode exerts on its host, which accelerates by `a` and `alpha`, about its origin.
    fn reaction(&self, a: &Vector3, alpha: &Vector3, second: f64) -> Wrench {
        let (t, w, arm) = (&self.translation, &self.w, &self.arm);
        let bent =
            Matrix3::identity() * (2.0 * arm.dot(t)) - arm * t.transpose() - t * arm.transpose();
        // The slope about the host's origin.
        let S = self.slope - bent;
        let swung = alpha.cross(t) + w.cross(&w.cross(t));
        let turned = S * alpha + w.cross(&(S * w)) + t.cross(a);
        Wrench {
            force: -(t * second + w.cross(t) * (2.0 * self.rate) + swung * self.y),
            torque: -(self.rotation * second
                + (w.cross(&self.rotation) + S * w) * self.rate
                + turned * self.y),
        }
    }
}

/// The modes and the mass centre of the undeflected vehicle.
struct Scene {
    modes: [Placed; MOST_MODES],
    /// The mass centre from the base's origin, and its velocity.
    c: Vector3,
    v: Vector3,
}

impl Scene {
    /// `sum translation y`, and its rate.
    fn shifts(&self) -> [Vector3; 2] {
        let sum = |f: fn(&Placed) -> Vector3| self.modes.iter().map(f).sum();
        [sum(|m| m.translation * m.y), sum(Placed::shift)]
    }
}

impl Flexing<'_> {
    fn scene(&self) -> Scene {
        let (k, centre) = (self.kinematics, &self.motion.base.centre);
        let (c, v) = (centre.p_BoScm_B, centre.l_B / centre.mass);
        let modes = [Placed::default(); MOST_MODES];
        let mut scene = Scene { modes, c, v };
        for (i, (out, mode)) in scene.modes.iter_mut().zip(self.modes).enumerate() {
            let R = &k.R[mode.body];
            *out = Placed {
                body: mode.body,
                translation: R * mode.translation,
                rotation: R * mode.rotation,
                slope: R * mode.inertia_slope * R.transpose(),
                y: self.internal[2 * i],
                rate: self.motion.rates[i],
                w: k.w[mode.body],
                ..Placed::default()
            };
        }
        let [shift, slide] = scene.shifts();
        scene.c -= shift / centre.mass;
        scene.v -= slide / centre.mass;
        let (c, v) = (scene.c, scene.v);
        for mode in &mut scene.modes {
            (mode.arm, mode.u) = (k.p[mode.body] - c, k.v[mode.body] - v);
        }
        scene
    }

    fn left(&self, scene: &Scene) -> SMatrix<f64, SIZE, SIZE> {
        let (centre, modes) = (&self.motion.base.centre, &scene.modes);
        let mut out = SMatrix::<f64, SIZE, SIZE>::identity();
        out.fixed_view_mut::<AXES, AXES>(0, 0)
            .copy_from(&centre.I_SScm_B);
        for (i, a) in modes.iter().enumerate() {
            for axis in 0..AXES {
                out[(axis, AXES + i)] = a.d()[axis];
                out[(AXES + i, axis)] = a.d()[axis];
            }
            for (j, b) in modes.iter().enumerate() {
                out[(AXES + i, AXES + j)] -= a.translation.dot(&b.translation) / centre.mass;
            }
        }
        out
    }

    fn right(&self, scene: &Scene, bodies: &Accelerations) -> SVector<f64, SIZE> {
        let (k, m, modes) = (self.kinematics, self.motion.base.centre.mass, &scene.modes);
        let (w, fall) = (&k.w[0], self.force / m);
        // The mass centre moves in the base as the joints do.
        let slip = scene.v - k.v[0] - w.cross(&scene.c);
        let slipping =
            fall - bodies.a[0] - bodies.alpha[0].cross(&scene.c) - w.cross(&(scene.v - k.v[0]));
        let [shift, slide] = scene.shifts();
        let turned: Vector3 = modes.iter().map(|a| a.turn(w, &bodies.alpha[0])).sum();
        let h = slide.cross(&slip) + shift.cross(&slipping) - shift.cross(&fall) - turned;
        let mut out = SVector::<f64, SIZE>::zeros();
        out.fixed_rows_mut::<AXES>(0).copy_from(&h);
        for (i, a) in modes.iter().enumerate().take(self.modes.len()) {
            let pulled = bodies.a[a.body] - fall - a.w.cross(&a.u);
            let along = |b: &Placed| {
                let turned = a.w.cross(&a.translation).dot(&b.translation);
                (turned + a.translation.dot(&b.w.cross(&b.translation))) * b.rate / m
            };
            out[AXES + i] = self.rate[2 * i + 1]
                - a.translation.dot(&pulled)
                - a.rotation.dot(&bodies.alpha[a.body])
                + modes.iter().map(along).sum::<f64>();
        }
        out
    }

    /// Adds to the accelerations what the modes change, and to the wrenches on the bodies what they exert; `None` where the deflected
    /// vehicle has no positive inertia.
    pub fn add(&self, bodies: &mut Accelerations, outside: &mut [Wrench]) -> Option<()> {
        let scene = self.scene();
        let right = self.right(&scene, bodies);
        let found = Cholesky::new(self.left(&scene))?.solve(&right);
        let turn: Vector3 = found.fixed_rows::<AXES>(0).into();
        bodies.alpha.iter_mut().for_each(|alpha| *alpha += turn);
        let modes = || scene.modes.iter().zip(found.iter().skip(AXES));
        let push = |(mode, second): (&Placed, &f64)| {
            let alpha = &bodies.alpha[mode.body];
            mode.reaction(&Vector3::zeros(), alpha, *second).force
        };
        let push: Vector3 = modes().map(push).sum();
        let shift = push / self.motion.base.centre.mass - turn.cross(&scene.c);
        for (a, p) in bodies.a.iter_mut().zip(&self.kinematics.p) {
            *a += shift + turn.cross(p);
        }
        for (mode, second) in modes().take(self.modes.len()) {
            let (a, alpha) = (&bodies.a[mode.body], &bodies.alpha[mode.body]);
            let wrench = mode.reaction(a, alpha, *second);
            outside[mode.body].force += wrench.force;
            outside[mode.body].torque += wrench.torque;
        }
        Some(())
    }
}
