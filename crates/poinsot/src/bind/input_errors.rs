//! Correlation in time of joint and wheel errors.
//!
//! The error of a rounded sample is up to half a step. If the quantity changes by a fraction `d` of a step per sample,
//! the correlation of two errors is `1 - 6 d + 6 d^2` by the mean over the phase of the product of two sawtooth
//! errors. Errors are treated as independent if the change exceeds a fifth of a step. In a run of `n` equal samples
//! `d` is at most `1 / n`. A quantity at rest and one that drifts by a whole step during the run are
//! indistinguishable by the run alone: it is taken as moving.

use super::channels::{Channels, JointColumns};
use super::sensors::{rounding, runs, scalar_sensor};
use poinsot_identify::{BetweenReadings, InputChannel, InputErrors, InputRate, RoundingError};
use poinsot_model::{Sensor, SensorKind};
use poinsot_telemetry::{Channel, median_step};

/// Correlation of neighbouring errors below which all are independent.
const UNCORRELATED: f64 = 1.0e-3;
/// What is known of every joint on the grid of a segment.
pub(super) fn joint_inputs(channels: &Channels, grid: &[f64]) -> Vec<InputChannel> {
    let of = |joint: JointColumns| {
        let sensor = scalar_sensor(channels.model, SensorKind::JointPosition, joint.at);
        InputChannel {
            errors: joint
                .position
                .map_or(InputErrors::None, |c| errors(c, sensor, grid)),
            rate: match joint.moving().and(joint.rate) {
                Some(_) => InputRate::Measured,
                None => InputRate::Unmeasured,
            },
            ..InputChannel::default()
        }
    };
    channels.joints().map(of).collect()
}

/// What is known of every wheel on the grid of a segment.
pub(super) fn wheel_inputs(channels: &Channels, grid: &[f64]) -> Vec<InputChannel> {
    let of = |(wheel, speed): (usize, Option<&Channel>)| {
        let sensor = scalar_sensor(channels.model, SensorKind::WheelSpeed, wheel);
        InputChannel {
            errors: speed.map_or(InputErrors::None, |c| of_wheel(c, sensor, grid)),
            rate: match speed.is_some() && channels.driven.drives(wheel) {
                true => InputRate::Straight,
                false => InputRate::Unmeasured,
            },
            ..InputChannel::default()
        }
    };
    channels.tachometers().enumerate().map(of).collect()
}

/// Whether some joint or wheel has no sample at some grid times, and no process that goes on between its samples.
pub(super) fn between_readings(channels: &Channels, joints: &[InputChannel], grid: &[f64]) -> bool {
    let joints = channels.joints().zip(joints);
    let read = joints.filter(|(_, known)| !matches!(known.errors, InputErrors::Process(_)));
    let joints = read.flat_map(|(j, _)| [j.position, j.rate]);
    let mut all = joints.chain(channels.tachometers()).flatten();
    all.any(|channel| !read_at(channel, grid))
}

/// Whether a channel has a sample at every grid time.
fn read_at(channel: &Channel, grid: &[f64]) -> bool {
    let tolerance = 1.0e-6 * median_step(&channel.time_s).unwrap_or(0.0);
    let mut times = channel.time_s.iter();
    grid.iter().all(|t| {
        let mut later = times.by_ref().skip_while(|x| **x < t - tolerance);
        later.next().is_some_and(|x| (x - t).abs() <= tolerance)
    })
}

/// A wheel runs straight between its samples, or as its torque drives it from both of them: where no error stays from sample
/// to sample, those in between are known exactly.
fn of_wheel(channel: &Channel, sensor: Option<&Sensor>, grid: &[f64]) -> InputErrors {
    let fresh = stays(channel, &runs_of(channel, sensor)).is_empty();
    match fresh && !read_at(channel, grid) {
        true => InputErrors::Interpolated(places(&channel.time_s, grid)),
        // Without torque a wheel keeps its speed in inertial space, not that against a body which turns.
        false => errors(channel, sensor, grid),
    }
}

/// Where the grid times lie among samples.
fn places(samples: &[f64], grid: &[f64]) -> Vec<BetweenReadings> {
    let tolerance = 1.0e-6 * median_step(samples).unwrap_or(0.0);
    let place = |t: &f64| {
        let after = samples.partition_point(|s| *s <= t + tolerance);
        let reading = after.saturating_sub(1);
        let past = samples.get(reading).map_or(0.0, |s| t - s);
        let step = samples.get(after).map_or(0.0, |s| s - samples[reading]);
        let share = if past > tolerance { past / step } else { 0.0 };
        BetweenReadings { reading, share }
    };
    grid.iter().map(place).collect()
}

