//! Correlation in time of joint and wheel errors.
//!
//! The error of a rounded sample is up to half a step. If the quantity changes by a fraction `d` of a step per sample,
//! the correlation of two errors is `1 - 6 d + 6 d^2` by the mean over the phase of the product of two sawtooth
//! errors. Errors are treated as independent if the change exceeds a fifth of a step. In a run of `n` equal samples
//! `d` is at most `1 / n`. A quantity at rest and one that drifts by a whole step during the run are
//! indistinguishable by the run alone. A joint may be at rest where the runs beside it are much
//! shorter; the fit decides by the likelihood.

use super::channels::{Channels, JointColumns};
use super::sensors::{rounding, runs, scalar_sensor};
use poinsot_identify::{BetweenReadings, InputChannel, InputErrors, InputRate, RoundingError};
use poinsot_model::{Sensor, SensorKind};
use poinsot_telemetry::{Channel, median_step};

/// Correlation of neighbouring errors below which all are independent.
const UNCORRELATED: f64 = 1.0e-3;
/// Samples that a motion from rest takes to leave its first level, over those that it stays on the next one: for a start with
/// the third power of time from the far edge of the level, `1 / (2^(1/3) - 1)`. Starts with constant acceleration take fewer.
const STARTS: f64 = 3.85;

/// What is known of every joint on the grid of a segment.
pub(super) fn joint_inputs(channels: &Channels, grid: &[f64]) -> Vec<InputChannel> {
    let of = |joint: JointColumns| {
        let sensor = scalar_sensor(channels.model, SensorKind::JointPosition, joint.at);
        InputChannel {
            errors: joint
                .position
                .map_or(InputErrors::None, |c| errors(c, sensor, grid, true)),
            rate: match joint.moving().and(joint.rate) {
                Some(_) => InputRate::Measured,
                None => InputRate::Unmeasured,
            },
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
        false => errors(channel, sensor, grid, false),
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
    /// Where it may be at rest, s, and the correlation of neighbours before and after.
    rest: Option<(f64, f64)>,
    ends: [f64; 2],
}

/// The longer runs of a rounded channel. A quantity may be at rest in a run that is much longer than those
/// beside it.
fn stays(channel: &Channel, runs: &[(usize, usize)]) -> Vec<Stay> {
    let t = &channel.time_s;
    let length = |r: Option<usize>| {
        let run = r.and_then(|r| runs.get(r));
        run.map_or(0, |(from, to)| to - from + 1)
    };
    let stay = |(r, &(from, to)): (usize, &(usize, usize))| {
        let own = to - from + 1;
        let moving = memory_of_run(own)?;
        // It stops and starts at the ends, if a run is beside them.
        let ends = [length(r.checked_sub(1)), length(Some(r + 1))];
        let ends = ends.map(|beside| (STARTS * beside as f64).ceil() as usize);
        let rests = ends[0] + ends[1] < own;
        Some(Stay {
            from_s: t[from],
            to_s: t[to],
            moving,
            rest: rests.then(|| (t[from + ends[0]], t[to - ends[1]])),
            ends: ends.map(|n| memory_of_run(n).unwrap_or(0.0)),
        })
    };
    runs.iter().enumerate().filter_map(stay).collect()
}

/// `brakes` says whether the quantity may be held still.
fn errors(channel: &Channel, sensor: Option<&Sensor>, grid: &[f64], brakes: bool) -> InputErrors {
    let runs = runs_of(channel, sensor);
    if runs.len() == 1 {
        return InputErrors::Locked;
    }
    let between = median_step(&channel.time_s).unwrap_or(0.0);
    let mut stays = stays(channel, &runs).into_iter().peekable();
    let tolerance = 1.0e-6 * between;
    let mut memory: Vec<RoundingError> = grid
        .windows(2)
        .map(|w| {
            while stays.next_if(|s| s.to_s < w[1] - tolerance).is_some() {}
            let h = w[1] - w[0];
            let Some(s) = stays.peek().filter(|s| s.from_s <= w[0] + tolerance) else {
                // Interpolated values share errors; this correlation keeps the noise per second.
                let shared = ((between - h) / (between + h)).max(0.0);
                return correlated(shared);
            };
            let over = |memory: f64| memory.powf((h / between).min(1.0));
            let moving = over(s.moving);
            let Some((from, to)) = s.rest.filter(|_| brakes) else {
                return correlated(moving);
            };
            let [before, after] = s.ends.map(over);
            RoundingError {
                moving,
                resting: if w[0] < from - tolerance {
                    before
                } else {
                    after
                },
                read: false,
                rests: w[0] >= from - tolerance && w[1] <= to + tolerance,
            }
        })
        .chain([correlated(0.0)])
        .collect();
    let places = places(&channel.time_s, grid);
    let pairs = memory.iter_mut().zip(&places);
    pairs.for_each(|(e, place)| e.read = place.share == 0.0);
    match memory.iter().all(|e| e.moving < UNCORRELATED && !e.rests) {
        true => InputErrors::Independent,
        false => InputErrors::Rounded(memory),
    }
}

/// A correlation that no rest changes.
fn correlated(memory: f64) -> RoundingError {
    RoundingError {
        moving: memory,
        resting: memory,
        rests: false,
        read: false,
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

    /// Starts from the far edge of a level: with constant acceleration and with the third power of time.
    #[test]
    fn exact_a_motion_from_rest_leaves_its_level_within_the_ends() {
        for power in [2.0_f64, 3.0] {
            let first = 1.0;
            let next = 2.0_f64.powf(1.0 / power) - 1.0;
            assert!(STARTS * next >= first - 1.0e-3, "{power}");
        }
    }

    #[test]
    fn unit_only_a_run_much_longer_than_its_neighbours_may_be_at_rest() {
        let rests = |lengths: &[usize]| -> Vec<bool> {
            let levels = lengths.iter().enumerate();
            let values: Vec<f64> = levels.flat_map(|(k, n)| vec![k as f64; *n]).collect();
            let channel = Channel {
                name: "q".to_owned(),
                time_s: (0..values.len()).map(|k| k as f64).collect(),
                values,
                ..Channel::default()
            };
            let runs = runs(&channel.values, 1.0);
            let all = stays(&channel, &runs);
            all.iter().map(|s| s.rest.is_some()).collect()
        };
        assert_eq!(rests(&[20, 20, 20, 20]), [false; 4]);
        assert_eq!(rests(&[100, 8, 6, 60]), [true, false, false, true]);
        // A turn at constant acceleration.
        assert_eq!(rests(&[10, 14, 48, 14, 10]), [false; 5]);
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
