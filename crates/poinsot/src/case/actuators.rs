//! `[[wheel_motion]]` and `[[firing]]` as motion of wheels and firings of thrusters.

use super::fault::did_you_mean;
use super::planner::Planner;
use super::torques::Build;
use poinsot_dynamics::{Firing, PiecewisePolynomial, WheelMotion};
use poinsot_formats::case::{FiringFile, Placed, WheelMotionFile};

/// Suffix of wheel speed columns.
const SPEED: &str = "_rad_s";
const TORQUE: &str = "_Nm";

impl Planner<'_> {
    pub(super) fn wheel_motion(
        &mut self,
        table: &WheelMotionFile,
        key: &str,
    ) -> Option<WheelMotion> {
        let wrong = |planner: &mut Self, problem: &str, remedy: &str| {
            planner.refuse("E0507", key, table.wheel.span(), problem, remedy);
            None
        };
        let column = match &table.column {
            Some(column) => column.get_ref().clone(),
            None => format!("{}{SPEED}", table.wheel.get_ref()),
        };
        let (torque, nodes) = match (&table.speed_rad_s, &table.torque_N_m, &table.file) {
            (Some(speed), None, None) => (false, Some(speed)),
            (None, Some(torque), None) => (true, Some(torque)),
            (None, None, Some(_)) => (column.ends_with(TORQUE), None),
            _ => {
                let problem = "a wheel needs exactly one of speed_rad_s, torque_N_m and file";
                return wrong(self, problem, "give one of them");
            }
        };
        let build = self.wheel_interpolation(table, torque, key)?;
        let profile = match (nodes, &table.time_s, &table.file) {
            (None, None, Some(file)) => self.column(file, &column, &[SPEED, TORQUE], build, key)?,
            (Some(values), Some(time), _) if table.column.is_none() => {
                let profile = build(time.get_ref(), values.get_ref());
                self.checked(profile, (time, values), key)?
            }
            (Some(_), None, _) => return wrong(self, "a table needs time_s", "add time_s = [...]"),
            _ => {
                let problem = "time_s belongs to a table, column to a file";
                return wrong(self, problem, "leave it out");
            }
        };
        let initial = table.initial_speed_rad_s.as_ref();
        if torque {
            let initial_speed = initial.map_or(0.0, |x| *x.get_ref());
            if !initial_speed.is_finite() {
                let problem = "the initial speed is not finite";
                self.refuse(
                    "E0505",
                    key,
                    table.wheel.span(),
                    problem,
                    "give a finite number",
                );
            }
            return Some(WheelMotion::Torque {
                initial_speed,
                torque: profile.starting_from(0.0),
            });
        }
        if let Some(x) = initial {
            let key = format!("{key}.initial_speed_rad_s");
            let problem = "speed_rad_s already gives the initial speed";
            self.refuse("E0507", &key, x.span(), problem, "leave it out");
        }
        Some(WheelMotion::Speed(profile))
    }

    fn wheel_interpolation(
        &mut self,
        table: &WheelMotionFile,
        torque: bool,
        key: &str,
    ) -> Option<Build> {
        let given = table.interpolation.as_ref();
        Some(match (given.map(|w| w.get_ref().as_str()), torque) {
            (None | Some("linear"), false) | (Some("linear"), true) => PiecewisePolynomial::linear,
            (None | Some("constant"), true) => PiecewisePolynomial::steps,
            (Some("cubic_clamped"), false) => PiecewisePolynomial::cubic_clamped,
            (Some(_), _) => {
                let problem = "no such interpolation here";
                let remedy = match torque {
                    true => "use \"constant\" or \"linear\"",
                    false => "use \"linear\" or \"cubic_clamped\"",
                };
                let key = format!("{key}.interpolation");
                let span = given.map_or(0..0, Placed::span);
                self.refuse("E0507", &key, span, problem, remedy);
                return None;
            }
        })
    }

    pub(super) fn firings(&mut self, tables: &[FiringFile]) -> Vec<Firing> {
        let mut firings: Vec<Firing> = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let key = |name: &str| format!("firing[{i}].{name}");
            let name = table.thruster.get_ref();
            let (on, off) = (*table.on_s.get_ref(), *table.off_s.get_ref());
            let force = *table.force_N.get_ref();
            if !on.is_finite() || !off.is_finite() || off <= on {
                let problem = "the firing ends before it begins, or is not finite";
                let remedy = "set off_s after on_s";
                self.refuse("E0505", &key("off_s"), table.off_s.span(), problem, remedy);
            }
            if !force.is_finite() || force < 0.0 {
                let problem = "a thruster force acts along its force_direction only";
                let remedy = "give a finite force that is not negative";
                self.refuse(
                    "E0505",
                    &key("force_N"),
                    table.force_N.span(),
                    problem,
                    remedy,
                );
            }
            let Some(thruster) = self.model.thruster(name) else {
                let names = self.model.thrusters.iter().map(|t| t.name.as_str());
                let remedy = did_you_mean(name, names);
                self.unknown("thruster", &key("thruster"), &table.thruster, remedy);
                continue;
            };
            let same = |f: &&Firing| f.thruster == thruster && f.on < off && on < f.off;
            if firings.iter().any(|f| same(&f)) {
                let problem = "the thruster already fires at that time";
                let remedy = "separate the firings of one thruster";
                self.refuse("E0507", &key("on_s"), table.on_s.span(), problem, remedy);
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
