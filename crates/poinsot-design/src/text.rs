//! A design in words: one sentence first, then the numbers behind it.

use crate::result::{Designed, Verification};
use poinsot_report::{Document, Section, Table, Tone, significant};

/// Figures of a sigma.
const FIGURES: i32 = 2;

/// The answer in one sentence.
pub(crate) fn sentence(designed: &Designed) -> String {
    let seconds = significant(designed.duration_s, 4);
    let of = format!(
        "{} wanted numbers of {}",
        designed.wants.len(),
        designed.model.name
    );
    let hidden = designed.wants.iter().find(|r| r.sigma.is_none());
    if let Some(hidden) = hidden {
        return format!(
            "No manoeuvre of this kind shows {} within the limits ({seconds} s, {of}).",
            hidden.want.name
        );
    }
    if let Some(broken) = designed.broken().next() {
        return format!(
            "No manoeuvre was found within the limits: {} is broken.",
            broken.what
        );
    }
    let worst = designed.worst_ratio();
    let ratio = significant(worst, 3);
    match designed.is_reached() {
        true => {
            format!("{seconds} s reach all {of}: the largest sigma is {ratio} of the wanted one.")
        }
        false => {
            let active: Vec<&str> = designed
                .limits
                .iter()
                .filter(|l| l.is_active())
                .map(|l| l.what.as_str())
                .take(3)
                .collect();
            let by = match active.is_empty() {
                true => "the duration".to_owned(),
                false => active.join(", "),
            };
            format!(
                "{seconds} s do not reach all {of}: the largest sigma is {ratio} of the wanted one, held back by {by}."
            )
        }
    }
}

/// The design as a document.
pub fn design_document(designed: &Designed) -> Document {
    let tone = match designed.passes() {
        true => Tone::Good,
        false => Tone::Fair,
    };
    let mut document = Document::new(sentence(designed)).toned(tone);
    document.push(wanted(designed));
    if !designed.limits.is_empty() {
        document.push(limits(designed));
    }
    if !designed.relaxed.is_empty() {
        let mut table = Table::new(&["limit", "times", "largest sigma over wanted"]);
        for r in &designed.relaxed {
            let factor = significant(r.factor, 3);
            table.push(vec![r.what.clone(), factor, significant(r.ratio, 3)]);
        }
        document.push(Section::table("what a relaxed limit would give", table));
    }
    if let Some(v) = &designed.verification {
        document.push(flights(v));
    }
    let settled = match designed.settled {
        true => "no further step promises more than 0.1 %",
        false => "stopped before it settled: more evaluations or minutes may find a better one",
    };
    let mut lines = vec![format!(
        "{} manoeuvres evaluated, {settled}",
        designed.evaluations
    )];
    if let Some(robust) = designed.robust {
        lines.push(format!(
            "worst tenth of the vehicles of the prior: largest sigma {} of the wanted one",
            significant(robust.exp(), 3)
        ));
    }
    document.push(Section::list("search", lines));
    document
}

fn wanted(designed: &Designed) -> Section {
    let compared = designed.wants.iter().any(|r| r.reference.is_some());
    let mut header = vec!["", "1 sigma", "wanted", "ratio"];
    if compared {
        header.push("manoeuvre of the case");
    }
    header.push("unit");
    let mut table = Table::new(&header);
    for r in &designed.wants {
        let sigma = r.sigma.map(|s| significant(s, FIGURES));
        let mut row = vec![
            r.want.name.clone(),
            sigma.unwrap_or_else(|| "not identifiable".to_owned()),
            significant(r.want.sigma, FIGURES),
            r.sigma
                .map_or_else(String::new, |_| significant(r.ratio(), 3)),
        ];
        if compared {
            row.push(
                r.reference
                    .map_or_else(String::new, |s| significant(s, FIGURES)),
            );
        }
        row.push(r.want.unit.to_owned());
        table.push(row);
    }
    Section::table("wanted", table)
}

fn limits(designed: &Designed) -> Section {
    let mut table = Table::new(&["", "value", "limit", "room", "unit"]);
    for l in &designed.limits {
        let room = match l.is_active() {
            true => "active".to_owned(),
            false => format!("{} %", significant(100.0 * l.margin, FIGURES)),
        };
        table.push(vec![
            l.what.clone(),
            significant(l.value, 4),
            significant(l.limit, 4),
            if l.margin < -1.0e-4 {
                "broken".to_owned()
            } else {
                room
            },
            l.unit.to_owned(),
        ]);
    }
    Section::table("limits", table)
}

fn flights(v: &Verification) -> Section {
    let mut table = Table::new(&["", "error over predicted sigma (rms)", "99.9 % band"]);
    for n in &v.numbers {
        table.push(vec![
            n.name.clone(),
            significant(n.rms_ratio, 3),
            format!(
                "{} to {}",
                significant(n.band.low, 3),
                significant(n.band.high, 3)
            ),
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
