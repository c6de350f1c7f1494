//! Exact data with both options, and the paper's histories.

use super::experiment::{self, Experiment, unsymmetric};
use super::noise::{OPTIONS, worst};
use super::sweeps::ORBITAL;
use crate::ma2008::printed::{PrintedAxes, two_step_printed};
use crate::study::{Context, Findings, StudyError, Table, decimals, figures, word};
use poinsot_figures::{Axis, Mark, Plot, Series};

/// Errors for exact data: both trajectories, both options, and option 2 as printed.
pub fn exact(context: &Context) -> Result<Findings, StudyError> {
    let mut table = Table::new(
        "exact",
        "Ten stopped samples, exact data: largest of the errors of mass, mass centre (m) and tensor; mass of option 2 as printed, kg",
        "base | trajectory, spin deg/s | orbital, m/s | option 1 | option 2 | as printed, in base axes | as printed, in N",
    );
    let mut findings = Findings::default();
    for (name, full) in [
        ("Table 1", false),
        ("offset mass centre, full tensor", true),
    ] {
        for (trajectory, spin, motion) in [
            (1, [0.0, 0.0, 5.0], "1, z 5"),
            (1, [0.0, 0.0, 1.0], "1, z 1"),
            (2, [0.0, 1.0, 5.0], "2, y 1 z 5"),
        ] {
            for orbital in [0.0, ORBITAL] {
                let mut e = Experiment::of(context, trajectory, spin)?;
                if full {
                    e = e.with_base(unsymmetric());
                }
                e.velocity = [0.02 + orbital, -0.01, 0.005];
                let run = e.run()?;
                let samples = experiment::readings(&e.model, &run.raws);
                let [one, two] = OPTIONS.map(|known| worst(&e, &run, known));
                let printed = [PrintedAxes::Body, PrintedAxes::Inertial]
                    .map(|axes| two_step_printed(&samples, axes).map_or(f64::NAN, |p| p.mass()));
                let cells = [
                    word(motion),
                    decimals(orbital, 0),
                    figures(one, 1),
                    figures(two, 1),
                    decimals(printed[0], 2),
                    decimals(printed[1], 2),
                ];
                table.row(name, cells);
                if full && trajectory == 2 && orbital == 0.0 {
                    let [one, two] = [one, two].map(|x| format!("{x:.0e}"));
                    findings.state("(10)-(13) step 1, option 1", one.clone());
                    let printed = format!("{two}; as printed {:.0} kg of 1000 kg", printed[1]);
                    findings.state("(14)-(17) step 1, option 2", printed);
                    findings.state("(18)-(20) step 2, option 1", one);
                    findings.state("(21)-(24) step 2, option 2", two);
                }
            }
        }
    }
    findings.tables.push(table);
    Ok(findings)
}

/// Fig. 9 to 12: the six velocities with the marked configurations.
pub fn histories(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut table = Table::new(
        "histories",
        "Largest velocities along both trajectories",
        "figure | duration, s | base origin, m/s | base, rad/s",
    );
    let mut ends = Vec::new();
    for (figure, trajectory, spin, marks) in [
        (
            "fig10",
            1,
            [0.0, 0.0, 5.0],
            &[(5.0, "A"), (45.0, "B"), (75.0, "C"), (125.0, "D")][..],
        ),
        ("fig12", 2, [0.0, 1.0, 0.0], &[(5.0, "A"), (45.0, "B")]),
    ] {
        let mut e = Experiment::of(context, trajectory, spin)?.sampled(2, false);
        let end = e.knots[e.knots.len() - 1].0;
        ends.push(format!("{end} s"));
        e.times = (0..=2 * end as usize).map(|k| 0.5 * k as f64).collect();
        let run = e.run()?;
        let most = |of: &dyn Fn(usize) -> f64| (0..run.raws.len()).map(of).fold(0.0, f64::max);
        table.row(
            format!("Fig. {}, trajectory {trajectory}", &figure[3..]),
            [
                decimals(end, 0),
                figures(most(&|k| run.raws[k].v_NBo_N.norm()), 3),
                figures(most(&|k| run.raws[k].w_NB_B.norm()), 3),
            ],
        );
        for (kind, label, unit) in [("v", "velocity in N", "m/s"), ("w", "rate in B", "rad/s")] {
            let at = |k: usize, axis: usize| match kind {
                "v" => run.raws[k].v_NBo_N[axis],
                _ => run.raws[k].w_NB_B[axis],
            };
            let curve = |axis: usize| {
                let values: Vec<f64> = (0..run.raws.len()).map(|k| at(k, axis)).collect();
                Series::new(["x", "y", "z"][axis], Mark::Line, axis, &run.times, &values)
            };
            let names: Vec<String> = marks.iter().map(|(t, m)| format!("{m} at {t} s")).collect();
            let at_marks = |axis: usize| -> Vec<(f64, f64)> {
                marks
                    .iter()
                    .map(|(t, _)| (*t, at((2.0 * t) as usize, axis)))
                    .collect()
            };
            let dots = |axis: usize| Series {
                points: at_marks(axis),
                ..Series::new("", Mark::Points, axis, &[], &[])
            };
            findings.plot(
                &format!("{figure}_{kind}"),
                Plot {
                    title: format!("Fig. {}: {label}, trajectory {trajectory}", &figure[3..]),
                    x: Axis::new("time", "s"),
                    y: Axis::new(label, unit),
                    series: (0..3).map(curve).chain((0..3).map(dots)).collect(),
                    note: format!("Dots: configurations {}.", names.join(", ")),
                    ..Plot::default()
                },
            );
        }
    }
    findings.tables.push(table);
    findings.state("Fig. 9-12 trajectories and velocities", ends.join(", "));
    Ok(findings)
}
