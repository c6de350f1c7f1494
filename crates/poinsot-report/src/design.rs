//! A designed manoeuvre as text: one sentence, then the numbers.

use crate::prediction::durations;
use poinsot_figures::{Document, Section, Table, Tone};
use poinsot_files::significant;
use poinsot_formats::{DesignFile, DesignVerificationFile, RelaxedFile};

/// Significant figures of a sigma.
const FIGURES: i32 = 2;
/// Round-off tolerance of a limit, relative.
pub(crate) const ROUNDED: f64 = 1.0e-4;

/// The design as a document.
///
/// ```
/// use poinsot_formats::DesignFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/design.json"));
/// let design: DesignFile = serde_json::from_str(text)?;
/// let document = poinsot_report::design_document(&design);
/// assert_eq!(document.verdict, design.in_words);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn design_document(design: &DesignFile) -> Document {
    let agrees = design.verification.as_ref().is_none_or(|v| v.agrees);
    let tone = match (design.verdict == "reached", agrees) {
        (true, true) => Tone::Good,
        _ => Tone::Fair,
    };
    let mut document = Document::new(design.in_words.clone()).toned(tone);
    document.push(wanted(design));
    if !design.limits.is_empty() {
        document.push(limits(design));
    }
    if !design.relaxed.is_empty() {
        document.push(points("effect of relaxing a limit", &design.relaxed));
    }
    if !design.front.is_empty() {
        document.push(points("with one limit tighter and looser", &design.front));
    }
    if let Some(found) = &design.against_duration {
        document.push(durations(found));
    }
    if let Some(v) = &design.verification {
        document.push(flights(v));
    }
    let settled = match design.search.settled {
        true => "the next step would gain less than 0.001 %",
        false => "stopped before convergence: more evaluations or minutes may find a better one",
    };
    let mut lines = vec![format!(
        "{} manoeuvres evaluated, {settled}",
        design.search.evaluations
    )];
    if let Some(robust) = design.robust_log_ratio {
        lines.push(format!(
            "worst tenth of the vehicles of the prior: largest sigma {} of the wanted one",
            significant(robust.exp(), 3)
        ));
        let others = [
            design.robust_log_ratio_others,
            design.nominal_log_ratio_others,
        ];
        if let [Some(own), Some(nominal)] = others {
            lines.push(format!(
                "worst tenth of a thousand others: {}; with the best manoeuvre for the nominal vehicle: {}",
                significant(own.exp(), 3),
                significant(nominal.exp(), 3)
            ));
        }
    }
    document.push(Section::list("search", lines));
    document
}

fn points(title: &str, all: &[RelaxedFile]) -> Section {
    let mut table = Table::new(&["limit", "times", "largest sigma over wanted"]);
    for r in all {
        let factor = significant(r.factor, 3);
        table.push(vec![r.what.clone(), factor, significant(r.worst_ratio, 3)]);
    }
    Section::table(title, table)
}

fn wanted(design: &DesignFile) -> Section {
    let compared = design.wants.iter().any(|r| r.reference_sigma.is_some());
    let mut header = vec!["", "1 sigma", "wanted", "ratio"];
    if compared {
        header.push("manoeuvre of the case");
    }
    header.push("unit");
    let mut table = Table::new(&header);
    for r in &design.wants {
        let sigma = r.sigma.map(|s| significant(s, FIGURES));
        let ratio = r.sigma.map(|s| significant(s / r.wanted_sigma, 3));
        let mut row = vec![
            r.name.clone(),
            sigma.unwrap_or_else(|| "not identifiable".to_owned()),
            significant(r.wanted_sigma, FIGURES),
            ratio.unwrap_or_default(),
        ];
        if compared {
            let reference = r.reference_sigma.map(|s| significant(s, FIGURES));
            row.push(reference.unwrap_or_default());
        }
        row.push(r.unit.clone());
        table.push(row);
    }
    Section::table("wanted", table)
}

fn limits(design: &DesignFile) -> Section {
    let mut table = Table::new(&["", "value", "limit", "room", "unit"]);
    for l in &design.limits {
        let room = match (l.margin < -ROUNDED, l.active) {
            (true, _) => "broken".to_owned(),
            (false, true) => "active".to_owned(),
            (false, false) => format!("{} %", significant(100.0 * l.margin, FIGURES)),
        };
        table.push(vec![
            l.what.clone(),
            significant(l.value, 4),
            significant(l.limit, 4),
            room,
            l.unit.clone(),
        ]);
    }
    Section::table("limits", table)
}

fn flights(v: &DesignVerificationFile) -> Section {
    let mut table = Table::new(&["", "error over predicted sigma (rms)", "99.9 % band"]);
    for n in &v.numbers {
        let [low, high] = n.band.map(|x| significant(x, 3));
        table.push(vec![
            n.name.clone(),
            significant(n.rms_ratio, 3),
            format!("{low} to {high}"),
        ]);
    }
    let title = format!(
        "{} trial flights: {} without an answer, {} with a broken limit",
        v.flights,
        v.failed.len(),
        v.limits_broken
    );
    let mut section = Section::table(&title, table);
    section.note = v.failed.first().cloned();
    section
}
