//! The result as a terminal document.

use crate::diagnostics_file::{Check, causes, checks};
use crate::estimate_file::{component, estimate_file, inertia_entries};
use crate::identify::Identified;
use crate::summary;
use crate::verdict::Standing;
use indexmap::IndexMap;
use poinsot_formats::{EstimateFile, UndeterminedFile};
use poinsot_identify::{BodyEstimate, DeterminedCombination, Estimate, Number, Source, Status};
use poinsot_report::{Document, Section, Table, Tone, number_with_sigma, probability, significant};

/// Text for known numbers without a declared uncertainty.
pub(crate) const ASSUMED: &str = "Assumed: known numbers without a declared source come from a drawing (source = \"cad\"). Write source = \"measured\", source = \"cad\" or exact = true in the model.";

/// Detail of the printed result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detail {
    /// The summary.
    #[default]
    Answer,
    /// Also the fit and every check.
    Everything,
}

/// Number of combinations listed in the terminal; the file has all.
const LISTED: usize = 12;

/// The result as a document: sentence, mass properties, undetermined numbers, failed checks, remedies. With full
/// detail also the fit and the passed checks.
pub fn estimate_document(identified: &Identified, detail: Detail) -> Document {
    let e = &identified.estimate;
    let file = estimate_file(identified);
    let (tone, word) = Standing {
        status: &file.status,
        covariance_trustworthy: file.covariance_trustworthy,
        doubts: &file.doubts,
    }
    .display();
    let name = &identified.model.name;
    let mut document =
        Document::new(format!("{name}: {word}. {}", summary::sentence(&file))).toned(tone);
    if e.known_numbers.assumed {
        let line = vec![ASSUMED.to_owned()];
        document.push(Section::list("known numbers", line).toned(Tone::Fair));
    }
    numbers(&mut document, e);
    evidence(&mut document, e, &file);
    let checks: Vec<Check> = file.diagnostics.iter().flat_map(checks).collect();
    let failed: Vec<&Check> = checks.iter().filter(|c| c.tone == Tone::Bad).collect();
    if !failed.is_empty() && detail == Detail::Answer {
        document.push(check_table("failed checks", &failed).toned(Tone::Bad));
    }
    let causes: Vec<Check> = file.diagnostics.iter().flat_map(causes).collect();
    if !causes.is_empty() {
        let section = check_table("possible causes", &causes.iter().collect::<Vec<_>>());
        document.push(section.toned(Tone::Bad));
    }
    if let Some(action) = summary::action(&file) {
        document.push(Section::list("what to do", vec![action]));
    }
    document.sections.extend(method_report(e));
    document.sections.extend(known(e));
    let found = telemetry_findings(identified);
    if !found.is_empty() {
        document.push(Section::list("found in the telemetry", found));
    }
    if !identified.repairs.is_empty() {
        let lines = identified.repairs.clone();
        document.push(Section::list("assumed or repaired", lines));
    }
    if detail == Detail::Everything {
        document.push(fit(identified));
        if !checks.is_empty() {
            document.push(check_table("checks", &checks.iter().collect::<Vec<_>>()));
        }
    }
    let samples: usize = e.fit.iter().map(|f| f.samples).sum();
    let mut line = format!("method {}, {samples} samples", e.method);
    if !checks.is_empty() {
        let (passed, all) = (checks.len() - failed.len(), checks.len());
        line.push_str(&format!(", {passed} of {all} checks passed"));
    }
    if detail == Detail::Answer {
        line.push_str("; --verbose prints the fit and every check");
    }
    document.push(Section::list("fit", vec![line]));
    document
}

/// Mass properties of every requested body and of the whole vehicle, and other estimated numbers.
fn numbers(document: &mut Document, e: &Estimate) {
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
    if e.nuisance.is_empty() {
        return;
    }
    let mut table = Table::new(&["", "value", "1 sigma", "nominal", "unit"]);
    for item in &e.nuisance {
        let n = &item.number;
        let (value, sigma) = value_and_sigma(n, e.status);
        let nominal = significant(n.nominal, 6);
        table.push(vec![
            item.name.clone(),
            value,
            sigma,
            nominal,
            item.unit.to_owned(),
        ]);
    }
    document.push(Section::table("also estimated", table));
}

/// Undetermined numbers, determined combinations, and warnings.
fn evidence(document: &mut Document, e: &Estimate, file: &EstimateFile) {
    if e.status == Status::Rejected {
        document.push(Section::list("why it is rejected", e.warnings.clone()).toned(Tone::Bad));
        return;
    }
    if !e.identifiability.open.is_empty() {
        document.push(Section::list(
            "not identifiable from these data",
            open_sentences(&file.identifiability.not_identifiable),
        ));
        document.sections.extend(determined(e));
    }
    if !e.warnings.is_empty() {
        document.push(Section::list("warnings", e.warnings.clone()).toned(Tone::Fair));
    }
}

/// Results of a published method, with the method's names.
fn method_report(e: &Estimate) -> Option<Section> {
    let report = e.method_report.as_ref()?;
    let mut table = Table::new(&["", "value", "nominal", "unit"]);
    for item in &report.numbers {
        let (value, _) = number_with_sigma(item.number.value, item.number.sigma);
        let nominal = match item.number.nominal {
            0.0 => String::new(),
            nominal => significant(nominal, 6),
        };
        table.push(vec![
            item.name.clone(),
            value,
            nominal,
            item.unit.to_owned(),
        ]);
    }
    let mut section = Section::table(
        &format!("results of method {} in its own terms", e.method),
        table,
    );
    section.note = Some(report.note.clone());
    Some(section)
}

