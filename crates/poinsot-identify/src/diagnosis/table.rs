//! Every whitened row of the fit with the columns of all candidates beside its own.
//!
//! A row is `[start of the segment | fitted unknowns | candidates | residual]`. A record too long to be held keeps the
//! triangle of the candidates that have slopes of their own; the others are not tried there.

use super::candidates::{Candidate, Twin};
use super::projected::Projected;
use crate::fit::Fitted;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::known_numbers::{SILENT, shifts};
use crate::fit::triangle::conditional_estimate;
use crate::likelihood::{Evaluated, KeptRow, Transition};
use crate::problem::parameters::{Parameters, UnknownKind};
use crate::problem::prior::PriorRow;
use crate::problem::segment::{BetweenReadings, InputErrors, Noise, Observations, SensorRecord};
use nalgebra::DMatrix;
use poinsot_dynamics::SensorError;
use poinsot_solve::{BlockQr, Triangle};
use poinsot_spatial::{Matrix3, Vector3};
use rayon::prelude::*;

/// The rows of one segment.
#[derive(Default)]
pub(super) struct SegmentRows<'a> {
    /// Columns of the start.
    pub initial_columns: usize,
    sensors: &'a [SensorRecord],
    /// Of each measurement, and of the priors of the start.
    pub measured: Vec<KeptRow>,
    /// First rows of the triangle of the columns `[start | fitted unknowns | residual]`: those that determine the start.
    pub start_rows: DMatrix<f64>,
    /// How the state at grid times moves with the start.
    pub transitions: Vec<Transition>,
}

impl SegmentRows<'_> {
    /// All rows, three for each measurement.
    pub fn rows(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.measured.iter().flat_map(|m| &m.rows)
    }

    fn rows_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.measured.iter_mut().flat_map(|m| &mut m.rows)
    }

    /// The triangle and the count of the rows before a grid time, of the start and the unknowns that were fitted.
    pub fn beginning(&self, base: usize, end: usize) -> Evaluated {
        let fitted = self.initial_columns + base;
        let mut qr = BlockQr::new(fitted + 1);
        let mut one = Evaluated::default();
        for own in self.measured.iter().filter(|own| own.at < end) {
            qr.push(3, |i, j| match j == fitted {
                true => own.rows[i].last().copied().unwrap_or(0.0),
                false => own.rows[i][j],
            });
            one.rows += own.sensor.map_or(0, |k| self.sensors[k].kind.numbers());
        }
        one.triangle = Some(qr.finish());
        one
    }

    /// Place, residual and column of an unknown, for each measurement of a sensor.
    fn measurements(
        &self,
        sensor: &str,
        unknown: usize,
    ) -> impl Iterator<Item = (usize, Vector3, Vector3)> {
        let index = self.sensors.iter().position(|s| s.name == sensor);
        let measured = self.measured.iter().enumerate();
        let own = measured.filter(move |(_, own)| index.is_some() && own.sensor == index);
        own.map(move |(place, own)| {
            let three = |k: usize| Vector3::from_fn(|i, _| own.rows[i][k]);
            let residual = three(own.rows[0].len() - 1);
            (place, residual, three(self.initial_columns + unknown))
        })
    }

    /// Gives every measurement the columns of a delay from the nearest earlier and later ones of its sensor that share no
    /// error of the wheels with it; `reach` is that of [`reach`].
    ///
    /// A delay moves a prediction by its slope over time. Between noisy samples of a wheel the slope has the noise
    /// that the residual has, and agrees with it without any delay; the slope of other samples does not (an instrumental
    /// variable, Reiersol 1945).
    fn take_slopes_from_others(&mut self, unknowns: &[usize], reach: &[(usize, usize)]) {
        let columns: Vec<usize> = unknowns.iter().map(|k| self.initial_columns + k).collect();
        for sensor in 0..self.sensors.len() {
            let all = self.measured.iter_mut();
            let all: Vec<&mut KeptRow> = all.filter(|m| m.sensor == Some(sensor)).collect();
            let own = |m: &&mut KeptRow| -> Vec<f64> {
                let row = |row: &Vec<f64>| columns.iter().map(|c| row[*c]).collect::<Vec<_>>();
                m.rows.iter().flat_map(row).collect()
            };
            let before: Vec<Vec<f64>> = all.iter().map(own).collect();
            let times: Vec<usize> = all.iter().map(|m| m.at).collect();
            let others = |i: usize| {
                let (first, last) = reach[times[i]];
                let earlier = times.partition_point(|t| *t < first).checked_sub(1);
                let later = times.partition_point(|t| *t <= last);
                [earlier, (later < times.len()).then_some(later)]
            };
            let taken: Vec<Vec<f64>> = (0..all.len())
                .map(|i| {
                    let found: Vec<usize> = others(i).into_iter().flatten().collect();
                    let mean = |k: usize| {
                        let sum: f64 = found.iter().map(|j| before[*j][k]).sum();
                        sum / found.len().max(1) as f64
                    };
                    (0..3 * columns.len()).map(mean).collect()
                })
                .collect();
            for (m, values) in all.into_iter().zip(taken) {
                let values = values.chunks_exact(columns.len().max(1));
                for (row, values) in m.rows.iter_mut().zip(values) {
                    for (c, value) in columns.iter().zip(values) {
                        row[*c] = *value;
                    }
                }
            }
        }
    }
}

