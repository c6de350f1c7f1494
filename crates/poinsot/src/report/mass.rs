//! Section 2: the numbers, with interval, nominal value and source.

use super::Answer;
use super::estimate::{Body, Number};
use super::numbers::{NINETY_FIVE, in_sigmas, interval, percent, plain, plus_minus, value};
use minijinja::{Value, context};
use poinsot_report::{Axis, Html, Mark, PageError, Part, Plot, Series, render};

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let bodies = e.bodies();
    let mut tables: Vec<Value> = bodies
        .iter()
        .filter(|(_, b)| b.asked())
        .map(|(name, b)| table(name, b, answer.truth.body(name)))
        .collect();
    let known: Vec<&String> = bodies
        .iter()
        .filter(|b| !b.1.asked())
        .map(|b| &b.0)
        .collect();
    if let (Some(whole), true) = (e.system.first(), bodies.len() > 1) {
        let name =
            "whole vehicle at the first sample, joints locked (base axes, from the base origin)";
        tables.push(table(name, whole, answer.truth.system()));
    }
    let nuisance: Vec<Value> = e
        .nuisance()
        .iter()
        .map(|(name, n)| row(name, "", n, None))
        .collect();
    let axes = |t: &super::estimate::Triple, what: &str, unit: &str| -> Vec<Value> {
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
        context! { tables, known, nuisance, momentum, truth => answer.truth.is_known() },
    )?;
    Ok(Part {
        id: "mass",
        title: "Mass properties",
        body,
    })
}

fn table(name: &str, body: &Body, truth: [Option<f64>; 10]) -> Value {
    let rows: Vec<Value> = body
        .numbers()
        .iter()
        .zip(truth)
        .map(|((what, unit, n), t)| row(what, unit, n, t))
        .collect();
    let figure = against_truth(body, truth).map(|f| f.value());
    context! { name, rows, figure, impossible => body.physically_consistent == Some(false), truth => truth.iter().any(Option::is_some) }
}

/// Every interval about its truth, in its own sigma; `None` where no truth is known.
fn against_truth(body: &Body, truth: [Option<f64>; 10]) -> Option<Html> {
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
        Plot {
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
        }
        .html()
    })
}

fn row(name: &str, unit: &str, n: &Number, truth: Option<f64>) -> Value {
    let known = n.is_known();
    let gap = n.value.map(|v| v - n.nominal).filter(|_| !known);
    let error = n.value.zip(truth).map(|(v, t)| v - t).filter(|_| !known);
    context! {
        name,
        unit,
        value => if known { plain(n.nominal) } else { value(n.value, n.sigma) },
        half => plus_minus(n.sigma),
        interval => interval(n.value, n.sigma),
        nominal => plain(n.nominal),
        percent => gap.map(|g| percent(g, n.nominal)),
        sigmas => gap.map(|g| in_sigmas(g, n.sigma)),
        truth => truth.map(plain),
        error => error.map(|x| in_sigmas(x, n.sigma)),
        source => n.source.clone().unwrap_or_default(),
        open => n.value.is_none(),
    }
}
