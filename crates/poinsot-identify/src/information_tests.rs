//! Sensitivities of every kind of unknown against differences of chi-square.

use crate::information::{Experiment, Point};
use crate::likelihood::{Head, HeadColumns, start};
use crate::motion::Motion;
use crate::parameters::{Equations, Parameters};
use crate::problem::Problem;
use crate::segment::{Firing, InputErrors, Noise, Observations, Samples, Segment, Translation};
use crate::vehicle::Vehicle;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use poinsot_dynamics::Tree;
use poinsot_model::{Model, parse_model};

const MODEL: &str = r#"
schema = "poinsot.model/1"
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

[[thruster]]
name = "jet"
body = "arm"
position_m = [0.1, 0.3, 0.0]
force_direction = [0.0, 1.0, 0.0]
scale = "estimate"

[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1.0e-3
bias = "estimate"
scale = "estimate"
misalignment = "estimate"
lag = "estimate"

[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 1.0e-3
lag = "estimate"

[environment]
disturbance_torque = "estimate"
drag_torque = "estimate"
"#;

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
    let all = |phase: f64| (0..samples).map(|k| Some(wave(k, phase))).collect();
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
    let none = vec![None; samples];
    Segment {
        label: "made".to_owned(),
        samples: Samples {
            time_s: time_s.clone(),
            R_NB: R_NB.clone(),
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
            rate: all(0.0),
            attitude: R_NB.into_iter().map(Some).collect(),
            velocity: if translation { all(1.0) } else { none.clone() },
            position: if translation { all(2.0) } else { none },
            velocity_arm_B: Vector3::new(0.1, 0.2, -0.3),
            position_arm_B: Vector3::new(-0.2, 0.1, 0.1),
            joint_position,
            joint_rate,
            wheel_speed: (0..samples * model.wheels.len())
                .map(|k| 20.0 + 15.0 * h * k as f64)
                .collect(),
            joint_errors: Vec::new(),
            wheel_errors: Vec::new(),
        },
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

/// Half the slope of chi-square over every unknown of a segment: by `J^T r` and by differences.
fn slopes(translation: bool) -> Vec<(String, f64, f64)> {
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let segments = [segment(&model, &tree, translation)];
    let noise = noise(&tree);
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &segments,
        noise: &noise,
        relative_accuracy: 1.0,
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    let experiment = Experiment::new(&problem, &parameters);
    let mut point = experiment.nominal_point();
    for (k, (x, unknown)) in point.x.iter_mut().zip(&parameters.unknowns).enumerate() {
        // A lag acts through the predicted rates, whose own change with the unknowns is of second order.
        if unknown.name.ends_with(".lag") {
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
    let chi2 = |p: &Point| experiment.evaluate(p, false).unwrap()[0].chi2;
    let mut out = Vec::new();
    for j in 0..last {
        let step = 1.0e-5;
        let ends = [step, -step].map(|d| {
            let mut p = point.clone();
            if let Some(u) = j.checked_sub(h) {
                p.x[u] += d;
            } else {
                let head = &mut p.heads[0];
                let mut e = Vector3::zeros();
                e[j % 3] = d;
                match (j / 3, translation) {
                    (0, _) => head.R_NB *= UnitQuaternion::from_scaled_axis(e),
                    (1, true) => head.p_NoBo_N += e,
                    (2, true) => head.P += e,
                    _ => head.h_SScm_N += e,
                }
            }
            chi2(&p)
        });
        let name = j.checked_sub(h).map_or_else(
            || format!("head {j}"),
            |u| parameters.unknowns[u].name.clone(),
        );
        let by_differences = -(ends[0] - ends[1]) / (4.0 * step);
        out.push((name, by_rows(j), by_differences));
    }
    out
}

#[test]
fn exact_sensitivity_of_every_unknown_is_the_slope_of_chi2() {
    for translation in [true, false] {
        for (name, by_rows, by_differences) in slopes(translation) {
            let gap = (by_rows - by_differences).abs();
            let size = by_rows.abs().max(by_differences.abs()).max(1.0);
            assert!(
                gap < 2.0e-6 * size,
                "{name} (translation {translation}): rows {by_rows:.9e}, differences {by_differences:.9e}"
            );
        }
    }
}

/// Whitened residual and sensitivities squared: chi-square and `J^T C^-1 [J r]` of the filter against those of the
/// dense covariance `C = S + G E G^T`, with `G` from differences over every reading of every input.
fn dense(translation: bool, fine: usize, joints: [InputErrors; 2], wheel: InputErrors) -> f64 {
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let mut made = finer(&model, &tree, translation, fine);
    made.observations.joint_errors = joints.to_vec();
    made.observations.wheel_errors = vec![wheel];
    let mut noise = noise(&tree);
    noise.joint_position = vec![4.0e-4, 1.0e-4];
    noise.wheel_speed = vec![40.0];
    // Small sensor noise: then nearly all of the residual's covariance is that of the inputs.
    noise.gyro *= 1.0e-3;
    noise.attitude *= 1.0e-3;
    noise.velocity *= 1.0e-3;
    noise.position *= 1.0e-3;
    let silent = Noise {
        joint_position: vec![0.0; 2],
        wheel_speed: vec![0.0],
        ..noise.clone()
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    // The start must not follow what the readings say.
    let head = Head {
        R_NB: UnitQuaternion::from_euler_angles(0.1, 0.2, -0.3),
        p_NoBo_N: Vector3::zeros(),
        P: Vector3::new(1.0, 2.0, -1.0) * f64::from(u8::from(translation)),
        h_SScm_N: Vector3::new(0.4, -0.3, 0.5),
    };
    let predicted = |segment: &Segment, head: &Head| {
        let spin = [0.002];
        let x = parameters.nominal_vector();
        let vehicle = Vehicle::new(&tree, &model.thrusters, &parameters, &spin, &x);
        let mut motion = Motion::new(&vehicle, segment, Vec::new(), 0);
        let (mut state, _) = start(
            head,
            HeadColumns {
                attitude: false,
                position: false,
                linear: false,
                angular: false,
            },
            x.len(),
        );
        let samples = segment.observations.time_s.len();
        let mut all = Vec::new();
        for k in 0..samples {
            let twist = motion.velocity(&state, k).unwrap().0.twist;
            let arm = segment.observations.velocity_arm_B;
            let v = state.R_NB * (twist.v + twist.w.cross(&arm));
            let p = state.p_NoBo_N + state.R_NB * segment.observations.position_arm_B;
            all.push((state.R_NB, v, twist.w, p));
            if k + 1 < samples {
                state = motion.advance(&state, k).unwrap();
            }
        }
        all
    };
    let evaluate = |segment: &Segment, noise: &Noise| {
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: std::slice::from_ref(segment),
            noise,
            relative_accuracy: 1.0,
        };
        let experiment = Experiment::new(&problem, &parameters);
        let mut point = experiment.nominal_point();
        point.heads[0] = head;
        experiment.evaluate(&point, false).unwrap().remove(0)
    };
    // Close to the prediction: slopes of residuals in turning axes depend on the residual.
    for (k, (R, v, w, p)) in predicted(&made, &head).into_iter().enumerate() {
        let error = Vector3::new((k as f64).sin(), (2.0 * k as f64).cos(), 0.5) * 1.0e-2;
        let o = &mut made.observations;
        o.attitude[k] = Some(R * UnitQuaternion::from_scaled_axis(error));
        o.velocity[k] = o.velocity[k].map(|_| v + error);
        o.rate[k] = Some(w + error);
        o.position[k] = o.position[k].map(|_| p + error);
    }
    // Residuals in units of the sensors' noise: C = 1 + G E G^T.
    let white = |segment: &Segment| -> Vec<f64> {
        let channels = evaluate(segment, &silent).channels;
        channels
            .iter()
            .flat_map(|c| &c.white)
            .flat_map(|w| w.iter().copied().collect::<Vec<_>>())
            .collect()
    };
    let residual = nalgebra::DVector::from_vec(white(&made));
    let samples = made.observations.time_s.len();
    let mut C = nalgebra::DMatrix::identity(residual.len(), residual.len());
    for input in 0..3 {
        let (variance, errors, step) = match input {
            2 => (40.0, made.observations.wheel_errors[0].clone(), 1.0e-3),
            j => (
                noise.joint_position[j],
                made.observations.joint_errors[j].clone(),
                1.0e-6,
            ),
        };
        let slope = |k: usize| {
            let ends = [step, -step].map(|d| {
                let mut moved = made.clone();
                let o = &mut moved.observations;
                match input {
                    2 => o.wheel_speed[k] += d,
                    j => o.joint_position[2 * k + j] += d,
                }
                nalgebra::DVector::from_vec(white(&moved))
            });
            (&ends[0] - &ends[1]) / (2.0 * step)
        };
        let G: Vec<_> = (0..samples).map(slope).collect();
        for i in 0..samples {
            for j in 0..samples {
                let between = i.min(j)..i.max(j);
                let correlation: f64 = between.map(|k| errors.memory(k)).product();
                C += &G[i] * G[j].transpose() * (variance * correlation);
            }
        }
    }
    let solved = C.clone().cholesky().unwrap().solve(&residual);
    let expected = residual.dot(&solved);
    let found = evaluate(&made, &noise);
    let log_det = 2.0 * C.cholesky().unwrap().l().diagonal().map(f64::ln).sum();
    let plain = residual.norm_squared();
    assert!(
        expected < 0.97 * plain,
        "the inputs' noise must matter: {expected} of {plain}"
    );
    let gap = (found.chi2 / expected - 1.0).abs();
    gap.max(((found.cost - found.chi2) / log_det - 1.0).abs())
}

#[test]
fn exact_chi2_with_noise_in_the_inputs_is_that_of_the_dense_covariance() {
    let kept = |a: f64| InputErrors::Kept(vec![a; 200]);
    for translation in [true, false] {
        let white = || [InputErrors::Independent, InputErrors::Independent];
        let coarse = dense(translation, 2, white(), InputErrors::Independent);
        let fine = dense(translation, 4, white(), InputErrors::Independent);
        let lasting = dense(translation, 4, [InputErrors::Locked, kept(0.7)], kept(0.9));
        // Measured: 6e-4, 2e-4 and 3e-4.
        assert!(fine < 5.0e-4 && lasting < 1.0e-3, "{fine:e} {lasting:e}");
        // The trapezium over a step is of second order.
        assert!(fine < 0.5 * coarse, "{coarse:e} {fine:e}");
    }
}
