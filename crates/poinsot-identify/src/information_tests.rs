//! Sensitivities of every kind of unknown against differences of chi-square.

mod curves;
mod inputs;
mod known_columns;
mod two_threads;

use crate::fit::experiment::{Experiment, Iterate};
use crate::methods::flexible::maximum_likelihood;
use crate::methods::linear::linear;
use crate::problem::Problem;
use crate::problem::loss::Loss;
use crate::problem::parameters::{Equations, Parameters};
use crate::problem::segment::{
    Firing, InputChannel, InputRate, Noise, Observations, Samples, Segment, SensorRecord,
    SensorSample, SensorValue, Translation,
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use poinsot_dynamics::Tree;
use poinsot_model::{
    Environment, FlexibleMode, Mode, ModeEstimate, Model, SensorKind, SlowError, SpringDamper,
    SpringNumber, parse_model,
};
use poinsot_solve::LeastSquares;

const MODEL: &str = r#"
schema = "poinsot.model/1"
exact = true
name = "everything unknown"

[[body]]
name = "bus"
mass_kg = 40.0
com_m = [0.05, -0.02, 0.03]
inertia_kg_m2 = { xx = 3.0, yy = 2.5, zz = 4.0, xy = 0.2, xz = -0.1, yz = 0.15 }
estimate = true

[[body]]
name = "arm"
mass_kg = 6.0
com_m = [0.2, 0.1, -0.05]
inertia_kg_m2 = { xx = 0.3, yy = 0.4, zz = 0.35, xy = 0.02, xz = 0.01, yz = -0.03 }
estimate = true

[[body]]
name = "hand"
mass_kg = 2.0
com_m = [0.1, 0.0, 0.1]
inertia_kg_m2 = { xx = 0.05, yy = 0.06, zz = 0.04 }
estimate = ["com", "inertia"]

[[joint]]
name = "shoulder"
type = "revolute"
parent = "bus"
child = "arm"
origin_m = [0.5, 0.1, 0.2]
axis = [0.0, 0.6, 0.8]

[[joint]]
name = "slide"
type = "prismatic"
parent = "arm"
child = "hand"
origin_m = [0.4, 0.0, 0.1]
axis = [1.0, 0.0, 0.0]

[[wheel]]
name = "wheel"
body = "arm"
axis = [0.0, 0.6, -0.8]
spin_inertia_kg_m2 = 0.002
estimate = true
misalignment = "estimate"

[[thruster]]
name = "jet"
body = "arm"
position_m = [0.1, 0.3, 0.0]
force_direction = [0.0, 1.0, 0.0]
specific_impulse_s = 10.0
propellant_m = [0.05, -0.1, 0.02]
scale = "estimate"

[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1.0e-3
bias = "estimate"
scale = "estimate"
misalignment = "estimate"
nonorthogonality = "estimate"
lag = "estimate"

[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 1.0e-3
lag = "estimate"

[[sensor]]
name = "acc of hand"
type = "accelerometer"
body = "hand"
position_m = [0.1, -0.2, 0.3]
noise_m_s2 = 1.0e-2
bias = "estimate"
scale = "estimate"
misalignment = "estimate"
lag = "estimate"

[[sensor]]
name = "increments"
type = "velocity_increment"
body = "arm"
position_m = [0.3, 0.1, -0.1]
noise_m_s = 1.0e-2
bias = "estimate"
lag = "estimate"

[[sensor]]
name = "sun"
type = "direction"
body = "hand"
noise_rad = 1.0e-2
bias = "estimate"
misalignment = "estimate"
lag = "estimate"

[[sensor]]
name = "camera"
type = "attitude"
body = "hand"
seen_from = "bus"
noise_rad = 1.0e-2
lag = "estimate"

[[sensor]]
name = "range"
type = "position"
seen_from = "hand"
position_m = [-0.3, 0.2, 0.1]
noise_m = 1.0e-2
bias = "estimate"
scale = "estimate"
misalignment = "estimate"
lag = "estimate"

[[sensor]]
name = "flow"
type = "velocity"
body = "arm"
seen_from = "hand"
position_m = [0.2, -0.1, 0.3]
noise_m_s = 1.0e-2
bias = "estimate"
scale = "estimate"
misalignment = "estimate"
lag = "estimate"

[[sensor]]
name = "angle"
type = "joint_position"
of = "shoulder"
bias = "estimate"
scale = "estimate"
lag = "estimate"

[[sensor]]
name = "tachometer of shoulder"
type = "joint_rate"
of = "shoulder"
bias = "estimate"
scale = "estimate"

[[sensor]]
name = "length"
type = "joint_position"
of = "slide"
bias = "estimate"
scale = "estimate"
lag = "estimate"

[[sensor]]
name = "tachometer"
type = "wheel_speed"
bias = "estimate"
lag = "estimate"

[[sensor]]
name = "valve"
type = "thrust"
lag = "estimate"

[[sensor]]
name = "velocity"
type = "velocity"
noise_m_s = 1.0e-2
lag = "estimate"

[[sensor]]
name = "position"
type = "position"
noise_m = 1.0e-2
lag = "estimate"

[environment]
gravity = "point_mass"
gm_m3_s2 = 50.0
gravity_gradient = true
disturbance_torque = "estimate"
disturbance_torque_inertial = "estimate"
drag_torque = "estimate"
"#;

/// Index of a kind in the sensors of [`finer`], where translation is read; gyro and attitude come first anyway.
const KINDS: [SensorKind; 10] = [
    SensorKind::Gyro,
    SensorKind::Attitude,
    SensorKind::Velocity,
    SensorKind::Position,
    SensorKind::Accelerometer,
    SensorKind::VelocityIncrement,
    SensorKind::Direction,
    SensorKind::RelativeAttitude,
    SensorKind::RelativePosition,
    SensorKind::RelativeVelocity,
];

/// The sensor of a kind in the test's model, with covariance and place.
fn record(model: &Model, kind: SensorKind) -> SensorRecord {
    let (variances, body, place) = match kind {
        SensorKind::Gyro => ([1.0e-2, 2.0e-2, 3.0e-2], 0, [0.0; 3]),
        SensorKind::Attitude => ([1.0e-2; 3], 0, [0.0; 3]),
        SensorKind::Velocity => ([2.0e-2; 3], 0, [0.1, 0.2, -0.3]),
        SensorKind::Position => ([3.0e-2, 1.0e-2, 2.0e-2], 0, [-0.2, 0.1, 0.1]),
        SensorKind::Accelerometer => ([1.0e-2, 2.0e-2, 3.0e-2], 2, [0.1, -0.2, 0.3]),
        SensorKind::Direction | SensorKind::RelativeAttitude => ([1.0e-2; 3], 2, [0.0; 3]),
        SensorKind::RelativePosition => ([1.0e-2, 3.0e-2, 2.0e-2], 0, [-0.3, 0.2, 0.1]),
        SensorKind::RelativeVelocity => ([2.0e-2, 1.0e-2, 3.0e-2], 1, [0.2, -0.1, 0.3]),
        _ => ([1.0e-2; 3], 1, [0.3, 0.1, -0.1]),
    };
    let covariance = Matrix3::from_diagonal(&Vector3::from(variances));
    SensorRecord {
        sensor: model.sensors.iter().position(|s| s.kind == kind),
        body,
        seen_from: match kind {
            SensorKind::RelativePosition | SensorKind::RelativeVelocity => 2,
            _ => 0,
        },
        p_BoS_B: Vector3::from(place),
        ..SensorRecord::of_base(kind, covariance)
    }
}

/// A smooth motion that no vehicle makes: residuals are large, so every slope matters.
fn segment(model: &Model, tree: &Tree, translation: bool) -> Segment {
    finer(model, tree, translation, 1)
}

/// The same motion at so many samples for each.
fn finer(model: &Model, tree: &Tree, translation: bool, fine: usize) -> Segment {
    let samples = 8 * fine + 1;
    let h = 0.2 / fine as f64;
    let time_s: Vec<f64> = (0..samples).map(|k| h * k as f64).collect();
    let wave = |k: usize, phase: f64| {
        let t = h * k as f64;
        Vector3::new((t + phase).sin(), (0.7 * t - phase).cos(), (1.3 * t).sin()) * 0.3
    };
    let of = |kind, phase: f64| {
        let values = (0..samples).map(|k| match kind {
            kind if kind.is_rotation() => {
                SensorValue::Attitude(UnitQuaternion::from_scaled_axis(wave(k, phase)))
            }
            SensorKind::Direction => {
                SensorValue::direction(wave(k, phase).normalize(), wave(k, 0.9 * phase).normalize())
            }
            _ => SensorValue::Vector(wave(k, phase)),
        });
        let mut made = record(model, kind).at_every_time(values);
        if kind == SensorKind::VelocityIncrement {
            made.samples.remove(0);
            made.samples.iter_mut().for_each(|s| s.from = s.to - 1);
        }
        made
    };
    let phases = [0.0, 0.4, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
    let moves = |kind| matches!(kind, SensorKind::Velocity | SensorKind::Position);
    let pairs = KINDS.into_iter().zip(phases);
    let sensors = pairs
        .filter(|(kind, _)| translation || !moves(*kind))
        .map(|(kind, phase)| of(kind, phase))
        .collect();
    let dof = tree.dof();
    let joint = |k: usize, j: usize| 0.3 * (h * k as f64 * (1.0 + j as f64)).sin();
    let joint_position: Vec<f64> = (0..samples)
        .flat_map(|k| (0..dof).map(move |j| joint(k, j)))
        .collect();
    let joint_rate: Vec<f64> = (0..samples)
        .flat_map(|k| {
            (0..dof).map(move |j| {
                let f = 1.0 + j as f64;
                0.3 * f * (h * k as f64 * f).cos()
            })
        })
        .collect();
    let R_NB: Vec<UnitQuaternion<f64>> = (0..samples)
        .map(|k| UnitQuaternion::from_scaled_axis(wave(k, 0.4)))
        .collect();
    Segment {
        label: "made".to_owned(),
        samples: Samples {
            time_s: time_s.clone(),
            R_NB,
            w_NB_B: (0..samples).map(|k| wave(k, 0.0)).collect(),
            translation: translation.then(|| Translation {
                v_NBo_N: (0..samples).map(|k| wave(k, 1.0)).collect(),
                p_NoBo_N: (0..samples).map(|k| wave(k, 2.0)).collect(),
            }),
            joint_position: joint_position.clone(),
            joint_rate: joint_rate.clone(),
            wheel_speed: vec![20.0; samples * model.wheels.len()],
        },
        observations: Observations {
            time_s,
            sensors,
            // Near and heavy: a torque of the size of the others.
            orbit: (0..samples)
                .map(|k| {
                    let (s, c) = (h * k as f64).sin_cos();
                    let (x, y) = (Vector3::new(0.6, 0.8, 0.0), Vector3::new(0.0, 0.6, 0.8));
                    ((x * c + y * s) * 10.0, (y * c - x * s) * 10.0)
                })
                .collect(),
            joint_position,
            joint_rate,
            wheel_speed: (0..samples * model.wheels.len())
                .map(|k| 20.0 + 15.0 * h * k as f64)
                .collect(),
            smooth_wheel_speed: Vec::new(),
            joints: vec![InputChannel {
                rate: InputRate::Measured,
                ..InputChannel::default()
            }],
            wheels: Vec::new(),
            between_readings: false,
            expected_errors: Vec::new(),
        },
        accelerations: None,
        firings: vec![Firing {
            thruster: 0,
            start_s: 0.4,
            end_s: 1.0,
            force: 1.5,
        }],
    }
}

fn noise(tree: &Tree) -> Noise {
    Noise {
        gyro_sensor: Some(0),
        gyro: Matrix3::from_diagonal(&Vector3::new(1.0e-2, 2.0e-2, 3.0e-2)),
        attitude: Matrix3::identity() * 1.0e-2,
        velocity: Matrix3::identity() * 2.0e-2,
        position: Matrix3::from_diagonal(&Vector3::new(3.0e-2, 1.0e-2, 2.0e-2)),
        joint_position: vec![0.0; tree.dof()],
        joint_rate: vec![0.0; tree.dof()],
        wheel_speed: vec![0.0],
        seen_gyro: 0.0,
        seen_velocity: 0.0,
        seen_joint_rate: 0.0,
    }
}

/// Gives some sensors errors that last: a process beside white noise, nearly alone, and a walk.
fn colour(segment: &mut Segment) {
    for record in &mut segment.observations.sensors {
        let own = record.covariance;
        let slow = |share: f64, correlation_s| SlowError {
            covariance: own * share,
            correlation_s,
        };
        record.slow = match record.kind {
            SensorKind::Gyro => vec![slow(0.7, 0.3)],
            SensorKind::Velocity => vec![slow(0.999, 0.2)],
            SensorKind::Position => vec![slow(0.4, 0.5), slow(3.0, f64::INFINITY)],
            _ => Vec::new(),
        };
    }
}

/// Half the slope of the loss over every unknown of a segment: by `J^T r` and by differences.
fn slopes(translation: bool, loss: Loss) -> Vec<(String, f64, f64)> {
    let model = parse_model(MODEL, "test").unwrap();
    slopes_of(&model, translation, loss)
}

fn slopes_of(model: &Model, translation: bool, loss: Loss) -> Vec<(String, f64, f64)> {
    let tree = Tree::new(model);
    // Passive joints swing within the usual steps.
    let fine = if model.passive_joints(&tree).joints().is_empty() {
        1
    } else {
        4
    };
    let mut segments = [finer(model, &tree, translation, fine)];
    // Weights of a robust loss change what the filter makes of slow errors, which the rows take as given.
    if loss == Loss::Gaussian {
        segments.iter_mut().for_each(colour);
    }
    for segment in &mut segments {
        let sensors = &mut segment.observations.sensors;
        sensors.retain(|r| model.sensors_of(r.kind).next().is_some());
        if model.environment.point_mass_gm.is_none() {
            segment.observations.orbit.clear();
        }
    }
    let noise = noise(&tree);
    let problem = Problem {
        model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
        pace: None,
    };
    let parameters = Parameters::new(model, &tree, Equations::Momentum, true).unwrap();
    let mut experiment = Experiment::new(&problem, &parameters);
    experiment.settings.loss = loss;
    let mut point = experiment.nominal_point();
    for (k, (x, unknown)) in point.x.iter_mut().zip(&parameters.unknowns).enumerate() {
        // A lag acts through the predicted rates, whose own change with the unknowns is of second order.
        if unknown.kind.delays_inputs() {
            *x = 0.03;
            continue;
        }
        if unknown.kind.is_delay() || unknown.kind.delays_drives() {
            continue;
        }
        *x += 0.01 * (k as f64).sin() * x.abs().max(0.05);
    }
    let evaluated = experiment.evaluate(&point, true).unwrap();
    let triangle = evaluated[0].triangle.as_ref().unwrap();
    let h = experiment.unknown[0].count();
    let last = triangle.r.ncols() - 1;
    // R^T d of the triangle is J^T r of the rows.
    let by_rows = |j: usize| -> f64 {
        (0..=j)
            .map(|i| triangle.r[(i, j)] * triangle.r[(i, last)])
            .sum()
    };
    let chi2 = |p: &Iterate| {
        let evaluated = &experiment.evaluate(p, false).unwrap()[0];
        match loss {
            Loss::Gaussian => evaluated.chi2,
            _ => evaluated.cost,
        }
    };
    if loss == Loss::Gaussian {
        a_short_step_keeps_its_promise(&experiment, &point);
    }
    let mut out = Vec::new();
    for j in 0..last {
        let step = 1.0e-5;
        let ends = [step, -step].map(|d| {
            let mut p = point.clone();
            if let Some(u) = j.checked_sub(h) {
                p.x[u] += d;
            } else {
                let initial_state = &mut p.initial_states[0];
                let mut e = Vector3::zeros();
                e[j % 3] = d;
                match (j / 3, translation) {
                    _ if j >= h - 2 * model.modes.len() => {
                        initial_state.internal[j + 2 * model.modes.len() - h] += d;
                    }
                    (0, _) => initial_state.R_NB *= UnitQuaternion::from_scaled_axis(e),
                    (1, true) => initial_state.p_NoBo_N += e,
                    (2, true) => initial_state.P += e,
                    _ => initial_state.h_SScm_N += e,
                }
            }
            chi2(&p)
        });
        let name = j.checked_sub(h).map_or_else(
            || format!("initial state {j}"),
            |u| parameters.unknowns[u].name.clone(),
        );
        let by_differences = -(ends[0] - ends[1]) / (4.0 * step);
        out.push((name, by_rows(j), by_differences));
    }
    out
}

/// A step shortens with its damping, pose and momentum too, and a short one lowers chi-square by what it promises.
fn a_short_step_keeps_its_promise(experiment: &Experiment, point: &Iterate) {
    let chi2 = |p: &Iterate| {
        let evaluated = experiment.evaluate(p, false).unwrap();
        let determinant: f64 = evaluated.iter().map(|e| e.cost - e.chi2).sum();
        experiment.chi2(p, &evaluated).unwrap() - determinant
    };
    let here = experiment.linearise(point).unwrap();
    let damping = 1.0e9 * experiment.longest_column(&here.rows.evaluated).powi(2);
    let step = experiment.step(point, &here, damping);
    let (fell, promised) = (chi2(point) - chi2(&step.to), step.predicted_reduction);
    assert!(
        promised > 0.0 && (fell / promised - 1.0).abs() < 0.01,
        "fell {fell:.6e}, promised {promised:.6e} of {:.6e}",
        here.predicted_reduction
    );
}

fn slopes_agree(translation: bool, loss: Loss) {
    agree((translation, loss), slopes(translation, loss));
}

fn agree((translation, loss): (bool, Loss), slopes: Vec<(String, f64, f64)>) {
    for (name, by_rows, by_differences) in slopes {
        let gap = (by_rows - by_differences).abs();
        let size = by_rows.abs().max(by_differences.abs()).max(1.0);
        assert!(
            gap < 2.0e-6 * size,
            "{name} (translation {translation}, {loss:?}): rows {by_rows:.9e}, differences {by_differences:.9e}"
        );
    }
}

#[test]
fn exact_sensitivity_of_every_unknown_is_the_slope_of_chi2() {
    for translation in [true, false] {
        slopes_agree(translation, Loss::Gaussian);
    }
}

/// The test's vehicle without what internal states are not identified beside: instruments at points, a field, lost mass.
fn plain() -> Model {
    let mut model = parse_model(MODEL, "test").unwrap();
    let points = [SensorKind::Accelerometer, SensorKind::VelocityIncrement];
    model.sensors.retain(|s| !points.contains(&s.kind));
    model.environment = Environment::default();
    model.thrusters[0].propellant = None;
    model
}

/// The same of a vehicle whose joints springs move, one or both, all of whose numbers are unknown.
#[test]
fn exact_sensitivity_of_every_number_beside_passive_joints_is_the_slope_of_chi2() {
    for joints in [vec![1], vec![0, 1]] {
        let mut model = plain();
        (model.thrusters[0].body, model.wheels[0].body) = (0, 0);
        for k in joints {
            let joint = &mut model.joints[k];
            joint.spring_damper = Some(SpringDamper {
                stiffness: 3.0,
                damping: 0.2,
                rest: 0.1,
            });
            joint.spring_unknown = SpringNumber::ALL.to_vec();
            model.sensors.retain(|s| {
                ![SensorKind::JointPosition, SensorKind::JointRate].contains(&s.kind)
                    || !s.of.contains(&k)
            });
        }
        for translation in [true, false] {
            let mut slopes = slopes_of(&model, translation, Loss::Gaussian);
            // The wide prior of the start is in the rows and not in chi-square.
            slopes.retain(|(name, ..)| !name.starts_with("initial"));
            assert!(slopes.iter().any(|(name, ..)| name == "slide.stiffness"));
            agree((translation, Loss::Gaussian), slopes);
        }
    }
}

/// The same of a vehicle with two modes on its base, all of whose numbers are unknown.
#[test]
fn exact_sensitivity_of_every_number_of_a_mode_is_the_slope_of_chi2() {
    let mut model = plain();
    let all = ModeEstimate {
        frequency: true,
        damping: true,
        translation: true,
        rotation: true,
        inertia_slope: true,
    };
    let mode = |k: u32, sign: f64| FlexibleMode {
        name: format!("mode {k}"),
        mode: Mode {
            body: 0,
            frequency_Hz: 0.4 + 0.2 * f64::from(k),
            damping_ratio: 0.03,
            translation: Vector3::new(1.1, -0.4, 0.6) * sign,
            rotation: Vector3::new(-0.3, 0.5, 0.2),
            inertia_slope: Matrix3::new(0.4, 0.1, -0.2, 0.1, 0.3, 0.05, -0.2, 0.05, -0.3) * sign,
        },
        estimate: all,
    };
    model.modes = vec![mode(0, 1.0), mode(1, -0.5)];
    model.modes[1].mode.rotation = Vector3::new(0.1, 0.3, -0.5);
    for translation in [true, false] {
        let loss = Loss::Gaussian;
        let mut slopes = slopes_of(&model, translation, loss);
        slopes.retain(|(name, ..)| !name.starts_with("initial"));
        agree((translation, loss), slopes);
    }
}

/// The weights of a robust loss in the rows are what makes them its slope.
#[test]
fn exact_sensitivity_under_a_robust_loss_is_the_slope_of_the_loss() {
    for loss in [Loss::Huber, Loss::StudentT] {
        slopes_agree(true, loss);
    }
}

#[test]
fn unit_readings_that_are_missing_or_cut_short_are_no_panic() {
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let noise = noise(&tree);
    let mut whole = segment(&model, &tree, true);
    let mut cut = whole.clone();
    cut.observations.sensors[0].samples[3] =
        SensorSample::new(100, SensorValue::Vector(Vector3::zeros()));
    whole.observations = Observations::default();
    for segments in [[whole], [cut]] {
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: &segments,
            noise: &noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let estimate = linear(&problem).unwrap();
        assert_eq!(estimate.method, "linear");
        let refused = maximum_likelihood(&problem).unwrap_err().to_string();
        assert!(refused.contains("E0404"), "{refused}");
    }
}
