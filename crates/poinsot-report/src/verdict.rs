//! The verdicts: one table for terminal, page and book.

use poinsot_figures::Tone;
use poinsot_formats::EstimateFile;

/// State of a result; the names are those of `estimate.json`.
pub struct Standing<'a> {
    /// Name of the status.
    pub status: &'a str,
    /// Whether the uncertainty of the method is reliable.
    pub covariance_trustworthy: bool,
    /// Whether any evidence is against the result.
    pub doubted: bool,
}

impl<'a> Standing<'a> {
    /// That of an estimate.
    pub fn of(e: &'a EstimateFile) -> Self {
        Self {
            status: &e.status,
            covariance_trustworthy: e.covariance_trustworthy,
            doubted: !e.evidence_against().is_empty(),
        }
    }

    /// The first matching row of [`VERDICTS`].
    fn verdict(&self) -> &'static Verdict {
        let mut rows = VERDICTS.iter();
        rows.find(|v| v.status == self.status && (v.holds)(self))
            .unwrap_or(&UNKNOWN)
    }

    /// Tone and display word.
    pub fn display(&self) -> (Tone, &'static str) {
        let verdict = self.verdict();
        (verdict.tone, verdict.word)
    }
}

/// One verdict: word and colour of a result, with its condition.
pub struct Verdict {
    /// Name of the status in `estimate.json`.
    pub status: &'static str,
    /// Additional condition, as text.
    pub condition: &'static str,
    holds: fn(&Standing) -> bool,
    /// Colour.
    pub tone: Tone,
    /// Display word.
    pub word: &'static str,
    /// Whether every requested number is determined and no evidence contradicts the answer.
    pub passes: bool,
}

/// All verdicts; for a status, the first whose condition holds applies.
pub static VERDICTS: [Verdict; 9] = [
    verdict("converged", DOUBTED, Tone::Bad, "Determined, not reliable"),
    verdict("converged", UNSTATED, Tone::Fair, "Determined").passing(),
    verdict("converged", OTHERWISE, Tone::Good, "Determined").passing(),
    verdict(
        "partial",
        DOUBTED,
        Tone::Bad,
        "Partly determined, not reliable",
    ),
    verdict("partial", UNSTATED, Tone::Fair, "Partly determined"),
    verdict("partial", OTHERWISE, Tone::Fair, "Partly determined"),
    verdict("not_identifiable", ALWAYS, Tone::Bad, "Not determined"),
    verdict("rejected", ALWAYS, Tone::Bad, "Contradicted"),
    verdict("iteration_limit", ALWAYS, Tone::Bad, "Not converged"),
];

/// For a status unknown to this program.
const UNKNOWN: Verdict = verdict("", ALWAYS, Tone::Bad, "Unknown status");

type Condition = (&'static str, fn(&Standing) -> bool);

const DOUBTED: Condition = ("evidence against the answer (`doubts` is not empty)", |s| {
    s.doubted
});
const UNSTATED: Condition = ("the method states no uncertainty", |s| {
    !s.covariance_trustworthy
});
const OTHERWISE: Condition = ("otherwise", |_| true);
const ALWAYS: Condition = ("always", |_| true);

const fn verdict(
    status: &'static str,
    (condition, holds): Condition,
    tone: Tone,
    word: &'static str,
) -> Verdict {
    Verdict {
        status,
        condition,
        holds,
        tone,
        word,
        passes: false,
    }
}

impl Verdict {
    const fn passing(self) -> Self {
        Self {
            passes: true,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_every_verdict_is_reached_and_passes_as_the_answer_does() {
        let mut reached = Vec::new();
        for status in VERDICTS.iter().map(|v| v.status) {
            for (doubted, covariance_trustworthy) in [(true, true), (false, false), (false, true)] {
                let standing = Standing {
                    status,
                    covariance_trustworthy,
                    doubted,
                };
                let verdict = standing.verdict();
                assert_eq!(verdict.passes, status == "converged" && !doubted);
                reached.push(std::ptr::from_ref(verdict));
            }
        }
        let reached = |v: &Verdict| reached.contains(&std::ptr::from_ref(v));
        assert!(VERDICTS.iter().all(reached));
    }

    #[test]
    fn prop_no_answer_with_evidence_against_it_is_called_good() {
        for status in ["converged", "partial"] {
            let doubted = Standing {
                status,
                covariance_trustworthy: false,
                doubted: true,
            };
            let (tone, word) = doubted.display();
            assert_eq!(tone, Tone::Bad);
            assert!(word.ends_with("not reliable"), "{word}");
        }
    }
}
