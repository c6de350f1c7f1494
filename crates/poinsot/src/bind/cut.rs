//! Cuts a record at gaps of its inputs, where the motion of wheels, joints and thrusters is unknown.
//!
//! Gaps of base sensors are allowed, since the equation of motion propagates the state. Each piece is a segment with a
//! separate initial state, and shares the bodies.

use super::channels::Channels;
use poinsot_telemetry::{Channel, GAP, Table, median_step};
use std::borrow::Cow;
use std::sync::Arc;

/// Joint, wheel and thrust channels that drive the motion.
pub(super) fn input_channels<'a>(channels: &Channels<'a>) -> Vec<&'a Channel> {
    let joints = channels.joints().flat_map(|joint| {
        // A rate without a position is not used; a locked joint needs none.
        let position = joint.moving();
        [position, position.and(joint.rate)]
    });
    let wheels = channels.tachometers();
    joints.chain(wheels).flatten().collect()
}

/// The pieces of a table between the gaps of its inputs, and the gaps, s; the table itself without gaps.
pub(super) fn pieces<'a>(
    channels: &Channels<'a>,
    clock: &[f64],
) -> (Vec<Cow<'a, Table>>, Vec<(f64, f64)>) {
    let mut inputs = input_channels(channels);
    // Thrust sampled with the gyro has the gyro's gaps; valve switching times are not samples.
    let thrust = channels.model.thrusters.iter();
    let thrust = thrust.filter_map(|t| channels.find(&format!("{}_N", t.name)));
    inputs.extend(thrust.filter(|c| *c.time_s == *clock));
    let gaps = merged(inputs.iter().flat_map(|c| gaps(&c.time_s)).collect());
    if gaps.is_empty() {
        return (vec![Cow::Borrowed(channels.table)], gaps);
    }
    let starts = std::iter::once(f64::NEG_INFINITY).chain(gaps.iter().map(|g| g.1));
    let ends = gaps.iter().map(|g| g.0).chain([f64::INFINITY]);
    let between = |(from, to)| Cow::Owned(piece(channels.table, from, to));
    (starts.zip(ends).map(between).collect(), gaps)
}

/// Gaps of a channel: the times of the samples before and after.
fn gaps(time_s: &[f64]) -> Vec<(f64, f64)> {
    let longest = GAP * median_step(time_s).unwrap_or(f64::INFINITY);
    let pairs = time_s.windows(2).filter(|w| w[1] - w[0] > longest);
    pairs.map(|w| (w[0], w[1])).collect()
}

/// Gaps in order of time; overlapping ones are merged.
fn merged(mut gaps: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    gaps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut all: Vec<(f64, f64)> = Vec::new();
    for (from, to) in gaps {
        match all.last_mut().filter(|last| from < last.1) {
            Some(last) => last.1 = last.1.max(to),
            None => all.push((from, to)),
        }
    }
    all
}

/// The samples of a table up to this time.
pub(crate) fn cut_at(table: &Table, end_s: f64) -> Table {
    piece(table, f64::NEG_INFINITY, end_s)
}

/// The samples of a table between two times, both included.
fn piece(table: &Table, from: f64, to: f64) -> Table {
    // Times of the previous channel: whole, and cut.
    let mut last: Option<[Arc<[f64]>; 2]> = None;
    let mut cut = |whole: &Channel| {
        let first = whole.time_s.partition_point(|t| *t < from);
        let past = whole.time_s.partition_point(|t| *t <= to).max(first);
        // Channels of one file share their time array.
        let shared = last.as_ref().filter(|s| Arc::ptr_eq(&s[0], &whole.time_s));
        let time_s = shared.map_or_else(|| whole.time_s[first..past].into(), |s| s[1].clone());
        last = Some([whole.time_s.clone(), time_s.clone()]);
        let channel = Channel {
            name: whole.name.clone(),
            sensor: whole.sensor.clone(),
            unit: whole.unit.clone(),
            frame: whole.frame.clone(),
            time_s,
            values: whole.values[first..past].to_vec(),
        };
        match first.checked_sub(1).filter(|_| whole.name.ends_with("_N")) {
            Some(before) => held(channel, from, whole.values[before]),
            None => channel,
        }
    };
    Table {
        channels: table.channels.iter().map(&mut cut).collect(),
        repairs: table.repairs.clone(),
        ignored: table.ignored.clone(),
        sources: table.sources.clone(),
        origin: table.origin,
    }
}

/// Thrust is sampled when it changes, so the value before the start of the piece still holds there.
fn held(mut channel: Channel, from: f64, value: f64) -> Channel {
    if channel.time_s.first().is_none_or(|t| *t > from) {
        let later = channel.time_s.iter().copied();
        channel.time_s = std::iter::once(from).chain(later).collect();
        channel.values.insert(0, value);
    }
    channel
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, samples: &[(f64, f64)]) -> Channel {
        Channel {
            name: name.to_owned(),
            time_s: samples.iter().map(|s| s.0).collect(),
            values: samples.iter().map(|s| s.1).collect(),
            ..Channel::default()
        }
    }

    #[test]
    fn unit_gaps_that_overlap_are_one() {
        assert_eq!(gaps(&[0.0, 1.0, 2.0, 6.0, 7.0]), [(2.0, 6.0)]);
        assert_eq!(gaps(&[0.0, 1.0, 2.0, 5.0, 6.0]), []);
        assert_eq!(gaps(&[1.0]), []);
        let all = vec![(8.0, 9.0), (2.0, 6.0), (5.0, 7.0)];
        assert_eq!(merged(all), [(2.0, 7.0), (8.0, 9.0)]);
    }

    #[test]
    fn unit_a_piece_holds_what_lies_between_and_the_valve_as_it_stood() {
        let table = Table {
            channels: vec![
                channel(
                    "wheel_rad_s",
                    &[(0.0, 1.0), (1.0, 2.0), (2.0, 3.0), (3.0, 4.0)],
                ),
                channel("jet_N", &[(0.5, 7.0), (2.5, 0.0)]),
            ],
            ..Table::default()
        };
        let cut = piece(&table, 1.0, 2.0);
        assert_eq!(*cut.channels[0].time_s, [1.0, 2.0]);
        assert_eq!(cut.channels[0].values, [2.0, 3.0]);
        assert_eq!(*cut.channels[1].time_s, [1.0]);
        assert_eq!(cut.channels[1].values, [7.0]);
        let first = piece(&table, f64::NEG_INFINITY, 1.0);
        assert_eq!(*first.channels[1].time_s, [0.5]);
    }
}
