//! Evaluation of a problem at any value of its unknowns, without the rest of the estimator.

use crate::{nutation, vehicle};

use nutation::{Cell, bus, study, study_of};
use poinsot::bind::bind;
use poinsot_dynamics::{SensorKind, Tree};
use poinsot_identify::{
    Evaluator, Firing, Information, Noise, Observations, Problem, ROUGH, Samples, Segment,
    SensorRecord, SensorValue, WantedTerm, maximum_likelihood,
};
use poinsot_model::{EstimateSet, Model, Nuisance, RandomTorque};
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_testkit::vehicles::ModelText;

/// One record of the nutating bus, bound.
fn record() -> (Model, Tree, Vec<Segment>, Noise) {
    let cell = Cell {
        stored_N_m_s: 3.0,
        rate_hz: 2.0,
    };
    let (tables, _) = study(cell).draw(1);
    let (model, tree) = (bus(), Tree::new(&bus()));
    let bound = bind(&model, &tree, &tables).unwrap();
    (model, tree, bound.segments, bound.noise)
}

fn problem<'a>(record: &'a (Model, Tree, Vec<Segment>, Noise)) -> Problem<'a> {
    Problem {
        model: &record.0,
        tree: &record.1,
        segments: &record.2,
        noise: &record.3,
        relative_accuracy: 1.0,
        pace: None,
    }
}

/// Gauss-Newton steps from the nominal numbers.
fn fitted(evaluator: &Evaluator) -> Vec<f64> {
    let mut x = evaluator.nominal();
    for _ in 0..8 {
        let here = evaluator.at(&x).unwrap();
        let step = here.covariance.unwrap() * (here.jacobian.transpose() * here.residuals);
        x.iter_mut().zip(step.iter()).for_each(|(x, d)| *x -= d);
    }
    x
}

#[test]
fn exact_jacobian_is_the_slope_of_the_residuals_and_of_the_likelihood() {
    let record = record();
    let evaluator = Evaluator::new(&problem(&record)).unwrap();
    // Near the fit: derivatives of an attitude hold to first order in its residual.
    let mut x = fitted(&evaluator);
    x[0] += 3.0e-5;
    x[1] -= 2.0e-5;
    let here = evaluator.at(&x).unwrap();
    assert_eq!(here.jacobian.nrows(), here.residuals.len());
    let gradient = -(here.jacobian.transpose() * &here.residuals);
    for (k, unknown) in evaluator.unknowns().iter().enumerate() {
        let step = 1.0e-6;
        let [up, down] = [step, -step].map(|d| {
            let mut there = x.clone();
            there[k] += d;
            evaluator.at(&there).unwrap()
        });
        let by_differences = (&up.residuals - &down.residuals) / (2.0 * step);
        let column = here.jacobian.column(k);
        let gap = (&by_differences - column).norm() / column.norm();
        assert!(gap < 1.0e-3, "{}: {gap:e}", unknown.name);
        let slope = (up.log_likelihood - down.log_likelihood) / (2.0 * step);
        let gap = (slope - gradient[k]).abs() / column.norm() / here.residuals.norm();
        assert!(gap < 1.0e-3, "{}: {gap:e}", unknown.name);
    }
}

#[test]
fn exact_gauss_and_newton_on_an_evaluation_end_where_the_fit_does() {
    let record = record();
    let problem = problem(&record);
    let evaluator = Evaluator::new(&problem).unwrap();
    let x = fitted(&evaluator);
    let here = evaluator.at(&x).unwrap();
    let covariance = here.covariance.as_ref().unwrap();
    let estimate = maximum_likelihood(&problem).unwrap();
    let body = &estimate.bodies[0];
    let first = x.len() - 6;
    for (k, number) in body.inertia.iter().enumerate() {
        let (value, sigma) = (number.value.unwrap(), number.sigma.unwrap());
        let at = first + k;
        let own = covariance[(at, at)].sqrt();
        let name = &evaluator.unknowns()[at].name;
        assert!(
            (x[at] - value).abs() < 0.01 * sigma,
            "{name}: {} {value}",
            x[at]
        );
        assert!((own / sigma - 1.0).abs() < 0.05, "{name}: {own} {sigma}");
    }
    let squares = here.residuals.norm_squared();
    let by_sensor: f64 = here
        .sensors
        .iter()
        .flat_map(|s| &s.white)
        .map(|w| w.norm_squared())
        .sum();
    assert!((squares - by_sensor).abs() < 1.0e-9 * squares);
    assert_eq!(here.sensors.len(), 2);
    assert!((squares / here.residuals.len() as f64 - 1.0).abs() < 0.2);
}

