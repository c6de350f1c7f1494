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
    let again = CellSums::of(plan, &rows(columns)?);
    let mut methods = sums.methods.iter().zip(again.methods);
    match again.seconds == sums.seconds && methods.all(|(own, again)| own.agree_with(again)) {
        true => Ok(()),
        false => Err("its sums are not those of its rows".to_owned()),
    }
}

/// The rows of a file.
fn rows(columns: &[RowColumn]) -> Result<Vec<Row>, String> {
    let number = |name: &str| match cells(columns, name)? {
        RowCells::Number(own) => Ok(move |k: usize| own.get(k).copied().flatten()),
        _ => Err(other(name)),
    };
    let text = |name: &str| match cells(columns, name)? {
        RowCells::Text(own) => Ok(own),
        _ => Err(other(name)),
    };
    let RowCells::Count(trials) = cells(columns, "trial")? else {
        return Err(other("trial"));
    };
    let (status, why) = (text("status")?, text("why")?);
    let (seconds, iterations) = (number("seconds")?, number("iterations")?);
    let chi2 = number("chi2_per_dof")?;
    let (square, dof) = (number("nees")?, number("nees_dof")?);
    let row = |(k, trial): (usize, &u64)| Row {
        trial: *trial,
        status: status.get(k).and_then(|name| Status::named(name)),
        evidence: Vec::from_iter(why.get(k).filter(|w| !w.is_empty()).cloned()),
        iterations: iterations(k).unwrap_or(0.0) as u64,
        chi2_per_dof: chi2(k),
        nees: square(k).zip(dof(k)).map(|(square, dof)| Nees {
            square,
            dof: dof as u64,
        }),
        seconds: seconds(k).unwrap_or(0.0),
        ..Row::default()
    };
    let mut rows: Vec<Row> = trials.iter().enumerate().map(row).collect();
    for name in columns.iter().filter_map(|c| c.name.strip_prefix("truth.")) {
        let of = |kind: &str| number(&format!("{kind}.{name}"));
        let (truth, estimate, sigma) = (of("truth")?, of("estimate")?, of("sigma")?);
        for (k, row) in rows.iter_mut().enumerate() {
            row.numbers.push(RowNumber {
                name: name.to_owned(),
                truth: truth(k).unwrap_or(f64::NAN),
                estimate: estimate(k),
                sigma: sigma(k),
                bound: None,
            });
        }
    }
    Ok(rows)
}

fn cells<'c>(columns: &'c [RowColumn], name: &str) -> Result<&'c RowCells, String> {
    let own = columns.iter().find(|c| c.name == name);
    Ok(&own.ok_or_else(|| other(name))?.cells)
}

fn other(name: &str) -> String {
    format!("its rows have no such column '{name}'")
}
