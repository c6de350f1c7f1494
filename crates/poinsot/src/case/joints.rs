//! `[[joint_motion]]` as motion of a joint.

use super::planner::Planner;
use crate::channel_names::joint_unit;
use poinsot_dynamics::{Fourier, JointMotion};
use poinsot_formats::case::JointMotionFile;
use serde::Serialize;
use serde_json::Value;

/// Ends of the keys of a revolute and of a prismatic joint.
const OF_KINDS: [[&str; 2]; 5] = [
    ["torque_N_m", "force_N"],
    ["_N_m", "_N"],
    ["_rad_s2", "_m_s2"],
    ["_rad_s", "_m_s"],
    ["_rad", "_m"],
];

impl Planner<'_> {
    /// Whether a key of the other type of joint is given; it is refused, with the key to use.
    pub(super) fn other_unit(&mut self, joint: usize, key: &str, table: &impl Serialize) -> bool {
        let slides = self.joint(joint).slides();
        let Ok(Value::Object(keys)) = serde_json::to_value(table) else {
            return false;
        };
        let mut given = keys.iter().filter(|(_, value)| !value.is_null());
        let wrong = given.find_map(|(name, _)| {
            let mut ends = OF_KINDS.iter().map(|[turning, sliding]| match slides {
                true => (turning, sliding),
                false => (sliding, turning),
            });
            ends.find_map(|(other, own)| {
                let wanted = format!("{}{own}", name.strip_suffix(*other)?);
                keys.contains_key(&wanted).then_some((name, wanted))
            })
        });
        let Some((name, wanted)) = wrong else {
            return false;
        };
        let problem = match slides {
            true => "a prismatic joint moves in metres and newtons",
            false => "a revolute joint moves in radians and newton metres",
        };
        let key = format!("{key}.{name}");
        self.refuse("E0507", &key, problem, format!("use {wanted}"));
        true
    }

    pub(super) fn joint_motion(
        &mut self,
        table: &JointMotionFile,
        joint: usize,
        key: &str,
    ) -> Option<JointMotion> {
        if self.other_unit(joint, key, table) {
            return None;
        }
        if table.interpolation == "fourier" {
            return fourier(table);
        }
        let position = table.position_rad.as_ref().or(table.position_m.as_ref());
        let (Some(time), Some(position)) = (&table.time_s, position) else {
            let problem = "time_s and position are needed";
            let remedy = "add time_s = [...] and position_rad = [...] (prismatic: position_m)";
            return self.refused("E0502", key, problem, remedy);
        };
        let motion = match table.interpolation.as_str() {
            "quintic_rest" => JointMotion::quintic_rest,
            _ => JointMotion::cubic_clamped,
        };
        let name = format!("position_{}", joint_unit(self.joint(joint)));
        self.checked(motion(time, position), key, &name)
    }
}

fn fourier(table: &JointMotionFile) -> Option<JointMotion> {
    let list = |rad: &Option<Vec<f64>>, m: &Option<Vec<f64>>| {
        rad.as_ref().or(m.as_ref()).cloned().unwrap_or_default()
    };
    let fourier = Fourier {
        offset: table.offset_rad.or(table.offset_m).unwrap_or(0.0),
        base_frequency_hz: table.base_frequency_hz?,
        sine: list(&table.sine_rad, &table.sine_m),
        cosine: list(&table.cosine_rad, &table.cosine_m),
    };
    Some(JointMotion::Fourier(fourier))
}
