//! The numbers: one folded table per body.

use super::Answer;
use super::numbers::{brief, difference, half_width, plus_minus, value};
use super::picture::moments;
use minijinja::{Value, context};
use poinsot_figures::{PageError, Part, render};
use poinsot_files::rounded;
use poinsot_formats::{BodyFile, NumberFile, VectorFile};

/// Width of a bar, px.
const WIDE: f64 = 120.0;
/// Least width of a visible bar, px.
const THIN: f64 = 3.0;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let bodies = &e.bodies;
    let withheld = e.is_withheld();
    let asked = bodies.iter().filter(|(_, b)| b.is_asked());
    let mut tables: Vec<Value> = asked
        .map(|(name, b)| table(name, b, answer.truth.body(name), withheld))
        .collect();
    let known: Vec<&String> = bodies
        .iter()
        .filter(|b| !b.1.is_asked())
        .map(|b| b.0)
        .collect();
    if let (Some(whole), true) = (e.system.first(), bodies.len() > 1) {
        let name = "whole vehicle, joints as at the first sample";
        tables.push(table(name, &whole.body, answer.truth.system(), withheld));
    }
    let nuisance: Vec<Value> = e
        .nuisance
        .iter()
        .map(|(name, n)| row(name, "", n, None, withheld))
        .collect();
    let momentum: Vec<Value> = e
        .momentum
        .iter()
        .enumerate()
        .filter(|_| !withheld)
        .map(|(k, m)| {
            let mut rows = axes(&m.linear_N_s, "P", "N s");
            // Without measured translation, linear momentum is not listed.
            rows.retain(|_| (0..3).any(|k| m.linear_N_s.number(k).source.is_some()));
            rows.extend(axes(&m.angular_N_m_s, "h", "N m s"));
            context! { label => e.fit.get(k).map(|f| f.segment.clone()).unwrap_or_default(), rows }
        })
        .collect();
    let body = render(
        "bodies.html",
        include_str!("templates/bodies.html"),
        context! { tables, known, nuisance, momentum, moments => moments(answer) },
    )?;
    Ok(Part {
        id: "numbers",
        title: "Numbers",
        body,
        figures: Vec::new(),
    })
}

fn axes(t: &VectorFile, what: &str, unit: &str) -> Vec<Value> {
    ["x", "y", "z"]
        .into_iter()
        .enumerate()
        .map(|(k, axis)| row(&format!("{what} {axis}"), unit, &t.number(k), None, false))
        .collect()
}

fn table(name: &str, body: &BodyFile, truth: [Option<f64>; 10], withheld: bool) -> Value {
    let numbers = body.numbers();
    let open = numbers
        .iter()
        .filter(|n| n.2.value.is_none() && !n.2.is_known())
        .count();
    let asked = numbers.iter().filter(|n| !n.2.is_known()).count();
    let rows: Vec<Value> = numbers
        .iter()
        .zip(truth)
        .map(|((what, unit, n), t)| row(what, unit, n, t, withheld))
        .collect();
    let known = truth.iter().any(Option::is_some);
    context! {
        name, rows, known, asked,
        determined => asked - open,
        impossible => body.physically_consistent == Some(false),
        within => within(&numbers, &truth),
    }
}

/// Number of 95 % intervals that hold the truth; `None` if there is none to compare.
fn within(
    numbers: &[(String, &'static str, NumberFile)],
    truth: &[Option<f64>; 10],
) -> Option<String> {
    let judged: Vec<bool> = numbers
        .iter()
        .zip(truth)
        .filter_map(|((_, _, n), t)| Some((n.value? - (*t)?).abs() <= half_width(n.sigma)?))
        .collect();
    let inside = judged.iter().filter(|inside| **inside).count();
    (!judged.is_empty()).then(|| format!("{inside} of {}", judged.len()))
}

fn row(name: &str, unit: &str, n: &NumberFile, truth: Option<f64>, withheld: bool) -> Value {
    let known = n.is_known();
    let gap = n.value.map(|v| v - n.nominal).filter(|_| !known);
    let open = n.value.is_none() && !known;
    context! {
        name, unit, open,
        value => match (known, open && withheld) {
            (true, _) => brief(n.nominal),
            (_, true) => "withheld".to_owned(),
            _ => value(n.value, n.sigma),
        },
        half => plus_minus(n.sigma),
        nominal => brief(n.nominal),
        difference => gap.map(|g| difference(g, n.sigma)),
        bar => bar(n, truth).filter(|_| !known),
        truth => truth.map(|x| rounded(x, 9)),
        source => n.source.clone().unwrap_or_else(|| if withheld { "withheld" } else { "not determined" }.to_owned()),
    }
}

/// The interval between nominal value and estimate: positions and widths in px.
fn bar(n: &NumberFile, truth: Option<f64>) -> Option<Value> {
    let (v, half) = (n.value?, half_width(n.sigma)?);
    let marks = [Some(n.nominal), Some(v - half), Some(v + half), truth];
    let low = marks
        .iter()
        .flatten()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let high = marks
        .iter()
        .flatten()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let span = (high - low).max(f64::MIN_POSITIVE);
    let place = |x: f64| 4.0 + (WIDE - 8.0) * (x - low) / span;
    let (from, to) = (place(v - half), place(v + half));
    let wide = (to - from).max(THIN);
    let px = |x: f64| format!("{x:.1}");
    Some(context! {
        from => px((from + to - wide) / 2.0),
        wide => px(wide),
        nominal => px(place(n.nominal)),
        truth => truth.map(|t| px(place(t))),
    })
}
