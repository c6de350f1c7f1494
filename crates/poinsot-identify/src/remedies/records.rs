//! Tested records: a rotation, a motion of joints or wheels, a sensor, a thrust. Those within the vehicle's capability come first.

use super::baseline::Baseline;
use super::{Action, Change, Effort, Row, listed};
use crate::fit::part_of_record::at_times;
use crate::likelihood::{InitialState, InitialStateColumns, Setting, evaluate};
use crate::motion::Fineness;
use crate::motion::input_curves::InputCurves;
use crate::problem::Problem;
use crate::problem::loss::Loss;
use crate::problem::parameters::axis_name;
use crate::problem::segment::{Firing, Noise, Observations, Segment, SensorRecord, SensorValue};
use poinsot_dynamics::{Kinematics, composite};
use poinsot_model::{Joint, SensorKind, Thruster, rounded};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Samples of a record that is tried, and its longest duration, s; their noise is scaled to that of the record at
/// hand over the same time.
const SAMPLES: usize = 40;
const SPAN: f64 = 120.0;
/// Noise of the velocity sensor tried, m/s.
const VELOCITY: f64 = 1.0e-3;
/// Noise of the accelerometer tried, m/s2.
const ACCELERATION: f64 = 1.0e-4;
/// Smallest tested rate about an axis, rad/s.
const RATE: f64 = 0.05;
/// Size of a joint's motion that is tried, rad or m, and its turns in the record.
const SWING: (f64, f64) = (0.3, 3.0);
/// Largest number of tested joints, those next to the base first: the time of all grows with the square of a chain. The same of wheels.
const JOINTS: usize = 32;
/// Largest change of a wheel's speed that is tried, rad/s, and its slope, rad/s2: small for the wheels of any size.
const RUN: (f64, f64) = (100.0, 10.0);
/// Largest force that is tried, N, its arm, m, and the share of the record that it lasts.
const PUSH: (f64, f64, f64) = (1.0, 0.5, 0.1);

