//! The page of validation: answers to the shipped data, compared with the truth of their simulation.

use crate::{Fault, read, repository};
use minijinja::{Value, context};
use poinsot::{IdentifyRequest, estimate_file, identify};
use poinsot_formats::{EstimateFile, TruthFile, read_truth};
use serde::Deserialize;

/// Half the width of a 95 % interval in sigmas.
const NINETY_FIVE: f64 = 1.959_964;

#[derive(Deserialize)]
struct Records {
    record: Vec<Record>,
}

/// One shipped record, or several records of one vehicle; model and records are named from `data`.
#[derive(Deserialize)]
struct Record {
    name: String,
    model: String,
    folders: Vec<String>,
    /// Otherwise noise-free, answered by the closed form.
    noisy: bool,
}

impl Record {
    fn answer(&self) -> Result<EstimateFile, Fault> {
        let data = repository("data");
        let file = match self.noisy {
            true => "telemetry_noisy.csv",
            false => "telemetry.parquet",
        };
        let records = self.folders.iter().map(|f| data.join(f).join(file));
        let method = if self.noisy { "auto" } else { "linear" };
        let request = IdentifyRequest::new(data.join(&self.model), records).by(method);
        Ok(estimate_file(&identify(&request)?))
    }

    /// The truth next to the first record.
    fn truth(&self) -> Result<TruthFile, Fault> {
        let folder = repository("data").join(&self.folders[0]);
        Ok(read_truth(&folder.join("truth.json"))?)
    }
}

/// The context of `validation.md`.
pub fn validation() -> Result<Value, Fault> {
    let records: Records = toml::from_str(&read("crates/poinsot-book/records.toml")?)?;
    let rows = records
        .record
        .iter()
        .map(row)
        .collect::<Result<Vec<_>, _>>()?;
    Ok(context! { rows })
}

/// One determined number of an answer with its sigma and true value.
struct Compared {
    unit: &'static str,
    value: f64,
    sigma: f64,
    truth: f64,
}

fn row(record: &Record) -> Result<Value, Fault> {
    let answer = record.answer()?;
    let all = compare(&answer, &record.truth()?);
    let i = &answer.identifiability;
    let holds = |c: &&Compared| c.sigma > 0.0 && (c.value - c.truth).abs() <= NINETY_FIVE * c.sigma;
    Ok(context! {
        record => record.name,
        status => answer.status.replace('_', " "),
        rank => i.rank,
        parameters => i.parameters,
        numbers => all.len(),
        mass => worst(&all, "kg"),
        centre => worst(&all, "m"),
        inertia => worst(&all, "kg m²"),
        within => all.iter().filter(holds).count(),
    })
}

/// All determined numbers of an answer, with the true values.
fn compare(answer: &EstimateFile, truth: &TruthFile) -> Vec<Compared> {
    let mut out = Vec::new();
    for (name, body) in &answer.bodies {
        let Some(true_body) = truth.bodies.get(name) else {
            continue;
        };
        let truths = true_body.mass.numbers();
        for ((_, unit, n), (.., truth)) in body.numbers().into_iter().zip(truths) {
            let estimated = n.source.is_some() && !n.is_known();
            if let (true, Some(value), Some(sigma)) = (estimated, n.value, n.sigma) {
                out.push(Compared {
                    unit,
                    value,
                    sigma,
                    truth: truth.value,
                });
            }
        }
    }
    out
}

/// Largest error of the numbers with a unit: in mm for the mass centre, relative for mass and inertia.
fn worst(all: &[Compared], unit: &str) -> String {
    let of_kind = all.iter().filter(|c| c.unit == unit);
    let scale = match unit {
        "m" => 1.0e-3,
        _ => of_kind.clone().map(|c| c.truth.abs()).fold(0.0, f64::max),
    };
    let errors = of_kind.map(|c| (c.value - c.truth).abs() / scale);
    match errors.reduce(f64::max) {
        None => "-".to_owned(),
        Some(x) if x < 1.0e-7 => "below 1e-7".to_owned(),
        Some(x) => format!("{x:.1e}"),
    }
}
