//! Converts samples of the motion to telemetry channels.

use super::stream;
use crate::case::Scenario;
use crate::channel_names::{XYZ, joint_channels, names, of_all, wheel_torques};
use poinsot_dynamics::{
    Instrument, JointDrive, MotionSample, SAME_TIME, Tree, WheelDrive, WheelMotion, thrust_held,
    vector_reading,
};
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table, classify};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Reads numbers of the exact motion.
type Read = Box<dyn Fn(&MotionSample, &mut Vec<f64>)>;

/// Source of a group of channels.
enum Reader {
    /// A sensor with its errors.
    Sensor(Box<Instrument>),
    /// The exact motion.
    Exact(Read),
}

/// Channels sampled together.
struct Group {
    /// Name of the sensor.
    sensor: Option<String>,
    names: Vec<String>,
    every: usize,
    reader: Reader,
    /// Row of the first sample: a velocity increment has no beginning in row 0.
    first: usize,
    values: Vec<Vec<f64>>,
}

/// Collects telemetry row by row, for pieces of any length.
pub(super) struct Recorder {
    /// The sensors in the order of the model, then the rest.
    groups: Vec<Group>,
    /// Exact channels to write; `None`: all.
    commanded: Option<HashSet<String>>,
    /// Names of the thrust channels, one per thruster.
    thrust: Vec<String>,
    row: usize,
    /// Time of the row before the piece, and those of its rows, s.
    before: Option<f64>,
    times: Vec<f64>,
    reading: Vec<f64>,
    pub trial: u64,
    /// The first instant; `None` before it.
    pub first: Option<MotionSample>,
}

impl Recorder {
    /// Creates groups for all sensors, and exact channels for everything without a sensor.
    pub fn new(model: &Model, scenario: &Scenario, seed: u64, trial: u64) -> Self {
        let tree = Tree::new(model);
        let mut groups = Vec::new();
        for (i, sensor) in model.sensors.iter().enumerate() {
            let given = scenario.sensors.get(i);
            let bias = given.and_then(|s| s.bias.as_deref());
            let mut instrument = Instrument::new(sensor, &tree, seed, stream(trial, i), bias);
            for (error, value) in given.map_or(&[][..], |s| &s.errors) {
                instrument.set_error(*error, *value);
            }
            if let Some(scales) = given.and_then(|s| s.scales.as_ref()) {
                instrument.set_scales(scales);
            }
            let reader = Reader::Sensor(Box::new(instrument));
            let names = names(model, sensor.kind, &sensor.of);
            let own = Some(sensor.name.clone());
            let every = given.map_or(1, |s| s.every);
            let mut group = Group::new(own, names, every, reader);
            if sensor.kind == SensorKind::VelocityIncrement {
                group.first = group.every;
            }
            groups.push(group);
        }
        let measured: HashSet<String> = groups.iter().flat_map(|g| g.names.clone()).collect();
        let only = scenario.sensors_only;
        let commanded = only.then(|| commanded(model, scenario, &measured));
        let written = |name: &String| {
            let wanted = commanded.as_ref().is_none_or(|c| c.contains(name));
            wanted && !measured.contains(name)
        };
        for (names, read) in exact_channels(model, scenario, &tree) {
            if names.iter().any(written) {
                groups.push(Group::new(None, names, 1, Reader::Exact(read)));
            }
        }
        // Scalars with a sensor are removed from their exact group later.
        Self {
            groups,
            commanded,
            thrust: of_all(model, SensorKind::Thrust),
            row: 0,
            before: None,
            times: Vec::new(),
            reading: Vec::new(),
            trial,
            first: None,
        }
    }

    /// Adds a row.
    pub fn take(&mut self, sample: &MotionSample) {
        self.first.get_or_insert_with(|| sample.clone());
        for group in &mut self.groups {
            if !self.row.is_multiple_of(group.every) {
                continue;
            }
            match &mut group.reader {
                Reader::Sensor(instrument) => instrument.read(sample, &mut self.reading),
                Reader::Exact(read) => {
                    self.reading.clear();
                    read(sample, &mut self.reading);
                }
            }
            for (values, x) in group.values.iter_mut().zip(&self.reading) {
                values.push(*x);
            }
        }
        self.row += 1;
        self.times.push(sample.time);
    }

    /// Rows per sample of a sensor.
    pub fn every(&self, sensor: usize) -> usize {
        self.groups.get(sensor).map_or(1, |group| group.every)
    }

    /// Rows of the piece.
    pub fn rows(&self) -> usize {
        self.times.len()
    }

