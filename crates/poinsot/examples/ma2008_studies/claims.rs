//! The claims of Sec. V as experiments with a verdict.

use crate::monte::*;
use crate::setup::{Experiment, readings};
use crate::studies::example;
use poinsot_papers::ma2008::two_step;

const SEEDS: u64 = 200;

fn percent(x: f64) -> String {
    if x.is_finite() {
        format!("{:.2} %", 100.0 * x)
    } else {
        "open".to_owned()
    }
}

/// Rank of both steps on exact data and condition of the second.
fn rank(e: &Experiment, known: bool) -> String {
    let run = e.run();
    let samples = readings(&e.model, &run.raws);
    let answer = two_step(&[samples], known.then_some(run.known));
    let condition = answer
        .angular
        .as_ref()
        .map_or(f64::INFINITY, |s| s.singular[0] / s.singular[5]);
    let bound = cramer_rao(e, &run, absolute(), known);
    format!(
        "bound {} mass, {} inertia, condition of step 2 {condition:.1e}",
        percent(bound[0]),
        percent(bound[2])
    )
}

/// The same absolute noise for all: 1 % of trajectory 1 at 5 deg/s.
fn absolute() -> Sigma {
    Sigma::of(
        &Experiment::new(1, [0.0, 0.0, 5.0]).run(),
        0.01,
        Scaling::Largest,
    )
}

pub fn run() {
    println!(
        "1. the arm should have at least 5 % of the mass (trajectory 1, 5 deg/s, ten stopped samples; medians, option 1 / 2)"
    );
    let fixed = absolute();
    for ratio in [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5] {
        let e = Experiment::new(1, [0.0, 0.0, 5.0]).with_arm_factor(ratio * 1000.0 / 93.184);
        let run = e.run();
        let own = Sigma::of(&run, 0.01, Scaling::Component);
        let mut line = format!("   ratio {:4.1} %:", 100.0 * ratio);
        for (name, sigma) in [("1 % of each maximum", own), ("fixed noise", fixed)] {
            let m = [true, false].map(|known| {
                let found = trials(&e, &run, sigma, known, SEEDS);
                [0, 2].map(|k| percent(quantile(&found, k, 0.5)))
            });
            line += &format!(
                " {name}: mass {} / {}, inertia {} / {};",
                m[0][0], m[1][0], m[0][1], m[1][1]
            );
        }
        println!("{line}");
    }
    println!(
        "2. no spin is needed for mass and mass centre; 3. a spin is needed for the inertia (trajectory 1, noise of 1 % of the 5 deg/s run)"
    );
    for spin in [0.0, 1.0, 5.0] {
        for (name, moving, v) in [
            ("stopped, from rest", false, 0.0),
            ("stopped, drifting", false, 0.02),
            ("moving, from rest", true, 0.0),
        ] {
            for known in [true, false] {
                let mut e = Experiment::new(1, [0.0, 0.0, spin]);
                e.velocity = [v, -0.5 * v, 0.25 * v];
                let e = if moving { e.moving(200) } else { e };
                println!(
                    "   spin {spin} deg/s, {name}, option {}: {}",
                    if known { 1 } else { 2 },
                    rank(&e, known)
                );
            }
        }
    }
    println!(
        "4. a spin about one axis needs two axes of arm motion; 5. a spin about two axes needs one (stopped, option 2 and 1)"
    );
    for (name, trajectory, spin) in [
        ("spin z, arm about y and z", 1, [0.0, 0.0, 5.0]),
        ("spin z, arm about y", 2, [0.0, 0.0, 5.0]),
        ("spin y, arm about y", 2, [0.0, 5.0, 0.0]),
        ("spin x, arm about y", 2, [5.0, 0.0, 0.0]),
        ("spin y and z, arm about y", 2, [0.0, 1.0, 5.0]),
        ("spin x and z, arm about y", 2, [1.0, 0.0, 5.0]),
    ] {
        let e = Experiment::new(trajectory, spin);
        let mut plane = e.clone();
        plane.model.joints[0].p_PoCo_P.y = 0.0;
        println!(
            "   {name}: {}; option 1: {}; arm in the plane of symmetry: {}",
            rank(&e, false),
            rank(&e, true),
            rank(&plane, false)
        );
    }
    println!(
        "6. the momentum may be unknown, at a price in noise; 7. mass and mass centre less sensitive; 8. 3 % noise (median errors, 3 % of each maximum)"
    );
    for n in [1, 2] {
        for (start, velocity) in [
            ("base origin at rest", [0.0; 3]),
            ("drifting at 0.02 m/s", [0.02, -0.01, 0.005]),
            (
                "orbital velocity 7500 m/s, noise without it",
                [7500.0, 0.0, 0.0],
            ),
        ] {
            let mut e = example(n);
            let slow = e.run();
            e.velocity = velocity;
            let run = e.run();
            let of = if velocity[0] > 1.0 { &slow } else { &run };
            let sigma = Sigma::of(of, 0.03, Scaling::Component);
            let mut line = format!("   example {n}, {start}:");
            for known in [true, false] {
                let found = trials(&e, &run, sigma, known, SEEDS);
                let q = |k| quantile(&found, k, 0.5);
                let b = cramer_rao(&e, &run, sigma, known);
                line += &format!(
                    " option {}: mass {} (bound {}), mass centre {:.4} m ({:.4}), inertia {} ({});",
                    if known { 1 } else { 2 },
                    percent(q(0)),
                    percent(b[0]),
                    q(1),
                    b[1],
                    percent(q(2)),
                    percent(b[2])
                );
            }
            println!("{line}");
        }
    }
}

/// Five readings of "a percentage of the maximum velocity value": own or largest component, option 1 or 2, and a
/// share of the velocity with the orbital one in it.
pub fn readings_of_noise() {
    println!("3 % noise, ten stopped samples; medians of {SEEDS} seeds: mass, mass centre, tensor");
    for n in [1, 2] {
        for (name, scaling, orbital) in [
            ("each component's own maximum", Scaling::Component, 0.0),
            ("the largest component's maximum", Scaling::Largest, 0.0),
            (
                "own maximum, orbital 7500 m/s in it",
                Scaling::Component,
                7500.0,
            ),
            (
                "largest maximum, orbital 7500 m/s in it",
                Scaling::Largest,
                7500.0,
            ),
        ] {
            let mut e = example(n);
            e.velocity = [orbital, 0.0, 0.0];
            let run = e.run();
            let sigma = Sigma::of(&run, 0.03, scaling);
            for known in [true, false] {
                let found = trials(&e, &run, sigma, known, SEEDS);
                let q = |k| quantile(&found, k, 0.5);
                println!(
                    "   example {n}, {name}, option {}: mass {}, mass centre {:.3} m, tensor {}",
                    if known { 1 } else { 2 },
                    percent(q(0)),
                    q(1),
                    percent(q(2))
                );
            }
        }
    }
}
