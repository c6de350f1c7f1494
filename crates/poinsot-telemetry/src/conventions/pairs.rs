//! Two measurements of one motion over the same intervals: how far it goes by one, and by the rates of the other.

use crate::median::{median, median_step};
use crate::{Axes, Channel, GAP, Order, Sense, classify, integral, resample_hermite, rotation};
use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};
use std::f64::consts::SQRT_2;

/// Turn of an attitude per compared interval, rad, and share of the range of other channels: well above noise, small enough for
/// averaging.
const TURN: f64 = 0.1;

/// Values at both ends of intervals, their length, and the mean rate in between.
pub(crate) struct Pairs {
    pub turns: Vec<Interval>,
    is_attitude: bool,
}

pub(crate) struct Interval {
    dt: f64,
    from: [f64; 4],
    to: [f64; 4],
    rate: [f64; 3],
    /// The turn that the rates make from sample to sample, where they are those of a body, and that of the opposite rates: others
    /// than by their mean where its axis moves, or by more than half a turn.
    turn: Option<[UnitQuaternion<f64>; 2]>,
}

/// Sums over the intervals, from which the residual of every unit and axis permutation follows.
#[derive(Default)]
pub(crate) struct Sums {
    pub n: f64,
    pub aa: f64,
    pub gg: f64,
    pub cross: [[f64; 3]; 3],
    /// With the turn that the rates make, and with that of the opposite ones.
    turns: [Turns; 2],
    /// Of the turns by an attitude less those by the rates as read, per second, and of their squares.
    apart: Vector3<f64>,
    apart_squared: f64,
}

/// Sums over the matrices of both turns less the unit matrix, per second and in rad where they are small.
#[derive(Default)]
struct Turns {
    aa_gg: f64,
    cross: SMatrix<f64, 9, 9>,
}

impl Turns {
    fn add(&mut self, both: [&UnitQuaternion<f64>; 2], dt: f64) {
        let less = |turn: &UnitQuaternion<f64>| {
            turn.to_rotation_matrix().into_inner() - Matrix3::identity()
        };
        let [a, g] = both.map(|turn| less(turn) / (SQRT_2 * dt));
        self.aa_gg += a.norm_squared() + g.norm_squared();
        let [a, g] = [a, g].map(|m| SVector::<f64, 9>::from_column_slice(m.as_slice()));
        self.cross += a * g.transpose();
    }

    /// Sum of the squares of what is left with the turns in these axes.
    fn left(&self, axes: Axes) -> f64 {
        let element = |k: usize| {
            let (i, j) = (k % 3, k / 3);
            let (a, b) = (axes.axis[i], axes.axis[j]);
            f64::from(axes.sign[i] * axes.sign[j]) * self.cross[(k, 3 * b + a)]
        };
        self.aa_gg - 2.0 * (0..9).map(element).sum::<f64>()
    }
}

impl Sums {
    /// Root mean square of the change by the first, in its unit per second.
    pub(crate) fn rate(&self) -> f64 {
        (self.aa / self.n).sqrt()
    }

    /// Sum of the products of the rates from the attitude and of the gyro in these axes.
    pub(crate) fn along(&self, axes: Axes) -> f64 {
        let rows = self.cross.iter().zip(axes.axis).zip(axes.sign);
        let products = rows.map(|((row, axis), sign)| row[axis] * f64::from(sign));
        products.sum()
    }

    pub(crate) fn residual(&self, factor: f64, axes: Axes) -> f64 {
        // Rates in mirrored axes make the turn of the opposite rates, in these axes.
        let turns = &self.turns[usize::from(axes.determinant() < 0)];
        let square = match factor == 1.0 && turns.aa_gg > 0.0 {
            true => turns.left(axes),
            false => self.aa - 2.0 * factor * self.along(axes) + factor * factor * self.gg,
        };
        (square.max(0.0) / self.n).sqrt()
    }