/// Correlation of two errors of an input below which they count as two.
const SHARED: f64 = 0.1;

/// Logarithm of how far the correlation of an error falls from the first grid time to each.
fn decay(error: &InputErrors, last: usize) -> Vec<f64> {
    if let InputErrors::Interpolated(places) = error {
        // Two errors that are two readings apart have none in common.
        let further = |p: &BetweenReadings| -SHARED.ln() * 0.5 * (p.reading as f64 + p.share);
        return places.iter().map(further).collect();
    }
    let mut sum = 0.0;
    let further = (0..last).map(|k| {
        sum -= error.memory(k).max(f64::MIN_POSITIVE).ln();
        sum
    });
    std::iter::once(0.0).chain(further).collect()
}

/// First and last grid time at which any wheel's error is that of a sample that a slope at each grid time uses.
///
/// `None` where no wheel is noisy. Joints have rates of their own, whose noise is small beside their motion.
fn reach(noise: &Noise, o: &Observations) -> Option<Vec<(usize, usize)>> {
    let noisy = noise.wheel_speed.iter().enumerate();
    let noisy = noisy.filter(|(_, variance)| **variance > 0.0);
    let error = |k: usize| &o.wheel(k).errors;
    let moves = |e: &&InputErrors| !matches!(e, InputErrors::None | InputErrors::Locked);
    let errors: Vec<&InputErrors> = noisy.map(|(k, _)| error(k)).filter(moves).collect();
    if errors.is_empty() {
        return None;
    }
    let last = o.time_s.len().saturating_sub(1);
    let decays: Vec<Vec<f64>> = errors.iter().map(|e| decay(e, last)).collect();
    let apart = -SHARED.ln();
    let forward = |k: usize| {
        let end = |d: &Vec<f64>| d.partition_point(|x| *x < d[k] + apart).min(last);
        decays.iter().map(end).max().unwrap_or(k)
    };
    let back = |k: usize| {
        let end = |d: &Vec<f64>| d.partition_point(|x| *x <= d[k] - apart).saturating_sub(1);
        decays.iter().map(end).min().unwrap_or(k)
    };
    // Past the samples beside a time, once; past those of its slope, twice.
    let around = |k: usize| (back(back(k)), forward(forward(k)));
    Some((0..=last).map(around).collect())
}

/// The most columns of candidates in one triangle: its update takes about as long as the evaluation that fills its rows.
pub(super) const WIDTH: usize = 128;

