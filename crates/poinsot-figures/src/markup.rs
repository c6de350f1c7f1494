//! Escapes text from files for HTML; only HTML made by this program is inserted unescaped.

use crate::error::PageError;
use minijinja::{AutoEscape, Environment, Value, escape_formatter};
use poinsot_files::{is_unprintable, json_escaped};
use serde::Serialize;

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

    /// Two columns.
    pub fn pair(parts: &[Self]) -> Self {
        Self(format!("<div class=\"pair\">{}</div>", Self::join(parts).0))
    }

    /// One after the other.
    pub fn join(parts: &[Self]) -> Self {
        Self(parts.iter().map(Self::as_str).collect())
    }
}

/// Renders a template; every value but [`Html`] is escaped.
///
/// # Errors
/// The template or its context is faulty.
///
/// ```
/// use poinsot_figures::render;
///
/// // Values are escaped.
/// let values = std::collections::BTreeMap::from([("name", "a < b")]);
/// let html = render("title", "<h1>{{ name }}</h1>", values)?;
/// assert_eq!(html.as_str(), "<h1>a &lt; b</h1>");
/// # Ok::<(), poinsot_figures::PageError>(())
/// ```
pub fn render(name: &str, template: &str, context: impl Serialize) -> Result<Html, PageError> {
    let fault = |source| PageError::Template {
        name: name.to_owned(),
        source,
    };
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.set_formatter(|out, state, value| match value.as_str() {
        Some(text) if !value.is_safe() => Ok(out.write_str(&escape(text))?),
        _ => escape_formatter(out, state, value),
    });
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment
        .render_named_str(name, template, context)
        .map(Html)
        .map_err(fault)
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

    #[test]
    fn exact_direction_marks_and_escapes_are_shown() {
        let bad = "a\u{202e}b\u{1b}[2J";
        let page = render("page", "{{ x }}", minijinja::context! { x => bad }).unwrap();
        assert_eq!(page.as_str(), "a\\u{202e}b\\u{1b}[2J");
        assert_eq!(island(&bad).unwrap().as_str(), "\"a\\u202eb\\u001b[2J\"");
    }

    #[test]
    fn unit_templates_escape_all_but_own_markup() {
        let own = render(
            "own",
            "<b>{{ x }}</b>",
            minijinja::context! { x => "<i>'\"" },
        )
        .unwrap();
        assert_eq!(own.as_str(), "<b>&lt;i&gt;&#39;&quot;</b>");
        let page = render("page", "{{ a }}", minijinja::context! { a => own.value() }).unwrap();
        assert_eq!(page, own);
    }
}
