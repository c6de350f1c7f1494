//! The paper's figures, the claims of its Sec. II to V, its bounds, and both options compared with the methods of this
//! project.

mod bounds;
mod cases;
mod cramer_rao;
pub mod experiment;
mod histories;
mod linear;
mod reach;

use crate::study::statistics::{largest, rms};
use crate::study::{Context, Digits, Findings, Study, StudyError};

/// The studies.
pub const STUDIES: &[Study] = &[
    Study::quick(
        "exact",
        "both options on exact data, the increments as printed beside them",
        |c| cases::study(c, "exact"),
    ),
    Study::quick(
        "histories",
        "Fig. 9 to 12: velocities along both trajectories",
        histories::run,
    ),
    Study::quick(
        "mass-ratio",
        "Fig. 8: errors against the mass ratio",
        mass_ratio,
    ),
    Study::quick("noise", "Fig. 13 and 14: errors against noise", |c| {
        cases::study(c, "noise")
    }),
    Study::quick(
        "readings",
        "five interpretations of 3 % noise, both examples, both options",
        |c| cases::study(c, "readings"),
    ),
    Study::quick(
        "claims",
        "the claims of Sec. V on spin, axes, unknown momentum and noise",
        |c| cases::study(c, "claims"),
    ),
    Study::quick(
        "advantages",
        "a constant velocity offset and a gyro bias in both options",
        advantages,
    ),
    Study::quick(
        "reach",
        "bounds against span of the motion, number of joints and mass ratio; another path",
        reach::run,
    ),
    Study::slow(
        "compare",
        "both options, the linear method and the bound at equal noise",
        |c| cases::study(c, "compare"),
    ),
    Study::slow(
        "bounds",
        "how often (35) holds in 10,000 trials, and how loose it is",
        bounds::run,
    ),
];

fn mass_ratio(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = cases::study(context, "mass-ratio")?;
    let exact = findings.tables[2..].iter().flat_map(|table| {
        let errors = |row| {
            [(1, 100.0), (2, 1.0), (3, 100.0)].map(|(column, scale)| table.at(row, column) / scale)
        };
        (0..table.rows.len()).flat_map(errors)
    });
    let text = format!("noise-free at most {:.0e} at every ratio", largest(exact));
    findings.state("Fig. 8 errors against mass ratio", text);
    Ok(findings)
}

fn advantages(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = cases::study(context, "advantages")?;
    let bias = &findings.tables[1];
    let of_axes = |column: usize| rms((0..3).map(|row| bias.at(row, column)));
    let [one, two] = [1, 2].map(|column| Digits::Figures(2).text(of_axes(column)));
    let text = format!("{one} and {two} %, rms of three axes");
    findings.state("increments have less bias", text);
    Ok(findings)
}
