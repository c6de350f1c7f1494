//! Largest values of a motion: the demands of a manoeuvre on the vehicle.

use crate::case::Scenario;
use crate::channel_names::joint_unit;
use poinsot_dynamics::MotionSample;
use poinsot_formats::PeakFile;
use poinsot_model::Model;
use poinsot_spatial::UnitQuaternion;

/// Collects peaks sample by sample, in a fixed order.
#[derive(Debug, Clone, Default)]
pub struct Peaks {
    first: Option<UnitQuaternion>,
    values: Vec<f64>,
}

impl Peaks {
    /// Adds a sample.
    pub fn take(&mut self, sample: &MotionSample) {
        let first = self.first.get_or_insert(sample.R_NB);
        let base = [sample.w_NB_B.norm(), first.angle_to(&sample.R_NB)];
        let joints = sample
            .q
            .iter()
            .zip(&sample.rates)
            .zip(&sample.accelerations);
        let joints = joints.flat_map(|((q, rate), acceleration)| [*q, *rate, *acceleration]);
        let wheels = sample.wheel_speed.iter().zip(&sample.wheel_torque);
        let wheels = wheels.flat_map(|(speed, torque)| [*speed, *torque]);
        let now: Vec<f64> = base
            .into_iter()
            .chain(joints)
            .chain(wheels)
            .map(f64::abs)
            .collect();
        self.values.resize(now.len(), 0.0);
        for (largest, x) in self.values.iter_mut().zip(now) {
            *largest = largest.max(x);
        }
    }

    /// The peaks with names, and the impulse of every firing thruster.
    pub fn named(&self, model: &Model, scenario: &Scenario) -> Vec<PeakFile> {
        let mut names: Vec<(String, String)> = vec![
            ("body rate".to_owned(), "rad/s".to_owned()),
            ("turn from the first attitude".to_owned(), "rad".to_owned()),
        ];
        for joint in model.moving_joints() {
            let unit = joint_unit(joint);
            let own = [
                ("position", unit.to_owned()),
                ("rate", format!("{unit}/s")),
                ("acceleration", format!("{unit}/s2")),
            ];
            names.extend(own.map(|(word, unit)| (format!("{word} of {}", joint.name), unit)));
        }
        for wheel in &model.wheels {
            names.push((format!("speed of {}", wheel.name), "rad/s".to_owned()));
            names.push((format!("torque of {}", wheel.name), "N m".to_owned()));
        }
        let named = names.into_iter().zip(&self.values);
        let mut all: Vec<PeakFile> = named
            .map(|((what, unit), value)| PeakFile {
                what,
                unit,
                value: *value,
            })
            .collect();
        let end = scenario.times.last().unwrap_or(0.0);
        for (k, thruster) in model.thrusters.iter().enumerate() {
            let own = scenario.plan.firings.iter().filter(|f| f.thruster == k);
            let lengths = own.map(|f| f.force * (f.off.min(end) - f.on.max(0.0)).max(0.0));
            let impulse: f64 = lengths.sum();
            if impulse > 0.0 {
                all.push(PeakFile {
                    what: format!("impulse of {}", thruster.name),
                    unit: "N s".to_owned(),
                    value: impulse,
                });
            }
        }
        all
    }
}
