//! Unknowns of sensors, actuators and surroundings, as the model declares them.

use super::{AXES, Parameters, UnknownKind};
use crate::point_sensor::Fault;
use poinsot_dynamics::Tree;
use poinsot_model::{JointKind, Model, Nuisance, SensorKind};

/// Pairs of axes by the one that is left out.
const PAIRS: [&str; 3] = ["yz", "xz", "xy"];

/// Whether a fault of an instrument is declared, the fault of an axis, its name and unit.
type Declared = (Nuisance, fn(usize) -> Fault, &'static str, &'static str);

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
        if let Some(gyro) = model.sensors_of(SensorKind::Gyro).next() {
            let name = gyro.name.as_str();
            self.add_axes(gyro.bias, UnknownKind::GyroBias, name, "bias", "rad/s");
            self.add_axes(gyro.scale, UnknownKind::GyroScale, name, "scale", "1");
            let turned = UnknownKind::GyroMisalignment;
            self.add_axes(gyro.misalignment, turned, name, "misalignment", "rad");
            if gyro.nonorthogonality != Nuisance::Known {
                for (k, pair) in PAIRS.iter().enumerate() {
                    let name = format!("{name}.nonorthogonality_{pair}");
                    self.push(UnknownKind::GyroShear(k), name, "rad", 0.0, 1.0);
                }
            }
            self.add_lag(gyro.lag, UnknownKind::GyroLag, name);
        }
        if let Some(tracker) = model.sensors_of(SensorKind::Attitude).next() {
            self.add_lag(tracker.lag, UnknownKind::AttitudeLag, &tracker.name);
        }
        self.add_instruments(model);
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

    /// Faults of accelerometers and of velocity increments, as declared.
    fn add_instruments(&mut self, model: &Model) {
        for (sensor, of) in model.sensors.iter().enumerate() {
            let unit = match of.kind {
                SensorKind::Accelerometer => "m/s2",
                SensorKind::VelocityIncrement => "m/s",
                _ => continue,
            };
            let triples: [Declared; 3] = [
                (of.bias, Fault::Bias, "bias", unit),
                (of.scale, Fault::Scale, "scale", "1"),
                (of.misalignment, Fault::Misalignment, "misalignment", "rad"),
            ];
            for (declared, fault, what, unit) in triples {
                if declared != Nuisance::Known {
                    for (k, axis) in AXES.iter().enumerate() {
                        let kind = UnknownKind::Instrument {
                            sensor,
                            fault: fault(k),
                        };
                        self.push(kind, format!("{}.{what}_{axis}", of.name), unit, 0.0, 1.0);
                    }
                }
            }
            let fault = Fault::Lag;
            self.add_lag(of.lag, UnknownKind::Instrument { sensor, fault }, &of.name);
        }
    }

    /// Offsets and lags of what drives the vehicle, lags of position and velocity, and tilts of wheels.
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
        for (kind, lag) in [
            (SensorKind::Velocity, UnknownKind::VelocityLag),
            (SensorKind::Position, UnknownKind::PositionLag),
        ] {
            if let Some(sensor) = model.sensors_of(kind).find(|s| s.body == 0) {
                self.add_lag(sensor.lag, lag, &sensor.name);
            }
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
