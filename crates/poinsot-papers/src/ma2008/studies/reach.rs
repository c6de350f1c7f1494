//! Claims of Sec. III and V on the motion: span, number of joints, path, internal torque, mass ratio.

use super::cases;
use super::experiment::{Experiment, Run, Sigma, scale_arm};
use crate::ma2008::Raw;
use crate::study::statistics::largest;
use crate::study::{CaseText, Context, Findings, StudyError, Table};
use poinsot_identify::{Number, tensor_index};
use poinsot_model::Model;

/// Fractions of the full span of the joint angles.
const SPANS: [f64; 3] = [1.0, 0.5, 0.25];
/// Arm mass over base mass.
const RATIOS: [f64; 6] = [0.005, 0.02, 0.05, 0.1, 0.2, 0.5];
/// Number of stops, of which the ten with the largest velocities are used.
const STOPS: usize = 40;
/// Trajectory 1 with a spin about z, deg/s.
const SPIN: [f64; 3] = [0.0, 0.0, 5.0];

/// Bounds of mass and tensor in percent, with momentum known and unknown.
fn bounds(run: &Run, sigma: Sigma) -> [f64; 4] {
    let [a, b] = [true, false].map(|known| run.bound(sigma, known));
    [a[0], a[2], b[0], b[2]].map(|x| 100.0 * x)
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let mut findings = cases::study(context, "reach")?;
    findings.tables.push(large_velocities(context)?);
    findings.tables.extend(predicted(context)?);
    findings.tables.push(another_path(context)?);
    Ok(findings.say(&[
        "samples where the velocities are large = tensor {large.1.2} %, equally spaced {large.0.2} %",
        "internal forces and the path do not matter = {path.0.2} kg between two paths",
    ]))
}

/// Ten of many stops: equally spaced, and those with the largest velocities relative to each component's maximum.
fn large_velocities(context: &Context) -> Result<Table, StudyError> {
    let sigma = Experiment::of(context, 1, SPIN)?.run()?.equal_sigma(0.01);
    let mut table = Table::new(
        "large",
        "Cramer-Rao bounds in %: ten stopped samples of forty, base origin at rest",
        "samples | mass, known | tensor, known | mass, unknown | tensor, unknown",
    );
    let experiment = Experiment::of(context, 1, SPIN)?.sampled(STOPS, true);
    let mut run = experiment.run()?;
    let most = run.sigma(1.0);
    let size = |r: &Raw| {
        let v = r.v_NBo_N.component_div(&most.v);
        v.norm_squared() + r.w_NB_B.component_div(&most.w).norm_squared()
    };
    let mut all = run.raws.clone();
    run.raws = all.iter().step_by(STOPS / 10).cloned().collect();
    table.row("equally spaced", bounds(&run, sigma));
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    run.raws = all[..10].to_vec();
    table.row("largest velocities", bounds(&run, sigma));
    Ok(table)
}

/// `predict` for the shipped case at 2 Hz: all sensors, momentum unknown, joints moving.
fn predicted(context: &Context) -> Result<[Table; 2], StudyError> {
    let case = context.case("ma2008_traj1.toml")?;
    let case = case.with(&[("rate_hz = 20", "rate_hz = 2")]);
    let vehicle = context.tools.vehicle(&case)?;
    let cells = |case: &CaseText, vehicle: &Model| -> Result<[f64; 2], StudyError> {
        let bound = context.tools.bound(case, vehicle)?;
        let base = &bound.bodies[0];
        let share = |n: &Number| 100.0 * n.sigma.map_or(f64::INFINITY, |s| s / n.nominal);
        Ok([&base.mass, &base.inertia[tensor_index("yy")]].map(share))
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
    Ok([span, ratio])
}

/// A case with scaled joint positions.
fn swung(case: &CaseText, factor: f64) -> CaseText {
    let line = |line: &str| {
        let list = line.strip_prefix("position_rad = [");
        let Some(list) = list.and_then(|l| l.strip_suffix("]")) else {
            return line.to_owned();
        };
        let angles = list.split(',').filter_map(|x| x.trim().parse::<f64>().ok());
        let angles: Vec<f64> = angles.map(|x| factor * x).collect();
        format!("position_rad = {angles:?}")
    };
    let lines: Vec<String> = case.text.lines().map(line).collect();
    CaseText {
        text: lines.join("\n"),
        ..case.clone()
    }
}

/// Two runs through the same stops on different paths: the arm swings out and back between the stops. Joint torques,
/// attitudes and velocities therefore differ.
fn another_path(context: &Context) -> Result<Table, StudyError> {
    let e = Experiment::of(context, 1, SPIN)?;
    let mut other = e.clone();
    other.detour_deg = 60.0;
    let runs = [e.run()?, other.run()?];
    let turned = runs[0].raws.iter().zip(&runs[1].raws);
    let attitude = largest(turned.map(|(x, y)| x.R_NB.angle_to(&y.R_NB)));
    let [a, b] = runs.map(|run| run.solved(&run.raws, false).mass());
    let mut table = Table::new(
        "path",
        "The same stops by another path: largest difference of attitude, rad; difference of option 2's mass, kg",
        " | attitude | mass :1",
    );
    table.row("another path", [attitude, (a - b).abs()]);
    Ok(table)
}
