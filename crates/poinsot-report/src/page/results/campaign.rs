//! The result of a campaign as a page.

use super::light;
use crate::campaign::{ABOUT_KNOWN, headline, label, table_document};
use indexmap::{IndexMap, IndexSet};
use poinsot_figures::{
    Axis, Figure, Light, Mark, Opening, Page, PageError, Part, Plot, Series, Tone,
};
use poinsot_files::short;
use poinsot_formats::{
    BandedFile, Calibration, CampaignFile, CellFile, MethodResultFile, NumberResultFile,
};
use std::cmp::Reverse;

/// Largest number of separate figures.
const FIGURES: usize = 12;

/// The page.
///
/// # Errors
/// A template is faulty.
///
/// ```
/// use poinsot_formats::CampaignFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/campaign.json"));
/// let campaign: CampaignFile = serde_json::from_str(text)?;
/// assert!(poinsot_report::campaign_page(&campaign)?.html()?.contains("are the stated uncertainties right?"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn campaign_page(result: &CampaignFile) -> Result<Page, PageError> {
    let axis = axis_of(result);
    let mut figures = axis.map_or_else(|| fixed(result), |address| swept(result, &address));
    let first: Vec<Figure> = figures.drain(..1.min(figures.len())).collect();
    let complete = result.missing.is_empty() && result.trials >= result.planned;
    let methods = worst_of_methods(result);
    let missing = methods.values().filter(|w| w.found.missed > 0).count();
    let worst = methods.values().max_by_key(|w| w.rank());
    let (tone, word) = match worst {
        _ if !complete => (Tone::Fair, "Incomplete"),
        Some(_) if missing > 0 && missing < methods.len() => (Tone::Bad, "Not all calibrated"),
        Some(w) if w.found.missed > 0 => (Tone::Bad, "Not calibrated"),
        Some(w) if w.found.is_resolved() => (Tone::Good, "Calibrated"),
        _ => (Tone::Good, "Consistent"),
    };
    let opening = Opening {
        tone,
        word: word.to_owned(),
        sentence: worst.map(Worst::sentence).unwrap_or_default(),
        action: (!complete).then(|| "Run the missing shards with --resume.".to_owned()),
        lights: lights(&methods),
        beside: first
            .first()
            .map(Figure::html)
            .transpose()?
            .unwrap_or_default(),
    };
    let answer = opening.part()?.with_figures(first);
    let body = Figure::page(&figures)?;
    let drawn = Part::new("figures", "Figures", body).with_figures(figures);
    let tables = table_document(result).sections;
    let tables = Part::of_sections("tables", "Tables", &result.about, &tables)?;
    let digest = result.digest.get(..12).unwrap_or_default();
    Ok(Page {
        title: format!("{}: are the stated uncertainties right?", result.name),
        subtitle: format!(
            "{}; plan {digest}; poinsot {}",
            headline(result),
            result.poinsot
        ),
        footer: format!(
            "Intervals have 95 % confidence: Wilson for shares, Student for means, chi-square for mean squares. {ABOUT_KNOWN}. This file needs no network."
        ),
        parts: vec![answer, drawn, tables],
    })
}

/// Where a method does worst.
struct Worst {
    /// What tells this method in this cell from the others.
    label: String,
    found: Calibration,
}

impl Worst {
    /// More misses are worse, then fewer trials.
    fn rank(&self) -> (usize, Reverse<u64>) {
        (self.found.missed, Reverse(self.found.trials))
    }

    fn sentence(&self) -> String {
        match self.label.as_str() {
            "" => format!("{}.", self.found),
            label => format!("Worst: {label}: {}.", self.found),
        }
    }
}

/// Every method, in the cell where it does worst.
fn worst_of_methods(result: &CampaignFile) -> IndexMap<&str, Worst> {
    let mut all: IndexMap<&str, Worst> = IndexMap::new();
    for cell in &result.cells {
        for method in &cell.methods {
            let own = Worst {
                label: label(result, cell, method),
                found: method.calibration(),
            };
            let known = all.get(method.method.as_str());
            if known.is_none_or(|known| known.rank() < own.rank()) {
                all.insert(&method.method, own);
            }
        }
    }
    all
}

/// Whether each method is calibrated.
fn lights(methods: &IndexMap<&str, Worst>) -> Vec<Light> {
    let light = |(method, Worst { found, .. }): (&&str, &Worst)| {
        let (tone, word) = match (found.missed, found.is_resolved()) {
            (0, true) => (Tone::Good, "yes"),
            (0, false) => (Tone::Fair, "not contradicted"),
            _ => (Tone::Bad, "no"),
        };
        let found = format!("{method}: {found}");
        light("Calibrated?", "tables", tone, word, found)
    };
    methods.iter().map(light).collect()
}

/// The address with the most values, if one has at least two.
fn axis_of(result: &CampaignFile) -> Option<String> {
    let count = |address: &str| {
        let values = result.cells.iter().filter_map(|c| c.at.get(address));
        values.map(|x| x.to_bits()).collect::<IndexSet<u64>>().len()
    };
    let most = result.cells.first()?.at.keys().max_by_key(|a| count(a))?;
    (count(most) > 1).then(|| most.clone())
}

/// Every number, in order of first appearance.
fn names(result: &CampaignFile) -> Vec<String> {
    let methods = result.cells.iter().flat_map(|c| &c.methods);
    let all: IndexSet<&String> = methods.flat_map(|m| m.numbers.keys()).collect();
    all.into_iter().cloned().collect()
}

