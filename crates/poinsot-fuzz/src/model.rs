//! Bytes as a model file.

use poinsot_dynamics::Tree;
use poinsot_model::{Model, describe, parse_model, write_model};

/// Bytes as a model file. An accepted file must survive writing and reading.
pub fn model(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match parse_model(text, "model.toml") {
        Ok(model) => check_model(&model),
        Err(error) => assert!(
            !error.to_string().trim().is_empty(),
            "an error without words"
        ),
    }
}

/// Invariants of every accepted model.
pub(crate) fn check_model(model: &Model) {
    let tree = Tree::new(model);
    assert_eq!(tree.bodies(), model.bodies.len());
    let _ = describe(model);
    let written = write_model(model);
    match parse_model(&written, "written.toml") {
        Ok(back) => {
            assert_eq!(back.bodies, model.bodies, "{written}");
            assert_eq!(back.joints, model.joints, "{written}");
            assert_eq!(back.wheels, model.wheels, "{written}");
            assert_eq!(back.thrusters, model.thrusters, "{written}");
            assert_eq!(back.modes, model.modes, "{written}");
            assert_eq!(back.sensors.len(), model.sensors.len(), "{written}");
        }
        Err(error) => assert_eq!(
            error.to_string(),
            "",
            "what was written is not read:\n{written}"
        ),
    }
}
