//! The filter of the inputs' noise against the covariance that it stands for, made in full.

use super::{MODEL, finer, noise};
use crate::fit::experiment::Experiment;
use crate::likelihood::InitialState;
use crate::motion::Motion;
use crate::motion::Vehicle;
use crate::problem::Problem;
use crate::problem::alternative::BetweenSamples;
use crate::problem::error_process::{ErrorProcess, ErrorStep};
use crate::problem::parameters::{Equations, Parameters};
use crate::problem::segment::{
    BetweenReadings, InputChannel, InputErrors, InputRate, Noise, Observations, Segment,
    SensorRecord, SensorValue,
};
use crate::sensors::ideal_measurement;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use poinsot_dynamics::Tree;
use poinsot_dynamics::propagation::PoseMomentum;
use poinsot_model::{SensorKind, SlowError, parse_model};

/// How the problem is put.
#[derive(Debug, Clone, Copy, Default)]
struct Case {
    translation: bool,
    /// Samples for each of the plain motion.
    fine: usize,
    /// Whether an accelerometer and velocity increments are read.
    points: bool,
    smooth: bool,
    /// Whether the noise of some sensors is correlated.
    coloured: bool,
    /// Whether the speed of the wheel is a process whose slope drives too.
    random: bool,
}

/// Relative gaps of the filter to the dense covariance.
#[derive(Debug, Clone, Copy)]
struct Gaps {
    /// Of chi-square and of `ln det`.
    likelihood: f64,
    /// Of what all samples together make of the inputs' errors, which were expected not to be zero, and of chi-square then.
    smoothed: f64,
}

/// Relative gap of chi-square and `ln det` of the filter to those of the dense covariance `C = S + G E G^T`, with `G`
/// from differences over every sample of every input.
fn dense(case: Case, joints: [InputErrors; 2], wheel: InputErrors) -> f64 {
    gaps(case, joints, wheel).likelihood
}

