//! `[[wheel_motion]]` and `[[firing]]` as motion of wheels and firings of thrusters.

use super::planner::{Part, Planner};
use super::torques::{Build, OF_TORQUE};
use poinsot_dynamics::{Firing, PiecewisePolynomial, WheelMotion};
use poinsot_formats::case::{FiringFile, WheelMotionFile};

/// Suffix of wheel speed columns.
const SPEED: &str = "_rad_s";
const TORQUE: &str = "_Nm";
const OF_SPEED: [(&str, Build); 2] = [
    ("linear", PiecewisePolynomial::linear),
    ("cubic_clamped", PiecewisePolynomial::cubic_clamped),
];

impl Planner<'_> {
    pub(super) fn wheel_motion(
        &mut self,
        table: &WheelMotionFile,
        key: &str,
    ) -> Option<WheelMotion> {
        let usual = || format!("{}{SPEED}", table.wheel);
        let column = table.column.clone().unwrap_or_else(usual);
        let (torque, nodes) = match (&table.speed_rad_s, &table.torque_N_m, &table.file) {
            (Some(speed), None, None) => (false, Some(speed)),
            (None, Some(torque), None) => (true, Some(torque)),
            (None, None, Some(_)) => (column.ends_with(TORQUE), None),
            _ => {
                let problem = "a wheel needs exactly one of speed_rad_s, torque_N_m and file";
                return self.refused("E0507", key, problem, "give one of them");
            }
        };
        let possible = if torque { OF_TORQUE } else { OF_SPEED };
        let build = self.interpolation(table.interpolation.as_deref(), possible, key)?;
        let profile = match (nodes, &table.time_s, &table.file) {
            (None, None, Some(file)) => self.column(file, &column, &[SPEED, TORQUE], build, key)?,
            (Some(values), Some(time), _) if table.column.is_none() => {
                let name = if torque { "torque_N_m" } else { "speed_rad_s" };
                self.checked(build(time, values), key, name)?
            }
            (Some(_), None, _) => {
                return self.refused("E0507", key, "a table needs time_s", "add time_s = [...]");
            }
            _ => {
                let problem = "time_s belongs to a table, column to a file";
                return self.refused("E0507", key, problem, "leave it out");
            }
        };
        if torque {
            return Some(WheelMotion::Torque {
                initial_speed: table.initial_speed_rad_s.unwrap_or(0.0),
                torque: profile.starting_from(0.0),
            });
        }
        if table.initial_speed_rad_s.is_some() {
            let key = format!("{key}.initial_speed_rad_s");
            let problem = "speed_rad_s already gives the initial speed";
            self.refuse("E0507", &key, problem, "leave it out");
        }
        Some(WheelMotion::Speed(profile))
    }

    pub(super) fn firings(&mut self, tables: &[FiringFile]) -> Vec<Firing> {
        let mut firings: Vec<Firing> = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let key = |name: &str| format!("firing[{i}].{name}");
            let (on, off, force) = (table.on_s, table.off_s, table.force_N);
            if off <= on {
                let problem = "the firing ends before it begins";
                self.refuse("E0505", &key("off_s"), problem, "set off_s after on_s");
            }
            let Some(thruster) = self.part(Part::Thruster, &table.thruster, &key("thruster"))
            else {
                continue;
            };
            let same = |f: &&Firing| f.thruster == thruster && f.on < off && on < f.off;
            if firings.iter().any(|f| same(&f)) {
                let problem = "the thruster already fires at that time";
                let remedy = "separate the firings of one thruster";
                self.refuse("E0507", &key("on_s"), problem, remedy);
            }
            firings.push(Firing {
                thruster,
                on,
                off,
                force,
            });
        }
        firings
    }
}
