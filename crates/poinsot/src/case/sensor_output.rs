//! Sample rate and errors of the sensors in a case.

use super::fault::did_you_mean;
use super::planner::Planner;
use poinsot_dynamics::SensorError;
use poinsot_formats::case::{OutputFile, SensorOutputFile};
use poinsot_identify::ErrorGroup;
use poinsot_model::{ErrorKey, Sensor};

/// Sample rate and errors of one sensor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SensorOutput {
    /// Rows per sample.
    pub every: usize,
    /// Bias in sensor axes, if given; otherwise random or zero.
    pub bias: Option<Vec<f64>>,
    /// Relative error of each joint, wheel or thruster, if given; of a sensor with axes it is among the errors.
    pub scales: Option<Vec<f64>>,
    /// Scale, misalignment, nonorthogonality and lag, in sensor axes.
    pub errors: Vec<(SensorError, f64)>,
}

/// One entry per sensor of the model.
pub(super) fn sensor_outputs(planner: &mut Planner, output: &OutputFile) -> Vec<SensorOutput> {
    let model = planner.model;
    let usual = SensorOutput {
        every: 1,
        ..SensorOutput::default()
    };
    let mut outputs = vec![usual; model.sensors.len()];
    for (i, table) in output.sensor.iter().enumerate() {
        let key = format!("output.sensor[{i}]");
        let name = &table.name;
        let found: Vec<usize> = (0..model.sensors.len())
            .filter(|k| model.sensors[*k].name == *name)
            .collect();
        let [k] = found.as_slice() else {
            let names = model.sensors.iter().map(|s| s.name.as_str());
            let (problem, remedy) = match found.len() {
                0 => (
                    "the model has no sensor of this name".to_owned(),
                    did_you_mean(name, names),
                ),
                n => (
                    format!("{n} sensors of the model have this name"),
                    "give them different names in the model".to_owned(),
                ),
            };
            planner.refuse("E0504", &format!("{key}.name"), problem, remedy);
            continue;
        };
        if let Some(rate) = table.rate_hz {
            let ratio = output.rate_hz / rate;
            let every = ratio.round();
            if !(1.0..1e9).contains(&every) || (ratio - every).abs() > 1e-9 * every {
                let problem = "the sensor's rate does not divide the output rate";
                let remedy = "choose output.rate_hz as a multiple of every sensor's rate";
                planner.refuse("E0505", &format!("{key}.rate_hz"), problem, remedy);
            } else {
                outputs[*k].every = every as usize;
            }
        }
        let sensor = &model.sensors[*k];
        outputs[*k].bias = planner.bias(table, sensor, &key);
        // Relative errors of a sensor of joints, wheels or thrusters.
        let scale = table.scale.as_ref().filter(|_| sensor.kind.is_scalar());
        let here = format!("{key}.scale");
        outputs[*k].scales = scale.and_then(|scale| planner.of_sensor(&here, scale, sensor));
        outputs[*k].errors = planner.errors(table, sensor, &key);
    }
    outputs
}

impl Planner<'_> {
    /// Errors given for a sensor; those not defined for its kind are faults.
    fn errors(
        &mut self,
        table: &SensorOutputFile,
        sensor: &Sensor,
        key: &str,
    ) -> Vec<(SensorError, f64)> {
        let scale = table.scale.clone().filter(|_| !sensor.kind.is_scalar());
        let lag = table.lag_s.map(|lag| vec![lag]);
        let turn = table.misalignment_rad.map(|v| v.to_vec());
        let shear = table.nonorthogonality_rad.map(|v| v.to_vec());
        let given = [
            (ErrorKey::Scale, "scale", scale),
            (ErrorKey::Misalignment, "misalignment_rad", turn),
            (ErrorKey::Nonorthogonality, "nonorthogonality_rad", shear),
            (ErrorKey::Lag, "lag_s", lag),
        ];
        let mut found = Vec::new();
        for (error, name, value) in given {
            let Some(numbers) = value else {
                continue;
            };
            let here = format!("{key}.{name}");
            let late = error == ErrorKey::Lag && sensor.kind.unknown_errors().contains(&error);
            let group = ErrorGroup::of(sensor.kind).find(|g| g.key == error);
            let known: Vec<SensorError> = match group {
                Some(group) => group.errors(),
                None if late => vec![SensorError::Lag],
                None => Vec::new(),
            };
            if known.is_empty() {
                let problem = format!("a sensor of type {} has no such error", sensor.kind.word());
                self.refuse("E0507", &here, problem, "take it out");
            } else if let Some(numbers) = self.per_channel(&here, &numbers, known.len()) {
                found.extend(known.into_iter().zip(numbers));
            }
        }
        found
    }

    /// So many numbers.
    fn per_channel(&mut self, key: &str, numbers: &[f64], channels: usize) -> Option<Vec<f64>> {
        if numbers.len() == channels {
            return Some(numbers.to_vec());
        }
        let problem = format!("{} numbers for {channels} channels", numbers.len());
        self.refused("E0506", key, problem, "give one per channel")
    }

    /// One number for each joint, wheel or thruster of a sensor, or one for all; three of a sensor with axes.
    fn of_sensor(&mut self, key: &str, numbers: &[f64], sensor: &Sensor) -> Option<Vec<f64>> {
        let channels = match (sensor.kind.is_scalar(), numbers.len()) {
            (true, 1) => 1,
            (true, _) => sensor.of.len(),
            (false, _) => 3,
        };
        self.per_channel(key, numbers, channels)
    }

    fn bias(&mut self, table: &SensorOutputFile, sensor: &Sensor, key: &str) -> Option<Vec<f64>> {
        let wanted = self.model.unit_of(sensor);
        let all = [
            ("rad", &table.bias_rad),
            ("rad_s", &table.bias_rad_s),
            ("m", &table.bias_m),
            ("m_s", &table.bias_m_s),
            ("m_s2", &table.bias_m_s2),
            ("N", &table.bias_N),
        ];
        let mut found = None;
        for (suffix, value) in all {
            let Some(numbers) = value else { continue };
            let key = format!("{key}.bias_{suffix}");
            if suffix == wanted {
                found = self.of_sensor(&key, numbers, sensor);
            } else {
                let remedy = format!("use bias_{wanted}");
                self.refuse("E0507", &key, "this sensor has another unit", remedy);
            }
        }
        found
    }
}
