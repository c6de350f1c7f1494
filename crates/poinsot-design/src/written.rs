//! The files of a design: a case that flies the manoeuvre, its model, and tables of commands.

use crate::mover::{Command, Target};
use crate::result::Designed;
use crate::shape::Space;
use poinsot::case::{Case, Design, parse_case};
use poinsot::{Error, digests, result_json, write_files};
use poinsot_dynamics::{Firing, Jet, JointDrive, Tree, WheelMotion, thrust_held};
use poinsot_formats::case::{CaseFile, FiringFile, JointMotionFile, LimitsFile, WheelMotionFile};
use poinsot_model::{JointKind, Model, read_model_text};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The case with the designed motions replacing its own; `model.toml` lies beside it.
pub(crate) fn manoeuvre_text(
    (case, design): (&Case, &Design),
    space: &Space,
    commands: &[(String, Command)],
    firings: &[(String, Firing)],
) -> Result<String, Error> {
    let mut file = case.file().clone();
    file.design = None;
    file.limits = LimitsFile::default();
    file.model = "model.toml".to_owned();
    file.duration_s = space.record();
    absolute_files(&mut file, case.path());
    leave_out(&mut file.joint_motion, &design.replaced.joint_motion);
    leave_out(&mut file.wheel_motion, &design.replaced.wheel_motion);
    leave_out(&mut file.firing, &design.replaced.firing);
    for ((name, command), mover) in commands.iter().zip(&space.movers) {
        match mover.target {
            Target::Joint(_) => {
                let motion = joint_motion(name, command, mover.slides);
                file.joint_motion.push(motion);
            }
            Target::Wheel(_) => file.wheel_motion.push(wheel_motion(name, command)),
            Target::Thruster(_) => {}
        }
    }
    file.firing
        .extend(firings.iter().map(|(name, f)| FiringFile {
            thruster: name.clone(),
            on_s: f.on,
            off_s: f.off,
            force_N: f.force,
        }));
    let text = toml::to_string(&file).map_err(|e| {
        let advice = "report this bug in poinsot with the case";
        Error::report(case.path(), format!("{e}"), advice)
    })?;
    let (program, from) = (env!("CARGO_PKG_VERSION"), case.path().display());
    Ok(format!(
        "# Designed by poinsot {program} for {from}.\n{text}"
    ))
}

/// The list without the tables at these places.
fn leave_out<T>(list: &mut Vec<T>, places: &[usize]) {
    let mut at = 0..list.len();
    list.retain(|_| at.next().is_some_and(|k| !places.contains(&k)));
}

fn absolute_files(file: &mut CaseFile, case: &Path) {
    let folder = case.parent().unwrap_or(Path::new(""));
    for name in file.files_mut() {
        if let Ok(path) = folder.join(&*name).canonicalize() {
            *name = path.display().to_string();
        }
    }
}

fn interpolation(command: &Command) -> &'static str {
    match command {
        Command::Fourier(_) => "fourier",
        Command::Spline(..) => "cubic_clamped",
        Command::Slews(..) => "quintic_rest",
    }
}

fn joint_motion(name: &str, command: &Command, slides: bool) -> JointMotionFile {
    let mut motion = JointMotionFile {
        joint: name.to_owned(),
        interpolation: interpolation(command).to_owned(),
        ..JointMotionFile::default()
    };
    let m = &mut motion;
    match command {
        Command::Fourier(f) => {
            let (offset, sine, cosine) = match slides {
                true => (&mut m.offset_m, &mut m.sine_m, &mut m.cosine_m),
                false => (&mut m.offset_rad, &mut m.sine_rad, &mut m.cosine_rad),
            };
            *offset = Some(f.offset);
            *sine = Some(f.sine.clone());
            *cosine = Some(f.cosine.clone());
            m.base_frequency_hz = Some(f.base_frequency_hz);
        }
        Command::Spline(time, values) | Command::Slews(time, values) => {
            let position = match slides {
                true => &mut m.position_m,
                false => &mut m.position_rad,
            };
            *position = Some(values.clone());
            m.time_s = Some(time.clone());
        }
    }
    motion
}

/// Wheels follow nodes: the format has no harmonics for wheels.
fn wheel_motion(name: &str, command: &Command) -> WheelMotionFile {
    let nodes = match command {
        Command::Spline(time, values) | Command::Slews(time, values) => Some((time, values)),
        Command::Fourier(_) => None,
    };
    let (time, speed) = nodes.unzip();
    WheelMotionFile {
        wheel: name.to_owned(),
        time_s: time.cloned(),
        speed_rad_s: speed.cloned(),
        interpolation: Some(interpolation(command).to_owned()),
        ..WheelMotionFile::default()
    }
}

