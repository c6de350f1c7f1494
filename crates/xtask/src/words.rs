//! The words of docs/words.txt: which the project does not use, and what it writes instead.

use crate::fault::Fault;
use crate::repository::{pattern, read, root};
use regex::Regex;
use std::collections::HashMap;

/// Entries below this line are for messages of the program alone.
const OF_MESSAGES: &str = "# messages\n";

/// Words to avoid, with the words to write.
pub struct Words {
    instead: HashMap<String, String>,
    pattern: Regex,
}

impl Words {
    /// All entries, for messages of the program.
    pub fn of_messages() -> Result<Self, Fault> {
        Self::new(&read(&root().join("docs/words.txt"))?)
    }

    /// Entries for pages.
    pub fn of_pages() -> Result<Self, Fault> {
        let all = read(&root().join("docs/words.txt"))?;
        Self::new(all.split(OF_MESSAGES).next().unwrap_or_default())
    }

    fn new(list: &str) -> Result<Self, Fault> {
        let lines = list.lines().filter(|line| !line.starts_with('#'));
        let entries = lines.filter_map(|line| line.split_once("=>"));
        let instead: HashMap<_, _> = entries
            .map(|(before, after)| (before.trim().to_lowercase(), after.trim().to_owned()))
            .collect();
        let mut longest_first: Vec<_> = instead.keys().map(|word| regex::escape(word)).collect();
        longest_first.sort_by_key(|word| (std::cmp::Reverse(word.len()), word.clone()));
        let any = longest_first.join("|").replace(' ', r"\s+");
        let pattern = pattern(&format!(r"(?i)(?:^|[^\w-])({any})(?:$|[^\w-])"))?;
        Ok(Self { instead, pattern })
    }

    /// Every word to avoid in a text, with what to write.
    pub fn found_in(&self, text: &str) -> Vec<(String, &str)> {
        let mut found = Vec::new();
        let mut from = 0;
        while let Some(word) = self.pattern.captures_at(text, from).and_then(|c| c.get(1)) {
            let lower = word.as_str().to_lowercase();
            let used = lower.split_whitespace().collect::<Vec<_>>().join(" ");
            let write = self.instead.get(&used).map_or("", String::as_str);
            found.push((used, write));
            // One separator may end this word and begin the next.
            from = word.end();
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_words_are_found_whole_and_longest_first() {
        let words =
            Words::new("# a => b\nreadings => samples\nled joint => x\na reading => y\n").unwrap();
        let found = |text| {
            words
                .found_in(text)
                .into_iter()
                .map(|(w, _)| w)
                .collect::<Vec<_>>()
        };
        assert_eq!(found("Readings readings, READINGS"), ["readings"; 3]);
        assert_eq!(found("led\n  joint"), ["led joint"]);
        assert!(found("re-readings misled jointly readings-x").is_empty());
        assert_eq!(words.found_in("a reading"), [("a reading".to_owned(), "y")]);
    }
}
