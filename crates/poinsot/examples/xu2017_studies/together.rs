//! One joint at a time, as the paper moves them, beside all joints at once.

use crate::setup::{ALL, Data, data, examples, model, runs};
use crate::studies::{errors, request};
use poinsot::case::{Case, parse_case, read_case};
use poinsot::identify::identify_tables;
use poinsot::simulate::simulate_trial;
use poinsot_identify::{BodyEstimate, Estimate, linear};
use poinsot_model::{Model, read_model};
use poinsot_spatial::MassProperties;

/// Draws of noise.
const TRIALS: u64 = 20;
/// The last joint turned by +-30 deg once in 60 s.
const ALONE: &str = r#"
[[joint_motion]]
joint = "joint6"
interpolation = "fourier"
base_frequency_hz = 0.016666666666666666
sine_rad = [0.5235987755982988]
cosine_rad = [0.0]

"#;
const AT_REST: &str = "[initial]\nmomentum_zero = true\n";

/// Both motions of the arm with the target, from rest or drifting and turning as the shipped case.
pub fn cases() -> Vec<(&'static str, Case)> {
    let path = examples().join("cases/xu2017_target_all_joints.toml");
    let text = std::fs::read_to_string(&path).expect("the case is there");
    let part = |mark: &str| text.find(mark).expect("the case has this part");
    let (initial, joints, output) = (
        part("[initial]"),
        part("[[joint_motion]]"),
        part("[output]"),
    );
    let (head, start) = (&text[..initial], &text[initial..joints]);
    let (all, tail) = (&text[joints..output], &text[output..]);
    let make = |start: &str, motion: &str| {
        parse_case(&path, format!("{head}{start}\n{motion}\n{tail}")).expect("the case is whole")
    };
    vec![
        ("joint 6 alone, from rest (as C7)", make(AT_REST, ALONE)),
        ("all joints, from rest", make(AT_REST, all)),
        ("joint 6 alone, drifting and turning", make(start, ALONE)),
        ("all joints, drifting and turning", make(start, all)),
    ]
}

/// Condition of the ten numbers of the target in the method's own equations.
pub fn condition(e: &Estimate) -> f64 {
    let numbers = e.method_report.iter().flat_map(|r| &r.numbers);
    let found = numbers
        .into_iter()
        .find(|n| n.name.ends_with("condition of these"));
    found.and_then(|n| n.number.value).unwrap_or(f64::NAN)
}

/// Errors of mass (share), mass centre (m), tensor (kg m2, largest element).
fn parts(b: &BodyEstimate, t: &MassProperties) -> [f64; 3] {
    let com = (0..3).map(|k| {
        b.com[k]
            .value
            .map_or(f64::NAN, |c| (c - t.p_BoBcm_B[k]).abs())
    });
    let tensor = b.inertia.iter().zip(poinsot_identify::TENSOR);
    let tensor = tensor.map(|(n, e)| n.value.map_or(f64::NAN, |i| (i - t.I_BBcm_B[e]).abs()));
    [
        b.mass.value.map_or(f64::NAN, |m| (m / t.mass - 1.0).abs()),
        com.fold(0.0, f64::max),
        tensor.fold(0.0, f64::max),
    ]
}

/// The target alone unknown: errors of one answer.
pub fn answer(case: &Case, method: &str, trial: Option<u64>) -> (Estimate, MassProperties) {
    let vehicle = read_model(&case.model).expect("model");
    let truth = vehicle.bodies[6].nominal;
    let mut off: Model = vehicle.clone();
    off.bodies[6].nominal.mass *= 1.2;
    off.bodies[6].nominal.p_BoBcm_B *= 0.8;
    off.bodies[6].nominal.I_BBcm_B *= 1.3;
    let mut flown = vehicle;
    if trial.is_none() {
        flown.sensors.clear();
    }
    let table = simulate_trial(case, &flown, trial.unwrap_or(0))
        .expect("it moves")
        .table;
    let variant = (method == "xu2017").then_some("linear");
    let found = identify_tables(off, vec![table], &request(method, variant)).expect("it suits");
    (found.estimate, truth)
}

pub fn run() {
    println!("grasped target, 60 s at 10 Hz, sensors of the case; rms of {TRIALS} draws of noise");
    println!(
        "  {:38} {:>10} {:>10}   mass %, mass centre mm, tensor kg m2",
        "", "no noise", "condition"
    );
    for (name, case) in cases() {
        let (e, truth) = answer(&case, "xu2017", None);
        let (worst, n) = errors(&e.bodies[6], &truth);
        println!(
            "  {name:38} {worst:10.1e} {:10.1e}   ({n} of ten)",
            condition(&e)
        );
        for method in ["xu2017", "maximum_likelihood"] {
            let mut squares = [0.0; 3];
            for trial in 0..TRIALS {
                let (e, truth) = answer(&case, method, Some(trial));
                for (s, x) in squares.iter_mut().zip(parts(&e.bodies[6], &truth)) {
                    *s += x * x / TRIALS as f64;
                }
            }
            let [m, c, i] = squares.map(f64::sqrt);
            println!(
                "    {method:36} {:>10} {:>10}   {:.4} {:.4} {:.2e}",
                "",
                "",
                100.0 * m,
                1000.0 * c,
                i
            );
        }
    }
    println!(
        "every body unknown: sigma of the least determined of the 52 combinations, natural units"
    );
    let worst = |d: &Data| {
        let found = linear(&d.problem()).expect("a problem").identifiability;
        (
            found.rank,
            found.sigmas_natural.get(51).copied().unwrap_or(f64::NAN),
        )
    };
    let (rank, sigma) = worst(&data(&ALL));
    println!("  C1 and C2 to C7, 62 s each: {rank} of 70, sigma {sigma:.1e}");
    let nominal = model("xu2017/model.toml");
    let (_, case) = cases().remove(1);
    let mut exact = read_model(
        &read_case(&examples().join("cases/xu2017_c1.toml"))
            .expect("case")
            .model,
    )
    .expect("model");
    exact.sensors.clear();
    let mut tables = runs(&nominal, &["C1"]);
    tables.push(simulate_trial(&case, &exact, 0).expect("it moves").table);
    let (rank, sigma) = worst(&Data::new(nominal, &tables));
    println!("  C1 and all joints at once, 60 s: {rank} of 70, sigma {sigma:.1e}");
}