/// Some of the candidates: columns `[fitted unknowns | their numbers | residual]` of all rows.
pub(super) struct Group {
    /// Places of its numbers among those of all candidates.
    numbers: Vec<usize>,
    pub stacked: Triangle,
}

/// The experiment at the answer with the columns of all candidates, group by group: memory is linear in their number.
pub(super) struct Table<'a> {
    pub experiment: &'a Experiment<'a>,
    pub fitted: &'a Fitted,
    pub candidates: &'a [Candidate],
    /// How many numbers all candidates have.
    numbers: usize,
    /// One where the rows are held.
    pub groups: Vec<Group>,
    /// Of the first group.
    evaluated: Vec<Evaluated>,
    /// Columns of the fit.
    pub base: usize,
    /// Empty where the record is too long.
    pub segments: Vec<SegmentRows<'a>>,
}

impl<'a> Table<'a> {
    /// In groups of at most so many columns; `None` holds the rows, in one group.
    pub fn new(
        experiment: &'a Experiment<'a>,
        fitted: &'a Fitted,
        candidates: &'a [Candidate],
        most: Option<usize>,
    ) -> Option<Self> {
        let mut table = Self {
            experiment,
            fitted,
            candidates,
            numbers: candidates.iter().map(|c| c.unknowns.len()).sum(),
            groups: Vec::new(),
            evaluated: Vec::new(),
            base: experiment.parameters.len(),
            segments: Vec::new(),
        };
        let own: Vec<Twin> = candidates.iter().flat_map(|c| c.twins.clone()).collect();
        match most {
            None => table.add_rows(&own)?,
            Some(most) => {
                let mut all = groups(candidates, most).into_iter();
                let (first, evaluated) = table.group(&own, all.next()?)?;
                // More segments keep the cores busy.
                let least = match experiment.problem.segments {
                    [_] => 1,
                    _ => usize::MAX,
                };
                let others: Vec<Vec<usize>> = all.collect();
                let others = others.into_par_iter().with_min_len(least);
                let others = others.map(|numbers| Some(table.group(&own, numbers)?.0));
                let all = rayon::iter::once(Some(first)).chain(others);
                table.groups = all.collect::<Option<_>>()?;
                table.evaluated = evaluated;
            }
        }
        Some(table)
    }

    /// A group of rows that are not held, and the segments with its columns.
    fn group(&self, own: &[Twin], numbers: Vec<usize>) -> Option<(Group, Vec<Evaluated>)> {
        let own: Vec<Twin> = numbers.iter().map(|k| own[*k].clone()).collect();
        let (extended, at) = self.extended(&own);
        let mut wide = self.experiment.with_parameters(&extended);
        wide.fitted = Some(self.base);
        let evaluated = wide.evaluate(&at, true)?;
        let stacked = wide.stack(&at, &evaluated, true);
        Some((Group { numbers, stacked }, evaluated))
    }

    /// One group of all candidates, of rows that are held.
    fn add_rows(&mut self, own: &[Twin]) -> Option<()> {
        let experiment = self.experiment;
        let (extended, at) = self.extended(own);
        let mut wide = experiment.with_parameters(&extended);
        wide.keep_rows = true;
        self.hold(wide.evaluate(&at, true)?);
        self.silence(own);
        self.derive();
        let is_late = |k: &usize| extended.unknowns[*k].kind.is_delay();
        let late: Vec<usize> = (self.base..extended.len()).filter(is_late).collect();
        let segments = experiment.problem.segments.iter();
        for (own, segment) in self.segments.iter_mut().zip(segments) {
            if let Some(reach) = reach(experiment.problem.noise, &segment.observations) {
                own.take_slopes_from_others(&late, &reach);
            }
        }
        let (stacked, start_rows) = self.stack(self.priors(), None);
        for (own, rows) in self.segments.iter_mut().zip(start_rows) {
            own.start_rows = rows;
        }
        let numbers = (0..self.numbers).collect();
        self.groups.push(Group { numbers, stacked });
        Some(())
    }

