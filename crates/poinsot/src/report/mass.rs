//! Section 2: the numbers, with interval, nominal value and source.

use super::Answer;
use super::numbers::{NINETY_FIVE, in_sigmas, interval, minus, percent, plain, plus_minus, value};
use minijinja::{Value, context};
use poinsot_formats::{BodyFile, NumberFile, VectorFile};
use poinsot_report::{Axis, Figure, Mark, PageError, Part, Plot, Series, render, significant};

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let bodies = &e.bodies;
    let mut tables: Vec<Value> = Vec::new();
    let mut figures: Vec<Figure> = Vec::new();
    for (at, (name, b)) in bodies.iter().enumerate().filter(|(_, b)| b.1.is_asked()) {
        let truth = answer.truth.body(name);
        let figure = against_truth(&format!("mass_body{}_{name}", at + 1), b, truth);
        tables.push(table(name, b, truth, figure.as_ref())?);
        figures.extend(figure);
    }
    let known: Vec<&String> = bodies
        .iter()
        .filter(|b| !b.1.is_asked())
        .map(|b| b.0)
        .collect();
    if let (Some(whole), true) = (e.system.first(), bodies.len() > 1) {
        let name =
            "whole vehicle at the first sample, joints locked (base axes, from the base origin)";
        let truth = answer.truth.system();
        let figure = against_truth("mass_whole_vehicle", &whole.body, truth);
        tables.push(table(name, &whole.body, truth, figure.as_ref())?);
        figures.extend(figure);
    }
    let nuisance: Vec<Value> = e
        .nuisance
        .iter()
        .map(|(name, n)| row(name, "", n, None))
        .collect();
    let axes = |t: &VectorFile, what: &str, unit: &str| -> Vec<Value> {
        ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .map(|(k, axis)| row(&format!("{what} {axis}"), unit, &t.number(k), None))
            .collect()
    };
    let momentum: Vec<Value> = e
        .momentum
        .iter()
        .enumerate()
        .map(|(k, m)| {
            let unseen = (0..3).all(|k| m.linear_N_s.number(k).source.is_none());
            let mut rows = if unseen {
                Vec::new()
            } else {
                axes(&m.linear_N_s, "P", "N s")
            };
            rows.extend(axes(&m.angular_N_m_s, "h", "N m s"));
            context! { label => e.fit.get(k).map(|f| f.segment.clone()).unwrap_or_default(), rows, unseen }
        })
        .collect();
    let body = render(
        "mass.html",
        include_str!("templates/mass.html"),
        context! { tables, withheld => e.is_withheld(), known, nuisance, momentum, truth => answer.truth.is_known() },
    )?;
    Ok(Part {
        id: "mass",
        title: "Mass properties",
        body,
        figures,
    })
}

fn table(
    name: &str,
    body: &BodyFile,
    truth: [Option<f64>; 10],
    figure: Option<&Figure>,
) -> Result<Value, PageError> {
    let rows: Vec<Value> = body
        .numbers()
        .iter()
        .zip(truth)
        .map(|((what, unit, n), t)| row(what, unit, n, t))
        .collect();
    let figure = figure.map(Figure::html).transpose()?.map(|f| f.value());
    Ok(
        context! { name, rows, figure, impossible => body.physically_consistent == Some(false), truth => truth.iter().any(Option::is_some) },
    )
}

/// Every interval about its truth, in its own sigma; `None` where no truth is known.
fn against_truth(file: &str, body: &BodyFile, truth: [Option<f64>; 10]) -> Option<Figure> {
    let mut names = Vec::new();
    let (mut x, mut z, mut bar_x, mut bar_z) = (vec![], vec![], vec![], vec![]);
    for ((name, _, n), t) in body.numbers().into_iter().zip(truth) {
        if let (Some(v), Some(s), Some(t)) = (n.value, n.sigma.filter(|s| *s > 0.0), t) {
            names.push(name);
            let (at, error) = (names.len() as f64, (v - t) / s);
            x.push(at);
            z.push(error);
            bar_x.extend([at, at, f64::NAN]);
            bar_z.extend([error - NINETY_FIVE, error + NINETY_FIVE, f64::NAN]);
        }
    }
    (!names.is_empty()).then(|| {
        let plot = Plot {
            title: "estimate against truth".to_owned(),
            y: Axis::new("error", "sigma"),
            names,
            series: vec![
                Series::new("95 % interval", Mark::Line, 0, &bar_x, &bar_z),
                Series::new("estimate", Mark::Points, 1, &x, &z),
            ],
            levels: vec![(0.0, "truth".to_owned())],
            height: 170.0,
            ..Plot::default()
        };
        Figure::plot(file, plot)
    })
}

/// A nominal value with no more figures than help; composites have as many as a double holds.
fn brief(x: f64) -> String {
    let all = plain(x);
    if all.chars().count() <= 9 {
        all
    } else {
        minus(&significant(x, 6))
    }
}

fn row(name: &str, unit: &str, n: &NumberFile, truth: Option<f64>) -> Value {
    let known = n.is_known();
    let gap = n.value.map(|v| v - n.nominal).filter(|_| !known);
    let error = n.value.zip(truth).map(|(v, t)| v - t).filter(|_| !known);
    context! {
        name,
        unit,
        value => if known { plain(n.nominal) } else { value(n.value, n.sigma) },
        half => plus_minus(n.sigma),
        interval => interval(n.value, n.sigma),
        nominal => brief(n.nominal),
        percent => gap.map(|g| percent(g, n.nominal)),
        sigmas => gap.map(|g| in_sigmas(g, n.sigma)),
        truth => truth.map(plain),
        error => error.map(|x| in_sigmas(x, n.sigma)),
        source => n.source.clone().unwrap_or_default(),
        open => n.value.is_none(),
    }
}
