//! Rotates columns from sensor axes to body axes.
#![allow(non_snake_case)]

use crate::channel_name::components;
use crate::{Channel, Table};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use std::sync::Arc;

/// Mounting of a sensor on its body.
#[derive(Debug, Clone, PartialEq)]
pub struct Mounting {
    /// Name of the sensor, as before the point in `imu2.omega_x`.
    pub sensor: String,
    /// Whether columns without a sensor name belong to it too.
    pub unnamed: bool,
    /// Column prefix: `omega`, `domega`, `acc`, or `q` and `relative_q` for an attitude.
    pub prefix: &'static str,
    /// Rotation from sensor axes to body axes, by rows.
    pub R_BS: [[f64; 3]; 3],
}

impl Mounting {
    /// The inverse rotation, from body axes to sensor axes.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            // By columns.
            R_BS: self.rotation().into(),
            ..self.clone()
        }
    }

    fn rotation(&self) -> Matrix3<f64> {
        Matrix3::from(self.R_BS).transpose()
    }
}

/// Rotates the channels of mounted sensors. A vector sample with a missing component is dropped.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// // A gyro whose x axis is the body's y axis, and whose y axis is the body's -x axis.
/// let R_BS = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
/// let mounting = Mounting { sensor: "imu".into(), unnamed: true, prefix: "omega", R_BS };
/// let axis = |name, value| channel(name, "rad/s", &[0.0], &[value]);
/// let channels = vec![axis("omega_x", 1.0), axis("omega_y", 2.0), axis("omega_z", 3.0)];
/// let mut table = Table { channels, ..Table::default() };
/// mount(&mut table, &[mounting]);
/// let body: Vec<f64> = table.channels.iter().map(|c| c.values[0]).collect();
/// assert_eq!(body, [-2.0, 1.0, 3.0]);
/// ```
pub fn mount(table: &mut Table, mountings: &[Mounting]) {
    for mounting in mountings {
        for places in table.vectors(mounting.prefix) {
            let sensor = places.first().and_then(|k| table.channels.get(*k));
            let sensor = sensor.map_or("", |c| c.sensor.as_str());
            if sensor != mounting.sensor && !(sensor.is_empty() && mounting.unnamed) {
                continue;
            }
            turn(&mut table.channels, &places, mounting);
            table.repairs.push(format!(
                "{}_{} of {}: turned from the sensor's axes to those of its body",
                mounting.prefix,
                components(mounting.prefix).join(", "),
                mounting.sensor
            ));
        }
    }
}

fn turn(channels: &mut [Channel], places: &[usize], mounting: &Mounting) {
    let R_BS = mounting.rotation();
    let R = Rotation3::from_matrix_unchecked(R_BS);
    // R_NB = R_NS R_SB, and alike for an attitude seen from another body.
    let back = UnitQuaternion::from_rotation_matrix(&R).inverse();
    each_row(channels, places, |_, row| {
        match row {
            [x, y, z, w] => {
                let q = UnitQuaternion::new_unchecked(Quaternion::new(*w, *x, *y, *z)) * back;
                (*x, *y, *z, *w) = (q.i, q.j, q.k, q.w);
            }
            [x, y, z] => {
                let v = R_BS * Vector3::new(*x, *y, *z);
                (*x, *y, *z) = (v.x, v.y, v.z);
            }
            _ => {}
        }
        Some(())
    });
}

/// Changes the samples of channels that belong together, at each time at which all of them have one; leaves out those of `None`.
pub(crate) fn each_row(
    channels: &mut [Channel],
    places: &[usize],
    mut change: impl FnMut(f64, &mut [f64]) -> Option<()>,
) {
    let Some((mut times, rows)) = complete_rows(channels, places) else {
        return;
    };
    let all = times.iter().zip(rows);
    let changed = all.filter_map(|(time, mut row)| {
        change(*time, &mut row)?;
        Some((*time, row))
    });
    let (kept, rows): (Vec<f64>, Vec<Vec<f64>>) = changed.unzip();
    if kept.len() < times.len() {
        times = kept.into();
    }
    for (k, place) in places.iter().enumerate() {
        if let Some(channel) = channels.get_mut(*place) {
            channel.time_s = Arc::clone(&times);
            channel.values = rows.iter().filter_map(|row| row.get(k).copied()).collect();
        }
    }
}

