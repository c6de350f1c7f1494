//! A segment on a grid with more times: the same motion, known at more instants.

use super::environment::orbit_between;
use super::inputs::{joint_between, row};
use crate::problem::error_process::{ErrorProcess, ErrorStep};
use crate::problem::segment::{
    BetweenReadings, InputChannel, InputErrors, Observations, SensorRecord, SensorSample,
};
use nalgebra::Matrix3;

/// Grid times closer than this are one, s.
pub(crate) const SAME_S: f64 = 1.0e-7;

/// Where a time of the new grid lies in the old one.
#[derive(Clone, Copy)]
struct Place {
    /// The last old grid time.
    k: usize,
    /// Share of the interval after it; zero at it.
    at: f64,
}

/// The observations with further grid times, of which those outside the record or beside an old one are left out. Joints and
/// orbit are on the curves between old grid times, wheel speeds on straight lines, and no error becomes a new one.
pub(crate) fn refined(o: &Observations, further_s: &[f64]) -> Observations {
    let places = places(&o.time_s, further_s);
    let n = o.time_s.len();
    let (dof, wheels) = (
        o.joint_position.len() / n.max(1),
        o.wheel_speed.len() / n.max(1),
    );
    let mut new = Observations {
        time_s: Vec::with_capacity(places.len()),
        joint_position: Vec::with_capacity(places.len() * dof),
        joint_rate: Vec::with_capacity(places.len() * dof),
        wheel_speed: Vec::with_capacity(places.len() * wheels),
        joints: at_places(&o.joints, &places, &o.time_s),
        wheels: at_places(&o.wheels, &places, &o.time_s),
        between_readings: o.between_readings || places.len() > n,
        ..Observations::default()
    };
    let mut old = Vec::with_capacity(n);
    for (i, place) in places.iter().enumerate() {
        let (k, at) = (place.k, place.at);
        if at == 0.0 {
            old.push(i);
            new.time_s.push(o.time_s[k]);
            new.orbit.extend(o.orbit.get(k));
            new.joint_position.extend(row(&o.joint_position, dof, k));
            new.joint_rate.extend(row(&o.joint_rate, dof, k));
            new.wheel_speed.extend(row(&o.wheel_speed, wheels, k));
            continue;
        }
        let h = o.time_s[k + 1] - o.time_s[k];
        new.time_s.push(o.time_s[k] + at * h);
        new.orbit.extend(orbit_between(o, k, at));
        for j in 0..dof {
            let (q, rate) = joint_between(o, (dof, j), (k, at));
            new.joint_position.push(q);
            new.joint_rate.push(rate);
        }
        for w in 0..wheels {
            let speed = |k: usize| o.wheel_speed[k * wheels + w];
            let (a, b) = (speed(k), speed(k + 1));
            new.wheel_speed.push(a + at * (b - a));
        }
    }
    new.sensors = o.sensors.iter().map(|r| moved(r, &old)).collect();
    new
}

/// All times of the new grid by their place in the old one.
fn places(time_s: &[f64], further_s: &[f64]) -> Vec<Place> {
    let mut further: Vec<f64> = further_s.to_vec();
    further.sort_by(f64::total_cmp);
    let mut further = further.into_iter().peekable();
    let mut all = Vec::with_capacity(time_s.len() + further_s.len());
    for (k, t) in time_s.iter().enumerate() {
        while further.next_if(|x| *x < t + SAME_S).is_some() {}
        all.push(Place { k, at: 0.0 });
        let Some(next) = time_s.get(k + 1) else {
            break;
        };
        let mut last = *t;
        while let Some(x) = further.next_if(|x| *x < next - SAME_S) {
            if x > last + SAME_S {
                all.push(Place {
                    k,
                    at: (x - t) / (next - t),
                });
                last = x;
            }
        }
    }
    all
}

/// The samples of a sensor at their new places.
fn moved(record: &SensorRecord, old: &[usize]) -> SensorRecord {
    let to = |k: usize| old.get(k).copied().unwrap_or(k);
    let samples = record.samples.iter().map(|s| SensorSample {
        from: to(s.from),
        to: to(s.to),
        ..*s
    });
    record.with_samples(samples)
}

fn at_places(inputs: &[InputChannel], places: &[Place], old_s: &[f64]) -> Vec<InputChannel> {
    let moved = |i: &InputChannel| InputChannel {
        errors: errors(&i.errors, places, old_s),
        rate: i.rate,
        acceleration: at_each(&i.acceleration, places, |a, b, p| a + p.at * (b - a)),
        of_rates: at_each(&i.of_rates, places, |a, b, p| {
            a.to(b, old_s[p.k + 1] - old_s[p.k], p.at)
        }),
    };
    inputs.iter().map(moved).collect()
}

/// Values of old grid times, and those between two of them.
fn at_each<T: Copy>(old: &[T], places: &[Place], between: impl Fn(&T, &T, &Place) -> T) -> Vec<T> {
    let value = |p: &Place| match (old.get(p.k), old.get(p.k + 1)) {
        (Some(a), Some(b)) => Some(between(a, b, p)),
        (a, _) => a.copied(),
    };
    places.iter().filter_map(value).collect()
}

/// The same errors, interpolated where there is no sample. A correlation is shared out over the parts of its interval.
fn errors(errors: &InputErrors, places: &[Place], old_s: &[f64]) -> InputErrors {
    match errors {
        InputErrors::Independent => {
            let place = |p: &Place| BetweenReadings {
                reading: p.k,
                share: p.at,
            };
            InputErrors::Interpolated(places.iter().map(place).collect())
        }
        InputErrors::Interpolated(old) => {
            let place = |p: &Place| {
                let a = old[p.k];
                let Some(b) = old.get(p.k + 1).filter(|_| p.at > 0.0) else {
                    return a;
                };
                let end = if b.reading > a.reading { 1.0 } else { b.share };
                BetweenReadings {
                    reading: a.reading,
                    share: a.share + p.at * (end - a.share),
                }
            };
            InputErrors::Interpolated(places.iter().map(place).collect())
        }
        InputErrors::Kept(_) | InputErrors::Rounded(_) => {
            let part = |pair: &[Place]| {
                let [a, b] = [pair[0], pair[1]];
                let end = if b.k > a.k { 1.0 } else { b.at };
                errors.memory(a.k).powf(end - a.at)
            };
            let mut memory: Vec<f64> = places.windows(2).map(part).collect();
            memory.push(0.0);
            InputErrors::Kept(memory)
        }
        InputErrors::Process(process) => {
            let part = |pair: &[Place]| step(process, [pair[0], pair[1]], old_s);
            InputErrors::Process(ErrorProcess::new(
                process.initial,
                places.windows(2).map(part),
            ))
        }
        other => other.clone(),
    }
}

/// From place to place: until the end of an interval an error goes on along its slope, and what is new is added there.
fn step(process: &ErrorProcess, [a, b]: [Place; 2], old_s: &[f64]) -> ErrorStep {
    let h = old_s[a.k + 1] - old_s[a.k];
    let line = |share: f64| {
        let s = share * h;
        Matrix3::new(1.0, s, 0.5 * s * s, 0.0, 1.0, s, 0.0, 0.0, 1.0)
    };
    match process.step(a.k).filter(|_| b.k > a.k) {
        Some(whole) => ErrorStep {
            memory: whole.memory * line(-a.at),
            ..whole
        },
        None => ErrorStep {
            memory: line(b.at - a.at),
            fresh: Matrix3::zeros(),
        },
    }
}
