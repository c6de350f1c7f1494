//! Errors against mass ratio and noise, and the interpretations of the noise.

use super::experiment::Experiment;
use super::noise::{Errors, OPTIONS, SEEDS, Scaling, Sigma, medians, trials};
use crate::study::statistics::{largest, quantile};
use crate::study::{Cell, Context, Findings, StudyError, Table, figures, percent, word};
use poinsot_figures::{Axis, Mark, Plot, Series};

/// Title, file name, unit and factor of each error.
const ERRORS: [(&str, &str, &str, f64); 3] = [
    ("mass error", "mass", "%", 100.0),
    ("mass centre error", "mass_centre", "m", 1.0),
    ("tensor error", "tensor", "%", 100.0),
];
/// Ratios of arm to base mass of Fig. 8.
const RATIOS: [f64; 12] = [
    0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5,
];
/// Noise of the examples, Sec. III.D.
const NOISE: f64 = 0.03;
/// Speed along the orbit, m/s.
pub const ORBITAL: f64 = 7500.0;

fn option(known: bool) -> &'static str {
    if known { "option 1" } else { "option 2" }
}

/// A table of the three errors.
fn table(name: impl Into<String>, title: &str, first: &str) -> Table {
    let errors = ERRORS.map(|(title, _, unit, _)| format!("{title}, {unit}"));
    Table::new(name, title, &format!("{first} | {}", errors.join(" | ")))
}

fn cells(errors: &Errors) -> [Cell; 3] {
    let [mass, mass_centre, tensor] = *errors;
    [
        percent(mass, 2),
        figures(mass_centre, 2),
        percent(tensor, 2),
    ]
}

/// One curve of a sweep: name, table, and three errors with their bands at each point.
struct Curve {
    name: String,
    table: Table,
    medians: Vec<Errors>,
    bands: Vec<[[f64; 2]; 3]>,
}

impl Curve {
    fn new(file: String, figure: &str, name: String, first: &str) -> Self {
        let title = format!("{figure}, {name}: median of {SEEDS} trials");
        Self {
            table: table(file, &title, first),
            name,
            medians: Vec::new(),
            bands: Vec::new(),
        }
    }

    /// Adds the trials of one point; returns their medians.
    fn push(&mut self, place: String, found: &[Errors]) -> Errors {
        let of = |k: usize, q: f64| quantile(found.iter().map(|e| e[k]), q);
        let medians = std::array::from_fn(|k| of(k, 0.5));
        self.table.row(place, cells(&medians));
        self.medians.push(medians);
        let band = |k: usize| [of(k, 0.05), of(k, 0.95)];
        self.bands.push(std::array::from_fn(band));
        medians
    }
}

/// Tables of the curves, and one plot per error: medians of all curves, bands of option 1.
fn show(
    figure: usize,
    x: &Axis,
    (places, names): (&[f64], Vec<String>),
    curves: Vec<Curve>,
    findings: &mut Findings,
) {
    for (k, (title, file, unit, factor)) in ERRORS.into_iter().enumerate() {
        let mut series = Vec::new();
        for (colour, curve) in curves.iter().enumerate() {
            let scaled = |list: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
                list.map(|x| factor * x).collect()
            };
            let bands = || curve.bands.iter().map(move |b| b[k]);
            if curve.name.contains("option 1") && bands().any(|b| b[1] > b[0]) {
                let [low, high] = [0, 1].map(|end| scaled(&mut bands().map(|b| b[end])));
                series.push(Series::band("", colour, places, &low, &high));
            }
            let medians = scaled(&mut curve.medians.iter().map(|m| m[k]));
            series.push(Series::new(
                &curve.name,
                Mark::Line,
                colour,
                places,
                &medians,
            ));
        }
        let plot = Plot {
            title: format!("Fig. {figure}: {title}, median of {SEEDS} trials"),
            x: x.clone(),
            y: Axis::new(title, unit),
            log: true,
            names: names.clone(),
            series,
            ..Plot::default()
        };
        findings.plot(&format!("fig{figure}_{file}"), plot);
    }
    findings.tables.extend(curves.into_iter().map(|c| c.table));
}

/// A ratio in percent with one decimal, which suffices here.
fn in_percent(ratio: f64) -> String {
    format!("{}", (1000.0 * ratio).round() / 10.0)
}

