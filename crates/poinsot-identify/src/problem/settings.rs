//! Choices and thresholds of an identification, with their defaults.

use crate::problem::loss::Loss;
use crate::problem::refusal;
use poinsot_files::Faults;
use statrs::function::erf::erfc;

/// Coordinates of the fit's steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coordinates {
    /// The linear parameters of physical bodies: the answer is always physical.
    #[default]
    Physical,
    /// All linear parameters: an impossible tensor is possible.
    Linear,
}

impl Coordinates {
    /// Names for the command line.
    pub const NAMES: [&'static str; 2] = ["physical", "linear"];

    /// By its name.
    pub fn from_name(name: &str) -> Option<Self> {
        let at = Self::NAMES.iter().position(|own| *own == name)?;
        [Self::Physical, Self::Linear].get(at).copied()
    }
}

impl Modes {
    /// Names for the command line.
    pub const NAMES: [&'static str; 2] = ["found", "none"];

    /// By its name.
    pub fn from_name(name: &str) -> Option<Self> {
        let at = Self::NAMES.iter().position(|own| *own == name)?;
        [Self::Found, Self::None].get(at).copied()
    }
}

/// Choices of a maximum-likelihood fit, and thresholds of the tests of its answer.
///
/// [`crate::maximum_likelihood_with`] validates and uses them. The defaults are those of the command `identify`, and the
/// trials of docs/validation are with them.
///
/// ```
/// use poinsot_identify::Settings;
///
/// let strict = Settings { false_alarm: 1.0e-3, ..Settings::default() };
/// assert!(strict.validate().is_ok());
/// let wrong = Settings { false_alarm: 2.0, ..Settings::default() };
/// let why = wrong.validate().unwrap_err().to_string();
/// assert_eq!(why, "E0407 setting 'false_alarm' = 2: out of its range; give a number above 0 and below 1");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Loss of a sample. Default: Gaussian.
    pub loss: Loss,
    /// Space of the steps. Default: physical bodies.
    pub coordinates: Coordinates,
    /// Whether modes that no model declares are searched. Default: they are.
    pub modes: Modes,
    /// Skips the search for the cause of a misfit. It changes no number, only the verdict. Default: false.
    pub undiagnosed: bool,
    /// Probability that any sensor of a correct record fails a test against its declared noise, above 0 and below 1. All
    /// tests of all sensors share it (Bonferroni). Default: 2e-5.
    pub false_alarm: f64,
    /// Excess of a mean square residual, relative to the declared variance, that has no effect. Default: 0.02, which is
    /// 1 % of sigma.
    pub negligible_excess: f64,
    /// Excess of the mean square of a white residual up to which wider sigmas suffice; at least `negligible_excess`.
    /// Default: 0.21, which is noise 10 % above the declared one, the usual accuracy of a declaration.
    pub white_excess: f64,
    /// Chi-square per degree of freedom above which the declared noise cannot be right, above 1. Default: 1.5.
    pub misfit: f64,
    /// Chi-square per degree of freedom above which a model is rejected that explains little, or whose residuals are
    /// correlated in time; at least `misfit`. Default: 9, three times the noise at every sample. A wider sigma does not
    /// bound such errors.
    pub rejection: f64,
    /// Difference between a declared number and the data, sigmas, above which they contradict each other, above 0.
    /// Default: 5.
    pub contradiction_sigmas: f64,
    /// Change of the estimate under another assumption, sigmas, above which it is sensitive to the assumption, above 0.
    /// Default: 1.
    pub sensitivity_sigmas: f64,
    /// Thresholds of the search for the cause of a misfit.
    pub diagnosis: DiagnosisSettings,
    /// Thresholds of the test of the integration steps.
    pub integration: IntegrationSettings,
}

/// Flexible modes that a model does not declare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Modes {
    /// Searched where the rigid model does not explain the data.
    #[default]
    Found,
    /// None: the vehicle is rigid but for what the model declares.
    None,
}

