//! Exact data, the paper's histories, and errors against mass ratio and noise.

use super::experiment::{self, Experiment, unsymmetric};
use super::noise::{OPTIONS, SEEDS, Scaling, Sigma, medians, trials, worst};
use crate::ma2008::printed::{PrintedAxes, two_step_printed};
use crate::study::statistics::quantile;
use crate::study::{Cell, Context, Findings, StudyError, Table, decimals, figures, percent, word};
use poinsot_report::{Axis, Mark, Plot, Series};

/// Title, name of files and unit of each error, and its factor.
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
const ORBITAL: f64 = 7500.0;

fn option(known: bool) -> &'static str {
    if known { "option 1" } else { "option 2" }
}

/// Errors on exact data: both trajectories, both options, printed option 2 beside them.
pub fn exact(context: &Context) -> Result<Findings, StudyError> {
    let mut table = Table::new(
        "exact",
        "Ten stopped samples, exact data: largest of the errors of mass, mass centre (m) and tensor; mass of option 2 as printed, kg",
        &[
            "base",
            "trajectory, spin deg/s",
            "orbital, m/s",
            "option 1",
            "option 2",
            "as printed, in base axes",
            "as printed, in N",
        ],
    );
    let mut findings = Findings::default();
    for (name, full) in [
        ("Table 1", false),
        ("offset mass centre, full tensor", true),
    ] {
        for (trajectory, spin, motion) in [
            (1, [0.0, 0.0, 5.0], "1, z 5"),
            (1, [0.0, 0.0, 1.0], "1, z 1"),
            (2, [0.0, 1.0, 5.0], "2, y 1 z 5"),
        ] {
            for orbital in [0.0, ORBITAL] {
                let mut e = Experiment::of(context, trajectory, spin)?;
                if full {
                    e = e.with_base(unsymmetric());
                }
                e.velocity = [0.02 + orbital, -0.01, 0.005];
                let run = e.run()?;
                let samples = experiment::readings(&e.model, &run.raws);
                let [one, two] = OPTIONS.map(|known| worst(&e, &run, known));
                let printed = [PrintedAxes::Body, PrintedAxes::Inertial]
                    .map(|axes| two_step_printed(&samples, axes).map_or(f64::NAN, |p| p.mass()));
                let cells = [
                    word(motion),
                    decimals(orbital, 0),
                    figures(one, 1),
                    figures(two, 1),
                    decimals(printed[0], 2),
                    decimals(printed[1], 2),
                ];
                table.row(name, cells);
                if full && trajectory == 2 && orbital == 0.0 {
                    let [one, two] = [one, two].map(|x| format!("{x:.0e}"));
                    findings.state("(10)-(13) step 1, option 1", one.clone());
                    let printed = format!("{two}; as printed {:.0} kg of 1000 kg", printed[1]);
                    findings.state("(14)-(17) step 1, option 2", printed);
                    findings.state("(18)-(20) step 2, option 1", one);
                    findings.state("(21)-(24) step 2, option 2", two);
                }
            }
        }
    }
    findings.tables.push(table);
    Ok(findings)
}

/// Fig. 9 to 12: the six velocities with the marked configurations.
pub fn histories(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut table = Table::new(
        "histories",
        "Largest velocities along both trajectories",
        &["figure", "duration, s", "base origin, m/s", "base, rad/s"],
    );
    let mut ends = Vec::new();
    for (figure, trajectory, spin, marks) in [
        (
            "fig10",
            1,
            [0.0, 0.0, 5.0],
            &[(5.0, "A"), (45.0, "B"), (75.0, "C"), (125.0, "D")][..],
        ),
        ("fig12", 2, [0.0, 1.0, 0.0], &[(5.0, "A"), (45.0, "B")]),
    ] {
        let mut e = Experiment::of(context, trajectory, spin)?.sampled(2, false);
        let end = e.knots[e.knots.len() - 1].0;
        ends.push(format!("{end} s"));
        e.times = (0..=2 * end as usize).map(|k| 0.5 * k as f64).collect();
        let run = e.run()?;
        let most = |of: &dyn Fn(usize) -> f64| (0..run.raws.len()).map(of).fold(0.0, f64::max);
        table.row(
            format!("Fig. {}, trajectory {trajectory}", &figure[3..]),
            [
                decimals(end, 0),
                figures(most(&|k| run.raws[k].v_NBo_N.norm()), 3),
                figures(most(&|k| run.raws[k].w_NB_B.norm()), 3),
            ],
        );
        for (kind, label, unit) in [("v", "velocity in N", "m/s"), ("w", "rate in B", "rad/s")] {
            let at = |k: usize, axis: usize| match kind {
                "v" => run.raws[k].v_NBo_N[axis],
                _ => run.raws[k].w_NB_B[axis],
            };
            let curve = |axis: usize| {
                let values: Vec<f64> = (0..run.raws.len()).map(|k| at(k, axis)).collect();
                Series::new(["x", "y", "z"][axis], Mark::Line, axis, &run.times, &values)
            };
            let names: Vec<String> = marks.iter().map(|(t, m)| format!("{m} at {t} s")).collect();
            let at_marks = |axis: usize| -> Vec<(f64, f64)> {
                marks
                    .iter()
                    .map(|(t, _)| (*t, at((2.0 * t) as usize, axis)))
                    .collect()
            };
            let dots = |axis: usize| Series {
                points: at_marks(axis),
                ..Series::new("", Mark::Points, axis, &[], &[])
            };
            findings.plot(
                &format!("{figure}_{kind}"),
                Plot {
                    title: format!("Fig. {}: {label}, trajectory {trajectory}", &figure[3..]),
                    x: Axis::new("time", "s"),
                    y: Axis::new(label, unit),
                    series: (0..3).map(curve).chain((0..3).map(dots)).collect(),
                    note: format!("Dots: configurations {}.", names.join(", ")),
                    ..Plot::default()
                },
            );
        }
    }
    findings.tables.push(table);
    findings.state("Fig. 9-12 trajectories and velocities", ends.join(", "));
    Ok(findings)
}

