//! The claims of Sec. V as experiments.

use super::cramer_rao::cramer_rao;
use super::experiment::{Experiment, Run, readings};
use super::noise::{OPTIONS, Scaling, Sigma, medians};
use crate::ma2008::two_step;
use crate::study::{Cell, Context, Findings, StudyError, Table, figures, percent, word};

/// Condition number of step 2 above which the tensor is not determined.
const DETERMINED: f64 = 1.0e12;

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let sigma = Sigma::fixed(context)?;
    spins(context, sigma, &mut findings)?;
    axes(context, sigma, &mut findings)?;
    starts(context, &mut findings)?;
    Ok(findings)
}

/// Bounds of mass and tensor, in percent, and the condition of step 2.
fn bounds(e: &Experiment, run: &Run, sigma: Sigma, known: bool) -> [Cell; 3] {
    let answer = two_step(&[readings(&e.model, &run.raws)], known.then_some(run.known));
    let step = answer.angular.as_ref();
    let condition = step.map_or(f64::INFINITY, |s| s.singular[0] / s.singular[5]);
    let found = cramer_rao(e, run, sigma, known);
    let condition = if condition < DETERMINED {
        condition
    } else {
        f64::INFINITY
    };
    [
        percent(found[0], 2),
        percent(found[2], 2),
        figures(condition, 2),
    ]
}

/// No spin is needed for mass and mass centre; a spin is needed for the tensor.
fn spins(context: &Context, sigma: Sigma, findings: &mut Findings) -> Result<(), StudyError> {
    let mut table = Table::new(
        "spin",
        "Trajectory 1, noise of 1 % of the 5 deg/s run: bounds in %, condition of step 2; a dash: not identifiable",
        "spin, deg/s | samples | momentum | mass | tensor | condition",
    );
    let mut moving_tensor = Vec::new();
    for spin in [0.0, 1.0, 5.0] {
        for (name, stops, drift) in [
            ("10 stopped, from rest", true, 0.0),
            ("10 stopped, drifting 0.02 m/s", true, 0.02),
            ("200 moving, from rest", false, 0.0),
        ] {
            let e = Experiment::of(context, 1, [0.0, 0.0, spin])?.drifting(drift);
            let e = if stops { e } else { e.sampled(200, false) };
            let run = e.run()?;
            for known in OPTIONS {
                let cells = bounds(&e, &run, sigma, known);
                if spin == 0.0 && !stops {
                    moving_tensor.push(cells[1].text());
                    if known {
                        let text = format!("{} % of the mass while joints move", cells[0].text());
                        findings.state("spin not needed for mass and mass centre", text);
                    }
                }
                let momentum = word(if known { "known" } else { "unknown" });
                let cells = [word(name), momentum].into_iter().chain(cells);
                table.row(format!("{spin}"), cells);
            }
        }
    }
    findings.tables.push(table);
    let text = format!(
        "{} % without spin while joints move",
        moving_tensor.join(", ")
    );
    findings.state("spin needed for inertia", text);
    Ok(())
}

/// A spin about one axis needs two axes of arm motion; a spin about two axes needs one.
fn axes(context: &Context, sigma: Sigma, findings: &mut Findings) -> Result<(), StudyError> {
    let mut table = Table::new(
        "axes",
        "Ten stopped samples: bound of the tensor, %; a dash: not identifiable",
        "spin, arm about | momentum unknown | momentum known | unknown, arm in the plane of symmetry",
    );
    let mut unknown = Vec::new();
    for (name, trajectory, spin) in [
        ("z, y and z", 1, [0.0, 0.0, 5.0]),
        ("z, y", 2, [0.0, 0.0, 5.0]),
        ("y, y", 2, [0.0, 5.0, 0.0]),
        ("x, y", 2, [5.0, 0.0, 0.0]),
        ("y and z, y", 2, [0.0, 1.0, 5.0]),
        ("x and z, y", 2, [1.0, 0.0, 5.0]),
    ] {
        let e = Experiment::of(context, trajectory, spin)?;
        let mut plane = e.clone();
        plane.model.joints[0].p_PoCo_P.y = 0.0;
        let of = |e: &Experiment, known| -> Result<Cell, StudyError> {
            let [_, tensor, _] = bounds(e, &e.run()?, sigma, known);
            Ok(tensor)
        };
        let cells = [of(&e, false)?, of(&e, true)?, of(&plane, false)?];
        unknown.push(cells[0].text());
        table.row(name, cells);
    }
    findings.tables.push(table);
    let text = format!(
        "{} % with one axis of the arm, {} % with two",
        unknown[1], unknown[0]
    );
    findings.state("one axis of spin needs two of the arm", text);
    findings.state(
        "two axes of spin need one of the arm",
        format!("{} %", unknown[4]),
    );
    Ok(())
}

/// The momentum may be unknown at the cost of more noise; mass and mass centre are less sensitive; 3 % noise.
fn starts(context: &Context, findings: &mut Findings) -> Result<(), StudyError> {
    let head = "example, start | option 1 | bound | option 2 | bound";
    let title = |what: &str| format!("3 % of each maximum: median error and bound, {what}");
    let mut tables = [
        Table::new("start_mass", &title("mass, %"), head),
        Table::new("start_mass_centre", &title("mass centre, m"), head),
        Table::new("start_tensor", &title("tensor, %"), head),
    ];
    let (mut price, mut at_rest, mut in_orbit) = (Vec::new(), f64::NAN, f64::NAN);
    for n in [1, 2] {
        for (start, velocity) in [
            ("base origin at rest", [0.0; 3]),
            ("drifting 0.02 m/s", [0.02, -0.01, 0.005]),
            ("7500 m/s, noise without it", [7500.0, 0.0, 0.0]),
        ] {
            let mut e = Experiment::example(context, n)?;
            let slow = e.run()?;
            e.velocity = velocity;
            let run = e.run()?;
            let noise_of = if velocity[0] > 1.0 { &slow } else { &run };
            let sigma = Sigma::of(noise_of, 0.03, Scaling::Component);
            let found = OPTIONS.map(|known| {
                (
                    medians(&e, &run, sigma, known),
                    cramer_rao(&e, &run, sigma, known),
                )
            });
            for (k, table) in tables.iter_mut().enumerate() {
                let scale = if k == 1 { 1.0 } else { 100.0 };
                let pair =
                    |(a, b): ([f64; 3], [f64; 3])| [a[k], b[k]].map(|x| figures(scale * x, 2));
                table.row(format!("{n}, {start}"), found.into_iter().flat_map(pair));
            }
            let ratio = found[1].0[2] / found[0].0[2];
            if velocity[0] == 0.0 {
                price.push(figures(ratio, 2).text());
            }
            if n == 1 && velocity[0] == 0.0 {
                at_rest = found[0].0[0];
            }
            if n == 1 && velocity[0] > 1.0 {
                in_orbit = found[0].0[0];
            }
        }
    }
    findings.tables.extend(tables);
    let text = format!("tensor {} times", price.join(" and "));
    findings.state("increments are more sensitive to noise", text);
    let [a, b] = [in_orbit, at_rest].map(|x| percent(x, 2).text());
    let text = format!("mass {a} % with orbital velocity, {b} % at rest");
    findings.state("mass and mass centre less sensitive than inertia", text);
    Ok(())
}
