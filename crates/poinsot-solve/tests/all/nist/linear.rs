//! The 11 linear sets, solved by the factorisation of the linear method.

use crate::nist::data::Data;
use crate::nist::double_double::DoubleDouble;
use crate::nist::refine::{Refined, refine, solve_triangle};
use poinsot_solve::{BlockQr, Triangle};

/// The columns of a set.
#[derive(Clone, Copy)]
pub enum Columns {
    /// `x^first ..= x^last` of one predictor.
    Powers(usize, usize),
    /// A constant, then the predictors.
    Plain,
}

pub const SETS: [(&str, Columns); 11] = [
    ("Norris", Columns::Powers(0, 1)),
    ("Pontius", Columns::Powers(0, 2)),
    ("NoInt1", Columns::Powers(1, 1)),
    ("NoInt2", Columns::Powers(1, 1)),
    ("Filip", Columns::Powers(0, 10)),
    ("Longley", Columns::Plain),
    ("Wampler1", Columns::Powers(0, 5)),
    ("Wampler2", Columns::Powers(0, 5)),
    ("Wampler3", Columns::Powers(0, 5)),
    ("Wampler4", Columns::Powers(0, 5)),
    ("Wampler5", Columns::Powers(0, 5)),
];

/// The rows of a set and their triangle.
pub struct Rows {
    /// Columns, then the response, from NIST's decimals.
    rows: Vec<Vec<DoubleDouble>>,
    triangle: Triangle,
}

impl Rows {
    pub fn new(columns: Columns, data: &Data) -> Self {
        let rows: Vec<Vec<DoubleDouble>> = data.rows.iter().map(|r| row(columns, r)).collect();
        let mut qr = BlockQr::new(rows[0].len());
        qr.push(rows.len(), |i, j| rows[i][j].hi);
        Self {
            rows,
            triangle: qr.finish(),
        }
    }

    /// The answer in double precision.
    pub fn solve(&self) -> Vec<f64> {
        solve_triangle(&self.triangle)
    }

    /// The answer refined with residuals in double-double precision.
    pub fn refine(&self) -> Refined {
        refine(&self.triangle, |i, j| self.rows[i][j])
    }

    /// Standard deviations from the inverse triangle and the residual sum of squares.
    pub fn sigma(&self, rss: f64) -> Vec<f64> {
        let n = self.rows[0].len() - 1;
        let variance = rss / (self.rows.len() - n) as f64;
        // Rows of the inverse are columns of the transposed inverse.
        let r = &self.triangle.r;
        let inverse_row = |i: usize| {
            let mut row = vec![0.0; n];
            row[i] = 1.0 / r[(i, i)];
            for k in i + 1..n {
                let known: f64 = (i..k).map(|j| row[j] * r[(j, k)]).sum();
                row[k] = -known / r[(k, k)];
            }
            row
        };
        let square = |i| inverse_row(i).iter().map(|x| x * x).sum::<f64>();
        (0..n).map(|i| (variance * square(i)).sqrt()).collect()
    }
}

fn row(columns: Columns, words: &[String]) -> Vec<DoubleDouble> {
    let numbers: Vec<DoubleDouble> = words.iter().map(|w| decimal(w)).collect();
    let one = DoubleDouble::from(1.0);
    let power = |k: usize| (0..k).fold(one, |p, _| p * numbers[1]);
    let mut row: Vec<DoubleDouble> = match columns {
        Columns::Powers(first, last) => (first..=last).map(power).collect(),
        Columns::Plain => std::iter::once(one)
            .chain(numbers[1..].iter().copied())
            .collect(),
    };
    row.push(numbers[0]);
    row
}

/// Parses a decimal number to 31 digits.
fn decimal(word: &str) -> DoubleDouble {
    let (mantissa, exponent) = word.split_once(['E', 'e']).unwrap_or((word, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: f64 = format!("{whole}{fraction}").parse().unwrap();
    assert!(
        digits.abs() < 2.0_f64.powi(53),
        "{word} has more digits than a double"
    );
    let exponent: i32 = exponent.parse::<i32>().unwrap() - fraction.len() as i32;
    let ten = DoubleDouble::from(10.0);
    let scale = (0..exponent.unsigned_abs()).fold(DoubleDouble::from(1.0), |p, _| p * ten);
    if exponent < 0 {
        DoubleDouble::from(digits) / scale
    } else {
        DoubleDouble::from(digits) * scale
    }
}
