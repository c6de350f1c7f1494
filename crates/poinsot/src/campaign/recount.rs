//! The sums of a shard again, from its rows.

use super::plan::Plan;
use super::sums::CellSums;
use crate::trials::{Nees, Row, RowNumber};
use poinsot_identify::Status;
use poinsot_telemetry::{RowCells, RowColumn};

/// Whether these are the sums of the rows, to the last bit. Rows state neither bounds nor the chi-square of sensors.
///
/// # Errors
/// They are not, or a column is missing.
pub(super) fn check(plan: &Plan, sums: &CellSums, columns: &[RowColumn]) -> Result<(), String> {
    let again = CellSums::of(plan, &Columns(columns).rows()?);
    let mut methods = sums.methods.iter().zip(again.methods);
    match again.seconds == sums.seconds && methods.all(|(own, again)| own.agree_with(again)) {
        true => Ok(()),
        false => Err("its sums are not those of its rows".to_owned()),
    }
}

/// The columns of a file of rows.
struct Columns<'c>(&'c [RowColumn]);

/// A number in every row.
struct NumberColumns<'c> {
    name: &'c str,
    truth: &'c [Option<f64>],
    estimate: &'c [Option<f64>],
    sigma: &'c [Option<f64>],
}

impl NumberColumns<'_> {
    fn at(&self, row: usize) -> RowNumber {
        RowNumber {
            name: self.name.to_owned(),
            truth: at(self.truth, row).unwrap_or(f64::NAN),
            estimate: at(self.estimate, row),
            sigma: at(self.sigma, row),
            bound: None,
        }
    }
}

impl<'c> Columns<'c> {
    fn rows(&self) -> Result<Vec<Row>, String> {
        let names = self.0.iter().filter_map(|c| c.name.strip_prefix("truth."));
        let number = |name| {
            let of = |kind| self.number(&format!("{kind}.{name}"));
            Ok(NumberColumns {
                name,
                truth: of("truth")?,
                estimate: of("estimate")?,
                sigma: of("sigma")?,
            })
        };
        let numbers = names.map(number).collect::<Result<Vec<_>, String>>()?;
        let RowCells::Count(trials) = self.cells("trial")? else {
            return Err(other("trial"));
        };
        let (status, why) = (self.text("status")?, self.text("why")?);
        let (seconds, iterations) = (self.number("seconds")?, self.number("iterations")?);
        let chi2 = self.number("chi2_per_dof")?;
        let (square, dof) = (self.number("nees")?, self.number("nees_dof")?);
        let nees = |(square, dof): (f64, f64)| Nees {
            square,
            dof: dof as u64,
        };
        let row = |(k, trial): (usize, &u64)| Row {
            trial: *trial,
            status: status.get(k).and_then(|name| Status::named(name)),
            evidence: why
                .get(k)
                .filter(|w| !w.is_empty())
                .cloned()
                .into_iter()
                .collect(),
            numbers: numbers.iter().map(|n| n.at(k)).collect(),
            iterations: at(iterations, k).unwrap_or(0.0) as u64,
            chi2_per_dof: at(chi2, k),
            nees: at(square, k).zip(at(dof, k)).map(nees),
            seconds: at(seconds, k).unwrap_or(0.0),
            ..Row::default()
        };
        Ok(trials.iter().enumerate().map(row).collect())
    }

    fn cells(&self, name: &str) -> Result<&'c RowCells, String> {
        let own = self.0.iter().find(|c| c.name == name);
        Ok(&own.ok_or_else(|| other(name))?.cells)
    }

    fn number(&self, name: &str) -> Result<&'c [Option<f64>], String> {
        match self.cells(name)? {
            RowCells::Number(cells) => Ok(cells),
            _ => Err(other(name)),
        }
    }

    fn text(&self, name: &str) -> Result<&'c [String], String> {
        match self.cells(name)? {
            RowCells::Text(cells) => Ok(cells),
            _ => Err(other(name)),
        }
    }
}

fn other(name: &str) -> String {
    format!("its rows have no such column '{name}'")
}

fn at(cells: &[Option<f64>], row: usize) -> Option<f64> {
    cells.get(row).copied().flatten()
}
