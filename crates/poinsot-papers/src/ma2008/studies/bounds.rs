//! Sec. IV: how often (35) holds over many trials, and how conservative it is. It uses the error matrices of each
//! trial, and the limits of the command.

use super::experiment::{Experiment, Run, Sigma, readings, unsymmetric};
use crate::ma2008::bounds::{Limits, angular_error, bound, linear_error, sizes};
use crate::ma2008::{Given, Reading, TwoStep, angular_rows, differences};
use crate::study::statistics::{median, quantile, rms};
use crate::study::{Context, Digits, Findings, StudyError, Table};
use nalgebra::SMatrix;
use poinsot_spatial::{Matrix3, Vector3};
use rayon::prelude::*;

const TRIALS: u64 = 10_000;

/// Errors and bounds of one trial.
struct Trial {
    /// Error of each step.
    error: [f64; 2],
    /// (35) with the error matrices of the trial.
    bound: [f64; 2],
    /// The same for step 2, including the error of step 1.
    inherited: f64,
    /// (35) as printed by the command: the trial's data, limits of the declared noise.
    stated: [f64; 2],
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut held = Table::new(
        "held",
        "Trials of 10,000 in which (35) holds, %: with the error matrices of the trial, step 2 also with the error of step 1; with the limits that the command states",
        "example, noise, option | step 1 :.2 | step 2 :.2 | with step 1 :.2 | stated, step 1 :.2 | stated, step 2 :.2",
    );
    let mut loose = Table::new(
        "loose",
        "Bound over error: median and band; median of the stated bound",
        "example, noise, option | step 1 | 5 to 95 % | stated | step 2 | 5 to 95 % | stated",
    );
    let mut efficient = Table::new(
        "cramer_rao",
        "Rms bound (35) over the Cramer-Rao bound",
        "example, noise, option | step 1 | step 2",
    );
    // The examples of Sec. III.D.
    for (n, spin) in [(1, [0.0, 0.0, 1.0]), (2, [0.0, 1.0, 5.0])] {
        let run = Experiment::of(context, n, spin)?;
        let run = run.with_base(unsymmetric()).run()?;
        for (share, known) in [0.001, 0.01, 0.03]
            .map(|s| [(s, true), (s, false)])
            .concat()
        {
            let sigma = run.sigma(share);
            let found = trials(&run, sigma, known)?;
            let title = format!("{n}, {} %, {}", 100.0 * share, if known { 1 } else { 2 });
            held.row(&title, shares(&found));
            looseness(&mut loose, &title, &found);
            let best = run.bound(sigma, known);
            let x = run.solved(&run.raws, known).linear.x[0];
            // Errors of the vectors x and y that (35) bounds.
            let tensor = best[2] * run.truth().I_BBcm_B.norm();
            let best = [(x * best[0]).hypot(best[1]), tensor];
            let over = |k: usize| rms(found.iter().map(|t| t.bound[k])) / best[k];
            efficient.row(&title, [over(0), over(1)]);
        }
    }
    let range = |table: &Table, columns: &[usize]| {
        let rows = 0..table.rows.len();
        let all = rows.flat_map(|r| columns.iter().map(move |c| table.at(r, *c)));
        all.fold([f64::INFINITY, 0.0], |[low, high], x: f64| {
            [low.min(x), high.max(x)]
        })
    };
    let least = range(&held, &[1, 2, 3, 4, 5])[0];
    let two = |columns| range(&loose, columns).map(|x| Digits::Figures(2).text(x));
    let ([low, high], [from, to]) = (two(&[1, 4]), two(&[3, 6]));
    let text = format!(
        "in {least:.2} % of trials; {low} to {high} times the error, stated {from} to {to} times"
    );
    let mut findings = Findings::of([held, loose, efficient]);
    findings.state("(29)-(37) first-order bounds", text);
    Ok(findings)
}

