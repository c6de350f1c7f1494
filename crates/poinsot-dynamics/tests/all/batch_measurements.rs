//! Measurements in many states against those of one state.

use crate::xu_arm::{self, State, Stream};

use poinsot_dynamics::batch::{self, BatchError, PlacedSensor, States};
use poinsot_dynamics::*;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Largest difference to one state, relative to the largest number of the row.
const TOLERANCE: f64 = 1e-12;
/// States: groups of eight, four or two lanes, and a part of one.
const COUNT: usize = 21;
/// Joint coordinates.
const DOF: usize = 6;

/// The arm of the benchmarks, one joint prismatic, in many poses.
struct Many {
    tree: Tree,
    q: Vec<f64>,
    rates: Vec<f64>,
    twist: Vec<f64>,
    poses: Vec<f64>,
    reference_N: Vec<f64>,
    accelerations: Vec<f64>,
}

impl Many {
    fn new() -> Self {
        let mut tree = xu_arm::tree();
        let p_PoCo_P = Vector3::new(0.2, 0.1, -0.3);
        let oblique = Vector3::new(0.6, 0.0, 0.8);
        let slide = Motion::Prismatic(2);
        tree.links[3] = Link::new(2, slide, p_PoCo_P, Matrix3::identity(), oblique);
        let mut stream = Stream(7);
        let states: Vec<State> = (0..COUNT).map(|_| stream.state()).collect();
        let mut many = Self {
            tree,
            q: states.iter().flat_map(|s| s.q).collect(),
            rates: states.iter().flat_map(|s| s.rates).collect(),
            twist: Vec::new(),
            poses: Vec::new(),
            reference_N: Vec::new(),
            accelerations: Vec::new(),
        };
        for state in &states {
            many.twist.extend(state.v.iter().chain(&state.w));
            let mut vector = || Vector3::from([(); 3].map(|()| 3.0 * stream.number()));
            let R_NB = UnitQuaternion::from_scaled_axis(vector());
            many.poses.extend(R_NB.coords.iter().chain(&vector()));
            many.reference_N.extend(&vector().normalize());
            let acceleration = (0..6 + DOF).map(|_| stream.number());
            many.accelerations.extend(acceleration);
        }
        many
    }

    fn sensor(&self, kind: SensorKind, body: usize, seen_from: usize) -> PlacedSensor<'_> {
        PlacedSensor {
            kind,
            body,
            p_BioS_Bi: Vector3::new(0.3, -0.2, 0.1),
            seen_from,
            reference_N: Some(&self.reference_N),
            accelerations: Some(&self.accelerations),
        }
    }

    /// The rows of the states from `first` on, `count` of them.
    fn of(&self, sensor: PlacedSensor, first: usize, count: usize) -> Vec<f64> {
        let part = |rows: &'_ [f64], width: usize| rows[first * width..][..count * width].to_vec();
        let (q, rates) = (part(&self.q, DOF), part(&self.rates, DOF));
        let (twist, poses) = (part(&self.twist, 6), part(&self.poses, 7));
        let reference_N = part(&self.reference_N, 3);
        let accelerations = part(&self.accelerations, 6 + DOF);
        let states = States {
            q: &q,
            rates: &rates,
            twist: &twist,
        };
        let sensor = PlacedSensor {
            reference_N: Some(&reference_N),
            accelerations: Some(&accelerations),
            ..sensor
        };
        let width = batch::measured_width(&self.tree, sensor.kind);
        let mut out = vec![f64::NAN; width * count];
        batch::measure(&self.tree, states, &poses, sensor, &mut out).unwrap();
        out
    }

    /// The same of state `k` by the model of one state.
    fn alone(&self, sensor: PlacedSensor, k: usize) -> Vec<f64> {
        let vector = |rows: &[f64], at: usize| Vector3::from_column_slice(&rows[at..][..3]);
        let (tree, rates) = (&self.tree, &self.rates[DOF * k..][..DOF]);
        let (v, w) = (vector(&self.twist, 6 * k), vector(&self.twist, 6 * k + 3));
        let mut kinematics = Kinematics::new(tree);
        kinematics.place(tree, &self.q[DOF * k..][..DOF]);
        kinematics.set_velocities(tree, &v, &w, rates);
        let acceleration = &self.accelerations[(6 + DOF) * k..][..6 + DOF];
        let (a, alpha) = (vector(acceleration, 0), vector(acceleration, 3));
        let mut bodies = Accelerations::new(tree);
        bodies.set_without_base(tree, &kinematics, rates, &acceleration[6..]);
        bodies.add_base(&kinematics, &a, &alpha);
        let [i, j, l, u] = [0, 1, 2, 3].map(|n| self.poses[7 * k + n]);
        let pose = BasePose {
            R_NB: UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(u, i, j, l)),
            p_NoBo_N: vector(&self.poses, 7 * k + 4),
        };
        let (body, place) = (sensor.body, &sensor.p_BioS_Bi);
        let point = PointMotion::new(&kinematics, body, place);
        let from = PointMotion::new(&kinematics, sensor.seen_from, &Vector3::zeros());
        let scene = Scene {
            pose: &pose,
            point: &point,
            from: &from,
            reference_N: Some(vector(&self.reference_N, 3 * k)),
            a_NP_B: Some(bodies.of_point(&kinematics, body, place)),
        };
        let found = sensor.kind.measure(&scene).unwrap();
        let mut row = match found.value {
            Ideal::Vector(x) => x.as_slice().to_vec(),
            Ideal::Rotation(q) => q.coords.as_slice().to_vec(),
        };
        row.extend(&found.rate.unwrap_or_default());
        row.extend(found.pose.iter().chain(&found.twist));
        for joint in 0..DOF {
            // The bodies form a chain.
            let relative = sensor.kind.is_relative();
            let carries = (joint < body, relative && joint < sensor.seen_from);
            let over = |carried| sensor.kind.over_joint(&scene, carried);
            let effect = |point| JointEffect::new(tree, &kinematics, joint + 1, point);
            let over = match carries {
                (true, false) => over(Carried::Point(&effect(&point))),
                (false, true) => over(Carried::From(&effect(&from))),
                _ => None,
            };
            let nothing = [0.0; 6];
            match over {
                Some(over) => row.extend(over.position.iter().chain(&over.rate)),
                None => row.extend(nothing),
            }
        }
        row
    }
}

