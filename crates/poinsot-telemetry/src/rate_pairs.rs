//! Body rates derived from attitude, and the mean gyro rate over the same interval.

use crate::hypothesis::{Axes, Order, Sense};
use crate::median::{median, median_step};
use crate::resample::resample;
use crate::{Channel, rotation};

/// Rotation per compared interval, rad: well above noise, small enough for averaging.
const TURN: f64 = 0.1;

/// Attitudes at both ends of intervals, their length, and the mean gyro rate in between.
pub(crate) struct Pairs {
    pub turns: Vec<Interval>,
}

pub(crate) struct Interval {
    dt: f64,
    q0: [f64; 4],
    q1: [f64; 4],
    gyro: [f64; 3],
}

/// Sums over the intervals, from which the residual of every unit and axis permutation follows.
pub(crate) struct Sums {
    pub n: f64,
    pub aa: f64,
    pub gg: f64,
    pub cross: [[f64; 3]; 3],
}

impl Sums {
    /// Sum of the products of the rates from the attitude and of the gyro in these axes.
    pub(crate) fn along(&self, axes: Axes) -> f64 {
        let rows = self.cross.iter().zip(axes.axis).zip(axes.sign);
        let products = rows.map(|((row, axis), sign)| row[axis] * f64::from(sign));
        products.sum()
    }

    pub(crate) fn residual(&self, factor: f64, axes: Axes) -> f64 {
        let square = self.aa - 2.0 * factor * self.along(axes) + factor * factor * self.gg;
        (square.max(0.0) / self.n).sqrt()
    }
}

impl Pairs {
    pub(crate) fn collect(attitude: [&Channel; 4], gyro: [&Channel; 3]) -> Option<Self> {
        let [x, y, z, w] = attitude;
        let [gx, gy, gz] = gyro;
        let same = [y, z, w].iter().all(|c| c.time_s == x.time_s)
            && [gy, gz].iter().all(|c| c.time_s == gx.time_s);
        if !same {
            return None;
        }
        let q: Vec<[f64; 4]> = (x.values.iter().zip(&y.values))
            .zip(z.values.iter().zip(&w.values))
            .map(|((x, y), (z, w))| [*x, *y, *z, *w])
            .collect();
        let angles = integrals(gyro, &x.time_s);
        let stride = stride(&q);
        let step = median_step(&x.time_s)?;
        let ends = q.iter().zip(x.time_s.iter()).zip(&angles);
        let mut turns = Vec::new();
        for (((q0, t0), a0), ((q1, t1), a1)) in ends.clone().zip(ends.skip(stride)).step_by(stride)
        {
            let dt = t1 - t0;
            let (Some((run0, a0)), Some((run1, a1))) = (a0, a1) else {
                continue;
            };
            if run0 != run1 || dt > 3.0 * step * stride as f64 {
                continue;
            }
            let mut mean = [0.0; 3];
            for (m, (a, b)) in mean.iter_mut().zip(a0.iter().zip(a1)) {
                *m = (b - a) / dt;
            }
            turns.push(Interval {
                dt,
                q0: *q0,
                q1: *q1,
                gyro: mean,
            });
        }
        (turns.len() >= 8).then_some(Self { turns })
    }

    /// Longest interval, s.
    pub(crate) fn longest_s(&self) -> f64 {
        self.turns.iter().fold(0.0, |m, t| t.dt.max(m))
    }

    pub(crate) fn sums(&self, order: Order, sense: Sense) -> Sums {
        let read = |[a, b, c, d]: [f64; 4]| {
            let [x, y, z, w] = match order {
                Order::Xyzw => [a, b, c, d],
                Order::Wxyz => [b, c, d, a],
            };
            match sense {
                Sense::BodyToInertial => [x, y, z, w],
                Sense::InertialToBody => [-x, -y, -z, w],
            }
        };
        let mut sums = Sums {
            n: self.turns.len() as f64,
            aa: 0.0,
            gg: 0.0,
            cross: [[0.0; 3]; 3],
        };
        for t in &self.turns {
            let rate = rotation::turn_between(read(t.q0), read(t.q1)).map(|c| c / t.dt);
            sums.aa += rate.iter().map(|a| a * a).sum::<f64>();
            sums.gg += t.gyro.iter().map(|g| g * g).sum::<f64>();
            for (row, a) in sums.cross.iter_mut().zip(rate) {
                for (c, g) in row.iter_mut().zip(t.gyro) {
                    *c += a * g;
                }
            }
        }
        sums
    }
}

/// Attitude samples per compared interval. The rotation angle between samples does not depend on the convention.
fn stride(q: &[[f64; 4]]) -> usize {
    let mut turns: Vec<f64> = q
        .iter()
        .zip(q.iter().skip(1))
        .map(|(a, b)| {
            let phi = rotation::turn_between(*a, *b);
            phi.iter().map(|c| c * c).sum::<f64>().sqrt()
        })
        .collect();
    let Some(turn) = median(&mut turns).filter(|t| *t > 0.0) else {
        return 1;
    };
    let most = (q.len() / 20).max(1);
    ((TURN / turn) as usize).clamp(1, most)
}

/// Integral of the gyro, linear between samples, from the start of a run to each time, with the index of the run.
/// `None` outside its samples and in gaps.
pub(crate) fn integrals(gyro: [&Channel; 3], times_s: &[f64]) -> Vec<Option<(usize, [f64; 3])>> {
    let [x, y, z] = gyro;
    let gap = 3.0 * median_step(&x.time_s).unwrap_or(0.0);
    let mut knots = Vec::with_capacity(x.values.len());
    let (mut run, mut sum) = (0_usize, [0.0; 3]);
    let mut before: Option<(f64, [f64; 3])> = None;
    let rates = x.values.iter().zip(&y.values).zip(&z.values);
    for (&t, ((&a, &b), &c)) in x.time_s.iter().zip(rates) {
        let here = [a, b, c];
        if let Some((t0, rate0)) = before {
            if t - t0 > gap {
                run += 1;
            }
            for (s, (a, b)) in sum.iter_mut().zip(rate0.iter().zip(here)) {
                *s += 0.5 * (a + b) * (t - t0);
            }
        }
        knots.push((run, sum, here));
        before = Some((t, here));
    }
    let mut rates = gyro.map(|c| resample(c, times_s, None).into_iter());
    let at = |&t: &f64| {
        let [a, b, c] = rates.each_mut().map(|r| r.next().flatten());
        let rate = [a?, b?, c?];
        let k = x.time_s.partition_point(|&s| s <= t).checked_sub(1)?;
        let (run, sum, rate0) = knots.get(k)?;
        let dt = t - x.time_s.get(k)?;
        let mut angle = *sum;
        for (s, (a, b)) in angle.iter_mut().zip(rate0.iter().zip(rate)) {
            *s += 0.5 * (a + b) * dt;
        }
        Some((*run, angle))
    };
    times_s.iter().map(at).collect()
}
