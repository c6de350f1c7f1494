//! URDF, the robot description of ROS, read into a [`Model`].
//!
//! No recursion over the file's content, no DTD, and files named in it are not opened.

mod base;
mod build;
mod inertial;
mod limits;
mod raw;
mod tree;

pub(crate) use inertial::rotation;
pub(crate) use limits::excess;
pub(crate) use raw::ELEMENTS;

use crate::document::Lines;
use crate::model_text::read_model_text;
use crate::vehicle::Model;
use poinsot_files::{Fault, Faults, Place, excerpt};
use std::path::Path;

/// A remark with its position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Remark {
    /// Error code; `None` for a note.
    pub code: Option<&'static str>,
    pub byte: usize,
    /// Subject: `link "arm"`, `joint "elbow"`.
    pub subject: String,
    pub value: String,
    pub problem: String,
    pub remedy: String,
}

impl Remark {
    fn new(
        code: Option<&'static str>,
        byte: usize,
        problem: impl Into<String>,
        remedy: &str,
    ) -> Self {
        Self {
            code,
            byte,
            subject: String::new(),
            value: String::new(),
            problem: problem.into(),
            remedy: remedy.to_owned(),
        }
    }

    /// The same with its subject.
    fn on(self, subject: impl Into<String>) -> Self {
        let subject = subject.into();
        Self { subject, ..self }
    }

    /// The same with the value as read.
    fn with_value(self, value: &str, most: usize) -> Self {
        let value = format!("\"{}\"", excerpt(value, most));
        Self { value, ..self }
    }
}

/// Content of a URDF file.
#[derive(Debug, Clone)]
pub struct Urdf {
    /// The vehicle, or the error.
    pub model: Result<Model, Faults>,
    /// Every remark on the file: its code or "note", and the words.
    pub remarks: Vec<String>,
}

/// Reads a URDF file; never fails, see [`Urdf::model`].
///
/// ```
/// use poinsot_model::read_urdf;
///
/// // A file that does not exist: the error is in the answer.
/// assert!(read_urdf("/nowhere/arm.urdf").model.is_err());
/// ```
pub fn read_urdf(path: impl AsRef<Path>) -> Urdf {
    read_urdf_with(path, &UrdfOptions::default())
}

/// How a URDF file is read.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UrdfOptions {
    /// Links that move no mass are fixed to their parents, instead of refused.
    pub allow_massless: bool,
    /// The link that is the base, with its frame; `None`: the link without parent.
    pub base: Option<String>,
}

/// Reads a URDF file as [`read_urdf`] does, with options.
///
/// ```
/// use poinsot_model::{UrdfOptions, read_urdf_with};
///
/// let options = UrdfOptions { allow_massless: true, ..UrdfOptions::default() };
/// assert!(read_urdf_with("/nowhere/arm.urdf", &options).model.is_err());
/// ```
pub fn read_urdf_with(path: impl AsRef<Path>, options: &UrdfOptions) -> Urdf {
    let path = path.as_ref();
    match read_model_text(path) {
        Ok(text) => parsed(&text, &path.display().to_string(), options),
        Err(error) => Urdf {
            model: Err(error),
            remarks: Vec::new(),
        },
    }
}

/// Reads URDF text; `file` is its name in messages.
///
/// ```
/// use poinsot_model::parse_urdf;
///
/// let text = r#"<robot name="box"><link name="bus"><inertial><origin xyz="0.1 0 0"/><mass value="10"/>
/// <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial></link></robot>"#;
/// let model = parse_urdf(text, "box.urdf").model?;
/// let bus = &model.bodies[0];
/// assert_eq!((bus.nominal.mass, bus.nominal.p_BoBcm_B.x), (10.0, 0.1));
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn parse_urdf(text: &str, file: &str) -> Urdf {
    parsed(text, file, &UrdfOptions::default())
}

fn parsed(text: &str, file: &str, options: &UrdfOptions) -> Urdf {
    let mut remarks = Vec::new();
    let model = raw::read(text, &mut remarks).and_then(|mut robot| {
        if let Some(link) = &options.base {
            base::choose(&mut robot, link, &mut remarks);
        }
        let order = tree::check(&robot, &mut remarks);
        let inertials = inertial::check(&mut robot, &order, options.allow_massless, &mut remarks);
        build::model(&robot, &order, &inertials, &mut remarks)
    });
    let words = |r: &Remark| format!("{} {}", r.code.unwrap_or("note"), r.problem);
    let words = remarks.iter().map(words).collect();
    Urdf {
        model: conclude(text, file, remarks, model),
        remarks: words,
    }
}

fn conclude(
    text: &str,
    file: &str,
    mut remarks: Vec<Remark>,
    model: Option<Model>,
) -> Result<Model, Faults> {
    remarks.sort_by_key(|r| r.byte);
    let lines = Lines::of(text);
    let place = |byte: usize| lines.line_column(text, byte);
    let errors: Vec<&Remark> = remarks.iter().filter(|r| r.code.is_some()).collect();
    if errors.is_empty()
        && let Some(mut model) = model
    {
        model.notes = remarks
            .iter()
            .map(|r| format!("line {}: {}: {}", place(r.byte).0, r.subject, r.problem))
            .collect();
        return Ok(model);
    }
    if errors.is_empty() {
        let (place, problem) = (Place::label(file), "there is no robot in it");
        let advice = "give a URDF file with links and joints";
        return Err(Faults::one("E0101", place, problem, advice));
    }
    let fault = |r: &&Remark| {
        let (line, column) = place(r.byte);
        let place = Place {
            line: line as u64,
            column: column as u64,
            ..Place::label(file).key(&r.subject)
        };
        let code = r.code.unwrap_or("E0120");
        Fault::new(code, place, &r.problem, &r.remedy).with_value(&r.value)
    };
    Err(Faults::sorted(errors.iter().map(fault).collect()))
}
