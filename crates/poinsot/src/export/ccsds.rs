//! Messages of CCSDS 504.0-B-2, keyword = value notation. The standard has no field for a mass centre.

use super::{Exported, Source, rendered, tensor};
use crate::error::Error;
use hifitime::Epoch;
use minijinja::context;
use poinsot_formats::BodyFile;
use std::time::SystemTime;

/// The attitude parameter message: inertia.
pub(super) fn apm(source: &Source) -> Result<Exported, Error> {
    let no_field = "not exported: mass and mass centre: an APM has no fields for them";
    Vehicle::new(source)?.message(source, "APM", no_field)
}

/// The attitude comprehensive message: mass if determined, and inertia.
pub(super) fn acm(source: &Source) -> Result<Exported, Error> {
    let no_field = "not exported: mass centre: an ACM has no field for it";
    let vehicle = Vehicle::new(source)?;
    let mut message = vehicle.message(source, "ACM", no_field)?;
    if vehicle.body.mass_kg.value.is_none() {
        let left_out = "not exported: WET_MASS: the mass is not determined";
        message.left_out.push(left_out.to_owned());
    }
    Ok(message)
}

/// The whole vehicle as one body, at the epoch of the estimate.
struct Vehicle<'a> {
    name: String,
    epoch: &'a str,
    scale: &'a str,
    body: &'a BodyFile,
    inertia: poinsot_spatial::Matrix3,
    joints: Vec<String>,
}

impl<'a> Vehicle<'a> {
    fn new(source: &Source<'a>) -> Result<Self, Error> {
        let e = source.estimate;
        let epoch = e.epoch.as_ref();
        let at = epoch.and_then(|epoch| Some((epoch.at.as_deref()?, epoch.scale.as_deref()?)));
        let (epoch, scale) = at.ok_or_else(|| {
            source.fault("a CCSDS message needs a date, and the times of the telemetry count from an unknown one", "declare `epoch` in the map of the telemetry")
        })?;
        let (body, joints) = match (e.bodies.len(), e.system.first()) {
            (1, _) => (e.bodies.first().map(|(_, b)| b), Vec::new()),
            (_, Some(system)) => {
                let joints = system.joint_positions.iter();
                let joints = joints.map(|(name, q)| format!("{name} = {q:?}"));
                (Some(&system.body), joints.collect())
            }
            _ => (None, Vec::new()),
        };
        let Some((body, inertia)) = body.and_then(|b| Some((b, tensor(b)?))) else {
            let why = "the inertia of the whole vehicle is not determined, but a CCSDS message requires it";
            return Err(source.fault(why, "identify with more data"));
        };
        Ok(Self {
            name: keyword_value(&e.model),
            epoch,
            scale,
            body,
            inertia,
            joints,
        })
    }

    fn message(&self, source: &Source, kind: &str, no_field: &str) -> Result<Exported, Error> {
        let mut comments = source.origin();
        comments.push(
            "Inertia about the mass centre of the whole vehicle, wheels included as if locked."
                .to_owned(),
        );
        comments.push(
            "IXY, IXZ and IYZ are elements of the tensor: IXY = -integral of x y dm.".to_owned(),
        );
        if !self.joints.is_empty() {
            comments.push(format!("Joint positions: {}", self.joints.join(", ")));
        }
        let comments: Vec<String> = comments.iter().map(|line| keyword_value(line)).collect();
        let element =
            |(name, at): (&'static str, (usize, usize))| (name, format!("{:?}", self.inertia[at]));
        let values = context! {
            kind,
            created => created(),
            name => self.name,
            epoch => self.epoch,
            scale => self.scale,
            comments,
            mass => self.body.mass_kg.value.map(|mass| format!("{mass:?}")),
            inertia => ELEMENTS.map(element),
        };
        Ok(Exported {
            text: rendered(include_str!("ccsds.txt"), values)?,
            no_field: vec![no_field.to_owned()],
            ..Exported::default()
        })
    }
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
    text.chars()
        .map(|c| if matches!(c, ' '..='~') { c } else { '?' })
        .collect()
}
