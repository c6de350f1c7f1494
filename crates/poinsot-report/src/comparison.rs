//! A comparison as text.

use poinsot_figures::{Document, Section, Table};
use poinsot_files::{number_with_sigma, probability, significant};
use poinsot_formats::{ComparedNumberFile, ComparisonFile, DIFFER_BELOW};

/// The comparison as a document.
///
/// ```
/// use poinsot_formats::ComparisonFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/comparison.json"));
/// let comparison: ComparisonFile = serde_json::from_str(text)?;
/// let document = poinsot_report::comparison_document(&comparison);
/// assert!(document.verdict.contains("agree"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn comparison_document(c: &ComparisonFile) -> Document {
    let mut document = Document::new(sentence(c));
    let mut answers = Table::new(&["", "answer", "method", "status"]);
    for (i, a) in (1..).zip(&c.answers) {
        answers.push(vec![
            format!("{i}"),
            a.path.clone(),
            a.method.clone(),
            a.status.clone(),
        ]);
    }
    document.push(Section::table("answers", answers));
    if !c.numbers.is_empty() {
        document.push(numbers(c));
        document.push(tests(c));
    }
    for (title, lines) in [("not compared", &c.not_compared), ("doubts", &c.doubts)] {
        if !lines.is_empty() {
            document.push(Section::list(title, lines.clone()));
        }
    }
    document
}

fn sentence(c: &ComparisonFile) -> String {
    let count = c.answers.len();
    let p = c.tests.first().map_or(1.0, |t| t.p);
    match c.verdict.as_str() {
        "agree" => format!(
            "{}: {count} answers agree (p = {})",
            c.model,
            probability(p)
        ),
        "differ" => {
            let changed = c.tests.iter().skip(1).filter(|t| t.p < DIFFER_BELOW);
            let changed: Vec<&str> = changed.map(|t| t.what.as_str()).collect();
            let changed = match changed.is_empty() {
                true => "only all numbers together".to_owned(),
                false => changed.join(", "),
            };
            format!(
                "{}: {count} answers differ (p = {}): {changed}",
                c.model,
                probability(p)
            )
        }
        _ => format!(
            "{}: the {count} answers determine no common number",
            c.model
        ),
    }
}

fn numbers(c: &ComparisonFile) -> Section {
    let mut head = vec![String::new()];
    for i in 1..=c.answers.len() {
        head.extend([format!("answer {i}"), "1 sigma".to_owned()]);
    }
    head.extend(["difference", "in sigma", "p"].map(str::to_owned));
    let pooled = c.numbers.values().any(|n| n.pooled.is_some());
    if pooled {
        head.extend(["pooled", "1 sigma"].map(str::to_owned));
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut table = Table::new(&head);
    for (name, n) in &c.numbers {
        table.push(row(name, n, pooled));
    }
    let mut section = Section::table("numbers", table);
    section.note = Some("difference: last answer minus first; p: p-value of no change".to_owned());
    section
}

fn row(name: &str, n: &ComparedNumberFile, pooled: bool) -> Vec<String> {
    let mut row = vec![name.to_owned()];
    let pair = |value: Option<f64>, sigma: Option<f64>, row: &mut Vec<String>| {
        let (value, sigma) = number_with_sigma(value, sigma);
        row.extend([value, sigma]);
    };
    for (value, sigma) in n.values.iter().zip(&n.sigmas) {
        pair(Some(*value), Some(*sigma), &mut row);
    }
    row.push(significant(n.difference, 3));
    row.push(format!("{:+.1}", n.difference / n.difference_sigma));
    row.push(probability(n.p));
    if pooled {
        pair(n.pooled, n.pooled_sigma, &mut row);
    }
    row
}

fn tests(c: &ComparisonFile) -> Section {
    let mut table = Table::new(&[
        "numbers tested together",
        "chi-square",
        "degrees of freedom",
        "p",
    ]);
    for t in &c.tests {
        table.push(vec![
            t.what.clone(),
            significant(t.chi2, 4),
            t.dof.to_string(),
            probability(t.p),
        ]);
    }
    Section::table("joint tests", table)
}
