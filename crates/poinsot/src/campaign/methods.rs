//! The methods of a plan.

use super::faults::PlanText;
use crate::identify::{Question, check_method};
use poinsot_formats::{MethodFile, SettingFile};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MethodChoice {
    /// Name, variant and settings in one line.
    pub label: String,
    pub question: Question,
    pub diagnose: bool,
}

impl MethodChoice {
    /// The methods of a plan; default `auto`.
    pub fn all(files: &[MethodFile], text: &mut PlanText) -> Vec<Self> {
        let usual = [MethodFile {
            name: Question::default().method,
            ..MethodFile::default()
        }];
        let files = if files.is_empty() { &usual } else { files };
        let mut all: Vec<Self> = Vec::new();
        for (k, file) in files.iter().enumerate() {
            let choice = Self::of(file);
            let key = format!("method[{k}].name");
            let faults = check_method(&choice.question).err();
            for fault in faults.iter().flat_map(|error| &error.list) {
                let remedy = match fault.advice.as_str() {
                    "" => "correct it here",
                    advice => advice,
                };
                text.refuse(&key, fault.problem.as_str(), remedy);
            }
            if all.iter().any(|other| other.label == choice.label) {
                let what = format!("the method {} is given twice", choice.label);
                text.refuse(&key, what, "give it once");
            }
            all.push(choice);
        }
        all
    }

    fn of(file: &MethodFile) -> Self {
        let settings: Vec<String> = file
            .set
            .iter()
            .map(|(key, value)| match value {
                SettingFile::Number(x) => format!("{key}={x}"),
                SettingFile::Text(t) => format!("{key}={t}"),
            })
            .collect();
        let words = [&file.name].into_iter().chain(&file.variant);
        let words: Vec<&str> = words.chain(&settings).map(String::as_str).collect();
        Self {
            label: words.join(" "),
            diagnose: file.diagnose,
            question: Question {
                variant: file.variant.clone(),
                settings,
                ..Question::by(&file.name)
            },
        }
    }
}
