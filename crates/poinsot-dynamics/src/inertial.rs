//! The ten inertial parameters over one number or over several side by side.

#[cfg(feature = "std")]
use crate::algebra::Real;
use crate::algebra::V3;
use crate::symmetric::Symmetric;
use poinsot_spatial::InertialParameters;

/// The ten inertial parameters of a body, or of several as one, about the origin of its frame.
#[derive(Debug, Clone, Copy)]
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
}

#[cfg(feature = "std")]
impl<T: Real> Inertial<T> {
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