/// Thresholds of the search for the cause of a misfit. They change no number of an answer, only the causes that are named.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnosisSettings {
    /// Probability that any cause is named in a record without a fault, above 0 and below 1. All hypotheses share it
    /// (Bonferroni). Default: 1e-4; a lower one hides faults that five sigma show.
    pub false_alarm: f64,
    /// Difference of evidence, in units of -2 ln L, below which two causes are indistinguishable, above 0. Default: 10, odds
    /// of 150.
    pub tied_evidence: f64,
    /// Chi-square per degree of freedom from which wrong signs, wrong units and exchanged columns are tested, above 1.
    /// Default: 100; linear tests find smaller mistakes.
    pub gross_misfit: f64,
    /// Share of the power of a residual in one spectral line from which the line is a cause, above 0 and below 1.
    /// Default: 0.25.
    pub line_share: f64,
    /// Share of the power of the predicted motion, or of its change, in that line, above which the manoeuvre causes it, above
    /// 0 and below 1. Default: 0.02.
    pub driven_share: f64,
    /// Share of outliers above which they are a cause, above 0 and below 1. Default: 0.001.
    pub least_outliers: f64,
    /// Share of outliers above which the model is wrong instead; above `least_outliers` and below 1. Default: 0.2.
    pub most_outliers: f64,
    /// Share of the excess variance that rounding explains, from which it is the cause, above 0 and below 1. Default: 0.5.
    pub rounding_share: f64,
    /// Share of a residual's variance that earlier samples may predict where its times have jitter, above 0 and below 1.
    /// Default: 0.1; a missing part of the motion is predicted by half and more.
    pub predictable_share: f64,
}

/// Thresholds of the test of the integration steps: change by steps of half the size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntegrationSettings {
    /// Largest change of the answer, sigmas, above 0. Default: 0.05, which adds 0.1 % to a sigma.
    pub answer_sigmas: f64,
    /// Largest change of all predictions together, in their noise, above 0. Default: 0.3: a chi-square moves by less than 0.1.
    pub predictions_sigmas: f64,
    /// Largest relative change of the sensitivities of identified directions, in the norm of the information, above 0. Default:
    /// 1e-3.
    pub sensitivities: f64,
    /// Largest change of the sensitivities of other directions, in units of the smallest singular value of an identified one,
    /// above 0. Default: 0.1.
    pub unidentified: f64,
}

impl Default for DiagnosisSettings {
    fn default() -> Self {
        Self {
            false_alarm: 1.0e-4,
            tied_evidence: 10.0,
            gross_misfit: 100.0,
            line_share: 0.25,
            driven_share: 0.02,
            least_outliers: 1.0e-3,
            most_outliers: 0.2,
            rounding_share: 0.5,
            predictable_share: 0.1,
        }
    }
}

impl Default for IntegrationSettings {
    fn default() -> Self {
        Self {
            answer_sigmas: 0.05,
            predictions_sigmas: 0.3,
            sensitivities: 1.0e-3,
            unidentified: 0.1,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            loss: Loss::default(),
            coordinates: Coordinates::default(),
            modes: Modes::default(),
            undiagnosed: false,
            false_alarm: 2.0e-5,
            negligible_excess: 0.02,
            white_excess: 0.21,
            misfit: 1.5,
            rejection: 9.0,
            contradiction_sigmas: 5.0,
            sensitivity_sigmas: 1.0,
            diagnosis: DiagnosisSettings::default(),
            integration: IntegrationSettings::default(),
        }
    }
}

impl From<Loss> for Settings {
    fn from(loss: Loss) -> Self {
        Self {
            loss,
            ..Self::default()
        }
    }
}

impl Settings {
    /// Checks every threshold.
    ///
    /// # Errors
    /// The first setting out of its range.
    pub fn validate(&self) -> Result<(), Faults> {
        let mut ranges = self.ranges().into_iter();
        match ranges.find(|(_, value, holds, _)| !holds || !value.is_finite()) {
            Some((name, value, _, range)) => Err(refusal::setting(name, value, &range)),
            None => Ok(()),
        }
    }

    /// Every threshold.
    fn ranges(&self) -> [Range; 20] {
        let (negligible, misfit) = (self.negligible_excess, self.misfit);
        let (diagnosis, integration) = (&self.diagnosis, &self.integration);
        let (least_outliers, most) = (diagnosis.least_outliers, diagnosis.most_outliers);
        let between =
            format!("a number above {least_outliers} (diagnosis.least_outliers) and below 1");
        [
            share("false_alarm", self.false_alarm),
            least("negligible_excess", negligible, 0.0, ""),
            least(
                "white_excess",
                self.white_excess,
                negligible,
                " (negligible_excess)",
            ),
            above("misfit", misfit, 1.0),
            least("rejection", self.rejection, misfit, " (misfit)"),
            above("contradiction_sigmas", self.contradiction_sigmas, 0.0),
            above("sensitivity_sigmas", self.sensitivity_sigmas, 0.0),
            share("diagnosis.false_alarm", diagnosis.false_alarm),
            above("diagnosis.tied_evidence", diagnosis.tied_evidence, 0.0),
            above("diagnosis.gross_misfit", diagnosis.gross_misfit, 1.0),
            share("diagnosis.line_share", diagnosis.line_share),
            share("diagnosis.driven_share", diagnosis.driven_share),
            share("diagnosis.least_outliers", least_outliers),
            (
                "diagnosis.most_outliers",
                most,
                most > least_outliers && most < 1.0,
                between,
            ),
            share("diagnosis.rounding_share", diagnosis.rounding_share),
            share("diagnosis.predictable_share", diagnosis.predictable_share),
            above("integration.answer_sigmas", integration.answer_sigmas, 0.0),
            above(
                "integration.predictions_sigmas",
                integration.predictions_sigmas,
                0.0,
            ),
            above("integration.sensitivities", integration.sensitivities, 0.0),
            above("integration.unidentified", integration.unidentified, 0.0),
        ]
    }

