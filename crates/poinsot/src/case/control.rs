//! `[control]`: attitude feedback by the wheels of the base.

use super::planner::{Part, Planner};
use poinsot_dynamics::{AttitudeControl, Plan, Target, WheelDrive, WheelLimits, composite};
use poinsot_dynamics::{Kinematics, WheelMotion};
use poinsot_formats::case::{CaseFile, ControlFile, ControlWheelFile};
use poinsot_spatial::Matrix3;

impl Planner<'_> {
    /// The plan of a case with a controller: locked joints, and all wheels under the law.
    pub fn control(&mut self, file: &CaseFile) -> Option<Plan> {
        let given = file.control.as_ref()?;
        let absent = [
            ("joint_motion", file.joint_motion.is_empty()),
            ("joint_torque", file.joint_torque.is_empty()),
            ("initial.joint", file.initial.joint.is_empty()),
        ];
        for (key, _) in absent.into_iter().filter(|(_, is_absent)| !is_absent) {
            let problem = "the simulation does not support this with [control]: joints are locked";
            let remedy = "take it out, or prescribe wheel speeds with [[wheel_motion]]";
            self.refuse("E0508", key, problem, remedy);
        }
        if !file.wheel_motion.is_empty() {
            let problem = "the controller already drives the wheels";
            let remedy = "take either [control] or the [[wheel_motion]] tables out";
            self.refuse("E0507", "wheel_motion", problem, remedy);
        }
        let mut joints = self.model.joints.iter();
        if let Some(joint) = joints.find(|j| j.is_passive()) {
            let problem = format!(
                "joint \"{}\" has a spring and damper, and the simulation does not support this with [control]: joints are locked",
                joint.name
            );
            let remedy = "lock the joint by locked_at_rad or locked_at_m, or prescribe wheel speeds with [[wheel_motion]]";
            self.refuse("E0508", "control", problem, remedy);
        }
        Some(Plan {
            control: Some(self.law(given)),
            wheels: self.wheels(given),
            firings: self.firings(&file.firing),
            ..Plan::hold(self.model)
        })
    }

    fn law(&mut self, file: &ControlFile) -> AttitudeControl {
        let (proportional, derivative) = self.gains(file);
        let drive = match file.drive.as_deref() {
            Some("acceleration") => WheelDrive::Acceleration,
            _ => WheelDrive::Torque,
        };
        AttitudeControl {
            proportional,
            derivative,
            targets: self.targets(file),
            period: file.period_s,
            drive,
        }
    }

    /// Attitudes to hold, each from its start time.
    fn targets(&mut self, file: &ControlFile) -> Vec<Target> {
        let mut targets: Vec<Target> = Vec::new();
        for (i, target) in file.target.iter().enumerate() {
            let key = |name: &str| format!("control.target[{i}].{name}");
            let time = target.time_s;
            if targets.last().is_some_and(|last| last.time >= time) {
                let problem = "the times of the targets must increase";
                self.refuse("E0506", &key("time_s"), problem, "sort them");
            }
            let R_NB = self.attitude(target.q_xyzw, &key("q_xyzw"));
            targets.extend(R_NB.map(|R_NB| Target { time, R_NB }));
        }
        targets
    }

    /// Limits and initial speed of every wheel, rad/s.
    fn wheels(&mut self, file: &ControlFile) -> Vec<WheelMotion> {
        let free = WheelMotion::Controlled {
            initial_speed: 0.0,
            limits: WheelLimits::default(),
        };
        let mut wheels = vec![free; self.model.wheels.len()];
        for (i, table) in file.wheel.iter().enumerate() {
            let key = format!("control.wheel[{i}].wheel");
            if let Some(k) = self.part(Part::Wheel, &table.wheel, &key) {
                wheels[k] = WheelMotion::Controlled {
                    initial_speed: table.initial_speed_rad_s.unwrap_or(0.0),
                    limits: limits_of(table),
                };
            }
        }
        wheels
    }

    /// Gains as given, or as in Table 1 of Kim, Choi, Oh 2010: `2 wn^2 I` and `2 zeta wn I` with the inertia of the
    /// model.
    fn gains(&mut self, file: &ControlFile) -> (Matrix3, Matrix3) {
        let matrix = |m: &[[f64; 3]; 3]| Matrix3::from_fn(|i, j| m[i][j]);
        match (
            &file.proportional_N_m,
            &file.derivative_N_m_s,
            file.natural_frequency_rad_s,
            file.damping_ratio,
        ) {
            (Some(p), Some(d), None, None) => (matrix(p), matrix(d)),
            (None, None, Some(wn), Some(zeta)) => {
                let I = self.locked_inertia();
                (I * (2.0 * wn * wn), I * (2.0 * zeta * wn))
            }
            _ => {
                let problem = "the controller needs two gains";
                let remedy = "give proportional_N_m and derivative_N_m_s (3 x 3), or a positive natural_frequency_rad_s and damping_ratio";
                self.refuse("E0507", "control", problem, remedy);
                (Matrix3::zeros(), Matrix3::zeros())
            }
        }
    }

    /// Inertia of the vehicle about its mass centre, with joints and wheels locked.
    fn locked_inertia(&self) -> Matrix3 {
        let tree = &self.tree;
        let locked = (0..tree.dof()).map(|k| self.joint(k).standing_at());
        let kinematics = Kinematics::at(tree, &locked.collect::<Vec<_>>());
        composite(&self.model.nominal_parameters(), &kinematics).I_SScm_B()
    }
}

fn limits_of(table: &ControlWheelFile) -> WheelLimits {
    let none = WheelLimits::default();
    WheelLimits {
        torque: table.max_torque_N_m.unwrap_or(none.torque),
        speed: table.max_speed_rad_s.unwrap_or(none.speed),
        viscous: table.viscous_N_m_s.unwrap_or(none.viscous),
        coulomb: table.coulomb_N_m.unwrap_or(none.coulomb),
    }
}
