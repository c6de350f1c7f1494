//! Sensors with several channels, and runs of equal samples.

use crate::median::median;
use crate::{Channel, Table, classify};
use crate::{Quantity, full_name};

/// The channels of one vector sensor on one time base.
pub(super) struct Sensor {
    /// Indices into the table.
    pub channels: Vec<usize>,
    /// Whether the sensor is a quaternion.
    pub is_attitude: bool,
    /// Name in messages: `omega_x..z`.
    pub name: String,
}

/// Gyros, attitudes, velocities, positions and accelerometers. Joints, wheels and thrusters may be at rest.
pub(super) fn sensors(table: &Table) -> Vec<Sensor> {
    let mut list = Vec::new();
    for (first, rest) in [
        ("omega_x", &["omega_y", "omega_z"][..]),
        ("q_x", &["q_y", "q_z", "q_w"][..]),
        ("v_x", &["v_y", "v_z"][..]),
        ("r_x", &["r_y", "r_z"][..]),
        ("acc_x", &["acc_y", "acc_z"][..]),
    ] {
        for (k, channel) in table.channels.iter().enumerate() {
            if channel.name != first {
                continue;
            }
            let find = |name: &str| {
                table.channels.iter().position(|c| {
                    c.name == name && c.sensor == channel.sensor && c.time_s == channel.time_s
                })
            };
            let Some(more) = rest.iter().map(|n| find(n)).collect::<Option<Vec<_>>>() else {
                continue;
            };
            let last = rest.last().copied().unwrap_or_default();
            list.push(Sensor {
                channels: std::iter::once(k).chain(more).collect(),
                is_attitude: classify(first)
                    .is_some_and(|c| matches!(c.quantity, Quantity::Attitude(_))),
                name: format!(
                    "{}..{}",
                    full_name(&channel.sensor, first),
                    last.rsplit('_').next().unwrap_or_default()
                ),
            });
        }
    }
    list
}

/// Runs of samples in which `same(k)` holds (sample k equals sample k-1): first index and length.
pub(super) fn runs(samples: usize, same: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut list = Vec::new();
    let mut start = 0;
    for k in 1..=samples {
        if k < samples && same(k) {
            continue;
        }
        list.push((start, k - start));
        start = k;
    }
    list
}

/// Whether sample k of a channel equals the one before it.
pub(super) fn repeats(channel: &Channel, k: usize) -> bool {
    let at = |k: usize| channel.values.get(k);
    k > 0 && at(k) == at(k - 1)
}

/// Whether every sample has noise: third differences are as large as white noise in the first differences implies.
/// Smooth motion makes them smaller.
pub(super) fn noise_is_visible(values: &[f64]) -> bool {
    let mut first: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let mut third: Vec<f64> = values
        .windows(4)
        .map(|w| ((w[0] - w[3]) - 3.0 * (w[1] - w[2])).abs())
        .collect();
    let (Some(first), Some(third)) = (median(&mut first), median(&mut third)) else {
        return false;
    };
    first > 0.0 && third / 20.0_f64.sqrt() > 0.3 * first / 2.0_f64.sqrt()
}
