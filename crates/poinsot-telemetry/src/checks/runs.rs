//! Sensors with several channels, and runs of equal samples.

use crate::channel_name::components;
use crate::median::median;
use crate::{Channel, Table, classify};

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
    let prefixes = ["omega", "q", "v", "r", "acc"];
    let all = prefixes.into_iter().flat_map(|prefix| {
        let places = table.vectors(prefix).into_iter();
        places.map(move |places| (prefix, places))
    });
    let of = |(prefix, channels): (&str, Vec<usize>)| {
        let own = table.at(&channels);
        let (first, last) = (own.first()?, components(prefix).last()?);
        let together = own.iter().all(|c| c.time_s == first.time_s);
        let name = format!("{}..{last}", first.full());
        together.then(|| Sensor {
            channels,
            is_attitude: prefix == "q",
            name,
        })
    };
    all.filter_map(of).collect()
}

/// Each angle, displacement or speed of a joint or wheel.
pub(super) fn inputs(table: &Table) -> Vec<Sensor> {
    let units = ["rad", "rad/s", "m", "m/s"];
    let all = table.channels.iter().enumerate();
    let of = |(k, channel): (usize, &Channel)| {
        let scalar = classify(&channel.name).is_some_and(|name| name.vector().is_none());
        (scalar && units.contains(&channel.unit.as_str())).then(|| Sensor {
            channels: vec![k],
            is_attitude: false,
            name: channel.full(),
        })
    };
    all.filter_map(of).collect()
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
