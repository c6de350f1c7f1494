//! Every method and variant on every kind of vehicle: an answer with a verdict, or an error with an explained code.

use poinsot::explain::explain;
use poinsot::methods::methods;
use poinsot::{IdentifyRequest, identify};
use std::path::Path;

/// Model and one record: a body with wheels, an arm of known mass, an arm under thrust.
const VEHICLES: [(&str, &str); 3] = [
    ("stsat3/model.toml", "stsat3/multiaxis/telemetry.parquet"),
    ("ma2008/model.toml", "ma2008/traj1/telemetry.parquet"),
    ("xu2017/model.toml", "xu2017/C1/telemetry.parquet"),
];
/// Row step: only the existence of an answer is tested, not its quality.
const EVERY: usize = 8;

#[test]
fn prop_every_published_variant_answers_or_is_refused_with_a_code() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let mut answered = Vec::new();
    for method in methods().iter().filter(|m| m.paper.is_some()) {
        for variant in &method.variants {
            for (model, record) in VEHICLES {
                let mut request = IdentifyRequest::new(shipped.join(model), [shipped.join(record)]);
                request.reading.every = EVERY;
                request.question.method = method.name.to_owned();
                request.question.variant = Some(variant.name.to_owned());
                let label = format!("{} {} on {model}", method.name, variant.name);
                match identify(&request) {
                    Ok(found) => {
                        assert_eq!(found.estimate.method, method.name, "{label}");
                        assert_eq!(found.estimate.variant.as_deref(), Some(variant.name));
                        answered.push((method.name, variant.name));
                    }
                    Err(error) => {
                        let text = error.to_string();
                        let code = text.get(..5).unwrap();
                        assert!(explain(code).is_some(), "{label}: {text}");
                        assert_eq!(error.kind(), poinsot::ErrorKind::Input, "{label}: {text}");
                    }
                }
            }
        }
    }
    // Each method must work for the vehicle of its own paper.
    for method in methods().iter().filter(|m| m.paper.is_some()) {
        assert!(
            answered.iter().any(|a| a.0 == method.name),
            "{}",
            method.name
        );
    }
}
