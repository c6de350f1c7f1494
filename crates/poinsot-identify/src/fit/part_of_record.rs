//! A part of a record: its beginning, or some of its samples.

use crate::problem::segment::{
    InputChannel, InputErrors, Observations, Segment, SensorRecord, SensorSample,
};

/// Samples per sensor in a segment that lead as close as all of them in a fraction of the time.
pub(crate) const FEW: usize = 128;
/// Largest step over readings: beyond it the motion between them may be lost.
const STRIDE: usize = 16;

/// A segment with a share of its readings, at least `few` of each sensor; `None` with instruments whose readings span intervals of the grid.
pub(crate) fn thinned(segment: &Segment, few: usize) -> Option<Segment> {
    if segment.observations.reads_points() {
        return None;
    }
    Some(at_times(segment, &kept(segment, few)))
}

/// The first part of a segment, a share of its grid times.
pub(crate) fn beginning(segment: &Segment, share: f64) -> Segment {
    let times = segment.observations.time_s.len();
    let first = ((times as f64 * share).ceil() as usize).clamp(2.min(times), times);
    if first == times {
        return segment.clone();
    }
    let kept: Vec<usize> = (0..first).collect();
    Segment {
        // Start of a fit.
        samples: segment.samples.clone(),
        ..at_times(segment, &kept)
    }
}

/// A segment at some of its grid times.
pub(crate) fn at_times(segment: &Segment, kept: &[usize]) -> Segment {
    let o = &segment.observations;
    let dof = o.joint_position.len() / o.time_s.len().max(1);
    let wheels = o.wheel_speed.len() / o.time_s.len().max(1);
    let errors = o.expected_errors.len() / o.time_s.len().max(1);
    let rows = |all: &[f64], width: usize| -> Vec<f64> {
        let mut rows = Vec::with_capacity(width * kept.len());
        for k in kept {
            rows.extend_from_slice(&all[k * width..(k + 1) * width]);
        }
        rows
    };
    let observations = Observations {
        time_s: picked(&o.time_s, kept),
        sensors: o.sensors.iter().map(|r| at_kept(r, kept)).collect(),
        orbit: picked(&o.orbit, kept),
        joint_position: rows(&o.joint_position, dof),
        joint_rate: rows(&o.joint_rate, dof),
        wheel_speed: rows(&o.wheel_speed, wheels),
        smooth_wheel_speed: Vec::new(),
        joints: at_kept_times(&o.joints, kept),
        wheels: at_kept_times(&o.wheels, kept),
        between_readings: o.between_readings,
        expected_errors: rows(&o.expected_errors, errors),
    };
    Segment {
        label: segment.label.clone(),
        observations,
        firings: segment.firings.clone(),
        ..Segment::default()
    }
}

/// Kept grid times: some samples of each sensor, both ends, and the edges of firings.
fn kept(segment: &Segment, few: usize) -> Vec<usize> {
    let o = &segment.observations;
    let n = o.time_s.len();
    let mut stays = vec![false; n];
    for record in &o.sensors {
        let stride = (record.samples.len() / few).clamp(1, STRIDE);
        let samples = record.samples.iter().step_by(stride);
        samples.for_each(|s| stays[s.to] = true);
    }
    let edges = segment.firings.iter().flat_map(|f| [f.start_s, f.end_s]);
    for edge in edges {
        let after = o.time_s.partition_point(|t| *t < edge);
        // An edge is a grid time to round-off: the neighbours on both sides are sure to hold it.
        stays[after.saturating_sub(1)..(after + 2).min(n)].fill(true);
    }
    (0..n)
        .filter(|&k| stays[k] || k == 0 || k + 1 == n)
        .collect()
}

/// The samples of a sensor at the grid times that stay, of which they then bear the places.
fn at_kept(record: &SensorRecord, kept: &[usize]) -> SensorRecord {
    let samples = record.samples.iter().filter_map(|s| {
        let to = kept.binary_search(&s.to).ok()?;
        let from = kept.binary_search(&s.from).unwrap_or(to);
        Some(SensorSample { from, to, ..*s })
    });
    record.with_samples(samples)
}

pub(super) fn picked<T: Clone>(all: &[T], kept: &[usize]) -> Vec<T> {
    kept.iter().filter_map(|k| all.get(*k).cloned()).collect()
}

fn at_kept_times(inputs: &[InputChannel], kept: &[usize]) -> Vec<InputChannel> {
    let at_kept = |i: &InputChannel| InputChannel {
        errors: errors(&i.errors, kept),
        rate: i.rate,
        acceleration: picked(&i.acceleration, kept),
        of_rates: picked(&i.of_rates, kept),
    };
    inputs.iter().map(at_kept).collect()
}

/// What is left of a correlation after the grid times in between.
fn errors(errors: &InputErrors, kept: &[usize]) -> InputErrors {
    match errors {
        InputErrors::Kept(_) | InputErrors::Rounded(_) => {}
        InputErrors::Interpolated(places) => {
            return InputErrors::Interpolated(picked(places, kept));
        }
        InputErrors::Process(process) => return InputErrors::Process(process.at_times(kept)),
        _ => return errors.clone(),
    }
    let between = |w: &[usize]| (w[0]..w[1]).map(|k| errors.memory(k)).product();
    let mut left: Vec<f64> = kept.windows(2).map(between).collect();
    left.push(0.0);
    InputErrors::Kept(left)
}
