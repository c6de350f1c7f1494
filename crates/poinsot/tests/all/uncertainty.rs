//! Uncertainty in closed form: effect of a prior, of a misfit, and of every sample.

use crate::vehicle;

use nalgebra::DMatrix;
use poinsot::Identified;
use poinsot_identify::{BodyEstimate, Number, Status};
use poinsot_model::{Model, Prior};
use poinsot_telemetry::Table;
use vehicle::*;

const METHODS: [&str; 2] = ["linear", "maximum_likelihood"];

/// One body with thrusters: all ten numbers are identifiable.
fn pushed(seed: u64, sigma: f64) -> Model {
    let mut model = with_thrusters(tree(seed, ""));
    model.sensors = sensors(sigma);
    model
}

/// A tumbling flight with this sample rate.
fn flown(model: &Model, seed: u64, rate_hz: f64) -> Table {
    let flight = Flight {
        rate_hz,
        ..moving(model, seed)
    };
    fly(model, &flight)
}

/// Mass, mass centre and inertia of the base.
fn ten(answer: &Identified) -> Vec<Number> {
    numbers(&answer.estimate.bodies[0])
}

fn covariance(answer: &Identified) -> DMatrix<f64> {
    let rows = &answer.estimate.covariance;
    DMatrix::from_fn(10, 10, |i, j| rows[i][j])
}

/// Gaussian knowledge adds as information: `C' = (C^-1 + D^-1)^-1`, and the answer is the weighted mean.
#[test]
fn exact_a_prior_adds_its_information_once() {
    let truth = pushed(31, 1.0e-3);
    let table = flown(&truth, 31, 5.0);
    let free = ask(&truth, vec![table.clone()], "maximum_likelihood");
    assert_eq!(free.estimate.status, Status::Converged);
    let C = covariance(&free);
    let sigmas: Vec<f64> = ten(&free).iter().map(|n| n.sigma.unwrap()).collect();
    let prior = Prior {
        mass: Some(sigmas[0]),
        com: Some(sigmas[1]),
        inertia: Some(sigmas[4]),
        entropic: None,
        forget_s: None,
    };
    let declared = |k: usize| match k {
        0 => sigmas[0],
        1..4 => sigmas[1],
        _ => sigmas[4],
    };
    // In units of each sigma, for well-conditioned matrices.
    let unit = |k: usize| sigmas[k];
    let scaled = DMatrix::from_fn(10, 10, |i, j| C[(i, j)] / (unit(i) * unit(j)));
    let D = DMatrix::from_fn(10, 10, |i, j| {
        f64::from(u8::from(i == j)) * (unit(i) / declared(i)).powi(2)
    });
    let expected = (scaled.try_inverse().unwrap() + &D).try_inverse().unwrap();
    let mut asked = truth.clone();
    asked.bodies[0].prior = Some(prior);
    // The prior mass is one sigma too large.
    asked.bodies[0].nominal.mass += sigmas[0];
    let held = ask(&asked, vec![table], "maximum_likelihood");
    let with = covariance(&held);
    for i in 0..10 {
        for j in 0..10 {
            let found = with[(i, j)] / (unit(i) * unit(j));
            let off = (found - expected[(i, j)]).abs();
            assert!(off < 1.0e-3, "{i} {j}: {found} {}", expected[(i, j)]);
        }
    }
    // Minimum of the sum of both squares: the answer moves by C' D^-1 times the error of the prior.
    for (i, (found, free)) in ten(&held).iter().zip(ten(&free)).enumerate() {
        let moved = (found.value.unwrap() - free.value.unwrap()) / unit(i);
        let off = (moved - expected[(i, 0)] * D[(0, 0)]).abs();
        assert!(off < 2.0e-3, "{i}: moved by {moved}");
    }
}

/// If the declared noise is ten times too large, sigmas are those of the experiment. If it is too small, sigmas and
/// covariance are widened by the root of chi-square per degree of freedom, or by the worst sensor: a short record, where
/// the unknowns took much of each residual, shows the first, a long one the second.
#[test]
fn exact_sigmas_widen_by_chi_square_or_the_worst_sensor() {
    assert!(widening(8.0, 8).is_lt());
    assert!(widening(20.0, 4).is_gt());
}

