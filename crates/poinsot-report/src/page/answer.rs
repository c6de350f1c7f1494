//! First screen: status, one sentence, one action, the tensor, three lights, and the numbers to copy.

use super::Answer;
use super::export::exports;
use super::lights::lights;
use crate::summary::{action, sentence};
use crate::templates::TEMPLATES;
use crate::verdict::Standing;
use minijinja::{Value, context};
use poinsot_figures::{Opening, PageError, Part, half_width, island};
use poinsot_formats::{BodyFile, NumberFile};

/// Half widths of 95 % intervals, relative to the largest inertia, at which the shade becomes lighter.
const SHADES: [f64; 4] = [1.0e-4, 1.0e-3, 1.0e-2, 1.0e-1];

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let (tone, word) = Standing::of(e).display();
    let body = |(name, b): (&str, &BodyFile)| {
        context! { name, rows => matrix(b), mass => b.mass_kg, com => b.com_m }
    };
    let bodies: Vec<Value> = shown(answer).into_iter().map(body).collect();
    let exports = island(&exports(e))?.value();
    let context = context! { bodies, exports, withheld => e.is_withheld() };
    Opening {
        tone,
        word: word.to_owned(),
        sentence: sentence(e).replace("m2", "m\u{b2}"),
        action: action(e),
        lights: lights(answer),
        beside: TEMPLATES.html("answer.html", context)?,
    }
    .part()
}

/// Requested bodies and the whole vehicle; the one with most determined tensor elements is first.
fn shown(answer: &Answer) -> Vec<(&str, &BodyFile)> {
    let e = &answer.estimate;
    let asked = e.bodies.iter().filter(|b| b.1.is_asked());
    let whole = answer.whole().map(|whole| (super::WHOLE, whole));
    let asked = asked.map(|(name, b)| (name.as_str(), b));
    let mut all: Vec<(&str, &BodyFile)> = asked.chain(whole).collect();
    let determined = |b: &BodyFile| {
        let entries = b.inertia_kg_m2.named();
        entries.iter().filter(|n| n.1.value.is_some()).count()
    };
    all.sort_by_key(|(_, b)| std::cmp::Reverse(determined(b)));
    all
}

/// Three rows of the tensor: each element with the class of its cell.
fn matrix(b: &BodyFile) -> Vec<Value> {
    let size = |n: &NumberFile| n.value.unwrap_or(n.nominal).abs();
    let numbers = b.inertia_kg_m2.named().map(|n| size(n.1));
    let largest = numbers.into_iter().fold(0.0, f64::max);
    let cell = |n: &NumberFile| {
        let share = half_width(n.sigma).map_or(f64::INFINITY, |half| half / largest);
        let class = match (n.is_known(), n.value.is_some()) {
            (true, _) => "known".to_owned(),
            (false, false) => "hatched".to_owned(),
            (false, true) => format!("s{}", SHADES.iter().filter(|s| share < **s).count()),
        };
        context! { class, number => n }
    };
    let [xx, xy, yy, xz, yz, zz] = b.inertia_kg_m2.map(cell);
    let rows = [[&xx, &xy, &xz], [&xy, &yy, &yz], [&xz, &yz, &zz]];
    let rows = ["x", "y", "z"].into_iter().zip(rows);
    rows.map(|(axis, cells)| context! { axis, cells }).collect()
}