/// Runs of equal samples of a rounding sensor.
fn runs_of(channel: &Channel, sensor: Option<&Sensor>) -> Vec<(usize, usize)> {
    let step = sensor.and_then(rounding);
    step.map_or_else(Vec::new, |step| runs(&channel.values, step))
}

/// A run of equal samples whose errors are correlated.
struct Stay {
    from_s: f64,
    to_s: f64,
    /// Correlation of neighbours if the quantity moves by a step during the run.
    moving: f64,
}

/// The longer runs of a rounded channel.
fn stays(channel: &Channel, runs: &[(usize, usize)]) -> Vec<Stay> {
    let t = &channel.time_s;
    let stay = |&(from, to): &(usize, usize)| {
        Some(Stay {
            from_s: t[from],
            to_s: t[to],
            moving: memory_of_run(to - from + 1)?,
        })
    };
    runs.iter().filter_map(stay).collect()
}

fn errors(channel: &Channel, sensor: Option<&Sensor>, grid: &[f64]) -> InputErrors {
    let runs = runs_of(channel, sensor);
    if runs.len() == 1 {
        return InputErrors::Locked;
    }
    let between = median_step(&channel.time_s).unwrap_or(0.0);
    let mut stays = stays(channel, &runs).into_iter().peekable();
    let tolerance = 1.0e-6 * between;
    let memory = |w: &[f64]| {
        while stays.next_if(|s| s.to_s < w[1] - tolerance).is_some() {}
        let h = w[1] - w[0];
        match stays.peek().filter(|s| s.from_s <= w[0] + tolerance) {
            // Interpolated values share errors; this correlation keeps the noise per second.
            None => ((between - h) / (between + h)).max(0.0),
            Some(s) => s.moving.powf((h / between).min(1.0)),
        }
    };
    let memory = grid.windows(2).map(memory).chain([0.0]);
    let error = |(memory, place): (f64, BetweenReadings)| RoundingError {
        memory,
        read: place.share == 0.0,
    };
    let all: Vec<RoundingError> = memory
        .zip(places(&channel.time_s, grid))
        .map(error)
        .collect();
    match all.iter().all(|e| e.memory < UNCORRELATED) {
        true => InputErrors::Independent,
        false => InputErrors::Rounded(all),
    }
}

/// Correlation of neighbouring errors in a run of equal samples; `None` for a short one.
fn memory_of_run(length: usize) -> Option<f64> {
    let d = 1.0 / length as f64;
    let correlation = 1.0 - 6.0 * d + 6.0 * d * d;
    (length >= 5 && correlation > 0.0).then_some(correlation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_runs_are_stretches_of_one_reading() {
        assert_eq!(
            runs(&[0.0, 0.0, 1.0, 1.0, 1.0, 3.0], 1.0),
            [(0, 1), (2, 4), (5, 5)]
        );
        assert_eq!(runs(&[], 1.0), []);
        assert_eq!(memory_of_run(3), None);
        assert!((memory_of_run(10).unwrap_or(0.0) - 0.46).abs() < 1.0e-12);
    }

    #[test]
    fn unit_places_of_grid_times_among_samples() {
        let found = places(&[-0.5, 0.5, 1.5], &[0.0, 0.5, 0.75, 1.5]);
        let expected = [(0, 0.5), (1, 0.0), (1, 0.25), (2, 0.0)];
        let pairs: Vec<(usize, f64)> = found.iter().map(|p| (p.reading, p.share)).collect();
        assert_eq!(pairs, expected);
    }

    #[test]
    fn exact_correlation_of_rounding_errors_is_the_bernoulli_polynomial() {
        // Mean over the phase of the product of two sawtooth errors separated by a fraction d of a step.
        let error = |x: f64| x - x.round();
        for d in [0.05, 0.1, 0.2] {
            let n = 100_000;
            let at = |i: usize| (i as f64 + 0.5) / n as f64;
            let product: f64 = (0..n).map(|i| error(at(i)) * error(at(i) + d)).sum();
            let correlation = 12.0 * product / n as f64;
            assert!((correlation - (1.0 - 6.0 * d + 6.0 * d * d)).abs() < 1.0e-4);
        }
    }
}
