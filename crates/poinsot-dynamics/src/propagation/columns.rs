//! Columns of one vehicle over a step, several in the lanes of a vector register.
//!
//! Every column has the bits that [`StepRows::carry`] and [`StepRows::carry_pose`] give it alone, but for the signs of zeros.

use super::carry::{Drives, StepRows};
use super::internal::Internal;
use super::rows::{StateRows, add};
use super::{COLUMN, Column, HALF, ModeRows, STATE};
use crate::algebra::Real;
use crate::lanes::{Lanes, MOST, Work, in_lanes};
use fearless_simd::Simd;
use nalgebra::{SVector, Vector6};

/// `b` of columns at the start, in the middle and at the end of a step, one for each of them: of pose, momenta and modes. `None` is
/// zero.
#[derive(Debug, Clone, Copy, Default)]
pub struct ColumnDrives<'a> {
    /// Of the pose.
    pub pose: Option<[&'a [Vector6<f64>]; 3]>,
    /// Of the momenta.
    pub push: Option<[&'a [Vector6<f64>]; 3]>,
    /// Of the modes.
    pub internal: Option<[&'a [Internal]; 3]>,
}

impl StepRows<'_> {
    /// Carries columns over a step of `dt` seconds. The momenta stay where neither [`ColumnDrives::push`] nor [`Self::momentum`] is
    /// there.
    ///
    /// # Panics
    /// A drive has fewer columns than `columns`.
    pub fn carry_columns(&self, columns: &mut [Column], drives: ColumnDrives, dt: f64) {
        in_lanes(Carrying {
            rows: self,
            columns,
            drives,
            dt,
        });
    }
}

struct Carrying<'a> {
    rows: &'a StepRows<'a>,
    columns: &'a mut [Column],
    drives: ColumnDrives<'a>,
    dt: f64,
}

impl Work for Carrying<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (rows, columns, drives, dt) = (self.rows, self.columns, self.drives, self.dt);
        let pushed = drives.push.is_some() || rows.momentum.iter().any(Option::is_some);
        let flexible = rows.modes.iter().any(Option::is_some);
        for first in (0..columns.len()).step_by(Lanes::<S>::COUNT) {
            if flexible {
                let mut x: [Lanes<S>; COLUMN] = gather(simd, columns, first);
                let driven = Drives {
                    pose: driven(simd, drives.pose, first),
                    push: driven(simd, drives.push, first),
                    internal: driven(simd, drives.internal, first),
                };
                rows.carry_flexible(&mut x, &driven, dt);
                scatter(&x, columns, first);
                continue;
            }
            let mut x: [Lanes<S>; STATE] = gather(simd, columns, first);
            let pose = driven(simd, drives.pose, first);
            if pushed {
                rows.carry(&mut x, &pose, &driven(simd, drives.push, first), dt);
            } else {
                let [.., a, b, c, d, e, f] = x;
                let momentum = [a, b, c, d, e, f];
                // The momentum stays: its part of the slope is known beforehand.
                let held = match rest(&momentum) {
                    true => pose,
                    false => rows.held(&momentum, &pose),
                };
                rows.carry_pose(&mut x, &held, dt);
            }
            scatter(&x, columns, first);
        }
    }
}

impl StateRows {
    /// Adds [`Self::times`] of each column, and of its modes, to its place in `sums`.
    pub fn add_times_columns(
        &self,
        modes: Option<&ModeRows>,
        columns: &[Column],
        sums: &mut [Vector6<f64>],
    ) {
        in_lanes(Multiplying {
            rows: self,
            columns,
            sums: &mut *sums,
        });
        for (sum, column) in sums.iter_mut().zip(columns).filter(|_| modes.is_some()) {
            *sum += modes.map_or_else(Vector6::zeros, |m| m.twist_times(column));
        }
    }
}

struct Multiplying<'a> {
    rows: &'a StateRows,
    columns: &'a [Column],
    sums: &'a mut [Vector6<f64>],
}

impl Work for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (rows, columns, sums) = (self.rows, self.columns, self.sums);
        let count = columns.len().min(sums.len());
        for first in (0..count).step_by(Lanes::<S>::COUNT) {
            let [px, py, pz, _, _, _, a, b, c, d, e, f]: [Lanes<S>; STATE] =
                gather(simd, columns, first);
            let momentum = [a, b, c, d, e, f];
            let mut sum = rows.attitude_times(&[px, py, pz]);
            let one = px.all(1.0);
            if !rest(&momentum) {
                add(&mut sum, &rows.momentum_times(&momentum), one);
            }
            let own: [Lanes<S>; HALF] = gather(simd, sums, first);
            add(&mut sum, &own, one);
            scatter(&sum, &mut sums[..count], first);
        }
    }
}

/// Whether columns have no momentum.
#[inline(always)]
fn rest<S: Simd>([a, b, c, d, e, f]: &[Lanes<S>; HALF]) -> bool {
    let sum = a.magnitude() + b.magnitude() + c.magnitude() + d.magnitude();
    let sum = sum + e.magnitude() + f.magnitude();
    sum == sum.all(0.0)
}

