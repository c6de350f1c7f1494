//! Accelerometers and velocity increments: every one of the model that has columns, on any body.

use super::BindError;
use super::channels::Channels;
use super::noise::covariance;
use super::observe::SAME;
use nalgebra::Vector3;
use poinsot_identify::{PointKind, PointReading, PointReadings};
use poinsot_model::{Model, Nuisance, Sensor, SensorKind};
use poinsot_telemetry::{Channel, Table, median_step};

/// The columns of one instrument.
pub(super) struct PointChannels<'a> {
    sensor: usize,
    kind: PointKind,
    axes: [&'a Channel; 3],
    step: f64,
}

/// Kind and column prefix of an instrument at a point; `None` for other sensors.
pub(super) fn point_kind(kind: SensorKind) -> Option<(PointKind, &'static str)> {
    match kind {
        SensorKind::Accelerometer => Some((PointKind::SpecificForce, "acc")),
        SensorKind::VelocityIncrement => Some((PointKind::VelocityIncrement, "dv")),
        _ => None,
    }
}

/// All instruments that declare their noise and have columns.
pub(super) fn point_channels<'a>(model: &Model, channels: &Channels<'a>) -> Vec<PointChannels<'a>> {
    let sensors = model.sensors.iter().enumerate();
    sensors
        .filter_map(|(at, sensor)| {
            let (kind, prefix) = point_kind(sensor.kind)?;
            let alone = model.sensors_of(sensor.kind).nth(1).is_none();
            let axis = |k: &str| {
                let name = format!("{prefix}_{k}");
                // A column without a sensor's name belongs to the only one.
                match alone {
                    true => channels.find(Some(&sensor.name), &name),
                    false => channels.table.sensor_channel(&sensor.name, &name),
                }
            };
            let axes = [axis("x")?, axis("y")?, axis("z")?];
            covariance(sensor)?;
            Some(PointChannels {
                sensor: at,
                kind,
                step: median_step(&axes[0].time_s)?,
                axes,
            })
        })
        .collect()
}

impl PointChannels<'_> {
    /// Times of the readings and of the beginnings of their intervals, s.
    pub fn times(&self) -> Vec<f64> {
        let own = self.axes[0].time_s.iter().copied();
        match self.kind {
            PointKind::SpecificForce => own.collect(),
            PointKind::VelocityIncrement => own.chain(self.starts()).collect(),
        }
    }

    /// Where the interval of each reading begins: at the reading before, or one step back where that is missing.
    fn starts(&self) -> Vec<f64> {
        let t = &self.axes[0].time_s;
        (0..t.len())
            .map(|i| {
                let before = i.checked_sub(1).map(|b| t[b]);
                before
                    .filter(|b| t[i] - b <= 1.5 * self.step)
                    .unwrap_or(t[i] - self.step)
            })
            .collect()
    }

    /// The readings whose times lie on the grid.
    pub fn readings(&self, model: &Model, grid: &[f64]) -> PointReadings {
        let sensor = &model.sensors[self.sensor];
        let own = covariance(sensor).unwrap_or_default();
        let at = |t: f64| {
            let k = grid.partition_point(|g| *g < t - SAME);
            grid.get(k).filter(|g| (*g - t).abs() <= SAME).map(|_| k)
        };
        let [x, y, z] = self.axes.map(|c| &c.values);
        let starts = self.starts();
        let mut readings: Vec<PointReading> = Vec::new();
        for (i, t) in self.axes[0].time_s.iter().enumerate() {
            let begins = match self.kind {
                PointKind::SpecificForce => *t,
                PointKind::VelocityIncrement => starts[i],
            };
            let on_grid = at(begins).zip(at(*t));
            let parts = (x.get(i), y.get(i), z.get(i));
            if let (Some((from, to)), (Some(x), Some(y), Some(z))) = (on_grid, parts) {
                let value = Vector3::new(*x, *y, *z);
                readings.push(PointReading { from, to, value });
            }
        }
        PointReadings {
            sensor: self.sensor,
            kind: self.kind,
            body: sensor.body,
            p_BoS_B: sensor.p_BoS_B,
            covariance: match self.kind {
                PointKind::SpecificForce => sensor.R_BS * own * sensor.R_BS.transpose(),
                PointKind::VelocityIncrement => own,
            },
            readings,
        }
    }
}

/// Refuses what cannot be used as it stands: columns without declared noise, and faults asked of a sensor
/// without columns.
///
/// # Errors
/// The first such sensor.
pub(super) fn check_points(model: &Model, tables: &[Table]) -> Result<(), BindError> {
    for sensor in &model.sensors {
        let Some((_, prefix)) = point_kind(sensor.kind) else {
            continue;
        };
        let name = format!("{prefix}_x");
        let read = tables.iter().any(|t| {
            let own = t.sensor_channel(&sensor.name, &name);
            own.or_else(|| t.sensor_channel("", &name)).is_some()
        });
        if read && covariance(sensor).is_none() {
            let (kind, key) = match sensor.kind {
                SensorKind::Accelerometer => ("accelerometer", "noise_m_s2"),
                _ => ("velocity_increment", "noise_m_s"),
            };
            return Err(BindError::NoNoise { kind, key });
        }
        if !read && asks(sensor) {
            return Err(BindError::Unsupported {
                what: format!(
                    "sensor '{}': an unknown of it is asked for, and no segment has its columns '{prefix}_x {prefix}_y {prefix}_z'; add them, or take bias, scale, misalignment and lag out",
                    sensor.name
                ),
            });
        }
    }
    Ok(())
}

/// Whether anything of a sensor is declared unknown.
fn asks(sensor: &Sensor) -> bool {
    let declared = [sensor.bias, sensor.scale, sensor.misalignment, sensor.lag];
    declared.iter().any(|n| *n != Nuisance::Known)
}
