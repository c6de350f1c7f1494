//! Faults that begin within a record: a restarted motion, an impulse, a jump of the attitude or of the clock.
//!
//! Columns of a fault that acts from a time on are those of the same fault from the start with zeros before that time.
//! So one pass from the end of a segment back gives the score of every time: products of the columns with themselves,
//! with the residual and with an orthonormal basis of all that was fitted are sums over the samples behind it. An
//! impulse changes the momentum alone, a restart all of the state.

use super::candidates::sensors_read;
use super::projected::SHOWN;
use super::pulse::pulse;
use super::score::{Best, Products, ProjectedRows, Score, explained, momentum_jump, of_record};
use super::suspects::Scored;
use super::table::{SegmentRows, Table};
use super::types::FaultKind;
use crate::fit::experiment::Experiment;
use nalgebra::{DMatrix, DVector};
use poinsot_dynamics::SensorError;
use poinsot_model::SensorKind;
use poinsot_solve::BlockQr;

/// Largest number of times tested in a segment.
const TIMES: usize = 160;
/// Share of a segment at either end without tested times.
const MARGIN: f64 = 0.02;

/// A fault with unknown onset, and its columns.
struct Onset {
    name: &'static str,
    fault: FaultKind,
    /// Indices of its columns among those of all.
    columns: std::ops::Range<usize>,
    /// Whether the momentum alone changes at that time.
    kick: bool,
}

/// A column of an onset: the sum of some of the table.
type Summed = Vec<usize>;

/// The best onset of each fault; pulses only if there is a misfit.
pub(super) fn onsets(table: &Table, misfit: bool) -> Vec<Scored> {
    let experiment = table.experiment;
    let mut list = Vec::new();
    let Some(basis) = Basis::new(table) else {
        return list;
    };
    for (s, rows) in table.segments.iter().enumerate() {
        let record = of_record(&experiment.problem.segments[s].label);
        let t = &experiment.problem.segments[s].observations.time_s;
        let clear = basis.clear(rows, experiment);
        let (columns, kinds) = kinds(table, rows);
        let all = best(&kinds, &columns, (rows, &clear), experiment, s);
        for (onset, best) in kinds.iter().zip(all) {
            let name = |_: &Score, at: &usize| format!("{} at {:.1} s{record}", onset.name, t[*at]);
            list.extend(best.suspect(onset.fault, name));
        }
        if misfit {
            list.extend(pulse(experiment, rows, &clear, s));
        }
    }
    list
}

/// The columns of all faults, and the faults.
fn kinds(table: &Table, rows: &SegmentRows) -> (Vec<Summed>, Vec<Onset>) {
    let problem = table.experiment.problem;
    let initial_columns = rows.initial_columns;
    let of = |sensor: usize, error| {
        let found = table.place(sensor, error);
        found.map(|k| initial_columns + k)
    };
    let read = sensors_read(problem);
    let mut columns: Vec<Summed> = (0..initial_columns).map(|k| vec![k]).collect();
    let mut list = vec![
        Onset {
            name: "the motion restarts",
            fault: FaultKind::JoinedRecord,
            columns: 0..initial_columns,
            kick: false,
        },
        Onset {
            name: "an impulse that is not in the telemetry (a missing or extra firing)",
            fault: FaultKind::Firing,
            columns: 0..initial_columns,
            kick: true,
        },
    ];
    let mut push = |name, fault, own: Vec<Summed>| {
        let first = columns.len();
        columns.extend(own);
        list.push(Onset {
            name,
            fault,
            columns: first..columns.len(),
            kick: false,
        });
    };
    let lags: Summed = read
        .iter()
        .filter_map(|(s, _)| of(*s, SensorError::Lag))
        .collect();
    if !lags.is_empty() {
        push("a jump of the clock", FaultKind::ClockJump, vec![lags]);
    }
    let model = problem.model;
    for (sensor, _) in read
        .iter()
        .filter(|r| model.sensors[r.0].kind == SensorKind::Attitude)
    {
        let axes: Option<Vec<Summed>> = (0..3)
            .map(|k| of(*sensor, SensorError::Bias(k)).map(|p| vec![p]))
            .collect();
        if let Some(axes) = axes {
            let name = "a jump of the measured attitude";
            push(name, FaultKind::AttitudeJump, axes);
        }
    }
    // A start that is known cannot change within the record.
    list.retain(|onset| !onset.columns.is_empty());
    (columns, list)
}

/// Triangle of all that was fitted.
struct Basis {
    /// Nuisances and identified directions of the mass properties over all unknowns.
    directions: DMatrix<f64>,
    shared: DMatrix<f64>,
    rhs: DVector<f64>,
}

impl Basis {
    fn new(table: &Table) -> Option<Self> {
        let parameters = table.experiment.parameters;
        let n = parameters.len();
        let nuisance = |k: &usize| parameters.unknowns[*k].kind.is_nuisance();
        let (front, mass): (Vec<usize>, Vec<usize>) = (0..n).partition(nuisance);
        let spectrum = &table.fitted.spectrum;
        let width = front.len() + spectrum.rank;
        let mut directions = DMatrix::zeros(n, width);
        for (j, k) in front.iter().enumerate() {
            directions[(*k, j)] = 1.0;
        }
        for j in 0..spectrum.rank {
            for (k, at) in mass.iter().enumerate() {
                directions[(*at, front.len() + j)] =
                    spectrum.natural[k] * spectrum.directions[(k, j)];
            }
        }
        // The fitted unknowns are first, and the residual is last.
        let r = &table.groups.first()?.stacked.r;
        let mut qr = BlockQr::new(width + 1);
        qr.push(n.min(r.nrows()), |i, j| match j < width {
            true => (0..n).map(|k| r[(i, k)] * directions[(k, j)]).sum(),
            false => r[(i, r.ncols() - 1)],
        });
        let t = qr.finish().r;
        (t.nrows() >= width).then(|| Self {
            directions,
            shared: DMatrix::from_fn(width, width, |i, j| t[(i, j)]),
            rhs: DVector::from_fn(width, |i, _| t[(i, width)]),
        })
    }

