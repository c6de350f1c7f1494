//! The page of validation: answers to the shipped data, compared with the truth of their simulation.

use crate::{Fault, GENERATED, repository};
use poinsot::{IdentifyRequest, estimate_file, identify};
use poinsot_formats::{EstimateFile, TruthFile, read_truth};
use std::fmt::Write;

/// Half the width of a 95 % interval in sigmas.
const NINETY_FIVE: f64 = 1.959_964;

const TEXT: &str = "\
With this page you can compare the answers to the shipped records with the truth of their simulation. Every number is computed \
from files of the repository, and a test compares the page with the program. Longer studies follow, first [a benchmark](validation/benchmark.md).

## Momentum against two engines

`validation/trees` contains the momentum that Pinocchio and MuJoCo compute for 1000 random trees with 6650 bodies, some without \
mass, and revolute, prismatic and fixed joints. Tests compare it with a sum over the bodies by definition \
(`crates/poinsot-testkit/tests`), and that sum with the kernels (`crates/poinsot-dynamics/tests`), to 1e-12 of the sum of the \
magnitudes of the terms.

## The shipped records against the truth of their simulation

Worst error of the determined numbers: mass relative to the mass, mass centre in mm, inertia relative to the body's largest \
moment. *Within* counts the 95 % intervals that contain the truth; errors of one record are correlated, so this is not a \
coverage. The closed form answers noise-free records, with errors of round-off; their intervals are those of the declared noise.

| record | status | rank | numbers determined | mass | mass centre, mm | inertia | within |
|---|---|---|---|---|---|---|---|
";

/// One shipped record, or several records of one vehicle; model and records are named from `data`.
struct Record {
    name: &'static str,
    model: &'static str,
    folders: &'static [&'static str],
    /// Otherwise noise-free, answered by the closed form.
    noisy: bool,
}

const fn record(
    name: &'static str,
    model: &'static str,
    folders: &'static [&'static str],
    noisy: bool,
) -> Record {
    Record {
        name,
        model,
        folders,
        noisy,
    }
}

const STSAT3: &str = "stsat3/model.toml";
const MA2008: &str = "ma2008/model.toml";
const XU2017: [&str; 7] = [
    "xu2017/C1",
    "xu2017/C2",
    "xu2017/C3",
    "xu2017/C4",
    "xu2017/C5",
    "xu2017/C6",
    "xu2017/C7",
];

const RECORDS: [Record; 9] = [
    record("stsat3, several axes", STSAT3, &["stsat3/multiaxis"], true),
    record(
        "stsat3, several axes, noise-free",
        STSAT3,
        &["stsat3/multiaxis"],
        false,
    ),
    record("stsat3, one axis", STSAT3, &["stsat3/paper"], true),
    record(
        "ma2008, trajectory 1",
        "ma2008/model_noisy.toml",
        &["ma2008/traj1"],
        true,
    ),
    record(
        "ma2008, trajectory 1, noise-free",
        MA2008,
        &["ma2008/traj1"],
        false,
    ),
    record(
        "ma2008, trajectory 1, wrist, noise-free",
        MA2008,
        &["ma2008/traj1_wrist"],
        false,
    ),
    record(
        "ma2008, trajectory 2, noise-free",
        MA2008,
        &["ma2008/traj2"],
        false,
    ),
    record(
        "ma2008, trajectory 2b, noise-free",
        MA2008,
        &["ma2008/traj2b"],
        false,
    ),
    record(
        "xu2017, seven records, noise-free",
        "xu2017/model.toml",
        &XU2017,
        false,
    ),
];

impl Record {
    fn answer(&self) -> Result<EstimateFile, Fault> {
        let data = repository("data");
        let file = match self.noisy {
            true => "telemetry_noisy.csv",
            false => "telemetry.parquet",
        };
        let records = self.folders.iter().map(|f| data.join(f).join(file));
        let method = if self.noisy { "auto" } else { "linear" };
        let request = IdentifyRequest::new(data.join(self.model), records).by(method);
        Ok(estimate_file(&identify(&request)?))
    }

    /// The truth next to the first record.
    fn truth(&self) -> Result<TruthFile, Fault> {
        let folder = repository("data").join(self.folders[0]);
        Ok(read_truth(&folder.join("truth.json"))?)
    }
}

/// The page.
pub fn page() -> Result<String, Fault> {
    let mut out = format!("# Validation\n\n{GENERATED}{TEXT}");
    for record in &RECORDS {
        let _ = writeln!(out, "{}", row(record)?);
    }
    Ok(out)
}

/// What a number is.
#[derive(PartialEq)]
enum Kind {
    Mass,
    Centre,
    Inertia,
}

/// One determined number of an answer with its sigma and true value.
struct Compared {
    kind: Kind,
    value: f64,
    sigma: f64,
    truth: f64,
}

fn row(record: &Record) -> Result<String, Fault> {
    let answer = record.answer()?;
    let all = compare(&answer, &record.truth()?);
    let i = &answer.identifiability;
    let within = all
        .iter()
        .filter(|c| c.sigma > 0.0 && (c.value - c.truth).abs() <= NINETY_FIVE * c.sigma);
    Ok(format!(
        "| {} | {} | {} of {} | {} | {} | {} | {} | {} of {} |",
        record.name,
        answer.status.replace('_', " "),
        i.rank,
        i.parameters,
        all.len(),
        worst(&all, &Kind::Mass),
        worst(&all, &Kind::Centre),
        worst(&all, &Kind::Inertia),
        within.count(),
        all.len(),
    ))
}

/// All determined numbers of an answer, with the true values.
fn compare(answer: &EstimateFile, truth: &TruthFile) -> Vec<Compared> {
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
                    kind: match k {
                        0 => Kind::Mass,
                        1..=3 => Kind::Centre,
                        _ => Kind::Inertia,
                    },
                    value,
                    sigma,
                    truth: truth.value,
                });
            }
        }
    }
    out
}

/// Largest error of one kind: in mm for the mass centre, relative for mass and inertia.
fn worst(all: &[Compared], kind: &Kind) -> String {
    let of_kind = all.iter().filter(|c| c.kind == *kind);
    let scale = match kind {
        Kind::Centre => 1.0e-3,
        _ => of_kind.clone().map(|c| c.truth.abs()).fold(0.0, f64::max),
    };
    let errors = of_kind.map(|c| (c.value - c.truth).abs() / scale);
    match errors.reduce(f64::max) {
        None => "-".to_owned(),
        Some(x) if x < 1.0e-7 => "below 1e-7".to_owned(),
        Some(x) => format!("{x:.1e}"),
    }
}
