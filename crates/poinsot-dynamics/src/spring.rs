//! A spring in a joint.

/// A linear spring and damper beside the motor: `-stiffness (q - rest) - damping q'`. The default has neither.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpringDamper {
    /// N m/rad or N/m.
    pub stiffness: f64,
    /// Position without force, rad or m.
    pub rest: f64,
    /// N m s/rad or N s/m.
    pub damping: f64,
}

impl SpringDamper {
    /// Force on the joint at position `q` (rad or m) and rate (rad/s or m/s): N m or N.
    #[inline]
    pub fn force(&self, q: f64, rate: f64) -> f64 {
        -self.stiffness * (q - self.rest) - self.damping * rate
    }

    /// Energy in the spring, J.
    pub fn energy(&self, q: f64) -> f64 {
        0.5 * self.stiffness * (q - self.rest) * (q - self.rest)
    }
}
