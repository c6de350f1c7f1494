//! Evidence against an answer, and the factor on its sigmas; status, exit code and verdict follow from it.
//!
//! A pooled chi-square hides a sensor with few readings, and a misfit that is small and slow. So every sensor is tested
//! separately, in every segment and in all together, as a whole and by octaves (see [`crate::octaves`]). The
//! false-alarm probability is split among the tests: a correct record fails less than once in 10,000 answers.

use crate::diagnosis::octaves::Octave;
use crate::fit::degrees_of_freedom::MISFIT;
use crate::solution::estimate::SegmentFit;
use crate::solution::solved::Solution;

/// Probability that any test of one answer rejects a correct record.
const FALSE_ALARM: f64 = 2.0e-5;
/// Excess of a mean square that is too small to matter: sigmas are 1 % too small.
const NEGLIGIBLE_EXCESS: f64 = 0.02;
/// Excess of a mean square that is white all over, up to which widened sigmas suffice: noise 10 % above the declared
/// one, the usual accuracy of a declaration.
const WHITE: f64 = 0.21;
/// Share of the misfit from which a suspect is reported with the sensors.
const MOST_OF_MISFIT: f64 = 0.5;
/// Chi-square per degree of freedom of a file without noise, round-off and rounded digits aside.
pub(crate) const NOISE_FREE: f64 = 1.0e-3;

/// Evidence against the answer from residuals, priors and convergence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reliability {
    /// Reasons against the answer, the most important first; empty if every check passed.
    pub doubts: Vec<String>,
    /// Factor on every sigma: the noise of the worst sensor, or of the priors, over the declared one.
    pub sigma_factor: f64,
    /// Whether residuals are too large and correlated in time: then the model is wrong, not the noise.
    pub coloured: bool,
}

impl Reliability {
    pub fn of(solution: &Solution) -> Self {
        let chi2 = solution.chi2_per_dof();
        let sensors = sensors(&solution.fit);
        let mut doubts = Vec::new();
        let mut worst = chi2.max(1.0);
        if let Some(conflict) = &solution.conflict {
            worst = worst.max(conflict.ratio);
            doubts.push("a prior contradicts the data".to_owned());
        }
        if !solution.converged {
            doubts.push("the iteration did not converge".to_owned());
        }
        for sensor in &sensors {
            worst = worst.max(sensor.worst.mean_square());
        }
        let bad = || sensors.iter().filter(|s| !s.is_made_up_for());
        doubts.extend(suspect(solution, bad().next().is_some()));
        doubts.extend(bad().map(Sensor::message));
        if bad().next().is_none() && chi2 > MISFIT {
            doubts.push(format!(
                "residuals are {:.1} times the declared noise",
                chi2.sqrt()
            ));
        }
        let sensitive = solution.sensitive_to.iter();
        doubts.extend(sensitive.map(|what| format!("the estimate is sensitive to {what}")));
        if solution.not_rigid {
            doubts.push("a spectral line in the residual: the vehicle is not rigid".to_owned());
        }
        if solution.noise_accumulates && chi2 > NOISE_FREE {
            doubts.push("noise accumulates from sample to sample under thrust".to_owned());
        }
        if let Some(held) = &solution.held {
            doubts.push(format!(
                "{} is at the limit of physical mass properties",
                held.bodies.join(", ")
            ));
        }
        Self {
            doubts,
            sigma_factor: worst.sqrt(),
            coloured: sensors.iter().any(|s| s.coloured),
        }
    }
}

/// The first suspect of the diagnosis; if a sensor fails too, only a suspect that explains most of the misfit.
fn suspect(solution: &Solution, shown: bool) -> Option<String> {
    let suspects = &solution.diagnostics.as_ref()?.suspects;
    let first = suspects.first().filter(|s| !s.fault.is_noise_fault())?;
    if shown && first.explains < MOST_OF_MISFIT {
        return None;
    }
    Some(match first.explains > 0.0 {
        true => format!(
            "{} would explain {:.0} % of the misfit",
            first.name,
            100.0 * first.explains
        ),
        false => format!(
            "{} would reduce chi-square by {:.0}",
            first.name, first.decrease
        ),
    })
}