    /// How the mass properties move with each of these numbers of the candidates.
    pub fn shifts(&self, numbers: &[usize]) -> Option<Vec<Vec<f64>>> {
        let mut all = vec![Vec::new(); numbers.len()];
        for group in &self.groups {
            let column = |number: &usize| group.numbers.iter().position(|own| own == number);
            let asked = numbers.iter().map(column).enumerate();
            let asked = asked.filter_map(|(k, column)| Some((k, self.base + column?)));
            let (asked, places): (Vec<usize>, Vec<usize>) = asked.unzip();
            let (_, found) = shifts(self.experiment, self.fitted, &group.stacked, &places)?;
            for (k, shift) in asked.into_iter().zip(found) {
                all[k] = shift;
            }
        }
        Some(all)
    }

    /// Moves the kept rows.
    fn hold(&mut self, evaluated: Vec<Evaluated>) {
        let segments = self.experiment.problem.segments.iter().zip(evaluated);
        for ((segment, one), unknown) in segments.zip(&self.experiment.unknown) {
            self.segments.push(SegmentRows {
                initial_columns: unknown.count(),
                sensors: &segment.observations.sensors,
                measured: one.kept.rows,
                transitions: one.kept.transitions,
                ..SegmentRows::default()
            });
        }
    }

    /// Clears columns that do not show in the predictions: one of round-off explains any residual with a huge number.
    fn silence(&mut self, own: &[Twin]) {
        let mut squares = vec![0.0; own.len()];
        let columns = |one: &SegmentRows| {
            let first = one.initial_columns + self.base;
            first..first + own.len()
        };
        for one in &self.segments {
            for row in one.rows() {
                let values = squares.iter_mut().zip(&row[columns(one)]);
                values.for_each(|(sum, x)| *sum += x * x);
            }
        }
        let lengths = squares.iter().zip(own).enumerate();
        let silent = lengths.filter(|(_, (square, twin))| square.sqrt() * twin.sigma <= SILENT);
        let silent: Vec<usize> = silent.map(|(k, _)| k).collect();
        for one in self.segments.iter_mut().filter(|_| !silent.is_empty()) {
            let first = columns(one).start;
            for row in one.rows_mut() {
                silent.iter().for_each(|k| row[first + k] = 0.0);
            }
        }
    }

    /// Puts the columns that are made of others between the candidates and the residual.
    fn derive(&mut self) {
        for sensor in self.candidates.iter().filter_map(|c| c.ramp) {
            let places = [0, 1, 2].map(|axis| self.place(sensor, SensorError::Bias(axis)));
            let segments = self.experiment.problem.segments;
            for (own, segment) in self.segments.iter_mut().zip(segments) {
                let t = &segment.observations.time_s;
                for measured in &mut own.measured {
                    for row in &mut measured.rows {
                        let residual = row.pop().unwrap_or(0.0);
                        let value =
                            |p: Option<usize>| p.map_or(0.0, |p| row[own.initial_columns + p]);
                        let drift = places.map(value).map(|d| d * (t[measured.at] - t[0]));
                        row.extend(drift);
                        row.push(residual);
                    }
                }
            }
        }
    }

    /// Residuals of a sensor beside the columns of an unknown, fitted or not.
    pub fn residuals_beside(&self, sensor: &str, unknown: usize) -> Vec<(Vector3, Vector3)> {
        let own = self
            .segments
            .iter()
            .flat_map(|s| s.measurements(sensor, unknown));
        own.map(|(_, residual, slope)| (residual, slope)).collect()
    }

