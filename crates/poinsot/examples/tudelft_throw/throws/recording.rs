//! One throw: the rows of one log, minus the gyro bias, low-pass filtered.

use super::low_pass::low_pass;
use super::{Fault, Settings};
use nalgebra::Vector3;
use poinsot_model::{Model, TelemetryMap};
use poinsot_telemetry::{ColumnMap, ReadOptions, read};
use std::path::Path;

/// Gyro scatter above which the box was moving before its throw, rad/s.
const AT_REST: f64 = 0.05;
/// Every fourth filtered sample is kept, about 1 kHz: twelve times the Nyquist rate of a cut-off of 40 Hz.
const KEEP: usize = 4;

/// Entry of `logs.csv` for one log.
#[derive(Debug, Clone)]
pub struct Log {
    /// Group: `device_only`, `proof_body`, `config_empty`, `config_a`.
    pub group: String,
    pub name: String,
    /// Gyro bias in B, rad/s.
    pub gyro_bias_B: Vector3<f64>,
}

/// One throw in the air, in body axes, at constant sample rate.
#[derive(Debug, Clone)]
pub struct Recording {
    pub name: String,
    /// Times from the start of the wheel, s.
    pub time_s: Vec<f64>,
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Angular velocity, rad/s.
    pub w_NB_B: Vec<Vector3<f64>>,
    /// Specific force at the accelerometer, m/s2.
    pub f_S_B: Vec<Vector3<f64>>,
    /// Speed of the wheel relative to the body about +z, rad/s.
    pub wheel_rad_s: Vec<f64>,
}

/// Reads `logs.csv`. The bias is the mean of the gyro before the throw. For a box that was moving then (LOG00132) it
/// is the median of the others.
pub fn read_logs(folder: &Path) -> Result<Vec<Log>, Fault> {
    let path = folder.join("logs.csv");
    let text = std::fs::read_to_string(&path)?;
    let mut rows = Vec::new();
    for line in text.lines().skip(1).filter(|l| !l.is_empty()) {
        let row =
            log_row(line).ok_or_else(|| format!("{}: not understood: {line}", path.display()))?;
        rows.push(row);
    }
    let quiet: Vec<Vector3<f64>> = rows
        .iter()
        .filter(|r| r.1)
        .map(|r| r.0.gyro_bias_B)
        .collect();
    let typical = Vector3::from_fn(|k, _| median(quiet.iter().map(|b| b[k]).collect()));
    Ok(rows
        .into_iter()
        .map(|(log, at_rest)| match at_rest {
            true => log,
            false => Log {
                gyro_bias_B: typical,
                ..log
            },
        })
        .collect())
}

/// Parses `source/group,log,...,"[mean]","[deviation]","[..]"`; returns also whether the box was at rest.
fn log_row(line: &str) -> Option<(Log, bool)> {
    let mut quoted = line.split('"');
    let mut plain = quoted.next()?.split(',');
    let group = plain.next()?.rsplit('/').next()?.to_owned();
    let name = plain.next()?.to_owned();
    let gyro_bias_B = vector(quoted.next()?)?;
    let deviation = vector(quoted.nth(1)?)?;
    let log = Log {
        group,
        name,
        gyro_bias_B,
    };
    Some((log, deviation.max() < AT_REST))
}

fn vector(text: &str) -> Option<Vector3<f64>> {
    let inner = text.strip_prefix('[')?.strip_suffix(']')?;
    let numbers: Vec<f64> = inner
        .split(',')
        .map(|x| x.trim().parse().ok())
        .collect::<Option<_>>()?;
    (numbers.len() == 3).then(|| Vector3::from_row_slice(&numbers))
}

/// Median; zero if empty.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Reads one log with the columns of the model, and the accelerometer channels.
pub fn read_recording(
    folder: &Path,
    model: &Model,
    log: &Log,
    settings: &Settings,
) -> Result<Recording, Fault> {
    let options = ReadOptions {
        map: TelemetryMap::of(
            columns(&model.telemetry),
            vec![("log".to_owned(), log.name.clone())],
        ),
        ..ReadOptions::default()
    };
    let table = read(&[folder.join("throws.parquet")], &options)?;
    let first = table.channel("omega_x").ok_or("no gyro")?;
    let rate_hz = 1.0 / poinsot_telemetry::median_step(&first.time_s).ok_or("no samples")?;
    // The filter includes samples before the start, so that its transient is outside.
    let from = first.time_s.partition_point(|t| *t < settings.start_s);
    // Without a filter every sample is kept.
    let (cut_off, keep) = match settings.cut_off_hz.is_finite() {
        true => (Some(settings.cut_off_hz), KEEP),
        false => (None, 1),
    };
    let kept =
        |values: &[f64]| -> Vec<f64> { values.iter().skip(from).step_by(keep).copied().collect() };
    let filtered = |name: &str, bias: f64| -> Result<Vec<f64>, Fault> {
        let channel = table
            .channel(name)
            .ok_or_else(|| format!("no channel {name}"))?;
        let unbiased: Vec<f64> = channel.values.iter().map(|x| x - bias).collect();
        Ok(match cut_off {
            Some(cut_off_hz) => kept(&low_pass(&unbiased, rate_hz, cut_off_hz)),
            None => kept(&unbiased),
        })
    };
    let [wx, wy, wz] =
        [0, 1, 2].map(|k| filtered(["omega_x", "omega_y", "omega_z"][k], log.gyro_bias_B[k]));
    let [fx, fy, fz] = ["acc_x", "acc_y", "acc_z"].map(|name| filtered(name, 0.0));
    Ok(Recording {
        name: log.name.clone(),
        time_s: kept(&first.time_s),
        rate_hz: rate_hz / keep as f64,
        w_NB_B: vectors(&wx?, &wy?, &wz?),
        f_S_B: vectors(&fx?, &fy?, &fz?),
        wheel_rad_s: filtered("wheel_rad_s", 0.0)?,
    })
}

fn columns(map: &TelemetryMap) -> Vec<ColumnMap> {
    let acceleration = [("acc_x", "ax"), ("acc_y", "ay"), ("acc_z", "az")];
    let added = acceleration
        .iter()
        .map(|(channel, column)| ColumnMap::new(channel, column, "m/s2"));
    map.all.columns.iter().cloned().chain(added).collect()
}

fn vectors(x: &[f64], y: &[f64], z: &[f64]) -> Vec<Vector3<f64>> {
    x.iter()
        .zip(y)
        .zip(z)
        .map(|((x, y), z)| Vector3::new(*x, *y, *z))
        .collect()
}
