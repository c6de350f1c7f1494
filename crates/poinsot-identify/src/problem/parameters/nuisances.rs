//! Declared unknowns of sensors, actuators and environment.

use super::sensor_errors::ErrorGroup;
use super::{AXES, Parameters, UnknownKind};
use poinsot_dynamics::Tree;
use poinsot_model::{JointKind, Model, Nuisance, SensorKind};

impl Parameters {
    pub(super) fn add_nuisances(&mut self, model: &Model, tree: &Tree) {
        for (k, wheel) in model.wheels.iter().enumerate() {
            if wheel.estimate {
                let js = wheel.spin_inertia;
                let name = format!("{}.spin_inertia", wheel.name);
                self.push(UnknownKind::SpinInertia(k), name, "kg m2", js, js);
            }
        }
        for (k, thruster) in model.thrusters.iter().enumerate() {
            if thruster.scale != Nuisance::Known {
                let name = format!("{}.scale", thruster.name);
                self.push(UnknownKind::ThrusterScale(k), name, "1", 0.0, 1.0);
            }
        }
        self.add_sensor_errors(model);
        self.add_input_faults(model, tree);
        let around = &model.environment;
        let torque = UnknownKind::DisturbanceTorque;
        self.add_axes(
            around.disturbance_torque,
            torque,
            "environment",
            "torque",
            "N m",
        );
        self.add_axes(
            around.disturbance_torque_inertial,
            UnknownKind::InertialTorque,
            "environment",
            "torque_inertial",
            "N m",
        );
        self.add_axes(
            around.drag_torque,
            UnknownKind::DragTorque,
            "environment",
            "drag",
            "kg m2",
        );
    }

    fn add_axes(
        &mut self,
        declared: Nuisance,
        kind: fn(usize) -> UnknownKind,
        owner: &str,
        what: &str,
        unit: &'static str,
    ) {
        if declared != Nuisance::Known {
            for (k, axis) in AXES.iter().enumerate() {
                self.push(kind(k), format!("{owner}.{what}_{axis}"), unit, 0.0, 1.0);
            }
        }
    }

    /// Errors of every sensor of three axes, as declared.
    fn add_sensor_errors(&mut self, model: &Model) {
        for (sensor, of) in model.sensors.iter().enumerate() {
            for group in ErrorGroup::of(of.kind) {
                if (group.declared)(of) == Nuisance::Known {
                    continue;
                }
                for (error, name) in group.errors {
                    let kind = UnknownKind::Sensor {
                        sensor,
                        error: *error,
                    };
                    let name = format!("{}.{name}", of.name);
                    self.push(kind, name, group.unit(of.kind), 0.0, 1.0);
                }
            }
        }
    }

    /// Offsets and lags of the inputs, and tilts of wheels.
    fn add_input_faults(&mut self, model: &Model, tree: &Tree) {
        for sensor in &model.sensors {
            let coordinates: Vec<usize> = (0..tree.dof())
                .filter(|k| sensor.of.contains(&tree.coordinates[*k]))
                .collect();
            let lag = match sensor.kind {
                SensorKind::JointPosition => {
                    if sensor.bias != Nuisance::Known {
                        for &k in &coordinates {
                            let joint = &model.joints[tree.coordinates[k]];
                            let unit = match joint.kind {
                                JointKind::Prismatic => "m",
                                _ => "rad",
                            };
                            let name = format!("{}.offset", joint.name);
                            self.push(UnknownKind::JointOffset(k), name, unit, 0.0, 1.0);
                        }
                    }
                    UnknownKind::JointLag(coordinates)
                }
                SensorKind::WheelSpeed => UnknownKind::WheelLag(sensor.of.clone()),
                SensorKind::Thrust => UnknownKind::ThrusterLag(sensor.of.clone()),
                _ => continue,
            };
            self.add_lag(sensor.lag, lag, &sensor.name);
        }
        for (k, wheel) in model.wheels.iter().enumerate() {
            if wheel.misalignment != Nuisance::Known {
                for (i, about) in wheel.tilt_axes().iter().enumerate() {
                    let axis = (0..3).find(|a| about[*a] == 1.0);
                    let what = axis.map_or_else(|| format!("{}", i + 1), |a| AXES[a].to_owned());
                    let name = format!("{}.misalignment_{what}", wheel.name);
                    self.push(UnknownKind::WheelTilt(k, i), name, "rad", 0.0, 1.0);
                }
            }
        }
    }

    fn add_lag(&mut self, declared: Nuisance, kind: UnknownKind, owner: &str) {
        if declared != Nuisance::Known {
            self.push(kind, format!("{owner}.lag"), "s", 0.0, 1.0);
        }
    }
}
