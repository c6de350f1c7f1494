//! Samples that repeat exactly: a stuck sensor, or one sampled faster than it measures.

use super::runs::{Sensor, noise_is_visible, repeats, runs};
use super::{Check, Finding};
use crate::{Channel, Table, conventions::BIAS};
use poinsot_files::as_read;

/// Number of equal consecutive samples that excludes chance in a noisy sensor.
const LONG: usize = 8;
/// Fraction of samples that may repeat by chance in a sensor without coarse quantisation.
const CHANCE: f64 = 0.02;
/// Largest step over smallest of a channel that counts steps of one size.
const ONE_STEP: f64 = 1.001;
/// Share of its usual rate from which a gyro turns.
const TURNS: f64 = 0.3;

pub(super) fn find(table: &Table, sensor: &Sensor, check: Check) -> Option<Finding> {
    let channels = table.at(&sensor.channels);
    let samples = channels.first()?.values.len();
    let all = runs(samples, |k| channels.iter().all(|c| repeats(c, k)));
    let times_s = channels.first()?.time_s.clone();
    let (stuck, text) = match check {
        Check::Held => slow(&all, samples)
            .filter(|_| !counts(&channels, &all))
            .or_else(|| rests_alone(table, &all, samples, sensor)),
        _ => hangs(&channels, samples, sensor),
    }?;
    let times = stuck.iter().filter_map(|&k| times_s.get(k).copied());
    Some(Finding {
        places: sensor.channels.clone(),
        ..Finding::new(check, &sensor.name, samples, times.collect(), text)
    })
}

/// Whether a channel alone counts steps of one size, as a coarse encoder does, which repeats although it is read each time.
fn counts(channels: &[&Channel], all: &[(usize, usize)]) -> bool {
    let [channel] = channels else { return false };
    let own = all.iter().filter_map(|&(k, _)| channel.values.get(k));
    let jumps = own.clone().zip(own.skip(1)).map(|(a, b)| (b - a).abs());
    let (least, most) = jumps.fold((f64::INFINITY, 0.0_f64), |(least, most), jump| {
        (least.min(jump), most.max(jump))
    });
    most < ONE_STEP * least
}

/// All channels of the sensor repeat in runs of one length: the column is sampled faster than the sensor.
fn slow(all: &[(usize, usize)], samples: usize) -> Option<(Vec<usize>, String)> {
    let repeated = samples - all.len();
    let share = repeated as f64 / samples as f64;
    if all.len() < 8 || !(0.4..0.98).contains(&share) {
        return None;
    }
    let mut lengths: Vec<usize> = all.iter().map(|r| r.1).collect();
    lengths.sort_unstable();
    let usual = lengths.get(lengths.len() / 2).copied()?;
    let regular = lengths.iter().filter(|l| l.abs_diff(usual) <= 1).count();
    if usual < 2 || regular * 10 < 9 * lengths.len() {
        return None;
    }
    // What rests for longer is read all the same.
    let of = |&(k, n): &(usize, usize)| (k + 1..k + n).filter(move |i| (i - k) % usual != 0);
    let text = format!(
        "each value is repeated {usual} times: the sensor is slower than its column; only the first sample of each is used"
    );
    Some((all.iter().flat_map(of).collect(), text))
}

/// One channel repeats a value exactly, but is noisy elsewhere.
fn hangs(channels: &[&Channel], samples: usize, sensor: &Sensor) -> Option<(Vec<usize>, String)> {
    let mut stuck: Vec<usize> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for channel in channels {
        let own = runs(samples, |k| repeats(channel, k)).into_iter();
        let (long, short): (Vec<_>, Vec<_>) = own.partition(|r| r.1 >= LONG);
        let outside: usize = short.iter().map(|r| r.1 - 1).sum();
        let free = short.iter();
        let free = free.flat_map(|&(k, n)| channel.values.get(k..k + n).unwrap_or_default());
        let free: Vec<f64> = free.copied().collect();
        // A quaternion is stuck only if all four components repeat.
        let noisy = free.len() >= 16
            && (outside as f64) < CHANCE * free.len() as f64
            && noise_is_visible(&free);
        if noisy && !long.is_empty() {
            stuck.extend(long.iter().flat_map(|&(k, n)| k + 1..k + n));
            let values = long.iter().filter_map(|&(k, _)| channel.values.get(k));
            let values: Vec<String> = values.take(3).map(|x| as_read(*x)).collect();
            names.push(format!("{} at {}", channel.name, values.join(", ")));
        }
    }
    if names.is_empty() || (sensor.is_attitude && names.len() < 4) {
        return None;
    }
    stuck.sort_unstable();
    stuck.dedup();
    let text = format!(
        "{} repeats exactly {LONG} times or more, although it is noisy elsewhere: the sensor is stuck",
        names.join("; ")
    );
    Some((stuck, text))
}

/// An attitude that repeats exactly while the gyro turns as elsewhere.
fn rests_alone(
    table: &Table,
    all: &[(usize, usize)],
    samples: usize,
    sensor: &Sensor,
) -> Option<(Vec<usize>, String)> {
    let times = &table.channels.get(*sensor.channels.first()?)?.time_s;
    let gyro = table.vector(None, "omega")?;
    let x = gyro.first()?;
    let mean = |run: &[(usize, usize)]| {
        let within = |t: f64| {
            let ends = |&(k, n): &(usize, usize)| Some((*times.get(k)?, *times.get(k + n - 1)?));
            run.iter().filter_map(ends).any(|(a, b)| a <= t && t <= b)
        };
        let kept = (0..x.values.len()).filter(|&k| within(x.time_s[k]));
        let square = |k: usize| -> f64 {
            let each = gyro.iter().filter_map(|c| c.values.get(k));
            each.map(|w| w * w).sum()
        };
        let squares: Vec<f64> = kept.map(square).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    };
    let long: Vec<(usize, usize)> = all.iter().copied().filter(|r| r.1 >= LONG).collect();
    let others: usize = all.iter().filter(|r| r.1 < LONG).map(|r| r.1 - 1).sum();
    if !sensor.is_attitude || long.is_empty() || others as f64 >= CHANCE * samples as f64 {
        return None;
    }
    // Without other samples a bias of the gyro is no turn.
    let least = match long.len() == all.len() {
        true => BIAS,
        false => TURNS * mean(&[(0, samples)]),
    };
    let held = long.into_iter().filter(|r| mean(&[*r]) > least);
    let stuck: Vec<usize> = held.flat_map(|(k, n)| k + 1..k + n).collect();
    let text = format!(
        "all four numbers repeat exactly {LONG} times or more while the gyro turns: the sensor holds its last value"
    );
    (!stuck.is_empty()).then_some((stuck, text))
}