fn gaps(case: Case, joints: [InputErrors; 2], wheel: InputErrors) -> Gaps {
    let Case {
        translation, fine, ..
    } = case;
    let model = parse_model(MODEL, "test").unwrap();
    let tree = Tree::new(&model);
    let mut made = finer(&model, &tree, translation, fine);
    let times = made.observations.time_s.len();
    let channel = |errors: InputErrors| InputChannel {
        errors,
        acceleration: (0..times).map(|k| 0.1 * (k as f64).sin()).collect(),
        ..InputChannel::default()
    };
    let mut noise = noise(&tree);
    noise.joint_position = vec![4.0e-4, 1.0e-4];
    noise.wheel_speed = vec![40.0];
    // Small sensor noise: then nearly all of the residual's covariance is that of the inputs.
    let points = |r: &SensorRecord| {
        matches!(
            r.kind,
            SensorKind::Accelerometer | SensorKind::VelocityIncrement
        )
    };
    for record in &mut made.observations.sensors {
        record.scale_noise(if points(record) { 1.0e-1 } else { 1.0e-3 });
    }
    if case.points {
        noise.joint_position = vec![4.0e-5, 1.0e-5];
        noise.wheel_speed = vec![4.0];
        // Beside so small errors of the inputs a relative pose adds residuals that hardly depend on them.
        let relative = |r: &SensorRecord| r.kind.is_relative();
        made.observations.sensors.retain(|r| !relative(r));
    } else {
        // With directions the coarse gap is as small as the fine one, by chance; they stay beside the points.
        let seen = |r: &SensorRecord| r.kind == SensorKind::Direction;
        made.observations.sensors.retain(|r| !points(r) && !seen(r));
    }
    let joint = |j: usize| channel(of_variance(&joints[j], noise.joint_position[j]));
    made.observations.joints = [0, 1].map(joint).to_vec();
    let mut of_wheel = channel(of_variance(&wheel, noise.wheel_speed[0]));
    match case.random {
        true => of_wheel.rate = InputRate::Random,
        false => of_wheel.acceleration.clear(),
    }
    made.observations.wheels = vec![of_wheel];
    if case.coloured {
        super::colour(&mut made);
    }
    let silent = Noise {
        joint_position: vec![0.0; 2],
        wheel_speed: vec![0.0],
        ..noise.clone()
    };
    let parameters = Parameters::new(&model, &tree, Equations::Momentum, true).unwrap();
    // The start must not follow what the readings say.
    let initial_state = InitialState::from(PoseMomentum {
        R_NB: UnitQuaternion::from_euler_angles(0.1, 0.2, -0.3),
        p_NoBo_N: Vector3::zeros(),
        P: Vector3::new(1.0, 2.0, -1.0) * f64::from(u8::from(translation)),
        h_SScm_N: Vector3::new(0.4, -0.3, 0.5),
    });
    let predicted = |segment: &Segment, initial_state: &InitialState| {
        let spin = [0.002];
        let x = parameters.nominal_vector();
        let mut vehicle = Vehicle::new(&tree, &model.thrusters, &parameters, &spin, &x);
        vehicle.wheels_smooth = case.smooth;
        let mut motion = Motion::new(&vehicle, segment, Vec::new(), 0);
        let mut state = *initial_state;
        let samples = segment.observations.time_s.len();
        let mut all = Vec::new();
        for k in 0..samples {
            let instant = motion.velocity(&state, k).unwrap().0;
            let sensors = segment.observations.sensors.iter();
            let values: Vec<SensorValue> = sensors
                .map(|r| {
                    ideal_measurement(r, &mut motion, (&state, k), &instant)
                        .unwrap()
                        .0
                })
                .collect();
            all.push(values);
            if k + 1 < samples {
                state = motion.advance(&state, k).unwrap();
            }
        }
        all
    };
    let evaluate_with = |segment: &Segment, noise: &Noise, smooth_inputs: bool| {
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: std::slice::from_ref(segment),
            noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let mut experiment = Experiment::new(&problem, &parameters);
        experiment.wheels = match case.smooth {
            true => BetweenSamples::Smooth,
            false => BetweenSamples::Held,
        };
        let mut point = experiment.nominal_point();
        point.initial_states[0] = initial_state;
        experiment.smooth_inputs = smooth_inputs;
        experiment.evaluate(&point, false).unwrap().remove(0)
    };
    let evaluate = |segment: &Segment, noise: &Noise| evaluate_with(segment, noise, false);
    // Close to the prediction: slopes of residuals in turning axes depend on the residual.
    let mut before: Vec<SensorValue> = Vec::new();
    for (k, values) in predicted(&made, &initial_state).into_iter().enumerate() {
        let error = Vector3::new((k as f64).sin(), (2.0 * k as f64).cos(), 0.5) * 1.0e-2;
        let sensors = made.observations.sensors.iter_mut().zip(&values);
        for (i, (record, value)) in sensors.enumerate() {
            let larger = if points(record) { 3.0 } else { 1.0 };
            let here = record.samples.iter_mut().find(|s| s.to == k);
            let Some(here) = here else { continue };
            here.value = match (*value, before.get(i)) {
                (SensorValue::Attitude(R), _) => {
                    SensorValue::Attitude(R * UnitQuaternion::from_scaled_axis(error))
                }
                (SensorValue::Vector(x), Some(SensorValue::Vector(was)))
                    if record.kind == SensorKind::VelocityIncrement =>
                {
                    SensorValue::Vector(x - was + error * larger)
                }
                (SensorValue::Vector(x), _) => match here.value {
                    SensorValue::Direction { reference_N, .. } => {
                        SensorValue::direction((x + error).normalize(), reference_N)
                    }
                    _ => SensorValue::Vector(x + error * larger),
                },
                (other, _) => other,
            };
        }
        before = values;
    }
    // Residuals in units of the sensors' white noise: C = 1 + S + G E G^T, with S the errors that last.
    let white = |segment: &Segment| -> Vec<f64> {
        let mut plain = segment.clone();
        for record in &mut plain.observations.sensors {
            record.covariance = record.white();
            record.slow.clear();
        }
        let Observations { joints, wheels, .. } = &mut plain.observations;
        for input in joints.iter_mut().chain(wheels) {
            input.errors = of_variance(&input.errors, 1.0e-20);
        }
        let channels = evaluate(&plain, &silent).channels;
        channels
            .iter()
            .flat_map(|c| &c.white)
            .flat_map(|w| w.iter().copied().collect::<Vec<_>>())
            .collect()
    };
    let residual = nalgebra::DVector::from_vec(white(&made));
    let samples = made.observations.time_s.len();
    let mut C = nalgebra::DMatrix::identity(residual.len(), residual.len());
    add_lasting(&mut C, &made.observations);
    let mut inputs = Vec::new();
    for input in 0..3 {
        let (variance, errors, step) = match input {
            2 => (noise.wheel_speed[0], wheel.clone(), 1.0e-3),
            j => (noise.joint_position[j], joints[j].clone(), 1.0e-6),
        };
        let slope_of = |input: usize, step: f64, k: usize| {
            let ends = [step, -step].map(|d| {
                let mut moved = made.clone();
                let o = &mut moved.observations;
                match input {
                    4 if case.random => o.wheels[0].acceleration[k] += d,
                    5.. => o.joints[input - 5].acceleration[k] += d,
                    3.. => o.joint_rate[2 * k + input - 3] += d,
                    2 => o.wheel_speed[k] += d,
                    j => o.joint_position[2 * k + j] += d,
                }
                nalgebra::DVector::from_vec(white(&moved))
            });
            (&ends[0] - &ends[1]) / (2.0 * step)
        };
        let slope = |k: usize| slope_of(input, step, k);
        let G: Vec<_> = (0..samples).map(slope).collect();
        let mut all = nalgebra::DMatrix::from_columns(&G);
        let mut own = nalgebra::DMatrix::from_fn(samples, samples, |i, j| {
            variance * correlation(&errors, i, j)
        });
        if let (true, InputErrors::Process(of)) = (input < 2 || case.random, &errors) {
            // Positions, then rates, then accelerations; speeds, then their slopes.
            let slopes: &[usize] = if input < 2 { &[3, 5] } else { &[2] };
            let slopes = slopes
                .iter()
                .flat_map(|more| (0..samples).map(move |k| (more, k)));
            let slopes = slopes.map(|(more, k)| slope_of(input + more, 1.0e-4, k));
            let columns: Vec<_> = G.iter().cloned().chain(slopes).collect();
            all = nalgebra::DMatrix::from_columns(&columns);
            own = nalgebra::DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
                let all = covariance(of, i % samples, j % samples);
                variance * all[(i / samples, j / samples)]
            });
        }
        C += &all * own * all.transpose();
        inputs.push((variance, errors, G));
    }
    let solution = C.clone().cholesky().unwrap().solve(&residual);
    let expected = residual.dot(&solution);
    let found = evaluate(&made, &noise);
    let log_det = 2.0
        * C.clone()
            .cholesky()
            .unwrap()
            .l()
            .diagonal()
            .map(f64::ln)
            .sum();
    // The filter counts it from the whole noise of the sensors, C from the white part.
    let share = |r: &SensorRecord| (r.covariance.determinant() / r.white().determinant()).ln();
    let sensors = made.observations.sensors.iter();
    let log_det = log_det
        - sensors
            .map(|r| r.samples.len() as f64 * share(r))
            .sum::<f64>();
    let plain = residual.norm_squared();
    assert!(
        expected < 0.97 * plain,
        "the inputs' noise must matter: {expected} of {plain}"
    );
    let gap = (found.chi2 / expected - 1.0).abs();
    let likelihood = gap.max(((found.cost - found.chi2) / log_det - 1.0).abs());
    let free = matches!(
        wheel,
        InputErrors::Process(_) | InputErrors::Interpolated(_)
    );
    let is_process = |e: &InputErrors| matches!(e, InputErrors::Process(_));
    if free || joints.iter().any(is_process) {
        return Gaps {
            likelihood,
            smoothed: f64::NAN,
        };
    }
    // Errors that are expected to be something: the residual is `n - G e`.
    let width = inputs.len();
    let mean = |c: usize, k: usize| inputs[c].0.sqrt() * (1.0 + (k * width + c) as f64).sin();
    let mut moved = made.clone();
    let rows = (0..samples * width).map(|i| mean(i % width, i / width));
    moved.observations.expected_errors = rows.collect();
    let mut left = residual.clone();
    for (c, (_, _, G)) in inputs.iter().enumerate() {
        (0..samples).for_each(|k| left += &G[k] * mean(c, k));
    }
    let solution = C.cholesky().unwrap().solve(&left);
    let found = evaluate_with(&moved, &noise, true);
    let chi2 = (found.chi2 / left.dot(&solution) - 1.0).abs();
    let smoothed = found.smoothed.unwrap().observations;
    let (mut off, mut size): (f64, f64) = (0.0, 0.0);
    for (c, (variance, errors, G)) in inputs.iter().enumerate() {
        for k in 0..samples {
            let toward = |j: usize| variance * correlation(errors, k, j) * G[j].dot(&solution);
            let change = -(0..samples).map(toward).sum::<f64>();
            let error = mean(c, k) - smoothed.expected_errors[k * width + c];
            let (now, before) = match c {
                2 => (&smoothed.wheel_speed, &made.observations.wheel_speed),
                _ => (&smoothed.joint_position, &made.observations.joint_position),
            };
            let at = if c == 2 { k } else { 2 * k + c };
            assert!((now[at] - before[at] - error).abs() < 1.0e-9);
            off = off.max((error - mean(c, k) - change).abs() / variance.sqrt());
            size = size.max(change.abs() / variance.sqrt());
        }
    }
    assert!(size > 0.3, "the samples tell of the errors: {size}");
    Gaps {
        likelihood,
        smoothed: chi2.max(off / size),
    }
}

