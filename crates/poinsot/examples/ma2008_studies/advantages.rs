//! The advantages that Sec. II.B states for option 2: less bias, and relative velocities from accelerometers.

use crate::setup::{Experiment, readings, unsymmetric};
use poinsot_papers::ma2008::{Known, Raw, two_step};
use poinsot_spatial::Vector3;

/// Errors of one answer: mass, kg, and tensor as a share of its norm.
pub struct Answer {
    pub mass: f64,
    pub tensor: f64,
}

/// Ten stopped samples of trajectory 1 at 5 deg/s, base origin at rest.
pub fn experiment(full_tensor: bool) -> Experiment {
    let e = Experiment::new(1, [0.0, 0.0, 5.0]);
    if full_tensor {
        e.with_base(unsymmetric())
    } else {
        e
    }
}

/// Both options on exact data with an error added to each sample.
pub fn both(e: &Experiment, error: impl Fn(&mut Raw)) -> [Answer; 2] {
    let run = e.run();
    let mut raws = run.raws;
    raws.iter_mut().for_each(error);
    let samples = readings(&e.model, &raws);
    let truth = e.truth().I_BBcm_B;
    let answer = |known: Option<Known>| {
        let found = two_step(std::slice::from_ref(&samples), known);
        Answer {
            mass: found.mass(),
            tensor: found
                .I_S()
                .map_or(f64::NAN, |I| (I - truth).norm() / truth.norm()),
        }
    };
    [answer(Some(run.known)), answer(None)]
}

pub fn run() {
    println!(
        "ten stopped samples, trajectory 1, 5 deg/s; true mass 1000 kg; mass and error of the tensor"
    );
    println!("  {:54} {:>24} {:>24}", "", "option 1", "option 2");
    for (base, full) in [("Table 1 base", false), ("unsymmetric base", true)] {
        let e = experiment(full);
        let row = |name: String, [a, b]: [Answer; 2]| {
            let cell = |x: &Answer| format!("{:.3} kg, {:.2e}", x.mass, x.tensor);
            println!(
                "  {:54} {:>24} {:>24}",
                format!("{base}, {name}"),
                cell(&a),
                cell(&b)
            );
        };
        for offset in [1.0, 0.1, 0.01, 0.001] {
            for (axis, d) in [("x", Vector3::x()), ("z", Vector3::z())] {
                row(
                    format!("velocity offset {offset} m/s along {axis} of N"),
                    both(&e, |raw| raw.v_NBo_N += d * offset),
                );
            }
        }
        for bias in [1.0e-4, 1.0e-5] {
            for (axis, d) in [
                ("x", Vector3::x()),
                ("y", Vector3::y()),
                ("z", Vector3::z()),
            ] {
                row(
                    format!("gyro bias {bias} rad/s about {axis} of B"),
                    both(&e, |raw| raw.w_NB_B += d * bias),
                );
            }
        }
    }
}