/// A sensor whose residual is larger than its declared noise allows.
#[derive(Debug, Clone, PartialEq)]
struct Sensor {
    name: String,
    /// Segment, if only that one fails.
    segment: Option<String>,
    /// All levels.
    whole: Octave,
    /// The largest significant mean square, of all levels or of one.
    worst: Octave,
    /// Whether the levels differ significantly.
    coloured: bool,
}

impl Sensor {
    /// Tests the levels of one sensor; `None` if none is too large.
    fn judged(name: &str, levels: &[Octave], chance: f64) -> Option<Self> {
        let whole = levels.iter().fold(Octave::default(), |a, b| a.plus(b));
        let too_large =
            |o: &&Octave| o.mean_square() > 1.0 + NEGLIGIBLE_EXCESS && o.p_value(1.0) < chance;
        let coloured = levels
            .iter()
            .any(|o| o.p_value(whole.mean_square()) < chance);
        // The levels of white noise scatter, most with few samples.
        let all = std::iter::once(&whole).chain(levels.iter().filter(|_| coloured));
        let larger = |a: &&Octave, b: &&Octave| a.mean_square().total_cmp(&b.mean_square());
        let worst = all.filter(too_large).max_by(larger);
        let worst = worst.or_else(|| levels.iter().filter(too_large).max_by(larger))?;
        Some(Self {
            name: name.to_owned(),
            segment: None,
            worst: *worst,
            coloured,
            whole,
        })
    }

    /// Whether widened sigmas suffice.
    fn is_made_up_for(&self) -> bool {
        !self.coloured && self.worst.mean_square() <= 1.0 + WHITE
    }

    fn message(&self) -> String {
        let place = match &self.segment {
            Some(segment) => format!(" in {segment}"),
            None => String::new(),
        };
        let (whole, worst) = (self.whole.mean_square(), self.worst.mean_square());
        let name = &self.name;
        match self.coloured && worst > whole {
            true => format!(
                "the residual of the {name}{place} is correlated in time: {:.1} times its declared noise over {} samples",
                worst.sqrt(),
                self.worst.readings
            ),
            false => format!(
                "the residual of the {name}{place} is {:.2} times its declared noise",
                whole.max(worst).sqrt()
            ),
        }
    }
}

/// Sensors that are too large: in all segments together, else in one of them.
fn sensors(fit: &[SegmentFit]) -> Vec<Sensor> {
    let mut names: Vec<&str> = Vec::new();
    for channel in fit.iter().flat_map(|s| &s.channels) {
        if !channel.octaves.is_empty() && !names.contains(&channel.name.as_str()) {
            names.push(&channel.name);
        }
    }
    let tests: usize = names
        .iter()
        .flat_map(|name| octaves_of(fit, name))
        .map(|(_, levels)| 2 * (levels.len() + 1))
        .sum();
    let chance = FALSE_ALARM / tests.max(1) as f64;
    names
        .iter()
        .filter_map(|name| {
            let together =
                octaves_of(fit, name).fold(Vec::new(), |sum, (_, levels)| added(sum, levels));
            let mut found = Sensor::judged(name, &together, chance);
            for (label, levels) in octaves_of(fit, name) {
                let alone = Sensor::judged(name, levels, chance);
                let Some(mut alone) = alone.filter(|_| fit.len() > 1) else {
                    continue;
                };
                alone.segment = Some(label.clone());
                let larger = |f: &Sensor| alone.worst.mean_square() > f.worst.mean_square();
                if found.as_ref().is_none_or(larger) {
                    alone.coloured |= found.as_ref().is_some_and(|f| f.coloured);
                    found = Some(alone);
                }
            }
            found
        })
        .collect()
}

/// Labels of the segments and octaves of one sensor.
fn octaves_of<'a>(
    fit: &'a [SegmentFit],
    name: &'a str,
) -> impl Iterator<Item = (&'a String, &'a Vec<Octave>)> {
    fit.iter().flat_map(move |s| {
        let own = s.channels.iter().filter(move |c| c.name == name);
        own.map(move |c| (&s.label, &c.octaves))
    })
}