fn shares(found: &[Trial]) -> [f64; 5] {
    let part = |holds: fn(&Trial) -> bool| {
        let count = found.iter().filter(|t| holds(t)).count();
        100.0 * count as f64 / found.len() as f64
    };
    [
        part(|t| t.error[0] <= t.bound[0]),
        part(|t| t.error[1] <= t.bound[1]),
        part(|t| t.error[1] <= t.inherited),
        part(|t| t.error[0] <= t.stated[0]),
        part(|t| t.error[1] <= t.stated[1]),
    ]
}

fn looseness(table: &mut Table, title: &str, found: &[Trial]) {
    table.row(title, []);
    for k in [0, 1] {
        let ratio = || found.iter().map(|t| t.bound[k] / t.error[k]);
        table.with(median(ratio()), Digits::Figures(2));
        table.pair([0.05, 0.95].map(|q| quantile(ratio(), q)), "to");
        let stated = found.iter().map(|t| t.stated[k] / t.error[k]);
        table.with(median(stated), Digits::Figures(2));
    }
}

fn trials(run: &Run, sigma: Sigma, known: bool) -> Result<Vec<Trial>, StudyError> {
    let exact = run.readings();
    let truth = run.solved(&run.raws, known);
    let given = Given::from(known.then_some(run.known));
    let errors = |s: &Reading, _| {
        let velocity = s.R_NB.transpose() * Matrix3::from_diagonal(&sigma.v);
        [velocity, Matrix3::from_diagonal(&sigma.w)]
    };
    let limits = Limits::of(std::slice::from_ref(&exact), given, &truth, errors);
    let one = |seed| {
        let raws = run.noisy(sigma, seed);
        let noisy = readings(&run.model, &raws);
        let found = run.solved(&raws, known);
        trial(&exact, &noisy, [&truth, &found], (limits, known))
    };
    Ok((0..TRIALS).into_par_iter().filter_map(one).collect())
}

fn trial(
    exact: &[Reading],
    noisy: &[Reading],
    [truth, found]: [&TwoStep; 2],
    (limits, known): (Limits, bool),
) -> Option<Trial> {
    let (step2, found2) = (truth.angular.as_ref()?, found.angular.as_ref()?);
    let (m, c) = (truth.mass(), truth.rho_S());
    // (39), (41), (43), (45) of this trial, with the differences of the option.
    let pairs = || {
        let both = exact.iter().zip(noisy);
        both.map(|(a, b)| (a, b.v_NBo_B - a.v_NBo_B, b.w_NB_B - a.w_NB_B))
    };
    let d1 = pairs().map(|(s, dv, dw)| linear_error(s, &dv, &dw));
    let d2 = pairs().map(|(s, _, dw)| angular_error(s, m, &c, &dw));
    let (a1, b1) = sizes::<4, 5>(&less_first(d1.collect(), known));
    let (a2, b2) = sizes::<6, 7>(&less_first(d2.collect(), known));
    // Beyond the paper: the right-hand side of step 2 depends on the solution of step 1.
    let exact = [exact.to_vec()];
    let shifted = |m, c: Vector3| differences(&exact, |s| angular_rows(s, m, &c), None);
    let moved = shifted(found.mass(), found.rho_S());
    let changes = moved.iter().zip(shifted(m, c)).map(|(a, b)| a - b);
    let squares = changes.map(|d| d.column(6).norm_squared());
    let inherited = squares.sum::<f64>().sqrt();
    let stated = limits.bounds(found);
    Some(Trial {
        error: [
            (found.linear.x - truth.linear.x).norm(),
            (found2.x - step2.x).norm(),
        ],
        bound: [
            bound(&truth.linear, a1, b1).absolute,
            bound(step2, a2, b2).absolute,
        ],
        inherited: bound(step2, a2, b2 + inherited).absolute,
        stated: [stated[0].absolute, stated.get(1)?.absolute],
    })
}

fn less_first<const W: usize>(
    mut rows: Vec<SMatrix<f64, 3, W>>,
    known: bool,
) -> Vec<SMatrix<f64, 3, W>> {
    if known || rows.is_empty() {
        return rows;
    }
    let first = rows.remove(0);
    rows.iter().map(|r| r - first).collect()
}
