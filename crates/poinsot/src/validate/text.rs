//! A validation in words: one sentence first, then the numbers behind it.

use super::{Against, Compared, Completed, Validation, Verdict};
use poinsot_report::{Document, Section, Table, probability, significant};

/// Figures of a difference.
const FIGURES: i32 = 3;
/// Names listed in a sentence.
const LISTED: usize = 6;

/// The validation as a document.
pub fn validation_document(validation: &Validation) -> Document {
    let mut document = Document::new(sentence(validation));
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

fn sentence(validation: &Validation) -> String {
    let own = match &validation.estimate {
        Some((path, status)) => format!("{path} ({status}) with {}", validation.model),
        None => validation.model.clone(),
    };
    let against = &validation.against;
    let verdict = match (validation.verdict, validation.kind) {
        (Verdict::Undetermined, _) => {
            "the motion depends on what the estimate leaves open: not determined"
        }
        (Verdict::Compared, _) => "compared, no limit given",
        (Verdict::Agrees, Against::Model) => "within the limits",
        (Verdict::Differs, Against::Model) => "beyond the limits",
        (Verdict::Agrees, _) => "agree within the declared noise",
        (Verdict::Differs, _) => "differ by more than the declared noise",
    };
    let verdict = match validation.relied_on {
        true => verdict.to_owned(),
        false => format!("{verdict}; the estimate itself says that it is not to be relied on"),
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

fn differences(validation: &Validation) -> Section {
    let sigmas = validation.compared.iter().any(|c| c.sigmas.is_some());
    let mut head = vec!["", "largest", "at", "rms", "unit"];
    if sigmas {
        head.extend(["rms/sigma", "largest/sigma", "white"]);
    }
    let mut table = Table::new(&head);
    for one in &validation.compared {
        table.push(row(one, sigmas));
    }
    let mut section = Section::table("difference, model less the other side", table);
    let mut notes = Vec::new();
    if validation.kind == Against::HeldBack {
        notes.push("nothing of the vehicle was fitted; pose, momentum and declared biases of the record were");
    }
    if sigmas {
        notes.push("sigma is the declared noise of the sensor alone, without that of the estimate");
    }
    section.note = (!notes.is_empty()).then(|| notes.join("; "));
    section
}

fn row(one: &Compared, sigmas: bool) -> Vec<String> {
    let mut row = vec![
        one.name.clone(),
        significant(one.largest, FIGURES),
        format!("{} s", significant(one.largest_at_s, 4)),
        significant(one.rms, FIGURES),
        one.unit.to_owned(),
    ];
    if sigmas {
        let cell = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, FIGURES));
        row.push(cell(one.sigmas.map(|s| s.rms)));
        row.push(cell(one.sigmas.map(|s| s.largest)));
        let white = one.sigmas.and_then(|s| s.whiteness_p);
        row.push(white.map_or("-".to_owned(), |p| format!("p = {}", probability(p))));
    }
    row
}

fn completion(completed: &Completed) -> Section {
    let effect = &completed.effect;
    let mut lines = vec![format!(
        "the estimate determines {} combinations and leaves {} directions open; there the nominal numbers of the model stand, moved as little as the combinations allow ({} in natural units): these are numbers to predict with and no estimate of single bodies",
        completed.determined,
        completed.open,
        significant(completed.distance, 2)
    )];
    let changes: Vec<String> = effect
        .changes
        .iter()
        .map(|(name, unit, x)| {
            format!("{name} {} {unit}", significant(*x, 2))
                .trim_end()
                .to_owned()
        })
        .collect();
    let moved = 100.0 * effect.moved;
    let tried = format!(
        "each open direction was moved by {moved:.0} % of its parameter: the prediction changes by at most {}",
        changes.join(", ")
    );
    lines.push(tried);
    if effect.matters() {
        let some: Vec<&str> = effect
            .dependent
            .iter()
            .take(LISTED)
            .map(String::as_str)
            .collect();
        let more = effect.dependent.len().saturating_sub(LISTED);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        lines.push(format!(
            "the motion depends on {}{more}, which the estimate leaves open; add telemetry that shows them (thrust, other joints), or give them as known",
            some.join(", ")
        ));
    }
    Section::list("how open numbers were completed", lines)
}
