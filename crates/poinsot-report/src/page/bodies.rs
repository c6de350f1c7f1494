//! The numbers: one folded table per body.

use super::Answer;
use super::picture::moments;
use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{PageError, Part, half_width};
use poinsot_formats::{BodyFile, MomentumFile, NumberFile, TrueBodyFile, VectorFile};

/// Width of a bar, px.
const WIDE: f64 = 120.0;
/// Least width of a visible bar, px.
const THIN: f64 = 3.0;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let truth = answer.data.truth.as_ref();
    let (asked, known): (Vec<_>, Vec<_>) = e.bodies.iter().partition(|b| b.1.is_asked());
    let asked = asked.into_iter().map(|(name, b)| {
        let truth = truth.and_then(|t| t.bodies.get(name));
        table(name, b, truth)
    });
    let whole = answer.whole().map(|b| {
        let truth = truth.and_then(|t| t.system.as_ref());
        table(super::WHOLE, b, truth)
    });
    let nuisance = e.nuisance.iter().map(|(name, n)| row(name, "", n, None));
    let momentum = e.momentum.iter().enumerate().filter(|_| !e.is_withheld());
    let momentum = momentum.map(|(k, m)| {
        context! { label => e.fit.get(k).map(|f| &f.segment), rows => momenta(m) }
    });
    let context = context! {
        withheld => e.is_withheld(),
        tables => asked.chain(whole).collect::<Vec<_>>(),
        known => known.iter().map(|b| b.0).collect::<Vec<_>>(),
        nuisance => nuisance.collect::<Vec<_>>(),
        momentum => momentum.collect::<Vec<_>>(),
        moments => moments(answer),
        covariance => e.covariance,
    };
    let body = TEMPLATES.html("bodies.html", context)?;
    Ok(Part::new("numbers", "Numbers", body))
}

/// Momentum of a record; without measured translation, linear momentum is not listed.
fn momenta(m: &MomentumFile) -> Vec<Value> {
    let axes = |v: &VectorFile, what: &str, unit: &str| -> Vec<Value> {
        let row = |(axis, n): (&str, &NumberFile)| row(&format!("{what} {axis}"), unit, n, None);
        v.named().into_iter().map(row).collect()
    };
    let measured = m.linear_N_s.named().iter().any(|(_, n)| n.source.is_some());
    let linear = measured.then(|| axes(&m.linear_N_s, "P", "N s"));
    let angular = axes(&m.angular_N_m_s, "h", "N m s");
    linear.into_iter().flatten().chain(angular).collect()
}

fn table(name: &str, body: &BodyFile, truth: Option<&TrueBodyFile>) -> Value {
    let numbers = body.numbers();
    let truths: Vec<f64> = truth.map_or_else(Vec::new, |t| {
        t.mass.numbers().iter().map(|n| n.2.value).collect()
    });
    let both = || {
        numbers
            .iter()
            .enumerate()
            .map(|(k, n)| (n, truths.get(k).copied()))
    };
    let holds = |(n, truth): (&(_, _, NumberFile), Option<f64>)| {
        Some((n.2.value? - truth?).abs() <= half_width(n.2.sigma)?)
    };
    let judged: Vec<bool> = both().filter_map(holds).collect();
    let rows = both().map(|((what, unit, n), t)| row(what, unit, n, t));
    let asked = numbers.iter().filter(|n| !n.2.is_known());
    context! {
        name,
        rows => rows.collect::<Vec<_>>(),
        known => truth.is_some(),
        asked => asked.clone().count(),
        determined => asked.filter(|n| n.2.value.is_some()).count(),
        impossible => body.physically_consistent == Some(false),
        judged => judged.len(),
        within => judged.iter().filter(|inside| **inside).count(),
    }
}

fn row(name: &str, unit: &str, number: &NumberFile, truth: Option<f64>) -> Value {
    let bar = bar(number, truth).filter(|_| !number.is_known());
    context! { name, unit, number, truth, bar }
}

/// The interval between nominal value and estimate: positions and widths in px.
fn bar(n: &NumberFile, truth: Option<f64>) -> Option<Value> {
    let (v, half) = (n.value?, half_width(n.sigma)?);
    let marks = [n.nominal, v - half, v + half, truth.unwrap_or(v)];
    let low = marks.into_iter().fold(f64::INFINITY, f64::min);
    let high = marks.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let span = (high - low).max(f64::MIN_POSITIVE);
    let place = |x: f64| 4.0 + (WIDE - 8.0) * (x - low) / span;
    let (from, to) = (place(v - half), place(v + half));
    let wide = (to - from).max(THIN);
    Some(context! {
        from => (from + to - wide) / 2.0,
        wide,
        nominal => place(n.nominal),
        truth => truth.map(place),
    })
}
