//! Section 4: what these data can tell and what they cannot.

use super::Answer;
use super::numbers::{plus_minus, value};
use minijinja::{Value, context};
use poinsot_report::{Axis, Figure, Mark, PageError, Part, Plot, Series, render};

/// Determined combinations listed; the result file has all.
const LISTED: usize = 80;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let i = &answer.estimate.identifiability;
    let determined: Vec<Value> = i
        .identifiable
        .iter()
        .take(LISTED)
        .map(|c| {
            context! { text => c.combination, value => value(c.value, c.sigma), half => plus_minus(c.sigma), unit => c.unit.replace("m2", "m²") }
        })
        .collect();
    // One reason often holds for several directions: said once.
    let mut groups: Vec<(&str, &str, Vec<&str>)> = Vec::new();
    for open in &i.not_identifiable {
        match groups.last_mut() {
            Some(g) if g.0 == open.reason && g.1 == open.remedy => g.2.push(&open.combination),
            _ => groups.push((&open.reason, &open.remedy, vec![&open.combination])),
        }
    }
    let open: Vec<Value> = groups
        .iter()
        .map(|(reason, remedy, texts)| context! { reason, remedy, texts })
        .collect();
    let spectrum = Figure::plot("identifiable_spectrum", spectrum(answer));
    let body = render(
        "identifiability.html",
        include_str!("templates/identifiability.html"),
        context! {
            withheld => answer.estimate.is_withheld(),
            spectrum => spectrum.html()?.value(),
            rank => i.rank,
            structural_rank => i.structural_rank,
            parameters => i.parameters,
            open,
            determined,
            more => i.identifiable.len().saturating_sub(LISTED),
        },
    )?;
    Ok(Part {
        id: "identifiable",
        title: "What is identifiable",
        body,
        figures: vec![spectrum],
    })
}

fn spectrum(answer: &Answer) -> Plot {
    let i = &answer.estimate.identifiability;
    let sigmas: Vec<f64> = i
        .sigmas_natural
        .iter()
        .map(|s| s.unwrap_or(f64::NAN))
        .collect();
    let order: Vec<f64> = (1..=sigmas.len()).map(|k| k as f64).collect();
    let keep = |wanted: bool| -> Vec<f64> {
        sigmas
            .iter()
            .enumerate()
            .map(|(k, s)| if (k < i.rank) == wanted { *s } else { f64::NAN })
            .collect()
    };
    // Of a model that the data contradict nothing is determined.
    let (word, colour) = match answer.estimate.is_withheld() {
        true => ("identifiable only if the model were right", 1),
        false => ("identifiable", 2),
    };
    let mut series = vec![Series::new(word, Mark::Bars, colour, &order, &keep(true))];
    if i.rank < sigmas.len() {
        series.push(Series::new(
            "not identifiable",
            Mark::Bars,
            1,
            &order,
            &keep(false),
        ));
    }
    // The limit is the default unless the count says that another was asked for.
    let below = sigmas.iter().filter(|s| **s < 1.0).count();
    let levels = if below == i.rank {
        vec![(1.0, "as uncertain as the vehicle's own scale".to_owned())]
    } else {
        Vec::new()
    };
    let unbounded = sigmas.iter().filter(|s| !s.is_finite()).count();
    Plot {
        title: "spectrum: one sigma of each independent direction".to_owned(),
        x: Axis::new("direction, best first", ""),
        y: Axis::new("one sigma / natural scale", ""),
        log: true,
        whole: true,
        series,
        levels,
        height: 260.0,
        note: if unbounded > 0 {
            format!("{unbounded} more directions have no bound at all and are not drawn.")
        } else {
            "Natural scale: m, m L and m L² of each body, L its radius of gyration.".to_owned()
        },
        ..Plot::default()
    }
}
