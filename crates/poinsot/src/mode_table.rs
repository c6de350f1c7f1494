//! Tables of modes, as finite-element programs print them, as `[[mode]]` tables of a model file.

use crate::error::Error;
use poinsot_dynamics::propagation::MOST_MODES;
use poinsot_files::{Place, counted};
use poinsot_model::read_model_text;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// A column: its names without units, blanks and signs, in small letters; its element.
const COLUMNS: [(&[&str], Column); 11] = {
    use Column::*;
    [
        (&["mode", "modeno", "modenumber", "no", "id", "name"], Name),
        (
            &["frequency", "freq", "f", "cycles", "eigenfrequency"],
            Hertz,
        ),
        (&["omega", "radians", "circularfrequency"], RadPerSecond),
        (&["damping", "dampingratio", "zeta", "xi"], Ratio),
        (&["dampingpercent"], Percent),
        (&["t1", "tx", "x", "xcomponent", "translationx"], Element(0)),
        (&["t2", "ty", "y", "ycomponent", "translationy"], Element(1)),
        (&["t3", "tz", "z", "zcomponent", "translationz"], Element(2)),
        (&["r1", "rx", "rotx", "xrotation", "rotationx"], Element(3)),
        (&["r2", "ry", "roty", "yrotation", "rotationy"], Element(4)),
        (&["r3", "rz", "rotz", "zrotation", "rotationz"], Element(5)),
    ]
};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Name,
    Hertz,
    RadPerSecond,
    Ratio,
    Percent,
    /// Participation in translation, then in rotation.
    Element(usize),
}

/// Modes for a model file.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeTable {
    /// `[[mode]]` tables.
    pub text: String,
    /// What was left out, one a line: columns without a meaning, modes beyond the most that a vehicle has.
    pub notes: Vec<String>,
}

/// One row.
struct Row {
    name: String,
    frequency_Hz: f64,
    damping_ratio: Option<f64>,
    participation: [f64; 6],
}

/// The `[[mode]]` tables of a body from a table of comma-separated values with a header: frequency in Hz (or circular, in rad/s),
/// damping ratio, participation factors in translation (kg^1/2) and rotation (kg^1/2 m) of modes that are normalised by mass, body held,
/// about the origin of its frame. Of more modes than a vehicle may have, those with the largest participation in rotation stay.
///
/// # Errors
/// The file cannot be read, has no frequencies or no participation, or a value is not a number.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let file = folder.path().join("modes.csv");
/// std::fs::write(&file, "MODE NO.,FREQUENCY (HZ),T1,T2,T3,R1,R2,R3\n7,0.42,0,0,1.2,0.9,0,0\n")?;
/// let modes = poinsot::import_modes(&file, "bus")?;
/// assert!(modes.text.contains("frequency_Hz = 0.42\n") && modes.text.contains("rotation_kg05_m = [0.9, 0.0, 0.0]\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn import_modes(path: &Path, body: &str) -> Result<ModeTable, Error> {
    let text = read_model_text(path)?;
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.trim(csv::Trim::All).from_reader(text.as_bytes());
    let broken = |error: &csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        let advice = "give one row for each mode, with as many values as the header";
        Error::one("E0204", Place::row(path, line), error.to_string(), advice)
    };
    let header = reader.headers().map_err(|e| broken(&e))?.clone();
    let columns: Vec<Option<Column>> = header.iter().map(meaning).collect();
    let unknown = header.iter().zip(&columns).filter(|(_, of)| of.is_none());
    let unknown: Vec<&str> = unknown.map(|(name, _)| name).collect();
    let mut notes = Vec::new();
    if !unknown.is_empty() {
        let unknown = unknown.join(", ");
        notes.push(format!("columns without a meaning here: {unknown}"));
    }
    let has = |wanted: fn(&Column) -> bool| columns.iter().flatten().any(wanted);
    let missing = [
        (
            has(|c| matches!(c, Column::Hertz | Column::RadPerSecond)),
            "a column of frequencies",
            "name it frequency_Hz, or omega_rad_s",
        ),
        (
            has(|c| matches!(c, Column::Element(_))),
            "participation factors",
            "name the columns T1, T2, T3 (kg^1/2) and R1, R2, R3 (kg^1/2 m)",
        ),
    ];
    if let Some((_, what, advice)) = missing.into_iter().find(|m| !m.0) {
        let names = header.iter().collect::<Vec<_>>().join(", ");
        let problem = format!("{what} is missing among {names}");
        return Err(Error::one("E0106", Place::row(path, 1), problem, advice));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| broken(&e))?;
        let line = record.position().map_or(0, csv::Position::line);
        rows.push(row((path, line), (&header, &columns), &record, rows.len())?);
    }
    let turns = |row: &Row| row.participation[3..].iter().map(|r| r * r).sum::<f64>();
    let mut ranked: Vec<usize> = (0..rows.len()).collect();
    ranked.sort_by(|a, b| turns(&rows[*b]).total_cmp(&turns(&rows[*a])));
    let left = ranked.split_off(rows.len().min(MOST_MODES));
    if !left.is_empty() {
        notes.push(format!(
            "{} with smaller participation in rotation: a vehicle has at most {MOST_MODES}; they move with the body",
            counted(left.len(), "mode")
        ));
    }
    let kept = rows.iter().enumerate().filter(|(k, _)| ranked.contains(k));
    let text = kept.map(|(_, row)| table(row, body)).collect();
    Ok(ModeTable { text, notes })
}

