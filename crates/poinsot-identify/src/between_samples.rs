//! What the motors do between the samples of the tachometers: hypotheses, chosen by evidence.
//!
//! A reaction wheel's torque is constant between commands, and when those come is mostly not in the telemetry. Each
//! hypothesis says at which times the torque may jump; how much it jumps is fitted to the tachometers
//! ([`crate::wheel_process`]). Evidence is `-2 ln L` of all samples, what was fitted integrated out
//! ([`crate::deviance`]).

use crate::deviance::{deviance, deviance_at};
use crate::fit::{Fitted, ITERATIONS, Local, fit_on};
use crate::information::{Experiment, Point};
use crate::problem::Problem;
use crate::refined_grid::refined;
use crate::segment::{Segment, Tachometer};
use crate::wheel_process::{Track, WheelProcess};
use poinsot_solve::{LeastSquares, Linearised};

/// Shift of the answer between straight and smooth speeds, sigmas, up to which the data are not asked where the wheels
/// are sampled together with all other sensors.
pub(crate) const UNASKED: f64 = 1.0;
/// Difference of `-2 ln L` within which two hypotheses are both possible, and of their answers, sigmas, from which it counts.
const POSSIBLE: f64 = 6.0;
const DIFFERENT: f64 = 0.3;
/// Largest growth of a sigma that counts as none.
const SAME_SIGMA: f64 = 0.05;

/// Periods of commands that are tried, s: flight computers run at round rates. In between the period is fitted.
const PERIODS: [f64; 17] = [
    0.04, 0.05, 0.1, 0.125, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 0.8, 1.0, 1.5, 2.0, 4.0, 5.0,
];
/// Periods of commands over the step of the tachometers: least and most that can be told.
const RATIO: (f64, f64) = (0.24, 12.0);
/// Phases tried of each period, and of the best the finest share of it.
const PHASES: usize = 16;
const FINEST: f64 = 2.0e-3;
/// Lattices of which the sensors are asked.
const ASKED: usize = 6;
/// Most samples of a wheel with which periods are searched.
const SEARCHED: usize = 600;
/// Parts of a tachometer's step in which a wandering torque is constant.
const FINE: f64 = 4.0;
/// Steps of expectation and maximisation: from nothing, and from what torques that jump at the samples gave.
const ROUNDS: (usize, usize) = (30, 4);
/// Samples over which the first trend lasts.
const LASTING: f64 = 5.0;
/// White noise of a tachometer that counts as exact, over the range of its speed, and over its rounding.
const SILENT: f64 = 1.0e-6;

/// When the torque of the wheels may jump.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Torque {
    /// At the samples of each wheel's own tachometer.
    AtSamples,
    /// Every so many seconds, for all wheels, from a phase of each segment on.
    Lattice { period_s: f64, phase_s: Vec<f64> },
    /// At any time.
    Wanders,
}

impl Torque {
    pub fn words(&self) -> String {
        match self {
            Self::AtSamples => "wheel torque constant between samples (zero-order hold)".to_owned(),
            Self::Lattice { period_s, .. } => format!(
                "wheel torque constant between commands every {period_s:.4} s; period and phase fitted to the tachometers"
            ),
            Self::Wanders => "wheel torque a random walk between samples".to_owned(),
        }
    }
}

/// A problem whose wheels are processes.
pub(crate) struct Driven {
    pub segments: Vec<Segment>,
    pub wheels: Vec<WheelProcess>,
    pub torque: Torque,
}

impl Driven {
    /// The same question about these wheels.
    pub fn problem<'b>(&'b self, problem: &Problem<'b>) -> Problem<'b> {
        Problem {
            segments: &self.segments,
            ..*problem
        }
    }

    /// The experiment about them.
    pub fn experiment<'b>(
        &'b self,
        of: &'b Experiment,
        problem: &'b Problem<'b>,
    ) -> Experiment<'b> {
        let mut experiment = of.with_problem(problem);
        experiment.wheels = &self.wheels;
        experiment.wheels_smooth = false;
        experiment
    }

    fn new(problem: &Problem, searched: &[Searched], torque: Torque) -> Self {
        let (mut segments, mut wheels) = (Vec::new(), Vec::new());
        for (at, (segment, searched)) in problem.segments.iter().zip(searched).enumerate() {
            let noise = &problem.noise.wheel_speed;
            let (segment, process) = driven(segment, (noise, searched), &torque, at);
            segments.push(segment);
            wheels.push(process);
        }
        Self {
            segments,
            wheels,
            torque,
        }
    }
}

