//! An estimate as a terminal document.

use crate::checks::{Check, causes, checks};
use crate::summary;
use crate::verdict::Standing;
use indexmap::IndexMap;
use poinsot_figures::{Document, Section, Table, Tone};
use poinsot_files::{number_with_sigma, probability, significant};
use poinsot_formats::{
    Address, BodyFile, CheckFile, DeterminedFile, EstimateFile, NumberFile, SegmentFitFile,
    SensitivityFile, UndeterminedFile,
};

/// Text for known numbers without a declared uncertainty.
const ASSUMED: &str = "Assumed: known numbers without a declared source come from a drawing (source = \"cad\"). Write source = \"measured\", source = \"cad\" or exact = true in the model.";

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
///
/// ```
#[doc = include_str!("../doc/estimate.txt")]
/// use poinsot_report::{Detail, estimate_document};
///
/// let document = estimate_document(&estimate, Detail::Answer);
/// assert!(document.verdict.starts_with("box: Determined."));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate_document(e: &EstimateFile, detail: Detail) -> Document {
    let (tone, word) = Standing::of(e).display();
    let mut document =
        Document::new(format!("{}: {word}. {}", e.model, summary::sentence(e))).toned(tone);
    if e.known_numbers.source_assumed {
        let line = vec![ASSUMED.to_owned()];
        document.push(Section::list("known numbers", line).toned(Tone::Fair));
    }
    numbers(&mut document, e);
    evidence(&mut document, e);
    let checks: Vec<Check> = e.diagnostics.iter().flat_map(checks).collect();
    let failed: Vec<&Check> = checks.iter().filter(|c| c.tone == Tone::Bad).collect();
    if !failed.is_empty() && detail == Detail::Answer {
        document.push(check_table("failed checks", &failed).toned(Tone::Bad));
    }
    let causes: Vec<Check> = e.diagnostics.iter().flat_map(causes).collect();
    if !causes.is_empty() {
        let section = check_table("possible causes", &causes.iter().collect::<Vec<_>>());
        document.push(section.toned(Tone::Bad));
    }
    if let Some(action) = summary::action(e) {
        document.push(Section::list("what to do", vec![action]));
    }
    document.sections.extend(method_report(e));
    document.sections.extend(known(e));
    let found = telemetry_findings(e);
    if !found.is_empty() {
        document.push(Section::list("found in the telemetry", found));
    }
    if !e.repairs.is_empty() {
        document.push(Section::list("assumed or repaired", e.repairs.clone()));
    }
    if detail == Detail::Everything {
        document.push(fit(&e.fit));
        if !checks.is_empty() {
            document.push(check_table("checks", &checks.iter().collect::<Vec<_>>()));
        }
    }
    document.push(Section::list("fit", vec![last_line(e, &checks, detail)]));
    document
}

fn last_line(e: &EstimateFile, checks: &[Check], detail: Detail) -> String {
    let samples: usize = e.fit.iter().map(|f| f.samples).sum();
    let mut line = format!("method {}, {samples} samples", e.method);
    if !checks.is_empty() {
        let failed = checks.iter().filter(|c| c.tone == Tone::Bad).count();
        let (passed, all) = (checks.len() - failed, checks.len());
        line.push_str(&format!(", {passed} of {all} checks passed"));
    }
    if detail == Detail::Answer {
        line.push_str("; --verbose prints the fit and every check");
    }
    line
}

/// Mass properties of every requested body and of the whole vehicle, and other estimated numbers.
fn numbers(document: &mut Document, e: &EstimateFile) {
    let withheld = e.is_withheld();
    for (name, body) in e.bodies.iter().filter(|b| b.1.is_asked()) {
        document.push(body_section(name, body, withheld));
    }
    if let Some(whole) = e.system.first()
        && e.bodies.len() > 1
    {
        let mut section = body_section("", &whole.body, withheld);
        section.title =
            "whole vehicle at the first sample (base axes, from the base origin)".to_owned();
        document.push(section);
    }
    if e.nuisance.is_empty() {
        return;
    }
    let mut table = Table::new(&["", "value", "1 sigma", "nominal"]);
    for (address, n) in &e.nuisance {
        let (value, sigma) = value_and_sigma(n, withheld);
        table.push(vec![
            address.clone(),
            value,
            sigma,
            significant(n.nominal, 6),
        ]);
    }
    document.push(Section::table("also estimated", table));
}

/// Undetermined numbers, determined combinations, and warnings.
fn evidence(document: &mut Document, e: &EstimateFile) {
    if e.status == "rejected" {
        document.push(Section::list("why it is rejected", e.warnings.clone()).toned(Tone::Bad));
        return;
    }
    let open = &e.identifiability.not_identifiable;
    if !open.is_empty() {
        document.push(Section::list(
            "not identifiable from these data",
            open_sentences(open),
        ));
        document
            .sections
            .extend(determined(&e.identifiability.identifiable));
    }
    if !e.warnings.is_empty() {
        document.push(Section::list("warnings", e.warnings.clone()).toned(Tone::Fair));
    }
}

/// Results of a published method, with the method's names.
fn method_report(e: &EstimateFile) -> Option<Section> {
    let report = e.method_report.as_ref()?;
    let mut table = Table::new(&["", "value", "nominal", "unit"]);
    for item in &report.numbers {
        let (value, _) = number_with_sigma(item.value, item.sigma);
        let nominal = item.nominal.filter(|n| *n != 0.0);
        table.push(vec![
            item.name.clone(),
            value,
            nominal.map(|n| significant(n, 6)).unwrap_or_default(),
            item.unit.clone(),
        ]);
    }
    let title = format!("results of method {} in its own terms", e.method);
    let mut section = Section::table(&title, table);
    section.note = Some(report.note.clone());
    Some(section)
}

