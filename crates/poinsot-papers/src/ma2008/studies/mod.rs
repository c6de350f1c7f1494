//! The paper's figures, the claims of its Sec. II to V, its bounds, and both options compared with the methods of this
//! project.

mod bounds;
mod cases;
mod cramer_rao;
pub mod experiment;
mod histories;

use crate::study::statistics::{largest, rms};
use crate::study::{Context, Digits, Findings, Study, StudyError, Table};
use experiment::Experiment;

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
        reach,
    ),
    Study::slow(
        "compare",
        "both options and the bound at equal noise",
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

fn reach(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = cases::study(context, "reach")?;
    findings.tables.push(another_path(context)?);
    Ok(findings
        .say(&["internal forces and the path do not matter = {path.0.2} kg between two paths"]))
}

/// Two runs through the same stops on different paths: the arm swings out and back between the stops. Joint torques,
/// attitudes and velocities therefore differ.
fn another_path(context: &Context) -> Result<Table, StudyError> {
    let e = Experiment::of(context, 1, [0.0, 0.0, 5.0])?;
    let mut other = e.clone();
    other.detour_deg = 60.0;
    let runs = [e.run()?, other.run()?];
    let turned = runs[0].raws.iter().zip(&runs[1].raws);
    let attitude = largest(turned.map(|(x, y)| x.R_NB.angle_to(&y.R_NB)));
    let [a, b] = runs.map(|run| run.solved(&run.raws, false).mass());
    let title = "The same stops by another path: largest difference of attitude, rad; difference of option 2's mass, kg";
    let mut table = Table::new("path", title, " | attitude | mass :1");
    table.row("another path", [attitude, (a - b).abs()]);
    Ok(table)
}
