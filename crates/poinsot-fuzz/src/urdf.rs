//! Bytes as a URDF file.

use crate::model::check_model;
use poinsot_model::{BodyProperties, Measured, parse_urdf, patch_urdf};

/// Bytes as a URDF file. An accepted file must give a valid model, and its mass properties can be written back.
pub fn urdf(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let read = parse_urdf(text, "robot.urdf");
    let model = match read.model {
        Ok(model) => model,
        Err(error) => {
            assert!(
                !error.to_string().trim().is_empty(),
                "an error without words"
            );
            return;
        }
    };
    check_model(&model);
    let links: Vec<BodyProperties> = model
        .bodies
        .iter()
        .filter(|body| body.nominal.mass > 0.0)
        .map(|body| BodyProperties {
            body: body.name.clone(),
            properties: body.nominal,
        })
        .collect();
    let links = Measured {
        bodies: links,
        ..Measured::default()
    };
    let patched = patch_urdf(text, &links);
    assert!(
        patched.is_ok(),
        "a file that was read is not XML: {patched:?}"
    );
    let Ok(exported) = patched else {
        return;
    };
    let again = parse_urdf(&exported.text, "exported.urdf").model;
    let bodies = again.as_ref().map(|m| m.bodies.len());
    assert_eq!(bodies.ok(), Some(model.bodies.len()), "{}", exported.text);
}
