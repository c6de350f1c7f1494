//! The functions of this crate for JavaScript: texts as they are, everything else as JSON.

use crate::{Named, check, identify, line_errors};
use poinsot::{Error, Listener, Step, panic_error};
use serde::Serialize;
use std::panic::set_hook;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// Is told every step.
    fn poinsot_step(stage: &str, done: f64, total: f64);
    /// Is told the error of a panic, before the program ends.
    fn poinsot_ends(failure: &str);
}

/// Errors in place of an answer.
#[derive(Serialize)]
struct Failure {
    errors: Vec<crate::LineError>,
}

impl Failure {
    fn of(error: &Error, model: &str) -> Self {
        let errors = line_errors(error, model);
        Self { errors }
    }
}

/// Without a text no page is left to say why.
fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// Runs when the module is loaded.
#[wasm_bindgen(start)]
pub fn start() {
    set_hook(Box::new(|info| {
        poinsot_ends(&json(&Failure::of(&panic_error(info), "")));
    }));
    let told = |step: Step| poinsot_step(&step.stage, step.done as f64, step.total as f64);
    // The module is loaded once.
    let _ = tracing::subscriber::set_global_default(Listener(told));
}

/// The errors of a model, or the vehicle: [`Checked`](crate::Checked).
#[wasm_bindgen]
pub fn check_model(name: String, content: String) -> String {
    json(&check(&Named { name, content }))
}

/// Telemetry files in the order in which they are added.
#[wasm_bindgen]
#[derive(Default)]
pub struct Telemetry(Vec<Named<Vec<u8>>>);

#[wasm_bindgen]
impl Telemetry {
    /// No file.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file.
    pub fn add(&mut self, name: String, content: Vec<u8>) {
        self.0.push(Named { name, content });
    }
}

/// The [`Answer`](crate::Answer), or errors.
#[wasm_bindgen]
pub fn identify_model(
    name: String,
    content: String,
    telemetry: Telemetry,
    together: bool,
) -> String {
    let model = Named { name, content };
    match identify(&model, telemetry.0, together) {
        Ok(answer) => json(&answer),
        Err(error) => json(&Failure::of(&error, &model.name)),
    }
}
