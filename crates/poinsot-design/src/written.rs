//! The files of a design: a case that flies the manoeuvre, its model, and tables of commands.

use crate::result::Designed;
use crate::shape::{Command, Space, Target};
use poinsot::case::{Case, parse_case};
use poinsot::simulate::SimulateError;
use poinsot::{Error, write_files};
use poinsot_files::read_text;
use poinsot_model::{JointKind, Model};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Largest model file that is copied.
const LARGEST_MODEL: u64 = 16 << 20;

/// The case with the designed motions in place of its own; `model.toml` lies beside it.
pub(crate) fn manoeuvre_text(case: &Case, space: &Space, commands: &[(String, Command)]) -> String {
    // It was parsed before.
    let mut table: Table = case.text().parse().unwrap_or_default();
    table.remove("design");
    table.remove("limits");
    table.insert("model".into(), "model.toml".into());
    table.insert("duration_s".into(), space.duration.into());
    absolute_files(&mut table, case.path());
    for ((name, command), mover) in commands.iter().zip(&space.movers) {
        let (list, key) = match mover.target {
            Target::Joint(_) => ("joint_motion", "joint"),
            Target::Wheel(_) => ("wheel_motion", "wheel"),
        };
        let all = table
            .entry(list)
            .or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(all) = all {
            all.retain(|one| one.get(key).and_then(Value::as_str) != Some(name));
            all.push(Value::Table(motion(key, name, command, mover.slides)));
        }
    }
    let text = toml::to_string(&table).unwrap_or_default();
    let (program, from) = (env!("CARGO_PKG_VERSION"), case.path().display());
    format!("# Designed by poinsot {program} for {from}.\n{text}")
}

/// Files that the case names are found from anywhere.
fn absolute_files(table: &mut Table, case: &Path) {
    let folder = case.parent().unwrap_or(Path::new(""));
    for list in ["joint_torque", "wheel_motion"] {
        let all = table.get_mut(list).and_then(Value::as_array_mut);
        for one in all.into_iter().flatten() {
            if let Some(Value::String(file)) = one.get_mut("file")
                && let Ok(path) = folder.join(&*file).canonicalize()
            {
                *file = path.display().to_string();
            }
        }
    }
}

/// One motion in the form of the case file.
fn motion(key: &str, name: &str, command: &Command, slides: bool) -> Table {
    let list = |x: &[f64]| Value::Array(x.iter().map(|x| Value::Float(*x)).collect());
    let unit = if slides { "m" } else { "rad" };
    let mut table = Table::new();
    table.insert(key.into(), name.into());
    let word = match command {
        Command::Fourier(_) => "fourier",
        Command::Spline(..) => "cubic_clamped",
        Command::Slews(..) => "quintic_rest",
    };
    table.insert("interpolation".into(), word.into());
    match command {
        Command::Fourier(f) => {
            table.insert("base_frequency_hz".into(), f.base_frequency_hz.into());
            table.insert(format!("offset_{unit}"), f.offset.into());
            table.insert(format!("sine_{unit}"), list(&f.sine));
            table.insert(format!("cosine_{unit}"), list(&f.cosine));
        }
        Command::Spline(time, values) | Command::Slews(time, values) => {
            table.insert("time_s".into(), list(time));
            let name = match key {
                "wheel" => "speed_rad_s".to_owned(),
                _ => format!("position_{unit}"),
            };
            table.insert(name, list(values));
        }
    }
    table
}

/// Commands of every joint and wheel at the rate of the case, with standard names.
fn commands_csv(designed: &Designed, times: &[f64]) -> String {
    let mut header = vec!["time_s".to_owned()];
    for (name, _) in &designed.commands {
        match unit_of(&designed.model, name) {
            None => header.push(format!("{name}_rad_s")),
            Some(unit) => header.extend(["", "_s", "_s2"].map(|end| format!("{name}_{unit}{end}"))),
        }
    }
    let mut text = header.join(",") + "\n";
    for &t in times {
        let _ = write!(text, "{t}");
        for (name, command) in &designed.commands {
            let jet = command.joint().map(|m| m.at(t, t)).unwrap_or_default();
            let _ = match unit_of(&designed.model, name) {
                None => write!(text, ",{}", jet.value),
                Some(_) => write!(text, ",{},{},{}", jet.value, jet.rate, jet.acceleration),
            };
        }
        text.push('\n');
    }
    text
}

/// Unit of a joint's position; `None` for a wheel.
fn unit_of(model: &Model, name: &str) -> Option<&'static str> {
    let joint = model.joint(name).and_then(|k| model.joints.get(k))?;
    Some(match joint.kind {
        JointKind::Prismatic => "m",
        _ => "rad",
    })
}

/// The manoeuvre as a case, as it will lie in a folder.
///
/// # Errors
/// The case is refused, which is a fault of this program.
pub fn manoeuvre_case(designed: &Designed, folder: &Path) -> Result<Case, Error> {
    let path = folder.join("case.toml");
    Ok(parse_case(&path, designed.manoeuvre.clone()).map_err(SimulateError::from)?)
}

/// Writes `case.toml`, `model.toml`, `commands.csv` and `design.json` into a folder, all or none. Gives their paths.
///
/// # Errors
/// The model cannot be read any more, or the disk refuses; earlier files stay then.
pub fn write_design(
    folder: &Path,
    designed: &Designed,
    model: &Path,
) -> Result<Vec<PathBuf>, Error> {
    let text = read_text(model, LARGEST_MODEL).map_err(|e| Error::Report {
        path: model.to_owned(),
        why: format!("{e}; {}", e.remedy()),
    })?;
    let case = manoeuvre_case(designed, folder)?;
    let mut json = serde_json::to_string_pretty(&crate::design_file(designed)).unwrap_or_default();
    json.push('\n');
    let files: [(PathBuf, Vec<u8>); 4] = [
        ("model.toml".into(), text.into_bytes()),
        (
            "commands.csv".into(),
            commands_csv(designed, &case.times()).into_bytes(),
        ),
        ("case.toml".into(), designed.manoeuvre.clone().into_bytes()),
        // The answer last: where it stands, the others do.
        ("design.json".into(), json.into_bytes()),
    ];
    write_files(folder, &files)
}