/// What was found of the wheels.
pub(crate) struct Chosen {
    pub driven: Driven,
    pub fitted: Fitted,
    /// Largest shift of the answer to another possible hypothesis, sigmas, and that hypothesis; none where all agree.
    pub other: Option<(f64, Torque)>,
    /// Changes of nuisances and mass properties to the possible hypotheses that differ.
    pub changes: Vec<Vec<f64>>,
}

/// Whether every segment has tachometers.
pub(crate) fn has_tachometers(problem: &Problem) -> bool {
    let wheels = problem.tree.rotors.len();
    let whole = |s: &Segment| {
        s.tachometers.len() == wheels && s.tachometers.iter().all(|t| t.time_s.len() > 2)
    };
    wheels > 0 && problem.segments.iter().all(whole)
}

/// Whether any sensor has a sample where some wheel has none.
pub(crate) fn is_sampled_elsewhere(problem: &Problem) -> bool {
    problem.segments.iter().any(|s| {
        let o = &s.observations;
        let points = o.points.iter().flat_map(|p| &p.readings).map(|r| r.to);
        let read = (0..o.time_s.len()).filter(|k| {
            let base = o.rate[*k].is_some() || o.velocity[*k].is_some();
            base || o.attitude[*k].is_some() || o.position[*k].is_some()
        });
        let times: Vec<f64> = read.chain(points).map(|k| o.time_s[k]).collect();
        let mut all = s.tachometers.iter();
        all.any(|t| times.iter().any(|k| nearest(&t.time_s, *k).is_none()))
    })
}

/// Asks the data what the motors did. `None` where it does not matter, or the wheels' samples are too few.
pub(crate) fn choose(experiment: &Experiment, fast: &Fitted, is_held: bool) -> Option<Chosen> {
    let problem = experiment.problem;
    if !has_tachometers(problem) || !fast.settled || !fast.is_close() {
        return None;
    }
    let noise = &problem.noise.wheel_speed;
    let searched: Vec<Searched> = problem
        .segments
        .iter()
        .map(|s| Searched::new(s, noise))
        .collect();
    let of = |torque| Driven::new(problem, &searched, torque);
    let free = Tried::at(experiment, of(Torque::Wanders), &fast.at)?;
    if fast.shared.length(&free.step) < DIFFERENT && free.widens(fast) < SAME_SIGMA {
        return None;
    }
    let mut tried: Vec<Tried> = candidates(problem, &searched)
        .into_iter()
        .filter_map(|torque| Tried::at(experiment, of(torque), &fast.at))
        .collect();
    tried.push(free);
    tried.sort_by(|a, b| a.evidence.total_cmp(&b.evidence));
    let best = tried.first()?;
    let clear = tried
        .iter()
        .skip(1)
        .all(|t| t.evidence > best.evidence + POSSIBLE);
    if clear && best.driven.torque == Torque::AtSamples && is_held {
        return None;
    }
    let mut tried = tried.into_iter();
    let mut best = tried.next()?;
    if let Torque::Lattice { .. } = best.driven.torque {
        best = sharpened(experiment, &searched, best, &fast.at);
    }
    let own = best.driven.problem(problem);
    let (fitted, evidence) = {
        let here = best.driven.experiment(experiment, &own);
        let from = here.linearise(&fast.at)?;
        let fitted = fit_on(&here, fast.at.clone(), from, ITERATIONS)?;
        let evidence = deviance(&here, &fitted);
        (fitted, evidence)
    };
    let mut other: Option<(f64, Torque)> = None;
    let mut changes = Vec::new();
    let rivals: Vec<Driven> = tried
        .filter(|t| t.evidence <= evidence + POSSIBLE)
        .map(|t| t.driven)
        .collect();
    for rival in rivals {
        let Some(found) = Tried::at(experiment, rival, &fitted.at) else {
            continue;
        };
        let shift = fitted.shared.length(&found.step);
        if found.evidence > evidence + POSSIBLE || shift < DIFFERENT {
            continue;
        }
        changes.push(found.step);
        if other.as_ref().is_none_or(|o| o.0 < shift) {
            other = Some((shift, found.driven.torque));
        }
    }
    Some(Chosen {
        driven: best.driven,
        fitted,
        other,
        changes,
    })
}

