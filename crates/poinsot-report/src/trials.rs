//! Statistics of many trials, of one set-up or of a campaign, as terminal documents.

use crate::campaign::table_document;
use poinsot_figures::{Document, Section, Table};
use poinsot_files::significant;
use poinsot_formats::{Band, CampaignFile, MethodResultFile, Statistics};

/// Number of failed trials listed.
const LISTED: usize = 10;
/// Largest number of cells times methods with separate tables.
const DETAILED: usize = 3;

/// The result of a campaign; where that is short, also the statistics of every method with their bands. `statistics`
/// has one list per cell, with one entry per method.
pub fn campaign_document(result: &CampaignFile, statistics: &[Vec<Statistics>]) -> Vec<Document> {
    let mut documents = Vec::new();
    let shown = result.cells.iter().zip(statistics);
    let count: usize = result.cells.iter().map(|c| c.methods.len()).sum();
    for (cell, statistics) in shown.filter(|_| count <= DETAILED) {
        for (method, statistics) in cell.methods.iter().zip(statistics) {
            let at = cell.at.iter().map(|(n, x)| format!(", {n} = {x}"));
            let mut title = cell.experiment.clone();
            if !result.about.is_empty() {
                title.push_str(&format!(": {}", result.about));
            }
            title.extend(at);
            if cell.methods.len() > 1 {
                title.push_str(&format!(", {}", method.method));
            }
            let mut document = statistics_document(&title, statistics);
            document.push(Section::list(
                "limits of a calibrated estimator",
                limits(method),
            ));
            documents.push(document);
        }
    }
    documents.push(table_document(result));
    documents
}

fn limits(method: &MethodResultFile) -> Vec<String> {
    match method.misses.as_slice() {
        [] => vec!["calibrated: RMSE/bound <= 1.05, |bias| < 0.1 sigma, coverage 94 to 96 %, NEES in its band, spread within 5 % of predicted".to_owned()],
        misses => misses.iter().map(|m| format!("missed: {m}")).collect(),
    }
}

/// The statistics as a document; values outside their 99.9 % band have an exclamation mark.
pub fn statistics_document(title: &str, s: &Statistics) -> Document {
    let faults = s.faults();
    let word = if faults.is_empty() {
        "every statistic inside its 99.9 % band".to_owned()
    } else {
        format!("{} statistics outside their 99.9 % bands", faults.len())
    };
    let mut document = Document::new(format!("{title}: {} trials, {word}", s.trials));
    document.push(numbers(s));
    document.push(Section::list("all together", together(s)));
    if !s.failed.is_empty() {
        let mut lines: Vec<String> = s
            .failed
            .iter()
            .take(LISTED)
            .map(|(trial, why)| format!("trial {trial}: {why}"))
            .collect();
        if s.failures > lines.len() as u64 {
            lines.push(format!("and {} more", s.failures - lines.len() as u64));
        }
        document.push(Section::list(
            &format!("{} failed trials", s.failures),
            lines,
        ));
    }
    document
}

/// Each number against its bound.
fn numbers(s: &Statistics) -> Section {
    let mut table = Table::new(&[
        "",
        "bound (1 sigma)",
        "stated/bound",
        "RMSE/bound",
        "|bias|/sigma",
        "coverage %",
        "trials",
    ]);
    for p in &s.parameters {
        let (n, sigma) = (p.trials, p.sigma());
        let marked = |text: String, x: f64, band: Band| {
            if x.is_nan() {
                "-".to_owned()
            } else if band.holds(x) {
                text
            } else {
                format!("{text} !")
            }
        };
        let (rmse, bias) = (p.rmse / sigma, p.bias.abs() / sigma);
        table.push(vec![
            p.name.clone(),
            p.bound.map_or("open".to_owned(), |b| significant(b, 3)),
            match p.stated.is_finite() {
                true => format!("{:.3}", p.stated / sigma),
                false => "-".to_owned(),
            },
            marked(format!("{rmse:.3}"), rmse, Band::of_rms(n)),
            marked(format!("{bias:.3}"), bias, Band::of_bias(n)),
            marked(
                format!("{:.1}", 100.0 * p.coverage),
                p.coverage,
                Band::of_coverage(n),
            ),
            n.to_string(),
        ]);
    }
    let mut section = Section::table("each number against the Cramer-Rao bound", table);
    let n = s.trials;
    let (rms, bias, coverage) = (Band::of_rms(n), Band::of_bias(n), Band::of_coverage(n));
    section.note = Some(format!(
        "99.9 % bands for {n} trials: RMSE/bound {:.3} to {:.3}, |bias|/sigma below {:.3}, coverage {:.1} to {:.1} %; ! = outside",
        rms.low,
        rms.high,
        bias.high,
        100.0 * coverage.low,
        100.0 * coverage.high
    ));
    section
}

/// Statistics common to all numbers.
fn together(s: &Statistics) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some((mean, dof)) = s.nees {
        let band = Band::of_mean_square(dof);
        lines.push(format!(
            "NEES per degree of freedom {mean:.4}; band {:.4} to {:.4}{}",
            band.low,
            band.high,
            if band.holds(mean) { "" } else { " !" }
        ));
    }
    // A kernel has no residuals.
    if s.chi2_per_dof > 0.0 {
        lines.push(format!(
            "chi-square per degree of freedom {:.4}",
            s.chi2_per_dof
        ));
    }
    for (name, chi2) in &s.channels {
        lines.push(format!("  {name} {chi2:.4}"));
    }
    lines.push(format!(
        "iterations {:.1} in the mean, {} at most",
        s.iterations.0, s.iterations.1
    ));
    for (status, count) in &s.statuses {
        lines.push(format!("{count} trials {status}"));
    }
    if let Some((name, gap)) = s.worst_prediction() {
        lines.push(format!(
            "predict agrees with the achieved spread within {:.1} % (worst: {name})",
            100.0 * gap.abs()
        ));
    }
    lines
}