/// Heavy wheels, one sample per radian of nutation: the curvature of relative speeds is a hundred times the sensor
/// noise.
#[test]
fn exact_rotors_under_constant_torque_drive_the_motion_between_samples() {
    let mut heavy = bus();
    heavy.wheels.iter_mut().for_each(|w| w.spin_inertia = 0.1);
    let cell = Cell {
        stored_N_m_s: 18.0,
        rate_hz: 1.0,
    };
    let exact = study_of(cell, heavy.clone()).exact;
    let tree = Tree::new(&heavy);
    let bound = bind(&heavy, &tree, &exact).unwrap();
    let record = (heavy, tree, bound.segments, bound.noise);
    let evaluator = Evaluator::new(&problem(&record)).unwrap();
    let x = evaluator.nominal();
    let here = evaluator.at(&x).unwrap();
    let left = here.residuals.norm();
    println!("residual of an exact record: {left:.4} sigma");
    assert!(left < 0.3, "{left}");
    for (k, unknown) in evaluator.unknowns().iter().enumerate() {
        let step = 1.0e-5;
        let [up, down] = [step, -step].map(|d| {
            let mut there = x.clone();
            there[k] += d;
            evaluator.at(&there).unwrap().residuals
        });
        let by_differences = (up - down) / (2.0 * step);
        let column = here.jacobian.column(k);
        let gap = (&by_differences - column).norm() / column.norm();
        println!("{}: {gap:.1e}", unknown.name);
        assert!(gap < 1.0e-3, "{}: {gap:e}", unknown.name);
    }
}

#[test]
fn unit_short_and_ragged_arrays_are_errors_with_a_code() {
    let whole = record();
    let refused = |spoil: &dyn Fn(&mut Segment, &mut Noise)| {
        let mut record = whole.clone();
        spoil(&mut record.2[0], &mut record.3);
        match Evaluator::new(&problem(&record)) {
            Ok(_) => panic!("not refused"),
            Err(error) => error.to_string(),
        }
    };
    type Spoil<'a> = &'a dyn Fn(&mut Segment, &mut Noise);
    let all: [(&str, Spoil); 9] = [
        ("E0411", &|s, _| s.samples.w_NB_B.truncate(3)),
        ("E0411", &|s, _| s.samples.R_NB.clear()),
        ("E0411", &|s, _| s.samples.wheel_speed.truncate(7)),
        ("E0411", &|s, _| s.observations.time_s.truncate(3)),
        ("E0411", &|s, _| {
            s.observations.sensors[0].samples[2].to = 100_000
        }),
        ("E0411", &|s, _| s.observations.wheel_speed.truncate(4)),
        ("E0411", &|_, n| n.wheel_speed.clear()),
        ("E0411", &|s, _| {
            s.firings.push(Firing {
                thruster: 5,
                start_s: 1.0,
                end_s: 2.0,
                force: 1.0,
            });
        }),
        ("E0404", &|s, _| s.samples.time_s.clear()),
    ];
    for (code, spoil) in all {
        let message = refused(spoil);
        assert!(message.starts_with(code), "{message}");
    }
    let evaluator = Evaluator::new(&problem(&whole)).unwrap();
    for length in [0, 3, 13] {
        let error = evaluator.at(&vec![0.1; length]).unwrap_err().to_string();
        assert!(error.starts_with("E0411 values of the unknowns"), "{error}");
    }
    // An unphysical inertia.
    let mut x = evaluator.nominal();
    *x.last_mut().unwrap() = -20.0;
    assert!(
        evaluator
            .at(&x)
            .unwrap_err()
            .to_string()
            .starts_with("E0405")
    );
}

/// Cost of thrust that changes at every sample: run with `--run-ignored only --no-capture`.
#[test]
#[ignore = "measures time"]
fn stat_thrust_that_changes_every_sample_costs_time_linear_in_the_samples() {
    let text = ModelText::new("tug")
        .body(
            "tug",
            40.0,
            [0.0; 3],
            [3.0, 2.5, 4.0, 0.0, 0.0, 0.0],
            "estimate = true",
        )
        .thruster("jet", "tug", [0.1, 0.3, 0.0], [0.0, 1.0, 0.0])
        .sensor("gyro", "gyro", "noise_rad_s = 1.0e-3")
        .text();
    let model = poinsot_model::parse_model(&text, "tug.toml").unwrap();
    let tree = Tree::new(&model);
    let noise = record().3;
    let noise = Noise {
        wheel_speed: Vec::new(),
        ..noise
    };
    let covariance = model.sensors[0].noise_covariance.unwrap();
    for samples in [4_000, 8_000, 16_000, 32_000, 64_000] {
        let time_s: Vec<f64> = (0..samples).map(|k| 0.1 * k as f64).collect();
        let rate = Vector3::new(0.01, 0.02, 0.03);
        let fire = |k: usize| Firing {
            thruster: 0,
            start_s: time_s[k],
            end_s: time_s[k + 1],
            force: 1.0e-3 * (1 + k % 2) as f64,
        };
        let segments = [Segment {
            firings: (0..samples - 1).map(fire).collect(),
            samples: Samples {
                R_NB: vec![UnitQuaternion::identity(); samples],
                w_NB_B: vec![rate; samples],
                time_s: time_s.clone(),
                ..Samples::default()
            },
            observations: Observations {
                sensors: vec![
                    SensorRecord::of_base(SensorKind::Gyro, covariance)
                        .at_every_time(vec![SensorValue::Vector(rate); samples]),
                ],
                time_s,
                ..Observations::default()
            },
            ..Segment::default()
        }];
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: &segments,
            noise: &noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let evaluator = Evaluator::new(&problem).unwrap();
        let x = evaluator.nominal();
        let start = std::time::Instant::now();
        evaluator.at(&x).unwrap();
        let spent = start.elapsed().as_secs_f64();
        println!(
            "{samples} samples: {spent:.2} s, {:.1} us a sample",
            1.0e6 * spent / samples as f64
        );
    }
}

