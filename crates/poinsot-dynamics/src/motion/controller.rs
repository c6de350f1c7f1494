//! Closed loop: quaternion feedback with reaction wheels.
//!
//! The commanded torque of the wheels on the body is `u = -K_P q_e - K_D w` (Kim, Choi, Oh 2010, eq. 17; Wie 1998, sec.
//! 7.3), `q_e` the vector part of the error quaternion for the shorter rotation. The wheels share it with the smallest
//! sum of squares, `-C^T (C C^T)^-1 u`.

use crate::motion::attitude_control::{AttitudeControl, SAME, WheelDrive};
use crate::motion::plan::Plan;
use crate::motion::reaction_wheel::WheelLimits;
use crate::motion::times::Times;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Rows of `-C^T (C C^T)^-1`; the error is the number of directions that the axes span.
pub(crate) fn allocation(axes: &[Vector3]) -> Result<Vec<Vector3>, usize> {
    let gram: Matrix3 = axes.iter().map(|a| a * a.transpose()).sum();
    let eigenvalues = gram.symmetric_eigenvalues();
    let rank = eigenvalues.iter().filter(|x| **x > 1e-9).count();
    let factor = gram.cholesky().filter(|_| rank == 3).ok_or(rank)?;
    Ok(axes.iter().map(|a| -factor.solve(a)).collect())
}

/// Use of a controlled wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelUse {
    /// Largest speed relative to the host at an output time, rad/s.
    pub speed: f64,
    /// Largest motor torque at an output time, N m.
    pub torque: f64,
    /// Whether a limit cut a command there.
    pub limited: bool,
}

/// A wheel under control.
struct Commanded {
    /// Index of the wheel.
    wheel: usize,
    row: Vector3,
    limits: WheelLimits,
    spin_inertia: f64,
    /// Torque commanded last, N m.
    torque: f64,
    used: WheelUse,
}

/// The controller of one run.
pub(crate) struct Controller<'p> {
    law: &'p AttitudeControl,
    wheels: Vec<Commanded>,
    /// Output times, s.
    times: &'p Times<'p>,
    /// Control instants until now.
    instants: u64,
    target: UnitQuaternion,
}

impl<'p> Controller<'p> {
    /// That of a plan, if it has one.
    pub fn of(
        plan: &'p Plan,
        (allocation, spin_inertia): (&[Vector3], &[f64]),
        times: &'p Times<'p>,
    ) -> Option<Self> {
        let controlled = plan.wheels.iter().enumerate();
        let controlled = controlled
            .filter_map(|(wheel, motion)| motion.controlled().map(|(_, limits)| (wheel, limits)));
        let commanded = |((wheel, limits), row): ((usize, WheelLimits), &Vector3)| Commanded {
            wheel,
            row: *row,
            limits,
            spin_inertia: spin_inertia[wheel],
            torque: 0.0,
            used: WheelUse::default(),
        };
        Some(Self {
            law: plan.control.as_ref()?,
            wheels: controlled.zip(allocation).map(commanded).collect(),
            times,
            instants: 0,
            target: UnitQuaternion::identity(),
        })
    }

    /// Begins a smooth part at `t`; whether a new command is due there.
    pub fn enter(&mut self, t: f64) -> bool {
        self.target = self.law.target(t);
        let due = |period| self.due(period) - t <= SAME * period;
        let is_due = self.law.period.is_some_and(due);
        self.instants += u64::from(is_due);
        is_due
    }

    /// When the command jumps next, s.
    pub fn next(&self, t: f64) -> f64 {
        match self.law.period {
            Some(period) => self.due(period),
            None => self.event(self.law.next_target(t), SAME),
        }
    }

    /// Whether the command follows the state all the time.
    pub fn is_continuous(&self) -> bool {
        self.law.period.is_none()
    }

    /// The command for a state, within the limits of the wheels.
    pub fn decide(&mut self, R_NB: &UnitQuaternion, w_NB_B: &Vector3, speeds: &[f64]) {
        let e = self.target.inverse() * R_NB;
        // The shorter rotation.
        let q_e = if e.w < 0.0 { -e.imag() } else { e.imag() };
        let u = -(self.law.proportional * q_e) - self.law.derivative * w_NB_B;
        let period = self.law.period;
        for c in &mut self.wheels {
            let wanted = c.row.dot(&u);
            c.torque = (c.limits).admit(wanted, speeds[c.wheel], c.spin_inertia, period);
            c.used.limited |= c.torque != wanted && period.is_some();
        }
    }

    /// Rates of the wheels' momenta under the present command, N m.
    pub fn command(&self, speeds: &[f64], rates: &mut [f64]) {
        for c in &self.wheels {
            rates[c.wheel] = c.torque;
            if self.law.drive == WheelDrive::Torque {
                rates[c.wheel] += c.limits.friction(speeds[c.wheel]);
            }
        }
    }

    /// Takes down speeds, rad/s, and motor torques, N m, at an output time.
    pub fn note(&mut self, speeds: &[f64], torques: &[f64]) {
        for c in &mut self.wheels {
            let used = &mut c.used;
            used.speed = used.speed.max(speeds[c.wheel].abs());
            used.torque = used.torque.max(torques[c.wheel].abs());
            used.limited |= used.speed >= 0.99 * c.limits.speed
                || used.torque >= c.limits.torque * (1.0 - SAME);
        }
    }

    /// Use of the wheels so far.
    pub fn used(&self) -> Vec<WheelUse> {
        self.wheels.iter().map(|c| c.used).collect()
    }

    /// The next control instant, s.
    fn due(&self, period: f64) -> f64 {
        let first = self.times.get(0).unwrap_or(0.0);
        self.event(first + self.instants as f64 * period, SAME * period)
    }

    /// The time of a change of the command, or the output time that is the same but for `tolerance`, s.
    fn event(&self, time: f64, tolerance: f64) -> f64 {
        let output = self.times.not_before(time - tolerance);
        output.filter(|t| *t <= time + tolerance).unwrap_or(time)
    }
}
