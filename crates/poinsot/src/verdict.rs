//! The verdict in words: one source for the terminal and the page.

/// Chi-square per degree of freedom below which the declared noise is too large.
const NOISE_TOO_LARGE: f64 = 0.5;

/// What an answer says of itself; the names are those of `estimate.json`.
pub struct Standing<'a> {
    /// Name of the status.
    pub status: &'a str,
    /// Whether the method states an uncertainty that can be relied on.
    pub covariance_trustworthy: bool,
    /// Evidence against the answer.
    pub doubts: &'a [String],
    /// Largest chi-square per degree of freedom of a segment.
    pub chi2: f64,
}

impl Standing<'_> {
    /// The answer in a clause, for the first line.
    pub fn headline(&self) -> String {
        let what = match self.status {
            "converged" => "every number asked for is determined",
            "partial" => "part of what was asked for is determined",
            "not_identifiable" => "nothing that was asked for is determined",
            "rejected" => "the rigid model contradicts the data; no number is given",
            _ => "the iteration did not settle",
        };
        match (self.status, self.doubts.first()) {
            ("converged", Some(why)) => format!("{what}, but not to be relied on: {why}"),
            ("partial", Some(why)) => format!("{what}, and not to be relied on: {why}"),
            _ => what.to_owned(),
        }
    }

    /// Whether the stated uncertainty can be relied on, in a sentence.
    pub fn reliance(&self) -> String {
        if !self.doubts.is_empty() {
            let all = self.doubts.join("; ");
            return format!("The stated uncertainty is not to be relied on: {all}.");
        }
        let words = match (self.covariance_trustworthy, self.chi2 < NOISE_TOO_LARGE) {
            (false, _) => "The method states no uncertainty that could be relied on.",
            (true, true) => {
                "The residuals are far smaller than the declared noise (a noise-free file, or noise declared too large); the stated uncertainty follows the declared noise."
            }
            (true, false) => {
                "No sensor's residual is larger than its declared noise by more than a tenth, and none is correlated in time beyond chance, so the stated uncertainty can be relied on as far as that noise is right."
            }
        };
        words.to_owned()
    }

    /// The row of [`VERDICTS`] that holds.
    fn verdict(&self) -> &'static Verdict {
        let mut rows = VERDICTS.iter();
        rows.find(|v| v.status == self.status && (v.holds)(self))
            .unwrap_or(&UNKNOWN)
    }

    /// Tone and word of the stated uncertainty: good only where numbers are stated and the residuals have the size of the
    /// declared noise.
    pub fn uncertainty(&self) -> (&'static str, &'static str) {
        self.verdict().uncertainty
    }

    /// Tone and word of the badge.
    pub fn badge(&self) -> (&'static str, &'static str) {
        self.verdict().badge
    }
}

/// One verdict: the words and colours of an answer, with the condition that sets them.
pub struct Verdict {
    /// Name of the status in `estimate.json`.
    pub status: &'static str,
    /// What else must hold, in words.
    pub condition: &'static str,
    holds: fn(&Standing) -> bool,
    /// Colour (good: green, fair: amber, bad: red) and word of the badge.
    pub badge: (&'static str, &'static str),
    /// The same of the stated uncertainty.
    pub uncertainty: (&'static str, &'static str),
    /// Exit code of `identify`.
    pub exit: u8,
}

