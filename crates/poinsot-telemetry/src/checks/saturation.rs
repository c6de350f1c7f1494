//! Samples clipped at the end of a range.

use super::runs::{noise_is_visible, repeats, runs};
use crate::Channel;
use crate::median::ends;
use poinsot_files::as_read;

/// Consecutive samples at one end of the range.
const PLATEAU: usize = 3;
/// Total number of samples at the end of the range.
const ALL: usize = 6;

/// Runs of samples at the largest or smallest value, if no other value repeats.
pub(super) fn find(channel: &Channel) -> Option<(Vec<usize>, String)> {
    let values = &channel.values;
    let [smallest, largest] = ends(values);
    let at_end = |x: f64| x == largest || x == smallest;
    let all = runs(values.len(), |k| repeats(channel, k));
    let plateaus: Vec<(usize, usize)> = all
        .iter()
        .copied()
        .filter(|&(k, n)| n >= PLATEAU && values.get(k).is_some_and(|x| at_end(*x)))
        .collect();
    let cut: usize = plateaus.iter().map(|p| p.1).sum();
    let free: Vec<f64> = values.iter().copied().filter(|x| !at_end(*x)).collect();
    let repeated: usize = all
        .iter()
        .filter(|r| values.get(r.0).is_some_and(|x| !at_end(*x)))
        .map(|r| r.1 - 1)
        .sum();
    if cut < ALL || free.len() < 8 || repeated * 50 > free.len() {
        return None;
    }
    let corner = plateaus.iter().any(|&(k, n)| is_corner(values, k, n));
    if !corner && !noise_is_visible(&free) {
        return None;
    }
    let samples = plateaus.iter().flat_map(|&(k, n)| k..k + n).collect();
    let ([smallest, largest], unit) = ([smallest, largest].map(as_read), &channel.unit);
    let text = format!(
        "{cut} samples are at the end of the range ({smallest} to {largest} {unit}): the sensor is saturated"
    );
    Some((samples, text))
}

/// Whether the curve runs into the plateau with its full slope, as one that is cut does.
fn is_corner(values: &[f64], start: usize, length: usize) -> bool {
    let step = |a: usize, b: usize| Some((values.get(a)? - values.get(b)?).abs());
    let before = start
        .checked_sub(3)
        .and_then(|k| Some((step(start, start - 1)?, step(k + 1, k)?)));
    let end = start + length;
    let after = step(end, end - 1).zip(step(end + 2, end + 1));
    let sharp = |(into, further): (f64, f64)| further > 0.0 && into > 0.3 * further;
    before.is_some_and(sharp) || after.is_some_and(sharp)
}
