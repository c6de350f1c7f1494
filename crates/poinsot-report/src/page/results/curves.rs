//! Curves from the tables next to a result: differences of a validation, commands of a design.

use crate::page::curves::{Differences, over_time};
use crate::page::envelope::Envelope;
use indexmap::IndexMap;
use poinsot_figures::{Axis, Figure, Mark, Plot, Series};
use poinsot_files::InputError;
use poinsot_formats::{AgainstDurationFile, Channel, LARGEST_RESULT, Segment, ValidationFile};
use std::path::Path;

/// Suffixes of command columns with quantity and unit, longest first.
const COMMANDS: [(&str, &str, &str); 7] = [
    ("_rad_s2", "joint acceleration", "rad/s²"),
    ("_m_s2", "joint acceleration", "m/s²"),
    ("_rad_s", "speed", "rad/s"),
    ("_m_s", "joint speed", "m/s"),
    ("_rad", "joint angle", "rad"),
    ("_m", "joint position", "m"),
    ("_N", "thrust", "N"),
];

/// Rows of a table; none if there is no file.
///
/// # Errors
/// It is too large, or cannot be read.
fn rows(path: &Path) -> Result<Vec<csv::StringRecord>, String> {
    let bytes = match poinsot_files::read(path, LARGEST_RESULT) {
        Ok(bytes) => bytes,
        Err(InputError::Missing(_)) => Vec::new(),
        Err(other) => return Err(format!("{}: {other}", path.display())),
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(bytes.as_slice());
    Ok(reader.records().filter_map(Result::ok).collect())
}

fn number(row: &csv::StringRecord, column: usize) -> f64 {
    let text = row.get(column).unwrap_or_default();
    text.parse().unwrap_or(f64::NAN)
}

/// The differences in `histories.csv`, one plot per quantity, with the band of the declared noise if any.
///
/// # Errors
/// As [`rows`].
pub(super) fn differences(path: &Path, validation: &ValidationFile) -> Result<Vec<Figure>, String> {
    let mut channels: IndexMap<String, Channel> = IndexMap::new();
    for row in rows(path)?.iter().skip(1) {
        let text = |column: usize| row.get(column).unwrap_or_default().to_owned();
        if text(6).is_empty() {
            continue;
        }
        let c = channels.entry(text(0)).or_default();
        if !c.components.contains(&text(1)) {
            c.components.push(text(1));
            c.residual.push(Vec::new());
            c.unit = text(2);
        }
        if c.residual.len() == 1 {
            c.time_s.push(number(row, 3));
        }
        if let Some(values) = c.residual.last_mut() {
            values.push(number(row, 6));
        }
    }
    let segment = Segment {
        channels: channels.values().cloned().collect(),
        ..Segment::default()
    };
    let envelope = Envelope::of(&[segment]);
    let figure = |(name, c): (&String, &Channel)| {
        let compared = validation.compared.iter().find(|q| q.quantity == *name);
        let names: Vec<&str> = c.components.iter().map(String::as_str).collect();
        let differences = Differences {
            record: 0,
            title: format!("{name}: model minus the other side"),
            y: Axis::new("difference", &c.unit),
            factor: 1.0,
            declared: compared.and_then(|q| Some(q.rms / q.sigmas.as_ref()?.rms)),
            names: &names,
            time_s: &c.time_s,
            rows: &c.residual,
        };
        Figure::plot(&format!("difference_{name}"), differences.plot(&envelope))
    };
    Ok(channels.iter().map(figure).collect())
}

/// The commands in `commands.csv`, one plot per quantity.
///
/// # Errors
/// As [`rows`].
pub(super) fn commands(path: &Path) -> Result<Vec<Figure>, String> {
    let table = rows(path)?;
    let Some((head, rows)) = table.split_first() else {
        return Ok(Vec::new());
    };
    let time: Vec<f64> = rows.iter().map(|row| number(row, 0)).collect();
    let mut plots: IndexMap<(&str, &str), Plot> = IndexMap::new();
    for (column, name) in head.iter().enumerate().skip(1) {
        let found = COMMANDS
            .iter()
            .find_map(|(end, label, unit)| Some((name.strip_suffix(end)?, *label, *unit)));
        let (mover, label, unit) = found.unwrap_or((name, "command", ""));
        let title = format!("{label} as commanded");
        let new = || Plot {
            height: 210.0,
            ..over_time(0, title, Axis::new(label, unit), Vec::new())
        };
        let plot = plots.entry((label, unit)).or_insert_with(new);
        let y: Vec<f64> = rows.iter().map(|row| number(row, column)).collect();
        let colour = plot.series.len();
        plot.series
            .push(Series::new(mover, Mark::Line, colour, &time, &y));
    }
    let plots = plots.into_iter();
    let figures = plots.map(|((label, _), plot)| Figure::plot(label, plot));
    Ok(figures.collect())
}

/// Sigmas for shorter records, relative to the wanted ones or to those of the whole record; `None` without two points.
pub(super) fn against_duration(found: &AgainstDurationFile) -> Option<Figure> {
    let wanted = found.numbers.iter().any(|n| n.wanted_sigma.is_some());
    let mut series = Vec::new();
    for (k, n) in found.numbers.iter().enumerate() {
        let scale = n.wanted_sigma.or_else(|| n.sigma.last().copied().flatten());
        let points = found.end_s.iter().zip(&n.sigma);
        let points = points.filter_map(|(t, s)| Some((*t, (*s)? / scale?)));
        let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
        if x.len() > 1 {
            series.push(Series::new(&n.name, Mark::Line, k, &x, &y));
        }
    }
    let over = match wanted {
        true => "wanted sigma",
        false => "sigma of the whole record",
    };
    (!series.is_empty()).then(|| {
        let plot = Plot {
            title: format!("sigma over {over}, with the record ended earlier"),
            x: Axis::new("end of the record", "s"),
            y: Axis::new("ratio", ""),
            log: true,
            series,
            levels: vec![(1.0, over.to_owned())],
            height: 210.0,
            ..Plot::default()
        };
        Figure::plot("against_duration", plot)
    })
}
