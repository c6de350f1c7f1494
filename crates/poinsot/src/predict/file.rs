//! The machine-readable prediction, `poinsot.prediction/1`.

use super::Prediction;
use super::text::sentence;
use crate::estimate_file::identifiability;
use crate::estimate_file::inertia_entries;
use poinsot_identify::{BodyEstimate, Number, axis_name};
use serde_json::{Map, Value, json};

/// The prediction as JSON: truth, sigma and source of every number; null where it is not identifiable.
pub fn prediction_json(prediction: &Prediction) -> Value {
    let bound = &prediction.bound;
    let bodies: Map<String, Value> = bound
        .bodies
        .iter()
        .filter(|b| b.asked)
        .map(|b| (b.name.clone(), body(b)))
        .collect();
    let nuisance: Map<String, Value> = bound
        .nuisance
        .iter()
        .map(|n| {
            (
                n.name.clone(),
                json!({ "sigma": n.number.sigma, "unit": n.unit }),
            )
        })
        .collect();
    let found = &bound.identifiability;
    json!({
        "schema": "poinsot.prediction/1",
        "poinsot": env!("CARGO_PKG_VERSION"),
        "case": prediction.case,
        "model": prediction.model.name,
        "duration_s": prediction.duration_s,
        "status": bound.status.name(),
        "in_words": sentence(prediction),
        "wants": prediction.wants.iter().map(|m| json!({
            "name": m.want.name,
            "unit": m.want.unit,
            "wanted_sigma": m.want.sigma,
            "sigma": m.sigma,
            "met": m.is_met(),
        })).collect::<Vec<_>>(),
        "bodies": bodies,
        "nuisance": nuisance,
        "covariance": {
            "names": bound.covariance_names,
            "units": bound.covariance_units,
            "matrix": bound.covariance,
        },
        "identifiability": identifiability(found),
        "assumptions": prediction.assumptions,
    })
}

fn body(b: &BodyEstimate) -> Value {
    let com: Map<String, Value> = (0..3)
        .map(|k| (axis_name(k).to_owned(), number(&b.com[k])))
        .collect();
    let inertia: Map<String, Value> = inertia_entries()
        .map(|(k, name)| (name.to_owned(), number(&b.inertia[k])))
        .collect();
    json!({ "mass_kg": number(&b.mass), "com_m": com, "inertia_kg_m2": inertia })
}

fn number(n: &Number) -> Value {
    json!({ "truth": n.nominal, "sigma": n.sigma, "source": n.source.name() })
}
