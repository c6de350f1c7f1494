//! Limits and friction of a reaction wheel.

/// Speed below which Coulomb friction fades out, so that a wheel at rest stays there, rad/s.
const STICTION_SPEED: f64 = 0.1;
/// Share of the speed limit over which a continuous controller reduces the torque.
const GIVING_WAY: f64 = 0.01;

/// Limits and friction of one wheel. The default has neither.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelLimits {
    /// Largest motor torque, N m.
    pub torque: f64,
    /// Largest speed relative to the host, rad/s.
    pub speed: f64,
    /// Viscous friction, N m s.
    pub viscous: f64,
    /// Coulomb friction, N m.
    pub coulomb: f64,
}

impl Default for WheelLimits {
    fn default() -> Self {
        Self {
            torque: f64::INFINITY,
            speed: f64::INFINITY,
            viscous: 0.0,
            coulomb: 0.0,
        }
    }
}

impl WheelLimits {
    /// Whether the numbers are valid: limits positive, friction not negative.
    pub fn is_valid(&self) -> bool {
        self.torque > 0.0
            && self.speed > 0.0
            && self.viscous.is_finite()
            && self.viscous >= 0.0
            && self.coulomb.is_finite()
            && self.coulomb >= 0.0
    }

    /// Torque of the bearing on the rotor at a speed relative to the host, N m.
    pub fn friction(&self, speed: f64) -> f64 {
        -self.viscous * speed - self.coulomb * (speed / STICTION_SPEED).tanh()
    }

    /// The motor torque for a command. A torque constant over `period` ends at the speed limit; a continuous one
    /// (`None`) is reduced linearly just before it.
    pub fn admit(&self, torque: f64, speed: f64, spin_inertia: f64, period: Option<f64>) -> f64 {
        let within = match period {
            _ if self.speed == f64::INFINITY => torque,
            Some(period) => torque.clamp(
                spin_inertia * (-self.speed - speed).min(0.0) / period,
                spin_inertia * (self.speed - speed).max(0.0) / period,
            ),
            None if torque * speed > 0.0 => {
                let room = (self.speed - speed.abs()) / (GIVING_WAY * self.speed);
                torque * room.clamp(0.0, 1.0)
            }
            None => torque,
        };
        within.clamp(-self.torque, self.torque)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_limits_hold() {
        let wheel = WheelLimits {
            torque: 0.01,
            speed: 100.0,
            ..WheelLimits::default()
        };
        assert_eq!(wheel.admit(0.02, 0.0, 4e-4, Some(0.1)), 0.01);
        assert_eq!(wheel.admit(-0.02, 0.0, 4e-4, None), -0.01);
        assert_eq!(wheel.admit(0.005, 100.0, 4e-4, Some(0.1)), 0.0);
        assert_eq!(wheel.admit(0.005, 100.5, 4e-4, None), 0.0);
        assert_eq!(wheel.admit(-0.005, 100.0, 4e-4, None), -0.005);
        // Ends exactly at the limit.
        let torque = wheel.admit(0.01, 99.0, 4e-4, Some(0.1));
        assert!((99.0 + torque * 0.1 / 4e-4 - 100.0).abs() < 1e-12);
    }

    #[test]
    fn unit_friction_brakes() {
        let wheel = WheelLimits {
            viscous: 1e-6,
            coulomb: 1e-4,
            ..WheelLimits::default()
        };
        assert!((wheel.friction(100.0) + 2e-4).abs() < 1e-15);
        assert!((wheel.friction(-100.0) - 2e-4).abs() < 1e-15);
        assert_eq!(wheel.friction(0.0), 0.0);
    }
}
