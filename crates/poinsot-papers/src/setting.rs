//! Settings of a published method, `key=value`.

use poinsot_files::Faults;
pub use poinsot_formats::ListedSettingFile as SettingText;

/// Settings of a method as given; unknown keys are rejected by [`Settings::check`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings(Vec<(String, String)>);

impl Settings {
    /// Parses `key=value` texts.
    ///
    /// # Errors
    /// A text without `=`, or a key given twice.
    pub fn parse<T: AsRef<str>>(texts: &[T]) -> Result<Self, Faults> {
        let mut all: Vec<(String, String)> = Vec::new();
        for text in texts {
            let refuse =
                |problem: &str, advice| Faults::usage("--set", text.as_ref(), problem, advice);
            let Some((key, value)) = text.as_ref().split_once('=') else {
                return Err(refuse("it is not KEY=VALUE", "write KEY=VALUE"));
            };
            let (key, value) = (key.trim(), value.trim());
            if all.iter().any(|(other, _)| other == key) {
                return Err(refuse("it is set twice", "set it once"));
            }
            all.push((key.to_owned(), value.to_owned()));
        }
        Ok(Self(all))
    }

    /// Returns an error for unknown keys.
    ///
    /// # Errors
    /// The first unknown key, with the valid ones.
    pub fn check(&self, method: &str, known: &[SettingText]) -> Result<(), Faults> {
        let has = |key: &str| known.iter().any(|s| s.key == key);
        let Some((key, value)) = self.0.iter().find(|(key, _)| !has(key)) else {
            return Ok(());
        };
        let keys: Vec<&str> = known.iter().map(|s| s.key).collect();
        let (what, advice) = match known.is_empty() {
            true => ("settings", "leave it out".to_owned()),
            false => ("such setting", format!("use one of {}", keys.join(", "))),
        };
        let problem = format!("{method} has no {what}");
        Err(refused(key, value, &problem, advice))
    }

    /// The value of a key as given.
    pub fn text(&self, key: &str) -> Option<&str> {
        let found = self.0.iter().find(|(k, _)| k == key);
        found.map(|(_, value)| value.as_str())
    }

    /// A number within limits; `None` if not set.
    ///
    /// # Errors
    /// The value is not a number, or outside the limits.
    pub fn number(&self, key: &str, least: f64, most: f64) -> Result<Option<f64>, Faults> {
        let Some(text) = self.text(key) else {
            return Ok(None);
        };
        match text.parse::<f64>() {
            Ok(x) if (least..=most).contains(&x) => Ok(Some(x)),
            _ => {
                let advice = format!("give a number from {least} to {most}");
                Err(refused(key, text, "it is out of range", advice))
            }
        }
    }

    /// An integer within limits; `None` if not set.
    ///
    /// # Errors
    /// As [`Self::number`], or the number is not an integer.
    pub fn count(&self, key: &str, least: u32, most: u32) -> Result<Option<u32>, Faults> {
        let found = self.number(key, f64::from(least), f64::from(most))?;
        match found {
            Some(x) if x.fract() != 0.0 => {
                let problem = "it is not a whole number";
                Err(refused(key, x, problem, "give one"))
            }
            other => Ok(other.map(|x| x as u32)),
        }
    }
}

/// A refused setting.
pub(crate) fn refused(
    key: &str,
    value: impl std::fmt::Display,
    problem: &str,
    advice: impl Into<String>,
) -> Faults {
    Faults::usage("--set", format!("{key}={value}"), problem, advice)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const KNOWN: [SettingText; 1] = [SettingText {
        key: "particles",
        summary: "how many",
        default: "50",
    }];

    #[test]
    fn unit_settings_are_read_and_refused_in_words() {
        let settings = Settings::parse(&["particles = 20"]).unwrap();
        settings.check("xu2017", &KNOWN).unwrap();
        assert_eq!(settings.count("particles", 1, 100).unwrap(), Some(20));
        assert_eq!(settings.count("other", 1, 100).unwrap(), None);
        for (texts, limit, words) in [
            (vec!["particles"], 100, "write KEY=VALUE"),
            (vec!["particles=1", "particles=2"], 100, "set twice"),
            (vec!["particle=1"], 100, "use one of particles"),
            (vec!["particles=1.5"], 100, "whole number"),
            (vec!["particles=20"], 10, "from 1 to 10"),
            (vec!["particles=NaN"], 10, "from 1 to 10"),
        ] {
            let why = Settings::parse(&texts)
                .and_then(|s| s.check("xu2017", &KNOWN).map(|()| s))
                .and_then(|s| s.count("particles", 1, limit))
                .unwrap_err()
                .to_string();
            assert!(
                why.starts_with("E0001 --set") && why.contains(words),
                "{why}"
            );
        }
    }
}
