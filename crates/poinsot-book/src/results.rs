//! Answers to the shipped data, with the true values.

use crate::error::BookError;
use crate::repository::root;
use poinsot::{IdentifyRequest, estimate_file, identify};
use poinsot_formats::{EstimateFile, TruthFile, read_truth};

/// One shipped record, or several records of one vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Example {
    /// Name in tables.
    pub name: &'static str,
    /// Model, from `data`.
    pub model: &'static str,
    /// Telemetry of every segment, from `data`.
    pub telemetry: &'static [&'static str],
    /// Method.
    pub method: &'static str,
}

/// The records of the validation page.
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
    /// The example of this name; the first if there is none.
    pub fn named(name: &str) -> Self {
        let found = EXAMPLES.iter().find(|e| e.name == name);
        *found.unwrap_or(&EXAMPLES[0])
    }

    /// The answer as `estimate.json`.
    ///
    /// # Errors
    /// The identification fails.
    pub fn answer(&self) -> Result<EstimateFile, BookError> {
        let shipped = root().join("data");
        let identified = identify(
            &IdentifyRequest::new(
                shipped.join(self.model),
                self.telemetry.iter().map(|t| shipped.join(t)),
            )
            .by(self.method),
        )
        .map_err(|source| BookError::Example {
            example: self.name.to_owned(),
            source: Box::new(source),
        })?;
        Ok(estimate_file(&identified))
    }

    /// `truth.json` next to the first record.
    ///
    /// # Errors
    /// The file is missing or invalid.
    pub fn truth(&self) -> Result<TruthFile, BookError> {
        let first = self.telemetry.first().copied().unwrap_or_default();
        let path = root().join("data").join(first).with_file_name("truth.json");
        read_truth(&path).map_err(|e| BookError::io(&path)(std::io::Error::other(e)))
    }
}

/// One number of an answer with its sigma and true value.
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

/// All determined numbers of an answer, with the true values.
pub fn compare(answer: &EstimateFile, truth: &TruthFile) -> Vec<Compared> {
    let mut out = Vec::new();
    for (name, body) in &answer.bodies {
        let Some(true_body) = truth.bodies.get(name) else {
            continue;
        };
        let mass = &true_body.mass;
        let centre = mass.com_m.named().map(|(_, n)| n);
        let inertia = mass.inertia_kg_m2.named().map(|(_, n)| n);
        let truths = std::iter::once(&mass.mass_kg).chain(centre).chain(inertia);
        for (k, ((_, _, n), truth)) in body.numbers().into_iter().zip(truths).enumerate() {
            let estimated = n.source.is_some() && !n.is_known();
            if let (true, Some(value), Some(sigma)) = (estimated, n.value, n.sigma) {
                out.push(Compared {
                    kind: usize::from(k > 0) + usize::from(k > 3),
                    value,
                    sigma,
                    truth: truth.value,
                });
            }
        }
    }
    out
}
