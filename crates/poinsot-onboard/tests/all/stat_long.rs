//! Long records.

use crate::setups::{self, Setup};
use crate::truth::{Noise, samples};
use poinsot_onboard::{Answer, Health, Sample, WHEELS};

const LENGTH: usize = 100_000;
/// Between one such record and the next, where more are asked for, s: the motion starts anew there.
const GAP_S: f64 = 60.0;

/// `POINSOT_SAMPLES` of them, by default one record.
fn long_run(setup: &mut Setup) -> Answer {
    setup.truth.samples = LENGTH;
    let asked = std::env::var("POINSOT_SAMPLES").ok();
    let asked = asked.map_or(LENGTH, |n| n.parse().expect("a number of samples"));
    let motions = setup.truth.motions(&setup.configuration);
    let mut noise = Noise::new(5);
    let mut filter = None;
    let mut before = [f64::MAX; 10];
    let mut answer = None;
    for record in 0..asked.div_ceil(LENGTH) {
        let (truth, told) = (&setup.truth, &setup.configuration);
        let stream = samples(truth, told, &motions, Some(&mut noise));
        let filter = filter.get_or_insert_with(|| setup.filter(&mut noise));
        let later_s = record as f64 * (LENGTH as f64 * setup.truth.dt + GAP_S);
        for (k, sample) in stream.iter().enumerate() {
            let time_s = later_s + sample.time_s;
            let taken = filter.push(&Sample { time_s, ..*sample });
            // After a jump of the clock the third sample is the first one taken.
            assert_eq!(taken.is_ok(), record == 0 || k >= 2, "{record} {k}");
            if k % 1000 == 999 {
                check(&filter.answer(time_s), &mut before);
            }
        }
        answer = Some(filter.answer(0.0));
    }
    answer.expect("a record")
}

/// The covariance is symmetric and positive, and no sigma has grown.
fn check(answer: &Answer, before: &mut [f64; 10]) {
    let n = answer.unknowns;
    let C = nalgebra::DMatrix::from_fn(n, n, |i, j| answer.covariance[i][j]);
    assert_eq!(C, C.transpose());
    assert!(C.cholesky().is_some());
    for (before, number) in before.iter_mut().zip(&answer.numbers) {
        assert!(number.sigma.is_finite() && number.sigma <= 1.01 * *before);
        *before = number.sigma;
    }
}

#[test]
fn stat_a_long_record_keeps_a_covariance() {
    let mut setup = setups::bus_with_wheels();
    let answer = long_run(&mut setup);
    let truth = setup.truth.parameters();
    let errors = (4..10).map(|k| (answer.numbers[k].value - truth[k]) / answer.numbers[k].sigma);
    let worst = errors.fold(0.0_f64, |worst, e| worst.max(e.abs()));
    println!("largest error {worst:.2} sigma");
    assert!(worst < 5.0 && answer.health == Health::Determined);
}

/// Sigma of the common factor of an inertia after a long record, and that of its prior.
fn common_factor(setup: &mut Setup) -> [f64; 2] {
    let answer = long_run(setup);
    let (m, c) = (setup.truth.mass, setup.truth.c);
    let shift = (nalgebra::Matrix3::identity() * c.norm_squared() - c * c.transpose()) * m;
    let shift = [
        shift.m11, shift.m12, shift.m22, shift.m13, shift.m23, shift.m33,
    ];
    let central: Vec<f64> = (0..6)
        .map(|j| answer.numbers[4 + j].value - shift[j])
        .collect();
    let prior: f64 = central
        .iter()
        .zip(&setup.sigma[4..])
        .map(|(n, s)| (n / s).powi(2))
        .sum();
    [answer.numbers[9].sigma / central[5], 1.0 / prior.sqrt()]
}

/// Without wheels and torque only the ratios of the inertia show.
#[test]
fn stat_a_common_factor_of_the_inertia_keeps_its_prior() {
    let mut setup = setups::tumbling();
    setup.configuration.wheel_count = 0;
    let [factor, prior] = common_factor(&mut setup);
    let kept = factor / prior;
    println!("common factor: sigma {factor:.4}, {kept:.5} of the prior");
    assert!((0.99..1.01).contains(&kept));
}

