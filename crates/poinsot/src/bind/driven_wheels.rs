//! Wheel speeds between tachometer samples, where the motor torque is measured.
//!
//! Between two tachometer samples the speed is the straight line through them plus a share of what the integral of the
//! torque deviates from its own straight line: `Omega' = k tau + b`. An offset of the torque and friction that changes
//! slowly fall out with `b`; `k` is fitted, so spin inertia and scale of the torque need not be known.
//!
//! What the torque tells is decided by the tachometer. Each of its samples is predicted from the one before and the one
//! after, with the torque held from sample to sample, with straight lines through its samples, and without it. What
//! scatters beyond the noise of the tachometer is the error of the bridge and is added to that noise.

use poinsot_model::Model;
use poinsot_telemetry::{Channel, GAP, Table, median_step, resample};
use std::borrow::Cow;

/// Fewest predicted tachometer samples that decide.
const FEWEST: usize = 10;
/// Deviation from a straight line, in sigmas of the bridge's error, from which a torque sample becomes a grid time.
const BEND: f64 = 0.1;

/// Torque between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TorqueMotion {
    /// Each sample holds until the next one, as commands do.
    Held,
    /// Straight lines from sample to sample.
    Straight,
}

/// How the torque of a wheel drives its speed.
#[derive(Debug, Clone, Copy)]
struct Drive {
    motion: TorqueMotion,
    /// Change of speed per torque and time, 1/(kg m2).
    scale: f64,
    /// Mean square error of a predicted tachometer sample, over that of white noise of unit variance.
    scatter: f64,
}

/// How every wheel is driven; nothing where its torque is not measured or does not explain its speed.
#[derive(Debug, Default)]
pub(super) struct DrivenWheels {
    of: Vec<Option<Drive>>,
}

impl DrivenWheels {
    /// `noise` holds the variance of each wheel's tachometer.
    pub fn new(model: &Model, tables: &[Table], noise: &[f64]) -> Self {
        let of = model.wheels.iter().zip(noise).map(|(wheel, noise)| {
            let read = tables.iter().filter_map(|t| {
                let speed = t.channel(&speed_column(&wheel.name))?;
                let torque = t.channel(&torque_column(&wheel.name))?;
                (*speed.time_s != *torque.time_s).then_some((speed, torque))
            });
            drive(&read.collect::<Vec<_>>(), *noise)
        });
        Self { of: of.collect() }
    }

    /// Whether the torque of this wheel is used.
    pub fn drives(&self, wheel: usize) -> bool {
        matches!(self.of.get(wheel), Some(Some(_)))
    }

    /// Variance of the error of the bridge for a tachometer with this variance of noise, (rad/s)^2.
    pub fn added(&self, wheel: usize, variance: f64) -> f64 {
        let drive = self.of.get(wheel).copied().flatten();
        drive.map_or(0.0, |d| (d.scatter - variance).max(0.0))
    }

    /// Speed of a wheel at its tachometer samples and, where its torque is used, at the samples of that between them.
    pub fn speed<'a>(
        &self,
        wheel: usize,
        tachometer: &'a Channel,
        torque: Option<&Channel>,
    ) -> Cow<'a, Channel> {
        let drive = self.of.get(wheel).copied().flatten();
        match drive.zip(torque) {
            Some((drive, torque)) => {
                let impulse = Impulse::new(torque, drive.motion);
                Cow::Owned(bridge(tachometer, &impulse, &drive))
            }
            None => Cow::Borrowed(tachometer),
        }
    }

    /// What is said of it.
    pub fn told(&self, model: &Model) -> Option<String> {
        let driven = model.wheels.iter().zip(&self.of);
        let (names, motions): (Vec<&str>, Vec<TorqueMotion>) = driven
            .filter_map(|(w, d)| Some((w.name.as_str(), (*d)?.motion)))
            .unzip();
        let held = motions.iter().filter(|m| **m == TorqueMotion::Held);
        let held = held.count();
        let how = match held {
            n if n == names.len() => "held from sample to sample",
            0 => "straight from sample to sample",
            _ => "held or straight from sample to sample, as the tachometer shows",
        };
        (!names.is_empty()).then(|| {
            format!(
                "speed of {} between tachometer samples: driven by the measured motor torque, {how}",
                names.join(", ")
            )
        })
    }
}

