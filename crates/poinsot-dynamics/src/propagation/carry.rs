//! Columns of the state's sensitivity over a step.

use super::rows::{StateRows, add, halves};
use super::{HALF, STATE};
use crate::algebra::Real;

/// Evaluation and share of the step of each Runge-Kutta stage.
const STAGES: [(usize, f64); 4] = [(0, 0.0), (1, 0.5), (1, 0.5), (2, 1.0)];

/// The linear equation `x' = A x + b` of a column at the start, in the middle and at the end of a step.
#[derive(Debug, Clone, Copy)]
pub struct StepRows<'v, T = f64> {
    /// Upper half of `A`: [`super::BaseMotion::pose_rows`].
    pub pose: [&'v StateRows<T>; 3],
    /// Lower half of `A`, where the state changes the momentum's rate.
    pub momentum: [Option<&'v StateRows<T>>; 3],
}

impl<T: Real> StepRows<'_, T> {
    /// Upper half of `A x` by a momentum that stays, plus the upper half `drive` of `b`, at the three points.
    #[inline(always)]
    pub fn held(&self, momentum: &[T; HALF], drive: &[[T; HALF]; 3]) -> [[T; HALF]; 3] {
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
    pub fn carry_pose(&self, x: &mut [T; STATE], held: &[[T; HALF]; 3], dt: f64) {
        let start = [x[0], x[1], x[2]];
        let mut slope = held[0];
        let mut sum: Option<[T; HALF]> = None;
        for (i, (at, share)) in STAGES.into_iter().enumerate() {
            let mut phi = start;
            if i > 0 {
                turn(&mut phi, &slope, share * dt);
            }
            slope = self.pose[at].attitude_times(&phi);
            add(&mut slope, &held[at], phi[0].all(1.0));
            sum = Some(summed(sum, &slope, i));
        }
        if let Some(sum) = sum {
            for (x, change) in x.iter_mut().zip(&sum) {
                *x = *x + *change * (dt / 6.0);
            }
        }
    }

    /// Carries a column over a step of `dt` seconds: Runge-Kutta of fourth order on an equation that is linear. `pose` and
    /// `momentum` are both halves of `b` at the three points.
    #[inline(always)]
    pub fn carry(
        &self,
        x: &mut [T; STATE],
        pose: &[[T; HALF]; 3],
        momentum: &[[T; HALF]; 3],
        dt: f64,
    ) {
        let (start, start_momentum) = halves(x);
        let one = start[0].all(1.0);
        let mut slope = (pose[0], momentum[0]);
        let mut sum: Option<([T; HALF], [T; HALF])> = None;
        for (i, (at, share)) in STAGES.into_iter().enumerate() {
            let mut phi = [start[0], start[1], start[2]];
            let mut pushed = *start_momentum;
            if i > 0 {
                turn(&mut phi, &slope.0, share * dt);
                add(&mut pushed, &slope.1, one.all(share * dt));
            }
            slope = (self.pose[at].attitude_times(&phi), momentum[at]);
            add(&mut slope.0, &self.pose[at].momentum_times(&pushed), one);
            add(&mut slope.0, &pose[at], one);
            if let Some(rows) = self.momentum[at] {
                add(&mut slope.1, &rows.attitude_times(&phi), one);
                if rows.is_coupled() {
                    add(&mut slope.1, &rows.momentum_times(&pushed), one);
                }
            }
            sum = Some(match sum {
                None => slope,
                Some((a, b)) => (summed(Some(a), &slope.0, i), summed(Some(b), &slope.1, i)),
            });
        }
        if let Some((pose, momentum)) = sum {
            for (x, change) in x.iter_mut().zip(pose.iter().chain(&momentum)) {
                *x = *x + *change * (dt / 6.0);
            }
        }
    }
}

/// `phi += slope dt`, the attitude alone.
#[inline(always)]
fn turn<T: Real>(phi: &mut [T; 3], slope: &[T; HALF], dt: f64) {
    for (phi, slope) in phi.iter_mut().zip(slope) {
        *phi = *phi + *slope * dt;
    }
}

/// The stages' slopes with their weights 1, 2, 2, 1.
#[inline(always)]
fn summed<T: Real>(sum: Option<[T; HALF]>, slope: &[T; HALF], stage: usize) -> [T; HALF] {
    let Some(mut sum) = sum else {
        return *slope;
    };
    let weight = if stage == 3 { 1.0 } else { 2.0 };
    add(&mut sum, slope, slope[0].all(weight));
    sum
}
