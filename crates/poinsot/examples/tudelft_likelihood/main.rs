//! Inertia of two objects from single throws by hand, by maximum likelihood with raw samples.
//!
//!     cargo run --release -p poinsot --example tudelft_likelihood -- ../shared/data/real/tudelft_throw [--choose | --segments | --ideal-box]
//!
//! `--segments` also fits all throws of a body as one problem, which takes minutes. `--ideal-box` assumes ideal gyro,
//! tachometer, wheel and accelerometer of the box. `--choose` prints the likelihood of other declarations of the
//! disturbances, separately for calibration throws and objects; the known inertia of the objects is not used. See
//! `data/tudelft_throw/README.md`.
#![allow(non_snake_case)]

mod chain;
mod device;
mod likelihood;
#[path = "../tudelft_throw/throws/mod.rs"]
#[allow(dead_code)]
mod throws;

use chain::{Answer, Object, Throws, calibrate, declared, identify, prepare};
use likelihood::{Declared, fit};
use nalgebra::Vector3;
use poinsot_model::Nuisance;
use std::path::PathBuf;
use throws::Fault;

fn main() -> Result<(), Fault> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let folder = words
        .iter()
        .find(|w| !w.starts_with("--"))
        .map(PathBuf::from);
    let folder = folder.unwrap_or_else(|| PathBuf::from("../shared/data/real/tudelft_throw"));
    if !folder.join("throws.parquet").exists() {
        println!("skipped: no shared data");
        return Ok(());
    }
    let mut throws = prepare(&folder, words.iter().any(|w| w == "--segments"))?;
    if !words.iter().any(|w| w == "--ideal-box") {
        calibrate(&mut throws)?;
        print_box(&throws);
    }
    if words.iter().any(|w| w == "--choose") {
        return choose(&throws);
    }
    let found = identify(&throws)?;
    println!(
        "J = {:.4}e-6 +- {:.4}e-6 kg m2; block with it: {:+.2} {:+.2} {:+.2} %",
        1.0e6 * found.J,
        1.0e6 * found.J_sigma,
        found.proof_error[0],
        found.proof_error[1],
        found.proof_error[2]
    );
    found.objects.iter().for_each(print_object);
    Ok(())
}

/// Prints the calibration of the box.
fn print_box(throws: &Throws) {
    let d = &throws.device;
    println!(
        "the box: axes of the gyro, axis of the wheel, mrad; lag of the tachometer, ms; bias of the accelerometer, m/s2"
    );
    for (k, name) in device::NUMBERS.iter().enumerate() {
        println!(
            "  {name:26} {:+6.2} +- {:.2}",
            1.0e3 * d.numbers[k],
            1.0e3 * d.numbers_sigma[k]
        );
    }
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let sigma = d.bias_covariance[(k, k)].sqrt();
        println!(
            "  accelerometer.bias_{axis:8} {:+6.3} +- {sigma:.3}",
            d.bias[k]
        );
    }
}

fn print_object(object: &Object) {
    println!(
        "\n{}: errors of the principal moments, %, with one sigma, %; the throws scatter {:.2} times as their fits say",
        object.name, object.scatter
    );
    for a in object.throws.iter().chain([&object.together]) {
        print_answer(a);
    }
    let (mean, worst) = object.published();
    println!("  by the paper's measure: mean {mean:.2} %, worst {worst:.2} %");
    println!(
        "  mean {:.2} %, worst {:.2} %; 95 % intervals hold the known moment in {:.0} % of {} cases, all three in {} of {} throws",
        object.mean_error(),
        object.worst_error(),
        100.0 * object.held(),
        3 * object.throws.len(),
        object
            .throws
            .iter()
            .filter(|t| t.held().iter().all(|h| *h))
            .count(),
        object.throws.len()
    );
}

fn print_answer(a: &Answer) {
    let part = |k: usize| format!("{:+6.2} ({:4.2})", a.error[k], a.sigma[k]);
    println!("  {:8} {}  {}  {}", a.name, part(0), part(1), part(2));
}

/// Restricted likelihood of other declarations, summed over the throws of each group. Sigma of the gyro is the RMS
/// residual of the declaration, found in two rounds.
fn choose(throws: &Throws) -> Result<(), Fault> {
    println!(
        "group, steady torque N m, drag kg m2, random torque N m (J = 1e-6), its correlation s: -2 ln L, gyro rad/s"
    );
    for (name, group) in throws.groups() {
        for (steady, drag, torque, correlation) in DECLARATIONS {
            let mut own: Declared = declared(name, &throws.device);
            let sized = |sigma: f64| match sigma > 0.0 {
                true => Nuisance::Prior(sigma),
                false => Nuisance::Known,
            };
            (own.steady, own.drag) = (sized(steady), sized(drag));
            own.torque.sigma_N_m = torque;
            own.torque.correlation_s = correlation;
            let (mut sum, mut gyro) = (0.0, Vector3::zeros());
            for throw in group {
                own.gyro = Vector3::repeat(0.1);
                let mut found = fit(&throws.model, &[throw], &own);
                if let Ok(first) = &found {
                    own.gyro = first.residual;
                    found = fit(&throws.model, &[throw], &own);
                }
                match found {
                    Ok(fitted) => {
                        sum += fitted.deviance;
                        gyro += fitted.residual / group.len() as f64;
                    }
                    Err(why) => println!("{name} {}: {why}", throw.name),
                }
            }
            println!(
                "{name} {steady:.0e} {drag:.0e} {torque:.0e} {correlation}: {sum:.1}  {:.4} {:.4} {:.4}",
                gyro.x, gyro.y, gyro.z
            );
        }
    }
    Ok(())
}

/// Constant torque, drag, random torque, its correlation time.
const DECLARATIONS: [(f64, f64, f64, f64); 5] = [
    (0.0, 0.0, 3.0e-5, 0.1),
    (0.0, 0.0, 1.0e-4, 0.1),
    (0.0, 0.0, 3.0e-4, 0.1),
    (3.0e-4, 0.0, 3.0e-4, 0.1),
    (0.0, 3.0e-6, 3.0e-4, 0.1),
];