/// Column of a wheel's speed.
pub(super) fn speed_column(wheel: &str) -> String {
    format!("{wheel}_rad_s")
}

/// Column of a wheel's motor torque.
pub(super) fn torque_column(wheel: &str) -> String {
    format!("{wheel}_Nm")
}

/// Speed of a wheel at these times; nothing in gaps of its tachometer.
pub(super) fn speed_at(speed: &Channel, tachometer: &Channel, times: &[f64]) -> Vec<Option<f64>> {
    let longest = median_step(&tachometer.time_s).map(|step| GAP * step);
    resample(speed, times, longest)
}

/// Time integral of a torque from its first sample.
struct Impulse<'a> {
    torque: &'a Channel,
    motion: TorqueMotion,
    /// At each sample, N m s.
    sum: Vec<f64>,
    /// Steps longer than this are gaps, s.
    longest: f64,
}

impl<'a> Impulse<'a> {
    fn new(torque: &'a Channel, motion: TorqueMotion) -> Self {
        let (t, x) = (&torque.time_s, &torque.values);
        let step = |k: usize| {
            let mean = match motion {
                TorqueMotion::Held => x[k],
                TorqueMotion::Straight => 0.5 * (x[k] + x[k + 1]),
            };
            mean * (t[k + 1] - t[k])
        };
        let mut sum = vec![0.0];
        for k in 0..t.len().saturating_sub(1) {
            sum.push(sum[k] + step(k));
        }
        Self {
            torque,
            motion,
            sum,
            longest: GAP * median_step(t).unwrap_or(0.0),
        }
    }

    /// From the first sample to this time; nothing beyond the samples or within a gap.
    fn at(&self, time_s: f64) -> Option<f64> {
        let (t, x) = (&self.torque.time_s, &self.torque.values);
        let k = t.partition_point(|x| *x <= time_s).checked_sub(1)?;
        let since = time_s - t[k];
        let Some(next) = t.get(k + 1) else {
            let holds =
                since == 0.0 || (self.motion == TorqueMotion::Held && since <= self.longest);
            return holds.then(|| self.sum[k] + since * x[k]);
        };
        let step = next - t[k];
        let slope = match self.motion {
            TorqueMotion::Held => 0.0,
            TorqueMotion::Straight => (x[k + 1] - x[k]) / step,
        };
        (step <= self.longest).then(|| self.sum[k] + since * (x[k] + 0.5 * slope * since))
    }

    /// Whether no sample is missing between two times.
    fn is_whole(&self, from: f64, to: f64) -> Option<bool> {
        let t = &self.torque.time_s;
        let first = t.partition_point(|x| *x <= from).checked_sub(1)?;
        let past = t.partition_point(|x| *x < to);
        let inside = t.get(first..=past.min(t.len() - 1))?;
        Some(inside.windows(2).all(|w| w[1] - w[0] <= self.longest))
    }

    /// What it deviates at a time between two others from the straight line through both; nothing where samples are
    /// missing.
    fn deviation(&self, [from, to]: [f64; 2], time_s: f64) -> Option<f64> {
        let (first, last) = (self.at(from)?, self.at(to)?);
        let share = (time_s - from) / (to - from);
        let line = first + share * (last - first);
        self.is_whole(from, to)?.then_some(self.at(time_s)? - line)
    }
}

/// A tachometer sample against the straight line through its neighbours, and the torque's impulse against its own.
struct Prediction {
    speed: f64,
    impulse: f64,
    /// Variance for white noise of unit variance.
    variance: f64,
}

fn predictions(speed: &Channel, impulse: &Impulse) -> Vec<Prediction> {
    let triples = speed.time_s.windows(3).zip(speed.values.windows(3));
    let one = |(t, x): (&[f64], &[f64])| {
        let share = (t[1] - t[0]) / (t[2] - t[0]);
        Some(Prediction {
            speed: x[1] - x[0] - share * (x[2] - x[0]),
            impulse: impulse.deviation([t[0], t[2]], t[1])?,
            variance: 1.0 + share * share + (1.0 - share) * (1.0 - share),
        })
    };
    triples.filter_map(one).collect()
}