    /// Mean of the difference of both as they are read, and the residual without it.
    pub(super) fn offset(&self) -> (f64, f64) {
        let square = (self.apart / self.n).norm_squared();
        let left = self.apart_squared / self.n - square;
        (square.sqrt(), left.max(0.0).sqrt())
    }
}

impl Pairs {
    /// Of the numbers of a quaternion, or up to three others, and of their rates. `None` if the channels of one sensor have different
    /// times, or both overlap in fewer than 8 intervals.
    pub(crate) fn collect(of: &[&Channel], rates: &[&Channel]) -> Option<Self> {
        let (first, rate) = (of.first()?, rates.first()?);
        let same = of.iter().all(|c| c.time_s == first.time_s)
            && rates.iter().all(|c| c.time_s == rate.time_s);
        if !same {
            return None;
        }
        let is_attitude = of.len() == 4;
        let at = |k: usize| padded(of.iter().filter_map(|c| c.values.get(k).copied()));
        let values: Vec<[f64; 4]> = (0..first.values.len()).map(at).collect();
        let of_body = matches!(classify(&rate.name)?.vector(), Some(("omega", _)));
        let mut times_s = first.time_s.to_vec();
        if of_body {
            times_s.extend(rate.time_s.iter());
            times_s.sort_by(f64::total_cmp);
            times_s.dedup();
        }
        let integrals = integrals(rates, &times_s);
        let place = |t: &f64| times_s.partition_point(|own| own < t);
        let stride = stride(&values, is_attitude);
        let step = median_step(&first.time_s)?;
        let ends = values.iter().zip(first.time_s.iter());
        let mut turns = Vec::new();
        for ((from, t0), (to, t1)) in ends.clone().zip(ends.skip(stride)).step_by(stride) {
            let dt = t1 - t0;
            let between = integrals.get(place(t0)..=place(t1)).unwrap_or_default();
            let (Some(Some((run0, a0))), Some(Some((run1, a1)))) =
                (between.first(), between.last())
            else {
                continue;
            };
            if run0 != run1 || dt > 3.0 * step * stride as f64 {
                continue;
            }
            turns.push(Interval {
                dt,
                from: *from,
                to: *to,
                rate: (change(a0, a1) / dt).into(),
                turn: of_body.then(|| [1.0, -1.0].map(|sign| turn(between, sign))),
            });
        }
        (turns.len() >= 8).then_some(Self { turns, is_attitude })
    }

    /// Root mean square of what a direction in other axes of its sensor turns in inertial axes, per second, where the rates are in
    /// other axes, times a factor.
    pub(super) fn turned(&self, axes: Axes, (rates, factor): (Axes, f64)) -> f64 {
        let seen = |[x, y, z, _]: [f64; 4]| axes.turned(&Vector3::new(x, y, z).normalize());
        let square = |i: &Interval| {
            let mean = Vector3::from(i.rate) * factor * i.dt;
            let turn = match i.turn.filter(|_| factor == 1.0) {
                Some([_, opposite]) if rates.determinant() < 0 => -opposite.scaled_axis(),
                Some([turn, _]) => turn.scaled_axis(),
                None => mean,
            };
            let turn = Rotation3::new(rates.turned(&turn));
            ((turn * seen(i.to) - seen(i.from)) / i.dt).norm_squared()
        };
        let sum: f64 = self.turns.iter().map(square).sum();
        (sum / self.turns.len() as f64).sqrt()
    }

