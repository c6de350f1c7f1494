//! Tests of every sensor against its declared noise.
//!
//! A pooled chi-square hides a sensor with few samples, and a misfit that is small and slow. So every sensor is tested
//! separately, in every segment and in all together, as a whole and by octaves (see [`crate::diagnosis::octaves`]). The
//! false-alarm probability is split among the tests: a correct record fails less than once in 10,000 answers.

use crate::diagnosis::octaves::Octave;
use crate::problem::settings::Settings;
use crate::solution::estimate::SegmentFit;
use crate::solution::evidence::{Effect, Remark};
use poinsot_files::{counted, each_once};

/// Thresholds of one test.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limits {
    /// p-value below which it fails.
    chance: f64,
    /// Mean square up to which it passes.
    negligible: f64,
    /// Mean square of a white residual up to which wider sigmas suffice.
    white: f64,
}

impl Limits {
    fn is_exceeded(&self, octave: &Octave) -> bool {
        octave.mean_square() > self.negligible && octave.p_value(1.0) < self.chance
    }
}

/// A residual that is larger than its declared noise allows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Excess {
    name: String,
    /// Segment, if only that one fails.
    segment: Option<String>,
    /// All levels.
    whole: Octave,
    /// The largest significant mean square, of all levels or of one.
    worst: Octave,
    /// Whether the levels differ significantly.
    pub coloured: bool,
    limits: Limits,
}

impl Excess {
    /// Tests the levels of one sensor; `None` if none is too large.
    fn judged(name: &str, levels: &[Octave], limits: Limits) -> Option<Self> {
        let whole = together(levels);
        let too_large = |o: &&Octave| limits.is_exceeded(o);
        let coloured = levels
            .iter()
            .any(|o| o.p_value(whole.mean_square()) < limits.chance);
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
            limits,
        })
    }

    /// Whether widened sigmas suffice.
    pub fn is_made_up_for(&self) -> bool {
        !self.coloured && self.worst.mean_square() <= self.limits.white
    }

    fn message(&self) -> String {
        let place = place(self.segment.as_deref());
        let (whole, worst) = (self.whole.mean_square(), self.worst.mean_square());
        let name = &self.name;
        match self.coloured && worst > whole {
            true => format!(
                "the residual of the {name}{place} is correlated in time: {:.1} times as large as declared over {} samples",
                worst.sqrt(),
                self.worst.readings
            ),
            false => format!(
                "the residual of the {name}{place} is {:.2} times as large as declared",
                whole.max(worst).sqrt()
            ),
        }
    }
}

fn place(segment: Option<&str>) -> String {
    segment.map_or(String::new(), |segment| format!(" in {segment}"))
}

/// All levels as one.
fn together(levels: &[Octave]) -> Octave {
    levels.iter().fold(Octave::default(), |a, b| a.plus(b))
}

/// The tests of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SensorNoise<'a> {
    name: &'a str,
    /// Levels of all segments together.
    levels: Vec<Octave>,
    /// Levels of each segment, where there are several.
    segments: Vec<(&'a str, &'a [Octave])>,
    limits: Limits,
    /// The largest excess, in all segments together, else in one of them.
    pub excess: Option<Excess>,
}

/// One tested sum of squares of a sensor.
struct Tested<'a> {
    segment: Option<&'a str>,
    octave: Octave,
    /// Whether it is one level of several.
    is_level: bool,
    /// Whether it is the largest excess of the sensor.
    decides: bool,
}

impl<'a> SensorNoise<'a> {
    fn new(fit: &'a [SegmentFit], name: &'a str, limits: Limits) -> Self {
        let levels = octaves_of(fit, name).fold(Vec::new(), |sum, (_, levels)| added(sum, levels));
        let mut excess = Excess::judged(name, &levels, limits);
        let segments: Vec<(&str, &[Octave])> = match fit.len() > 1 {
            true => octaves_of(fit, name).collect(),
            false => Vec::new(),
        };
        for (label, levels) in &segments {
            let Some(mut alone) = Excess::judged(name, levels, limits) else {
                continue;
            };
            alone.segment = Some((*label).to_owned());
            let larger = |f: &Excess| alone.worst.mean_square() > f.worst.mean_square();
            if excess.as_ref().is_none_or(larger) {
                alone.coloured |= excess.as_ref().is_some_and(|f| f.coloured);
                excess = Some(alone);
            }
        }
        Self {
            name,
            levels,
            segments,
            limits,
            excess,
        }
    }