/// Commands of every designed joint and wheel at the sample rate of the case, with standard column names.
fn commands_csv(designed: &Designed, case: &Case) -> Result<String, Error> {
    let model = &designed.model;
    let plan = case.bind(model)?.plan;
    let tree = Tree::new(model);
    let jet = |name: &str, t: f64| {
        let joint = model.joint(name);
        let joint = tree.coordinates.iter().position(|k| Some(*k) == joint);
        let wheel = model.wheel(name).map(|k| &plan.wheels[k]);
        match (joint.map(|k| &plan.joints[k]), wheel) {
            (Some(JointDrive::Motion(motion)), _) => motion.at(t, t),
            (None, Some(WheelMotion::Speed(speed))) => speed.at(t, t),
            _ => Jet::default(),
        }
    };
    let mut header = vec!["time_s".to_owned()];
    for (name, _) in &designed.commands {
        match unit_of(&designed.model, name) {
            None => header.push(format!("{name}_rad_s")),
            Some(unit) => header.extend(["", "_s", "_s2"].map(|end| format!("{name}_{unit}{end}"))),
        }
    }
    let thrusters = designed.thrusters();
    header.extend(
        thrusters
            .iter()
            .map(|k| format!("{}_N", designed.model.thrusters[*k].name)),
    );
    let mut levels = vec![0.0; designed.model.thrusters.len()];
    let mut text = header.join(",") + "\n";
    for t in case.times().iter() {
        let _ = write!(text, "{t}");
        for (name, _) in &designed.commands {
            let jet = jet(name, t);
            let _ = match unit_of(&designed.model, name) {
                None => write!(text, ",{}", jet.value),
                Some(_) => write!(text, ",{},{},{}", jet.value, jet.rate, jet.acceleration),
            };
        }
        thrust_held(&plan.firings, t, &mut levels);
        for k in &thrusters {
            let _ = write!(text, ",{}", levels[*k]);
        }
        text.push('\n');
    }
    Ok(text)
}

/// Switching times of every designed thruster.
fn firings_csv(designed: &Designed) -> String {
    let mut text = "thruster,on_s,off_s,force_N\n".to_owned();
    for (name, f) in &designed.firings {
        let _ = writeln!(text, "{name},{},{},{}", f.on, f.off, f.force);
    }
    text
}

/// Unit of a joint's position; `None` for a wheel.
fn unit_of(model: &Model, name: &str) -> Option<&'static str> {
    let joint = model.joint(name).and_then(|k| model.joints.get(k))?;
    Some(match joint.kind {
        JointKind::Prismatic => "m",
        _ => "rad",
    })
}

/// The manoeuvre as a case in a folder.
///
/// # Errors
/// The case is invalid, which is a bug.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// let designed = design_case(&case, model.clone(), &DesignRequest::default())?;
/// // The manoeuvre is a case: predict its accuracy.
/// let manoeuvre = manoeuvre_case(&designed, &folder)?;
/// let prediction = poinsot::predict::predict_case(&manoeuvre, model, 1.0)?;
/// assert!(prediction.wants[0].met);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn manoeuvre_case(designed: &Designed, folder: &Path) -> Result<Case, Error> {
    let path = folder.join("case.toml");
    parse_case(&path, designed.manoeuvre.clone())
}

/// Writes `case.toml`, `model.toml`, `commands.csv`, `firings.csv` of a design that fires, and `design.json` into a
/// folder, all or none. The design then lists the others with their checksums. Returns their paths.
///
/// # Errors
/// The model cannot be read, or writing fails; earlier files are then kept.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-design-write-{}", std::process::id()));
/// let mut designed = design_case(&case, model, &DesignRequest::default())?;
/// write_design(&out, &mut designed, &folder.join("model.toml"))?;
/// assert!(out.join("case.toml").exists() && out.join("design.json").exists());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_design(
    folder: &Path,
    designed: &mut Designed,
    model: &Path,
) -> Result<Vec<PathBuf>, Error> {
    let text = read_model_text(model)?;
    let case = manoeuvre_case(designed, folder)?;
    let mut files: Vec<(PathBuf, Vec<u8>)> = vec![
        ("model.toml".into(), text.into_bytes()),
        (
            "commands.csv".into(),
            commands_csv(designed, &case)?.into_bytes(),
        ),
        ("case.toml".into(), designed.manoeuvre.clone().into_bytes()),
    ];
    if !designed.firings.is_empty() {
        files.push(("firings.csv".into(), firings_csv(designed).into_bytes()));
    }
    // The result comes last: if it exists, the other files do too.
    designed.file.files = digests(&files);
    let json = result_json(folder, &designed.file, true)?;
    files.push(("design.json".into(), json.into_bytes()));
    write_files(folder, &files)
}