/// A hypothesis as it looks from a point.
struct Tried {
    driven: Driven,
    evidence: f64,
    /// Full step of the shared unknowns.
    step: Vec<f64>,
    singular: Vec<f64>,
}

impl Tried {
    fn at(experiment: &Experiment, driven: Driven, at: &Point) -> Option<Self> {
        let (evidence, step, singular) = {
            let problem = driven.problem(experiment.problem);
            let here = driven.experiment(experiment, &problem);
            let found = here.linearise(at)?;
            (
                evidence(&here, at, &found),
                found.rows.full_step(),
                found.rows.spectrum().singular.clone(),
            )
        };
        tracing::debug!(torque = ?driven.torque, evidence);
        Some(Self {
            driven,
            evidence,
            step,
            singular,
        })
    }

    /// By what share a sigma of the plain fit is too small.
    fn widens(&self, fast: &Fitted) -> f64 {
        let pairs = self.singular.iter().zip(&fast.spectrum.singular);
        let rank = fast.spectrum.rank;
        pairs
            .take(rank)
            .map(|(own, plain)| plain / own - 1.0)
            .fold(0.0, f64::max)
    }
}

/// `-2 ln L` at the end of the full step.
fn evidence(experiment: &Experiment, at: &Point, found: &Linearised<Local>) -> f64 {
    let (evaluated, shared, spectrum) = found.rows.all();
    deviance_at(experiment, at, evaluated, (shared, spectrum)) - found.promised
}

fn candidates(problem: &Problem, searched: &[Searched]) -> Vec<Torque> {
    let mut list = vec![Torque::AtSamples];
    list.extend(lattices(problem, searched));
    list
}

/// The phase that all sensors together prefer.
fn sharpened(experiment: &Experiment, searched: &[Searched], mut best: Tried, at: &Point) -> Tried {
    let Torque::Lattice { period_s, .. } = best.driven.torque else {
        return best;
    };
    let mut step = period_s / (2 * PHASES) as f64;
    while step > FINEST * period_s {
        let moved = [step, -step].into_iter().find_map(|d| {
            let Torque::Lattice { period_s, phase_s } = &best.driven.torque else {
                return None;
            };
            let torque = Torque::Lattice {
                period_s: *period_s,
                phase_s: phase_s.iter().map(|p| p + d).collect(),
            };
            let driven = Driven::new(experiment.problem, searched, torque);
            let found = Tried::at(experiment, driven, at)?;
            (found.evidence < best.evidence).then_some(found)
        });
        match moved {
            Some(better) => best = better,
            None => step *= 0.5,
        }
    }
    best
}

/// Lattices that the tachometers alone prefer, the best first.
fn lattices(problem: &Problem, tracks: &[Searched]) -> Vec<Torque> {
    let Some(step) = problem
        .segments
        .iter()
        .filter_map(typical_step)
        .reduce(f64::max)
    else {
        return Vec::new();
    };
    let mut periods: Vec<f64> = PERIODS.to_vec();
    periods.extend([0.25, 1.0 / 3.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0].map(|x| x * step));
    periods.retain(|p| (RATIO.0 * step..=RATIO.1 * step).contains(p));
    periods.sort_by(f64::total_cmp);
    periods.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1.0e-3);
    let mut found: Vec<(f64, f64, Vec<f64>)> = Vec::new();
    for period in periods {
        let phases = (0..PHASES).map(|i| (i as f64 + 0.5) / PHASES as f64 * period);
        let mut total = 0.0;
        let mut best = Vec::new();
        for track in tracks {
            let costs = phases
                .clone()
                .map(|phase| (track.cost(period, phase), phase));
            let Some((cost, phase)) = costs.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            let (cost, phase) = track.sharpened(period, (cost, phase));
            total += cost;
            best.push(phase);
        }
        found.push((total, period, best));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(ASKED);
    found
        .into_iter()
        .map(|(_, period, phase_s)| refined_period(tracks, period, phase_s))
        .collect()
}

