//! A case in words.

use super::{Case, CaseError};
use poinsot_formats::case::{CaseFile, InitialFile, JointTorqueFile, Placed, WheelMotionFile};
use poinsot_model::Model;
use poinsot_telemetry::rounded;

/// Digits of numbers in words.
const DIGITS: usize = 6;

/// What a case does with a model, one statement a line.
///
/// # Errors
/// Everything that `simulate`, `predict` and `design` would refuse.
pub(crate) fn describe_case(case: &Case, model: &Model) -> Result<Vec<String>, CaseError> {
    let wants = case.wants(model)?;
    case.limits(model)?;
    let design = case.design(model)?;
    // A wheel that the design turns needs no motion of the case.
    let turned = design.iter().flat_map(|d| &d.wheels);
    let open: Vec<usize> = turned.map(|wheel| wheel.index).collect();
    let scenario = case.bind_open(model, &open)?;
    let file = &case.file;
    let mut lines = vec![
        format!("model: {} ({})", model.name, case.model.display()),
        format!(
            "{} s at {} Hz: {} rows, seed {}",
            short(case.duration_s),
            short(case.rate_hz),
            scenario.times.len(),
            case.seed
        ),
        format!("start: {}", start(&file.initial)),
    ];
    motions(file, &mut lines);
    for sensor in &file.output.get_ref().sensor {
        let rate = sensor.rate_hz.as_ref();
        let rate = rate.map_or(String::new(), |r| format!(" at {} Hz", short(*r.get_ref())));
        lines.push(format!("sensor {}{rate}", sensor.name.get_ref()));
    }
    for want in wants {
        let sigma = short(want.sigma);
        lines.push(format!("wanted: {} to {sigma} {}", want.name, want.unit));
    }
    if let Some(design) = design {
        let (joints, wheels) = (design.joints.len(), design.wheels.len());
        lines.push(format!("design: moves {joints} joints and {wheels} wheels"));
    }
    Ok(lines)
}

fn short(x: f64) -> String {
    rounded(x, DIGITS)
}

fn list<const N: usize>(x: &Placed<[f64; N]>) -> String {
    let all: Vec<String> = x.get_ref().iter().map(|x| short(*x)).collect();
    format!("({})", all.join(", "))
}

fn start(initial: &InitialFile) -> String {
    let mut said = Vec::new();
    for (name, value, unit) in [
        ("angular velocity", &initial.omega_rad_s, "rad/s"),
        ("position", &initial.r_m, "m"),
        ("velocity", &initial.v_m_s, "m/s"),
        ("linear momentum", &initial.linear_N_s, "N s"),
        ("angular momentum", &initial.angular_N_m_s, "N m s"),
    ] {
        if let Some(value) = value {
            said.push(format!("{name} {} {unit}", list(value)));
        }
    }
    if let Some(q) = &initial.q_xyzw {
        said.push(format!("attitude {} xyzw", list(q)));
    }
    match said.is_empty() {
        true => "at rest".to_owned(),
        false => said.join(", "),
    }
}

fn motions(file: &CaseFile, lines: &mut Vec<String>) {
    for motion in &file.joint_motion {
        let word = motion.interpolation.get_ref();
        lines.push(format!(
            "joint {}: prescribed, {word}",
            motion.joint.get_ref()
        ));
    }
    for torque in &file.joint_torque {
        let (joint, how) = (torque.joint.get_ref(), torque_words(torque));
        lines.push(format!("joint {joint}: motor torque, {how}"));
    }
    for motion in &file.wheel_motion {
        lines.push(format!(
            "wheel {}: {}",
            motion.wheel.get_ref(),
            wheel_words(motion)
        ));
    }
    for firing in &file.firing {
        lines.push(format!(
            "thruster {}: {} N from {} to {} s",
            firing.thruster.get_ref(),
            short(*firing.force_N.get_ref()),
            short(*firing.on_s.get_ref()),
            short(*firing.off_s.get_ref())
        ));
    }
    if let Some(control) = &file.control {
        let targets = control.get_ref().target.len();
        let to = match targets {
            0 => "the axes of N".to_owned(),
            n => format!("{n} targets"),
        };
        lines.push(format!("control: the wheels turn the vehicle to {to}"));
    }
}

fn torque_words(torque: &JointTorqueFile) -> String {
    match (&torque.file, &torque.time_s, &torque.frequency_rad_s) {
        (Some(file), _, _) => format!("from {}", file.get_ref()),
        (_, Some(times), _) => format!("{} nodes", times.get_ref().len()),
        (_, _, Some(frequency)) => format!("sinusoid of {} rad/s", short(*frequency.get_ref())),
        _ => "constant".to_owned(),
    }
}

fn wheel_words(motion: &WheelMotionFile) -> String {
    let what = match motion.torque_N_m {
        Some(_) => "motor torque",
        None => "speed",
    };
    match (&motion.file, &motion.time_s) {
        (Some(file), _) => format!("from {}", file.get_ref()),
        (_, Some(times)) => format!("{what}, {} nodes", times.get_ref().len()),
        _ => what.to_owned(),
    }
}