    /// The sums in the declared reading.
    pub(crate) fn as_declared(&self) -> Sums {
        self.sums(Order::Xyzw, Sense::BodyToInertial)
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
            ..Sums::default()
        };
        for t in &self.turns {
            let change = match self.is_attitude {
                true => rotation::turn_between(read(t.from), read(t.to)),
                false => padded(t.to.iter().zip(t.from).map(|(b, a)| b - a)),
            };
            let rate = change.map(|c| c / t.dt);
            sums.aa += rate.iter().map(|a| a * a).sum::<f64>();
            sums.gg += t.rate.iter().map(|g| g * g).sum::<f64>();
            for (row, a) in sums.cross.iter_mut().zip(rate) {
                for (c, g) in row.iter_mut().zip(t.rate) {
                    *c += a * g;
                }
            }
            if let Some([turn, opposite]) = t.turn.filter(|_| self.is_attitude) {
                let own = UnitQuaternion::from_scaled_axis(Vector3::from(change));
                sums.turns[0].add([&own, &turn], t.dt);
                sums.turns[1].add([&own, &opposite], t.dt);
                let apart = (own.inverse() * turn).scaled_axis() / t.dt;
                sums.apart += apart;
                sums.apart_squared += apart.norm_squared();
            }
        }
        sums
    }
}

/// Difference of two integrals.
fn change(from: &[f64; 3], to: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(*to) - Vector3::from(*from)
}

/// The turn from the first of these integrals of rates, times a sign, to the last.
fn turn(integrals: &[Option<(usize, [f64; 3])>], sign: f64) -> UnitQuaternion<f64> {
    let known = || integrals.iter().flatten();
    let steps = known().zip(known().skip(1));
    steps.fold(UnitQuaternion::identity(), |all, ((_, a), (_, b))| {
        all * UnitQuaternion::from_scaled_axis(change(a, b) * sign)
    })
}

/// The first numbers, with zeros behind them where they are fewer.
fn padded<const N: usize>(numbers: impl Iterator<Item = f64>) -> [f64; N] {
    let mut all = [0.0; N];
    all.iter_mut().zip(numbers).for_each(|(own, x)| *own = x);
    all
}

/// Samples per compared interval. The turn between samples does not depend on the convention.
fn stride(values: &[[f64; 4]], is_attitude: bool) -> usize {
    let norm = |d: &[f64]| d.iter().map(|c| c * c).sum::<f64>().sqrt();
    let apart = |a: &[f64; 4], b: &[f64; 4]| match is_attitude {
        true => norm(&rotation::turn_between(*a, *b)),
        false => norm(&padded::<4>(b.iter().zip(a).map(|(b, a)| b - a))),
    };
    let whole = match (is_attitude, values.first()) {
        (false, Some(first)) => values.iter().map(|v| apart(first, v)).fold(0.0, f64::max),
        _ => 1.0,
    };
    let steps = values.iter().zip(values.iter().skip(1));
    let mut turns: Vec<f64> = steps.map(|(a, b)| apart(a, b)).collect();
    let Some(turn) = median(&mut turns).filter(|t| *t > 0.0) else {
        return 1;
    };
    let most = (values.len() / 20).max(1);
    ((TURN * whole / turn) as usize).clamp(1, most)
}

/// Integral of rates, linear between samples, to each time, with how many gaps are before it. `None` outside their samples and in gaps.
fn integrals(rates: &[&Channel], times_s: &[f64]) -> Vec<Option<(usize, [f64; 3])>> {
    let read = |c: &&Channel| resample_hermite(&integral(c), c, times_s);
    let all: Vec<Vec<Option<f64>>> = rates.iter().map(read).collect();
    let own = rates.first().map_or(&[][..], |c| &c.time_s);
    let longest = GAP * median_step(own).unwrap_or(0.0);
    let steps = own.windows(2).filter(|w| w[1] - w[0] > longest);
    let gaps: Vec<f64> = steps.map(|w| w[0]).collect();
    let at = |(i, t): (usize, &f64)| {
        let mut here = [0.0; 3];
        for (x, own) in here.iter_mut().zip(&all) {
            *x = own.get(i).copied().flatten()?;
        }
        Some((gaps.partition_point(|gap| gap < t), here))
    };
    times_s.iter().enumerate().map(at).collect()
}