/// Times, and one value per channel at each.
type Rows = (Arc<[f64]>, Vec<Vec<f64>>);

/// Times at which every channel has a sample, with the samples.
fn complete_rows(channels: &[Channel], places: &[usize]) -> Option<Rows> {
    let all: Option<Vec<&Channel>> = places.iter().map(|k| channels.get(*k)).collect();
    let all = all?;
    let base = &all.first()?.time_s;
    let sample = |c: &Channel, t: f64| {
        let k = c.time_s.partition_point(|x| *x < t);
        let there = c.time_s.get(k) == Some(&t);
        c.values.get(k).copied().filter(|_| there)
    };
    let row = |t: &f64| all.iter().map(|c| sample(c, *t)).collect::<Option<_>>();
    let whole = base.iter().filter_map(|t| Some((*t, row(t)?)));
    let (times, rows): (Vec<f64>, Vec<Vec<f64>>) = whole.unzip();
    match times.len() == base.len() {
        true => Some((Arc::clone(base), rows)),
        false => Some((times.into(), rows)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, times: &[f64], values: &[f64]) -> Channel {
        Channel {
            name: name.to_owned(),
            time_s: times.into(),
            values: values.to_vec(),
            ..Channel::default()
        }
    }

    #[test]
    fn exact_a_gyro_turned_by_a_quarter_and_back() {
        // The sensor's x axis is the body's y axis.
        let gyro = Mounting {
            sensor: "gyro".into(),
            unnamed: true,
            prefix: "omega",
            R_BS: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let mut table = Table {
            channels: vec![
                channel("omega_x", &[0.0, 1.0, 2.0], &[1.0, 2.0, 3.0]),
                channel("omega_y", &[0.0, 2.0], &[4.0, 6.0]),
                channel("omega_z", &[0.0, 1.0, 2.0], &[7.0, 8.0, 9.0]),
            ],
            ..Table::default()
        };
        mount(&mut table, std::slice::from_ref(&gyro));
        assert_eq!(table.channels[0].values, [-4.0, -6.0]);
        assert_eq!(table.channels[1].values, [1.0, 3.0]);
        assert_eq!(*table.channels[2].time_s, [0.0, 2.0]);
        mount(&mut table, &[gyro.inverse()]);
        assert_eq!(table.channels[0].values, [1.0, 3.0]);
    }

    #[test]
    fn exact_an_attitude_is_that_of_the_body() {
        let R_BS = Rotation3::from_euler_angles(0.4, -0.9, 1.3);
        let q_NB = UnitQuaternion::from_euler_angles(0.1, 0.2, -0.3);
        let q_NS = q_NB * UnitQuaternion::from_rotation_matrix(&R_BS);
        let tracker = Mounting {
            sensor: "tracker".into(),
            unnamed: true,
            prefix: "q",
            R_BS: [0, 1, 2].map(|i| [0, 1, 2].map(|j| R_BS[(i, j)])),
        };
        let part = |name: &str, x: f64| channel(name, &[0.0], &[x]);
        let mut table = Table {
            channels: vec![
                part("q_x", q_NS.i),
                part("q_y", q_NS.j),
                part("q_z", q_NS.k),
                part("q_w", q_NS.w),
            ],
            ..Table::default()
        };
        mount(&mut table, &[tracker]);
        let found: Vec<f64> = table.channels.iter().map(|c| c.values[0]).collect();
        let found = UnitQuaternion::from_quaternion(Quaternion::new(
            found[3], found[0], found[1], found[2],
        ));
        assert!(found.angle_to(&q_NB) < 1e-14);
    }
}
