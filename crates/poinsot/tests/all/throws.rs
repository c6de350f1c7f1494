//! Inertia of objects from throws by hand, after Blaha et al. (arXiv:2503.13137): calibrate on two groups of throws, then
//! identify two more. `data/tudelft_throw/README.md` describes the methods and quotes the tables.
//!
//! Symbols: `b` the measuring box, `o` an object, `c` both bolted together; `J` the wheel's spin inertia.

mod chain;
mod device;
pub mod likelihood;
pub mod linear;
mod low_pass;
mod recording;
mod truth;

pub use chain::{Found, Object};

use poinsot_model::{Model, parse_model};
use recording::{Recording, read_logs, read_recording};
use std::path::Path;
use truth::{Truth, read_truth};

/// A throw may determine nothing.
pub type Fault = Box<dyn std::error::Error>;

/// The model file of the box.
const MODEL: &str = include_str!("../../../../data/tudelft_throw/model.toml");
/// Cut-off of the low-pass filter, Hz.
const CUT_OFF_HZ: f64 = 40.0;
/// Samples up to this time after the start of the wheel are dropped, s.
const START_S: f64 = 0.074;
/// Samples of 4 kHz of which one is made.
const TOGETHER: usize = 4;

/// The throws of each group.
pub struct Throws {
    pub model: Model,
    truth: Truth,
    groups: Vec<(String, Vec<Recording>)>,
}

impl Throws {
    /// Reads a folder: filtered samples, or averages of raw ones.
    pub fn read(folder: &Path, filtered: bool) -> Self {
        let model = parse_model(MODEL, "model.toml").unwrap();
        let mut groups: Vec<(String, Vec<Recording>)> = Vec::new();
        for log in read_logs(folder) {
            let throw = read_recording(folder, &model, &log, filtered);
            match groups.iter_mut().find(|(name, _)| *name == log.group) {
                Some((_, own)) => own.push(throw),
                None => groups.push((log.group, vec![throw])),
            }
        }
        Self {
            model,
            truth: read_truth(folder),
            groups,
        }
    }

    fn group(&self, name: &str) -> &[Recording] {
        let own = self.groups.iter().find(|(group, _)| group == name);
        own.map_or(&[], |(_, throws)| throws)
    }
}
