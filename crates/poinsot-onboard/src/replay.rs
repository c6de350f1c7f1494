//! The first window, and what happens with each sample in order.

use crate::configuration::PASSES;
use crate::excitation::Excitation;
use crate::filter::{Change, Filter, GATE, MOVED};
use crate::health::{Checkpoint, Verdict};
use crate::motion::{Bend, Moving};
use crate::numbers::Numbers;
use crate::sample::Sample;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;

/// Shares of the prior by which the motion may deviate from that of the parameters in the first passes: far from the truth a motion
/// without noise leaves the data, and its linearisation with it.
const LOOSE: [f64; 7] = [1.0, 1.0, 0.3, 0.1, 0.03, 0.01, 0.003];
/// Factor on the gate in the pass after these.
const FIRST_GATE: f64 = 100.0;
/// Largest move in sigma after which a pass is followed by one that is less loose.
const FAR: f64 = 10.0;
/// Largest distance from the nominal numbers at which the motion is linearised, in sigma of the prior.
const BEYOND: f64 = 6.0;
/// Share of the prior's sigma within which the parameters are when a window ends, if it can be thinned until then: what is learnt
/// while they are further off is linearised where they are not.
const NEAR: f64 = 0.02;
/// Most times that a step to an impossible vehicle is halved.
const HALVINGS: u32 = 20;

impl<const N: usize, const WINDOW: usize> Filter<N, WINDOW> {
    /// The next sample in order.
    pub(crate) fn process(&mut self, sample: &Sample) {
        let moving = Moving::new(&self.configuration, &self.numbers);
        let h = moving.wheel_momentum(&sample.wheel_speed);
        let bend = self
            .course
            .next(sample.time_s, h, self.configuration.longest_gap_s);
        if self.window.done {
            let verdict = self.step(sample, bend, true);
            self.conclude(verdict);
            return;
        }
        let taken = self.window.gather(sample, (&bend, &moving));
        if !taken || !self.window.is_due(&self.configuration) {
            return;
        }
        let verdict = self.replay();
        let lost = matches!(verdict, Verdict::Lost | Verdict::Alarm | Verdict::LongAlarm);
        let filling = self.window.is_filling();
        self.window.replayed = verdict != Verdict::Lost && !(filling && lost);
        let near = self.window.replayed && self.is_near();
        if filling && lost {
            // What does not come right with few samples may with more.
            self.numbers = self.configuration.nominal;
            self.set_prior();
        }
        if filling && !near {
            return;
        }
        let full = self.window.count == WINDOW;
        let moving = Moving::new(&self.configuration, &self.numbers);
        self.window.done = near || (full && !self.window.thin(&moving));
        self.conclude(verdict);
    }

    /// Whether the parameters are so well known that what follows may be linearised at them.
    fn is_near(&self) -> bool {
        let sigma = self.of_parameters().sigma(self.layout.unknown);
        let mut pairs = self.layout.unknown().iter().zip(&sigma);
        // What walks is not known better than it walks in the window.
        let walked = match self.configuration.forget_s {
            0.0 => 0.0,
            forget => self.window.length_s() / forget,
        };
        let near = (NEAR * NEAR + walked).sqrt();
        pairs.all(|(&k, sigma)| *sigma <= near * self.prior_sigma[k])
    }

    /// One sample. Parameters stay while the window is replayed.
    fn step(&mut self, sample: &Sample, bend: Bend, moves: bool) -> Verdict {
        let mut done = self.take(sample, bend);
        if moves && self.running.is_some() {
            done = done.and_then(|()| self.follow_parameters());
        }
        match done {
            Some(()) => self.tests.verdict(),
            None => Verdict::Alarm,
        }
    }

    /// Passes over the window.
    fn replay(&mut self) -> Verdict {
        self.shown = Excitation::new();
        let mut level = 0;
        for _ in 0..PASSES {
            let loose = LOOSE.get(level).copied();
            self.looseness = loose.unwrap_or(0.0);
            // In the first pass without looseness a moderate misfit is that of the parameters.
            let wide = if level == LOOSE.len() {
                FIRST_GATE
            } else {
                1.0
            };
            self.gate = GATE * wide;
            let verdict = self.pass();
            self.looseness = 0.0;
            let Some(Change { by, farthest }) = self.change() else {
                break;
            };
            if level > LOOSE.len() && farthest <= MOVED {
                self.shown.grows = true;
                return verdict;
            }
            self.shown.settle();
            level += usize::from(farthest <= FAR || level >= LOOSE.len());
            self.numbers = self.nearest(&by);
        }
        Verdict::Lost
    }

    /// One pass over the window, with its worst verdict.
    fn pass(&mut self) -> Verdict {
        self.tests.begin_pass();
        self.starts = 0;
        self.set_prior();
        self.shown.begin();
        let mut worst = Verdict::Clean;
        for k in 0..self.window.count {
            let (sample, bend) = (self.window.samples[k], self.window.bends[k]);
            let verdict = self.step(&sample, bend, false);
            if matches!(verdict, Verdict::Alarm | Verdict::LongAlarm) {
                worst = verdict;
            }
        }
        worst
    }

    /// The parameters after a change, which is halved until the vehicle is possible and not far beyond the prior.
    fn nearest(&self, change: &Numbers) -> Numbers {
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let mut numbers = self.numbers;
            for (&k, change) in self.layout.numbers().iter().zip(change) {
                numbers[k] += change * share;
            }
            let nominal = &self.configuration.nominal;
            let mut beyond = numbers.iter().zip(nominal).zip(&self.prior_sigma);
            let far = beyond.any(|((x, nominal), sigma)| (x - nominal).abs() > BEYOND * sigma);
            if self.configuration.is_possible(&numbers) && !far {
                return numbers;
            }
            share *= 0.5;
        }
        self.numbers
    }

    /// What the tests of innovations lead to.
    // Its checkpoints are not on the stack of every sample.
    #[inline(never)]
    fn conclude(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Open => {}
            Verdict::Clean | Verdict::LongClean => {
                let here = Checkpoint {
                    numbers: self.numbers,
                    info: self.of_parameters(),
                    known_s: self.known_s,
                    is_prior: false,
                };
                self.checkpoints.keep(here, verdict == Verdict::LongClean);
            }
            // The parameters found are where the next passes begin: over more samples, or over the next ones.
            Verdict::Lost => {
                if self.window.done {
                    self.window.restart();
                }
                self.set_prior();
            }
            Verdict::Alarm | Verdict::LongAlarm => {
                self.starts = 0;
                let back = self.checkpoints.back(verdict == Verdict::LongAlarm);
                self.tests.alarm();
                self.numbers = back.numbers;
                self.set_parameters(&back.info);
                self.known_s = back.known_s;
                self.window.done = true;
                if back.is_prior {
                    self.window.restart();
                }
            }
        }
    }
}
