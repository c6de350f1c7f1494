//! The result of a campaign as a page.

use crate::campaign::{headline, table_document};
use indexmap::IndexSet;
use poinsot_figures::{
    Axis, Figure, Light, Mark, Opening, Page, PageError, Part, Plot, Series, Tone,
};
use poinsot_files::short;
use poinsot_formats::{BandedFile, CampaignFile, NumberResultFile};

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
/// assert!(poinsot_report::campaign_page(&campaign)?.html()?.contains("Complete"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn campaign_page(result: &CampaignFile) -> Result<Page, PageError> {
    let figures = match axis_of(result) {
        Some(address) => swept(result, &address),
        None => fixed(result),
    };
    let first = Figure::page(figures.get(..1).unwrap_or_default())?;
    let complete = result.missing.is_empty() && result.trials >= result.planned;
    let (tone, word) = match complete {
        true => (Tone::Good, "Complete"),
        false => (Tone::Fair, "Incomplete"),
    };
    let opening = Opening {
        tone,
        word: word.to_owned(),
        sentence: headline(result),
        action: (!complete).then(|| "Run the missing shards with --resume.".to_owned()),
        lights: vec![held(result)],
        beside: first,
    };
    let drawn = Part {
        id: "figures",
        title: "Figures",
        body: Figure::page(&figures)?,
        figures,
    };
    let tables = Part::of_document("tables", "Tables", &result.about, &table_document(result))?;
    Ok(Page {
        title: format!("Campaign {}", result.name),
        subtitle: format!("{}; plan {}; poinsot {}", headline(result), &result.digest.get(..12).unwrap_or(""), result.poinsot),
        footer: "Intervals have 95 % confidence: Wilson for shares, Student for means, chi-square for mean squares; of a sampling Student's over its replicates. This file needs no network.".to_owned(),
        parts: vec![opening.part()?, drawn, tables],
    })
}

/// Whether every method is calibrated.
fn held(result: &CampaignFile) -> Light {
    let methods = || result.cells.iter().flat_map(|c| &c.methods);
    let missed = methods().filter(|m| !m.misses.is_empty()).count();
    let (tone, word) = match missed {
        0 => (Tone::Good, "yes"),
        _ => (Tone::Bad, "no"),
    };
    Light {
        question: "Calibrated?",
        place: "tables",
        tone,
        word: word.to_owned(),
        found: format!("{missed} of {} methods miss a limit", methods().count()),
    }
}

/// The address with the most values, if one has at least two.
fn axis_of(result: &CampaignFile) -> Option<String> {
    let first = result.cells.first()?;
    let count = |address: &str| {
        let mut values: Vec<f64> = result
            .cells
            .iter()
            .filter_map(|c| c.at.get(address).copied())
            .collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values.len()
    };
    let most = first.at.keys().max_by_key(|a| count(a))?;
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
    let names = names(result);
    let plot =
        |title: &str, y: Axis, level: f64, of: &dyn Fn(&NumberResultFile) -> (BandedFile, f64)| {
            let mut series = Vec::new();
            let lines = result
                .cells
                .iter()
                .flat_map(|c| c.methods.iter().map(move |m| (c, m)));
            for (colour, (cell, method)) in lines.enumerate() {
                let mut points = Vec::new();
                for (k, name) in names.iter().enumerate() {
                    if let Some(n) = method.numbers.get(name) {
                        let (x, factor) = of(n);
                        // Marks of several methods are offset horizontally.
                        let at = (k + 1) as f64 + 0.08 * colour as f64;
                        points.push((at, x, factor));
                    }
                }
                let label = match result.cells.len() {
                    1 => method.method.clone(),
                    _ => format!("{} {}", cell.experiment, method.method),
                };
                push_banded(&mut series, &label, colour, &points);
            }
            Plot {
                title: title.to_owned(),
                x: Axis::new("number", ""),
                y,
                names: names.clone(),
                levels: vec![(level, "wanted".to_owned())],
                series,
                height: 300.0,
                ..Plot::default()
            }
        };
    vec![
        Figure::plot(
            "coverage",
            plot(
                "coverage of stated 95 % intervals, all trials",
                Axis::new("coverage", "%"),
                95.0,
                &|n| (n.coverage_all, 100.0),
            ),
        ),
        Figure::plot(
            "efficiency",
            plot(
                "error over the Cramer-Rao bound",
                Axis::new("RMSE/bound", ""),
                1.0,
                &|n| (n.rmse_over_bound, 1.0),
            ),
        ),
    ]
}

/// Adds marks with interval bars.
fn push_banded(
    series: &mut Vec<Series>,
    label: &str,
    colour: usize,
    points: &[(f64, BandedFile, f64)],
) {
    let (mut x, mut y, mut bar_x, mut bar_y) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (at, band, factor) in points {
        if let Some(value) = band.value {
            x.push(*at);
            y.push(factor * value);
        }
        if let (Some(low), Some(high)) = (band.low, band.high) {
            bar_x.extend([*at, *at, f64::NAN]);
            bar_y.extend([factor * low, factor * high, f64::NAN]);
        }
    }
    series.push(Series::new(label, Mark::Points, colour, &x, &y));
    series.push(Series::new("", Mark::Line, colour, &bar_x, &bar_y));
}

/// Error and bound of every number over the varied number, one line per method and set of other numbers.
fn swept(result: &CampaignFile, address: &str) -> Vec<Figure> {
    let names = names(result);
    let mut figures = Vec::new();
    for name in names.iter().take(FIGURES) {
        let mut lines: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
        let mut add = |label: String, x: f64, y: f64| match lines.iter_mut().find(|l| l.0 == label)
        {
            Some((_, points)) => points.push((x, y)),
            None => lines.push((label, vec![(x, y)])),
        };
        for cell in &result.cells {
            let x = cell.at.get(address).copied().unwrap_or(f64::NAN);
            let mut rest = vec![cell.experiment.clone()];
            rest.extend(
                cell.at
                    .iter()
                    .filter(|(n, _)| *n != address)
                    .map(|(n, v)| format!("{n}={}", short(*v))),
            );
            let rest = rest.join(" ");
            for method in &cell.methods {
                let Some(n) = method.numbers.get(name) else {
                    continue;
                };
                add(
                    format!("{} {rest}", method.method),
                    x,
                    n.rmse.value.unwrap_or(f64::NAN),
                );
                if let Some(bound) = n.bound {
                    add(format!("bound {rest}"), x, bound);
                }
            }
        }
        let series = lines
            .into_iter()
            .enumerate()
            .map(|(k, (label, mut points))| {
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                points.dedup();
                let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
                let mark = if label.starts_with("bound ") {
                    Mark::Dashed
                } else {
                    Mark::Line
                };
                Series::new(&label, mark, k, &x, &y)
            });
        figures.push(Figure::plot(
            name,
            Plot {
                title: format!("error of {name}"),
                x: Axis::new(address, ""),
                y: Axis::new("RMSE and bound", "SI"),
                log: true,
                series: series.collect(),
                height: 260.0,
                half: true,
                ..Plot::default()
            },
        ));
    }
    figures
}
