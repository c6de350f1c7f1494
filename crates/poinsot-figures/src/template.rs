//! Templates (minijinja) of pages and terminal texts, with the formats of their numbers. Text from files is escaped; only
//! HTML made by this program is inserted unescaped.

use crate::document::{BAR, Document, Tone};
use crate::error::PageError;
use minijinja::{AutoEscape, Environment, Error, Output, State, Value, escape_formatter};
use poinsot_files::{
    HALF_WIDTH_95, counted, escaped, is_unprintable, json_escaped, number_with_sigma, probability,
    rounded, short, significant,
};
use serde::Serialize;

/// Name of the escaping of terminal texts.
const TEXT: AutoEscape = AutoEscape::Custom("text");

/// HTML that this program made, safe to place in a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Html(pub(crate) String);

impl Html {
    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// For a template: inserted unescaped.
    pub fn value(&self) -> Value {
        Value::from_safe_string(self.0.clone())
    }
}

/// Templates by name; one may import another. Those of names in `.txt` are terminal texts, others HTML.
///
/// | filter | text |
/// |---|---|
/// | `sig(n)`, `rounded(n)`, `short` | significant digits; at most `n` or six without trailing zeros |
/// | `fixed(n)`, `signed(n)`, `sci(n)` | decimals; with a sign; with an exponent |
/// | `prob` | a probability |
/// | `value(sigma)`, `sigma(value)` | value and sigma with the digits of the sigma |
/// | `change(sigma)`, `half` | the same of a difference, with its sign; half of the 95 % interval |
/// | `interval(factor, n)` | value and 95 % interval |
/// | `over(x)`, `times(x)`, `exp` | arithmetic |
/// | `counted(noun)` | a count with its noun |
///
/// A missing number gives none, which prints nothing.
///
/// ```
/// use poinsot_figures::Templates;
///
/// const TEXT: &str = "{{ verdict }}\n# numbers\n| | kg |\n| mass | {{ m|fixed(1) }} |\n- a sentence\n";
/// const HTML: &str = "<p>{{ verdict }}: {{ m|sig(2) }}{{ missing|sig(2) }}</p>";
/// let templates = Templates::new(&[("a.html", HTML), ("a.txt", TEXT)]);
/// let context = minijinja::context! { verdict => "a < b", m => 1.234 };
/// assert_eq!(templates.html("a.html", &context)?.as_str(), "<p>a &lt; b: 1.2</p>");
/// let document = templates.document("a.txt", &context);
/// assert_eq!(document.to_string(), "a < b\n\nnumbers\n         kg\n  mass  1.2\n  a sentence\n");
/// # Ok::<(), poinsot_figures::PageError>(())
/// ```
#[derive(Debug)]
pub struct Templates(Environment<'static>);

impl Templates {
    /// From names and texts.
    pub fn new(all: &'static [(&'static str, &'static str)]) -> Self {
        let mut environment = Environment::new();
        environment.set_loader(|name| {
            let found = all.iter().find(|(own, _)| *own == name);
            Ok(found.map(|(_, text)| (*text).to_owned()))
        });
        environment.set_auto_escape_callback(|name| match name.ends_with(".txt") {
            true => TEXT,
            false => AutoEscape::Html,
        });
        environment.set_formatter(write_value);
        environment.set_trim_blocks(true);
        environment.set_lstrip_blocks(true);
        add_filters(&mut environment);
        Self(environment)
    }

    /// HTML of a template; every value but [`Html`] is escaped.
    ///
    /// # Errors
    /// The template is faulty or does not fit its context.
    pub fn html(&self, name: &str, context: impl Serialize) -> Result<Html, PageError> {
        self.rendered(name, context).map(Html)
    }

    /// Document of a template, whose lines are: verdict, then `# title` (`#bad title` with a tone), `| cell | cell |`, of
    /// which the first is the head, `- sentence`, `> note`. A section without rows and sentences is left out.
    ///
    /// A fault of a template is the verdict of its document.
    pub fn document(&self, name: &str, context: impl Serialize) -> Document {
        match self.rendered(name, context) {
            Ok(text) => Document::parse(&text),
            Err(error) => Document::new(error.to_string()).toned(Tone::Bad),
        }
    }

    /// Lines of a terminal text. A fault of the template is its line.
    pub fn lines(&self, name: &str, context: impl Serialize) -> Vec<String> {
        let text = match self.rendered(name, context) {
            Ok(text) => text.replace(BAR, "|"),
            Err(error) => error.to_string(),
        };
        let lines = text.lines().filter(|line| !line.is_empty());
        lines.map(str::to_owned).collect()
    }

    fn rendered(&self, name: &str, context: impl Serialize) -> Result<String, PageError> {
        let made = self.0.get_template(name).and_then(|t| t.render(context));
        made.map_err(|source| PageError::Template {
            name: name.to_owned(),
            source,
        })
    }
}

fn write_value(out: &mut Output, state: &State, value: &Value) -> Result<(), Error> {
    let html = state.auto_escape() == AutoEscape::Html;
    match value.as_str() {
        _ if value.is_none() || value.is_undefined() => Ok(()),
        Some(text) if value.is_safe() => Ok(out.write_str(text)?),
        Some(text) if html => Ok(out.write_str(&escape(text))?),
        Some(text) => Ok(out.write_str(&escaped(text).replace('|', &BAR.to_string()))?),
        None if html => escape_formatter(out, state, value),
        None => Ok(write!(out, "{value}")?),
    }
}

fn add_filters(e: &mut Environment) {
    type Number = Option<f64>;
    e.add_filter("sig", |x: Number, n: i32| x.map(|x| significant(x, n)));
    e.add_filter("rounded", |x: Number, n: usize| x.map(|x| rounded(x, n)));
    e.add_filter("short", |x: Number| x.map(short));
    let finite = |x: Number| x.filter(|x| x.is_finite());
    e.add_filter("fixed", move |x: Number, n: usize| {
        finite(x).map(|x| format!("{x:.n$}"))
    });
    e.add_filter("signed", move |x: Number, n: usize| {
        finite(x).map(|x| format!("{x:+.n$}"))
    });
    e.add_filter("sci", |x: Number, n: usize| x.map(|x| format!("{x:.n$e}")));
    e.add_filter("prob", |p: Number| p.map(probability));
    e.add_filter("value", |x: Number, sigma: Number| {
        x.map(|_| number_with_sigma(x, sigma).0)
    });
    e.add_filter("sigma", |sigma: Number, x: Number| {
        number_with_sigma(x, sigma).1
    });
    e.add_filter("change", change);
    e.add_filter("half", |sigma: Number| {
        half_width(sigma).map(|half| format!("\u{b1}{}", significant(half, 2)))
    });
    e.add_filter("times", |x: Number, by: Number| Some(x? * by?));
    e.add_filter("over", |x: Number, by: Number| Some(x? / by?));
    e.add_filter("exp", |x: Number| x.map(f64::exp));
    e.add_filter("interval", interval);
    e.add_filter("counted", |n: u64, noun: &str| counted(n, noun));
}

/// A signed difference, with the digits of its sigma; zero has no sign.
fn change(gap: f64, sigma: Option<f64>) -> String {
    let text = number_with_sigma(Some(gap), sigma).0;
    match gap > 0.0 && text.contains(|c: char| ('1'..='9').contains(&c)) {
        true => format!("+{text}"),
        false => text,
    }
}

/// `95.1 [94.2, 95.8]`; none if the value is not finite.
fn interval(x: Value, factor: f64, decimals: usize) -> Option<String> {
    let text = |key: &str| {
        let v = factor * f64::try_from(x.get_attr(key).ok()?).ok()?;
        v.is_finite().then(|| format!("{v:.decimals$}"))
    };
    let value = text("value")?;
    Some(match text("low").zip(text("high")) {
        Some((low, high)) => format!("{value} [{low}, {high}]"),
        None => value,
    })
}

/// Half width of the 95 % interval; `None` without sigma.
///
/// ```
/// assert_eq!(poinsot_figures::half_width(None), None);
/// ```
pub fn half_width(sigma: Option<f64>) -> Option<f64> {
    let sigma = sigma.filter(|s| *s > 0.0 && s.is_finite())?;
    Some(HALF_WIDTH_95 * sigma)
}

/// Escapes text for element content and quoted attributes. Unprintable characters become escapes (`\u{202e}`); line
/// ends and tabs are kept.
///
/// ```
/// use poinsot_figures::escape;
///
/// assert_eq!(escape("a < \"b\""), "a &lt; &quot;b&quot;");
/// ```
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if is_unprintable(c) => out.extend(c.escape_default()),
            c => out.push(c),
        }
    }
    out
}

