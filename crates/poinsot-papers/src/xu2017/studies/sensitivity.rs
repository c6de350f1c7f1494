//! Sec. 5.6: sensitivity of candidate paths of each joint, and the best one.

use super::robot::Robot;
use crate::study::statistics::largest;
use crate::study::{Context, Digits, Findings, StudyError, Table};
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
    let bodies = robot.model.bodies.iter().map(|b| b.nominal.parameters());
    let bodies: Vec<_> = bodies.collect();
    let normal = vec![0.0; tree.dof()];
    let titles = PATHS.map(|(angle, period)| format!("+-{angle} deg in {period} s"));
    let title = format!(
        "Weakest of the seven directions that a joint shows, N s or N m s per natural unit, {SAMPLES} samples"
    );
    let head = format!("joint | {}", titles.join(" | "));
    let mut weakest = Table::new("weakest", title, &head);
    for joint in 0..tree.dof() {
        let score = |(angle, period)| {
            let found = path_sensitivity(&tree, &bodies, &normal, joint, &path(angle, period));
            found.and_then(|s| s.last().copied()).unwrap_or(f64::NAN)
        };
        weakest.row(format!("{}", joint + 1), PATHS.map(score));
    }
    let near_paper = || (0..tree.dof()).map(|joint| weakest.at(joint, 2));
    let ends = [
        near_paper().fold(f64::INFINITY, f64::min),
        largest(near_paper()),
    ];
    let [low, high] = ends.map(|x| Digits::Figures(2).text(x));
    let mut findings = Findings::of([weakest]);
    findings.state("sensitivity chooses the path", format!("{low} to {high}"));
    Ok(findings)
}
