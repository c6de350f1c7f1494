//! Changes of telemetry: cells, columns and rows.

use crate::bad_input::bench::{Bench, Problem};
use crate::bad_input::case::Change;
use crate::bad_input::sheet::{Sheet, noise, rows};
use serde::Deserialize;

/// Changes cells of a column. The keys apply from top to bottom; numbers change only cells that hold one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cells {
    #[serde(default = "telemetry")]
    file: String,
    /// A name, or a beginning with '*' behind it.
    column: String,
    /// Absent: every row.
    #[serde(default = "every")]
    rows: String,
    /// Adds the column behind the others, 0.0 in each row.
    #[serde(default)]
    new: bool,
    /// Removes the columns.
    #[serde(default)]
    remove: bool,
    /// The text of each cell.
    value: Option<String>,
    /// Each value stands for this many rows.
    hold: Option<usize>,
    /// Values come this many rows late.
    late: Option<usize>,
    scale: Option<f64>,
    add: Option<f64>,
    /// Adds this much for each second of `time_s`.
    ramp: Option<f64>,
    /// Adds this amplitude of a sine.
    sine: Option<f64>,
    /// Angular frequency of the sine.
    #[serde(default)]
    rate_rad_s: f64,
    /// Angle of the sine at time 0.
    #[serde(default)]
    phase_rad: f64,
    /// Adds this amplitude of noise.
    noise: Option<f64>,
    /// Another sequence of noise.
    #[serde(default)]
    seed: usize,
    /// This part of the noise of a row is in the next one.
    #[serde(default)]
    memory: f64,
    /// Limits the absolute value.
    clamp: Option<f64>,
    /// Rounds to multiples.
    round: Option<f64>,
    /// The counter starts at 0 again from here.
    wrap: Option<f64>,
}

fn telemetry() -> String {
    "t.csv".to_owned()
}

fn every() -> String {
    "0..".to_owned()
}

/// Changes a file of telemetry.
fn edit(
    bench: &Bench,
    file: &str,
    change: impl FnOnce(&mut Sheet) -> Result<(), Problem>,
) -> Result<(), Problem> {
    bench.edit(file, |old| {
        let mut sheet = Sheet::parse(&String::from_utf8(old).map_err(|e| e.to_string())?);
        change(&mut sheet)?;
        Ok(sheet.text().into_bytes())
    })
}

impl Change for Cells {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        edit(bench, &self.file, |sheet| {
            if self.new {
                sheet.header.push(self.column.clone());
                sheet.rows.iter_mut().for_each(|r| r.push("0.0".to_owned()));
            }
            let columns = sheet.columns(&self.column)?;
            let lines = rows(&self.rows, sheet.rows.len())?;
            for &k in columns.iter().rev() {
                if self.remove {
                    let all = std::iter::once(&mut sheet.header).chain(&mut sheet.rows);
                    all.for_each(|r| {
                        r.remove(k);
                    });
                    continue;
                }
                self.column(sheet, k, &lines)?;
            }
            Ok(())
        })
    }
}

impl Cells {
    fn column(&self, sheet: &mut Sheet, k: usize, lines: &[usize]) -> Result<(), Problem> {
        let old: Vec<String> = sheet.rows.iter().map(|r| r[k].clone()).collect();
        let first = lines[0];
        let time = sheet.columns("time_s")?[0];
        let time: Vec<f64> = sheet
            .rows
            .iter()
            .map(|r| r[time].parse().unwrap_or(0.0))
            .collect();
        let mut drift = 0.0;
        for &n in lines {
            let held = self.hold.map_or(n, |h| n - (n - first) % h);
            let source = held.checked_sub(self.late.unwrap_or(0));
            let source = source.ok_or("late: there is no row so early")?;
            let text = self.value.as_ref().unwrap_or(&old[source]);
            drift = self.memory * drift + noise(n + self.seed);
            sheet.rows[n][k] = match text.parse::<f64>() {
                Ok(x) if self.counts() => format!("{:?}", self.number(time[n], x, drift)),
                _ => text.clone(),
            };
        }
        Ok(())
    }

    /// Whether numbers change.
    fn counts(&self) -> bool {
        let sums = [self.scale, self.add, self.ramp, self.sine, self.noise];
        let limits = [self.clamp, self.round, self.wrap];
        sums.iter().chain(&limits).any(Option::is_some)
    }

    fn number(&self, time: f64, x: f64, drift: f64) -> f64 {
        let sine = (self.rate_rad_s * time + self.phase_rad).sin();
        let scaled = x * self.scale.unwrap_or(1.0);
        let x = scaled
            + self.add.unwrap_or(0.0)
            + self.ramp.unwrap_or(0.0) * time
            + self.sine.unwrap_or(0.0) * sine
            + self.noise.unwrap_or(0.0) * drift;
        let x = self.clamp.map_or(x, |c| x.clamp(-c, c));
        let x = self.round.map_or(x, |r| (x / r).round() * r);
        self.wrap.map_or(x, |w| x % w)
    }
}

/// Changes rows: removes some, or changes what stands at one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rows {
    #[serde(default = "telemetry")]
    file: String,
    /// Removes these rows.
    remove: Option<String>,
    /// Exchanges two rows.
    swap: Option<[usize; 2]>,
    /// The row of the keys below.
    at: Option<usize>,
    /// Inserts a line.
    text: Option<String>,
    /// Inserts a copy of this row.
    copy: Option<usize>,
    /// The number of fields; new ones are 1.
    fields: Option<usize>,
}

impl Change for Rows {
    fn apply(&self, bench: &Bench) -> Result<(), Problem> {
        edit(bench, &self.file, |sheet| {
            let lines = sheet.rows.len();
            match self {
                Self {
                    remove: Some(which),
                    at: None,
                    ..
                } => {
                    for k in rows(which, lines)?.into_iter().rev() {
                        sheet.rows.remove(k);
                    }
                }
                Self {
                    swap: Some([a, b]),
                    at: None,
                    ..
                } => sheet.rows.swap(*a, *b),
                Self { at: Some(at), .. } => self.at(sheet, *at)?,
                _ => return Err("rows: give remove, swap or at".to_owned()),
            }
            Ok(())
        })
    }
}

impl Rows {
    fn at(&self, sheet: &mut Sheet, at: usize) -> Result<(), Problem> {
        match (&self.text, self.copy, self.fields) {
            (Some(text), None, None) => sheet.rows.insert(at, vec![text.clone()]),
            (None, Some(row), None) => sheet.rows.insert(at, sheet.rows[row].clone()),
            (None, None, Some(n)) => sheet.rows[at].resize(n, "1".to_owned()),
            _ => return Err("rows at: give one of text, copy, fields".to_owned()),
        }
        Ok(())
    }
}