    /// The time up to which no later row has a sample, s.
    pub fn until(&self) -> f64 {
        let last = self.times.last().copied().unwrap_or(f64::NEG_INFINITY);
        let lags = self.groups.iter().map(Group::lag_s);
        last + lags.fold(0.0, f64::min)
    }

    /// A sensor with its true errors.
    pub fn instrument(&self, sensor: usize) -> Option<&Instrument> {
        match &self.groups.get(sensor)?.reader {
            Reader::Sensor(instrument) => Some(instrument),
            Reader::Exact(_) => None,
        }
    }

    /// Takes the channels of the piece; if two sensors write one channel, both get their names.
    pub fn drain(&mut self, scenario: &Scenario) -> Table {
        let mut readers: HashMap<String, usize> = HashMap::new();
        let by_sensor = self.groups.iter().filter(|g| g.sensor.is_some());
        for name in by_sensor.flat_map(|g| &g.names) {
            *readers.entry(name.clone()).or_default() += 1;
        }
        let mut bases: HashMap<(usize, usize, u64), Arc<[f64]>> = HashMap::new();
        let mut channels = Vec::new();
        let start = self.row - self.times.len();
        for group in &mut self.groups {
            let (first, every, lag_s) = (group.first, group.every, group.lag_s());
            let base = bases
                .entry((first, every, lag_s.to_bits()))
                .or_insert_with(|| {
                    let rows = (start..).zip(&self.times);
                    let own = rows.filter(|(row, _)| *row >= first && row.is_multiple_of(every));
                    own.map(|(_, t)| t + lag_s).collect()
                });
            for (name, values) in group.names.iter().zip(&mut group.values) {
                let (name, mut values) = (name.clone(), std::mem::take(values));
                values.shrink_to_fit();
                let count = readers.get(&name).copied().unwrap_or(0);
                let exact = group.sensor.is_none();
                let wanted = self.commanded.as_ref().is_none_or(|c| c.contains(&name));
                if (exact && (count > 0 || !wanted)) || first >= scenario.times.count() {
                    continue;
                }
                let thruster = self.thrust.iter().position(|n| exact && *n == name);
                let (time_s, values) = match thruster {
                    Some(k) => with_switches(scenario, k, (self.before, base)),
                    None => (base.clone(), values),
                };
                let sensor = group.sensor.clone().filter(|_| count > 1);
                let sensor = sensor.unwrap_or_default();
                channels.push(channel(name, sensor, time_s, values));
            }
        }
        self.before = self.times.last().copied().or(self.before);
        self.times.clear();
        Table {
            channels,
            ..Table::default()
        }
    }
}

/// The rows of a thruster with its switching times in between, from the row before: a value holds until the next. A switch at a
/// row, to round-off of their times, counts as done there.
fn with_switches(
    scenario: &Scenario,
    thruster: usize,
    (before, rows): (Option<f64>, &Arc<[f64]>),
) -> (Arc<[f64]>, Vec<f64>) {
    let firings = &scenario.plan.firings;
    let own = firings.iter().filter(|f| f.thruster == thruster);
    let is_between = |t: &f64| {
        let next = rows.partition_point(|row| row < t);
        let last = next.checked_sub(1).and_then(|k| rows.get(k));
        let last = last.or(before.as_ref().filter(|row| *row < t));
        let apart = |row: Option<&f64>| row.is_some_and(|row| (row - t).abs() > SAME_TIME);
        apart(rows.get(next)) && apart(last)
    };
    let between = own.flat_map(|f| [f.on, f.off]).filter(is_between);
    let mut times: Vec<f64> = between.collect();
    let times = if times.is_empty() {
        rows.clone()
    } else {
        times.extend(rows.iter());
        times.sort_by(f64::total_cmp);
        times.dedup();
        times.into()
    };
    let mut levels = vec![0.0; thruster + 1];
    let mut level = |t: &f64| {
        thrust_held(firings, *t, &mut levels);
        levels[thruster]
    };
    let values = times.iter().map(&mut level).collect();
    (times, values)
}

impl Group {
    fn new(sensor: Option<String>, names: Vec<String>, every: usize, reader: Reader) -> Self {
        Self {
            sensor,
            values: vec![Vec::new(); names.len()],
            names,
            every: every.max(1),
            reader,
            first: 0,
        }
    }

    /// By how much its samples are late, s: a delayed sensor writes an earlier one.
    fn lag_s(&self) -> f64 {
        match &self.reader {
            Reader::Sensor(instrument) => instrument.lag_s(),
            Reader::Exact(_) => 0.0,
        }
    }
}

