//! The verdict in words: one source for the terminal and the page.

/// What an answer says of itself; the names are those of `estimate.json`.
pub(crate) struct Standing<'a> {
    pub status: &'a str,
    pub covariance_trustworthy: bool,
    pub doubts: &'a [String],
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

    /// Tone and display word.
    pub fn display(&self) -> (&'static str, &'static str) {
        let row = WORDS.iter().find(|w| w.0 == self.status);
        let (_, word, tone, doubted) = *row.unwrap_or(&WORDS[WORDS.len() - 1]);
        match (self.doubts.is_empty(), self.covariance_trustworthy) {
            (false, _) => ("bad", doubted),
            (true, false) if tone == "good" => ("fair", word),
            (true, _) => (tone, word),
        }
    }
}

/// Status, display word, tone, and the display word where a test of the evidence failed.
const WORDS: [(&str, &str, &str, &str); 5] = [
    (
        "converged",
        "Determined",
        "good",
        "Determined, not reliable",
    ),
    (
        "partial",
        "Partly determined",
        "fair",
        "Partly determined, not reliable",
    ),
    (
        "not_identifiable",
        "Not determined",
        "bad",
        "Not determined",
    ),
    ("rejected", "Contradicted", "bad", "Contradicted"),
    ("iteration_limit", "Not converged", "bad", "Not converged"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_no_words_call_an_answer_good_that_anything_speaks_against() {
        for status in ["converged", "partial"] {
            let doubts = ["a lag of the gyro would explain 90 % of the misfit".to_owned()];
            let doubted = Standing {
                status,
                covariance_trustworthy: false,
                doubts: &doubts,
            };
            assert!(doubted.headline().ends_with(&doubts[0]));
            assert!(doubted.headline().contains("not to be relied on"));
            assert_eq!(doubted.display().0, "bad");
        }
    }
}