/// With a wheel whose spin inertia is known within 2 % only the ratios to it show.
#[test]
fn stat_a_common_factor_of_inertia_and_wheel_keeps_its_prior() {
    let mut setup = setups::tumbling().drawn();
    let [factor, of_inertia] = common_factor(&mut setup);
    let prior = 1.0 / (of_inertia.powi(-2) + 0.02_f64.powi(-2)).sqrt();
    let kept = factor / prior;
    println!("common factor with a wheel: sigma {factor:.5}, {kept:.5} of the prior");
    assert!((0.99..1.01).contains(&kept));
}

/// A bus that turns about one axis alone, with its wheel or without one.
fn turning_about_one_axis(wheels: usize) -> Setup {
    let mut setup = setups::bus_with_wheels();
    setup.truth.I = nalgebra::Matrix3::from_diagonal(&nalgebra::Vector3::new(10.0, 12.0, 8.0));
    setup.truth.c = nalgebra::Vector3::zeros();
    setup.configuration.nominal[..10].copy_from_slice(&setup.truth.parameters());
    setup.truth.start.w = nalgebra::Vector3::new(0.0, 0.0, 0.004);
    setup.configuration.wheels[0].axis_B = [0.0, 0.0, 1.0];
    setup.configuration.wheel_count = wheels;
    if wheels == 0 {
        setup.truth.motors = |_| [0.0; WHEELS];
    }
    setup
}

/// The inertia about the other axes does not show, without a wheel not that about this one either, whatever torques are declared.
#[test]
fn stat_inertia_that_does_not_show_keeps_its_prior() {
    for (wheels, walk) in [(1, 0.0), (0, 0.0), (0, 1.0e-5), (0, 1.0e-4), (1, 1.0e-4)] {
        let mut setup = turning_about_one_axis(wheels);
        setup.configuration.noise.torque_walk = walk;
        let answer = long_run(&mut setup);
        let shown = (4..10).map(|k| answer.numbers[k].sigma / setup.sigma[k]);
        let kept: Vec<f64> = shown.collect();
        println!("{wheels} wheels, walk {walk}: xx, xy, yy, xz, yz, zz: {kept:.5?} of the prior");
        let hidden = [0, 1, 2].into_iter().chain((wheels == 0).then_some(5));
        assert!(hidden.into_iter().all(|k| (0.99..1.01).contains(&kept[k])));
        assert!(kept[3..5].iter().all(|k| *k < 0.1));
        assert!(wheels == 0 || walk > 0.0 || kept[3..].iter().all(|k| *k < 1.0e-3));
    }
}

/// An arm that stands still on a turning base: of the ten numbers of its payload the ratios of the inertia of the whole show, five
/// directions; encoders and a point of linearisation that moves show no other.
#[test]
fn stat_a_payload_that_does_not_move_keeps_its_prior() {
    let mut setup = setups::arm_with_payload();
    for link in &mut setup.truth.arm.as_mut().unwrap().links {
        link.curve = [link.curve[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    }
    setup.truth.start.w = nalgebra::Vector3::new(0.2, -0.1, 0.15);
    setup.truth.samples = 5_000;
    let motions = setup.truth.motions(&setup.configuration);
    let mut noise = Noise::new(5);
    let told = &setup.configuration;
    let stream = samples(&setup.truth, told, &motions, Some(&mut noise));
    let mut filter = setup.filter(&mut noise);
    for sample in &stream {
        filter.push(sample).unwrap();
        assert_ne!(filter.answer(sample.time_s).health, Health::Inconsistent);
    }
    let answer = filter.answer(0.0);
    assert_eq!(answer.health, Health::Converging);
    let C = nalgebra::DMatrix::from_fn(10, 10, |i, j| {
        answer.covariance[i][j] / (setup.sigma[i] * setup.sigma[j])
    });
    let eigen = C.symmetric_eigen().eigenvalues;
    let mut kept: Vec<f64> = eigen.iter().map(|x| x.sqrt()).collect();
    kept.sort_by(f64::total_cmp);
    println!("principal directions: {kept:.5?} of the prior");
    assert!(kept[4] < 1.0e-3 && kept[5..].iter().all(|k| (0.99..1.01).contains(k)));
}