impl Baseline<'_> {
    /// Records with a sensor, a thrust, a momentum or a motion that is missing; `None` without a record to start
    /// from.
    pub fn records(&self) -> Option<Vec<Change>> {
        use Effort::{Equipment, Manoeuvre, Turn};
        let from = self.problem.segments.first()?;
        let (base, share) = thinned(from, self.sees_translation, self.problem.noise)?;
        let trial = Trial {
            segment: base,
            initial_state: self.initial_state,
            sees_translation: self.sees_translation,
            known_momentum: false,
            thrusters: self.problem.model.thrusters.clone(),
            share,
        };
        let mut list = Vec::new();
        let mut add = |effort: Effort, text: String, trial: &Trial| {
            if let Some(rows) = self.rows_of(trial) {
                list.push(Change {
                    action: Action::Record(text),
                    effort,
                    rows,
                });
            }
        };
        let by = |there: bool| if there { Manoeuvre } else { Equipment };
        let turn = match (
            trial.thrusters.is_empty(),
            self.problem.model.wheels.is_empty(),
        ) {
            (false, _) => Manoeuvre,
            (true, false) => Turn,
            (true, true) => Equipment,
        };
        self.turns(&trial, &mut |text, trial| add(turn, text, trial));
        self.joints(&trial, &mut |text, trial| add(Manoeuvre, text, trial));
        self.wheels(&trial, &mut |text, trial| add(Manoeuvre, text, trial));
        self.sensors(&trial, &mut |text, trial| add(Equipment, text, trial));
        self.pushes(&trial, &mut |own, text, trial| add(by(own), text, trial));
        let mut known = trial;
        known.known_momentum = true;
        let text = "measure the angular momentum at the start of a record";
        add(Equipment, text.to_owned(), &known);
        Some(list)
    }

    /// The bodies at the first time of a record, and their inertia together, in base axes.
    fn inertia(&self, trial: &Trial) -> (Kinematics, Matrix3) {
        let tree = self.problem.tree;
        let joints = &trial.segment.observations.joint_position;
        let kinematics = Kinematics::at(tree, joints.get(..tree.dof()).unwrap_or(&[]));
        let I = composite(&self.parameters.bodies(&self.x), &kinematics).I_SScm_B();
        (kinematics, I)
    }

    /// The base also rotates about one of its axes.
    fn turns(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let (_, I) = self.inertia(trial);
        let fastest = self.problem.segments[0].samples.w_NB_B.iter();
        let fastest = fastest.map(|w| w.norm()).fold(RATE, f64::max);
        for axis in 0..3 {
            let w = Vector3::ith(axis, fastest);
            let mut turning = trial.clone();
            turning.initial_state.h_SScm_N += trial.initial_state.R_NB * (I * w);
            let text = format!(
                "record {:.0} s more with the base also rotating about its {} axis, at {fastest:.2} rad/s",
                trial.span(),
                axis_name(axis)
            );
            add(text, &turning);
        }
    }

    /// An oscillating joint; all of them, each at its own pace.
    fn joints(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let coordinates = &self.problem.tree.coordinates;
        let unit = |joint: &Joint| SensorKind::JointPosition.unit(joint.slides());
        let (size, _) = SWING;
        let span = trial.span();
        for (joint, at) in coordinates.iter().enumerate().take(JOINTS) {
            let mut moving = trial.clone();
            moving.swing(joint, coordinates.len(), 1.0);
            let joint = &self.problem.model.joints[*at];
            let (name, unit) = (&joint.name, unit(joint));
            let text = format!("record {span:.0} s more with {name} oscillating by {size} {unit}");
            add(text, &moving);
        }
        if coordinates.len() > 1 {
            let mut moving = trial.clone();
            for joint in 0..coordinates.len() {
                let pace = 1.0 + joint as f64 / coordinates.len() as f64;
                moving.swing(joint, coordinates.len(), pace);
            }
            let joints = coordinates.iter().map(|at| &self.problem.model.joints[*at]);
            let mut units: Vec<&str> = joints.map(unit).collect();
            units.sort_unstable();
            units.dedup();
            let text = format!(
                "record {span:.0} s more with all joints oscillating by {size} {}, each at its own pace",
                units.join(" or ")
            );
            add(text, &moving);
        }
    }

    /// A wheel whose speed rises and falls back; all of them, one after the other. The base reaches the tested rate at most.
    fn wheels(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let wheels = &self.problem.model.wheels;
        let (kinematics, I) = self.inertia(trial);
        let (most, slope) = RUN;
        let each = (0..wheels.len().min(JOINTS)).map(|k| k..k + 1);
        let all = (wheels.len() > 1).then_some(0..wheels.len());
        for set in each.chain(all) {
            let of = &wheels[set.clone()];
            let lasting = trial.span() / of.len() as f64;
            let reached = of.iter().map(|wheel| {
                let axis = kinematics.R[wheel.body] * wheel.axis_B;
                RATE * axis.dot(&(I * axis)) / wheel.spin_inertia
            });
            let size = reached.fold(most.min(0.5 * slope * lasting), f64::min);
            let mut running = trial.clone();
            let o = &mut running.segment.observations;
            let speeds = o.wheel_speed.chunks_exact_mut(wheels.len());
            for (speeds, t) in speeds.zip(&o.time_s) {
                for (k, wheel) in set.clone().enumerate() {
                    let share = (t - o.time_s[0]) / lasting - k as f64;
                    speeds[wheel] += size * (1.0 - (2.0 * share - 1.0).abs()).max(0.0);
                }
            }
            let names: Vec<&str> = of.iter().map(|wheel| wheel.name.as_str()).collect();
            let (names, half) = (listed(&names), rounded(0.5 * lasting, 3));
            let size = rounded(size, 2);
            let whose = match of.len() {
                1 => format!("the speed of {names}"),
                _ => format!("the speeds of {names}, one after the other,"),
            };
            let text = format!(
                "record {:.0} s more with {whose} rising evenly by {size} rad/s in {half} s and falling back in the same time",
                trial.span()
            );
            add(text, &running);
        }
    }

    /// A velocity sensor or an accelerometer on the base.
    fn sensors(&self, trial: &Trial, add: &mut impl FnMut(String, &Trial)) {
        let share = trial.share;
        let samples = trial.segment.observations.time_s.len();
        if !self.sees_translation {
            let mut with = trial.clone();
            with.sees_translation = true;
            let o = &mut with.segment.observations;
            let sigma = VELOCITY * share.sqrt();
            o.sensors.push(tried(SensorKind::Velocity, samples, sigma));
            let text = format!("add a velocity sensor of {VELOCITY} m/s, as fast as the gyro");
            add(text, &with);
        }
        if !self.problem.sees_points() {
            let mut with = trial.clone();
            let o = &mut with.segment.observations;
            let sigma = ACCELERATION * share.sqrt();
            o.sensors
                .push(tried(SensorKind::Accelerometer, samples, sigma));
            let text = format!(
                "add an accelerometer of {ACCELERATION:.0e} m/s2 at the origin of the base, as fast as the gyro"
            );
            add(text, &with);
        }
    }

    /// A known force: of every thruster that does not fire; from outside on a vehicle that has no actuator at all.
    fn pushes(&self, trial: &Trial, add: &mut impl FnMut(bool, String, &Trial)) {
        let (most, arm, share) = PUSH;
        let o = &trial.segment.observations;
        let start_s = o.time_s[0];
        let lasting = (trial.span() * share).max(f64::MIN_POSITIVE);
        // At most the tested rate about the base's axes.
        let (_, I) = self.inertia(trial);
        let force = (RATE * I.trace() / 3.0 / (arm * lasting)).clamp(1.0e-6, most);
        // Edges on the grid.
        let last = ((o.time_s.len() as f64 * share).ceil() as usize).min(o.time_s.len() - 1);
        let mut push = |thruster: usize, trial: &Trial, text: String| {
            let mut with = trial.clone();
            with.segment.firings = vec![Firing {
                thruster,
                start_s,
                end_s: trial.segment.observations.time_s[last],
                force,
            }];
            let lasting = trial.segment.observations.time_s[last] - start_s;
            let size = rounded(force, 2);
            let text = format!("{text}, {size} N for {lasting:.1} s, of known force");
            add(!self.problem.model.thrusters.is_empty(), text, &with);
        };
        let fires = |k: usize| {
            let firings = self.problem.segments.iter().flat_map(|s| &s.firings);
            firings.into_iter().any(|f| f.thruster == k)
        };
        let thrusters = trial.thrusters.iter().enumerate();
        for (k, thruster) in thrusters.filter(|(k, _)| !fires(*k)) {
            push(k, trial, format!("fire {}", thruster.name));
        }
        let model = self.problem.model;
        if trial.thrusters.is_empty() && model.wheels.is_empty() && model.joints.is_empty() {
            let mut with = trial.clone();
            with.thrusters.push(Thruster {
                name: String::new(),
                body: 0,
                p_BoT_B: Vector3::new(arm, 0.0, 0.0),
                direction_B: Vector3::y(),
                never_fires: false,
                scale: Default::default(),
                propellant: None,
            });
            let text =
                format!("apply a force to the base along y, {arm} m from its origin along x");
            push(0, &with, text);
        }
    }

    /// Information of a record over the shared unknowns, its own start projected out.
    fn rows_of(&self, trial: &Trial) -> Option<Vec<Row>> {
        let o = &trial.segment.observations;
        let unknown = InitialStateColumns {
            attitude: o.reads(SensorKind::Attitude)
                && !o.of_kind(SensorKind::Attitude).any(SensorRecord::is_exact),
            position: false,
            linear: trial.sees_translation,
            angular: !trial.known_momentum,
            internal: self.problem.internal_states(),
        };
        // A separate record, without the others.
        let index = self.problem.segments.len();
        // The readings of inputs are as few as those of the gyro.
        let scaled = |all: &[f64]| all.iter().map(|x| x * trial.share).collect();
        let given = self.problem.noise;
        let noise = Noise {
            joint_position: scaled(&given.joint_position),
            joint_rate: scaled(&given.joint_rate),
            wheel_speed: scaled(&given.wheel_speed),
            ..given.clone()
        };
        let mut curves = vec![InputCurves::default(); index];
        if self.parameters.delay_inputs() {
            curves.push(InputCurves::new(o, &noise));
        }
        let setting = Setting {
            known: None,
            problem: Problem {
                noise: &noise,
                ..*self.problem
            },
            thrusters: &trial.thrusters,
            parameters: &self.parameters,
            nominal_spin: &self.problem.model.spin_inertias(),
            loss: Loss::Gaussian,
            wheels: self.wheels,
            curves: &curves,
            grids: &[],
            fineness: Fineness::default(),
            keep_rows: false,
            smooth_inputs: false,
            fitted: None,
            split: false,
        };
        let evaluated = evaluate(
            &setting,
            (index, &trial.segment),
            &self.x,
            &trial.initial_state,
            unknown,
            true,
        )?;
        let triangle = evaluated.triangle?;
        let h = unknown.count();
        let n = self.parameters.len();
        let rows = (h..h + n).map(|i| (0..n).map(|j| triangle.r[(i, h + j)]).collect());
        Some(rows.collect())
    }
}