/// How the torque drives the speed, if it explains more of it than it leaves beyond the noise of the tachometer.
fn drive(read: &[(&Channel, &Channel)], noise: f64) -> Option<Drive> {
    let motions = [TorqueMotion::Held, TorqueMotion::Straight];
    let fits = motions.into_iter().filter_map(|motion| {
        let found: Vec<Prediction> = read
            .iter()
            .flat_map(|(speed, torque)| predictions(speed, &Impulse::new(torque, motion)))
            .collect();
        let n = found.len();
        let square: f64 = found.iter().map(|p| p.impulse * p.impulse).sum();
        if n < FEWEST || square == 0.0 {
            return None;
        }
        let scale = found.iter().map(|p| p.impulse * p.speed).sum::<f64>() / square;
        let errors = |scale: f64| -> f64 {
            let error = |p: &Prediction| (p.speed - scale * p.impulse).powi(2);
            found.iter().map(error).sum()
        };
        let (without, left) = (errors(0.0), errors(scale));
        let unit: f64 = found.iter().map(|p| p.variance).sum();
        // The Bayesian information criterion (Schwarz 1978) of one more number.
        let tells = n as f64 * (without / left).ln() > (n as f64).ln();
        let explained = without - left > left - noise * unit;
        let drive = Drive {
            motion,
            scale,
            scatter: left / unit,
        };
        (tells && explained).then_some((left / n as f64, drive))
    });
    fits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|f| f.1)
}

