//! Sec. 5.6: sensitivity of candidate paths of each joint, and the best one.

use super::robot::Robot;
use crate::study::{Context, Findings, StudyError, Table, figures};
use crate::xu2017::sensitivity::path_sensitivity;
use poinsot_dynamics::Tree;

/// Candidate paths: amplitude, deg, and period, s. The second is close to the paper's.
const PATHS: [(f64, f64); 5] = [
    (15.0, 60.0),
    (30.0, 60.0),
    (30.0, 30.0),
    (60.0, 60.0),
    (90.0, 60.0),
];
const SAMPLES: u32 = 600;

/// Angle and rate over one period of a sine.
fn path(degrees: f64, period: f64) -> Vec<(f64, f64)> {
    let (a, w) = (degrees.to_radians(), std::f64::consts::TAU / period);
    let at = |k| {
        let t = period * f64::from(k) / f64::from(SAMPLES);
        (a * (w * t).sin(), a * w * (w * t).cos())
    };
    (0..SAMPLES).map(at).collect()
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let tree = Tree::new(&robot.model);
    let bodies: Vec<_> = robot
        .model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let normal = vec![0.0; tree.dof()];
    let titles = PATHS.map(|(angle, period)| format!("+-{angle} deg in {period} s"));
    let title = format!(
        "Weakest of the seven directions that a joint shows, N s or N m s per natural unit, {SAMPLES} samples"
    );
    let mut weakest = Table::new("weakest", &title, "joint");
    weakest.head.extend(titles);
    let mut parts = Table::new(
        "paper_path",
        "+-30 deg in 60 s: rate of the base, rad/s; rms of [P; H] per natural unit of the base side",
        "joint | rate | m | mc, largest | I, largest | strongest | weakest",
    );
    let mut near_paper: Vec<f64> = Vec::new();
    for joint in 0..tree.dof() {
        let scores = PATHS.map(|(angle, period)| {
            path_sensitivity(&tree, &bodies, &normal, joint, &path(angle, period))
        });
        let number = |s: &Option<_>| {
            s.as_ref().map_or(
                f64::NAN,
                crate::xu2017::sensitivity::PathSensitivity::weakest,
            )
        };
        weakest.row(
            format!("{}", joint + 1),
            scores.iter().map(|s| figures(number(s), 2)),
        );
        near_paper.push(number(&scores[1]));
        if let Some(s) = &scores[1] {
            let largest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
            let c = &s.coefficients;
            let strongest = s.singular.first().copied().unwrap_or(f64::NAN);
            let row = [
                s.largest_rate,
                c[0],
                largest(&c[1..4]),
                largest(&c[4..]),
                strongest,
                s.weakest(),
            ];
            parts.row(format!("{}", joint + 1), row.map(|x| figures(x, 2)));
        }
    }
    let low = near_paper.iter().copied().fold(f64::INFINITY, f64::min);
    let high = near_paper.iter().copied().fold(0.0, f64::max);
    let mut findings = Findings::of(weakest);
    findings.tables.push(parts);
    let text = format!("{} to {}", figures(low, 2).text(), figures(high, 2).text());
    findings.state("sensitivity chooses the path", text);
    Ok(findings)
}
