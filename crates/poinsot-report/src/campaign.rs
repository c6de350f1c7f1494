//! A campaign as text: one headline, then the tables.

use poinsot_figures::{Document, Section, Table, Tone};
use poinsot_files::{short, significant};
use poinsot_formats::{BandedFile, CampaignCost, CampaignFile, CellFile, MethodResultFile};

/// Numbers of trials with a reported cost, in addition to the plan's.
const PRICED: [u64; 2] = [1_000_000, 1_000_000_000];

/// A campaign in one line.
pub(crate) fn headline(result: &CampaignFile) -> String {
    let cells = result.cells.len();
    let methods = result.cells.first().map_or(0, |c| c.methods.len());
    let trials = result
        .cells
        .iter()
        .flat_map(|c| &c.methods)
        .map(|m| m.trials);
    let mut text = format!(
        "{}: {} fits ({cells} cells, {methods} methods, {} trials of each)",
        result.name,
        trials.sum::<u64>(),
        result.trials
    );
    if result.trials < result.planned {
        text.push_str(&format!(", stopped before {}", result.planned));
    }
    if !result.missing.is_empty() {
        text.push_str(", incomplete: shards are missing");
    }
    text
}

/// The statistics with their intervals.
/// Every number of every method, with failures and timing.
///
/// ```
/// use poinsot_formats::CampaignFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/campaign.json"));
/// let campaign: CampaignFile = serde_json::from_str(text)?;
/// let document = poinsot_report::table_document(&campaign);
/// assert!(document.verdict.starts_with("box"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn table_document(result: &CampaignFile) -> Document {
    let tone = if result.missing.is_empty() {
        Tone::Good
    } else {
        Tone::Bad
    };
    let mut document = Document::new(headline(result)).toned(tone);
    for (_, cell, method) in all(result) {
        let mut table = Table::new(&[
            "",
            "bound",
            "RMSE",
            "RMSE/bound",
            "bias/sigma",
            "answered %",
            "coverage %",
            "trials",
        ]);
        for (name, n) in &method.numbers {
            let sigma = n.bound.or(n.stated).unwrap_or(f64::NAN);
            table.push(vec![
                name.clone(),
                n.bound
                    .map_or("not identifiable".to_owned(), |b| significant(b, 3)),
                n.rmse.value.map_or("-".to_owned(), |r| significant(r, 3)),
                interval(n.rmse_over_bound, 1.0, 3),
                plain(n.bias.value.map(|b| b / sigma), 3),
                plain(n.coverage_answered.value.map(|c| 100.0 * c), 1),
                interval(n.coverage_all, 100.0, 1),
                n.trials.to_string(),
            ]);
        }
        let of = prefix(result, cell, method);
        let title = match of.trim_end_matches(": ") {
            "" => "every number with its 95 % interval".to_owned(),
            of => format!("every number with its 95 % interval, {of}"),
        };
        document.push(Section::table(&title, table));
    }
    if let Some(last) = document.sections.last_mut() {
        last.note = Some("coverage: share of stated 95 % intervals that contain the truth, over all trials; answered: over the trials that determined the number. campaign.json has an interval for every statistic".to_owned());
    }
    document.push(rates(result));
    if let Some(section) = pairs(result) {
        document.push(section);
    }
    document
}

fn all(result: &CampaignFile) -> impl Iterator<Item = (usize, &CellFile, &MethodResultFile)> {
    let cells = result.cells.iter().enumerate();
    cells.flat_map(|(k, c)| c.methods.iter().map(move |m| (k, c, m)))
}

/// Labels of the rows.
fn prefix(result: &CampaignFile, cell: &CellFile, method: &MethodResultFile) -> String {
    let mut words = Vec::new();
    if result.cells.iter().any(|c| c.experiment != cell.experiment) {
        words.push(cell.experiment.clone());
    }
    words.extend(cell.at.iter().map(|(n, x)| format!("{n}={}", short(*x))));
    if cell.methods.len() > 1 {
        words.push(method.method.clone());
    }
    match words.is_empty() {
        true => String::new(),
        false => format!("{}: ", words.join(" ")),
    }
}

/// A number that may be missing.
fn plain(x: Option<f64>, decimals: usize) -> String {
    let finite = x.filter(|x| x.is_finite());
    finite.map_or("-".to_owned(), |x| format!("{x:.decimals$}"))
}

