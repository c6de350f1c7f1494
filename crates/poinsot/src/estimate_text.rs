//! The answer as an engineer reads it in a terminal.

use crate::estimate_file::{component, inertia_entries};
use crate::identify::Identified;
use crate::verdict::Standing;
use poinsot_identify::{
    BodyEstimate, Estimate, MethodReport, Number, OpenCombination, Source, Status,
};
use poinsot_report::{Document, Section, Table, Tone, number_with_sigma, significant};

/// What is said where the model leaves open how good its known numbers are.
pub(crate) const ASSUMED: &str = "Assumed: known numbers without a declared source are exact. \
     Write source = \"measured\", source = \"cad\" or exact = true into the model.";

/// Combinations listed in the terminal; the file has all.
const LISTED: usize = 12;

/// The answer as a document: verdict, mass properties, what is open, fit, repairs.
pub fn estimate_document(identified: &Identified) -> Document {
    let e = &identified.estimate;
    let tone = match e.status {
        Status::Converged if e.covariance_trustworthy => Tone::Good,
        Status::Converged | Status::Partial => Tone::Fair,
        _ => Tone::Bad,
    };
    let mut document = Document::new(verdict(identified)).toned(tone);
    if e.known_numbers.assumed {
        let line = vec![ASSUMED.to_owned()];
        document.push(Section::list("known numbers", line).toned(Tone::Fair));
    }
    for body in e.bodies.iter().filter(|b| b.asked) {
        document.push(body_section(body, e.status));
    }
    if let Some((whole, _)) = &e.system
        && e.bodies.len() > 1
    {
        let mut section = body_section(whole, e.status);
        section.title =
            "whole vehicle at the first sample (base axes, from the base origin)".to_owned();
        document.push(section);
    }
    if !e.nuisance.is_empty() {
        document.push(nuisances(e));
    }
    if e.status == Status::Rejected {
        document.push(Section::list("why it is rejected", e.warnings.clone()).toned(Tone::Bad));
    } else {
        if !e.identifiability.open.is_empty() {
            document.push(Section::list(
                "not identifiable from these data",
                open_sentences(&e.identifiability.open),
            ));
            document.push(determined(identified));
        }
        if !e.warnings.is_empty() {
            document.push(Section::list("warnings", e.warnings.clone()).toned(Tone::Fair));
        }
    }
    if let Some(report) = &e.method_report {
        document.push(own_numbers(&e.method, report));
    }
    if let Some(section) = sensitivities(e) {
        document.push(section);
    } else if e.known_numbers.exact {
        let line = "all taken as exact, as the model declares".to_owned();
        document.push(Section::list("known numbers", vec![line]));
    }
    document.push(fit(identified));
    let found = found(identified);
    if !found.is_empty() {
        document.push(Section::list("found in the telemetry", found));
    }
    if let Some(d) = &identified.estimate.diagnostics {
        document.push(crate::diagnostics_file::diagnostics_section(d));
    }
    if !identified.repairs.is_empty() {
        document.push(Section::list(
            "assumed or repaired",
            identified.repairs.clone(),
        ));
    }
    document
}

fn nuisances(e: &Estimate) -> Section {
    let mut table = Table::new(&["", "value", "1 sigma", "nominal", "unit"]);
    for item in &e.nuisance {
        let n = &item.number;
        let (value, sigma) = number_with_sigma(n.value, n.sigma);
        table.push(vec![
            item.name.clone(),
            value,
            sigma,
            significant(n.nominal, 6),
            item.unit.to_owned(),
        ]);
    }
    Section::table("also estimated", table)
}

/// What a published method gives in its own terms.
fn own_numbers(method: &str, report: &MethodReport) -> Section {
    let mut table = Table::new(&["", "value", "nominal", "unit"]);
    for item in &report.numbers {
        let (value, _) = number_with_sigma(item.number.value, item.number.sigma);
        table.push(vec![
            item.name.clone(),
            value,
            if item.number.nominal == 0.0 {
                String::new()
            } else {
                significant(item.number.nominal, 6)
            },
            item.unit.to_owned(),
        ]);
    }
    let mut section = Section::table(&format!("what the method {method} prints"), table);
    section.note = Some(report.note.clone());
    section
}

/// Findings in the telemetry.
fn found(identified: &Identified) -> Vec<String> {
    identified
        .findings
        .iter()
        .filter(|f| f.count > 0)
        .map(|f| {
            format!(
                "{} ({}): {}: {}",
                f.check.name(),
                f.policy.name(),
                f.channel,
                f.text
            )
        })
        .collect()
}

fn verdict(identified: &Identified) -> String {
    let e = &identified.estimate;
    let i = &e.identifiability;
    let standing = Standing {
        status: e.status.name(),
        covariance_trustworthy: e.covariance_trustworthy,
        doubts: &e.doubts,
    };
    let combinations = match e.status {
        Status::Rejected | Status::IterationLimit => String::new(),
        _ => format!("{} of {} combinations; ", i.rank, i.parameters),
    };
    format!(
        "{}: {} ({combinations}method {})",
        identified.model.name,
        standing.headline(),
        e.method
    )
}