fn sensors(many: &Many) -> Vec<PlacedSensor<'_>> {
    let places = |kind: SensorKind| match kind.is_relative() {
        true => vec![(6, 0), (0, 6), (6, 2), (1, 4)],
        false => vec![(0, 0), (3, 0), (6, 0)],
    };
    let placed = |kind: SensorKind| {
        let of = move |(body, from)| many.sensor(kind, body, from);
        places(kind).into_iter().map(of)
    };
    SensorKind::with_axes().flat_map(placed).collect()
}

#[test]
fn exact_many_measurements_are_those_one_by_one() {
    let many = Many::new();
    for sensor in sensors(&many) {
        let all = many.of(sensor, 0, COUNT);
        let width = batch::measured_width(&many.tree, sensor.kind);
        for (k, row) in all.chunks_exact(width).enumerate() {
            let one = many.alone(sensor, k);
            assert_eq!(one.len(), width);
            let scale = one.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (a, b) in row.iter().zip(&one) {
                let gap = (a - b).abs() / scale;
                let PlacedSensor { kind, body, .. } = sensor;
                assert!(gap < TOLERANCE, "{kind:?} {body} state {k}: {gap:e}");
            }
        }
    }
}

#[test]
fn exact_bits_of_measurements_do_not_depend_on_the_batch() {
    let many = Many::new();
    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    for sensor in sensors(&many) {
        let all = many.of(sensor, 0, COUNT);
        let width = batch::measured_width(&many.tree, sensor.kind);
        for size in [1, 3, 8] {
            for first in (0..COUNT).step_by(size) {
                let count = size.min(COUNT - first);
                let part = many.of(sensor, first, count);
                let same = &all[first * width..][..count * width];
                assert_eq!(bits(same), bits(&part), "{:?} {first}", sensor.kind);
            }
        }
    }
}

#[test]
fn unit_a_sensor_without_what_it_measures_is_an_error() {
    let many = Many::new();
    let states = States {
        q: &many.q,
        rates: &many.rates,
        twist: &many.twist,
    };
    let error = |sensor| {
        let mut out = vec![0.0; 1];
        batch::measure(&many.tree, states, &many.poses, sensor, &mut out).unwrap_err()
    };
    let kind = SensorKind::Direction;
    let lacking = PlacedSensor {
        reference_N: None,
        ..many.sensor(kind, 1, 0)
    };
    assert_eq!(error(lacking), BatchError::Unmeasured(kind));
    let kind = SensorKind::WheelSpeed;
    assert_eq!(error(many.sensor(kind, 1, 0)), BatchError::Unmeasured(kind));
    let kind = SensorKind::Gyro;
    assert_eq!(error(many.sensor(kind, 7, 0)), BatchError::Body(7, 7));
    let width = batch::measured_width(&many.tree, kind);
    let length = BatchError::Length("out", 1, COUNT * width);
    assert_eq!(error(many.sensor(kind, 6, 0)), length);
}
