//! Several results of one vehicle side by side.

use super::{ROWS, Shown, answer, light};
use crate::comparison::comparison_document;
use poinsot_figures::{Axis, Figure, Mark, Opening, Plot, Series, Tone};
use poinsot_files::probability;
use poinsot_formats::{ComparisonFile, HALF_WIDTH_95};

pub(super) fn result(c: &ComparisonFile) -> Shown {
    let (tone, word) = match (c.verdict.as_str(), c.doubts.is_empty()) {
        ("agree", true) => (Tone::Good, "Agree"),
        ("agree", false) => (Tone::Bad, "Agree, not reliable"),
        ("differ", true) => (Tone::Bad, "Differ"),
        ("differ", false) => (Tone::Bad, "Differ, not reliable"),
        _ => (Tone::Fair, "Not comparable"),
    };
    let document = comparison_document(c);
    let (reliable, yes) = answer(c.doubts.is_empty());
    let found = match c.doubts.len() {
        0 => "no evidence against any of them".to_owned(),
        n => format!("{n} items of evidence against them"),
    };
    let mut lights = vec![light("Answers reliable?", reliable, yes, found)];
    if let Some(all) = c.tests.first() {
        let found = format!("{} numbers, p = {}", all.dof, probability(all.p));
        let (tone, yes) = answer(c.verdict == "agree");
        lights.push(light("Same vehicle?", tone, yes, found));
    }
    Shown {
        title: format!("Answers of {} compared", c.model),
        poinsot: c.poinsot.clone(),
        opening: Opening {
            tone,
            word: word.to_owned(),
            sentence: document.verdict.clone(),
            action: c.doubts.first().cloned(),
            lights,
            ..Opening::default()
        },
        beside: changes(c),
        document,
        curves: ("", Vec::new()),
        open: None,
        several: false,
        inputs: c
            .answers
            .iter()
            .map(|a| ("answer", a.path.clone()))
            .collect(),
    }
}

/// Every difference in units of its sigma.
fn changes(c: &ComparisonFile) -> Option<Figure> {
    let numbers = || c.numbers.iter().take(ROWS);
    let x: Vec<f64> = numbers().zip(1..).map(|(_, k)| f64::from(k)).collect();
    let y: Vec<f64> = numbers()
        .map(|(_, n)| n.difference / n.difference_sigma)
        .collect();
    let edge = HALF_WIDTH_95;
    (!x.is_empty()).then(|| {
        Figure::plot(
            "differences",
            Plot {
                title: "last answer minus the first".to_owned(),
                x: Axis::new("number", ""),
                y: Axis::new("difference", "sigma"),
                names: numbers().map(|(name, _)| name.clone()).collect(),
                from_zero: true,
                series: vec![Series::new("difference", Mark::Points, 0, &x, &y)],
                levels: vec![
                    (edge, "95 % if unchanged".to_owned()),
                    (-edge, String::new()),
                ],
                half: true,
                ..Plot::default()
            },
        )
    })
}
