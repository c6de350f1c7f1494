//! Inertia of two objects from single throws by hand, by maximum likelihood on raw readings.
//!
//!     cargo run --release -p poinsot --example tudelft_likelihood -- ../shared/data/real/tudelft_throw [--choose]
//!
//! `--choose` prints the likelihood of other declarations of the disturbances, calibration throws and objects by
//! themselves; the known inertia of the objects takes no part. See `examples/tudelft_throw/README.md`.
#![allow(non_snake_case)]

mod chain;
mod likelihood;
#[path = "../tudelft_throw/throws/mod.rs"]
#[allow(dead_code)]
mod throws;

use chain::{Answer, Object, Throws, declared, identify, prepare};
use likelihood::{Declared, fit};
use std::path::PathBuf;
use throws::Fault;

fn main() -> Result<(), Fault> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let folder = words.iter().find(|w| !w.starts_with("--")).map(PathBuf::from);
    let folder = folder.unwrap_or_else(|| PathBuf::from("../shared/data/real/tudelft_throw"));
    if !folder.join("throws.parquet").exists() {
        println!("skipped: no shared data");
        return Ok(());
    }
    let throws = prepare(&folder)?;
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

fn print_object(object: &Object) {
    println!("\n{}: errors of the principal moments, %, with one sigma, %", object.name);
    for a in object.throws.iter().chain([&object.together]) {
        print_answer(a);
    }
    println!(
        "  mean {:.2} %, worst {:.2} %; 95 % intervals hold the known moment in {:.0} % of {} cases, all three in {} of {} throws",
        object.mean_error(),
        object.worst_error(),
        100.0 * object.held(),
        3 * object.throws.len(),
        object.throws.iter().filter(|t| t.held().iter().all(|h| *h)).count(),
        object.throws.len()
    );
}

fn print_answer(a: &Answer) {
    let part = |k: usize| format!("{:+6.2} ({:4.2})", a.error[k], a.sigma[k]);
    println!("  {:8} {}  {}  {}", a.name, part(0), part(1), part(2));
}

/// Restricted likelihood of other declarations, summed over the throws of each group.
fn choose(throws: &Throws) -> Result<(), Fault> {
    println!("group, torque N m (J = 1e-6), its correlation s, gyro correlation s: -2 ln L");
    for (name, group) in throws.groups() {
        for torque in [3.0e-6, 1.0e-5, 3.0e-5, 1.0e-4] {
            for (correlation, colour) in [(0.1, 0.0), (0.1, 0.003), (0.03, 0.003)] {
                let mut own: Declared = declared(name);
                own.torque.sigma_N_m = torque;
                own.torque.correlation_s = correlation;
                own.gyro_correlation_s = colour;
                let mut sum = 0.0;
                for throw in group.iter().take(3) {
                    sum += fit(&throws.model, &[throw], &own)?.deviance;
                }
                println!("{name} {torque:.0e} {correlation} {colour}: {sum:.1}");
            }
        }
    }
    Ok(())
}