/// What a name of a column says; `None` where it says nothing.
fn meaning(name: &str) -> Option<Column> {
    let small = name.to_lowercase();
    let bare = small.split(['(', '[']).next().unwrap_or_default();
    let plain: String = bare.chars().filter(char::is_ascii_alphanumeric).collect();
    let ends = ["hz", "kg05m", "kg05", "rads"];
    let mut without = ends.iter().filter_map(|end| plain.strip_suffix(end));
    let of = |word: &str| COLUMNS.iter().find(|(names, _)| names.contains(&word));
    let (_, found) = of(&plain).or_else(|| of(without.next()?))?;
    Some(match *found {
        Column::Ratio if small.contains('%') => Column::Percent,
        Column::Hertz if small.contains("rad/s") || plain.ends_with("rads") => Column::RadPerSecond,
        other => other,
    })
}

fn row(
    (path, line): (&Path, u64),
    (header, columns): (&csv::StringRecord, &[Option<Column>]),
    record: &csv::StringRecord,
    k: usize,
) -> Result<Row, Error> {
    let mut row = Row {
        name: format!("mode{}", k + 1),
        frequency_Hz: f64::NAN,
        damping_ratio: None,
        participation: [0.0; 6],
    };
    for ((name, column), cell) in header.iter().zip(columns).zip(record) {
        let Some(column) = column else { continue };
        if *column == Column::Name {
            let is_number = cell.chars().all(|c| c.is_ascii_digit());
            row.name = if is_number {
                format!("mode{cell}")
            } else {
                cell.to_owned()
            };
            continue;
        }
        let number = cell.parse().ok().filter(|x: &f64| x.is_finite());
        let Some(number) = number else {
            let problem = format!("\"{cell}\" is not a number");
            let advice = "give a number in SI with a decimal point";
            let place = Place::cell(path, line, name);
            return Err(Error::one("E0107", place, problem, advice));
        };
        match column {
            Column::Hertz => row.frequency_Hz = number,
            Column::RadPerSecond => row.frequency_Hz = number / TAU,
            Column::Ratio => row.damping_ratio = Some(number),
            Column::Percent => row.damping_ratio = Some(number / 100.0),
            Column::Element(at) => row.participation[*at] = number,
            Column::Name => {}
        }
    }
    Ok(row)
}

fn table(row: &Row, body: &str) -> String {
    let [tx, ty, tz, rx, ry, rz] = row.participation;
    let mut out = format!(
        "[[mode]]\nname = {:?}\nbody = {body:?}\nfrequency_Hz = {:?}\n",
        row.name, row.frequency_Hz
    );
    if let Some(ratio) = row.damping_ratio {
        let _ = writeln!(out, "damping_ratio = {ratio:?}");
    }
    let _ = writeln!(
        out,
        "translation_kg05 = [{tx:?}, {ty:?}, {tz:?}]\nrotation_kg05_m = [{rx:?}, {ry:?}, {rz:?}]\n"
    );
    out
}
