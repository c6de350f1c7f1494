//! Proposes a map for an unknown column; it is never applied.

use crate::conventions::line;
use crate::{ColumnMap, Found, Kind, classify, recognise};
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

/// What the columns of a header may be, such as `wx [deg/s]`, `gyro_x_dps`, `rw1 (rpm)` or `t_ms`; without names that are
/// unknown, or standard names in SI.
///
/// ```
/// use poinsot_telemetry::suggestions;
///
/// let found = suggestions(&["wx [deg/s]".to_owned(), "Mode".to_owned()]);
/// assert_eq!(found[0].toml, r#"omega_x = { column = "wx [deg/s]", unit = "deg/s" }"#);
/// assert_eq!(found.len(), 1);
/// ```
pub fn suggestions(header: &[String]) -> Vec<Suggestion> {
    let found = recognise(header, &[]).channels.into_iter();
    let fits = |f: &Found| f.named && !matches!(f.kind, Kind::Firing | Kind::Pulse);
    let lines = found.filter(|f| fits(f) && classify(&f.channel).is_some());
    let all = lines.filter_map(|f| Some((header.get(f.column)?, f)));
    all.filter(|(column, f)| f.channel != **column)
        .map(|(column, f)| {
            let unit = f.unit.map(|unit| unit.symbol.to_owned());
            let map = ColumnMap::new(&f.channel, column, unit.as_deref().unwrap_or("?"));
            Suggestion {
                column: column.clone(),
                toml: line(&f.channel, &map),
                channel: f.channel,
                unit,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suggestion(column: &str) -> Option<Suggestion> {
        suggestions(&[column.to_owned()]).pop()
    }

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
            let s = suggestion(column).unwrap_or_else(|| panic!("{column}"));
            assert_eq!(
                (s.channel.as_str(), s.unit.as_deref()),
                (channel, unit),
                "{column}"
            );
        }
        assert_eq!(
            suggestion("wx [deg/s]").unwrap().toml,
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
            assert_eq!(suggestion(column), None, "{column}");
        }
    }
}
