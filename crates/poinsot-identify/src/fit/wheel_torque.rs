//! Wheels whose torque is a process: a third hypothesis on what they do between their samples.
//!
//! The torque of each wheel changes all along by white noise, of a size that the samples tell ([`InputSamples`]). The mean of the
//! motion that is left drives the prediction, and its error is a state of the filter.

use crate::fit::sampled_motion::{Changes, InputSample, InputSamples, all_along, rounded};
use crate::problem::Problem;
use crate::problem::segment::{
    BetweenReadings, InputChannel, InputErrors, InputRate, Observations, Segment,
};

/// Records in which the torque of every wheel is a process.
pub(crate) struct RandomTorque {
    pub segments: Vec<Segment>,
    /// -2 ln of the probability density of the tachometers' samples, less a constant.
    pub deviance: f64,
}

impl RandomTorque {
    /// `None` where it is not known when a wheel was read, or none has noise.
    pub fn new(problem: &Problem, changes: Changes) -> Option<Self> {
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
}

fn driven_at_random(segment: &Segment, noise: &[f64], of: Changes) -> Option<(Segment, f64)> {
    let o = &segment.observations;
    let free = (0..noise.len()).filter(|w| o.is_smooth(*w, true) && noise[*w] > 0.0);
    let free: Vec<usize> = free.collect();
    let mut new = o.clone();
    new.wheels.resize_with(noise.len(), InputChannel::default);
    new.wheels
        .iter_mut()
        .for_each(|w| w.rate = InputRate::Straight);
    let mut deviance = 0.0;
    for w in free.iter().copied() {
        let times = read_at(o, w)?;
        let independent = samples(o, w, &times, noise[w]);
        let changes = changes(o, &times, of)?;
        let all = |samples| InputSamples {
            time_s: &o.time_s,
            changes: &changes,
            of,
            samples,
        };
        let (mut found, sizes) = all(&independent).most_probable()?;
        if let Some(rounded) = rounded(&independent) {
            found.errors = all(&rounded).posterior(&sizes)?.errors;
        }
        deviance += found.deviance;
        let column = new.wheel_speed.iter_mut().skip(w).step_by(noise.len());
        column
            .zip(&found.mean.value)
            .for_each(|(to, from)| *to = *from);
        let own = &mut new.wheels[w];
        own.errors = InputErrors::Process(found.errors);
        if of == Changes::Slope {
            (own.rate, own.acceleration) = (InputRate::Random, found.mean.slope);
        }
    }
    let segment = Segment {
        observations: new,
        ..segment.clone()
    };
    (!free.is_empty()).then_some((segment, deviance))
}

/// Changes before each grid time, over one in the mean interval of samples where they are all along.
fn changes(o: &Observations, read: &[usize], of: Changes) -> Option<Vec<f64>> {
    if of == Changes::SlopeAtTimes {
        let mut at = vec![0.0; o.time_s.len()];
        read.iter().for_each(|k| at[*k] = 1.0);
        return Some(at);
    }
    let span = o.time_s.last()? - o.time_s.first()?;
    let intervals = read.len().checked_sub(1).filter(|n| *n > 0)?;
    Some(all_along(&o.time_s, span / intervals as f64))
}

/// The samples of a wheel.
fn samples(o: &Observations, w: usize, times: &[usize], variance: f64) -> Vec<InputSample> {
    let wheels = o.wheel_speed.len() / o.time_s.len().max(1);
    let one = |k: &usize| InputSample::white(*k, o.wheel_speed[k * wheels + w], variance);
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