/// A rough evaluation has the sigmas of the whole one to 0.1 %: on rows far apart, with stored momentum and with moving
/// joints.
#[test]
fn exact_rough_information_has_the_sigmas_of_the_whole() {
    let close = |record: &(Model, Tree, Vec<Segment>, Noise), wanted: &[usize]| {
        let problem = problem(record);
        let of_base = |number: &usize| {
            vec![WantedTerm {
                body: 0,
                number: *number,
                factor: 1.0,
            }]
        };
        let sums: Vec<Vec<WantedTerm>> = wanted.iter().map(of_base).collect();
        let of = |i: Information| i.covariance(&sums).map_diagonal(f64::sqrt);
        let whole = of(Information::of(&problem, false, (1, 1.0)).unwrap());
        let rough = of(Information::of(&problem, false, (ROUGH, 1.0)).unwrap());
        let ratio = rough.component_div(&whole);
        println!("{:.7}", ratio.transpose());
        let is_same = ratio.iter().all(|r| (r - 1.0).abs() < 1.0e-3);
        // The steps differ, or nothing is tested.
        assert!(is_same && ratio.iter().any(|r| *r != 1.0));
    };
    close(&record(), &[4, 5, 6, 7, 8, 9]);
    let mut arm = vehicle::with_thrusters(vehicle::tree(41, "rp"));
    arm.bodies[1].estimate = EstimateSet::default();
    arm.bodies[2].estimate = EstimateSet::default();
    arm.sensors = vehicle::sensors(1.0e-4);
    let mut flight = vehicle::moving(&arm, 6);
    flight.rate_hz = 2.0;
    let table = vehicle::fly(&arm, &flight);
    let tree = Tree::new(&arm);
    let bound = bind(&arm, &tree, &[table]).unwrap();
    let record = (arm, tree, bound.segments, bound.noise);
    // Mass, mass centre y, inertia xx.
    close(&record, &[0, 2, 4]);
}

/// Given the shared unknowns, records are independent: the likelihood of two is the sum of both, and so is the information
/// about what they share. A late gyro needs the motion before and after a sample, driven by the inputs of its own record.
#[test]
fn exact_the_likelihood_of_two_records_is_the_sum_of_both() {
    let mut model = vehicle::with_thrusters(vehicle::with_wheels(vehicle::tree(41, "r")));
    model.bodies[1].estimate = EstimateSet::default();
    model.sensors = vehicle::sensors(1.0e-4);
    model.sensors[0].lag = Nuisance::Estimate;
    model.thrusters[1].scale = Nuisance::Estimate;
    model.environment.random_torque = Some(RandomTorque {
        sigma_N_m: 1.0e-3,
        correlation_s: 2.0,
    });
    let tree = Tree::new(&model);
    let tables = [6, 7].map(|seed| vehicle::fly(&model, &vehicle::moving(&model, seed)));
    let bound = bind(&model, &tree, &tables).unwrap();
    let both = (model, tree, bound.segments, bound.noise);
    let whole = Evaluator::new(&problem(&both)).unwrap();
    assert_eq!(both.2.len(), 2);
    let mut x = whole.nominal();
    let late = |u: &poinsot_identify::EvaluatedUnknown| u.name == "gyro.lag";
    let lag = whole.unknowns().iter().position(late).unwrap();
    x[lag] = 0.01;
    let together = whole.at(&x).unwrap();
    let starts = whole
        .unknowns()
        .iter()
        .filter(|u| u.name.contains(".start."))
        .count();
    let count = x.len() - starts;
    let (mut likelihood, mut information) = (0.0, nalgebra::DMatrix::zeros(count, count));
    for k in 0..2 {
        let one = (
            both.0.clone(),
            both.1.clone(),
            vec![both.2[k].clone()],
            both.3.clone(),
        );
        let alone = Evaluator::new(&problem(&one)).unwrap();
        let own = starts / 2;
        let mut values = x[k * own..(k + 1) * own].to_vec();
        values.extend(&x[starts..]);
        let here = alone.at(&values).unwrap();
        likelihood += here.log_likelihood;
        information += here.information.view((own, own), (count, count));
    }
    let gap = (together.log_likelihood - likelihood).abs() / likelihood.abs();
    assert!(gap < 1.0e-12, "{gap:e}");
    let of_both = together.information.view((starts, starts), (count, count));
    for k in 0..count {
        let gap = (of_both[(k, k)] / information[(k, k)] - 1.0).abs();
        assert!(gap < 1.0e-9, "{k}: {gap:e}");
    }
}
