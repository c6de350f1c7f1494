//! Inertia and bias force of a body with free joints outboard of it (`forward_dynamics.rs`).

use crate::algebra::{M3, Real, V3};
use crate::inertial::Inertial;
use crate::symmetric::Symmetric;

/// Smallest articulated inertia about a joint, relative to that about the other axes: below it, round-off.
const ROUND_OFF: f64 = 1e-13;

/// Articulated inertia `[[M, C], [C^T, J]]` and bias `[F; N]` about the body's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Articulated<T> {
    pub M: Symmetric<T>,
    pub C: M3<T>,
    pub J: Symmetric<T>,
    pub F: V3<T>,
    pub N: V3<T>,
}

impl<T: Real> Articulated<T> {
    /// One body alone, without bias.
    #[inline(always)]
    pub fn of(body: &Inertial<T>) -> Self {
        let Inertial { mass, mc, I } = *body;
        let zero = mass.all(0.0);
        Self {
            M: Symmetric::new([mass, zero, mass, zero, zero, mass]),
            // C = -[mc]x.
            C: M3([
                V3::new(zero, -mc.z, mc.y),
                V3::new(mc.z, zero, -mc.x),
                V3::new(-mc.y, mc.x, zero),
            ]),
            J: I,
            F: V3::all(zero),
            N: V3::all(zero),
        }
    }

    /// The inverse of [`Self::of`].
    #[inline(always)]
    pub fn of_one_body(&self) -> Inertial<T> {
        let [x, y, z] = &self.C.0;
        Inertial {
            mass: self.M.xx,
            mc: V3::new(z.y, x.z, y.x),
            I: self.J,
        }
    }

    /// Adds inertia and bias, moved from `Co` to `Po` over `r = p_PoCo`, to the outboard inertia of the parent.
    #[inline(always)]
    pub fn pass_on(&self, r: &V3<T>, parent: &mut Self) {
        // C_P = C - M [r]x; J_P = J + [r]x C_P + ([r]x C)^T.
        let C_P = self.C - self.M.full().times_skew(r);
        let ([px, py, pz], [cx, cy, cz]) = (C_P.crossed(r).0, self.C.crossed(r).0);
        parent.J += self.J;
        parent.J += Symmetric {
            xx: px.x + cx.x,
            xy: px.y + cy.x,
            yy: py.y + cy.y,
            xz: px.z + cz.x,
            yz: py.z + cz.y,
            zz: pz.z + cz.z,
        };
        parent.C = parent.C + C_P;
        parent.M += self.M;
        parent.F += self.F;
        parent.N += self.N + r.cross(&self.F);
    }

    /// The acceleration at which no force acts on the base: `IA [a; alpha] = -bias`.
    #[inline(always)]
    pub fn free_acceleration(&self) -> Option<(V3<T>, V3<T>)> {
        // L D L^T of the whole in two blocks. It is stable where an explicit inverse of M is not: for a light base on
        // a heavy arm that loses two more digits.
        let (M, C, J) = (&self.M, &self.C, &self.J);
        let upper = M.factor();
        let [x, y, z] = &C.0;
        let Y = [upper.forward(x), upper.forward(y), upper.forward(z)];
        let inverse = &upper.inverse;
        let Z = [
            Y[0].times_each(inverse),
            Y[1].times_each(inverse),
            Y[2].times_each(inverse),
        ];
        let rest = Symmetric {
            xx: J.xx - Y[0].dot(&Z[0]),
            xy: J.xy - Y[1].dot(&Z[0]),
            yy: J.yy - Y[1].dot(&Z[1]),
            xz: J.xz - Y[2].dot(&Z[0]),
            yz: J.yz - Y[2].dot(&Z[1]),
            zz: J.zz - Y[2].dot(&Z[2]),
        };
        let lower = rest.factor();
        if !upper.pivots_exceed(round_off(M.trace())) || !lower.pivots_exceed(round_off(J.trace()))
        {
            return None;
        }
        let f = -upper.forward(&self.F);
        let n = -self.N - V3::new(Z[0].dot(&f), Z[1].dot(&f), Z[2].dot(&f));
        let alpha = lower.back(&lower.forward(&n).times_each(&lower.inverse));
        let z = f.times_each(&upper.inverse);
        let a = upper.back(&(z - Z[0] * alpha.x - Z[1] * alpha.y - Z[2] * alpha.z));
        Some((a, alpha))
    }
}

/// The largest inertia that is round-off beside `size`.
#[inline(always)]
pub(crate) fn round_off<T: Real>(size: T) -> T {
    size.magnitude() * ROUND_OFF
}