/// Adds the covariance of the sensors' slow errors, in units of their white noise, sensor by sensor.
fn add_lasting(C: &mut nalgebra::DMatrix<f64>, o: &Observations) {
    let mut first = 0;
    for record in &o.sensors {
        let unit = record
            .white()
            .cholesky()
            .unwrap()
            .l()
            .try_inverse()
            .unwrap();
        let times: Vec<f64> = record.samples.iter().map(|s| o.time_s[s.to]).collect();
        for (i, a) in times.iter().enumerate() {
            for (j, b) in times.iter().enumerate() {
                let share = |s: &SlowError| match s.is_walk() {
                    true => a.min(*b) - o.time_s[0],
                    false => (-(a - b).abs() / s.correlation_s).exp(),
                };
                let all = record.slow.iter().map(|s| s.covariance * share(s));
                let block: Matrix3<f64> = unit * all.sum::<Matrix3<f64>>() * unit.transpose();
                let mut at = C.fixed_view_mut::<3, 3>(first + 3 * i, first + 3 * j);
                at += block;
            }
        }
        first += 3 * times.len();
    }
}

/// Correlation of the errors at two grid times, for unit variance of a reading.
fn correlation(errors: &InputErrors, i: usize, j: usize) -> f64 {
    let places = match errors {
        InputErrors::Interpolated(places) => places,
        InputErrors::Process(process) => return covariance(process, i, j)[(0, 0)],
        _ => return (i.min(j)..i.max(j)).map(|k| errors.memory(k)).product(),
    };
    let shares = |k: usize| {
        let BetweenReadings { reading, share } = places[k];
        [(reading, 1.0 - share), (reading + 1, share)]
    };
    let pairs = shares(i)
        .into_iter()
        .flat_map(|a| shares(j).map(|b| (a, b)));
    let common = pairs.filter(|(a, b)| a.0 == b.0);
    common.map(|(a, b)| a.1 * b.1).sum()
}

