//! A checked case, plan or result in statements, one a line.

use poinsot_files::{list, short};
use poinsot_formats::case::{CaseFile, InitialFile, JointTorqueFile, Placed, WheelMotionFile};
use poinsot_formats::{EstimateFile, PlanFile};

/// What the check of a case with its model found beside its file.
pub struct CheckedCase<'a> {
    /// The case as read.
    pub file: &'a CaseFile,
    /// Name and file of the model.
    pub model: String,
    /// Duration, s.
    pub duration_s: f64,
    /// Rate of the samples, Hz.
    pub rate_hz: f64,
    /// Number of samples.
    pub rows: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Wanted numbers: name, sigma and unit.
    pub wants: Vec<(String, f64, &'static str)>,
    /// Numbers of joints and wheels that a design prescribes; `None` without a design.
    pub design: Option<[usize; 2]>,
}

/// A case.
///
/// ```
/// use poinsot_formats::case::CaseFile;
/// use poinsot_report::{CheckedCase, case_lines};
///
/// let text = "schema = 'poinsot.case/2'\nmodel = 'box.toml'\nduration_s = 10.0\n[output]\nrate_hz = 5\n";
/// let file = CaseFile::parse(text).unwrap();
/// let model = "box (box.toml)".to_owned();
/// let (rows, seed, wants, design) = (51, 1, Vec::new(), None);
/// let lines = case_lines(&CheckedCase { file: &file, model, duration_s: 10.0, rate_hz: 5.0, rows, seed, wants, design });
/// assert_eq!(lines[1], "10 s at 5 Hz: 51 rows, seed 1");
/// assert_eq!(lines[2], "start: at rest");
/// ```
pub fn case_lines(case: &CheckedCase<'_>) -> Vec<String> {
    let file = case.file;
    let mut lines = vec![
        format!("model: {}", case.model),
        format!(
            "{} s at {} Hz: {}, seed {}",
            short(case.duration_s),
            short(case.rate_hz),
            counted(case.rows as u64, "row"),
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
    for (name, sigma, unit) in &case.wants {
        lines.push(format!("wanted: {name} to {} {unit}", short(*sigma)));
    }
    if let Some([joints, wheels]) = case.design {
        let joints = counted(joints as u64, "joint");
        let wheels = counted(wheels as u64, "wheel");
        lines.push(format!("design: prescribes {joints} and {wheels}"));
    }
    lines
}

/// A plan of this name with its numbers of trials, cells and shards, and its methods.
///
/// ```
/// use poinsot_formats::PlanFile;
/// use poinsot_report::plan_lines;
///
/// let text = "schema = 'poinsot.plan/1'\n[[experiment]]\nname = 'box'\ncase = 'case.toml'\n";
/// let file = PlanFile::parse(text).unwrap();
/// let lines = plan_lines(&file, "box", [4, 1, 1], &["linear"]);
/// assert_eq!(lines, ["box: 4 trials of 1 cell, in 1 shard", "experiment: case.toml", "methods: linear"]);
/// ```
pub fn plan_lines(
    file: &PlanFile,
    name: &str,
    [trials, cells, shards]: [u64; 3],
    methods: &[&str],
) -> Vec<String> {
    let mut lines = vec![format!(
        "{name}: {} of {}, in {}",
        counted(trials, "trial"),
        counted(cells, "cell"),
        counted(shards, "shard")
    )];
    for experiment in &file.experiment {
        let of = experiment.case.as_ref().or(experiment.record.as_ref());
        lines.push(format!("experiment: {}", of.map_or("", String::as_str)));
    }
    lines.push(format!("methods: {}", methods.join(", ")));
    lines.extend(file.vary.iter().map(|v| format!("varies: {}", v.number)));
    lines.extend(file.change.iter().map(|c| format!("changed: {}", c.number)));
    lines.extend(file.draw.iter().map(|d| format!("drawn: {}", d.number)));
    lines
}

/// A result of `identify`.
///
/// ```
#[doc = include_str!("../doc/estimate.txt")]
/// let lines = poinsot_report::estimate_lines(&estimate);
/// assert!(lines[0].contains("combinations are identifiable"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate_lines(file: &EstimateFile) -> Vec<String> {
    let found = &file.identifiability;
    let mut lines = vec![format!(
        "{}: {} by {}, {} of {} combinations are identifiable",
        file.model,
        file.status,
        file.method_in_words(),
        found.rank,
        found.parameters
    )];
    for (name, body) in file.bodies.iter().filter(|(_, b)| b.is_asked()) {
        let all = body.numbers();
        let asked = all.iter().filter(|(_, _, n)| !n.is_known()).count();
        let open = all.iter().filter(|(_, _, n)| n.value.is_none()).count();
        let determined = asked - open;
        lines.push(format!(
            "{name}: {determined} of {asked} requested numbers are determined"
        ));
    }
    let files = file.inputs.iter();
    lines.extend(files.map(|i| format!("telemetry: {} ({} rows)", i.path, i.rows)));
    lines.extend(
        file.evidence_against()
            .iter()
            .map(|d| format!("doubt: {d}")),
    );
    lines
}

/// A count with its noun.
fn counted(n: u64, what: &str) -> String {
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
