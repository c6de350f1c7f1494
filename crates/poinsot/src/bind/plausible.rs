//! Plausibility limits against placeholders and wrong units, which would dominate the result and the computing time.

use super::BindError;
use super::channels::Channels;
use poinsot_files::rounded;
use poinsot_telemetry::{Channel, median_step};
use std::f64::consts::PI;

/// Largest plausible values, by suffix of the channel name.
const LARGEST: [(&str, f64, &str); 6] = [
    ("_rad_s", 1.0e5, "rad/s"),
    ("_m_s", 1.0e4, "m/s"),
    ("_rad", 1.0e6, "rad"),
    ("_m", 1.0e6, "m"),
    ("_Nm", 1.0e6, "N m"),
    ("_N", 1.0e8, "N"),
];

/// Returns an error for samples beyond plausible limits.
///
/// # Errors
/// The first such sample, with channel and time.
pub(super) fn check(channels: &Channels) -> Result<(), BindError> {
    for channel in &channels.table.channels {
        let fault = match channel.name.as_str() {
            "omega_x" | "omega_y" | "omega_z" => turns_too_far(channel),
            "v_x" | "v_y" | "v_z" => beyond(channel, 1.0e6, "m/s"),
            "dv_x" | "dv_y" | "dv_z" => beyond(channel, 1.0e6, "m/s"),
            "acc_x" | "acc_y" | "acc_z" => beyond(channel, 1.0e6, "m/s2"),
            "domega_x" | "domega_y" | "domega_z" => beyond(channel, 1.0e6, "rad/s2"),
            name => LARGEST
                .iter()
                .find(|(end, ..)| name.ends_with(end))
                .and_then(|(_, most, unit)| beyond(channel, *most, unit)),
        };
        if let Some((at, why)) = fault {
            return Err(BindError::Implausible {
                file: channels.label.to_owned(),
                channel: poinsot_telemetry::full_name(&channel.sensor, &channel.name),
                value: channel.values.get(at).copied().unwrap_or_default(),
                time_s: channel.time_s.get(at).copied().unwrap_or_default(),
                why,
            });
        }
    }
    Ok(())
}

fn beyond(channel: &Channel, most: f64, unit: &str) -> Option<(usize, String)> {
    let at = channel.values.iter().position(|x| x.abs() > most)?;
    Some((at, format!("beyond {most:e} {unit}")))
}

/// Between two samples a vehicle must rotate by less than half a turn; otherwise the rotation is ambiguous.
fn turns_too_far(channel: &Channel) -> Option<(usize, String)> {
    let step = median_step(&channel.time_s)?;
    let at = channel.values.iter().position(|x| x.abs() * step > PI)?;
    let turns = channel.values.get(at)?.abs() * step / (2.0 * PI);
    Some((
        at,
        format!(
            "{} turns between samples {} s apart",
            rounded(turns, 4),
            rounded(step, 4)
        ),
    ))
}
