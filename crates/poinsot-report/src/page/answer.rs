//! First screen: status, one sentence, one action, the tensor, three lights, and the numbers to copy.

use super::Answer;
use super::export::exports;
use super::lights::lights;
use super::numbers::{brief, half_width, plus_minus, value};
use crate::summary::{action, sentence};
use crate::verdict::Standing;
use minijinja::{Value, context};
use poinsot_figures::{Opening, PageError, Part, island, render};
use poinsot_formats::{BodyFile, NumberFile};

/// Half widths of 95 % intervals, relative to the largest inertia, at which the shade becomes lighter.
const SHADES: [f64; 4] = [1.0e-4, 1.0e-3, 1.0e-2, 1.0e-1];

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let (tone, word) = Standing::of(e).display();
    let shown = shown(answer);
    let bodies: Vec<Value> = shown
        .iter()
        .map(|(name, b)| context! { name, rows => matrix(b, e.is_withheld()), beside => beside(b, e.is_withheld()) })
        .collect();
    let beside = render(
        "answer.html",
        include_str!("templates/answer.html"),
        context! { bodies, exports => island(&exports(e))?.value() },
    )?;
    Opening {
        tone,
        word: word.to_owned(),
        sentence: sentence(e).replace("m2", "m\u{b2}"),
        action: action(e),
        lights: lights(answer),
        beside,
    }
    .part()
}

/// Requested bodies and the whole vehicle; the one with most determined tensor elements is first.
fn shown(answer: &Answer) -> Vec<(&str, &BodyFile)> {
    let e = &answer.estimate;
    let asked = e.bodies.iter().filter(|b| b.1.is_asked());
    let mut all: Vec<(&str, &BodyFile)> = asked.map(|(name, b)| (name.as_str(), b)).collect();
    if let (Some(whole), true) = (e.system.first(), e.bodies.len() > 1) {
        all.push(("whole vehicle, joints as at the first sample", &whole.body));
    }
    let determined = |b: &BodyFile| {
        let entries = b.inertia_kg_m2.named();
        entries.iter().filter(|n| n.1.value.is_some()).count()
    };
    all.sort_by_key(|(_, b)| std::cmp::Reverse(determined(b)));
    all
}

/// Three rows of the tensor.
fn matrix(b: &BodyFile, withheld: bool) -> Vec<Value> {
    let numbers = b.inertia_kg_m2.named().map(|n| n.1);
    let size = |n: &&NumberFile| n.value.unwrap_or(n.nominal).abs();
    let largest = numbers.iter().map(size).fold(0.0, f64::max);
    // Index of each entry among xx, yy, zz, xy, xz, yz.
    [("x", [0, 3, 4]), ("y", [3, 1, 5]), ("z", [4, 5, 2])]
        .map(|(axis, row)| {
            let cells: Vec<Value> = row
                .iter()
                .map(|k| cell(numbers[*k], largest, withheld))
                .collect();
            context! { axis, cells }
        })
        .to_vec()
}

fn cell(n: &NumberFile, largest: f64, withheld: bool) -> Value {
    let class = match (n.is_known(), n.value.is_some()) {
        (true, _) => "known".to_owned(),
        (false, false) => "hatched".to_owned(),
        (false, true) => {
            let share = half_width(n.sigma).map_or(f64::INFINITY, |half| half / largest);
            format!("s{}", SHADES.iter().filter(|limit| share < **limit).count())
        }
    };
    context! {
        class,
        text => text(n, withheld),
        half => if n.is_known() { "known".to_owned() } else { plus_minus(n.sigma) },
    }
}

fn text(n: &NumberFile, withheld: bool) -> String {
    match (n.is_known(), n.value, withheld) {
        (true, ..) => brief(n.nominal),
        (_, None, true) => "withheld".to_owned(),
        _ => value(n.value, n.sigma),
    }
}

/// Mass and mass centre.
fn beside(b: &BodyFile, withheld: bool) -> Vec<Value> {
    let said = |n: &NumberFile| {
        let half = if n.is_known() {
            "known".to_owned()
        } else {
            plus_minus(n.sigma)
        };
        format!("{} {half}", text(n, withheld))
            .trim_end()
            .to_owned()
    };
    let centre = [0, 1, 2].map(|k| b.com_m.number(k));
    let centre = if centre.iter().all(NumberFile::is_known) {
        let all = centre.each_ref().map(|n| brief(n.nominal));
        format!("({}) known", all.join(", "))
    } else if centre.iter().all(|n| n.value.is_none()) {
        said(&centre[0])
    } else {
        centre.each_ref().map(said).join(", ")
    };
    vec![
        context! { name => "mass, kg", text => said(&b.mass_kg) },
        context! { name => "mass centre x, y, z, m", text => centre },
    ]
}