fn channel(name: String, sensor: String, time_s: Arc<[f64]>, values: Vec<f64>) -> Channel {
    let meaning = classify(&name);
    let unit = meaning.as_ref().map_or("", |m| m.dimension.si());
    let frame = meaning.as_ref().map_or("", |m| m.frame);
    Channel {
        unit: unit.to_owned(),
        frame: frame.to_owned(),
        name,
        sensor,
        time_s,
        values,
    }
}

/// Joint coordinates with a motor, and their channels; none if all motion is prescribed, because motor torque is then
/// not commanded.
fn motor_channels(model: &Model, scenario: &Scenario) -> (Vec<usize>, Vec<String>) {
    let drives = &scenario.plan.joints;
    if !drives.iter().any(JointDrive::is_free) {
        return (Vec::new(), Vec::new());
    }
    let driven = model.moving_joints().zip(drives).enumerate();
    let with_motor = driven.filter(|(_, (_, drive))| !drive.is_free() || drive.has_motor());
    let named = with_motor.map(|(k, (joint, _))| {
        let [.., effort] = joint_channels(joint);
        (k, effort)
    });
    named.unzip()
}

/// Commanded channels: thrust, motor torques, and prescribed motions without a sensor.
fn commanded(model: &Model, scenario: &Scenario, measured: &HashSet<String>) -> HashSet<String> {
    let mut all = HashSet::from_iter(of_all(model, SensorKind::Thrust));
    let law = scenario.plan.control.as_ref();
    let accelerated = law.is_some_and(|law| law.drive == WheelDrive::Acceleration);
    for (wheel, motion) in model.wheels.iter().zip(&scenario.plan.wheels) {
        let suffix = match motion {
            WheelMotion::Controlled { .. } if accelerated => continue,
            WheelMotion::Controlled { .. } | WheelMotion::Torque { .. } => "Nm",
            WheelMotion::Speed(_) => "rad_s",
        };
        all.insert(format!("{}_{suffix}", wheel.name));
    }
    for (joint, drive) in model.moving_joints().zip(&scenario.plan.joints) {
        let [position, rate, _, effort] = joint_channels(joint);
        match drive {
            JointDrive::Force { .. } => all.extend([effort]),
            _ if !measured.contains(&position) => all.extend([position, rate]),
            _ => {}
        }
    }
    all
}

/// All channels of the exact motion of the base origin, in the order of a file.
fn exact_channels(model: &Model, scenario: &Scenario, tree: &Tree) -> Vec<(Vec<String>, Read)> {
    use SensorKind::{Accelerometer, Attitude, Gyro, JointPosition, JointRate};
    use SensorKind::{Position, Thrust, Velocity, WheelSpeed};
    let joints = &tree.coordinates;
    let of = |kind, list: &[usize]| names(model, kind, list);
    let vector = |name: &str| XYZ.map(|axis| format!("{name}_{axis}")).to_vec();
    let rates = of(JointRate, joints);
    let accelerations = rates.iter().map(|name| format!("{name}2")).collect();
    let accelerometer: Read = Box::new(|s, out| {
        let origin = Vector3::zeros();
        out.extend(vector_reading(Accelerometer, s, 0, &origin).iter());
    });
    let orbit = match model.environment.gravity_gradient {
        true => vector("orbit"),
        false => Vec::new(),
    };
    let (motors, efforts) = motor_channels(model, scenario);
    let motor: Read = Box::new(move |s, out| {
        out.extend(motors.iter().filter_map(|k| s.motor_force.get(*k)));
    });
    vec![
        (of(Attitude, &[]), numbers(|s| s.R_NB.coords.as_slice())),
        (of(Gyro, &[]), numbers(|s| s.w_NB_B.as_slice())),
        (vector("domega"), numbers(|s| s.body.alpha[0].as_slice())),
        (of(Position, &[]), numbers(|s| s.p_NoBo_N.as_slice())),
        (of(Velocity, &[]), numbers(|s| s.v_NBo_N.as_slice())),
        (of(Accelerometer, &[]), accelerometer),
        (orbit, numbers(|s| s.p_orbit_N.as_slice())),
        (of(JointPosition, joints), numbers(|s| &s.q)),
        (rates, numbers(|s| &s.rates)),
        (accelerations, numbers(|s| &s.accelerations)),
        (of_all(model, WheelSpeed), numbers(|s| &s.wheel_speed)),
        (wheel_torques(model), numbers(|s| &s.wheel_torque)),
        (of_all(model, Thrust), numbers(|s| &s.thrust)),
        (efforts, motor),
    ]
}

fn numbers(of: fn(&MotionSample) -> &[f64]) -> Read {
    Box::new(move |sample, out| out.extend(of(sample)))
}
