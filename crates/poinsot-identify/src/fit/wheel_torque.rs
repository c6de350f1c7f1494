//! Wheels whose torque is a process: a third hypothesis on what they do between their samples.
//!
//! The torque of each wheel changes at random, several times between two samples, by amounts whose size the samples tell
//! ([`InputSamples`]). The mean of the motion that is left drives the prediction, and its error is a state of the filter.

use crate::fit::sampled_motion::{InputSample, InputSamples, SHARED, rounded};
use crate::motion::refined::{SAME_S, refined};
use crate::problem::Problem;
use crate::problem::segment::{
    BetweenReadings, InputChannel, InputErrors, InputRate, Observations, Segment,
};

/// Changes of the torque between two samples of a wheel. Half as many gave the same NEES for 40 tones at 2 Hz, and 6.50 instead of
/// 6.28 for 40 slews.
const CHANGES: usize = SHARED;

/// When a torque changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TorqueChanges {
    /// At the samples of its wheel: it is constant between them.
    AtSamples,
    /// [`CHANGES`] times between two samples.
    Anywhere,
}

/// Records in which the torque of every wheel is a process.
pub(crate) struct RandomTorque {
    pub segments: Vec<Segment>,
    /// -2 ln of the probability density of the tachometers' samples, less a constant.
    pub deviance: f64,
}

impl RandomTorque {
    /// `None` where it is not known when a wheel was read, or none has noise.
    pub fn new(problem: &Problem, changes: TorqueChanges) -> Option<Self> {
        let noise = &problem.noise.wheel_speed;
        let segments = problem.segments.iter();
        let found: Vec<(Segment, f64)> = segments
            .map(|s| driven_at_random(s, noise, changes))
            .collect::<Option<_>>()?;
        Some(Self {
            deviance: found.iter().map(|f| f.1).sum(),
            segments: found.into_iter().map(|f| f.0).collect(),
        })
    }

    /// The problem with these records.
    pub fn problem<'a>(&'a self, problem: &Problem<'a>) -> Problem<'a> {
        problem.with_segments(&self.segments)
    }
}

fn driven_at_random(
    segment: &Segment,
    noise: &[f64],
    changes: TorqueChanges,
) -> Option<(Segment, f64)> {
    let o = &segment.observations;
    let wheels = noise.len();
    let free = |o: &Observations, w: usize| o.is_smooth(w, true) && noise[w] > 0.0;
    let times: Vec<Vec<usize>> = (0..wheels)
        .filter(|w| free(o, *w))
        .map(|w| read_at(o, w))
        .collect::<Option<_>>()?;
    let anywhere = change_times(o, &times)?;
    let mut new = match changes {
        TorqueChanges::AtSamples => refined(o, &[]),
        TorqueChanges::Anywhere => refined(o, &anywhere),
    };
    let free = (0..wheels).filter(|w| free(o, *w));
    let mut deviance = 0.0;
    for (w, times) in free.zip(&times) {
        let independent = samples(o, w, times, noise[w], &new.time_s);
        let changes: Vec<f64> = match changes {
            TorqueChanges::Anywhere => new.time_s.iter().map(|t| nearest(&anywhere, *t)).collect(),
            TorqueChanges::AtSamples => {
                let mut at = vec![0.0; new.time_s.len()];
                independent.iter().for_each(|s| at[s.at] = 1.0);
                at
            }
        };
        let of = |samples| InputSamples {
            time_s: &new.time_s,
            changes: &changes,
            all_along: false,
            samples,
        };
        let (mut found, sizes) = of(&independent).most_probable()?;
        if let Some(rounded) = rounded(&independent) {
            found.errors = of(&rounded).posterior(&sizes)?.errors;
        }
        deviance += found.deviance;
        let column = new.wheel_speed.iter_mut().skip(w).step_by(wheels);
        column
            .zip(&found.mean.value)
            .for_each(|(to, from)| *to = *from);
        new.wheels[w].errors = InputErrors::Process(found.errors);
    }
    new.wheels.resize_with(wheels, InputChannel::default);
    let rate = match changes {
        TorqueChanges::AtSamples => InputRate::Straight,
        TorqueChanges::Anywhere => InputRate::Random,
    };
    new.wheels.iter_mut().for_each(|w| w.rate = rate);
    let segment = Segment {
        observations: new,
        ..segment.clone()
    };
    Some((segment, deviance))
}

/// The samples of a wheel, on the new grid.
fn samples(
    o: &Observations,
    w: usize,
    times: &[usize],
    variance: f64,
    grid: &[f64],
) -> Vec<InputSample> {
    let wheels = o.wheel_speed.len() / o.time_s.len().max(1);
    let one = |k: &usize| {
        let at = grid.partition_point(|t| *t < o.time_s[*k]);
        InputSample::white(at, o.wheel_speed[k * wheels + w], variance)
    };
    times.iter().map(one).collect()
}

/// Grid times at which a wheel is read; `None` where that is not known.
fn read_at(o: &Observations, w: usize) -> Option<Vec<usize>> {
    match &o.wheels.get(w)?.errors {
        InputErrors::Independent => Some((0..o.time_s.len()).collect()),
        InputErrors::Interpolated(places) => {
            let read = |p: &(usize, &BetweenReadings)| p.1.share == 0.0;
            let read = places.iter().enumerate().filter(read);
            Some(read.map(|(k, _)| k).collect())
        }
        InputErrors::Rounded(all) => {
            let read = all.iter().enumerate().filter(|(_, e)| e.read);
            Some(read.map(|(k, _)| k).collect())
        }
        _ => None,
    }
}

/// Times at which torques change: [`CHANGES`] in the mean interval of the wheel that is read most often.
fn change_times(o: &Observations, read: &[Vec<usize>]) -> Option<Vec<f64>> {
    let (from, to) = (o.time_s.first()?, o.time_s.last()?);
    let most = read.iter().map(Vec::len).max()?;
    let count = CHANGES * most.checked_sub(1).filter(|n| *n > 0)?;
    let step = (to - from) / count as f64;
    Some((1..count).map(|k| from + k as f64 * step).collect())
}

/// One where a grid time is one of these, or stands for one of them, zero elsewhere.
fn nearest(times: &[f64], t: f64) -> f64 {
    let after = times.partition_point(|x| *x < t);
    let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
    let found = near
        .filter_map(|k| times.get(k))
        .any(|x| (x - t).abs() < 2.0 * SAME_S);
    f64::from(u8::from(found))
}
