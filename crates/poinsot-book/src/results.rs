//! Answers to the shipped examples, and the truth of their simulation.

use crate::error::BookError;
use crate::repository::root;
use poinsot::{IdentifyRequest, estimate_json, identify};
use serde_json::Value;

/// One shipped record, or several of one vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Example {
    /// Name in the tables.
    pub name: &'static str,
    /// Model, from `examples`.
    pub model: &'static str,
    /// Telemetry of every segment, from `examples`.
    pub telemetry: &'static [&'static str],
    /// Method.
    pub method: &'static str,
}

/// The examples of the validation page.
pub const EXAMPLES: [Example; 9] = [
    Example {
        name: "stsat3, several axes",
        model: "stsat3/model.toml",
        telemetry: &["stsat3/multiaxis/telemetry_noisy.csv"],
        method: "auto",
    },
    Example {
        name: "stsat3, several axes, noise-free",
        model: "stsat3/model.toml",
        telemetry: &["stsat3/multiaxis/telemetry.parquet"],
        method: "linear",
    },
    Example {
        name: "stsat3, one axis",
        model: "stsat3/model.toml",
        telemetry: &["stsat3/paper/telemetry_noisy.csv"],
        method: "auto",
    },
    Example {
        name: "ma2008, trajectory 1",
        model: "ma2008/model_noisy.toml",
        telemetry: &["ma2008/traj1/telemetry_noisy.csv"],
        method: "auto",
    },
    Example {
        name: "ma2008, trajectory 1, noise-free",
        model: "ma2008/model.toml",
        telemetry: &["ma2008/traj1/telemetry.parquet"],
        method: "linear",
    },
    Example {
        name: "ma2008, trajectory 1, wrist, noise-free",
        model: "ma2008/model.toml",
        telemetry: &["ma2008/traj1_wrist/telemetry.parquet"],
        method: "linear",
    },
    Example {
        name: "ma2008, trajectory 2, noise-free",
        model: "ma2008/model.toml",
        telemetry: &["ma2008/traj2/telemetry.parquet"],
        method: "linear",
    },
    Example {
        name: "ma2008, trajectory 2b, noise-free",
        model: "ma2008/model.toml",
        telemetry: &["ma2008/traj2b/telemetry.parquet"],
        method: "linear",
    },
    Example {
        name: "xu2017, seven records, noise-free",
        model: "xu2017/model.toml",
        telemetry: &[
            "xu2017/C1/telemetry.parquet",
            "xu2017/C2/telemetry.parquet",
            "xu2017/C3/telemetry.parquet",
            "xu2017/C4/telemetry.parquet",
            "xu2017/C5/telemetry.parquet",
            "xu2017/C6/telemetry.parquet",
            "xu2017/C7/telemetry.parquet",
        ],
        method: "linear",
    },
];

impl Example {
    /// The example of this name; the first where there is none.
    pub fn named(name: &str) -> Self {
        let found = EXAMPLES.iter().find(|e| e.name == name);
        *found.unwrap_or(&EXAMPLES[0])
    }

    /// The answer as `estimate.json` holds it.
    ///
    /// # Errors
    /// The program refuses the question.
    pub fn answer(&self) -> Result<Value, BookError> {
        let examples = root().join("examples");
        let identified = identify(
            &IdentifyRequest::new(
                examples.join(self.model),
                self.telemetry.iter().map(|t| examples.join(t)),
            )
            .by(self.method),
        )
        .map_err(|source| BookError::Example {
            example: self.name.to_owned(),
            source: Box::new(source),
        })?;
        Ok(estimate_json(&identified))
    }

    /// `truth.json` beside the first record.
    ///
    /// # Errors
    /// It is not there or not JSON.
    pub fn truth(&self) -> Result<Value, BookError> {
        let first = self.telemetry.first().copied().unwrap_or_default();
        let path = root()
            .join("examples")
            .join(first)
            .with_file_name("truth.json");
        let bytes = std::fs::read(&path).map_err(BookError::io(&path))?;
        serde_json::from_slice(&bytes).map_err(|e| BookError::io(&path)(e.into()))
    }
}

/// One number of an answer with its sigma and the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// 0 mass, 1 mass centre, 2 inertia.
    pub kind: usize,
    /// Estimate.
    pub value: f64,
    /// One sigma.
    pub sigma: f64,
    /// Truth.
    pub truth: f64,
}

/// All numbers of an answer that the data determine, against the truth.
pub fn compare(answer: &Value, truth: &Value) -> Vec<Compared> {
    let mut out = Vec::new();
    let Some(bodies) = answer["bodies"].as_object() else {
        return out;
    };
    for (name, body) in bodies {
        let true_body = &truth["bodies"][name];
        let scalar = &body["mass_kg"];
        push(
            &mut out,
            0,
            [&scalar["value"], &scalar["sigma"], &scalar["source"]],
            &true_body["mass_kg"]["value"],
        );
        let com = &body["com_m"];
        for k in 0..3 {
            let numbers = [&com["value"][k], &com["sigma"][k], &com["source"][k]];
            push(&mut out, 1, numbers, &true_body["com_m"]["value"][k]);
        }
        let I = &body["inertia_kg_m2"];
        for k in ["xx", "yy", "zz", "xy", "xz", "yz"] {
            let numbers = [&I["value"][k], &I["sigma"][k], &I["source"][k]];
            push(
                &mut out,
                2,
                numbers,
                &true_body["inertia_kg_m2"]["value"][k],
            );
        }
    }
    out
}

fn push(out: &mut Vec<Compared>, kind: usize, [value, sigma, source]: [&Value; 3], truth: &Value) {
    if source != "data" && source != "prior" {
        return;
    }
    if let (Some(value), Some(sigma), Some(truth)) =
        (value.as_f64(), sigma.as_f64(), truth.as_f64())
    {
        out.push(Compared {
            kind,
            value,
            sigma,
            truth,
        });
    }
}
