//! Checks of quaternions: unit norm, continuous sign.

use crate::error::not_strict;
use poinsot_files::{Faults, Place, as_read, counted, rounded};
use std::path::Path;

/// Norms this close to one are not changed: a few units in the last place.
const EXACT: f64 = 1e-15;
/// Largest norm deviation normalised without a message.
const SILENT: f64 = 1e-6;
/// Largest norm deviation attributed to rounding in the file.
const ROUNDING: f64 = 1e-3;
/// Largest norm deviation accepted.
const LIMIT: f64 = 5e-2;

/// Columns x, y, z, w of one attitude.
pub(crate) type Components = [Vec<f64>; 4];

/// Normalises the rows, turns incomplete and zero rows into gaps (NaN) and makes the sign continuous. Returns the
/// repairs.
///
/// # Errors
/// A row with a norm too far from one; with `strict`, the first row that needs a repair.
pub(crate) fn tidy(
    path: &Path,
    column: &str,
    rows: &[u64],
    q: &mut Components,
    strict: bool,
) -> Result<Vec<String>, Faults> {
    let [x, y, z, w] = q;
    let mut tally = Tally::default();
    let mut last: Option<[f64; 4]> = None;
    let cells = x.iter_mut().zip(y).zip(z).zip(w).zip(rows);
    for ((((x, y), z), w), &row) in cells {
        let here = [*x, *y, *z, *w];
        let missing = here.iter().filter(|c| c.is_nan()).count();
        let norm = here.iter().map(|c| c * c).sum::<f64>().sqrt();
        if missing > 0 || norm == 0.0 {
            tally.zero += u64::from(missing == 0);
            tally.partial += u64::from((1..4).contains(&missing));
            (*x, *y, *z, *w) = (f64::NAN, f64::NAN, f64::NAN, f64::NAN);
            continue;
        }
        let deviation = (norm - 1.0).abs();
        if deviation.is_nan() || deviation > LIMIT {
            let place = Place::cell(path, row, column);
            let (components, norm) = (here.map(as_read).join(", "), rounded(norm, 6));
            let problem = format!("the quaternion ({components}) has norm {norm}, not 1");
            let advice = "correct the row or the order of the columns, or leave such rows out by invalid or where of the attitude in [telemetry]";
            return Err(Faults::one("E0214", place, problem, advice));
        }
        if deviation > tally.worst.0 {
            tally.worst = (deviation, row);
        }
        tally.beyond_rounding += u64::from(deviation > ROUNDING);
        let scale = if deviation > EXACT { 1.0 / norm } else { 1.0 };
        let along = last.map_or(1.0, |l| {
            l.iter().zip(&here).map(|(a, b)| a * b).sum::<f64>()
        });
        let sign = if along < 0.0 { -1.0 } else { 1.0 };
        tally.flips += u64::from(along < 0.0);
        let tidy = here.map(|c| c * scale * sign);
        [*x, *y, *z, *w] = tidy;
        last = Some(tidy);
    }
    let file = Place::cell(path, 0, column);
    let mut repairs = tally.changes();
    if strict && let Some(repair) = repairs.first() {
        return Err(not_strict(file, repair));
    }
    if tally.flips > 0 {
        let changes = counted(tally.flips, "change");
        repairs.push(format!(
            "{changes} of quaternion sign undone (the same attitude)"
        ));
    }
    Ok(repairs
        .into_iter()
        .map(|r| format!("{file}: {r}"))
        .collect())
}

/// What was changed in the rows of one attitude.
#[derive(Default)]
struct Tally {
    zero: u64,
    partial: u64,
    flips: u64,
    /// Largest error of a norm, with its row.
    worst: (f64, u64),
    beyond_rounding: u64,
}

impl Tally {
    /// Changes of the attitude itself, in words.
    fn changes(&self) -> Vec<String> {
        let mut repairs = Vec::new();
        if self.worst.0 > SILENT {
            let (off, row) = (rounded(self.worst.0, 3), self.worst.1);
            repairs.push(format!(
                "quaternions normalised; the norm is off by up to {off} (row {row})"
            ));
        }
        if self.beyond_rounding > 0 {
            repairs.push(format!(
                "warning: {} off unit norm by more than 1e-3, more than rounding explains; check the source",
                counted(self.beyond_rounding, "quaternion")
            ));
        }
        if self.zero > 0 {
            let zero = counted(self.zero, "zero quaternion");
            repairs.push(format!("{zero} treated as missing samples"));
        }
        if self.partial > 0 {
            repairs.push(format!(
                "{} with missing components treated as missing samples",
                counted(self.partial, "quaternion")
            ));
        }
        repairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(rows: &[[f64; 4]]) -> Components {
        [0, 1, 2, 3].map(|k| rows.iter().map(|r| r[k]).collect())
    }

    fn run(rows: &[[f64; 4]]) -> Result<(Components, Vec<String>), Faults> {
        let mut q = columns(rows);
        let lines: Vec<u64> = (2..).take(rows.len()).collect();
        let repairs = tidy(Path::new("a.csv"), "q_x", &lines, &mut q, false)?;
        Ok((q, repairs))
    }

    #[test]
    fn exact_unit_rows_are_left_alone_and_signs_follow() {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let (q, repairs) = run(&[[0.0, 0.0, h, h], [0.0, 0.0, -h, -h], [0.0, 0.0, h, h]]).unwrap();
        assert_eq!(q[2], [h, h, h]);
        assert_eq!(
            repairs,
            ["a.csv column 'q_x': 1 change of quaternion sign undone (the same attitude)"]
        );
    }

    #[test]
    fn unit_zero_and_partial_rows_are_gaps() {
        let (q, repairs) = run(&[
            [0.0, 0.0, 0.0, 1.0],
            [0.0; 4],
            [f64::NAN, 0.0, 0.0, 1.0],
            [f64::NAN; 4],
        ])
        .unwrap();
        assert_eq!(q[3].iter().filter(|c| c.is_nan()).count(), 3);
        assert_eq!(repairs.len(), 2);
    }

    #[test]
    fn unit_norm_thresholds() {
        let (q, repairs) = run(&[[0.0, 0.0, 0.0, 1.0 + 1e-9]]).unwrap();
        assert!(q[3][0] == 1.0 && repairs.is_empty());
        assert_eq!(run(&[[0.0, 0.0, 0.0, 1.0005]]).unwrap().1.len(), 1);
        assert_eq!(run(&[[0.0, 0.0, 0.0, 0.97]]).unwrap().1.len(), 2);
        assert_eq!(
            run(&[[0.0, 0.0, 0.0, 1.1]]).unwrap_err().to_string(),
            "E0214 a.csv:2 column 'q_x': the quaternion (0, 0, 0, 1.1) has norm 1.1, not 1; correct the row or the order of the columns, or leave such rows out by invalid or where of the attitude in [telemetry]"
        );
        assert_eq!(
            run(&[[1e300, -1e300, 5e-324, 0.0]])
                .unwrap_err()
                .to_string(),
            "E0214 a.csv:2 column 'q_x': the quaternion (1e300, -1e300, 5e-324, 0) has norm inf, not 1; correct the row or the order of the columns, or leave such rows out by invalid or where of the attitude in [telemetry]"
        );
        let mut q = columns(&[[0.0, 0.0, 0.0, 1.0005]]);
        let strict = tidy(Path::new("a.csv"), "q_x", &[2], &mut q, true).unwrap_err();
        assert_eq!(strict.code(), "E0218");
    }
}
