//! Proposes a map for an unknown column; it is never applied.

use crate::conventions::line;
use crate::{ColumnMap, Found, Kind, classify, recognise};

/// What the columns of a header may be, such as `wx [deg/s]`, `gyro_x_dps`, `rw1 (rpm)` or `t_ms`, as lines of `[telemetry.columns]`, with
/// `unit = "?"` where the unit must be stated; without names that are unknown, or standard names in SI.
///
/// ```
/// use poinsot_telemetry::suggestions;
///
/// let found = suggestions(&["wx [deg/s]".to_owned(), "Mode".to_owned()]);
/// assert_eq!(found, [r#"omega_x = { column = "wx [deg/s]", unit = "deg/s" }"#]);
/// ```
pub fn suggestions(header: &[String]) -> Vec<String> {
    let found = recognise(header, &[]).channels.into_iter();
    let fits = |f: &Found| f.named && !matches!(f.kind, Kind::Firing | Kind::Pulse);
    let found = found.filter(|f| fits(f) && classify(&f.channel).is_some());
    let all = found.filter_map(|f| Some((header.get(f.column)?, f)));
    let others = all.filter(|(column, f)| f.channel != **column);
    let lines = others.map(|(column, f)| {
        let unit = f.unit.map_or("?", |unit| unit.symbol);
        line(&f.channel, &ColumnMap::new(&f.channel, column, unit))
    });
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suggestion(column: &str) -> Option<String> {
        suggestions(&[column.to_owned()]).pop()
    }

    #[test]
    fn unit_headers_in_the_wild() {
        for (column, channel, unit) in [
            ("wx [deg/s]", "omega_x", "deg/s"),
            ("wx (rad/s)", "omega_x", "rad/s"),
            ("wy_dps", "omega_y", "deg/s"),
            ("Gyro Z", "omega_z", "?"),
            ("ax", "acc_x", "?"),
            ("t_s", "time_s", "s"),
            ("OBTS, sec", "time_s", "s"),
            ("timestamp [ns]", "time_s", "ns"),
            ("rw2 (rpm)", "wheel2_rad_s", "rpm"),
            ("RW1_H_Nms", "wheel1_rad_s", "N m s"),
            ("rw_momentum_3 [N m s]", "wheel3_rad_s", "N m s"),
            ("whl2_mom_mN_m_s", "wheel2_rad_s", "mN m s"),
            ("rw4_mNms", "wheel4_rad_s", "mN m s"),
            ("wheel_h_x_N_m_s", "wheel_x_rad_s", "N m s"),
            ("qw", "q_w", "?"),
            ("wz_rad_s", "omega_z", "rad/s"),
            ("joint3 [deg]", "joint3_rad", "deg"),
        ] {
            let line = format!(r#"{channel} = {{ column = "{column}", unit = "{unit}" }}"#);
            assert_eq!(suggestion(column), Some(line));
        }
        for column in [
            "Mode",
            "omega_x",
            "wheel1_rad_s",
            "rw1_rad_s",
            "i_meas1",
            "rw1_momentum",
            "h_total_x_Nms",
            "rw1_momentum_err_Nms",
            "",
        ] {
            assert_eq!(suggestion(column), None, "{column}");
        }
    }
}