/// The speed at the samples of the tachometer, and at those of the torque where it bends.
fn bridge(speed: &Channel, impulse: &Impulse, drive: &Drive) -> Channel {
    let torque = &impulse.torque.time_s;
    let tolerance = BEND * drive.scatter.sqrt();
    let mut points = Vec::new();
    let pairs = speed.time_s.windows(2).zip(speed.values.windows(2));
    for (t, x) in pairs {
        points.push((t[0], x[0]));
        if impulse.deviation([t[0], t[1]], t[0]).is_none() {
            continue;
        }
        let from = torque.partition_point(|s| *s <= t[0]);
        let to = torque.partition_point(|s| *s < t[1]);
        let driven = torque
            .get(from..to)
            .unwrap_or_default()
            .iter()
            .filter_map(|&at| {
                let line = x[0] + (at - t[0]) / (t[1] - t[0]) * (x[1] - x[0]);
                Some((
                    at,
                    line + drive.scale * impulse.deviation([t[0], t[1]], at)?,
                ))
            });
        let all: Vec<_> = std::iter::once((t[0], x[0]))
            .chain(driven)
            .chain([(t[1], x[1])])
            .collect();
        points.extend(bends(&all, tolerance));
    }
    let last = speed.time_s.last().zip(speed.values.last());
    points.extend(last.map(|(t, x)| (*t, *x)));
    let (time_s, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    Channel {
        time_s: time_s.into(),
        values,
        ..speed.clone()
    }
}

/// The inner points between which straight lines pass all others within a tolerance (swinging door: Bristol 1990).
fn bends(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    let Some(mut start) = points.first().copied() else {
        return kept;
    };
    let open = (f64::NEG_INFINITY, f64::INFINITY);
    let mut door = open;
    for pair in points.windows(2).skip(1) {
        let (last, next) = (pair[0], pair[1]);
        let slope = |(t, x): (f64, f64), off: f64| (x + off - start.1) / (t - start.0);
        door = (
            door.0.max(slope(last, -tolerance)),
            door.1.min(slope(last, tolerance)),
        );
        let ahead = slope(next, 0.0);
        if ahead < door.0 || ahead > door.1 {
            kept.push(last);
            start = last;
            door = open;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, time_s: Vec<f64>, values: Vec<f64>) -> Channel {
        Channel {
            name: name.to_owned(),
            time_s: time_s.into(),
            values,
            ..Channel::default()
        }
    }

    /// Torque at 4 Hz, tachometer at 1 Hz; the torque has a wrong scale and an offset.
    fn record(motion: TorqueMotion) -> (Channel, Channel, impl Fn(f64) -> f64) {
        let times: Vec<f64> = (0..240).map(|k| 0.25 * f64::from(k)).collect();
        let torque: Vec<f64> = (0..240)
            .map(|k| (f64::from(k) * 0.9).sin() * 0.02)
            .collect();
        let measured = torque.iter().map(|x| 1.04 * x + 0.003).collect();
        let true_torque = channel("w_Nm", times.clone(), torque);
        let speed = move |t: f64| {
            let impulse = Impulse::new(&true_torque, motion).at(t).unwrap_or(f64::NAN);
            150.0 + impulse / 0.05 - 0.01 * t
        };
        let read: Vec<f64> = (0..58)
            .map(|k| 0.1 + f64::from(k) * 1.03)
            .filter(|t| *t < 59.0)
            .collect();
        let tachometer = channel(
            "w_rad_s",
            read.clone(),
            read.iter().map(|t| speed(*t)).collect(),
        );
        (tachometer, channel("w_Nm", times, measured), speed)
    }

    /// Against the speed in closed form, at the samples of the torque.
    #[test]
    fn exact_the_torque_gives_the_speed_between_tachometer_samples() {
        for motion in [TorqueMotion::Held, TorqueMotion::Straight] {
            let (tachometer, torque, speed) = record(motion);
            let drive = drive(&[(&tachometer, &torque)], 0.0).unwrap();
            assert_eq!(drive.motion, motion);
            assert!((drive.scale * 0.05 * 1.04 - 1.0).abs() < 1.0e-9);
            let bridged = bridge(&tachometer, &Impulse::new(&torque, motion), &drive);
            assert!(bridged.time_s.len() > 200);
            for (t, x) in bridged.time_s.iter().zip(&bridged.values) {
                assert!((x - speed(*t)).abs() < 1.0e-9, "{t}");
            }
        }
    }

    #[test]
    fn unit_a_torque_of_another_wheel_tells_nothing() {
        let (tachometer, torque, _) = record(TorqueMotion::Held);
        let other = (0..240).map(|k| (f64::from(k * k) * 0.37).sin()).collect();
        let other = channel("w_Nm", torque.time_s.to_vec(), other);
        assert!(drive(&[(&tachometer, &other)], 0.0).is_none());
    }

    #[test]
    fn unit_a_gap_in_the_torque_is_not_bridged() {
        let (tachometer, torque, _) = record(TorqueMotion::Held);
        let stays = |t: &f64| !(20.0..24.0).contains(t);
        let (time_s, values) = torque
            .time_s
            .iter()
            .zip(&torque.values)
            .filter(|(t, _)| stays(t))
            .unzip();
        let gap = channel("w_Nm", time_s, values);
        let drive = drive(&[(&tachometer, &gap)], 0.0).unwrap();
        let bridged = bridge(&tachometer, &Impulse::new(&gap, drive.motion), &drive);
        let inside = |t: &&f64| **t > 20.0 && **t < 24.0;
        let read = tachometer.time_s.iter().filter(inside).count();
        assert_eq!(bridged.time_s.iter().filter(inside).count(), read);
    }

    /// Every point lies within the tolerance of the lines through those that are kept.
    #[test]
    fn prop_lines_between_bends_pass_every_point() {
        let points: Vec<(f64, f64)> = (0..400)
            .map(|k| (f64::from(k), (f64::from(k) * 0.03).sin() * 5.0))
            .collect();
        let mut kept = vec![points[0]];
        kept.extend(bends(&points, 0.1));
        kept.push(points[399]);
        assert!(kept.len() < 60, "{}", kept.len());
        for (t, x) in points {
            let k = kept.partition_point(|p| p.0 <= t).clamp(1, kept.len() - 1);
            let (a, b) = (kept[k - 1], kept[k]);
            let line = a.1 + (t - a.0) / (b.0 - a.0) * (b.1 - a.1);
            assert!((line - x).abs() <= 0.1 + 1.0e-12);
        }
    }
}
