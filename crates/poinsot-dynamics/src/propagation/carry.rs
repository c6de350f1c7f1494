//! Columns of the state's sensitivity over a step.

use super::internal::INTERNAL;
use super::modes::ModeRows;
use super::rows::{StateRows, add};
use super::{COLUMN, Column, HALF, STATE};
use crate::algebra::Real;
use core::ops::Mul;

/// The linear equation `x' = A x + b` of a column at the start, in the middle and at the end of a step.
#[derive(Debug, Clone, Copy)]
pub struct StepRows<'v, R = f64> {
    /// Upper half of `A`: [`super::BaseMotion::pose_rows`].
    pub pose: [&'v StateRows<R>; 3],
    /// Lower half of `A`, where the state changes the momentum's rate.
    pub momentum: [Option<&'v StateRows<R>>; 3],
    /// The rows of the modes, where there are any.
    pub modes: [Option<&'v ModeRows>; 3],
}

/// `b` of a column at the three points.
#[derive(Debug, Clone, Copy, Default)]
pub struct Drives<T = f64> {
    /// Of the pose.
    pub pose: [[T; HALF]; 3],
    /// Of the momenta.
    pub push: [[T; HALF]; 3],
    /// Of the modes.
    pub internal: [[T; INTERNAL]; 3],
}

impl<R: Copy> StepRows<'_, R> {
    /// Upper half of `A x` by a momentum that stays, plus the upper half `drive` of `b`, at the three points.
    #[inline(always)]
    pub fn held<T: Real + Mul<R, Output = T>>(
        &self,
        momentum: &[T; HALF],
        drive: &[[T; HALF]; 3],
    ) -> [[T; HALF]; 3] {
        let mut held = *drive;
        for (held, rows) in held.iter_mut().zip(&self.pose) {
            let part = rows.momentum_times(momentum);
            add(held, &part, part[0].all(1.0));
        }
        held
    }

    /// Carries a column whose momentum stays over a step of `dt` seconds; `held` is that of [`Self::held`], or the upper half of `b`
    /// where the column has no momentum.
    #[inline(always)]
    pub fn carry_pose<T: Real + Mul<R, Output = T>>(
        &self,
        x: &mut [T; STATE],
        held: &[[T; HALF]; 3],
        dt: f64,
    ) {
        let start = [x[0], x[1], x[2]];
        let two = start[0].all(2.0);
        // Four stages of weights 1, 2, 2 and 1.
        let slope = self.pose_slope(0, &start, held);
        let mut sum = slope;
        let slope = self.pose_slope(1, &turned(&start, &slope, 0.5 * dt), held);
        add(&mut sum, &slope, two);
        let slope = self.pose_slope(1, &turned(&start, &slope, 0.5 * dt), held);
        add(&mut sum, &slope, two);
        let slope = self.pose_slope(2, &turned(&start, &slope, dt), held);
        for ((x, change), last) in x.iter_mut().zip(&sum).zip(&slope) {
            *x = *x + (*change + *last) * (dt / 6.0);
        }
    }

    /// The upper half of `A x + b` at one of the three points, by an attitude.
    #[inline(always)]
    fn pose_slope<T: Real + Mul<R, Output = T>>(
        &self,
        at: usize,
        phi: &[T; 3],
        held: &[[T; HALF]; 3],
    ) -> [T; HALF] {
        let mut slope = self.pose[at].attitude_times(phi);
        add(&mut slope, &held[at], phi[0].all(1.0));
        slope
    }

    /// Carries a column over a step of `dt` seconds: Runge-Kutta of fourth order on an equation that is linear. `pose` and
    /// `momentum` are both halves of `b` at the three points.
    #[inline(always)]
    pub fn carry<T: Real + Mul<R, Output = T>>(
        &self,
        x: &mut [T; STATE],
        pose: &[[T; HALF]; 3],
        momentum: &[[T; HALF]; 3],
        dt: f64,
    ) {
        let [p, q, r, _, _, _, a, b, c, d, e, f] = *x;
        let start = ([p, q, r], [a, b, c, d, e, f]);
        let drive = (pose, momentum);
        let two = start.0[0].all(2.0);
        let slope = self.slope(0, &start, drive);
        let mut sum = slope;
        let slope = self.slope(1, &after(&start, &slope, 0.5 * dt), drive);
        add(&mut sum.0, &slope.0, two);
        add(&mut sum.1, &slope.1, two);
        let slope = self.slope(1, &after(&start, &slope, 0.5 * dt), drive);
        add(&mut sum.0, &slope.0, two);
        add(&mut sum.1, &slope.1, two);
        let slope = self.slope(2, &after(&start, &slope, dt), drive);
        let sums = sum.0.iter().chain(&sum.1);
        for ((x, change), last) in x.iter_mut().zip(sums).zip(slope.0.iter().chain(&slope.1)) {
            *x = *x + (*change + *last) * (dt / 6.0);
        }
    }

    /// Both halves of `A x + b` at one of the three points.
    #[inline(always)]
    fn slope<T: Real + Mul<R, Output = T>>(
        &self,
        at: usize,
        (phi, momentum): &Moving<T>,
        (pose, push): (&[[T; HALF]; 3], &[[T; HALF]; 3]),
    ) -> ([T; HALF], [T; HALF]) {
        let one = phi[0].all(1.0);
        let mut slope = (self.pose[at].attitude_times(phi), push[at]);
        add(&mut slope.0, &self.pose[at].momentum_times(momentum), one);
        add(&mut slope.0, &pose[at], one);
        if let Some(rows) = self.momentum[at] {
            add(&mut slope.1, &rows.attitude_times(phi), one);
            if rows.coupled {
                add(&mut slope.1, &rows.momentum_times(momentum), one);
            }
        }
        slope
    }
}

impl StepRows<'_> {
    /// Carries a column over a step of `dt` seconds. Without modes the momenta stay where [`Self::momentum`] is not there.
    pub fn carry_column(&self, x: &mut Column, drives: &Drives, dt: f64) {
        let x = &mut x.data.0[0];
        if self.modes.iter().any(Option::is_some) {
            self.carry_flexible(x, drives, dt);
        } else if let Some(x) = x.first_chunk_mut() {
            if self.momentum.iter().any(Option::is_some) {
                self.carry(x, &drives.pose, &drives.push, dt);
            } else {
                let [.., a, b, c, d, e, f] = *x;
                let held = self.held(&[a, b, c, d, e, f], &drives.pose);
                self.carry_pose(x, &held, dt);
            }
        }
    }

    /// Carries a column of a vehicle with modes over a step of `dt` seconds, its pose, momenta and modes.
    #[inline(always)]
    pub(super) fn carry_flexible<T: Real>(&self, x: &mut [T; COLUMN], drives: &Drives<T>, dt: f64) {
        let start = *x;
        let mut slope = self.flexible_slope(0, x, drives);
        let mut sum = slope;
        for (at, share, weight) in [(1, 0.5, 2.0), (1, 0.5, 2.0), (2, 1.0, 1.0)] {
            for ((x, start), slope) in x.iter_mut().zip(&start).zip(&slope) {
                *x = *start + *slope * (share * dt);
            }
            slope = self.flexible_slope(at, x, drives);
            for (sum, slope) in sum.iter_mut().zip(&slope) {
                *sum = *sum + *slope * weight;
            }
        }
        for ((x, start), sum) in x.iter_mut().zip(&start).zip(&sum) {
            *x = *start + *sum * (dt / 6.0);
        }
    }

    /// `A x + b` at one of the three points.
    #[inline(always)]
    fn flexible_slope<T: Real>(
        &self,
        at: usize,
        x: &[T; COLUMN],
        drives: &Drives<T>,
    ) -> [T; COLUMN] {
        let [p, q, r, _, _, _, a, b, c, d, e, f, internal @ ..] = x;
        let (phi, momentum) = ([*p, *q, *r], [*a, *b, *c, *d, *e, *f]);
        let drive = (&drives.pose, &drives.push);
        let (mut pose, mut push) = self.slope(at, &(phi, momentum), drive);
        let mut own = drives.internal[at];
        if let Some(rows) = self.modes[at] {
            let columns = rows.attitude.iter().chain(&rows.momentum);
            for (column, x) in columns.zip(phi.iter().chain(&momentum)) {
                add_first(&mut own, column, *x, rows.count);
            }
            for (j, x) in internal.iter().enumerate().take(rows.count) {
                add_first(&mut own, &rows.internal[j], *x, rows.count);
                add(&mut pose, &rows.pose[j], *x);
                add(&mut push, &rows.push[j], *x);
            }
        }
        let mut out = [p.all(0.0); COLUMN];
        out[..HALF].copy_from_slice(&pose);
        out[HALF..STATE].copy_from_slice(&push);
        out[STATE..].copy_from_slice(&own);
        out
    }
}

/// `sum += x factor` of the first `count` numbers.
#[inline(always)]
fn add_first<T: Real>(sum: &mut [T; INTERNAL], x: &[f64; INTERNAL], factor: T, count: usize) {
    for (sum, x) in sum.iter_mut().zip(x).take(count) {
        *sum = *sum + factor * *x;
    }
}

/// Attitude and momenta of a column.
type Moving<T> = ([T; 3], [T; HALF]);

/// Attitude and momenta after `dt` seconds at this slope.
#[inline(always)]
fn after<T: Real>(
    (phi, momentum): &Moving<T>,
    slope: &([T; HALF], [T; HALF]),
    dt: f64,
) -> Moving<T> {
    let mut momentum = *momentum;
    add(&mut momentum, &slope.1, phi[0].all(dt));
    (turned(phi, &slope.0, dt), momentum)
}

/// The attitude `phi` after `dt` seconds at this slope.
#[inline(always)]
fn turned<T: Real>(phi: &[T; 3], slope: &[T; HALF], dt: f64) -> [T; 3] {
    let ([x, y, z], [a, b, c, ..]) = (*phi, *slope);
    [x + a * dt, y + b * dt, z + c * dt]
}