/// Fig. 8: errors against the mass ratio, noise-free and with 1 % of each maximum.
pub fn mass_ratio(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = Vec::new();
    let mut exact: Vec<f64> = Vec::new();
    for (file, known, share) in [
        ("option_1", true, 0.01),
        ("option_2", false, 0.01),
        ("option_1_exact", true, 0.0),
        ("option_2_exact", false, 0.0),
    ] {
        let name = format!("{}, noise {} %", option(known), 100.0 * share);
        let mut curve = Curve::new(file.to_owned(), "Fig. 8", name, "arm / base, %");
        for ratio in RATIOS {
            let e = Experiment::of(context, 1, [0.0, 0.0, 5.0])?.with_ratio(ratio);
            let run = e.run()?;
            let sigma = Sigma::of(&run, share, Scaling::Component);
            let seeds = if share > 0.0 { SEEDS } else { 1 };
            let found = trials(&e, &run, sigma, known, seeds);
            let medians = curve.push(in_percent(ratio), &found);
            exact.extend(medians.into_iter().filter(|_| share == 0.0));
        }
        curves.push(curve);
    }
    let places: Vec<f64> = (1..=RATIOS.len()).map(|k| k as f64).collect();
    let names = RATIOS.map(in_percent).to_vec();
    let x = Axis::new("arm mass / base mass", "%");
    show(8, &x, (&places, names), curves, &mut findings);
    let text = format!("noise-free at most {:.0e} at every ratio", largest(exact));
    findings.state("Fig. 8 errors against mass ratio", text);
    Ok(findings)
}

/// Fig. 13 and 14: errors against noise.
pub fn noise(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let shares: Vec<f64> = (1..=10).map(|k| 0.005 * f64::from(k)).collect();
    let places: Vec<f64> = shares.iter().map(|s| 100.0 * s).collect();
    let x = Axis::new("noise over the maximum", "%");
    let mut tensors = Vec::new();
    for n in [1, 2] {
        let e = Experiment::example(context, n)?;
        let run = e.run()?;
        let mut curves = Vec::new();
        for (scaling, own) in [(Scaling::Component, "own"), (Scaling::Largest, "largest")] {
            for (known, k) in OPTIONS.into_iter().zip(1..) {
                let figure = format!("Fig. {}, example {n}", 12 + n);
                let name = format!("{}, {}", option(known), scaling.name());
                let file = format!("ex{n}_{own}_{k}");
                let mut curve = Curve::new(file, &figure, name, "noise, %");
                for share in &shares {
                    let sigma = Sigma::of(&run, *share, scaling);
                    let found = trials(&e, &run, sigma, known, SEEDS);
                    let [_, _, tensor] = curve.push(format!("{:.1}", 100.0 * share), &found);
                    if known && scaling == Scaling::Component && *share == NOISE {
                        tensors.push(format!("{:.1}", 100.0 * tensor));
                    }
                }
                curves.push(curve);
            }
        }
        show(12 + n, &x, (&places, Vec::new()), curves, &mut findings);
    }
    let text = format!("tensor {} % at 3 % noise", tensors.join(" and "));
    findings.state("Fig. 13, 14 errors against noise", text);
    Ok(findings)
}

/// Five interpretations of "a percentage of the maximum velocity value": each component or the largest, option 1 or 2,
/// and a percentage that includes the orbital velocity.
fn reading(
    context: &Context,
    n: usize,
    scaling: Scaling,
    orbital: f64,
) -> Result<[[f64; 3]; 2], StudyError> {
    let mut e = Experiment::example(context, n)?;
    e.velocity = [orbital, 0.0, 0.0];
    let run = e.run()?;
    let sigma = Sigma::of(&run, NOISE, scaling);
    Ok(OPTIONS.map(|known| medians(&e, &run, sigma, known)))
}

/// Errors of both examples in five interpretations of the noise.
pub fn readings(context: &Context) -> Result<Findings, StudyError> {
    let mut readings = Table::new(
        "readings",
        "Median error of the tensor, % of its norm, at 3 % noise",
        "reading | example 1 | example 2",
    );
    readings.row("paper", [word("about 3"), word("over 20")]);
    let title = "3 % of each component's maximum, orbital 7500 m/s in it: median errors";
    let mut orbital = table("orbital", title, "example, option");
    let mut statement = Vec::new();
    for scaling in [Scaling::Largest, Scaling::Component] {
        let found = [
            reading(context, 1, scaling, 0.0)?,
            reading(context, 2, scaling, 0.0)?,
        ];
        for (k, known) in OPTIONS.into_iter().enumerate() {
            let cells = found.map(|of| percent(of[k][2], 2));
            if known && scaling == Scaling::Largest {
                statement = cells.iter().map(Cell::text).collect();
            }
            readings.row(format!("{}, {}", scaling.name(), option(known)), cells);
        }
    }
    for n in [1, 2] {
        let found = reading(context, n, Scaling::Component, ORBITAL)?;
        for (k, known) in OPTIONS.into_iter().enumerate() {
            orbital.row(format!("example {n}, {}", option(known)), cells(&found[k]));
        }
    }
    let mut findings = Findings::of(readings);
    findings.tables.push(orbital);
    findings.state(
        "3 % noise: 3 % and over 20 %",
        format!("{} %", statement.join(", ")),
    );
    Ok(findings)
}