/// Checks the widening of a record of this length, with noise of this seed, and says how the worst sensor compares with chi-square.
fn widening(duration_s: f64, seed: u64) -> std::cmp::Ordering {
    let declared = 1.0e-3;
    let model = pushed(32, declared);
    let flight = Flight {
        duration_s,
        rate_hz: 1.0,
        ..moving(&model, 32)
    };
    let table = noisy(fly(&model, &flight), seed, 2.0 * declared);
    let small = ask(&model, vec![table.clone()], "maximum_likelihood");
    let large = ask(
        &pushed(32, 10.0 * declared),
        vec![table],
        "maximum_likelihood",
    );
    let fit = &small.estimate.fit[0];
    // Gyro, attitude, velocity and position; mass properties, pose and momentum at the start.
    let readings = 12.0 * fit.samples as f64;
    let freedom = readings - 10.0 - 12.0;
    let sensors = fit.channels.iter().map(|c| {
        let square: f64 = c.octaves.iter().map(|o| o.square).sum();
        square / c.octaves.iter().map(|o| o.numbers).sum::<usize>() as f64
    });
    let pooled = fit.chi2_per_dof * readings / freedom;
    let worst = sensors.fold(0.0, f64::max);
    let expected = worst.max(pooled).sqrt();
    println!("{readings} readings, sensors {worst}, all {pooled}");
    assert!((1.7..2.3).contains(&expected), "{expected}");
    assert!(!small.estimate.covariance_trustworthy());
    let C = covariance(&small);
    for (k, (found, plain)) in ten(&small).iter().zip(ten(&large)).enumerate() {
        let sigma = found.sigma.unwrap();
        let widened = 10.0 * sigma / plain.sigma.unwrap();
        assert!((widened / expected - 1.0).abs() < 5.0e-3, "{k}: {widened}");
        assert!((C[(k, k)].sqrt() / sigma - 1.0).abs() < 1.0e-9, "{k}");
    }
    worst.total_cmp(&pooled)
}

/// Doubled declared noise doubles sigma, on noise-free data.
#[test]
fn exact_sigma_is_proportional_to_the_declared_noise() {
    let table = flown(&pushed(33, 1.0), 33, 5.0);
    for method in METHODS {
        let [one, two] = [1.0e-4, 2.0e-4]
            .map(|sigma| ten(&ask(&pushed(33, sigma), vec![table.clone()], method)));
        for (a, b) in one.iter().zip(&two) {
            let ratio = b.sigma.unwrap() / a.sigma.unwrap();
            // The linear method adds the bias from noise in the regressor: 2e-4 here.
            let own = if method == "linear" { 1.0e-3 } else { 1.0e-6 };
            assert!((ratio - 2.0).abs() < own, "{method}: {ratio}");
        }
    }
}

/// A change of any sample changes the answer: first and last, and on both sides of the blocks of 1,024.
#[test]
fn prop_every_sample_counts() {
    let model = pushed(34, 1.0e-4);
    let table = noisy(flown(&model, 34, 105.0), 6, 1.0e-4);
    for method in METHODS {
        let before = ten(&ask(&model, vec![table.clone()], method));
        for k in [0, 1023, 1024, 2047, 2048, 2100] {
            let mut changed = table.clone();
            channel(&mut changed, "omega_x").values[k] += 1.0e-4;
            let after = ten(&ask(&model, vec![changed], method));
            let moved = before
                .iter()
                .zip(&after)
                .map(|(a, b)| (a.value.unwrap() - b.value.unwrap()).abs() / a.sigma.unwrap());
            let most = moved.fold(0.0, f64::max);
            println!("{method} {k}: {most:.1e} sigma");
            assert!(most > 1.0e-4, "{method}: sample {k} does not count");
        }
    }
}

fn numbers(body: &BodyEstimate) -> Vec<Number> {
    let all = std::iter::once(&body.mass).chain(&body.com);
    all.chain(&body.inertia).copied().collect()
}
