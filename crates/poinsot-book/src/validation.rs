//! Generates the page of validation: tables from `validation` and from answers to the shipped data.

use crate::commands::GENERATED;
use crate::error::BookError;
use crate::results::{Compared, EXAMPLES, Example, compare};
use crate::trees;
use std::fmt::Write;

/// Half the width of a 95 % interval in sigmas.
const NINETY_FIVE: f64 = 1.959_964;

/// The page `validation.md`.
///
/// # Errors
/// A fixture is missing, or an example fails.
pub fn page() -> Result<String, BookError> {
    let mut out = "# Validation\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(
        "Every number on this page is computed from the files of the repository when the page is made, and a test \
         compares the page with the program. Campaigns of many trials, which take longer, stand on the pages of the \
         methods and in the [README](../README.md).\n",
    );
    momentum(&mut out)?;
    examples(&mut out)?;
    Ok(out)
}

fn momentum(out: &mut String) -> Result<(), BookError> {
    let w = trees::worst()?;
    let _ = write!(
        out,
        "\n## Momentum against two engines\n\n\
         {} random trees with {} bodies, revolute, prismatic and fixed joints, some bodies without mass; momentum from \
         Pinocchio and MuJoCo is recorded in `validation/trees`. Largest difference, relative to the sum of the magnitudes \
         of the terms:\n\n\
         | | linear momentum | angular momentum |\n|---|---|---|\n\
         | Pinocchio, about the base origin | {} | {} |\n\
         | MuJoCo, about the mass centre | {} | {} |\n",
        w.trees,
        w.bodies,
        below(w.pinocchio[0]),
        below(w.pinocchio[1]),
        below(w.mujoco[0]),
        below(w.mujoco[1]),
    );
    Ok(())
}

/// Round-off differs between processors, so only its power of ten is given, rounded up.
fn below(x: f64) -> String {
    format!("below 1e{}", x.max(1.0e-300).log10().ceil())
}

fn examples(out: &mut String) -> Result<(), BookError> {
    out.push_str(
        "\n## The shipped records against the truth of their simulation\n\n\
         Worst error of the numbers that are determined: mass as a share of the mass, mass centre in mm, inertia as a \
         share of the body's largest moment. *Within* counts the 95 % intervals that hold the truth; errors of one record are \
         correlated, so this is no coverage. Noise-free records are answered by the closed form, whose error is round-off; \
         their intervals are those of the declared noise.\n\n\
         | record | status | rank | numbers determined | mass | mass centre, mm | inertia | within |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for example in EXAMPLES {
        let _ = writeln!(out, "{}", row(&example)?);
    }
    Ok(())
}

fn row(example: &Example) -> Result<String, BookError> {
    let answer = example.answer()?;
    let truth = example.truth()?;
    let all = compare(&answer, &truth);
    let i = &answer.identifiability;
    let within = all
        .iter()
        .filter(|c| c.sigma > 0.0 && (c.value - c.truth).abs() <= NINETY_FIVE * c.sigma);
    Ok(format!(
        "| {} | {} | {} of {} | {} | {} | {} | {} | {} of {} |",
        example.name,
        answer.status.replace('_', " "),
        i.rank,
        i.parameters,
        all.len(),
        worst(&all, 0, 1.0),
        worst(&all, 1, 1000.0),
        worst(&all, 2, 1.0),
        within.count(),
        all.len(),
    ))
}

/// Largest error of one kind; relative for mass and inertia.
fn worst(all: &[Compared], kind: usize, factor: f64) -> String {
    let of_kind = all.iter().filter(|c| c.kind == kind);
    let largest = of_kind.clone().map(|c| c.truth.abs()).fold(0.0, f64::max);
    let scale = if kind == 1 { 1.0 } else { largest };
    let errors = of_kind.map(|c| factor * (c.value - c.truth).abs() / scale);
    match errors.reduce(f64::max) {
        None => "-".to_owned(),
        Some(x) if x < 1.0e-7 => "below 1e-7".to_owned(),
        Some(x) => format!("{x:.1e}"),
    }
}