    /// Residuals of a sensor after a fit, to first order, with another weight of its rows: a matrix of the column of an unknown.
    ///
    /// Where noise is uneven, the plain fit leaves errors of the large part in the small one, which are not white.
    pub fn refitted(
        &self,
        sensor: &str,
        weight: impl Fn(&Vector3) -> Matrix3,
        unknown: usize,
    ) -> Vec<Vector3> {
        let mut stacked = BlockQr::new(self.base + 1);
        let mut weighted = Vec::new();
        for segment in &self.segments {
            let fitted = segment.initial_columns + self.base;
            let mut all: Vec<Vec<Vec<f64>>> =
                segment.measured.iter().map(|m| m.rows.clone()).collect();
            for (place, _, slope) in segment.measurements(sensor, unknown) {
                let (W, rows) = (weight(&slope), &segment.measured[place].rows);
                let along = |axis: usize| -> Vec<f64> {
                    let value = |j: usize| (0..3).map(|k| W[(axis, k)] * rows[k][j]).sum();
                    (0..rows[0].len()).map(value).collect()
                };
                all[place] = (0..3).map(along).collect();
            }
            let mut qr = BlockQr::new(fitted + 1);
            for rows in &all {
                qr.push(3, |i, j| match j == fitted {
                    true => rows[i].last().copied().unwrap_or(0.0),
                    false => rows[i][j],
                });
            }
            let (r, h) = (qr.finish().r, segment.initial_columns);
            stacked.push(r.nrows().saturating_sub(h), |i, j| r[(h + i, h + j)]);
            weighted.push((segment, all, r));
        }
        let shared = conditional_estimate(&stacked.finish().r, self.base, &[]).mean;
        let mut left = Vec::new();
        for (segment, rows, r) in weighted {
            let mut all = conditional_estimate(&r, segment.initial_columns, &shared).mean;
            all.extend(&shared);
            let of_row = |row: &Vec<f64>| {
                let told: f64 = row.iter().zip(&all).map(|(a, x)| a * x).sum();
                row.last().copied().unwrap_or(0.0) - told
            };
            let own = segment.measurements(sensor, unknown);
            left.extend(own.map(|(place, ..)| Vector3::from_fn(|i, _| of_row(&rows[place][i]))));
        }
        left
    }

    /// Triangle of the shared unknowns and the candidates, and the rows of each segment that determine its start, with these rows of
    /// the fitted unknowns in addition; with a segment given the candidates act in that segment alone.
    fn stack(&self, priors: Vec<PriorRow>, only: Option<usize>) -> (Triangle, Vec<DMatrix<f64>>) {
        let (base, all) = (self.base, self.numbers);
        let mut stacked = BlockQr::new(base + all + 1);
        let mut starts = Vec::with_capacity(self.segments.len());
        for (s, own) in self.segments.iter().enumerate() {
            let mut qr = BlockQr::new(own.initial_columns + base + all + 1);
            let candidate = own.initial_columns + base..own.initial_columns + base + all;
            let is_out = |j: usize| candidate.contains(&j) && only.is_some_and(|only| only != s);
            for of in &own.measured {
                qr.push(3, |i, j| if is_out(j) { 0.0 } else { of.rows[i][j] });
            }
            let r = qr.finish().r;
            let h = own.initial_columns;
            stacked.push(r.nrows().saturating_sub(h), |i, j| r[(h + i, h + j)]);
            let own = |i: usize, j: usize| match (i < r.nrows(), j < h + base) {
                (true, true) => r[(i, j)],
                (true, false) => r[(i, h + base + all)],
                (false, _) => 0.0,
            };
            starts.push(DMatrix::from_fn(h, h + base + 1, own));
        }
        priors
            .iter()
            .for_each(|row| row.add_to(&mut stacked, base, all));
        (stacked.finish(), starts)
    }

