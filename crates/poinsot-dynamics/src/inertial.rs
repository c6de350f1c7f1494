//! The ten inertial parameters over one number or over several side by side.

use crate::algebra::{M3, Real, V3};
use crate::symmetric::Symmetric;
use core::ops::AddAssign;
use poinsot_spatial::InertialParameters;

/// The ten inertial parameters of a body, or of several as one, about the origin of its frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Inertial<T> {
    pub mass: T,
    pub mc: V3<T>,
    pub I: Symmetric<T>,
}

impl Inertial<f64> {
    #[inline(always)]
    pub fn of(body: &InertialParameters) -> Self {
        Self {
            mass: body.mass,
            mc: V3::of(&body.mc_B),
            I: Symmetric::of(&body.I_BBo_B),
        }
    }

    pub fn stored(&self) -> InertialParameters {
        InertialParameters {
            mass: self.mass,
            mc_B: self.mc.stored(),
            I_BBo_B: self.I.full().stored(),
        }
    }
}

impl<T: Real> Inertial<T> {
    /// No body.
    #[inline(always)]
    pub fn nothing(zero: T) -> Self {
        Self {
            mass: zero,
            mc: V3::all(zero),
            I: Symmetric::new([zero; 6]),
        }
    }

    /// The same body in other axes.
    #[inline(always)]
    pub fn turned(&self, R: &M3<T>) -> Self {
        Self {
            mass: self.mass,
            mc: R.times(&self.mc),
            I: self.I.turned(R),
        }
    }

    /// The same about another point, from which the present one lies at `r`.
    #[inline(always)]
    pub fn seen_from(&self, r: &V3<T>) -> Self {
        let Self { mass, mc, mut I } = *self;
        let g = mc + *r * mass;
        let d = r.dot(&mc) + r.dot(&g);
        I += Symmetric {
            xx: d - r.x * g.x - mc.x * r.x,
            xy: -r.x * g.y - mc.x * r.y,
            yy: d - r.y * g.y - mc.y * r.y,
            xz: -r.x * g.z - mc.x * r.z,
            yz: -r.y * g.z - mc.y * r.z,
            zz: d - r.z * g.z - mc.z * r.z,
        };
        Self { mass, mc: g, I }
    }

    /// The mass centre.
    #[inline(always)]
    pub fn centre(&self) -> V3<T> {
        self.mc / self.mass
    }

    /// The inertia about the mass centre at `c`.
    #[inline(always)]
    pub fn about_centre(&self, c: &V3<T>) -> Symmetric<T> {
        let (I, m) = (&self.I, self.mass);
        let (xx, yy, zz) = (c.x * c.x, c.y * c.y, c.z * c.z);
        Symmetric {
            xx: I.xx - m * (yy + zz),
            xy: I.xy + m * (c.x * c.y),
            yy: I.yy - m * (xx + zz),
            xz: I.xz + m * (c.x * c.z),
            yz: I.yz + m * (c.y * c.z),
            zz: I.zz - m * (xx + yy),
        }
    }
}

impl<T: Real> AddAssign for Inertial<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.mass = self.mass + other.mass;
        self.mc += other.mc;
        self.I += other.I;
    }
}