/// One curve of a sweep: its name, and three errors with their bands at each place.
struct Curve {
    name: String,
    medians: Vec<[f64; 3]>,
    bands: Vec<[[f64; 2]; 3]>,
}

impl Curve {
    fn push(&mut self, found: &[[f64; 3]]) {
        let of = |k: usize, q: f64| quantile(found.iter().map(|e| e[k]), q);
        self.medians.push(std::array::from_fn(|k| of(k, 0.5)));
        self.bands
            .push(std::array::from_fn(|k| [of(k, 0.05), of(k, 0.95)]));
    }
}

/// One plot an error: medians of all curves, bands of the first that has one.
fn plots(
    figure: &str,
    x: Axis,
    places: &[f64],
    names: Vec<String>,
    curves: &[Curve],
    findings: &mut Findings,
) {
    for (k, (title, file, unit, factor)) in ERRORS.into_iter().enumerate() {
        let mut series = Vec::new();
        for (colour, curve) in curves.iter().enumerate() {
            let of = |pick: &dyn Fn(usize) -> f64| -> Vec<f64> {
                (0..places.len()).map(|i| factor * pick(i)).collect()
            };
            if curve.name.contains("option 1") && curve.bands.iter().any(|b| b[k][1] > b[k][0]) {
                let (low, high) = (of(&|i| curve.bands[i][k][0]), of(&|i| curve.bands[i][k][1]));
                series.push(Series::band("", colour, places, &low, &high));
            }
            let medians = of(&|i| curve.medians[i][k]);
            series.push(Series::new(
                &curve.name,
                Mark::Line,
                colour,
                places,
                &medians,
            ));
        }
        findings.plot(
            &format!("{figure}_{file}"),
            Plot {
                title: format!(
                    "{}: {title}, median of {SEEDS} trials",
                    figure.replace("fig", "Fig. ").replace("_", " ")
                ),
                x: x.clone(),
                y: Axis::new(title, unit),
                log: true,
                names: names.clone(),
                series,
                ..Plot::default()
            },
        );
    }
}

fn error_head(first: &str) -> Vec<String> {
    let errors = ERRORS.map(|(title, _, unit, _)| format!("{title}, {unit}"));
    std::iter::once(first.to_owned()).chain(errors).collect()
}

fn error_cells(errors: &[f64; 3]) -> [Cell; 3] {
    [
        percent(errors[0], 2),
        figures(errors[1], 2),
        percent(errors[2], 2),
    ]
}

/// A ratio as text; one decimal is enough for all of them.
fn in_percent(ratio: f64) -> String {
    format!("{}", (1000.0 * ratio).round() / 10.0)
}

