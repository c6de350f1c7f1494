//! A model file with questions, and their answers.

use crate::error::Error;
use crate::file_head::quoted;
use indexmap::IndexMap;
use poinsot_formats::QuestionFile;
use poinsot_model::parse_model;

/// What stands for an answer.
const OPEN: &str = "\"?\"";
/// What begins a question.
const MARK: &str = "# ? ";

/// A model file with questions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Draft {
    /// The text.
    pub text: String,
}

impl Draft {
    /// The questions that have no answer, in the order of their lines. Lines with one question share its answer.
    ///
    /// ```
    /// let draft = poinsot::Draft { text: "mass_kg = \"?\"   # ? mass, kg\n".to_owned() };
    /// let questions = draft.questions();
    /// assert_eq!((questions[0].lines[0], questions[0].text.as_str()), (1, "mass, kg"));
    /// ```
    pub fn questions(&self) -> Vec<QuestionFile> {
        let mut all: IndexMap<String, Vec<usize>> = IndexMap::new();
        let open = (1..).zip(self.text.lines());
        let open = open.filter(|(_, line)| line.contains(OPEN));
        for (k, text) in open.filter_map(|(k, line)| Some((k, line.split_once(MARK)?.1))) {
            all.entry(text.to_owned()).or_default().push(k);
        }
        let question = |(text, lines)| QuestionFile { lines, text };
        all.into_iter().map(question).collect()
    }

    /// Writes an answer in place of the marks of a question: a number, a word, or values with blanks between them.
    ///
    /// # Errors
    /// What the model file says of the answer; the draft is then unchanged.
    ///
    /// ```
    /// let text = "schema = \"poinsot.model/1\"\n[[body]]\nname = \"bus\"\nmass_kg = \"?\"   # ? mass, kg\n";
    /// let mut draft = poinsot::Draft { text: text.to_owned() };
    /// let question = draft.questions().remove(0);
    /// assert!(draft.answer(&question, "-3").is_err());
    /// draft.answer(&question, "12.5").unwrap();
    /// assert!(draft.text.contains("mass_kg = 12.5") && draft.questions().is_empty());
    /// ```
    pub fn answer(&mut self, question: &QuestionFile, answer: &str) -> Result<(), Error> {
        let mut text = String::new();
        for (k, line) in self.text.lines().enumerate() {
            match question.lines.contains(&(k + 1)) {
                true => text.push_str(&answered(line, answer)),
                false => text.push_str(line),
            }
            text.push('\n');
        }
        if let Err(faults) = parse_model(&text, "answer") {
            let own = |line: &usize| faults.list.iter().find(|f| f.place.line == *line as u64);
            if let Some(fault) = question.lines.iter().find_map(own) {
                return Err(fault.clone().into());
            }
        }
        self.text = text;
        Ok(())
    }
}

/// A line with its marks replaced.
fn answered(line: &str, answer: &str) -> String {
    let (code, comment) = line.split_once(MARK).unwrap_or((line, ""));
    let parts = answer.split([' ', ',', '[', ']']);
    let parts: Vec<String> = parts.filter(|word| !word.is_empty()).map(value).collect();
    let open = code.matches(OPEN).count();
    let numbers = parts.iter().all(|part| part.parse::<f64>().is_ok());
    let values = match parts.len() {
        many if many > 1 && many == open => parts,
        many if many > 1 && numbers => vec![format!("[{}]", parts.join(", ")); open],
        _ => vec![value(answer.trim()); open],
    };
    let code = values
        .iter()
        .fold(code.to_owned(), |code, value| code.replacen(OPEN, value, 1));
    format!("{}   # {comment}", code.trim_end())
}

/// A value as TOML writes it.
fn value(answer: &str) -> String {
    let is_toml = || format!("x = {answer}").parse::<toml::Table>().is_ok();
    match answer.parse::<f64>() {
        Ok(number) if number.is_finite() => format!("{number:?}"),
        _ if is_toml() => answer.to_owned(),
        _ => quoted(answer),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_an_answer_is_checked_on_its_line() {
        let text = "schema = \"poinsot.model/1\"\n[[body]]\nname = \"bus\"\nmass_kg = \"?\"   # ? mass, kg\n\
                    inertia_kg_m2 = { xx = \"?\", yy = \"?\", zz = \"?\" }   # ? moments\n";
        let mut draft = Draft {
            text: text.to_owned(),
        };
        let [mass, moments] = &draft.questions()[..] else {
            panic!("{:?}", draft.questions());
        };
        assert!(draft.answer(mass, "-3").is_err());
        draft.answer(mass, "12.5").unwrap();
        draft.answer(moments, "1 2, 2.5").unwrap();
        assert!(draft.text.contains("mass_kg = 12.5   # mass, kg\n"));
        let filled = "inertia_kg_m2 = { xx = 1.0, yy = 2.0, zz = 2.5 }   # moments\n";
        assert!(draft.text.ends_with(filled), "{}", draft.text);
        assert!(draft.questions().is_empty());
    }

    #[test]
    fn unit_an_answer_becomes_a_value() {
        for (answer, line) in [
            ("deg/s", "x = \"deg/s\"   # unit"),
            ("\"rpm\"", "x = \"rpm\"   # unit"),
            ("0 1 0", "x = [0.0, 1.0, 0.0]   # unit"),
            ("[\"mass\", \"com\"]", "x = [\"mass\", \"com\"]   # unit"),
            ("true", "x = true   # unit"),
        ] {
            assert_eq!(answered("x = \"?\"   # ? unit", answer), line);
        }
    }
}
