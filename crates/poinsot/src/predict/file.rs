//! The machine-readable prediction, `poinsot.prediction/3`.

use super::Prediction;
use crate::estimate_file::{covariance, identifiability, known_numbers, reference};
use poinsot_formats::{MassFile, PREDICTION, PredictedNumberFile, PredictionFile, address, finite};
use poinsot_identify::{BodyEstimate, Number};
use poinsot_report::prediction_sentence;

/// The prediction as a file: sigma and source of every number; null if not identifiable.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::predict::{predict_case, prediction_file};
///
/// let file = prediction_file(&predict_case(&case, model, 1.0)?);
/// assert!(file.bodies["bus"].inertia_kg_m2.zz.sigma.is_some_and(|sigma| sigma > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prediction_file(prediction: &Prediction) -> PredictionFile {
    let bound = &prediction.bound;
    let bodies = bound.bodies.iter().filter(|b| b.asked);
    let nuisance = bound.nuisance.iter();
    let mut file = PredictionFile {
        schema: PREDICTION.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        case: prediction.case.clone(),
        model: prediction.model.name.clone(),
        reference: reference(&prediction.model),
        duration_s: prediction.duration_s,
        status: bound.status.name().to_owned(),
        in_words: String::new(),
        wants: prediction.wants.clone(),
        bodies: bodies.map(|b| (b.name.clone(), body(b))).collect(),
        system: bound
            .system
            .as_ref()
            .filter(|_| bound.bodies.len() > 1)
            .map(|(whole, _)| body(whole)),
        nuisance: nuisance
            .map(|n| (address(&n.name, n.unit), number(&n.number)))
            .collect(),
        covariance: covariance(bound),
        identifiability: identifiability(&bound.identifiability),
        known_numbers: Some(known_numbers(bound)),
        assumptions: prediction.assumptions.clone(),
        peaks: prediction.peaks.clone(),
        against_duration: prediction.against_duration.clone(),
    };
    file.in_words = prediction_sentence(&file);
    file
}

fn body(b: &BodyEstimate) -> MassFile<PredictedNumberFile> {
    MassFile::of(b.numbers().each_ref().map(number))
}

fn number(n: &Number) -> PredictedNumberFile {
    PredictedNumberFile {
        nominal: n.nominal,
        sigma: n.sigma.and_then(finite),
        source: n.source.name().map(str::to_owned),
    }
}
