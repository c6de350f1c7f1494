//! Calibration of answers if stored momentum makes the bus nutate between its samples.
//!
//! `POINSOT_SEEDS=200 cargo nextest run --release -p poinsot stored_momentum::` runs the full table
//! (docs/validation/stored_momentum.md); `POINSOT_STORED=9,18@2` selects settings by momentum, and by rate.

use crate::nutation;
use crate::shared::rows;

use nutation::{Cell, study, table};
use poinsot::trials::Row;
use poinsot_identify::Status;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Default number of seeds per setting.
const SEEDS: u64 = 4;
/// Probability that a correct estimator fails anywhere in the table.
const FALSE_ALARM: f64 = 1.0e-3;
/// Numbers of an answer: the inertia of the bus.
const NUMBERS: usize = 6;

/// Probability per test: six means, NEES and coverage in every setting, two-sided.
fn tail() -> f64 {
    FALSE_ALARM / (2 * (NUMBERS + 2) * table().len()) as f64
}

/// Statistics over the seeds of one setting.
struct Shown {
    cell: Cell,
    seeds: usize,
    not_converged: usize,
    mean_z: Vec<f64>,
    nees: f64,
    /// Fraction of 95 % intervals that hold the truth, with its standard error between seeds: the six numbers of one
    /// seed are correlated.
    coverage: (f64, f64),
}

impl Shown {
    fn of(cell: Cell, seeds: u64) -> Self {
        let outcomes = rows(&study(cell), 0..seeds);
        if let Some(why) = outcomes.iter().find_map(|row| row.answer().err()) {
            println!("{cell:?}: {why}");
        }
        let answers: Vec<&Row> = outcomes.iter().filter(|r| r.status.is_some()).collect();
        let converged = Some(Status::Converged);
        if let Some(other) = answers.iter().find(|a| a.status != converged) {
            println!("{cell:?}: {:?}", other.status);
        }
        let zs = |a: &Row| a.determined().filter_map(|n| n.z()).collect::<Vec<f64>>();
        let right = |a: &&&Row| a.status == converged && zs(a).len() == NUMBERS;
        let good: Vec<&Row> = answers.iter().filter(right).copied().collect();
        let n = good.len().max(1) as f64;
        let z = |a: &Row, k: usize| zs(a)[k];
        let held = |a: &&Row| {
            let inside = (0..NUMBERS).filter(|k| z(a, *k).abs() < 1.959_964);
            inside.count() as f64 / NUMBERS as f64
        };
        let share = good.iter().map(held).sum::<f64>() / n;
        let scatter = good.iter().map(|a| (held(a) - share).powi(2)).sum::<f64>();
        Self {
            cell,
            seeds: outcomes.len(),
            not_converged: outcomes.len() - good.len(),
            mean_z: (0..NUMBERS)
                .map(|k| good.iter().map(|a| z(a, k)).sum::<f64>() / n)
                .collect(),
            nees: good
                .iter()
                .filter_map(|a| Some(a.nees?.square))
                .sum::<f64>()
                / n,
            coverage: (share, (scatter / (n - 1.0).max(1.0) / n).sqrt()),
        }
    }

    fn faults(&self) -> Vec<String> {
        let n = self.seeds as f64;
        let normal = Normal::standard().inverse_cdf(1.0 - tail());
        let squares = ChiSquared::new(n * NUMBERS as f64).unwrap();
        let mut list = Vec::new();
        if self.not_converged > 0 {
            list.push(format!("{} did not converge", self.not_converged));
        }
        let worst = self.mean_z.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
        if worst > normal / n.sqrt() {
            list.push(format!("mean z {:.3?}", self.mean_z));
        }
        let band = [tail(), 1.0 - tail()].map(|p| squares.inverse_cdf(p) / n);
        if !(band[0]..=band[1]).contains(&self.nees) {
            list.push(format!("NEES {:.2}, asked {band:.2?}", self.nees));
        }
        // With few seeds the standard error is too uncertain for a test.
        let (share, sigma) = self.coverage;
        if self.seeds >= 100 && (share - 0.95).abs() > normal * sigma {
            list.push(format!("coverage {share:.4} +- {sigma:.4}"));
        }
        list
    }
}

#[test]
fn stat_answers_are_right_whatever_momentum_the_wheels_store() {
    let seeds = std::env::var("POINSOT_SEEDS").ok();
    let seeds = seeds.and_then(|s| s.parse().ok()).unwrap_or(SEEDS);
    println!("| h, N m s | rate, Hz | not converged | largest mean z | NEES (6) | coverage |");
    println!("|---:|---:|---:|---:|---:|---:|");
    let mut faults = Vec::new();
    let stored = std::env::var("POINSOT_STORED").ok();
    let wanted = |cell: &Cell| {
        let list = stored.as_deref().map(|list| list.split(','));
        let own = [
            cell.stored_N_m_s.to_string(),
            format!("{}@{}", cell.stored_N_m_s, cell.rate_hz),
        ];
        list.is_none_or(|mut all| all.any(|one| own.iter().any(|name| name == one)))
    };
    for cell in table().into_iter().filter(wanted) {
        let shown = Shown::of(cell, seeds);
        let worst = shown.mean_z.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
        println!(
            "| {} | {} | {} of {} | {worst:.2} | {:.2} | {:.1} % |",
            cell.stored_N_m_s,
            cell.rate_hz,
            shown.not_converged,
            shown.seeds,
            shown.nees,
            100.0 * shown.coverage.0
        );
        let of_cell = shown.faults();
        faults.extend(of_cell.iter().map(|f| format!("{:?}: {f}", shown.cell)));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
