//! Describes a case as text.

use super::{Case, CaseError, CaseFault, Design, Open, refuse};
use poinsot_files::{list, short};
use poinsot_formats::case::{CaseFile, InitialFile, JointTorqueFile, Placed, WheelMotionFile};
use poinsot_model::Model;

/// Describes a case with a model, one statement per line; `faults` are those found without the model.
///
/// # Errors
/// All faults that `simulate`, `predict` and `design` would report, in file order.
pub(crate) fn describe_case(
    case: &Case,
    model: &Model,
    mut faults: Vec<CaseFault>,
) -> Result<Vec<String>, CaseError> {
    let wants = kept(case.wants(model), &mut faults);
    kept(case.limits(model), &mut faults);
    let design = kept(case.design(model), &mut faults);
    // A wheel moved by the design needs no motion in the case.
    let open = match &design {
        Some(design) => design.as_ref().map(Design::open).unwrap_or_default(),
        None => Open {
            wheels: (0..model.wheels.len()).collect(),
            ..Open::default()
        },
    };
    let scenario = kept(case.bind_around(model, open), &mut faults);
    let (Some(wants), Some(design), Some(scenario), []) =
        (wants, design, scenario, faults.as_slice())
    else {
        faults.sort_by_key(|f| f.line);
        faults.dedup();
        return Err(refuse(faults));
    };
    let file = &case.file;
    let mut lines = vec![
        format!("model: {} ({})", model.name, case.model.display()),
        format!(
            "{} s at {} Hz: {}, seed {}",
            short(case.duration_s),
            short(case.rate_hz),
            counted(scenario.times.len() as u64, "row"),
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
        let (joints, wheels) = (
            counted(joints as u64, "joint"),
            counted(wheels as u64, "wheel"),
        );
        lines.push(format!("design: prescribes {joints} and {wheels}"));
    }
    Ok(lines)
}

/// The value read; its faults are added to `faults`.
fn kept<T>(read: Result<T, CaseError>, faults: &mut Vec<CaseFault>) -> Option<T> {
    read.map_err(|error| faults.extend(error.faults)).ok()
}

/// A count with its noun.
pub(crate) fn counted(n: u64, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn bracketed<const N: usize>(x: &Placed<[f64; N]>) -> String {
    format!("({})", list(x.get_ref()))
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
            said.push(format!("{name} {} {unit}", bracketed(value)));
        }
    }
    if let Some(q) = &initial.q_xyzw {
        said.push(format!("attitude {} xyzw", bracketed(q)));
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
            n => counted(n as u64, "target"),
        };
        lines.push(format!("control: the wheels turn the vehicle to {to}"));
    }
}

fn torque_words(torque: &JointTorqueFile) -> String {
    match (&torque.file, &torque.time_s, &torque.frequency_rad_s) {
        (Some(file), _, _) => format!("from {}", file.get_ref()),
        (_, Some(times), _) => counted(times.get_ref().len() as u64, "node"),
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
        (_, Some(times)) => format!("{what}, {}", counted(times.get_ref().len() as u64, "node")),
        _ => what.to_owned(),
    }
}