fn body_section(body: &BodyEstimate, status: Status) -> Section {
    let open = match status {
        Status::Rejected | Status::IterationLimit => "withheld",
        _ => "not identifiable",
    };
    let mut table = Table::new(&["", "value", "1 sigma", "nominal", "difference", "unit"]);
    let mut row = |name: String, n: &Number, unit: &str| {
        let (value, sigma) = number_with_sigma(n.value, n.sigma);
        let (value, sigma, difference) = match n.source {
            Source::Known => (significant(n.nominal, 6), "known".to_owned(), String::new()),
            Source::Open => (open.to_owned(), String::new(), String::new()),
            _ => (value, sigma, difference(n)),
        };
        table.push(vec![
            name,
            value,
            sigma,
            significant(n.nominal, 6),
            difference,
            unit.to_owned(),
        ]);
    };
    row("mass".to_owned(), &body.mass, "kg");
    for k in 0..3 {
        row(component("com", k), &body.com[k], "m");
    }
    for (k, name) in inertia_entries() {
        row(format!("I_{name}"), &body.inertia[k], "kg m2");
    }
    let mut section = Section::table(
        &format!(
            "{} (inertia about its mass centre, tensor elements)",
            body.name
        ),
        table,
    );
    let seen = (0..10)
        .filter(|&k| body.barycentric[k].source == Source::Data)
        .count();
    if seen > 0 && body.inertia.iter().any(|n| n.source == Source::Open) {
        section.note = Some(format!(
            "{seen} of its 10 barycentric parameters about its frame origin are determined: see the result file"
        ));
    }
    if body.physically_consistent == Some(false) {
        section.note = Some("no distribution of positive mass has this tensor".to_owned());
    }
    section
}

/// Difference from nominal in sigmas, or in percent where the sigma is far smaller.
fn difference(n: &Number) -> String {
    let Some(value) = n.value else {
        return String::new();
    };
    let gap = value - n.nominal;
    match n.sigma {
        _ if n.nominal != 0.0 => format!("{:+.3} %", 100.0 * gap / n.nominal.abs()),
        Some(sigma) if sigma > 0.0 => format!("{:+.1} sigma", gap / sigma),
        _ => String::new(),
    }
}

pub(crate) fn open_sentences(open: &[OpenCombination]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut last = ("", "");
    for (k, item) in open.iter().enumerate() {
        lines.push(item.text.clone());
        let next = open
            .get(k + 1)
            .map(|n| (n.reason.as_str(), n.remedy.as_str()));
        let own = (item.reason.as_str(), item.remedy.as_str());
        if next != Some(own) && last != own {
            lines.push(format!("    why: {}", item.reason));
            lines.push(format!("    to change that: {}", item.remedy));
            last = own;
        } else if next != Some(own) {
            last = ("", "");
        }
    }
    lines
}

fn determined(identified: &Identified) -> Section {
    let all = &identified.estimate.identifiability.determined;
    let what = match all.iter().all(|c| !c.coefficients.is_empty()) {
        true => "determined combination",
        false => "determined combination or function",
    };
    let mut table = Table::new(&[what, "value", "1 sigma", "unit"]);
    for c in all.iter().take(LISTED) {
        let (value, sigma) = number_with_sigma(Some(c.value), Some(c.sigma));
        table.push(vec![c.text.clone(), value, sigma, c.unit.to_owned()]);
    }
    let mut section = Section::table("what is determined instead", table);
    if all.len() > LISTED {
        section.note = Some(format!(
            "and {} more combinations in the result file",
            all.len() - LISTED
        ));
    }
    section
}

/// Known numbers and the number of the answer whose variance each has most of.
fn sensitivities(e: &Estimate) -> Option<Section> {
    let known = &e.known_numbers;
    if known.effects.is_empty() {
        return None;
    }
    let mut table = Table::new(&[
        "known number",
        "1 sigma",
        "with the data",
        "unit",
        "most sensitive",
        "step",
        "change",
        "share of variance",
    ]);
    for n in known.effects.iter().take(LISTED) {
        let Some((at, share)) = n.largest() else {
            continue;
        };
        let change = n.changes.get(at).copied().flatten().unwrap_or(0.0);
        let unit = e.covariance_units.get(at).copied().unwrap_or("");
        table.push(vec![
            n.name.clone(),
            format!("{:.1e}", n.sigma),
            n.estimated.map_or_else(
                || "as declared".to_owned(),
                |(value, sigma)| {
                    let (value, sigma) = number_with_sigma(Some(value), Some(sigma));
                    format!("{value} ± {sigma}")
                },
            ),
            n.unit.to_owned(),
            e.covariance_names.get(at).cloned().unwrap_or_default(),
            n.step_words.to_owned(),
            format!("{change:+.2e} {unit}"),
            format!("{:.0} %", 100.0 * share),
        ]);
    }
    let mut section = Section::table("sensitivity to known numbers", table);
    if known.effects.len() > LISTED {
        section.note = Some(format!(
            "and {} more known numbers in the result file",
            known.effects.len() - LISTED
        ));
    }
    Some(section)
}

fn fit(identified: &Identified) -> Section {
    let mut table = Table::new(&[
        "segment", "samples", "chi2/dof", "sensor", "rms", "chi2/n", "white",
    ]);
    for f in &identified.estimate.fit {
        let mut first = vec![
            f.label.clone(),
            f.samples.to_string(),
            significant(f.chi2_per_dof, 4),
        ];
        for c in &f.channels {
            let mut row = std::mem::replace(&mut first, vec![String::new(); 3]);
            row.push(c.name.to_owned());
            row.push(format!("{:.2e} {}", c.rms, c.unit));
            row.push(
                c.chi2_per_number
                    .map_or_else(|| "-".to_owned(), |x| format!("{x:.3}")),
            );
            row.push(
                c.whiteness_p
                    .map_or_else(|| "-".to_owned(), |p| format!("p = {p:.2}")),
            );
            table.push(row);
        }
        if f.channels.is_empty() {
            first.extend(["-", "-", "-", "-"].map(str::to_owned));
            table.push(first);
        }
    }
    Section::table("fit", table)
}