    /// Probability of a difference of more than `contradiction_sigmas` in one number.
    pub(crate) fn contradiction_p(&self) -> f64 {
        erfc(self.contradiction_sigmas * std::f64::consts::FRAC_1_SQRT_2)
    }
}

/// Name of a setting, its value, whether it is in its range, and the range.
type Range = (&'static str, f64, bool, String);

fn share(name: &'static str, value: f64) -> Range {
    let range = "a number above 0 and below 1".to_owned();
    (name, value, value > 0.0 && value < 1.0, range)
}

fn least(name: &'static str, value: f64, limit: f64, of: &str) -> Range {
    let range = format!("a finite number of at least {limit}{of}");
    (name, value, value >= limit, range)
}

fn above(name: &'static str, value: f64, limit: f64) -> Range {
    let range = format!("a finite number above {limit}");
    (name, value, value > limit, range)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Change = fn(&mut Settings, f64);

    #[test]
    fn unit_every_setting_has_a_range() {
        let default = Settings::default();
        assert_eq!(default.validate(), Ok(()));
        let changed: [(&str, Change); 20] = [
            ("false_alarm", |s, x| s.false_alarm = x),
            ("negligible_excess", |s, x| s.negligible_excess = x),
            ("white_excess", |s, x| s.white_excess = x),
            ("misfit", |s, x| s.misfit = x),
            ("rejection", |s, x| s.rejection = x),
            ("contradiction_sigmas", |s, x| s.contradiction_sigmas = x),
            ("sensitivity_sigmas", |s, x| s.sensitivity_sigmas = x),
            ("diagnosis.false_alarm", |s, x| s.diagnosis.false_alarm = x),
            ("diagnosis.tied_evidence", |s, x| {
                s.diagnosis.tied_evidence = x;
            }),
            ("diagnosis.gross_misfit", |s, x| {
                s.diagnosis.gross_misfit = x;
            }),
            ("diagnosis.line_share", |s, x| s.diagnosis.line_share = x),
            ("diagnosis.driven_share", |s, x| {
                s.diagnosis.driven_share = x;
            }),
            ("diagnosis.least_outliers", |s, x| {
                s.diagnosis.least_outliers = x;
            }),
            ("diagnosis.most_outliers", |s, x| {
                s.diagnosis.most_outliers = x;
            }),
            ("diagnosis.rounding_share", |s, x| {
                s.diagnosis.rounding_share = x;
            }),
            ("diagnosis.predictable_share", |s, x| {
                s.diagnosis.predictable_share = x;
            }),
            ("integration.answer_sigmas", |s, x| {
                s.integration.answer_sigmas = x;
            }),
            ("integration.predictions_sigmas", |s, x| {
                s.integration.predictions_sigmas = x;
            }),
            ("integration.sensitivities", |s, x| {
                s.integration.sensitivities = x;
            }),
            ("integration.unidentified", |s, x| {
                s.integration.unidentified = x;
            }),
        ];
        for (name, change) in changed {
            for wrong in [-1.0, f64::NAN, f64::INFINITY] {
                let mut settings = default;
                change(&mut settings, wrong);
                let error = settings.validate().unwrap_err();
                let place = &error.list[0].place.key;
                assert_eq!(place, &format!("setting '{name}'"), "{wrong}");
            }
        }
        let contradictory = Settings {
            rejection: 1.4,
            ..default
        };
        assert_eq!(
            contradictory.validate().unwrap_err().to_string(),
            "E0407 setting 'rejection' = 1.4: out of its range; give a finite number of at least 1.5 (misfit)"
        );
    }

    /// Five sigma of the normal distribution.
    #[test]
    fn exact_the_probability_of_a_contradiction_is_that_of_five_sigma() {
        let p = Settings::default().contradiction_p();
        assert!((p / 5.733_031_437_583_892e-7 - 1.0).abs() < 1.0e-6, "{p:e}");
    }
}
