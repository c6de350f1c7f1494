//! One throw: the rows of one log, minus the gyro bias, low-pass filtered or averaged.

use super::low_pass::low_pass;
use super::{CUT_OFF_HZ, START_S, TOGETHER};
use nalgebra::Vector3;
use poinsot_model::{Model, TelemetryMap};
use poinsot_telemetry::{Channel, ColumnMap, ReadOptions, Source, Table, median_step, read};
use std::path::Path;
use std::sync::Arc;

/// Gyro scatter above which the box was moving before its throw, rad/s.
const AT_REST: f64 = 0.05;

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

impl Recording {
    /// The samples of a part.
    pub fn table(&self, from: usize, to: usize) -> Table {
        let time_s: Arc<[f64]> = self.time_s[from..to].into();
        let channel = |name: &str, frame: &str, values: Vec<f64>| Channel {
            name: name.to_owned(),
            sensor: String::new(),
            unit: "rad/s".to_owned(),
            frame: frame.to_owned(),
            time_s: Arc::clone(&time_s),
            values,
        };
        let rate = |k: usize| self.w_NB_B[from..to].iter().map(|w| w[k]).collect();
        Table {
            channels: vec![
                channel("omega_x", "body", rate(0)),
                channel("omega_y", "body", rate(1)),
                channel("omega_z", "body", rate(2)),
                channel("wheel_rad_s", "", self.wheel_rad_s[from..to].to_vec()),
            ],
            sources: vec![Source {
                path: format!("{} from {:.3} s", self.name, time_s[0]),
                sha256: String::new(),
                rows: to - from,
                time_s: [time_s[0], time_s[to - from - 1]],
            }],
            ..Table::default()
        }
    }
}

/// Reads `logs.csv`. The bias is the mean of the gyro before the throw. For a box that was moving then (LOG00132) it
/// is the median of the others.
pub fn read_logs(folder: &Path) -> Vec<Log> {
    let text = std::fs::read_to_string(folder.join("logs.csv")).unwrap();
    let lines = text.lines().skip(1).filter(|l| !l.is_empty());
    let rows: Vec<(Log, bool)> = lines
        .map(|l| log_row(l).unwrap_or_else(|| panic!("logs.csv: {l}")))
        .collect();
    let typical = Vector3::from_fn(|k, _| {
        let quiet = rows.iter().filter(|r| r.1);
        median(quiet.map(|r| r.0.gyro_bias_B[k]).collect())
    });
    let corrected = |(mut log, at_rest): (Log, bool)| {
        if !at_rest {
            log.gyro_bias_B = typical;
        }
        log
    };
    rows.into_iter().map(corrected).collect()
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
    let numbers: [f64; 3] = serde_json::from_str(text).ok()?;
    Some(Vector3::from(numbers))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Reads one log with the columns of the model, and the accelerometer channels. Every fourth filtered sample is kept, about
/// 1 kHz: twelve times the Nyquist rate of the cut-off.
pub fn read_recording(folder: &Path, model: &Model, log: &Log, filtered: bool) -> Recording {
    let acceleration = [("acc_x", "ax"), ("acc_y", "ay"), ("acc_z", "az")];
    let added = acceleration.map(|(channel, column)| ColumnMap::new(channel, column, "m/s2"));
    let columns = model.telemetry.all.columns.iter().cloned().chain(added);
    let mut map = TelemetryMap::default();
    map.all.columns = columns.collect();
    map.all.row_filter = vec![("log".to_owned(), log.name.clone())];
    let options = ReadOptions {
        map,
        ..ReadOptions::default()
    };
    let table = read(&[folder.join("throws.parquet")], &options).unwrap();
    let times = &table.channel("omega_x").unwrap().time_s;
    let rate_hz = 1.0 / median_step(times).unwrap();
    // The filter includes samples before the start, so that its transient is outside.
    let from = times.partition_point(|t| *t < START_S);
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let kept = |values: &[f64]| -> Vec<f64> {
        match filtered {
            true => values[from..].iter().step_by(TOGETHER).copied().collect(),
            false => values[from..].chunks_exact(TOGETHER).map(mean).collect(),
        }
    };
    let samples = |name: &str, bias: f64| -> Vec<f64> {
        let values = table.channel(name).unwrap().values.iter();
        let unbiased: Vec<f64> = values.map(|x| x - bias).collect();
        match filtered {
            true => kept(&low_pass(&unbiased, rate_hz, CUT_OFF_HZ)),
            false => kept(&unbiased),
        }
    };
    let vectors = |names: [&str; 3], bias: Vector3<f64>| -> Vec<Vector3<f64>> {
        let axes: [Vec<f64>; 3] = std::array::from_fn(|k| samples(names[k], bias[k]));
        let rows = 0..axes[0].len();
        rows.map(|row| Vector3::from_fn(|k, _| axes[k][row]))
            .collect()
    };
    Recording {
        name: log.name.clone(),
        time_s: kept(times),
        rate_hz: rate_hz / TOGETHER as f64,
        w_NB_B: vectors(["omega_x", "omega_y", "omega_z"], log.gyro_bias_B),
        f_S_B: vectors(["acc_x", "acc_y", "acc_z"], Vector3::zeros()),
        wheel_rad_s: samples("wheel_rad_s", 0.0),
    }
}