/// Every verdict; of those of a status the first whose condition holds.
pub const VERDICTS: [Verdict; 11] = [
    verdict(
        (
            "converged",
            "any evidence against the answer (`doubts`)",
            |s| !s.doubts.is_empty(),
        ),
        ("bad", "converged, not to be relied on"),
        ("bad", "not to be relied on"),
        1,
    ),
    verdict(
        ("converged", "the method states no uncertainty", |s| {
            !s.covariance_trustworthy
        }),
        ("fair", "converged, without an uncertainty"),
        ("fair", "none that could be relied on"),
        0,
    ),
    verdict(
        (
            "converged",
            "chi-square per degree of freedom below 0.5",
            |s| s.chi2 < NOISE_TOO_LARGE,
        ),
        ("good", "converged"),
        ("fair", "noise declared too large"),
        0,
    ),
    verdict(
        ("converged", "otherwise", |_| true),
        ("good", "converged"),
        ("good", "as the declared noise"),
        0,
    ),
    verdict(
        (
            "partial",
            "any evidence against the answer (`doubts`)",
            |s| !s.doubts.is_empty(),
        ),
        ("bad", "partial, not to be relied on"),
        ("bad", "not to be relied on"),
        1,
    ),
    verdict(
        ("partial", "the method states no uncertainty", |s| {
            !s.covariance_trustworthy
        }),
        ("fair", "partial"),
        ("fair", "none that could be relied on"),
        1,
    ),
    verdict(
        (
            "partial",
            "chi-square per degree of freedom below 0.5",
            |s| s.chi2 < NOISE_TOO_LARGE,
        ),
        ("fair", "partial"),
        ("fair", "noise declared too large"),
        1,
    ),
    verdict(
        ("partial", "otherwise", |_| true),
        ("fair", "partial"),
        ("good", "as the declared noise"),
        1,
    ),
    verdict(
        ("not_identifiable", "always", |_| true),
        ("bad", "not identifiable"),
        ("bad", "none stated"),
        1,
    ),
    verdict(
        ("rejected", "always", |_| true),
        ("bad", "rejected"),
        ("bad", "none stated"),
        1,
    ),
    verdict(
        ("iteration_limit", "always", |_| true),
        ("bad", "not settled"),
        ("bad", "none stated"),
        1,
    ),
];

/// Of a status that no answer of this program has.
const UNKNOWN: Verdict = verdict(
    ("", "", |_| true),
    ("bad", "unknown status"),
    ("bad", "none stated"),
    1,
);

const fn verdict(
    (status, condition, holds): (&'static str, &'static str, fn(&Standing) -> bool),
    badge: (&'static str, &'static str),
    uncertainty: (&'static str, &'static str),
    exit: u8,
) -> Verdict {
    Verdict {
        status,
        condition,
        holds,
        badge,
        uncertainty,
        exit,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_an_uncertainty_is_good_only_where_numbers_and_noise_are() {
        let of = |status, chi2| {
            let standing = Standing {
                status,
                covariance_trustworthy: true,
                doubts: &[],
                chi2,
            };
            standing.uncertainty().0
        };
        assert_eq!(of("converged", 1.0), "good");
        assert_eq!(of("converged", 2.0e-14), "fair");
        for status in ["rejected", "iteration_limit", "not_identifiable"] {
            assert_eq!(of(status, 1.0), "bad");
        }
    }

    #[test]
    fn exact_every_verdict_is_reached_and_its_exit_code_is_that_of_the_answer() {
        let doubts = ["a lag".to_owned()];
        let mut reached = Vec::new();
        for status in [
            "converged",
            "partial",
            "not_identifiable",
            "rejected",
            "iteration_limit",
        ] {
            for (doubts, covariance_trustworthy, chi2) in [
                (&doubts[..], true, 1.0),
                (&[][..], false, 1.0),
                (&[][..], true, 1.0e-9),
                (&[][..], true, 1.0),
            ] {
                let standing = Standing {
                    status,
                    covariance_trustworthy,
                    doubts,
                    chi2,
                };
                let verdict = standing.verdict();
                assert_eq!(
                    verdict.exit,
                    u8::from(status != "converged" || !doubts.is_empty())
                );
                reached.push(std::ptr::from_ref(verdict));
            }
        }
        assert!(
            VERDICTS
                .iter()
                .all(|v| reached.contains(&std::ptr::from_ref(v)))
        );
    }

    #[test]
    fn prop_no_words_call_an_answer_good_that_anything_speaks_against() {
        for status in ["converged", "partial"] {
            for chi2 in [0.0, 0.9, 1.0, 1.4] {
                let doubts = ["a lag of the gyro would explain 90 % of the misfit".to_owned()];
                let doubted = Standing {
                    status,
                    covariance_trustworthy: false,
                    doubts: &doubts,
                    chi2,
                };
                assert!(doubted.headline().ends_with(&doubts[0]));
                assert!(doubted.headline().contains("not to be relied on"));
                assert!(doubted.reliance().contains("is not to be relied on"));
                assert_eq!(doubted.badge().0, "bad");
            }
        }
    }
}