/// Level by level.
fn added(mut sum: Vec<Octave>, levels: &[Octave]) -> Vec<Octave> {
    sum.resize(sum.len().max(levels.len()), Octave::default());
    for (s, level) in sum.iter_mut().zip(levels) {
        *s = s.plus(level);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::octaves::octaves;
    use crate::diagnosis::octaves::tests::white;
    use crate::problem::loss::Loss;
    use crate::solution::estimate::ChannelFit;
    use poinsot_spatial::Vector3;

    fn fit(channels: &[(&'static str, Vec<Vector3>)]) -> SegmentFit {
        let channel = |(name, white): &(&'static str, Vec<Vector3>)| ChannelFit {
            name: (*name).to_owned(),
            unit: "",
            rms: 0.0,
            chi2_per_number: None,
            whiteness_p: None,
            octaves: octaves(white, 3, Loss::Gaussian),
        };
        SegmentFit {
            label: "run".to_owned(),
            channels: channels.iter().map(channel).collect(),
            ..SegmentFit::default()
        }
    }

    /// Of 3,000 correct records, short and long, none fails: the rate is below one in 1,000 (95 %), and by construction
    /// below 2e-5.
    #[test]
    fn stat_no_honest_record_is_doubted() {
        for seed in 0..3000 {
            let n = [20, 60, 500][seed as usize % 3];
            let run = fit(&[
                ("gyro", white(n, seed)),
                ("attitude", white(n / 3, seed + 9999)),
            ]);
            assert_eq!(sensors(&[run]), [], "{seed}");
        }
    }

    #[test]
    fn stat_few_readings_with_ten_times_the_noise_are_seen_beside_many_good_ones() {
        let bad = white(20, 1).iter().map(|w| 10.0 * w).collect();
        let found = sensors(&[fit(&[("gyro", white(5000, 2)), ("attitude", bad)])]);
        assert_eq!(found.len(), 1);
        assert_eq!((&*found[0].name, found[0].coloured), ("attitude", false));
        let factor = found[0].worst.mean_square().sqrt();
        assert!((7.0..13.0).contains(&factor), "{factor}");
    }

    #[test]
    fn stat_a_slow_wave_below_the_noise_is_seen_and_called_correlated() {
        let wave = |k: usize| Vector3::x() * 0.25 * (k as f64 / 300.0).sin();
        let slow: Vec<Vector3> = white(5000, 3)
            .iter()
            .enumerate()
            .map(|(k, w)| w + wave(k))
            .collect();
        let whole = slow.iter().map(|w| w.norm_squared()).sum::<f64>() / 15000.0;
        assert!(whole < 1.03, "{whole}");
        let found = sensors(&[fit(&[("attitude", slow)])]);
        assert!(
            found[0].coloured && found[0].worst.readings > 100,
            "{found:?}"
        );
        assert!(found[0].message().contains("correlated in time"));
    }

    #[test]
    fn stat_a_small_excess_is_let_pass_or_made_up_for_where_it_is_white() {
        let n = 400_000;
        let near = white(n, 4).iter().map(|w| 1.007 * w).collect();
        assert_eq!(sensors(&[fit(&[("gyro", near)])]), []);
        for (factor, made_up_for) in [(1.02, true), (1.09, true), (1.12, false)] {
            let far = white(n, 4).iter().map(|w| factor * w).collect();
            let found = sensors(&[fit(&[("gyro", far)])]);
            let widened = found[0].worst.mean_square().sqrt();
            assert_eq!((found.len(), found[0].is_made_up_for()), (1, made_up_for));
            assert!((widened / factor - 1.0).abs() < 0.01, "{widened}");
        }
    }

    #[test]
    fn stat_one_bad_segment_of_many_is_named() {
        let mut runs: Vec<SegmentFit> = (0..6).map(|s| fit(&[("gyro", white(300, s))])).collect();
        let bad = white(300, 77).iter().map(|w| 1.5 * w).collect();
        runs[4] = SegmentFit {
            label: "fifth".to_owned(),
            ..fit(&[("gyro", bad)])
        };
        let found = sensors(&runs);
        assert_eq!(found[0].segment.as_deref(), Some("fifth"));
    }
}
