//! The verdict in words: one source for the terminal and the page.

/// Chi-square per degree of freedom below which the declared noise is too large.
const NOISE_TOO_LARGE: f64 = 0.5;

/// What an answer says of itself; the names are those of `estimate.json`.
pub(crate) struct Standing<'a> {
    pub status: &'a str,
    pub covariance_trustworthy: bool,
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

    /// Tone and word of the stated uncertainty: good only where numbers are stated and the residuals have the size of the
    /// declared noise.
    pub fn uncertainty(&self) -> (&'static str, &'static str) {
        match self.status {
            "rejected" | "iteration_limit" | "not_identifiable" => ("bad", "none stated"),
            _ if !self.doubts.is_empty() => ("bad", "not to be relied on"),
            _ if !self.covariance_trustworthy => ("fair", "none that could be relied on"),
            _ if self.chi2 < NOISE_TOO_LARGE => ("fair", "noise declared too large"),
            _ => ("good", "as the declared noise"),
        }
    }

    /// Tone and word of the badge.
    pub fn badge(&self) -> (&'static str, &str) {
        match self.status {
            "converged" if !self.doubts.is_empty() => ("bad", "converged, not to be relied on"),
            "converged" if self.covariance_trustworthy => ("good", "converged"),
            "converged" => ("fair", "converged, without an uncertainty"),
            "partial" if !self.doubts.is_empty() => ("bad", "partial, not to be relied on"),
            "partial" => ("fair", "partial"),
            "not_identifiable" => ("bad", "not identifiable"),
            "rejected" => ("bad", "rejected"),
            "iteration_limit" => ("bad", "not settled"),
            other => ("bad", other),
        }
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
