//! Claims of Sec. III and V on the motion: span, number of joints, path, internal torque, mass ratio.

use super::cramer_rao::cramer_rao;
use super::experiment::{Experiment, Run, readings, scale_arm};
use super::noise::{OPTIONS, Scaling, Sigma, medians};
use crate::ma2008::{Raw, two_step};
use crate::study::statistics::largest;
use crate::study::{CaseText, Cell, Context, Findings, StudyError, Table, figures, percent};
use poinsot_identify::{Number, tensor_index};
use poinsot_model::Model;

const HEAD: &str = "mass, known | tensor, known | mass, unknown | tensor, unknown";
/// Fractions of the full span of the joint angles.
const SPANS: [f64; 3] = [1.0, 0.5, 0.25];
/// Arm mass over base mass.
const RATIOS: [f64; 6] = [0.005, 0.02, 0.05, 0.1, 0.2, 0.5];
/// Number of stops, of which the ten with the largest velocities are used.
const STOPS: usize = 40;
/// Trajectory 1 with a spin about z, deg/s.
const SPIN: [f64; 3] = [0.0, 0.0, 5.0];

fn scaled(mut e: Experiment, factor: f64) -> Experiment {
    for knot in &mut e.knots {
        knot.1.iter_mut().for_each(|q| *q *= factor);
    }
    e
}

/// Fixes all other joints.
fn only(mut e: Experiment, moves: &[usize]) -> Experiment {
    let first = e.knots[0].1;
    for knot in &mut e.knots {
        for j in (0..6).filter(|j| !moves.contains(j)) {
            knot.1[j] = first[j];
        }
    }
    e
}

/// Trajectory 1 with additional rotation of the wrist.
fn with_wrist(mut e: Experiment) -> Experiment {
    for (k, knot) in e.knots.iter_mut().enumerate() {
        for j in 3..6 {
            knot.1[j] = 30.0 * k as f64 * (1.0 - 0.5 * (j - 3) as f64);
        }
    }
    e
}

/// Bounds of mass and tensor in percent, with momentum known and unknown.
fn bounds(e: &Experiment, sigma: Sigma) -> Result<[Cell; 4], StudyError> {
    Ok(bounds_of(e, &e.run()?, sigma))
}

fn bounds_of(e: &Experiment, run: &Run, sigma: Sigma) -> [Cell; 4] {
    let [a, b] = OPTIONS.map(|known| cramer_rao(e, run, sigma, known));
    [a[0], a[2], b[0], b[2]].map(|x| percent(x, 2))
}

fn table(name: &str, title: &str, first: &str) -> Table {
    let title = format!("Cramer-Rao bounds in %: {title}");
    Table::new(name, &title, &format!("{first} | {HEAD}"))
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let sigma = Sigma::fixed(context)?;
    span(context, sigma, &mut findings)?;
    joints(context, sigma, &mut findings)?;
    ratio(context, sigma, &mut findings)?;
    large_velocities(context, sigma, &mut findings)?;
    predicted(context, &mut findings)?;
    another_path(context, &mut findings)?;
    Ok(findings)
}

/// Ten of many stops: equally spaced, and those with the largest velocities relative to each component's maximum.
fn large_velocities(
    context: &Context,
    sigma: Sigma,
    findings: &mut Findings,
) -> Result<(), StudyError> {
    let title = "ten stopped samples of forty, base origin at rest";
    let mut table = table("large", title, "samples");
    let e = Experiment::of(context, 1, SPIN)?.sampled(STOPS, true);
    let mut run = e.run()?;
    let most = Sigma::of(&run, 1.0, Scaling::Component);
    let size = |r: &Raw| {
        let (v, w) = (
            r.v_NBo_N.component_div(&most.v),
            r.w_NB_B.component_div(&most.w),
        );
        v.norm_squared() + w.norm_squared()
    };
    let all = run.raws.clone();
    run.raws = all.iter().step_by(STOPS / 10).cloned().collect();
    let spaced = bounds_of(&e, &run, sigma);
    run.raws = all;
    run.raws.sort_by(|a, b| size(b).total_cmp(&size(a)));
    run.raws.truncate(10);
    let cells = bounds_of(&e, &run, sigma);
    let [one, other] = [&cells, &spaced].map(|c| c[1].text());
    let text = format!("tensor {one} %, equally spaced {other} %");
    findings.state("samples where the velocities are large", text);
    table.row("equally spaced", spaced);
    table.row("largest velocities", cells);
    findings.tables.push(table);
    Ok(())
}

/// `predict` for the shipped case at 2 Hz: all sensors, momentum unknown, joints moving.
fn predicted(context: &Context, findings: &mut Findings) -> Result<(), StudyError> {
    let case = context.case("ma2008_traj1.toml")?;
    let case = case.with(&[("rate_hz = 20", "rate_hz = 2")]);
    let vehicle = context.tools.vehicle(&case)?;
    let cells = |case: &CaseText, vehicle: &Model| -> Result<[Cell; 2], StudyError> {
        let bound = context.tools.bound(case, vehicle)?;
        let base = &bound.bodies[0];
        let share = |n: &Number| n.sigma.map_or(f64::INFINITY, |s| s / n.nominal);
        Ok([&base.mass, &base.inertia[tensor_index("yy")]].map(|n| percent(share(n), 2)))
    };
    let title = "Bounds of `predict data/cases/ma2008_traj1.toml` at 2 Hz, %";
    let mut span = Table::new("predicted_span", title, "joint angles times | mass | I_yy");
    for factor in SPANS {
        span.row(format!("{factor}"), cells(&swung(&case, factor), &vehicle)?);
    }
    let mut ratio = Table::new("predicted_ratio", title, "arm / base, % | mass | I_yy");
    for share in RATIOS {
        let mut vehicle = vehicle.clone();
        scale_arm(&mut vehicle, share);
        ratio.row(format!("{}", 100.0 * share), cells(&case, &vehicle)?);
    }
    findings.tables.extend([span, ratio]);
    Ok(())
}

