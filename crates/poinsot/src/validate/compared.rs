//! One quantity from two sources over time, and its difference.

use crate::bind::covariance;
use nalgebra::Quaternion;
use poinsot_formats::{ComparedQuantityFile, InSigmasFile};
use poinsot_model::Sensor;
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_telemetry::{Channel, Table};

/// One quantity from two sources.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Compared {
    /// Its record in the result file: name, unit and size of the difference.
    pub file: ComparedQuantityFile,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Names of the components of both sides.
    pub components: Vec<String>,
    /// Values of the model, one row per component.
    pub model: Vec<Vec<f64>>,
    /// Values of the other side.
    pub against: Vec<Vec<f64>>,
    /// Names of the components of the difference; for an attitude, a small rotation in base axes.
    pub difference_components: Vec<String>,
    /// Model minus other side, one row per component.
    pub difference: Vec<Vec<f64>>,
}

impl Compared {
    /// The quantity with the statistics of its difference.
    pub(super) fn measured(mut self) -> Self {
        let file = &mut self.file;
        file.samples = self.time_s.len();
        file.largest_at_s = self.time_s.first().copied().unwrap_or(0.0);
        let mut square = 0.0;
        for (k, time) in self.time_s.iter().enumerate() {
            let rows = self.difference.iter().filter_map(|row| row.get(k));
            let own: f64 = rows.map(|x| x * x).sum();
            square += own;
            // NaN must not count as agreement.
            if own.sqrt() > file.largest || own.is_nan() {
                (file.largest, file.largest_at_s) = (own.sqrt(), *time);
            }
        }
        file.rms = (square / self.time_s.len().max(1) as f64).sqrt();
        self
    }
}

/// Channels compared together.
pub(super) struct Group<'m> {
    pub name: String,
    pub unit: &'static str,
    pub channels: Vec<String>,
    pub sensor: Option<&'m Sensor>,
    /// Whether channels without a sensor name are its own.
    pub unnamed: bool,
    /// Makes an attitude of four numbers: measured ones are rounded.
    pub attitude: fn(Quaternion<f64>) -> UnitQuaternion,
}

/// Values at the wanted times; both lists ascend, and every wanted time exists.
fn at(channel: &Channel, wanted: &[f64]) -> Vec<f64> {
    let index = |t: &f64| channel.time_s.partition_point(|own| own < t);
    let value = |i: usize| channel.values.get(i).copied().unwrap_or(f64::NAN);
    wanted.iter().map(|t| value(index(t))).collect()
}

impl Group<'_> {
    fn find<'t>(&self, table: &'t Table, name: &str) -> Option<&'t Channel> {
        let own = self
            .sensor
            .and_then(|s| table.sensor_channel(&s.name, name));
        own.or_else(|| table.channel(name).filter(|_| self.unnamed))
    }

    /// The quantity from two tables, at the times that both have up to the last.
    pub fn compare(&self, exact: &Table, measured: &Table, until: f64) -> Option<Compared> {
        let of = |table| {
            let found = self.channels.iter().map(|name| self.find(table, name));
            found.collect::<Option<Vec<&Channel>>>()
        };
        let (found, computed) = (of(measured)?, of(exact)?);
        let has = |c: &&Channel, t: &f64| c.time_s.binary_search_by(|own| own.total_cmp(t)).is_ok();
        let together = |t: &f64| (0.0..=until).contains(t) && found.iter().all(|c| has(c, t));
        let times = found.first()?.time_s.iter().copied();
        let times: Vec<f64> = times.filter(together).collect();
        if times.is_empty() {
            return None;
        }
        let model: Vec<Vec<f64>> = computed.iter().map(|c| at(c, &times)).collect();
        let against: Vec<Vec<f64>> = found.iter().map(|c| at(c, &times)).collect();
        let (difference_components, difference) = if self.channels.len() == 4 {
            let q = |rows, k| (self.attitude)(quaternion(rows, k));
            let turn = |k| turn(&q(&against, k), &q(&model, k));
            let turns: Vec<Vector3> = (0..times.len()).map(turn).collect();
            let row = |k| turns.iter().map(|v| v[k]).collect();
            (turn_names(), (0..3).map(row).collect::<Vec<Vec<f64>>>())
        } else {
            let rows = model.iter().zip(&against);
            let rows = rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect());
            (self.channels.clone(), rows.collect())
        };
        let compared = Compared {
            file: ComparedQuantityFile {
                quantity: self.name.clone(),
                unit: self.unit.to_owned(),
                sigmas: self.sigmas(&difference),
                ..ComparedQuantityFile::default()
            },
            time_s: times,
            components: self.channels.clone(),
            model,
            against,
            difference_components,
            difference,
        };
        Some(compared.measured())
    }

    /// Differences in units of the declared noise including rounding, per axis.
    fn sigmas(&self, difference: &[Vec<f64>]) -> Option<InSigmasFile> {
        let sensor = self.sensor?;
        let covariance = covariance(sensor)?;
        let (mut square, mut count, mut largest) = (0.0, 0_usize, 0.0_f64);
        for (k, row) in difference.iter().enumerate() {
            let axis = if sensor.kind.is_scalar() { 0 } else { k };
            let sigma = covariance[(axis, axis)].sqrt();
            if sigma <= 0.0 {
                return None;
            }
            count += row.len();
            for x in row {
                square += (x / sigma).powi(2);
                largest = largest.max((x / sigma).abs());
            }
        }
        Some(InSigmasFile {
            rms: (square / count.max(1) as f64).sqrt(),
            largest,
            whiteness_p: None,
        })
    }
}

/// Names of the components of a difference of attitudes.
pub(super) fn turn_names() -> Vec<String> {
    ["turn_x", "turn_y", "turn_z"].map(str::to_owned).to_vec()
}

fn quaternion(rows: &[Vec<f64>], k: usize) -> Quaternion<f64> {
    let part = |row: usize| {
        let x = rows.get(row).and_then(|r| r.get(k));
        x.copied().unwrap_or(f64::NAN)
    };
    Quaternion::new(part(3), part(0), part(1), part(2))
}

/// Rotation vector from attitude `from` to attitude `to`, in the axes of `from`, rad. Accurate for tiny rotations,
/// where the scalar part of a quaternion is useless.
fn turn(from: &UnitQuaternion, to: &UnitQuaternion) -> Vector3 {
    let q = from.inverse() * to;
    let (v, w) = (q.imag(), q.w);
    let (v, w) = if w < 0.0 { (-v, -w) } else { (v, w) };
    let size = v.norm();
    if size == 0.0 {
        return Vector3::zeros();
    }
    v * (2.0 * size.atan2(w) / size)
}