/// Fig. 8: errors against the mass ratio, noise-free and with 1 % of each maximum.
pub fn mass_ratio(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = Vec::new();
    let mut worst_exact: f64 = 0.0;
    for (name, known, share) in [
        ("option_1", true, 0.01),
        ("option_2", false, 0.01),
        ("option_1_exact", true, 0.0),
        ("option_2_exact", false, 0.0),
    ] {
        let mut curve = Curve {
            name: format!("{}, noise {} %", option(known), 100.0 * share),
            medians: Vec::new(),
            bands: Vec::new(),
        };
        let title = format!("Fig. 8: {}, median of {SEEDS} trials", curve.name);
        let mut table = Table::new(name, &title, &[]);
        table.head = error_head("arm / base, %");
        for ratio in RATIOS {
            let e = Experiment::of(context, 1, [0.0, 0.0, 5.0])?.with_ratio(ratio);
            let run = e.run()?;
            let sigma = Sigma::of(&run, share, Scaling::Component);
            let seeds = if share > 0.0 { SEEDS } else { 1 };
            curve.push(&trials(&e, &run, sigma, known, seeds));
            let last = curve.medians[curve.medians.len() - 1];
            if share == 0.0 {
                worst_exact = last.into_iter().fold(worst_exact, f64::max);
            }
            table.row(in_percent(ratio), error_cells(&last));
        }
        findings.tables.push(table);
        curves.push(curve);
    }
    let places: Vec<f64> = (1..=RATIOS.len()).map(|k| k as f64).collect();
    let names = RATIOS.map(in_percent).to_vec();
    plots(
        "fig8",
        Axis::new("arm mass / base mass", "%"),
        &places,
        names,
        &curves,
        &mut findings,
    );
    let text = format!("noise-free at most {worst_exact:.0e} at every ratio");
    findings.state("Fig. 8 errors against mass ratio", text);
    Ok(findings)
}

/// Fig. 13 and 14: errors against noise.
pub fn noise(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let shares: Vec<f64> = (1..=10).map(|k| 0.005 * f64::from(k)).collect();
    let mut tensors = Vec::new();
    for (n, names) in [
        (
            1,
            [
                ["ex1_own_1", "ex1_own_2"],
                ["ex1_largest_1", "ex1_largest_2"],
            ],
        ),
        (
            2,
            [
                ["ex2_own_1", "ex2_own_2"],
                ["ex2_largest_1", "ex2_largest_2"],
            ],
        ),
    ] {
        let e = Experiment::example(context, n)?;
        let run = e.run()?;
        let mut curves = Vec::new();
        for (scaling, names) in [Scaling::Component, Scaling::Largest]
            .into_iter()
            .zip(names)
        {
            for (known, name) in OPTIONS.into_iter().zip(names) {
                let mut curve = Curve {
                    name: format!("{}, {}", option(known), scaling.name()),
                    medians: Vec::new(),
                    bands: Vec::new(),
                };
                let title = format!("Fig. {}: example {n}, {}", 12 + n, curve.name);
                let mut table = Table::new(name, &title, &[]);
                table.head = error_head("noise, %");
                for share in &shares {
                    let sigma = Sigma::of(&run, *share, scaling);
                    curve.push(&trials(&e, &run, sigma, known, SEEDS));
                    let last = curve.medians[curve.medians.len() - 1];
                    table.row(format!("{:.1}", 100.0 * share), error_cells(&last));
                    if known && scaling == Scaling::Component && *share == NOISE {
                        tensors.push(format!("{:.1}", 100.0 * last[2]));
                    }
                }
                findings.tables.push(table);
                curves.push(curve);
            }
        }
        let places: Vec<f64> = shares.iter().map(|s| 100.0 * s).collect();
        let x = Axis::new("noise over the maximum", "%");
        plots(
            &format!("fig{}", 12 + n),
            x,
            &places,
            Vec::new(),
            &curves,
            &mut findings,
        );
    }
    let text = format!("tensor {} % at 3 % noise", tensors.join(" and "));
    findings.state("Fig. 13, 14 errors against noise", text);
    Ok(findings)
}

/// Five readings of "a percentage of the maximum velocity value": own or largest component, option 1 or 2, and a
/// share of the velocity with the orbital one in it.
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

/// Errors of both examples in five readings of the noise.
pub fn readings(context: &Context) -> Result<Findings, StudyError> {
    let mut table = Table::new(
        "readings",
        "Median error of the tensor, % of its norm, at 3 % noise",
        &["reading", "example 1", "example 2"],
    );
    table.row("paper", [word("about 3"), word("over 20")]);
    let mut orbital = Table::new(
        "orbital",
        "3 % of each component's maximum, orbital 7500 m/s in it: median errors",
        &[],
    );
    orbital.head = error_head("example, option");
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
            table.row(format!("{}, {}", scaling.name(), option(known)), cells);
        }
    }
    for n in [1, 2] {
        let found = reading(context, n, Scaling::Component, ORBITAL)?;
        for (k, known) in OPTIONS.into_iter().enumerate() {
            orbital.row(
                format!("example {n}, {}", option(known)),
                error_cells(&found[k]),
            );
        }
    }
    let mut findings = Findings::of(table);
    findings.tables.push(orbital);
    findings.state(
        "3 % noise: 3 % and over 20 %",
        format!("{} %", statement.join(", ")),
    );
    Ok(findings)
}