/// Coverage and efficiency of every number, one mark per method.
fn fixed(result: &CampaignFile) -> Vec<Figure> {
    let coverage = Plot {
        title: "coverage of stated 95 % intervals, all trials".to_owned(),
        y: Axis::new("coverage", "%"),
        levels: vec![(95.0, "wanted".to_owned())],
        series: banded(result, 100.0, |n| n.coverage_all),
        half: true,
        ..Plot::default()
    };
    let efficiency = Plot {
        title: "error over the Cramer-Rao bound".to_owned(),
        y: Axis::new("RMSE/bound", ""),
        levels: vec![(1.0, "wanted".to_owned())],
        series: banded(result, 1.0, |n| n.rmse_over_bound),
        ..Plot::default()
    };
    let figure = |(name, plot): (&str, Plot)| {
        let plot = Plot {
            x: Axis::new("number", ""),
            names: names(result),
            height: 300.0,
            ..plot
        };
        Figure::plot(name, plot)
    };
    [("coverage", coverage), ("efficiency", efficiency)]
        .map(figure)
        .to_vec()
}

/// Marks with interval bars of every method.
fn banded(
    result: &CampaignFile,
    factor: f64,
    of: fn(&NumberResultFile) -> BandedFile,
) -> Vec<Series> {
    let names = names(result);
    let all = result
        .cells
        .iter()
        .flat_map(|c| c.methods.iter().map(move |m| (c, m)));
    let mut series = Vec::new();
    for (colour, (cell, method)) in all.enumerate() {
        let (mut x, mut y, mut bar_x, mut bar_y) = (vec![], vec![], vec![], vec![]);
        for (k, name) in names.iter().enumerate() {
            let Some(band) = method.numbers.get(name).map(of) else {
                continue;
            };
            // Marks of several methods are offset horizontally.
            let at = (k + 1) as f64 + 0.08 * colour as f64;
            x.push(at);
            y.push(band.value.map_or(f64::NAN, |v| factor * v));
            if let (Some(low), Some(high)) = (band.low, band.high) {
                bar_x.extend([at, at, f64::NAN]);
                bar_y.extend([factor * low, factor * high, f64::NAN]);
            }
        }
        let label = match result.cells.len() {
            1 => method.method.clone(),
            _ => format!("{} {}", cell.experiment, method.method),
        };
        series.push(Series::new(&label, Mark::Points, colour, &x, &y));
        series.push(Series::new("", Mark::Line, colour, &bar_x, &bar_y));
    }
    series
}

/// All methods over the varied number, by the errors of all their numbers; then error and bound of every number.
fn swept(result: &CampaignFile, address: &str) -> Vec<Figure> {
    let over_bound = |m: &MethodResultFile| {
        let ratios = m.numbers.values().filter_map(|n| n.rmse_over_bound.value);
        let squares: Vec<f64> = ratios.map(|r| r * r).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        [(Mark::Line, Some(mean.sqrt()))]
    };
    let all = Plot {
        title: "error over the Cramer-Rao bound, rms of all numbers".to_owned(),
        x: Axis::new(address, ""),
        y: Axis::new("RMSE/bound", ""),
        log: true,
        levels: vec![(1.0, "wanted".to_owned())],
        series: lines(result, address, over_bound),
        height: 300.0,
        half: true,
        ..Plot::default()
    };
    let figure = |name: &String| {
        let of = |m: &MethodResultFile| match m.numbers.get(name) {
            Some(n) => [(Mark::Line, n.rmse.value), (Mark::Dashed, n.bound)],
            None => [(Mark::Line, None), (Mark::Dashed, None)],
        };
        let plot = Plot {
            title: format!("error of {name}"),
            x: Axis::new(address, ""),
            y: Axis::new("RMSE and bound", "SI"),
            log: true,
            series: lines(result, address, of),
            height: 260.0,
            half: true,
            ..Plot::default()
        };
        Figure::plot(name, plot)
    };
    let each = names(result);
    let each = each.iter().take(FIGURES).map(figure);
    std::iter::once(Figure::plot("methods", all))
        .chain(each)
        .collect()
}

/// Lines over the varied number: of each method solid, of bounds dashed, one for each set of other numbers.
fn lines<const N: usize>(
    result: &CampaignFile,
    address: &str,
    of: impl Fn(&MethodResultFile) -> [(Mark, Option<f64>); N],
) -> Vec<Series> {
    let rest = |cell: &CellFile| {
        let others = cell.at.iter().filter(|(n, _)| *n != address);
        let others = others.map(|(n, v)| format!(" {n}={}", short(*v)));
        format!("{}{}", cell.experiment, others.collect::<String>())
    };
    let mut lines: IndexMap<(Mark, String), Vec<(f64, f64)>> = IndexMap::new();
    for cell in &result.cells {
        let x = cell.at.get(address).copied().unwrap_or(f64::NAN);
        for method in &cell.methods {
            for (mark, value) in of(method) {
                let what = match mark {
                    Mark::Dashed => "bound",
                    _ => &method.method,
                };
                if let Some(value) = value {
                    let line = (mark, format!("{what} {}", rest(cell)));
                    lines.entry(line).or_default().push((x, value));
                }
            }
        }
    }
    let mut series = Vec::new();
    for ((mark, label), mut points) in lines {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.dedup();
        let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        series.push(Series::new(&label, mark, series.len(), &x, &y));
    }
    series
}
