//! Proposes a map for an unknown column; it is never applied.

use crate::{classify, parse_unit};
use schemars::JsonSchema;
use serde::Serialize;

/// A proposed line of `[telemetry.columns]`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Suggestion {
    /// The column as the file writes it.
    pub column: String,
    /// The standard channel it may hold.
    pub channel: String,
    /// The unit found in its header; `None` where the header has none and it must be stated.
    pub unit: Option<String>,
    /// The line to write, `unit = "?"` where the unit must be stated.
    pub toml: String,
}

/// A standard channel for a column such as `wx [deg/s]`, `gyro_x_dps`, `rw1 (rpm)` or `t_ms`. `None` if the name is
/// unknown, or already a standard name in SI.
///
/// ```
/// use poinsot_telemetry::suggest;
///
/// let line = suggest("wx [deg/s]").unwrap().toml;
/// assert_eq!(line, r#"omega_x = { column = "wx [deg/s]", unit = "deg/s" }"#);
/// ```
pub fn suggest(column: &str) -> Option<Suggestion> {
    let (stem, unit) = split_unit(column);
    let channel = channel_of(&stem, unit.as_deref())?;
    let is_vector = classify(&channel).is_some_and(|c| !c.frame.is_empty());
    if channel == column || (classify(column).is_some() && !is_vector) {
        return None;
    }
    let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
    let key = if channel.contains('.') {
        quoted(&channel)
    } else {
        channel.clone()
    };
    let toml = format!(
        "{key} = {{ column = {}, unit = {} }}",
        quoted(column),
        quoted(unit.as_deref().unwrap_or("?"))
    );
    Some(Suggestion {
        column: column.to_owned(),
        channel,
        unit,
        toml,
    })
}

/// Suffixes that name a unit, longest first, with the unit.
const UNIT_SUFFIXES: [(&str, &str); 19] = [
    ("_rad_s2", "rad/s2"),
    ("_rad_s", "rad/s"),
    ("_radps", "rad/s"),
    ("_deg_s", "deg/s"),
    ("_degps", "deg/s"),
    ("_dps", "deg/s"),
    ("_mps2", "m/s2"),
    ("_m_s2", "m/s2"),
    ("_mps", "m/s"),
    ("_m_s", "m/s"),
    ("_rpm", "rpm"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_mm", "mm"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_ns", "ns"),
    ("_s", "s"),
    ("_m", "m"),
];

/// The name without its unit, lower case with `_` for blanks, and the unit if known.
fn split_unit(column: &str) -> (String, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((stem, rest)) = column.split_once(open)
            && let Some((inside, _)) = rest.split_once(close)
            && let Ok(unit) = parse_unit(inside)
        {
            return (plain(stem), Some(unit.symbol.to_owned()));
        }
    }
    if let Some((stem, last)) = column.rsplit_once(", ")
        && let Ok(unit) = parse_unit(last)
    {
        return (plain(stem), Some(unit.symbol.to_owned()));
    }
    let name = plain(column);
    for (suffix, unit) in UNIT_SUFFIXES {
        if let Some(stem) = name.strip_suffix(suffix).filter(|s| !s.is_empty()) {
            return (stem.to_owned(), Some(unit.to_owned()));
        }
    }
    (name, None)
}

fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '-', '.'], "_")
}

/// Common stems of vector columns, with the standard prefix.
const VECTOR_STEMS: [(&str, &[&str]); 4] = [
    (
        "omega",
        &[
            "w",
            "omega",
            "gyro",
            "gyr",
            "g",
            "rate",
            "ang_vel",
            "angular_velocity",
            "p_q_r",
        ],
    ),
    (
        "acc",
        &["a", "acc", "accel", "acceleration", "specific_force", "f"],
    ),
    ("v", &["vel", "velocity", "v"]),
    ("r", &["pos", "position", "p", "r"]),
];

fn channel_of(stem: &str, unit: Option<&str>) -> Option<String> {
    if matches!(
        stem,
        "t" | "time" | "timestamp" | "epoch" | "seconds" | "obt" | "obts" | "met"
    ) {
        return Some("time_s".into());
    }
    if let Some(component) = stem
        .strip_prefix("quaternion_")
        .or_else(|| stem.strip_prefix("quat_"))
        .or_else(|| stem.strip_prefix("q_"))
        .or_else(|| stem.strip_prefix('q'))
        && matches!(component, "x" | "y" | "z" | "w")
    {
        return Some(format!("q_{component}"));
    }
    let axis = stem
        .chars()
        .next_back()
        .filter(|c| matches!(c, 'x' | 'y' | 'z'));
    if let Some(axis) = axis {
        let prefix = stem.trim_end_matches(axis).trim_end_matches('_');
        if let Some((standard, _)) = VECTOR_STEMS
            .iter()
            .find(|(_, stems)| stems.contains(&prefix))
        {
            return Some(format!("{standard}_{axis}"));
        }
    }
    let letters = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = stem.get(letters.len()..).unwrap_or_default();
    let wheel = ["wheel", "rw", "mrw", "reaction_wheel", "momentum_wheel"];
    if wheel.contains(&letters.trim_end_matches('_'))
        && matches!(unit, None | Some("rpm" | "rad/s" | "deg/s"))
    {
        return Some(format!("wheel{digits}_rad_s"));
    }
    let joint = ["joint", "jnt", "theta"];
    if joint.contains(&letters.trim_end_matches('_')) {
        return match unit {
            None | Some("rad" | "deg") => Some(format!("joint{digits}_rad")),
            Some("rad/s" | "deg/s") => Some(format!("joint{digits}_rad_s")),
            _ => None,
        };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_headers_in_the_wild() {
        for (column, channel, unit) in [
            ("wx [deg/s]", "omega_x", Some("deg/s")),
            ("wx (rad/s)", "omega_x", Some("rad/s")),
            ("wy_dps", "omega_y", Some("deg/s")),
            ("Gyro Z", "omega_z", None),
            ("ax", "acc_x", None),
            ("t_s", "time_s", Some("s")),
            ("OBTS, sec", "time_s", Some("s")),
            ("timestamp [ns]", "time_s", Some("ns")),
            ("rw2 (rpm)", "wheel2_rad_s", Some("rpm")),
            ("qw", "q_w", None),
            ("wz_rad_s", "omega_z", Some("rad/s")),
            ("joint3 [deg]", "joint3_rad", Some("deg")),
        ] {
            let s = suggest(column).unwrap_or_else(|| panic!("{column}"));
            assert_eq!(
                (s.channel.as_str(), s.unit.as_deref()),
                (channel, unit),
                "{column}"
            );
        }
        assert_eq!(
            suggest("wx [deg/s]").unwrap().toml,
            "omega_x = { column = \"wx [deg/s]\", unit = \"deg/s\" }"
        );
        for column in [
            "Mode",
            "omega_x",
            "wheel1_rad_s",
            "rw1_rad_s",
            "i_meas1",
            "",
        ] {
            assert_eq!(suggest(column), None, "{column}");
        }
    }
}