/// Covariance of value, slope and its slope at one grid time with those at another one.
fn covariance(process: &ErrorProcess, i: usize, j: usize) -> Matrix3<f64> {
    let (first, last) = (i.min(j), i.max(j));
    let along = |P, s: ErrorStep| s.memory * P * s.memory.transpose() + s.fresh;
    let here = process.steps().take(first).fold(process.initial, along);
    let on = process.steps().take(last).skip(first);
    let later = on.fold(here, |P, s| s.memory * P);
    if i > j { later } else { later.transpose() }
}

/// The errors with this variance instead of one; all but a process have it beside them.
fn of_variance(errors: &InputErrors, variance: f64) -> InputErrors {
    let InputErrors::Process(process) = errors else {
        return errors.clone();
    };
    let step = |s: ErrorStep| ErrorStep {
        fresh: s.fresh * variance,
        ..s
    };
    let initial = process.initial * variance;
    InputErrors::Process(ErrorProcess::new(initial, process.steps().map(step)))
}

/// A speed whose error moves with those of its slope and of the slope of that, new in all at every third grid time.
fn process() -> InputErrors {
    let step = |k: usize| ErrorStep {
        memory: Matrix3::new(0.9, 0.3, 0.1, -0.2, 0.8, -0.1, 0.05, -0.1, 0.7),
        fresh: Matrix3::new(0.2, 0.05, 0.02, 0.05, 0.3, 0.1, 0.02, 0.1, 0.2)
            * f64::from(u8::from(k.is_multiple_of(3))),
        within: 0.0,
    };
    let initial = Matrix3::new(1.0, -0.3, 0.1, -0.3, 0.5, 0.1, 0.1, 0.1, 0.4);
    InputErrors::Process(ErrorProcess::new(initial, (0..200).map(step)))
}

