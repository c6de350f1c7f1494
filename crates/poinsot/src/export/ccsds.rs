//! Messages of CCSDS 504.0-B-2, keyword = value notation. The standard has no field for a mass centre.

use super::{Exported, Source, tensor};
use crate::error::Error;
use hifitime::Epoch;
use poinsot_formats::BodyFile;
use std::fmt::Write as _;
use std::time::SystemTime;

/// The body frame of the message.
const FRAME: &str = "SC_BODY_1";
/// Required text if the international designator is not given.
const UNKNOWN: &str = "UNKNOWN";
const ORIGINATOR: &str = "POINSOT";

/// The attitude parameter message: inertia.
pub(super) fn apm(source: &Source) -> Result<Exported, Error> {
    let vehicle = Vehicle::new(source)?;
    let mut out = header("APM");
    let _ = writeln!(out, "OBJECT_NAME = {}", vehicle.name);
    let _ = writeln!(out, "OBJECT_ID = {UNKNOWN}");
    let _ = writeln!(out, "TIME_SYSTEM = {}", vehicle.scale);
    vehicle.comments(source, &mut out);
    let _ = writeln!(out, "EPOCH = {}\nINERTIA_START", vehicle.epoch);
    vehicle.inertia(&mut out);
    out.push_str("INERTIA_STOP\n");
    Ok(Exported {
        text: out,
        no_field: vec![
            "not exported: mass and mass centre: an APM has no fields for them".to_owned(),
        ],
        ..Exported::default()
    })
}

/// The attitude comprehensive message: mass and inertia.
pub(super) fn acm(source: &Source) -> Result<Exported, Error> {
    let vehicle = Vehicle::new(source)?;
    let mut out = header("ACM");
    let _ = writeln!(out, "META_START\nOBJECT_NAME = {}", vehicle.name);
    let _ = writeln!(out, "TIME_SYSTEM = {}", vehicle.scale);
    let _ = writeln!(
        out,
        "EPOCH_TZERO = {}\nMETA_STOP\nPHYS_START",
        vehicle.epoch
    );
    vehicle.comments(source, &mut out);
    let mut left_out = Vec::new();
    match vehicle.body.mass_kg.value {
        Some(mass) => {
            let _ = writeln!(out, "WET_MASS = {mass:?} [kg]");
        }
        None => left_out.push("not exported: WET_MASS: the mass is not determined".to_owned()),
    }
    vehicle.inertia(&mut out);
    out.push_str("PHYS_STOP\n");
    Ok(Exported {
        text: out,
        left_out,
        no_field: vec!["not exported: mass centre: an ACM has no field for it".to_owned()],
        ..Exported::default()
    })
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

    fn comments(&self, source: &Source, out: &mut String) {
        let mut lines = source.origin();
        lines.push(
            "Inertia about the mass centre of the whole vehicle, wheels included as if locked."
                .to_owned(),
        );
        lines.push(
            "IXY, IXZ and IYZ are elements of the tensor: IXY = -integral of x y dm.".to_owned(),
        );
        if !self.joints.is_empty() {
            lines.push(format!("Joint positions: {}", self.joints.join(", ")));
        }
        for line in lines {
            let _ = writeln!(out, "COMMENT {}", keyword_value(&line));
        }
    }

    fn inertia(&self, out: &mut String) {
        let _ = writeln!(out, "INERTIA_REF_FRAME = {FRAME}");
        let elements = [
            ("IXX", (0, 0)),
            ("IYY", (1, 1)),
            ("IZZ", (2, 2)),
            ("IXY", (0, 1)),
            ("IXZ", (0, 2)),
            ("IYZ", (1, 2)),
        ];
        for (name, at) in elements {
            let _ = writeln!(out, "{name} = {:?} [kg*m**2]", self.inertia[at]);
        }
    }
}

fn header(kind: &str) -> String {
    let seconds = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .map_or(0, |t| t.as_secs());
    let (y, month, d, h, min, s, _) = Epoch::from_unix_seconds(seconds as f64).to_gregorian_utc();
    format!(
        "CCSDS_{kind}_VERS = 2.0\nCREATION_DATE = {y:04}-{month:02}-{d:02}T{h:02}:{min:02}:{s:02}\nORIGINATOR = {ORIGINATOR}\n"
    )
}

/// Text allowed by the notation: printable ASCII on one line.
fn keyword_value(text: &str) -> String {
    text.chars()
        .map(|c| if matches!(c, ' '..='~') { c } else { '?' })
        .collect()
}
