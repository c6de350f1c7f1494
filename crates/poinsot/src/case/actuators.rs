//! `[[wheel_motion]]` and `[[firing]]` as motion of wheels and firings of thrusters.

use super::fault::did_you_mean;
use super::file::{FiringFile, WheelMotionFile};
use super::planner::Planner;
use poinsot_dynamics::{Firing, PiecewisePolynomial, WheelMotion};
use toml::Spanned;

impl Planner<'_> {
    pub(super) fn wheel_motion(
        &mut self,
        table: &WheelMotionFile,
        key: &str,
    ) -> Option<WheelMotion> {
        let word = table.interpolation.as_ref().map(|w| w.get_ref().as_str());
        let (values, torque) = match (&table.speed_rad_s, &table.torque_N_m) {
            (Some(speed), None) => (speed, false),
            (None, Some(torque)) => (torque, true),
            _ => {
                let problem = "a wheel needs either speed_rad_s or torque_N_m";
                self.refuse(
                    "E0507",
                    key,
                    table.wheel.span(),
                    problem,
                    "give one of the two",
                );
                return None;
            }
        };
        let build = match (word, torque) {
            (None | Some("linear"), false) | (Some("linear"), true) => PiecewisePolynomial::linear,
            (None | Some("constant"), true) => PiecewisePolynomial::steps,
            (Some("cubic_clamped"), false) => PiecewisePolynomial::cubic_clamped,
            (Some(_), _) => {
                let span = table.interpolation.as_ref().map_or(0..0, Spanned::span);
                let problem = "no such interpolation here";
                let remedy = if torque {
                    "use \"constant\" or \"linear\""
                } else {
                    "use \"linear\" or \"cubic_clamped\""
                };
                self.refuse(
                    "E0507",
                    &format!("{key}.interpolation"),
                    span,
                    problem,
                    remedy,
                );
                return None;
            }
        };
        let profile = build(table.time_s.get_ref(), values.get_ref());
        let profile = self.checked(profile, (&table.time_s, values), key)?;
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
            let problem = "speed_rad_s already says the initial speed";
            self.refuse("E0507", &key, x.span(), problem, "leave it out");
        }
        Some(WheelMotion::Speed(profile))
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
                let remedy = "let off_s lie after on_s";
                self.refuse("E0505", &key("off_s"), table.off_s.span(), problem, remedy);
            }
            if !force.is_finite() || force < 0.0 {
                let problem = "a thruster pushes along its force_direction only";
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
                let remedy = "let firings of one thruster not overlap";
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