/// A record that is tried.
#[derive(Clone)]
struct Trial {
    segment: Segment,
    initial_state: InitialState,
    sees_translation: bool,
    known_momentum: bool,
    thrusters: Vec<Thruster>,
    /// Number of its readings of the gyro over those that they stand for.
    share: f64,
}

impl Trial {
    /// Duration, s.
    fn span(&self) -> f64 {
        let t = &self.segment.observations.time_s;
        t.last().copied().unwrap_or(0.0) - t.first().copied().unwrap_or(0.0)
    }

    /// One of the joints also oscillates, at a multiple of the usual pace.
    fn swing(&mut self, joint: usize, joints: usize, pace: f64) {
        let (size, turns) = SWING;
        let pace = std::f64::consts::TAU * turns * pace / self.span().max(f64::MIN_POSITIVE);
        let o = &mut self.segment.observations;
        for (k, t) in o.time_s.iter().enumerate() {
            let angle = pace * (t - o.time_s[0]);
            o.joint_position[k * joints + joint] += size * angle.sin();
            o.joint_rate[k * joints + joint] += size * pace * angle.cos();
            let own = o.joints.get_mut(joint);
            if let Some(own) = own.and_then(|j| j.acceleration.get_mut(k)) {
                *own -= size * pace * pace * angle.sin();
            }
        }
    }
}