    /// What of candidates and residual differs from those of another table, clear of what was fitted there.
    pub fn changes(mut self, from: &Self) -> Projected {
        for (own, from) in self.segments.iter_mut().zip(&from.segments) {
            let first = from.initial_columns + self.base;
            for (own, from) in own.rows_mut().zip(from.rows()) {
                own[..first].copy_from_slice(&from[..first]);
                let changed = own[first..].iter_mut().zip(&from[first..]);
                changed.for_each(|(own, from)| *own -= from);
            }
        }
        let mut priors = from.priors();
        priors.iter_mut().for_each(|row| row.residual = 0.0);
        self.groups[0].stacked = self.stack(priors, None).0;
        self.projected(None)
    }

    /// Candidates clear of the fit; with a segment given those of the first group, and they act in that segment alone.
    pub fn projected(&self, segment: Option<usize>) -> Projected {
        let mut all = Projected::new(self.numbers);
        let parameters = self.experiment.parameters;
        let mut add = |group: &Group, stacked: &Triangle| {
            all.add(parameters, self.fitted, &group.numbers, stacked);
        };
        match segment {
            None => self.groups.iter().for_each(|own| add(own, &own.stacked)),
            Some(only) if self.segments.is_empty() => {
                let first = self.groups.first().into_iter();
                first.for_each(|own| add(own, &self.only_in(only, own.numbers.len())));
            }
            Some(only) => add(&self.groups[0], &self.stack(self.priors(), Some(only)).0),
        }
        all
    }

    /// Triangle of the first group, of so many numbers, that act in one segment alone; without priors.
    fn only_in(&self, only: usize, numbers: usize) -> Triangle {
        let width = self.base + numbers;
        let mut stacked = BlockQr::new(width + 1);
        for (s, one) in self.evaluated.iter().enumerate() {
            if let Some(triangle) = &one.triangle {
                let h = self.experiment.unknown[s].count();
                stacked.push(triangle.r.nrows().saturating_sub(h), |i, j| {
                    match (self.base..width).contains(&j) && s != only {
                        true => 0.0,
                        false => triangle.r[(h + i, h + j)],
                    }
                });
            }
        }
        stacked.finish()
    }

    /// Column of an error of a sensor: an unknown of the fit, or a number of a candidate.
    pub fn place(&self, sensor: usize, error: SensorError) -> Option<usize> {
        let kind = UnknownKind::Sensor { sensor, error };
        let own = self.candidates.iter().flat_map(|c| &c.unknowns);
        let mut all = self.experiment.parameters.unknowns.iter().chain(own);
        all.position(|u| u.kind == kind)
    }

    /// What the fit knows beside the samples.
    fn priors(&self) -> Vec<PriorRow> {
        self.experiment.prior_rows(&self.fitted.at, true)
    }

    /// The unknowns of the fit and these behind them, and the answer with them at their nominal values.
    fn extended(&self, own: &[Twin]) -> (Parameters, Iterate) {
        let mut extended = self.experiment.parameters.clone();
        extended
            .unknowns
            .extend(own.iter().map(|t| t.unknown.clone()));
        let mut x = self.fitted.at.x.clone();
        x.extend(own.iter().map(|t| t.unknown.nominal));
        let initial_states = self.fitted.at.initial_states.clone();
        (extended, Iterate { x, initial_states })
    }
}

/// Places of the numbers of the candidates, in groups of at most so many columns: one in their order, or more, of which the
/// first has all that are scored together.
fn groups(candidates: &[Candidate], most: usize) -> Vec<Vec<usize>> {
    let mut first = 0;
    let own = |c: &Candidate| {
        first += c.unknowns.len();
        (c.is_scored_with_others(), first - c.unknowns.len()..first)
    };
    let mut all: Vec<_> = candidates.iter().map(own).collect();
    if first > most {
        all.sort_by_key(|(together, _)| !together);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new()];
    for (together, own) in all {
        let fits = |last: &Vec<usize>| together || last.len() + own.len() <= most.max(own.len());
        match groups.last_mut() {
            Some(last) if fits(last) => last.extend(own),
            _ => groups.push(own.collect()),
        }
    }
    groups
}

#[cfg(test)]
mod tests;
