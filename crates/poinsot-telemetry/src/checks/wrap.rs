//! Channels that begin anew at a value: angles within one turn, counters, and integers of a two's complement read as unsigned.

use super::{Check, Finding};
use crate::median::{ends, median};
use crate::{Change, Channel, Repair, common_step};
use poinsot_files::rounded;
use std::f64::consts::TAU;

/// Fewest samples that tell.
const FEW: usize = 16;
/// Steps, in typical ones, from which a step is a jump, and to which it falls where the channel is continued.
const JUMP: f64 = 20.0;
const CONTINUED: f64 = 10.0;
/// Widths of integers, bits.
const WIDTHS: std::ops::RangeInclusive<i32> = 8..=32;
/// Share of a period that the values of a channel cover about its ends.
const ENDS: f64 = 0.1;
/// Deviation of a multiple of the least step, in steps.
const OFF_STEP: f64 = 0.01;

pub(super) fn find(channel: &Channel) -> Option<Finding> {
    let v = &channel.values;
    let steps: Vec<f64> = v.windows(2).map(|w| w[1] - w[0]).collect();
    let sizes = steps.iter().map(|d| d.abs()).filter(|d| *d > 0.0);
    let typical = median(&mut sizes.collect::<Vec<_>>())?;
    let largest = steps.iter().fold(0.0_f64, |a, d| a.max(d.abs()));
    // A quaternion may change its sign.
    if v.len() < FEW || largest < JUMP * typical || channel.unit == "1" {
        return None;
    }
    let turn = (channel.unit == "rad").then_some((TAU, Change::WrapsAt(TAU)));
    let step = least_step(v);
    let of_counts = |n: i32| {
        let range = step? * 2.0_f64.powi(n);
        let signed = v
            .iter()
            .map(|x| x - range * f64::from(u8::from(*x >= 0.5 * range)));
        let signed: Vec<f64> = signed.collect();
        // Signed integers do not jump; a counter still does.
        let jumps = signed.windows(2).any(|w| (w[1] - w[0]).abs() > 0.5 * range);
        let change = match jumps {
            true => Change::WrapsAt(range),
            false => Change::SignedRange(range),
        };
        Some((range, change))
    };
    let mut periods = turn.into_iter().chain(WIDTHS.filter_map(of_counts));
    let (period, change) = periods.find(|p| begins_anew(v, &steps, p.0, (typical, largest)))?;
    let jumps: Vec<usize> = (1..v.len())
        .filter(|&k| steps[k - 1].abs() > 0.5 * period)
        .collect();
    let what = match change {
        Change::WrapsAt(TAU) => "the angle jumps by one turn; write wraps_at in its column of the map (360 for a column in deg, 6.283185307 in rad)".to_owned(),
        _ => {
            let (what, key) = match change {
                Change::WrapsAt(_) => ("a counter that begins anew", "wraps_at"),
                _ => ("a signed integer read as unsigned", "signed_range"),
            };
            format!(
                "the values jump by {} {}, {} of their steps: {what}; write that range as {key} in its column of the map, in the numbers of the column",
                rounded(period, 6),
                channel.unit,
                (period / step.unwrap_or(period)).round()
            )
        }
    };
    let found = Finding::of_channel(Check::Wrap, channel, (jumps, what));
    Some(Finding {
        repair: Some(Repair::of(&found.channel, change)),
        ..found
    })
}

/// The step of which all values are multiples.
fn least_step(v: &[f64]) -> Option<f64> {
    let [low, high] = ends(v);
    let size = low.abs().max(high.abs());
    let step = common_step(v, 1, 1.0e-9 * size, |n| OFF_STEP * (1.0 + n))?;
    // The whole range tells it better than one difference.
    let step = (high - low) / ((high - low) / step).round();
    let off = |x: &f64| ((x - low) / step - ((x - low) / step).round()).abs();
    let even = OFF_STEP.max(1.0e-9 * size / step);
    v.iter().all(|x| off(x) < even).then_some(step)
}

/// Whether the channel stays within one period, jumps only between its ends, and is continuous when it is continued there.
fn begins_anew(v: &[f64], steps: &[f64], period: f64, (typical, largest): (f64, f64)) -> bool {
    let [low, high] = ends(v);
    let within = high - low < (1.0 + 1.0e-9) * period && high - low > (1.0 - ENDS) * period;
    let jumps = steps
        .iter()
        .zip(v.windows(2))
        .filter(|(d, _)| d.abs() > 0.5 * period);
    let between = |w: &[f64]| {
        let (a, b) = (w[0].min(w[1]), w[0].max(w[1]));
        a - low < ENDS * period && high - b < ENDS * period
    };
    let continued = steps
        .iter()
        .map(|d| (d - period * (d / period).round()).abs());
    let most = continued.fold(0.0, f64::max);
    let mut count = 0;
    let at_ends = jumps.inspect(|_| count += 1).all(|(_, w)| between(w));
    within && at_ends && count > 0 && most < (CONTINUED * typical).max(0.05 * largest)
}