/// A sensor at the base's origin with a sample at every grid time; its values are not used.
fn tried(kind: SensorKind, samples: usize, sigma: f64) -> SensorRecord {
    let covariance = Matrix3::identity() * (sigma * sigma);
    SensorRecord::of_base(kind, covariance).at_every_time(vec![any_value(kind); samples])
}

fn any_value(kind: SensorKind) -> SensorValue {
    match kind {
        SensorKind::Attitude => SensorValue::Attitude(UnitQuaternion::identity()),
        _ => SensorValue::Vector(Vector3::zeros()),
    }
}

/// A segment at a few times of the gyro, every sensor of rate, attitude and velocity at each, and how many these are of
/// those at hand; `moving`: its velocity is measured, too.
fn thinned(segment: &Segment, moving: bool, noise: &Noise) -> Option<(Segment, f64)> {
    let o = &segment.observations;
    let first = o.time_s.first()?;
    let times = o.rates().map(|(k, _)| k);
    let all: Vec<usize> = times.filter(|&k| o.time_s[k] - first <= SPAN).collect();
    let stride = all.len().div_ceil(SAMPLES).max(1);
    let picked: Vec<usize> = all.iter().copied().step_by(stride).collect();
    if picked.len() < 4 {
        return None;
    }
    let samples = picked.len();
    let share = samples as f64 / all.len() as f64;
    let mut sensors: Vec<SensorRecord> = Vec::new();
    for record in o.sensors.iter().filter(|r| !r.samples.is_empty()) {
        let kept = match record.kind {
            SensorKind::Gyro | SensorKind::Attitude => true,
            SensorKind::Velocity => moving,
            _ => false,
        };
        if kept {
            let own = record.samples.iter();
            let own = own.filter(|s| o.time_s[s.to] - first <= SPAN).count();
            let mut few = record.with_samples(std::iter::empty());
            // These samples stand for all of its own.
            few.scale_noise(samples as f64 / own.max(1) as f64);
            sensors.push(few.at_every_time(vec![any_value(record.kind); samples]));
        }
    }
    if moving && sensors.iter().all(|r| r.kind != SensorKind::Velocity) {
        // Derived from positions.
        sensors.push(SensorRecord {
            covariance: noise.velocity * share,
            ..tried(SensorKind::Velocity, samples, VELOCITY)
        });
    }
    // Its inputs have independent errors.
    let observations = Observations {
        sensors,
        joints: Vec::new(),
        wheels: Vec::new(),
        expected_errors: Vec::new(),
        between_readings: Default::default(),
        ..at_times(segment, &picked).observations
    };
    let segment = Segment {
        observations,
        ..Segment::default()
    };
    Some((segment, share))
}
