//! What is said of an answer: one list of remarks. Status, reliability and the factor on every sigma follow from it.

use crate::diagnosis::octaves::Octave;
use poinsot_files::each_once;

/// What a remark is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RemarkKind {
    /// A test of the answer, passed or failed: evidence.
    Test,
    /// What the user has to know.
    Warning,
    /// What was assumed of the inputs or the model.
    Assumption,
    /// What was repaired or assumed while reading.
    Repair,
    /// A column that is not used.
    Ignored,
}

/// Effect of one remark on the answer, the weakest first. The names are those of the result file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// The test passed, or another row of the same sensor decides.
    None,
    /// Every sigma is multiplied by the factor of the row.
    WidensSigmas,
    /// The status is at most partial.
    MakesPartial,
    /// The answer is not reliable.
    AgainstAnswer,
    /// The answer is not reliable, and its numbers are withheld.
    WithholdsNumbers,
    /// The data contradict the model, and the numbers are withheld.
    RejectsModel,
}

impl Effect {
    /// Name in the result file.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::WidensSigmas => "widens_sigmas",
            Self::MakesPartial => "makes_partial",
            Self::AgainstAnswer => "against_answer",
            Self::WithholdsNumbers => "withholds_numbers",
            Self::RejectsModel => "rejects_model",
        }
    }

    /// Whether the answer is not reliable.
    pub fn is_against_answer(self) -> bool {
        self >= Self::AgainstAnswer
    }

    /// `self` where a test failed, none where it passed.
    pub fn if_failed(self, failed: bool) -> Self {
        if failed { self } else { Self::None }
    }
}

/// One remark.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// What it is.
    pub kind: RemarkKind,
    /// Name of the test; empty of what is no test.
    pub test: String,
    /// Name and value of the statistic; `None` of a test without one.
    pub statistic: Option<(&'static str, f64)>,
    /// Degrees of freedom of the statistic, or how many numbers were compared.
    pub degrees_of_freedom: Option<usize>,
    /// Probability of a statistic at least as large if model and declared noise are correct.
    pub p: Option<f64>,
    /// Effect on the answer.
    pub effect: Effect,
    /// Factor on every sigma that this test requires; 1 if none.
    pub sigma_factor: f64,
    /// In words.
    pub words: String,
}

impl Remark {
    /// One without effect on the answer, which is no test.
    pub fn new(kind: RemarkKind, words: impl Into<String>) -> Self {
        Self {
            kind,
            test: String::new(),
            statistic: None,
            degrees_of_freedom: None,
            p: None,
            effect: Effect::None,
            sigma_factor: 1.0,
            words: words.into(),
        }
    }

    /// A warning.
    pub fn warning(words: impl Into<String>) -> Self {
        Self::new(RemarkKind::Warning, words)
    }

    /// An assumption.
    pub fn assumption(words: impl Into<String>) -> Self {
        Self::new(RemarkKind::Assumption, words)
    }

    /// A test without statistic.
    pub fn test(test: impl Into<String>, effect: Effect, words: impl Into<String>) -> Self {
        Self {
            test: test.into(),
            effect,
            ..Self::new(RemarkKind::Test, words)
        }
    }

    /// With a statistic.
    pub fn statistic(mut self, name: &'static str, value: f64) -> Self {
        self.statistic = Some((name, value));
        self
    }

    /// With a sum of squares that is chi-square distributed, its degrees of freedom and its p-value.
    pub fn chi_square(self, square: f64, degrees_of_freedom: usize) -> Self {
        let sum = Octave {
            readings: 1,
            numbers: degrees_of_freedom,
            square,
        };
        let mut row = self.statistic(CHI_SQUARE, square);
        row.degrees_of_freedom = Some(degrees_of_freedom);
        row.p = Some(sum.p_value(1.0));
        row
    }

    /// With a factor on every sigma; a larger one widens them.
    pub fn widening(mut self, sigma_factor: f64) -> Self {
        if sigma_factor > 1.0 {
            self.sigma_factor = sigma_factor;
            self.effect = self.effect.max(Effect::WidensSigmas);
        }
        self
    }
}

/// Name of the statistic of [`Remark::chi_square`].
const CHI_SQUARE: &str = "chi-square";

/// The largest factor on every sigma.
pub(crate) fn sigma_factor(rows: &[Remark]) -> f64 {
    rows.iter().map(|r| r.sigma_factor).fold(1.0, f64::max)
}

/// Words of the rows against the answer, in their order, each once.
pub(crate) fn doubts(rows: &[Remark]) -> Vec<String> {
    let against = rows.iter().filter(|r| r.effect.is_against_answer());
    each_once(against.map(|row| row.words.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    #[test]
    fn exact_p_is_the_tail_of_chi_square() {
        for (square, dof) in [(3.84, 1), (18.3, 10), (1100.0, 1000), (5300.0, 5000)] {
            let p = Remark::test("", Effect::None, "").chi_square(square, dof).p;
            let tail = ChiSquared::new(dof as f64).unwrap().sf(square);
            assert!(
                (p.unwrap() / tail - 1.0).abs() < 1.0e-3,
                "{dof}: {p:?} {tail}"
            );
        }
    }

    #[test]
    fn unit_the_strongest_rows_decide() {
        let row = |effect, words| Remark::test("", effect, words);
        let rows = [
            row(Effect::RejectsModel, "a"),
            row(Effect::None, "b").widening(1.5),
            row(Effect::AgainstAnswer, "c").widening(1.2),
            row(Effect::MakesPartial, "d").widening(0.5),
            row(Effect::AgainstAnswer, "c"),
            row(Effect::WithholdsNumbers, "e"),
        ];
        assert_eq!(rows[1].effect, Effect::WidensSigmas);
        assert_eq!(rows[2].effect, Effect::AgainstAnswer);
        assert_eq!(rows[3].effect, Effect::MakesPartial);
        assert_eq!(sigma_factor(&rows), 1.5);
        assert_eq!(doubts(&rows), ["a", "c", "e"]);
        assert_eq!(sigma_factor(&[]), 1.0);
    }
}