/// The period fitted with its phases: a record of many periods tells it far better than its round value may be kept.
fn refined_period(tracks: &[Searched], mut period: f64, mut phases: Vec<f64>) -> Torque {
    let total = |period: f64, phases: &[f64]| -> f64 {
        let pairs = tracks.iter().zip(phases);
        pairs.map(|(t, phase)| t.cost(period, *phase)).sum()
    };
    let mut best = total(period, &phases);
    let count = tracks.iter().map(|t| t.span() / period).fold(1.0, f64::max);
    // The last knot may move by half a period.
    let mut step = 0.25 * period / count;
    while step > FINEST * period / count {
        let mut moved = false;
        for d in [step, -step] {
            // About the middle of each record, so that period and phase do not trade.
            let turned: Vec<f64> = tracks
                .iter()
                .zip(&phases)
                .map(|(t, phase)| phase - d * (0.5 * t.span() / period).round())
                .collect();
            let cost = total(period + d, &turned);
            // A round period is left only for evidence.
            if cost < best - 2.0 {
                (best, period, phases) = (cost, period + d, turned);
                moved = true;
                break;
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    Torque::Lattice {
        period_s: period,
        phase_s: phases,
    }
}

/// How much a wheel's torque changes, from torques that jump at its samples: variance a second.
struct Roughness {
    time_s: Vec<f64>,
    of: Vec<[f64; 2]>,
}

impl Roughness {
    fn new(tachometer: &Tachometer, variance: f64) -> Self {
        let times = &tachometer.time_s;
        let mut track = track(tachometer, variance, times, (times, None));
        track.fit_jumps(ROUNDS.0);
        let jumping = (0..times.len()).filter(|k| track.lasted[*k] > 0.0);
        let (time_s, of) = jumping
            .map(|k| (times[k], track.jumps[k].map(|q| q / track.lasted[k])))
            .unzip();
        Self { time_s, of }
    }

    fn at(&self, t: f64) -> [f64; 2] {
        let after = self.time_s.partition_point(|x| *x < t);
        let at = after.min(self.of.len().saturating_sub(1));
        self.of.get(at).copied().unwrap_or_default()
    }
}

/// The tachometers of a segment, and their busiest part, in which periods are searched.
struct Searched {
    roughness: Vec<Roughness>,
    from: f64,
    to: f64,
    origin: f64,
    wheels: Vec<Track>,
}

impl Searched {
    fn new(segment: &Segment, noise: &[f64]) -> Self {
        let origin = segment.observations.time_s.first().copied().unwrap_or(0.0);
        let (from, to) = busiest(segment);
        let pairs = || segment.tachometers.iter().zip(noise);
        let wheels = pairs().map(|(t, variance)| {
            let grid = within(&t.time_s, from, to);
            track(t, *variance, &grid, (&[], None))
        });
        Self {
            roughness: pairs()
                .map(|(t, variance)| Roughness::new(t, *variance))
                .collect(),
            wheels: wheels.collect(),
            from,
            to,
            origin,
        }
    }

    fn span(&self) -> f64 {
        self.to - self.origin
    }

    fn cost(&self, period: f64, phase: f64) -> f64 {
        let knots = knots(self.origin + phase, period, (self.from, self.to));
        let wheels = self.wheels.iter().zip(&self.roughness);
        wheels
            .map(|(wheel, roughness)| with_knots(wheel, &knots, roughness).cost())
            .sum()
    }

    fn sharpened(&self, period: f64, mut best: (f64, f64)) -> (f64, f64) {
        let mut step = 0.5 * period / PHASES as f64;
        while step > 4.0 * FINEST * period {
            let tried = [step, -step].map(|d| (self.cost(period, best.1 + d), best.1 + d));
            match tried.into_iter().find(|t| t.0 < best.0) {
                Some(better) => best = better,
                None => step *= 0.5,
            }
        }
        best
    }
}

/// First and last time of as many samples as are searched, where the wheels' acceleration changes most.
fn busiest(segment: &Segment) -> (f64, f64) {
    let ends = |t: &[f64]| (t.first().copied(), t.last().copied());
    let Some(longest) = segment.tachometers.iter().max_by_key(|t| t.time_s.len()) else {
        return (0.0, 0.0);
    };
    let t = &longest.time_s;
    if t.len() <= SEARCHED {
        let (first, last) = ends(t);
        return (first.unwrap_or(0.0), last.unwrap_or(0.0));
    }
    let mut change = vec![0.0; t.len()];
    for wheel in &segment.tachometers {
        let (t, y) = (&wheel.time_s, &wheel.speed);
        let slope = |k: usize| (y[k + 1] - y[k]) / (t[k + 1] - t[k]);
        for k in 1..t.len().min(change.len()) - 1 {
            change[k] += (slope(k) - slope(k - 1)).powi(2);
        }
    }
    let mut sum: f64 = change[..SEARCHED].iter().sum();
    let mut best = (sum, 0);
    for k in SEARCHED..change.len() {
        sum += change[k] - change[k - SEARCHED];
        if sum > best.0 {
            best = (sum, k + 1 - SEARCHED);
        }
    }
    (t[best.1], t[best.1 + SEARCHED - 1])
}

fn within(time_s: &[f64], from: f64, to: f64) -> Vec<f64> {
    let inside = time_s.iter().copied();
    inside.filter(|t| *t >= from && *t <= to).collect()
}

fn typical_step(segment: &Segment) -> Option<f64> {
    let of = |t: &Tachometer| {
        let mut steps: Vec<f64> = t.time_s.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied()
    };
    segment.tachometers.iter().filter_map(of).reduce(f64::max)
}

/// Times of a lattice within two others.
fn knots(anchor: f64, period: f64, (from, to): (f64, f64)) -> Vec<f64> {
    let first = ((from - anchor) / period).ceil();
    let count = ((to - anchor) / period).floor() - first + 1.0;
    (0..count.max(0.0) as usize)
        .map(|k| anchor + (first + k as f64) * period)
        .collect()
}

/// Place of a time among others, to a microsecond.
fn nearest(times: &[f64], t: f64) -> Option<usize> {
    let after = times.partition_point(|x| *x < t - 1.0e-6);
    times
        .get(after)
        .filter(|x| (*x - t).abs() <= 1.0e-6)
        .map(|_| after)
}

/// Samples of a tachometer on a grid that holds their times; torque jumps at the knots among them.
fn track(
    tachometer: &Tachometer,
    variance: f64,
    grid: &[f64],
    (knots, roughness): (&[f64], Option<&Roughness>),
) -> Track {
    let (t, y) = (&tachometer.time_s, &tachometer.speed);
    let mut samples = vec![None; grid.len()];
    let mut read = Vec::new();
    for (i, time) in t.iter().enumerate() {
        if let Some(k) = nearest(grid, *time) {
            let memory = i
                .checked_sub(1)
                .map_or(0.0, |b| tachometer.errors.memory(b));
            samples[k] = Some((y[i], memory));
            read.push(i);
        }
    }
    let all = || read.iter().map(|i| y[*i]);
    let range = all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min);
    let range = range.max(0.0) + 10.0 * variance.sqrt() + f64::MIN_POSITIVE.sqrt();
    let steepest = read
        .windows(2)
        .map(|w| ((y[w[1]] - y[w[0]]) / (t[w[1]] - t[w[0]])).abs())
        .fold(0.0, f64::max);
    // A trend that lasts for some samples.
    let apart = LASTING * (t[t.len() - 1] - t[0]).max(f64::MIN_POSITIVE) / t.len() as f64;
    let kept = (0..t.len()).any(|k| tachometer.errors.memory(k) > 0.0);
    let silent = (SILENT * range).powi(2);
    let (noise, rounding) = match kept {
        true => (silent.max(SILENT * variance), variance),
        false => (variance.max(silent), 0.0),
    };
    let first = read.first().map_or(0.0, |i| y[*i]);
    let plain = Track {
        lasted: vec![0.0; grid.len()],
        jumps: vec![[0.0; 2]; grid.len()],
        time_s: grid.to_vec(),
        samples,
        noise,
        rounding,
        first,
        start: [
            range,
            steepest.max(silent.sqrt()),
            steepest.max(silent.sqrt()) / apart,
        ],
    };
    let mut track = plain;
    jump_at(&mut track, knots, roughness);
    track
}

/// Lets the torque jump at times that are on the grid of a track.
fn jump_at(track: &mut Track, knots: &[f64], roughness: Option<&Roughness>) {
    let mut before = track.time_s.first().copied().unwrap_or(0.0);
    let [_, torque, trend] = track.start.map(|s| s * s);
    let span = track
        .time_s
        .last()
        .map_or(1.0, |t| t - before)
        .max(f64::MIN_POSITIVE);
    for knot in knots {
        let Some(k) = nearest(&track.time_s, *knot).filter(|k| *k > 0) else {
            continue;
        };
        let lasted = track.time_s[k] - before;
        if lasted > 0.0 {
            track.lasted[k] = lasted;
            let a_second = match roughness {
                Some(known) => known.at(track.time_s[k]),
                None => [torque / span, trend / span],
            };
            track.jumps[k] = a_second.map(|q| q * lasted);
            before = track.time_s[k];
        }
    }
}

/// A track with more times on its grid, at which the torque jumps.
fn with_knots(track: &Track, knots: &[f64], roughness: &Roughness) -> Track {
    let mut all: Vec<(f64, Option<(f64, f64)>)> = track
        .time_s
        .iter()
        .copied()
        .zip(track.samples.iter().copied())
        .collect();
    let new = knots
        .iter()
        .filter(|t| nearest(&track.time_s, **t).is_none());
    all.extend(new.map(|t| (*t, None)));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (time_s, samples): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let mut track = Track {
        lasted: vec![0.0; time_s.len()],
        jumps: vec![[0.0; 2]; time_s.len()],
        time_s,
        samples,
        ..track.clone()
    };
    jump_at(&mut track, knots, Some(roughness));
    track
}

/// A segment whose wheels are processes, on a grid with the times at which torques may jump.
fn driven(
    segment: &Segment,
    (noise, searched): (&[f64], &Searched),
    torque: &Torque,
    at: usize,
) -> (Segment, WheelProcess) {
    let t = &segment.observations.time_s;
    let ends = (
        t.first().copied().unwrap_or(0.0),
        t.last().copied().unwrap_or(0.0),
    );
    let more: Vec<f64> = match torque {
        Torque::AtSamples => Vec::new(),
        Torque::Lattice { period_s, phase_s } => {
            let phase = phase_s.get(at).copied().unwrap_or(0.0);
            knots(ends.0 + phase, *period_s, ends)
        }
        Torque::Wanders => divided(t, typical_step(segment).unwrap_or(f64::INFINITY) / FINE),
    };
    // A tachometer may have samples where no other sensor was: they are measured too.
    let own = segment
        .tachometers
        .iter()
        .flat_map(|t| t.time_s.iter().copied());
    let times: Vec<f64> = more.iter().copied().chain(own).collect();
    let mut segment = refined(segment, &times);
    let grid = segment.observations.time_s.clone();
    let (mut speeds, mut paths) = (Vec::new(), Vec::new());
    let wheels = segment
        .tachometers
        .iter()
        .zip(noise)
        .zip(&searched.roughness);
    for ((tachometer, variance), roughness) in wheels {
        let knots: &[f64] = match torque {
            Torque::AtSamples => &tachometer.time_s,
            Torque::Lattice { .. } => &more,
            Torque::Wanders => &grid,
        };
        let known = (knots, Some(roughness));
        let mut track = track(tachometer, *variance, &grid, known);
        track.fit_jumps(ROUNDS.1);
        let (speed, path) = track.path();
        speeds.push(speed);
        paths.push(path);
    }
    let row = |k: usize| speeds.iter().map(move |s| s[k]);
    segment.observations.wheel_speed = (0..grid.len()).flat_map(row).collect();
    (segment, WheelProcess { paths })
}

/// Times that divide every interval of a grid into parts no longer than a step.
fn divided(t: &[f64], step: f64) -> Vec<f64> {
    let mut more = Vec::new();
    for w in t.windows(2) {
        let parts = ((w[1] - w[0]) / step).ceil().max(1.0) as usize;
        more.extend((1..parts).map(|i| w[0] + (w[1] - w[0]) * i as f64 / parts as f64));
    }
    more
}
