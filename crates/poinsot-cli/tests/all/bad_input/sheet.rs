//! Telemetry as text: a header and cells.

use crate::bad_input::bench::Problem;

pub struct Sheet {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Sheet {
    pub fn parse(text: &str) -> Self {
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut lines = text.lines().map(cells);
        Self {
            header: lines.next().unwrap_or_default(),
            rows: lines.collect(),
        }
    }

    pub fn text(&self) -> String {
        let mut out = self.header.join(",") + "\n";
        for row in &self.rows {
            out.push_str(&(row.join(",") + "\n"));
        }
        out
    }

    /// These columns alone.
    pub fn of(&self, names: &[&str]) -> Self {
        let place = |name: &&str| self.header.iter().position(|h| h == name).unwrap();
        let keep: Vec<usize> = names.iter().map(place).collect();
        let pick = |row: &Vec<String>| keep.iter().map(|&k| row[k].clone()).collect();
        Self {
            header: pick(&self.header),
            rows: self.rows.iter().map(pick).collect(),
        }
    }

    /// The columns of a name, or of a beginning with '*' behind it.
    pub fn columns(&self, name: &str) -> Result<Vec<usize>, Problem> {
        let is = |h: &str| match name.strip_suffix('*') {
            Some(beginning) => h.starts_with(beginning),
            None => h == name,
        };
        let all: Vec<usize> = (0..self.header.len())
            .filter(|&k| is(&self.header[k]))
            .collect();
        if all.is_empty() {
            return Err(format!("no column {name:?}"));
        }
        Ok(all)
    }
}

/// A fixed pseudo-random sequence between -1 and 1.
pub fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// Rows of a sheet, counted from 0: `7`, `10..13`, `250..`, `0..500/50` (each fiftieth), several of these with commas
/// between them, or `random 0.4` (this share of the rows).
pub fn rows(which: &str, count: usize) -> Result<Vec<usize>, Problem> {
    let mut all = Vec::new();
    if let Some(share) = which.strip_prefix("random ") {
        let share: f64 = number(share)?;
        all.extend((0..count).filter(|&k| noise(k) > 1.0 - 2.0 * share));
    } else {
        for part in which.split(',') {
            let (range, step) = part.trim().split_once('/').unwrap_or((part.trim(), "1"));
            let (from, to) = match range.split_once("..") {
                Some((from, "")) => (number(from)?, count),
                Some((from, to)) => (number(from)?, number(to)?),
                None => (number(range)?, number::<usize>(range)? + 1),
            };
            if from >= to || to > count {
                return Err(format!("rows {part:?}: the file has {count} rows"));
            }
            all.extend((from..to).step_by(number(step)?));
        }
    }
    Ok(all)
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, Problem> {
    text.parse()
        .map_err(|_| format!("rows: {text:?} is not a number"))
}

#[test]
fn unit_rows_are_named() {
    assert_eq!(rows("7", 9).unwrap(), [7]);
    assert_eq!(rows("2..4, 6..", 9).unwrap(), [2, 3, 6, 7, 8]);
    assert_eq!(rows("0..9/4", 9).unwrap(), [0, 4, 8]);
    assert!(rows("random 0.4", 100).unwrap().len().abs_diff(40) < 10);
    assert!(rows("9", 9).is_err() && rows("x", 9).is_err());
}