    /// One row for the sensor as a whole, one for its worst octave and one for its worst segment.
    pub fn rows(&self) -> Vec<Remark> {
        let mut tested = self.of_all_segments();
        tested.extend(self.of_one_segment());
        tested.iter().map(|t| self.row(t)).collect()
    }

    fn of_all_segments(&self) -> Vec<Tested<'a>> {
        let excess = self.excess.as_ref().filter(|e| e.segment.is_none());
        let octave = together(&self.levels);
        let level = excess.map(|e| e.worst).filter(|worst| *worst != octave);
        let mut list = vec![Tested {
            segment: None,
            octave,
            is_level: false,
            decides: excess.is_some() && level.is_none(),
        }];
        let least = |a: &&Octave, b: &&Octave| a.p_value(1.0).total_cmp(&b.p_value(1.0));
        let worst = level.or_else(|| self.levels.iter().min_by(least).copied());
        list.extend(worst.map(|worst| Tested {
            segment: None,
            octave: worst,
            is_level: true,
            decides: level.is_some(),
        }));
        list
    }

    fn of_one_segment(&self) -> Option<Tested<'a>> {
        let excess = self.excess.as_ref().filter(|e| e.segment.is_some());
        let whole = |levels: &[Octave]| together(levels).p_value(1.0);
        let (label, levels) = match excess {
            Some(e) => (self.segments.iter()).find(|s| Some(s.0) == e.segment.as_deref()),
            None => (self.segments.iter()).min_by(|a, b| whole(a.1).total_cmp(&whole(b.1))),
        }?;
        let octave = excess.map_or_else(|| together(levels), |e| e.worst);
        Some(Tested {
            segment: Some(label),
            octave,
            is_level: excess.is_some_and(|e| e.worst != e.whole),
            decides: excess.is_some(),
        })
    }

    fn row(&self, t: &Tested) -> Remark {
        let level = match (t.is_level, t.octave.readings) {
            (false, _) => String::new(),
            (true, samples) => format!(" over {}", counted(samples, "sample")),
        };
        let test = format!("residual of the {}{}{level}", self.name, place(t.segment));
        let times = t.octave.mean_square().sqrt();
        let row = match &self.excess {
            Some(e) if t.decides => {
                let effect = Effect::AgainstAnswer.if_failed(!e.is_made_up_for());
                Remark::test(test, effect, e.message()).widening(times)
            }
            excess => {
                let words = format!("the {test} is {times:.2} times as large as declared");
                let decided = excess.as_ref().map_or(0.0, |e| e.worst.mean_square());
                let fails = self.limits.is_exceeded(&t.octave);
                let factor = match fails && t.octave.mean_square() <= decided {
                    true => times,
                    false => 1.0,
                };
                Remark::test(test, Effect::None, words).widening(factor)
            }
        };
        row.chi_square(t.octave.square, t.octave.numbers)
    }
}

/// The tests of every sensor that the method weights separately.
pub(super) fn sensor_noise<'a>(fit: &'a [SegmentFit], settings: &Settings) -> Vec<SensorNoise<'a>> {
    let tested = fit.iter().flat_map(|s| &s.channels);
    let tested = tested.filter(|c| !c.octaves.is_empty());
    let names = each_once(tested.map(|c| c.name.as_str()));
    let tests: usize = names
        .iter()
        .flat_map(|name| octaves_of(fit, name))
        .map(|(_, levels)| 2 * (levels.len() + 1))
        .sum();
    let limits = Limits {
        chance: settings.false_alarm / tests.max(1) as f64,
        negligible: 1.0 + settings.negligible_excess,
        white: 1.0 + settings.white_excess,
    };
    let names = names.into_iter();
    names
        .map(|name| SensorNoise::new(fit, name, limits))
        .collect()
}

