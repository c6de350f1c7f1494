//! A validation as text: one sentence, then the numbers.

use poinsot_figures::{Document, Section, Table, Tone};
use poinsot_files::{probability, significant};
use poinsot_formats::{ComparedQuantityFile, CompletedFile, ValidationFile};

/// Significant figures of a difference.
const FIGURES: i32 = 3;
/// Number of names listed in a sentence.
const LISTED: usize = 6;

/// The validation as a document.
///
/// ```
/// use poinsot_formats::ValidationFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/validation.json"));
/// let validation: ValidationFile = serde_json::from_str(text)?;
/// let document = poinsot_report::validation_document(&validation);
/// assert!(document.verdict.contains("no limit given"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn validation_document(validation: &ValidationFile) -> Document {
    let tone = match (validation.verdict.as_str(), is_reliable(validation)) {
        ("compared", true) => Tone::Plain,
        ("agrees", true) => Tone::Good,
        ("undetermined", true) => Tone::Fair,
        _ => Tone::Bad,
    };
    let mut document = Document::new(sentence(validation)).toned(tone);
    document.push(differences(validation));
    if let Some(completed) = &validation.completed {
        document.push(completion(completed));
    }
    if !validation.warnings.is_empty() {
        document.push(Section::list("warnings", validation.warnings.clone()));
    }
    if !validation.repairs.is_empty() {
        let lines = validation.repairs.iter();
        let lines = lines.map(|r| r.trim_start_matches(": ").to_owned());
        document.push(Section::list("assumed or repaired", lines.collect()));
    }
    document
}

/// Whether the estimate, if any, is reliable.
fn is_reliable(validation: &ValidationFile) -> bool {
    let estimate = validation.estimate.as_ref();
    estimate.is_none_or(|e| e.covariance_trustworthy)
}

fn sentence(validation: &ValidationFile) -> String {
    let own = match &validation.estimate {
        Some(e) => format!("{} ({}) with {}", e.path, e.status, validation.model),
        None => validation.model.clone(),
    };
    let against = &validation.against;
    let of_models = validation.kind == "model";
    let verdict = match (validation.verdict.as_str(), of_models) {
        ("undetermined", _) => "the motion depends on undetermined numbers",
        ("compared", _) => "compared, no limit given",
        ("agrees", true) => "within the limits",
        ("agrees", false) => "agree within the declared noise",
        (_, true) => "beyond the limits",
        (_, false) => "differ by more than the declared noise",
    };
    let verdict = match is_reliable(validation) {
        true => verdict.to_owned(),
        false => format!("{verdict}; the estimate is not reliable"),
    };
    match (&validation.case, validation.chi2_per_dof) {
        (Some(case), _) => format!("{own} against {against} in {case}: {verdict}"),
        (None, Some(chi2)) => format!(
            "{own} against held-back {against}: {verdict} (chi-square per degree of freedom {})",
            significant(chi2, FIGURES)
        ),
        (None, None) => format!("{own} against {against}: {verdict}"),
    }
}

fn differences(validation: &ValidationFile) -> Section {
    let sigmas = validation.compared.iter().any(|c| c.sigmas.is_some());
    let mut head = vec!["", "largest", "at", "rms", "unit"];
    if sigmas {
        head.extend(["rms/sigma", "largest/sigma", "white"]);
    }
    let mut table = Table::new(&head);
    for one in &validation.compared {
        table.push(row(one, sigmas));
    }
    let mut section = Section::table("difference, model minus the other side", table);
    let mut notes = Vec::new();
    if validation.kind == "held_back_telemetry" {
        notes.push("only pose, momentum and declared biases of the record were fitted");
    }
    if sigmas {
        notes.push("sigma is the declared noise of the sensor alone, without the uncertainty of the estimate");
    }
    section.note = (!notes.is_empty()).then(|| notes.join("; "));
    section
}

fn row(one: &ComparedQuantityFile, sigmas: bool) -> Vec<String> {
    let mut row = vec![
        one.quantity.clone(),
        significant(one.largest, FIGURES),
        format!("{} s", significant(one.largest_at_s, 4)),
        significant(one.rms, FIGURES),
        one.unit.clone(),
    ];
    if sigmas {
        let sigmas_of = one.sigmas.as_ref();
        let cell = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, FIGURES));
        row.push(cell(sigmas_of.map(|s| s.rms)));
        row.push(cell(sigmas_of.map(|s| s.largest)));
        let white = sigmas_of.and_then(|s| s.whiteness_p);
        row.push(white.map_or("-".to_owned(), |p| format!("p = {}", probability(p))));
    }
    row
}

fn completion(completed: &CompletedFile) -> Section {
    let mut lines = vec![format!(
        "the estimate determines {} combinations and has {} unobservable directions; along those the nominal numbers are used, with the smallest change that fits ({} in natural units). These numbers predict motion and are no estimate of single bodies",
        completed.determined,
        completed.open,
        significant(completed.distance_natural, 2)
    )];
    let changes: Vec<String> = completed
        .prediction_changes
        .iter()
        .map(|c| {
            format!("{} {} {}", c.quantity, significant(c.largest, 2), c.unit)
                .trim_end()
                .to_owned()
        })
        .collect();
    let moved = 100.0 * completed.open_moved_by_natural;
    let tried = format!(
        "each unobservable direction was varied by {moved:.0} % of its parameter: the prediction changes by at most {}",
        changes.join(", ")
    );
    lines.push(tried);
    if !completed.depends_on.is_empty() {
        let some: Vec<&str> = completed
            .depends_on
            .iter()
            .take(LISTED)
            .map(String::as_str)
            .collect();
        let more = completed.depends_on.len().saturating_sub(LISTED);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        lines.push(format!(
            "the motion depends on {}{more}, which are undetermined; add telemetry that determines them (thrust, other joints), or give them as known",
            some.join(", ")
        ));
    }
    Section::list("completion of undetermined numbers", lines)
}