    /// The rows of a segment in the basis. What it gives is linear in a row: once for each column, then sums.
    fn clear(&self, rows: &SegmentRows, experiment: &Experiment) -> ProjectedRows {
        let (h, n) = (rows.initial_columns, experiment.parameters.len());
        let of_columns: Vec<(DVector<f64>, f64)> = (0..h + n)
            .map(|k| {
                let mut row = vec![0.0; h + n];
                row[k] = 1.0;
                self.clear_row(rows, &row)
            })
            .collect();
        let width = of_columns.first().map_or(0, |(basis, _)| basis.len());
        let mut out = ProjectedRows::default();
        for row in rows.rows() {
            let mut basis = DVector::zeros(width);
            let mut residual = row.last().copied().unwrap_or(0.0);
            for (x, (own, explained)) in row.iter().zip(&of_columns).filter(|(x, _)| **x != 0.0) {
                basis.axpy(*x, own, 1.0);
                residual -= x * explained;
            }
            out.basis.push(basis);
            out.residual.push(residual);
        }
        out
    }

    /// A row of the start and the fitted unknowns in the basis, and what the fit explains of its residual.
    fn clear_row(&self, rows: &SegmentRows, row: &[f64]) -> (DVector<f64>, f64) {
        let h = rows.initial_columns;
        let n = row.len() - h;
        let start = &rows.start_rows;
        let own = start.columns(0, h).into_owned();
        let carried = start.columns(h, n) * &self.directions;
        let rhs = start.column(h + n).into_owned();
        let own_columns = solved(&own, &row[..h]);
        let shared = DVector::from_column_slice(&row[h..]);
        let shared = self.directions.tr_mul(&shared) - carried.tr_mul(&own_columns);
        let shared = solved(&self.shared, shared.as_slice());
        let explained = own_columns.dot(&rhs) + shared.dot(&self.rhs);
        let all = own_columns.iter().chain(shared.iter()).copied();
        (DVector::from_iterator(h + shared.len(), all), explained)
    }
}

/// `x` with `x R = row`; zero along unobservable directions.
fn solved(r: &DMatrix<f64>, row: &[f64]) -> DVector<f64> {
    let n = row.len();
    let largest = (0..n).fold(0.0_f64, |a, k| a.max(r[(k, k)].abs()));
    let mut x = DVector::zeros(n);
    for (j, column) in r.as_slice().chunks_exact(n.max(1)).enumerate() {
        let pivot = column[j];
        if pivot.abs() > SHOWN * SHOWN * largest {
            let pairs = x.as_slice().iter().zip(&column[..j]);
            let before: f64 = pairs.map(|(x, r)| x * r).sum();
            x[j] = (row[j] - before) / pivot;
        }
    }
    x
}

/// For each fault the time from which it explains most.
fn best(
    kinds: &[Onset],
    columns: &[Summed],
    (rows, clear): (&SegmentRows, &ProjectedRows),
    experiment: &Experiment,
    segment: usize,
) -> Vec<Best<usize>> {
    let mut found: Vec<Best<usize>> = kinds.iter().map(|_| Best::default()).collect();
    if clear.basis.is_empty() {
        return found;
    }
    let times = rows.transitions.len();
    let stride = times.div_ceil(TIMES).max(1);
    let margin = (MARGIN * times as f64).ceil() as usize;
    let mut sums = Products::new(columns.len(), clear);
    let mut next = rows.measured.len();
    for (place, transition) in rows.transitions.iter().enumerate().rev() {
        let at = transition.at;
        while next > 0 && rows.measured[next - 1].at >= at {
            next -= 1;
            for (i, row) in (3 * next..).zip(&rows.measured[next].rows) {
                let summed = |of: &Summed| -> f64 { of.iter().map(|k| row[*k]).sum() };
                let d = DVector::from_iterator(columns.len(), columns.iter().map(summed));
                sums.add(&d, clear, i);
            }
        }
        if place % stride != 0 || place < margin || place + margin >= times {
            continue;
        }
        let left = sums.left();
        for (onset, found) in kinds.iter().zip(&mut found) {
            let (first, m) = (onset.columns.start, onset.columns.len());
            let part = |all: &DMatrix<f64>| all.view((first, first), (m, m)).into_owned();
            let toward = sums.toward.rows(first, m).into_owned();
            let (left, square) = (part(&left), part(&sums.square));
            let score = if onset.kick {
                let Some(kick) = momentum_jump(&transition.start, experiment, segment) else {
                    continue;
                };
                let of = |m: &DMatrix<f64>| kick.transpose() * m * &kick;
                explained(&of(&left), &of(&square), &kick.tr_mul(&toward))
            } else {
                explained(&left, &square, &toward)
            };
            found.take(score, at);
        }
    }
    found
}