/// Labels of the segments and octaves of one sensor.
fn octaves_of<'a>(
    fit: &'a [SegmentFit],
    name: &'a str,
) -> impl Iterator<Item = (&'a str, &'a [Octave])> {
    fit.iter().flat_map(move |s| {
        let own = s.channels.iter().filter(move |c| c.name == name);
        own.map(move |c| (s.label.as_str(), c.octaves.as_slice()))
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
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    fn fit(channels: &[(&'static str, Vec<Vector3>)]) -> SegmentFit {
        let channel = |(name, white): &(&'static str, Vec<Vector3>)| ChannelFit {
            name: (*name).to_owned(),
            unit: "",
            rms: 0.0,
            chi2_per_number: None,
            whiteness_p: None,
            power_p: None,
            octaves: octaves(white, 3, Loss::Gaussian),
        };
        SegmentFit {
            label: "run".to_owned(),
            channels: channels.iter().map(channel).collect(),
            ..SegmentFit::default()
        }
    }

    fn excesses(fit: &[SegmentFit]) -> Vec<Excess> {
        let all = sensor_noise(fit, &Settings::default()).into_iter();
        all.filter_map(|s| s.excess).collect()
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
            assert_eq!(excesses(&[run]), [], "{seed}");
        }
    }

    #[test]
    fn stat_few_readings_with_ten_times_the_noise_are_seen_beside_many_good_ones() {
        let bad = white(20, 1).iter().map(|w| 10.0 * w).collect();
        let found = excesses(&[fit(&[("gyro", white(5000, 2)), ("attitude", bad)])]);
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
        let found = excesses(&[fit(&[("attitude", slow)])]);
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
        assert_eq!(excesses(&[fit(&[("gyro", near)])]), []);
        for (factor, made_up_for) in [(1.02, true), (1.09, true), (1.12, false)] {
            let far = white(n, 4).iter().map(|w| factor * w).collect();
            let found = excesses(&[fit(&[("gyro", far)])]);
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
        let found = excesses(&runs);
        assert_eq!(found[0].segment.as_deref(), Some("fifth"));
    }

    /// p is that of the definition, and the row of the largest excess decides, whichever it is.
    #[test]
    fn exact_rows_have_the_tail_of_chi_square_and_one_of_them_decides() {
        let scaled = |n: usize, seed: u64, factor: f64| -> Vec<Vector3> {
            white(n, seed).iter().map(|w| factor * w).collect()
        };
        let slow: Vec<Vector3> = white(5000, 3)
            .iter()
            .enumerate()
            .map(|(k, w)| w + Vector3::x() * 0.25 * (k as f64 / 300.0).sin())
            .collect();
        let one = |series| vec![fit(&[("gyro", series)])];
        let mut many: Vec<SegmentFit> = (0..4).map(|s| fit(&[("gyro", white(300, s))])).collect();
        many.push(SegmentFit {
            label: "fifth".to_owned(),
            ..fit(&[("gyro", scaled(300, 77, 1.5))])
        });
        let cases = [
            (one(white(500, 1)), None, Effect::None),
            (one(scaled(500, 1, 3.0)), Some(0), Effect::AgainstAnswer),
            (one(scaled(400_000, 4, 1.05)), Some(0), Effect::WidensSigmas),
            (one(slow), Some(1), Effect::AgainstAnswer),
            (many, Some(2), Effect::AgainstAnswer),
        ];
        for (fit, decisive, effect) in cases {
            let noise = &sensor_noise(&fit, &Settings::default())[0];
            let rows = noise.rows();
            assert_eq!(rows.len(), 2 + usize::from(fit.len() > 1));
            for (k, row) in rows.iter().enumerate() {
                let (Some((_, square)), Some(dof)) = (row.statistic, row.degrees_of_freedom) else {
                    panic!("{row:?}");
                };
                let tail = ChiSquared::new(dof as f64).unwrap().sf(square);
                if tail > 1.0e-100 {
                    // Wilson and Hilferty 1931: three digits of the exponent in the far tail.
                    let apart = (row.p.unwrap() / tail).ln().abs();
                    assert!(apart < 2.0e-3 * (1.0 - tail.ln()), "{apart}: {tail}");
                }
                if decisive == Some(k) {
                    let excess = noise.excess.as_ref().unwrap();
                    assert_eq!((row.effect, &row.words), (effect, &excess.message()));
                    assert_eq!(row.sigma_factor, excess.worst.mean_square().sqrt());
                } else {
                    assert!(row.effect <= Effect::WidensSigmas, "{row:?}");
                }
            }
            let factor = crate::solution::evidence::sigma_factor(&rows);
            let worst = noise.excess.as_ref().map_or(1.0, |e| e.worst.mean_square());
            assert_eq!(factor, worst.sqrt());
        }
    }
}