/// A speed whose error moves with that of its slope, new in both at every second grid time.
fn turning() -> InputErrors {
    let step = |k: usize| ErrorStep {
        memory: Matrix3::new(0.9, 0.2, 0.0, -0.2, 0.8, 0.0, 0.0, 0.0, 0.0),
        fresh: Matrix3::new(0.2, 0.3, 0.0, 0.3, 2.0, 0.0, 0.0, 0.0, 0.0)
            * f64::from(u8::from(k.is_multiple_of(2))),
        within: 0.0,
    };
    let initial = Matrix3::new(1.0, -0.3, 0.0, -0.3, 5.0, 0.0, 0.0, 0.0, 0.0);
    InputErrors::Process(ErrorProcess::new(initial, (0..200).map(step)))
}

/// Readings every so many grid times.
fn interpolated(every: f64) -> InputErrors {
    let place = |k: usize| {
        let at = 0.4 + k as f64 / every;
        BetweenReadings {
            reading: at as usize,
            share: at.fract(),
        }
    };
    InputErrors::Interpolated((0..200).map(place).collect())
}

#[test]
fn exact_chi2_with_noise_in_the_inputs_is_that_of_the_dense_covariance() {
    let kept = |a: f64| InputErrors::Kept(vec![a; 200]);
    for translation in [true, false] {
        let case = |fine: usize| Case {
            translation,
            fine,
            ..Case::default()
        };
        let white = || [InputErrors::Independent, InputErrors::Independent];
        let coarse = dense(case(2), white(), InputErrors::Independent);
        let fine = dense(case(4), white(), InputErrors::Independent);
        let lasting = dense(case(4), [InputErrors::Locked, kept(0.7)], kept(0.9));
        let between = [2.5, 7.0].map(|every| dense(case(4), white(), interpolated(every)));
        let driven = dense(case(4), white(), process());
        assert!(driven < 5.0e-4, "{driven:e}");
        let random = Case {
            random: true,
            ..case(4)
        };
        let random = dense(random, white(), turning());
        assert!(random < 5.0e-4, "{random:e}");
        let joints = [process(), InputErrors::Independent];
        let smoothed = dense(case(4), joints, InputErrors::Independent);
        assert!(smoothed < 1.0e-3, "{smoothed:e}");
        // Measured: 6e-4, 2e-4 and 3e-4.
        assert!(fine < 5.0e-4 && lasting < 1.0e-3, "{fine:e} {lasting:e}");
        assert!(between.iter().all(|gap| *gap < 5.0e-4), "{between:?}");
        // The trapezium over a step is of second order.
        assert!(fine < 0.5 * coarse, "{coarse:e} {fine:e}");
    }
}

#[test]
fn exact_chi2_of_instruments_at_points_with_noise_in_the_inputs_is_that_of_the_dense_covariance() {
    let kept = |a: f64| InputErrors::Kept(vec![a; 200]);
    let white = || [InputErrors::Independent, InputErrors::Independent];
    // Measured: 4e-5.
    for (translation, smooth) in [(true, false), (false, true)] {
        let case = Case {
            translation,
            fine: 4,
            smooth,
            points: true,
            ..Case::default()
        };
        let fresh = dense(case, white(), InputErrors::Independent);
        let lasting = dense(case, [kept(0.5), kept(0.7)], kept(0.9));
        let between = dense(case, white(), interpolated(2.5));
        assert!(fresh < 2.0e-4 && lasting < 2.0e-4, "{fresh:e} {lasting:e}");
        assert!(between < 2.0e-4, "{between:e}");
        let driven = dense(case, [kept(0.5), kept(0.7)], process());
        assert!(driven < 2.0e-4, "{driven:e}");
        let smoothed = dense(case, [process(), kept(0.7)], process());
        assert!(smoothed < 2.0e-4, "{smoothed:e}");
        let case = Case {
            random: true,
            ..case
        };
        let random = dense(case, white(), turning());
        assert!(random < 2.0e-4, "{random:e}");
    }
}

/// The backward pass, and expected errors, against the normal distribution of all readings; white and coloured ones.
#[test]
fn exact_smoothed_inputs_are_those_of_the_dense_covariance() {
    let kept = |a: f64| InputErrors::Kept(vec![a; 200]);
    let white = || [InputErrors::Independent, InputErrors::Independent];
    for (translation, coloured) in [(true, false), (false, true)] {
        let case = Case {
            translation,
            fine: 4,
            coloured,
            ..Case::default()
        };
        let fresh = gaps(case, white(), InputErrors::Independent);
        let lasting = gaps(case, [InputErrors::Locked, kept(0.7)], kept(0.9));
        for found in [fresh, lasting] {
            assert!(found.likelihood < 1.0e-3, "{case:?} {found:?}");
            assert!(found.smoothed < 1.0e-2, "{case:?} {found:?}");
        }
    }
}
