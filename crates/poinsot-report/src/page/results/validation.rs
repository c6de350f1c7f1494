//! Page of a validation.

use super::curves::differences;
use super::{Shown, asked, ratio_figure};
use crate::templates::TEMPLATES;
use crate::validation::validation_document;
use minijinja::context;
use poinsot_figures::{Figure, Opening, Picture};
use poinsot_files::significant;
use poinsot_formats::ValidationFile;
use std::path::Path;

pub(super) fn result(v: &ValidationFile, folder: &Path) -> Result<Shown, String> {
    let document = validation_document(v);
    let word = match v.verdict.as_str() {
        "compared" => "Compared",
        "agrees" => "Agrees",
        "undetermined" => "Not determined",
        _ => "Differs",
    };
    let sigmas = || {
        v.compared
            .iter()
            .filter_map(|c| Some((c, c.sigmas.as_ref()?)))
    };
    let largest = sigmas().max_by(|a, b| a.1.rms.total_cmp(&b.1.rms));
    let sentence = context! { verdict => v.verdict, rms => largest.map(|l| l.1.rms) };
    let within = largest.map(|(c, s)| {
        let found = format!("{}: rms {} sigma", c.quantity, significant(s.rms, 3));
        asked("Within the declared noise?", v.verdict == "agrees", found)
    });
    let reliable = v.estimate.as_ref().map(|e| {
        asked(
            "Estimate reliable?",
            e.covariance_trustworthy,
            e.status.clone(),
        )
    });
    let action = match v.verdict.as_str() {
        "differs" => {
            Some("Identify this record too, and compare both answers with poinsot compare.")
        }
        "undetermined" => Some(
            "Add telemetry that determines the numbers on which the motion depends, or give them as known.",
        ),
        _ => None,
    };
    let figures = differences(&folder.join("histories.csv"), v)?;
    let estimate = v.estimate.iter().map(|e| ("estimate", e.path.clone()));
    let case = v.case.iter().map(|c| ("case", c.clone()));
    let own = [("model", v.model.clone()), ("against", v.against.clone())];
    Ok(Shown {
        title: format!("Validation of {}", v.model),
        poinsot: v.poinsot.clone(),
        opening: Opening {
            tone: document.tone,
            word: word.to_owned(),
            sentence: TEMPLATES.lines("differences.txt", sentence).concat(),
            action: action.map(str::to_owned),
            lights: within.into_iter().chain(reliable).collect(),
            ..Opening::default()
        },
        beside: in_sigmas(v),
        document,
        curves: ("Differences", figures),
        inputs: own.into_iter().chain(estimate).chain(case).collect(),
        ..Shown::default()
    })
}

/// The differences of every sensor, in units of its declared noise.
fn in_sigmas(v: &ValidationFile) -> Option<Figure> {
    let all = v.compared.iter();
    let rows = all.filter_map(|c| Some((c.quantity.as_str(), vec![c.sigmas.as_ref()?.rms])));
    let mut figure = ratio_figure(&["difference"], rows)?;
    if let Picture::Plot(plot) = &mut figure.picture {
        plot.title = "difference over declared noise, rms".to_owned();
        plot.x.label = "sensor".to_owned();
        plot.levels = vec![(1.0, "declared".to_owned())];
    }
    Some(figure)
}
