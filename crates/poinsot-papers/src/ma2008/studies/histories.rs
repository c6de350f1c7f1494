//! Fig. 9 to 12: the six velocities with the marked configurations.

use super::experiment::Experiment;
use crate::ma2008::Raw;
use crate::study::statistics::largest;
use crate::study::{Context, Findings, StudyError, Table, curves};
use poinsot_figures::{Mark, Plot, Series};
use poinsot_spatial::Vector3;

/// Velocity of a sample, and its name with unit.
type Velocity = (&'static str, &'static str, fn(&Raw) -> Vector3);
const VELOCITIES: [Velocity; 2] = [
    ("v", "velocity in N, m/s", |r| r.v_NBo_N),
    ("w", "rate in B, rad/s", |r| r.w_NB_B),
];

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::of([Table::new(
        "histories",
        "Largest velocities along both trajectories",
        "figure | duration, s :.0 | base origin, m/s :3 | base, rad/s :3",
    )]);
    for (figure, trajectory, spin, marks) in [
        (10, 1, [0.0, 0.0, 5.0], &[5, 45, 75, 125][..]),
        (12, 2, [0.0, 1.0, 0.0], &[5, 45]),
    ] {
        let mut e = Experiment::of(context, trajectory, spin)?.sampled(2, false);
        e.times = e.whole();
        let run = e.run()?;
        let most = VELOCITIES.map(|(_, _, of)| largest(run.raws.iter().map(|r| of(r).norm())));
        let end = e.times[e.times.len() - 1];
        let words = format!("Fig. {figure}, trajectory {trajectory}");
        findings.tables[0].row(words, [end, most[0], most[1]]);
        let names = marks.iter().zip(["A", "B", "C", "D"]);
        let names: Vec<String> = names.map(|(t, m)| format!("{m} at {t} s")).collect();
        for (kind, y, of) in VELOCITIES {
            let series = |name: &str, mark, axis: usize, rows: &[usize]| {
                let time: Vec<f64> = rows.iter().map(|k| run.times[*k]).collect();
                let values: Vec<f64> = rows.iter().map(|k| of(&run.raws[*k])[axis]).collect();
                Series::new(name, mark, axis, &time, &values)
            };
            let all: Vec<usize> = (0..run.raws.len()).collect();
            let marked: Vec<usize> = marks.iter().map(|t| 2 * t).collect();
            let lines = ["x", "y", "z"].into_iter().enumerate();
            let lines = lines.map(|(axis, name)| series(name, Mark::Line, axis, &all));
            let dots = (0..3).map(|axis| series("", Mark::Points, axis, &marked));
            let label = y.split(", ").next().unwrap_or_default();
            let title = format!("Fig. {figure}: {label}, trajectory {trajectory}");
            let plot = Plot {
                note: format!("Dots: configurations {}.", names.join(", ")),
                ..curves(title, "time, s", y, lines.chain(dots).collect())
            };
            findings.plot(&format!("fig{figure}_{kind}"), plot);
        }
    }
    Ok(findings
        .say(&["Fig. 9-12 trajectories and velocities = {histories.0.1} s, {histories.1.1} s"]))
}
