//! Messages of CCSDS 504.0-B-2, keyword = value notation. The standard has no field for a mass centre.

use super::{Exported, Source, rendered, tensor};
use crate::error::Error;
use hifitime::Epoch;
use minijinja::context;
use poinsot_formats::{BodyFile, EstimateFile};
use std::time::SystemTime;

/// The attitude parameter message: inertia.
pub(super) fn apm(source: &Source) -> Result<Exported, Error> {
    let no_field = "not exported: mass and mass centre: an APM has no fields for them";
    message(source, "APM", no_field)
}

/// The attitude comprehensive message: mass if determined, and inertia.
pub(super) fn acm(source: &Source) -> Result<Exported, Error> {
    let no_field = "not exported: mass centre: an ACM has no field for it";
    let mut message = message(source, "ACM", no_field)?;
    let (body, _) = whole(source.estimate);
    if body.is_some_and(|body| body.mass_kg.value.is_none()) {
        let left_out = "not exported: WET_MASS: the mass is not determined";
        message.left_out.push(left_out.to_owned());
    }
    Ok(message)
}

/// The whole vehicle as one body, and the positions of its joints.
fn whole(e: &EstimateFile) -> (Option<&BodyFile>, Vec<String>) {
    match (e.bodies.len(), e.system.first()) {
        (1, _) => (e.bodies.first().map(|(_, b)| b), Vec::new()),
        (_, Some(system)) => {
            let joints = system.joint_positions.iter();
            let joints = joints.map(|(name, q)| format!("{name} = {q:?}"));
            (Some(&system.body), joints.collect())
        }
        _ => (None, Vec::new()),
    }
}

/// The message at the epoch of the estimate.
fn message(source: &Source, kind: &str, no_field: &str) -> Result<Exported, Error> {
    let e = source.estimate;
    let epoch = e.epoch.as_ref();
    let at = epoch.and_then(|epoch| Some((epoch.at.as_deref()?, epoch.scale.as_deref()?)));
    let (epoch, scale) = at.ok_or_else(|| {
        source.fault("a CCSDS message needs a date, and the times of the telemetry count from an unknown one", "declare `epoch` in the map of the telemetry")
    })?;
    let (body, joints) = whole(e);
    let Some((body, inertia)) = body.and_then(|b| Some((b, tensor(b)?))) else {
        let why =
            "the inertia of the whole vehicle is not determined, but a CCSDS message requires it";
        return Err(source.fault(why, "identify with more data"));
    };
    let element = |(name, at): (&'static str, (usize, usize))| (name, format!("{:?}", inertia[at]));
    let values = context! {
        kind,
        created => created(),
        name => keyword_value(&e.model),
        epoch,
        scale,
        comments => comments(source, &joints),
        mass => body.mass_kg.value.map(|mass| format!("{mass:?}")),
        inertia => ELEMENTS.map(element),
    };
    Ok(Exported {
        text: rendered(include_str!("ccsds.txt"), values)?,
        no_field: vec![no_field.to_owned()],
        ..Exported::default()
    })
}

/// Where the numbers come from and what they are about, one line each.
fn comments(source: &Source, joints: &[String]) -> Vec<String> {
    let mut comments = source.origin();
    let about = [
        "Inertia about the mass centre of the whole vehicle, wheels included as if locked.",
        "IXY, IXZ and IYZ are elements of the tensor: IXY = -integral of x y dm.",
    ];
    comments.extend(about.map(str::to_owned));
    if !joints.is_empty() {
        comments.push(format!("Joint positions: {}", joints.join(", ")));
    }
    comments.iter().map(|line| keyword_value(line)).collect()
}

/// Elements of the tensor in the order of a message.
const ELEMENTS: [(&str, (usize, usize)); 6] = [
    ("IXX", (0, 0)),
    ("IYY", (1, 1)),
    ("IZZ", (2, 2)),
    ("IXY", (0, 1)),
    ("IXZ", (0, 2)),
    ("IYZ", (1, 2)),
];

/// The time now, UTC.
fn created() -> String {
    let seconds = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .map_or(0, |t| t.as_secs());
    let (y, month, d, h, min, s, _) = Epoch::from_unix_seconds(seconds as f64).to_gregorian_utc();
    format!("{y:04}-{month:02}-{d:02}T{h:02}:{min:02}:{s:02}")
}

/// Text allowed by the notation: printable ASCII on one line.
fn keyword_value(text: &str) -> String {
    text.replace(|c| !matches!(c, ' '..='~'), "?")
}
