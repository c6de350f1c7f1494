//! Proposes `[[sensor]]` tables with the noise observed in the data, if no data sheet is available.

use poinsot_files::rounded;
use poinsot_model::SensorKind;
use poinsot_telemetry::{ChannelSummary, Inspection};
use std::fmt::Write;

/// Significant figures of an estimated noise.
const DIGITS: usize = 2;
/// Relative tolerance within which rounding alone (step / sqrt(12)) explains the scatter.
const ROUNDING: f64 = 1.0e-6;

const HEAD: &str = "\
# Estimated from the data by differences of neighbouring samples. A data sheet is better.
";

/// The channels of a sensor.
pub(crate) struct SensorChannels<'a> {
    /// Name; that of the kind where the columns name none.
    pub name: String,
    pub kind: SensorKind,
    /// Of prismatic joints.
    pub slides: bool,
    pub channels: Vec<&'a ChannelSummary>,
}

/// The sensors with axes.
pub(crate) fn vector_sensors(inspection: &Inspection) -> Vec<SensorChannels<'_>> {
    let mut owners: Vec<&str> = inspection.channels.iter().map(|c| owner(c).0).collect();
    owners.sort_unstable();
    owners.dedup();
    let of = |(own, kind): (&str, SensorKind)| {
        let channels = inspection.channels.iter();
        let own_channel = |c: &&ChannelSummary| {
            let (sensor, name) = owner(c);
            sensor == own && kind.columns().contains(&name)
        };
        SensorChannels {
            name: if own.is_empty() { kind.word() } else { own }.to_owned(),
            kind,
            slides: false,
            channels: channels.filter(own_channel).collect(),
        }
    };
    let kinds = |own| SensorKind::with_axes().map(move |kind| (own, kind));
    let all = owners.into_iter().flat_map(kinds).map(of);
    all.filter(|s| !s.channels.is_empty()).collect()
}

/// The tables to paste into a model; `None` if no channel has noise.
pub(crate) fn proposed_sensors(inspection: &Inspection) -> Option<String> {
    let mut out = String::new();
    for sensor in vector_sensors(inspection) {
        if let Some(noise) = noise(&sensor) {
            let (name, word) = (&sensor.name, sensor.kind.declared_as().word());
            let bodies = if sensor.kind.is_relative() {
                "body = \"SEEN BODY\"\nseen_from = \"BODY OF THE CAMERA\"\n"
            } else {
                ""
            };
            let _ = write!(
                out,
                "[[sensor]]\nname = \"{name}\"\ntype = \"{word}\"\n{bodies}{noise}\n\n"
            );
        }
    }
    for channel in &inspection.channels {
        let name = owner(channel).1;
        let vector = SensorKind::with_axes().any(|kind| kind.columns().contains(&name));
        if let (false, Some(noise)) = (vector, channel.noise) {
            let (name, noise) = (&channel.name, rounded(noise, DIGITS));
            let error = error(&[channel]);
            let _ = writeln!(out, "# {name}: {noise} {}, {error}", channel.unit);
        }
    }
    (!out.is_empty()).then(|| format!("{HEAD}{}", out.trim_end()))
}

/// Sensor (may be empty) and channel.
pub(crate) fn owner(channel: &ChannelSummary) -> (&str, &str) {
    channel
        .name
        .rsplit_once('.')
        .unwrap_or(("", channel.name.as_str()))
}

/// The line of a sensor: noise, or the rounding step if it explains the scatter.
pub(crate) fn noise(sensor: &SensorChannels<'_>) -> Option<String> {
    let (kind, channels) = (sensor.kind, &sensor.channels);
    let unit = kind.unit(sensor.slides);
    let sigmas: Vec<f64> = channels.iter().filter_map(|c| c.noise).collect();
    if sigmas.is_empty() || sigmas.len() != channels.len() {
        return None;
    }
    let steps: Vec<f64> = channels
        .iter()
        .filter_map(|c| Some((c.quantum?, c.noise?)))
        .filter(|(q, noise)| (noise * 12.0_f64.sqrt() / q - 1.0).abs() < ROUNDING)
        .map(|(q, _)| q)
        .collect();
    let largest = steps.iter().copied().fold(0.0, f64::max);
    let error = error(channels);
    // Variance per component: a quaternion's four components hold half of each of three small angles, a unit vector's
    // three hold two angles.
    let share = match kind {
        SensorKind::Direction => Some(1.0),
        // One number for all joints or wheels: the mean of their variances.
        kind if kind.is_scalar() => Some(1.0),
        kind if kind.is_rotation() => Some(2.0),
        _ => None,
    };
    if steps.len() == channels.len() && (share.is_none() || kind.is_scalar()) {
        let step = rounded(largest, DIGITS);
        return Some(format!("quantisation_{unit} = {step}"));
    }
    if let Some(share) = share {
        let sum: f64 = sigmas.iter().map(|s| s * s).sum();
        let numbers = if kind.is_scalar() {
            sigmas.len()
        } else {
            kind.numbers()
        };
        let angle = rounded(share * (sum / numbers as f64).sqrt(), DIGITS);
        return Some(format!("noise_{unit} = {angle}   # {error}"));
    }
    let sigmas: Vec<String> = sigmas.iter().map(|s| rounded(*s, DIGITS)).collect();
    let sigmas = sigmas.join(", ");
    Some(format!("noise_{unit} = [{sigmas}]   # {error}"))
}

/// Relative error of the estimated noise.
fn error(channels: &[&ChannelSummary]) -> String {
    if channels.iter().any(|c| c.noise_is_upper_bound) {
        return "an upper bound: it includes motion between the samples".to_owned();
    }
    let errors = channels.iter().filter_map(|c| c.noise_relative_error);
    let percent = 100.0 * errors.fold(0.0, f64::max);
    format!("within {} % (one sigma)", rounded(percent, DIGITS))
}