/// Sensitivity to known numbers, or a note that all are exact.
fn known(e: &Estimate) -> Option<Section> {
    let exact = || {
        let line = "all exact, as the model declares".to_owned();
        Section::list("known numbers", vec![line])
    };
    let declared = e.known_numbers.exact && !e.known_numbers.assumed;
    sensitivities(e).or_else(|| declared.then(exact))
}

fn telemetry_findings(identified: &Identified) -> Vec<String> {
    let found = identified.findings.iter().filter(|f| f.count > 0);
    let line = |f: &poinsot_telemetry::checks::Finding| {
        let (check, policy) = (f.check.name(), f.policy.name());
        format!("{check} ({policy}): {}: {}", f.channel, f.text)
    };
    found.map(line).collect()
}

fn check_table(title: &str, checks: &[&Check]) -> Section {
    let mut table = Table::new(&["", "found", "verdict"]);
    for c in checks {
        table.push(vec![c.test.clone(), c.found.clone(), c.verdict.clone()]);
    }
    Section::table(title, table)
}

fn value_and_sigma(n: &Number, status: Status) -> (String, String) {
    if n.value.is_none() && matches!(status, Status::Rejected | Status::IterationLimit) {
        return ("withheld".to_owned(), String::new());
    }
    number_with_sigma(n.value, n.sigma)
}

fn body_section(body: &BodyEstimate, status: Status) -> Section {
    let mut table = Table::new(&["", "value", "1 sigma", "nominal", "difference", "unit"]);
    let mut row = |name: String, n: &Number, unit: &str| {
        let (value, sigma) = match n.source {
            Source::Known => (significant(n.nominal, 6), "known".to_owned()),
            _ => value_and_sigma(n, status),
        };
        let difference = match n.source {
            Source::Known => String::new(),
            _ => difference(n),
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
            "{seen} of its 10 barycentric parameters about its frame origin are determined (see the result file)"
        ));
    }
    if body.physically_consistent == Some(false) {
        section.note = Some("no distribution of positive mass has this tensor".to_owned());
    }
    section
}

/// Difference from nominal in sigmas, or in percent if the sigma is much smaller.
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

/// One line per direction; those of one remedy together, with the remedy and the reason once below them.
pub(crate) fn open_sentences(open: &[UndeterminedFile]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut told: Vec<&str> = Vec::new();
    for alike in open.chunk_by(|a, b| a.reason == b.reason) {
        let mut groups: IndexMap<&str, Vec<&str>> = IndexMap::new();
        for item in alike {
            let group = groups.entry(&item.remedy).or_default();
            group.push(&item.combination);
        }
        for (remedy, combinations) in groups {
            lines.extend(combinations.into_iter().map(str::to_owned));
            // Several changes are told once: the list is long.
            let words = match remedy.split_once(':') {
                Some((together, _)) if told.contains(&remedy) => &format!("{together}, as above"),
                _ => remedy,
            };
            lines.push(format!("    to resolve it: {words}."));
            told.push(remedy);
        }
        lines.push(format!("    why: {}.", alike[0].reason));
    }
    lines
}

/// Determined combinations and functions, except single numbers already in the tables above.
fn determined(e: &Estimate) -> Option<Section> {
    let tabled = |c: &&DeterminedCombination| match &c.coefficients[..] {
        [(name, _)] => name.ends_with(".m") || name.contains(".I_BBcm_"),
        _ => false,
    };
    let all = e.identifiability.determined.iter();
    let all: Vec<_> = all.filter(|c| !tabled(c)).collect();
    if all.is_empty() {
        return None;
    }
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
    let more = all.len().saturating_sub(LISTED);
    if more > 0 {
        section.note = Some(format!("and {more} more combinations in the result file"));
    }
    Some(section)
}

/// For each known number, the result number with its largest share of variance.
fn sensitivities(e: &Estimate) -> Option<Section> {
    let known = &e.known_numbers;
    let stated = known.effects.iter().filter_map(|n| Some((n, n.largest()?)));
    let stated: Vec<_> = stated.collect();
    if stated.is_empty() {
        return None;
    }
    let mut table = Table::new(&[
        "known number",
        "1 sigma",
        "with the data",
        "most sensitive",
        "step",
        "change",
        "share of variance",
    ]);
    for (n, (at, share)) in stated.iter().copied().take(LISTED) {
        let change = n.changes.get(at).copied().flatten().unwrap_or(0.0);
        let unit = e.covariance_units.get(at).copied().unwrap_or("");
        table.push(vec![
            n.name.clone(),
            format!("{:.1e} {}", n.sigma, n.unit),
            n.estimated.map_or_else(
                || "as declared".to_owned(),
                |(value, sigma)| {
                    let (value, sigma) = number_with_sigma(Some(value), Some(sigma));
                    format!("{value} ± {sigma}")
                },
            ),
            e.covariance_names.get(at).cloned().unwrap_or_default(),
            n.step_words.to_owned(),
            format!("{change:+.2e} {unit}"),
            format!("{:.0} %", 100.0 * share),
        ]);
    }
    let mut section = Section::table("sensitivity to known numbers", table);
    if stated.len() > LISTED {
        section.note = Some(format!(
            "and {} more known numbers in the result file",
            stated.len() - LISTED
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
                    .map_or_else(|| "-".to_owned(), |p| format!("p = {}", probability(p))),
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
