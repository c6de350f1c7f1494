//! Every error line ends with what to do.

/// Verbs that start the advice.
const WORDS: &[&str] = &[
    "accept",
    "add",
    "begin",
    "bring",
    "change",
    "check",
    "choose",
    "complete",
    "connect",
    "convert",
    "copy",
    "correct",
    "count",
    "cut",
    "declare",
    "describe",
    "did you mean",
    "drive",
    "end",
    "expand",
    "fire",
    "fix",
    "free",
    "give",
    "increase",
    "keep",
    "lead",
    "leave",
    "let",
    "lower",
    "make",
    "map",
    "move",
    "name",
    "normalise",
    "prescribe",
    "raise",
    "read",
    "reduce",
    "remove",
    "rename",
    "report",
    "restore",
    "reverse",
    "run",
    "save",
    "separate",
    "set",
    "sort",
    "split",
    "state",
    "store",
    "take",
    "unpack",
    "use",
    "write",
];

/// Words allowed before the verb.
const BEFORE: &[&str] = &["please ", "if need be ", "its unit is likely "];

/// The text after a semicolon, or for E0218 after its colon, starts with an imperative.
pub fn says_what_to_do(line: &str) -> bool {
    line.match_indices("; ")
        .map(|(at, _)| line.get(at + 2..).unwrap_or_default())
        .any(|rest| {
            let rest = BEFORE
                .iter()
                .find_map(|b| rest.strip_prefix(b))
                .unwrap_or(rest);
            WORDS.iter().any(|w| {
                rest.strip_prefix(w)
                    .is_some_and(|r| !r.starts_with(char::is_alphanumeric))
            })
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_an_error_without_advice_is_noticed() {
        for (line, good) in [
            ("E0203 t.csv:5 column 'x': 'abc' is not a number", false),
            (
                "E0203 t.csv:5 column 'x': 'abc' is not a number; write a number",
                true,
            ),
            (
                "E0211 unit 'rad/ss' is not known; did you mean 'rad/s'?",
                true,
            ),
            ("E0303 t.csv: 1 samples; at least 2 are needed", false),
            (
                "E0101 m.toml: larger than 16 MiB; is it a model file?",
                false,
            ),
            ("E0202 t.csv: damaged; it is not CSV; give another", true),
            ("E0002 x; useless", false),
        ] {
            assert_eq!(says_what_to_do(line), good, "{line}");
        }
    }
}
