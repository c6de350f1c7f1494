//! Statistics of many trials, of one set-up or of a campaign, as text.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_files::{short, significant};
use poinsot_formats::{
    Band, CampaignCost, CampaignFile, CellFile, MethodResultFile, NumberResultFile,
};

/// Numbers of trials with a reported cost, in addition to the plan's.
const PRICED: [u64; 2] = [1_000_000, 1_000_000_000];
/// What trials do with known numbers.
pub(crate) const ABOUT_KNOWN: &str = "Every trial has the known numbers of the model, and the bound takes them as exact; a fit takes them to be as uncertain as the model says";
/// Largest number of cells times methods with separate tables.
const DETAILED: usize = 3;

/// A campaign in one line.
pub(crate) fn headline(result: &CampaignFile) -> String {
    TEMPLATES.lines("headline.txt", result).concat()
}

/// Every number of every method with its interval, failures and timing.
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
    let cells = || result.cells.iter();
    let all = || cells().flat_map(|c| c.methods.iter().map(move |m| (c, m)));
    let of = |(c, m)| context! { of => label(result, c, m), ..Value::from_serialize(m) };
    let context = context! {
        headline => headline(result),
        about_known => ABOUT_KNOWN,
        methods => all().map(of).collect::<Vec<_>>(),
        failures => all().flat_map(|(_, m)| &m.failures).take(1).collect::<Vec<_>>(),
    };
    let tone = match result.missing.is_empty() {
        true => Tone::Good,
        false => Tone::Bad,
    };
    TEMPLATES.document("campaign.txt", context).toned(tone)
}

/// What tells a method's rows from those of the others; empty if there are none.
pub(crate) fn label(result: &CampaignFile, cell: &CellFile, method: &MethodResultFile) -> String {
    let mut words = Vec::new();
    if result.cells.iter().any(|c| c.experiment != cell.experiment) {
        words.push(cell.experiment.clone());
    }
    words.extend(cell.at.iter().map(|(n, x)| format!("{n}={}", short(*x))));
    if cell.methods.len() > 1 {
        words.push(method.method.clone());
    }
    words.join(" ")
}

/// The result of a campaign; where that is short, also the statistics of every method with their bands.
pub fn campaign_document(result: &CampaignFile) -> Vec<Document> {
    let mut documents = Vec::new();
    let count: usize = result.cells.iter().map(|c| c.methods.len()).sum();
    for cell in result.cells.iter().filter(|_| count <= DETAILED) {
        for method in &cell.methods {
            let mut title = cell.experiment.clone();
            if !result.about.is_empty() {
                title.push_str(&format!(": {}", result.about));
            }
            title.extend(cell.at.iter().map(|(n, x)| format!(", {n} = {x}")));
            if cell.methods.len() > 1 {
                title.push_str(&format!(", {}", method.method));
            }
            documents.push(statistics_document(&title, method));
        }
    }
    documents.push(table_document(result));
    documents
}

/// The statistics of a method as a document; values outside their 99.9 % band have an exclamation mark.
pub fn statistics_document(title: &str, m: &MethodResultFile) -> Document {
    let n = m.trials;
    let (rms, coverage) = (Band::of_rms(n), Band::of_coverage(n));
    let nees = m.nees.and_then(|nees| nees.value).map(|mean| {
        let band = Band::of_mean_square(m.nees_dof);
        context! { mean, low => band.low, high => band.high, holds => band.holds(mean) }
    });
    let context = context! {
        title, nees,
        faults => m.fault_count(),
        parameters => m.numbers.iter().map(parameter).collect::<Vec<_>>(),
        rms => [rms.low, rms.high],
        coverage => [coverage.low, coverage.high],
        bias => Band::of_bias(n).high,
        worst => m.worst_prediction(),
        calibration => m.calibration().to_string(),
        resolved => m.calibration().is_resolved(),
        failure_count => m.failure_count(),
        ..Value::from_serialize(m)
    };
    TEMPLATES.document("statistics.txt", context)
}

/// A number against its bound.
fn parameter((name, n): (&String, &NumberResultFile)) -> Value {
    let rmse = n.in_sigmas(n.rmse.value);
    let bias = n.in_sigmas(n.bias.value.map(f64::abs));
    let coverage = n.coverage_answered.value;
    let holds = |band: Band, x: Option<f64>| x.is_none_or(|x| x.is_nan() || band.holds(x));
    context! {
        name, rmse, bias, coverage,
        trials => n.trials,
        bound => n.bound,
        stated => n.in_sigmas(n.stated),
        rmse_holds => holds(Band::of_rms(n.trials), rmse),
        bias_holds => holds(Band::of_bias(n.trials), bias),
        coverage_holds => holds(Band::of_coverage(n.trials), coverage),
    }
}

/// The cost of a campaign as a document.
pub fn cost_document(cost: &CampaignCost) -> Document {
    let row = |trials: u64| {
        let hours = cost.seconds * trials as f64 / 3600.0;
        context! { trials, hours, disk => size(cost.bytes * trials as f64) }
    };
    let rows = [cost.trials, PRICED[0], PRICED[1]].map(row);
    let context = context! {
        rows,
        name => cost.name,
        seconds => cost.seconds,
        memory => cost.memory.map(|m| size(m as f64)),
        block => cost.block,
        planned_block => cost.planned_block,
    };
    TEMPLATES.document("cost.txt", context)
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