/// `95.1 [94.2, 95.8]`.
pub(crate) fn interval(x: BandedFile, factor: f64, decimals: usize) -> String {
    let shown = |v: f64| {
        (factor * v)
            .is_finite()
            .then(|| format!("{:.decimals$}", factor * v))
    };
    let text = |v: Option<f64>| v.and_then(shown);
    match (text(x.value), text(x.low), text(x.high)) {
        (Some(v), Some(a), Some(b)) => format!("{v} [{a}, {b}]"),
        (Some(v), _, _) => v,
        _ => "-".to_owned(),
    }
}

fn rates(result: &CampaignFile) -> Section {
    let mut table = Table::new(&[
        "",
        "failed %",
        "doubted %",
        "NEES/dof",
        "chi2/dof",
        "iterations",
        "ms a trial",
    ]);
    for (_, cell, m) in all(result) {
        let name = prefix(result, cell, m);
        table.push(vec![
            match name.as_str() {
                "" => m.method.clone(),
                name => name.trim_end_matches(": ").to_owned(),
            },
            interval(m.failed, 100.0, 2),
            interval(m.doubted, 100.0, 2),
            m.nees.map_or("-".to_owned(), |n| interval(n, 1.0, 3)),
            m.chi2_per_dof.map_or("-".to_owned(), |c| format!("{c:.3}")),
            format!("{:.1}", m.iterations.0),
            m.seconds_per_trial
                .map_or("-".to_owned(), |s| significant(1.0e3 * s, 3)),
        ]);
    }
    let mut section = Section::table("every method", table);
    let failures: Vec<String> = all(result)
        .flat_map(|(_, _, m)| m.failures.iter().take(1))
        .map(|(trial, why)| format!("trial {trial}: {why}"))
        .collect();
    section.note = failures.first().cloned();
    section
}

fn pairs(result: &CampaignFile) -> Option<Section> {
    let mut table = Table::new(&[
        "",
        "RMSE ratio",
        "covered by first alone",
        "by other alone",
        "McNemar p",
        "trials",
    ]);
    for cell in &result.cells {
        for (pair, method) in cell.comparisons.iter().zip(cell.methods.iter().skip(1)) {
            for (name, n) in &pair.numbers {
                table.push(vec![
                    format!("{}{name}", prefix(result, cell, method)),
                    interval(n.rmse_ratio, 1.0, 3),
                    n.held_by_first_alone.to_string(),
                    n.held_by_other_alone.to_string(),
                    n.mcnemar_p.map_or("-".to_owned(), |p| significant(p, 2)),
                    n.trials.to_string(),
                ]);
            }
        }
    }
    let first = result.cells.first()?.methods.first()?;
    (!table.rows.is_empty()).then(|| {
        let title = format!("beside {} on the same trials", first.method);
        let mut section = Section::table(&title, table);
        section.note =
            Some("RMSE ratio: other over first, 95 % interval of a paired bootstrap".to_owned());
        section
    })
}

/// The cost of a campaign as a document.
pub fn cost_document(cost: &CampaignCost) -> Document {
    let mut document = Document::new(format!(
        "{}: {} s of processor time a trial",
        cost.name,
        significant(cost.seconds, 3)
    ));
    let mut table = Table::new(&["trials", "core-hours", "disk"]);
    let mut rows = vec![(cost.trials, "this plan")];
    rows.extend(PRICED.map(|n| (n, "")));
    for (trials, word) in rows {
        table.push(vec![
            format!("{trials} {word}").trim_end().to_owned(),
            significant(cost.seconds * trials as f64 / 3600.0, 3),
            size(cost.bytes * trials as f64),
        ]);
    }
    document.push(Section::table("cost", table));
    let mut lines = Vec::new();
    if let Some(memory) = cost.memory {
        lines.push(format!(
            "memory: {} with one thread; each further thread adds one trial",
            size(memory as f64)
        ));
    }
    let (least, most) = cost.block;
    lines.push(format!(
        "a shard of 10 to 120 s has {least} to {most} trials; trials_per_shard is {}",
        cost.planned_block
    ));
    lines.push(
        "measured on this machine without other load; times differ on other machines".to_owned(),
    );
    document.push(Section::list("and", lines));
    document
}

fn size(bytes: f64) -> String {
    const UNITS: [&str; 6] = ["B", "kB", "MB", "GB", "TB", "PB"];
    let (mut x, mut unit) = (bytes, 0);
    while x >= 1000.0 && unit + 1 < UNITS.len() {
        x /= 1000.0;
        unit += 1;
    }
    format!("{} {}", significant(x, 3), UNITS[unit])
}