/// JSON for a `<script type="application/json">`: no text in it can close the element.
///
/// # Errors
/// The value has no JSON form.
///
/// ```
/// use poinsot_figures::island;
///
/// // No text can close the element.
/// assert!(!island(&"</script>")?.as_str().contains('<'));
/// # Ok::<(), poinsot_figures::PageError>(())
/// ```
pub fn island(value: &impl Serialize) -> Result<Html, PageError> {
    let text = serde_json::to_string(value)?;
    let mut out = String::with_capacity(text.len());
    for c in json_escaped(&text).chars() {
        match c {
            '<' | '>' | '&' => {
                out.push_str(&format!("\\u{:04x}", u32::from(c)));
            }
            c => out.push(c),
        }
    }
    Ok(Html(out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use minijinja::context;

    #[test]
    fn unit_island_cannot_be_left() {
        let text = island(&"</script><!--\u{2028}&").unwrap();
        assert_eq!(
            text.as_str(),
            r#""\u003c/script\u003e\u003c!--\u2028\u0026""#
        );
        let back: String = serde_json::from_str(text.as_str()).unwrap();
        assert_eq!(back, "</script><!--\u{2028}&");
    }

    const LINES: &str = "{{ x }}\n# {{ x }}\n| {{ x }} |\n| {{ x }} |\n- {{ x }}\n> {{ x }}\n";

    fn templates() -> Templates {
        Templates::new(&[("page.html", "<b>{{ x }}</b>"), ("text.txt", LINES)])
    }

    #[test]
    fn exact_direction_marks_and_escapes_are_shown() {
        let bad = "a\u{202e}b\u{1b}[2J";
        let page = templates()
            .html("page.html", context! { x => bad })
            .unwrap();
        assert_eq!(page.as_str(), "<b>a\\u{202e}b\\u{1b}[2J</b>");
        assert_eq!(island(&bad).unwrap().as_str(), "\"a\\u202eb\\u001b[2J\"");
    }

    #[test]
    fn unit_templates_escape_all_but_own_markup() {
        let own = templates()
            .html("page.html", context! { x => "<i>'\"" })
            .unwrap();
        assert_eq!(own.as_str(), "<b>&lt;i&gt;&#39;&quot;</b>");
        let page = templates()
            .html("page.html", context! { x => own.value() })
            .unwrap();
        assert_eq!(page.as_str(), format!("<b>{}</b>", own.as_str()));
    }

    #[test]
    fn unit_zero_has_no_sign_and_a_gain_has_one() {
        assert_eq!(change(-0.001, Some(0.16)), "0.00");
        assert_eq!(change(0.001, Some(0.16)), "0.00");
        assert_eq!(change(1.5, Some(0.16)), "+1.50");
    }

    /// Text of a file makes no section, row or cell.
    #[test]
    fn unit_hostile_text_stays_in_its_cell() {
        for x in ["a | b", "a\n# b", "|", "- a\n> b", "a\u{1f}b\r\n| c"] {
            let document = templates().document("text.txt", context! { x });
            let [section] = &document.sections[..] else {
                panic!("{x:?}: {document:?}");
            };
            let shown = poinsot_files::escaped(x);
            assert_eq!(section.rows, [[shown.clone()]]);
            for text in [&document.verdict, &section.title, &section.lines[0]] {
                assert_eq!(*text, shown);
            }
        }
    }
}