/// Sensitivity to known numbers, or a note that all are exact.
fn known(e: &EstimateFile) -> Option<Section> {
    let exact = || {
        let line = "all exact, as the model declares".to_owned();
        Section::list("known numbers", vec![line])
    };
    let declared = e.known_numbers.exact && !e.known_numbers.source_assumed;
    sensitivities(e).or_else(|| declared.then(exact))
}

fn telemetry_findings(e: &EstimateFile) -> Vec<String> {
    let found = e.telemetry_checks.iter().filter(|f| f.count > 0);
    let line = |f: &CheckFile| format!("{} ({}): {}: {}", f.check, f.policy, f.channel, f.text);
    found.map(line).collect()
}

fn check_table(title: &str, checks: &[&Check]) -> Section {
    let mut table = Table::new(&["", "found", "verdict"]);
    for c in checks {
        table.push(vec![c.test.clone(), c.found.clone(), c.verdict.clone()]);
    }
    Section::table(title, table)
}

fn value_and_sigma(n: &NumberFile, withheld: bool) -> (String, String) {
    if n.value.is_none() && withheld {
        return ("withheld".to_owned(), String::new());
    }
    number_with_sigma(n.value, n.sigma)
}

fn body_section(name: &str, body: &BodyFile, withheld: bool) -> Section {
    let mut table = Table::new(&["", "value", "1 sigma", "nominal", "difference", "unit"]);
    for (what, unit, n) in body.numbers() {
        let nominal = significant(n.nominal, 6);
        let (value, sigma, difference) = match n.is_known() {
            true => (nominal.clone(), "known".to_owned(), String::new()),
            false => {
                let (value, sigma) = value_and_sigma(&n, withheld);
                (value, sigma, difference(&n))
            }
        };
        table.push(vec![
            what.replace(' ', "_"),
            value,
            sigma,
            nominal,
            difference,
            unit.replace('²', "2"),
        ]);
    }
    let title = format!("{name} (inertia about its mass centre, tensor elements)");
    let mut section = Section::table(&title, table);
    let seen = body.barycentric.determined();
    if seen > 0 && body.inertia_kg_m2.named().iter().any(|(_, n)| n.is_open()) {
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
fn difference(n: &NumberFile) -> String {
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
fn determined(all: &[DeterminedFile]) -> Option<Section> {
    let tabled = |c: &&DeterminedFile| match c.coefficients.first() {
        Some((address, _)) if c.coefficients.len() == 1 => {
            ["mass_kg", "inertia_kg_m2"].contains(&Address::parse(address).quantity())
        }
        _ => false,
    };
    let all: Vec<_> = all.iter().filter(|c| !tabled(c)).collect();
    if all.is_empty() {
        return None;
    }
    let what = match all.iter().all(|c| !c.coefficients.is_empty()) {
        true => "determined combination",
        false => "determined combination or function",
    };
    let mut table = Table::new(&[what, "value", "1 sigma", "unit"]);
    for c in all.iter().take(LISTED) {
        let (value, sigma) = number_with_sigma(c.value, c.sigma);
        table.push(vec![c.combination.clone(), value, sigma, c.unit.clone()]);
    }
    let mut section = Section::table("what is determined instead", table);
    let more = all.len().saturating_sub(LISTED);
    if more > 0 {
        section.note = Some(format!("and {more} more combinations in the result file"));
    }
    Some(section)
}

/// For each known number, the result number with its largest share of variance.
fn sensitivities(e: &EstimateFile) -> Option<Section> {
    let known = e.known_numbers.sensitivities.iter();
    let stated = known.filter_map(|s| Some((s, s.most_sensitive()?)));
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
    for (s, (name, share)) in stated.iter().take(LISTED) {
        let change = s.change.get(*name).copied().unwrap_or(0.0);
        let unit = e.covariance.unit_of(name).unwrap_or_default();
        table.push(vec![
            Address::parse(&s.number).without_unit(&s.unit),
            format!("{:.1e} {}", s.sigma, s.unit),
            with_the_data(s),
            Address::parse(name).without_unit(unit),
            s.step.clone(),
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

fn with_the_data(s: &SensitivityFile) -> String {
    match (s.estimate, s.estimate_sigma) {
        (Some(value), Some(sigma)) => {
            let (value, sigma) = number_with_sigma(Some(value), Some(sigma));
            format!("{value} ± {sigma}")
        }
        _ => "as declared".to_owned(),
    }
}

fn fit(segments: &[SegmentFitFile]) -> Section {
    let mut table = Table::new(&[
        "segment", "samples", "chi2/dof", "sensor", "rms", "chi2/n", "white",
    ]);
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    for f in segments {
        let mut first = vec![
            f.segment.clone(),
            f.samples.to_string(),
            or_dash(f.chi2_per_dof.map(|x| significant(x, 4))),
        ];
        for (name, c) in &f.channels {
            let mut row = std::mem::replace(&mut first, vec![String::new(); 3]);
            row.push(name.clone());
            row.push(or_dash(c.rms.map(|x| format!("{x:.2e} {}", c.unit))));
            row.push(or_dash(c.chi2_per_number.map(|x| format!("{x:.3}"))));
            row.push(or_dash(
                c.whiteness_p.map(|p| format!("p = {}", probability(p))),
            ));
            table.push(row);
        }
        if f.channels.is_empty() {
            first.extend(["-", "-", "-", "-"].map(str::to_owned));
            table.push(first);
        }
    }
    Section::table("fit", table)
}