/// A case with scaled joint positions.
fn swung(case: &CaseText, factor: f64) -> CaseText {
    let line = |line: &str| {
        let list = line.strip_prefix("position_rad = [");
        let Some(list) = list.and_then(|l| l.strip_suffix(']')) else {
            return line.to_owned();
        };
        let angles = list.split(',').filter_map(|x| x.trim().parse::<f64>().ok());
        let angles: Vec<f64> = angles.map(|x| factor * x).collect();
        format!("position_rad = {angles:?}")
    };
    let lines: Vec<String> = case.text.lines().map(line).collect();
    CaseText {
        path: case.path.clone(),
        text: lines.join("\n"),
    }
}

fn span(context: &Context, sigma: Sigma, findings: &mut Findings) -> Result<(), StudyError> {
    for (name, title, drift, moving) in [
        (
            "span",
            "span of the motion, ten stopped samples, base origin at rest",
            0.0,
            false,
        ),
        (
            "span_drifting",
            "span of the motion, ten stopped samples, drifting 0.02 m/s",
            0.02,
            false,
        ),
        (
            "span_moving",
            "span of the motion, 200 moving samples, drifting 0.02 m/s",
            0.02,
            true,
        ),
    ] {
        let mut table = table(name, title, "joint angles times");
        let mut tensors = Vec::new();
        for factor in SPANS {
            let e = scaled(Experiment::of(context, 1, SPIN)?, factor).drifting(drift);
            let e = if moving { e.sampled(200, false) } else { e };
            let cells = bounds(&e, sigma)?;
            tensors.push(cells[3].text());
            table.row(format!("{factor}"), cells);
        }
        if name == "span" {
            findings.state(
                "span as large as possible",
                format!("tensor {} %", tensors.join(", ")),
            );
        }
        findings.tables.push(table);
    }
    Ok(())
}

fn joints(context: &Context, sigma: Sigma, findings: &mut Findings) -> Result<(), StudyError> {
    let title = "joints that move, spin y 1 and z 5 deg/s, ten stopped samples";
    let mut table = table("joints", title, "joints");
    let e = Experiment::of(context, 1, [0.0, 1.0, 5.0])?;
    let mut known = Vec::new();
    for (name, moves) in [
        ("1", &[0][..]),
        ("2", &[1]),
        ("1 and 2", &[0, 1]),
        ("1, 2, 3 (trajectory 1)", &[0, 1, 2]),
    ] {
        let cells = bounds(&only(e.clone(), moves), sigma)?;
        known.push(cells[1].text());
        table.row(name, cells);
    }
    let cells = bounds(&with_wrist(e), sigma)?;
    known.push(cells[1].text());
    table.row("all six", cells);
    findings.tables.push(table);
    let text = format!("tensor {} and {} % with one joint", known[0], known[1]);
    findings.state("fewer than six joints suffice", text);
    let text = format!("tensor {} % with three, {} % with six", known[3], known[4]);
    findings.state("more joints are better", text);
    Ok(())
}

/// The bounds, and the tensor of the two steps with the same fixed noise.
fn ratio(context: &Context, sigma: Sigma, findings: &mut Findings) -> Result<(), StudyError> {
    for (name, title, drift) in [
        (
            "ratio",
            "arm mass over base mass, ten stopped samples, base origin at rest",
            0.0,
        ),
        (
            "ratio_drifting",
            "arm mass over base mass, ten stopped samples, drifting 0.02 m/s",
            0.02,
        ),
    ] {
        let mut table = table(name, title, "arm / base, %");
        table.head.push("option 1, tensor".to_owned());
        for ratio in RATIOS {
            let e = Experiment::of(context, 1, SPIN)?
                .with_ratio(ratio)
                .drifting(drift);
            let mut cells = bounds(&e, sigma)?.to_vec();
            if drift == 0.0 && ratio == 0.02 {
                let text = format!("tensor {} % at 2 %", cells[1].text());
                findings.state("arm mass at least 5 %", text);
            }
            let median = medians(&e, &e.run()?, sigma, true)[2];
            cells.push(percent(median, 2));
            table.row(format!("{}", 100.0 * ratio), cells);
        }
        findings.tables.push(table);
    }
    Ok(())
}

/// Two runs through the same stops on different paths: the arm swings out and back between the stops. Joint torques,
/// attitudes and velocities therefore differ.
fn another_path(context: &Context, findings: &mut Findings) -> Result<(), StudyError> {
    let e = Experiment::of(context, 1, SPIN)?;
    let mut other = e.clone();
    other.detour_deg = 60.0;
    let runs = [e.run()?, other.run()?];
    let turned = runs[0].raws.iter().zip(&runs[1].raws);
    let attitude = largest(turned.map(|(x, y)| x.R_NB.angle_to(&y.R_NB)));
    let [a, b] = runs.map(|run| two_step(&[readings(&e.model, &run.raws)], None).mass());
    let mut table = Table::new(
        "path",
        "The same stops by another path: largest difference of attitude, rad; difference of option 2's mass, kg",
        " | attitude | mass",
    );
    table.row(
        "another path",
        [figures(attitude, 2), figures((a - b).abs(), 1)],
    );
    findings.tables.push(table);
    let text = format!("{:.0e} kg between two paths", (a - b).abs());
    findings.state("internal forces and the path do not matter", text);
    Ok(())
}
