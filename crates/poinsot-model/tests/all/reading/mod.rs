//! Limits, order, notes, round trips, the schema and the shipped examples.

mod bodies;
mod description;
mod findings;
mod formats;
mod keys;
mod schema;

use poinsot_model::{Model, parse_model};
use std::path::PathBuf;

const HEAD: &str = "schema = \"poinsot.model/1\"\n";

fn body(name: &str, mass: f64) -> String {
    let inertia = if mass > 0.0 {
        "com_m = [0.0, 0.0, 0.1]\ninertia_kg_m2 = { xx = 0.3, yy = 0.4, zz = 0.5 }\n"
    } else {
        ""
    };
    format!("[[body]]\nname = \"{name}\"\nmass_kg = {mass:?}\n{inertia}")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\ntype = \"{kind}\"\nparent = \"{parent}\"\nchild = \"{child}\"\norigin_m = [0.0, 0.0, 1.0]\n{}",
        if kind == "fixed" {
            ""
        } else {
            "axis = [0.0, 1.0, 0.0]\n"
        }
    )
}

fn accepted(text: &str) -> Model {
    parse_model(text, "m.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    match parse_model(text, "m.toml") {
        Ok(_) => panic!("accepted"),
        Err(error) => error.to_string(),
    }
}

fn shipped() -> Vec<PathBuf> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data");
    [
        "stsat3/model.toml",
        "ma2008/model.toml",
        "ma2008/model_noisy.toml",
        "xu2017/model.toml",
    ]
    .iter()
    .map(|name| root.join(name))
    .collect()
}