/// The first `N` numbers of the columns from `first` on in lanes; beyond the last one, that one again.
#[inline(always)]
fn gather<S: Simd, const N: usize, const M: usize>(
    simd: S,
    columns: &[SVector<f64, M>],
    first: usize,
) -> [Lanes<S>; N] {
    let last = columns.len() - 1;
    let mut out = [Lanes::new(simd, 0.0); N];
    for k in 0..N.div_ceil(4) {
        let at = start_of_four(k, N);
        let mut four = [[0.0; 4]; MOST];
        for (lane, four) in four[..Lanes::<S>::COUNT].iter_mut().enumerate() {
            let column = &columns[last.min(first + lane)].data.0[0];
            four.copy_from_slice(&column[at..at + 4]);
        }
        out[at..at + 4].copy_from_slice(&Lanes::of_four(simd, &four));
    }
    out
}

/// Where a four of `n` numbers begins: the last one overlaps the one before where `n` is not a multiple of four.
#[inline(always)]
fn start_of_four(k: usize, n: usize) -> usize {
    (4 * k).min(n - 4)
}

#[inline(always)]
fn driven<S: Simd, const N: usize>(
    simd: S,
    drive: Option<[&[SVector<f64, N>]; 3]>,
    first: usize,
) -> [[Lanes<S>; N]; 3] {
    let zero = [Lanes::new(simd, 0.0); N];
    let Some([begin, middle, end]) = drive else {
        return [zero; 3];
    };
    [
        gather(simd, begin, first),
        gather(simd, middle, first),
        gather(simd, end, first),
    ]
}

/// Puts the lanes of [`gather`] into the columns from `first` on, as many as there are.
#[inline(always)]
fn scatter<S: Simd, const N: usize, const M: usize>(
    x: &[Lanes<S>; N],
    columns: &mut [SVector<f64, M>],
    first: usize,
) {
    for k in 0..N.div_ceil(4) {
        let at = start_of_four(k, N);
        let four = Lanes::four_of_each([x[at], x[at + 1], x[at + 2], x[at + 3]]);
        for (lane, four) in four[..Lanes::<S>::COUNT].iter().enumerate() {
            if let Some(column) = columns.get_mut(first + lane) {
                column.data.0[0][at..at + 4].copy_from_slice(four);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number that looks random, of both signs.
    fn number(k: usize) -> f64 {
        ((k * 7919 % 1009) as f64 / 504.5 - 1.0) * 1.3
    }

    fn rows(seed: usize, coupled: bool) -> StateRows {
        let inside = |i: usize, j: usize| match j {
            3..6 => 0.0,
            6.. if !coupled => 0.0,
            _ => number(seed + 12 * i + j),
        };
        StateRows::of_matrix(&super::super::Matrix6x12::from_fn(inside))
    }

    fn columns(count: usize, momentum: bool) -> Vec<Column> {
        let inside = |j: usize, k: usize| match k < HALF || (momentum && !j.is_multiple_of(3)) {
            true => number(31 * j + k),
            false => 0.0,
        };
        (0..count)
            .map(|j| Column::from_fn(|k, _| if k < STATE { inside(j, k) } else { 0.0 }))
            .collect()
    }

    /// Whatever the number of columns, of momenta and of forces, each column has the bits that it has alone.
    #[test]
    fn exact_columns_side_by_side_are_those_carried_alone() {
        let pose = [rows(1, true), rows(2, true), rows(3, true)];
        let torque = [rows(4, false), rows(5, true), rows(6, false)];
        let list = |seed: usize| {
            (0..9)
                .map(|j| Vector6::from_fn(|k, _| number(seed + 17 * j + k)))
                .collect()
        };
        let lists: [Vec<Vector6<f64>>; 6] = [0, 10, 20, 30, 40, 50].map(list);
        let [a, b, c, d, e, f] = lists.each_ref().map(Vec::as_slice);
        for count in 1..=9 {
            for (case, momentum) in [(0, false), (1, true), (2, true), (3, true)] {
                let mut step = StepRows {
                    pose: pose.each_ref(),
                    momentum: [None; 3],
                    modes: [None; 3],
                };
                if case == 3 {
                    step.momentum = torque.each_ref().map(Some);
                }
                let push = (case >= 2).then_some([d, e, f]);
                let mut together = columns(count, momentum);
                let mut alone = together.clone();
                let drives = ColumnDrives {
                    pose: Some([a, b, c]),
                    push,
                    internal: None,
                };
                step.carry_columns(&mut together, drives, 0.1);
                for (j, column) in alone.iter_mut().enumerate() {
                    let x = column.data.0[0].first_chunk_mut::<STATE>().unwrap();
                    let own = [a, b, c].map(|of| of[j].data.0[0]);
                    match push {
                        Some(push) => step.carry(x, &own, &push.map(|of| of[j].data.0[0]), 0.1),
                        None => {
                            let [.., p, q, r, s, t, u] = *x;
                            let held = step.held(&[p, q, r, s, t, u], &own);
                            step.carry_pose(x, &held, 0.1);
                        }
                    }
                }
                assert_eq!(together, alone, "{count} columns, case {case}");
                let mut sums = a[..count].to_vec();
                pose[0].add_times_columns(None, &together, &mut sums);
                let one = |(x, own): (&Column, &Vector6<f64>)| pose[0].times(x) + own;
                assert_eq!(sums, together.iter().zip(a).map(one).collect::<Vec<_>>());
            }
        }
    }
}
