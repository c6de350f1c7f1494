//! Measured accelerations at the sample times, for methods that use them.

use super::channels::Channels;
use super::sensors::SAME;
use poinsot_identify::{Accelerations, Samples};
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::Channel;

/// Channels of accelerations: `domega` and those of the accelerometer.
///
/// ```
/// use poinsot::bind::acceleration_channels;
///
/// assert!(acceleration_channels().any(|name| name == "domega_x"));
/// ```
pub fn acceleration_channels() -> impl Iterator<Item = String> {
    ["domega", "acc"]
        .into_iter()
        .flat_map(|name| ["x", "y", "z"].map(|k| format!("{name}_{k}")))
}

/// Angular acceleration at every sample, and specific force if the accelerometer has a value at every sample.
///
/// Nothing is interpolated: thrust switches between samples.
pub(super) fn accelerations(
    model: &Model,
    channels: &Channels,
    samples: &Samples,
) -> Option<Accelerations> {
    let angular = ["x", "y", "z"].map(|k| channels.find(None, &format!("domega_{k}")));
    let [Some(x), Some(y), Some(z)] = angular else {
        return None;
    };
    let dw_NB_B = at_samples(&[x, y, z], &samples.time_s)?;
    let linear = channels.vector(model, SensorKind::Accelerometer);
    let p_BoS_B = linear.as_ref().map_or_else(Vector3::zeros, |a| a.p_BoS_B);
    Some(Accelerations {
        dw_NB_B,
        a_NS_B: linear.and_then(|a| at_samples(&a.axes, &samples.time_s)),
        p_BoS_B,
    })
}

fn at_samples(axes: &[&Channel; 3], times: &[f64]) -> Option<Vec<Vector3>> {
    let mut at = [0; 3];
    times
        .iter()
        .map(|t| {
            let mut value = Vector3::zeros();
            for (k, (channel, at)) in axes.iter().zip(&mut at).enumerate() {
                while *channel.time_s.get(*at)? < t - SAME {
                    *at += 1;
                }
                if (channel.time_s.get(*at)? - t).abs() > SAME {
                    return None;
                }
                value[k] = *channel.values.get(*at)?;
            }
            Some(value)
        })
        .collect()
}
