//! Several results of one vehicle side by side.

use super::{ROWS, Shown, asked, points};
use crate::comparison::comparison_document;
use poinsot_figures::{Axis, Figure, Opening, Plot, Tone};
use poinsot_files::{counted, probability};
use poinsot_formats::{ComparisonFile, HALF_WIDTH_95};

pub(super) fn result(c: &ComparisonFile) -> Shown {
    let reliable = c.doubts.is_empty();
    let (tone, word) = match (c.verdict.as_str(), reliable) {
        ("agree", true) => (Tone::Good, "Agree"),
        ("agree", false) => (Tone::Bad, "Agree, not reliable"),
        ("differ", true) => (Tone::Bad, "Differ"),
        ("differ", false) => (Tone::Bad, "Differ, not reliable"),
        _ => (Tone::Fair, "Not comparable"),
    };
    let found = match c.doubts.len() {
        0 => "no evidence against any of them".to_owned(),
        n => format!("{} of evidence against them", counted(n, "item")),
    };
    let same = c.tests.first().map(|all| {
        let found = format!("{}, p = {}", counted(all.dof, "number"), probability(all.p));
        asked("Same vehicle?", c.verdict == "agree", found)
    });
    let document = comparison_document(c);
    let answers = c.answers.iter();
    Shown {
        title: format!("Answers of {} compared", c.model),
        poinsot: c.poinsot.clone(),
        opening: Opening {
            tone,
            word: word.to_owned(),
            sentence: document.verdict.clone(),
            action: c.doubts.first().cloned(),
            lights: [asked("Answers reliable?", reliable, found)]
                .into_iter()
                .chain(same)
                .collect(),
            ..Opening::default()
        },
        beside: changes(c),
        document,
        inputs: answers.map(|a| ("answer", a.path.clone())).collect(),
        ..Shown::default()
    }
}

/// Every difference in units of its sigma.
fn changes(c: &ComparisonFile) -> Option<Figure> {
    let numbers = || c.numbers.iter().take(ROWS);
    let values = numbers().map(|(_, n)| n.difference / n.difference_sigma);
    let edge = HALF_WIDTH_95;
    let plot = Plot {
        title: "last answer minus the first".to_owned(),
        x: Axis::new("number", ""),
        y: Axis::new("difference", "sigma"),
        names: numbers().map(|(name, _)| name.clone()).collect(),
        from_zero: true,
        series: vec![points("difference", 0, values)?],
        levels: vec![
            (edge, "95 % if unchanged".to_owned()),
            (-edge, String::new()),
        ],
        half: true,
        ..Plot::default()
    };
    Some(Figure::plot("differences", plot))
}
