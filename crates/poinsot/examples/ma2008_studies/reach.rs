//! Claims of Sec. III and V on the motion: span, number of joints, path and internal torque, mass ratio.

use crate::monte::{Scaling, Sigma, cramer_rao};
use crate::setup::{Experiment, readings};
use poinsot_papers::ma2008::two_step;

/// The noise of every row: 1 % of the largest components of trajectory 1 at 5 deg/s.
fn fixed() -> Sigma {
    let run = Experiment::new(1, [0.0, 0.0, 5.0]).run();
    Sigma::of(&run, 0.01, Scaling::Largest)
}

/// With all joint angles times a factor.
pub fn scaled(mut e: Experiment, factor: f64) -> Experiment {
    for knot in &mut e.knots {
        knot.1.iter_mut().for_each(|q| *q *= factor);
    }
    e
}

/// With only these joints in motion.
fn only(mut e: Experiment, moves: &[usize]) -> Experiment {
    let first = e.knots[0].1;
    for knot in &mut e.knots {
        for j in (0..6).filter(|j| !moves.contains(j)) {
            knot.1[j] = first[j];
        }
    }
    e
}

/// Trajectory 1 with the wrist turning, too.
fn with_wrist(mut e: Experiment) -> Experiment {
    for (k, knot) in e.knots.iter_mut().enumerate() {
        for j in 3..6 {
            knot.1[j] = 30.0 * k as f64 * (1.0 - 0.5 * (j - 3) as f64);
        }
    }
    e
}

fn percent(x: f64) -> String {
    match x.is_finite() {
        true => format!("{:.4} %", 100.0 * x),
        false => "open".to_owned(),
    }
}

fn row(name: &str, e: &Experiment) {
    let run = e.run();
    let [known, unknown] = [true, false].map(|known| cramer_rao(e, &run, fixed(), known));
    println!(
        "  {name:44} momentum known: mass {}, tensor {}; unknown: mass {}, tensor {}",
        percent(known[0]),
        percent(known[2]),
        percent(unknown[0]),
        percent(unknown[2])
    );
}

/// Two runs through the same stops by other paths: how far the attitudes at the stops differ, rad, and the masses
/// of option 2, kg.
pub fn by_another_path() -> (f64, f64) {
    let e = Experiment::new(1, [0.0, 0.0, 5.0]);
    // The same stops, but the arm swings out by the wrist and back before each: other joint torques, other
    // attitudes and velocities at the stops.
    let mut other = e.clone();
    other.detour_deg = 60.0;
    let [a, b] = [&e, &other].map(|e| (e.run(), e));
    let turned =
        a.0.raws
            .iter()
            .zip(&b.0.raws)
            .map(|(x, y)| x.R_NB.angle_to(&y.R_NB));
    let attitude = turned.fold(0.0, f64::max);
    let masses = [&a, &b].map(|(run, e)| two_step(&[readings(&e.model, &run.raws)], None).mass());
    (attitude, (masses[0] - masses[1]).abs())
}

pub fn run() {
    println!("Cramer-Rao bounds, trajectory 1, spin 5 deg/s, the same noise in every row");
    for (name, velocity, moving) in [
        ("base origin at rest, ten stopped samples", 0.0, false),
        ("drifting, ten stopped samples", 0.02, false),
        ("drifting, 200 moving samples", 0.02, true),
    ] {
        println!("span of the motion, {name}: joint angles times");
        for factor in [1.0, 0.5, 0.25] {
            let mut e = scaled(Experiment::new(1, [0.0, 0.0, 5.0]), factor);
            e.velocity = [velocity, -0.5 * velocity, 0.25 * velocity];
            let e = if moving { e.moving(200) } else { e };
            row(&format!("{factor}"), &e);
        }
    }
    println!("joints that move, spin 1 deg/s about y and 5 deg/s about z, ten stopped samples");
    let spin = [0.0, 1.0, 5.0];
    for (name, moves) in [
        ("joint 1", &[0][..]),
        ("joint 2", &[1]),
        ("joints 1 and 2", &[0, 1]),
        ("joints 1, 2, 3 (trajectory 1)", &[0, 1, 2]),
    ] {
        row(name, &only(Experiment::new(1, spin), moves));
    }
    row("all six", &with_wrist(Experiment::new(1, spin)));
    for (name, velocity) in [("base origin at rest", 0.0), ("drifting", 0.02)] {
        println!("arm mass over base mass, {name}, ten stopped samples");
        for ratio in [0.005, 0.02, 0.05, 0.1, 0.2, 0.5] {
            let mut e =
                Experiment::new(1, [0.0, 0.0, 5.0]).with_arm_factor(ratio * 1000.0 / 93.184);
            e.velocity = [velocity, -0.5 * velocity, 0.25 * velocity];
            row(&format!("{:.1} %", 100.0 * ratio), &e);
        }
    }
    let (attitude, mass) = by_another_path();
    println!(
        "the same stops by another path: attitudes differ by up to {attitude:.3} rad, option 2's mass by {mass:.1e} kg"
    );
}
