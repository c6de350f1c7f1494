//! The five uses of the Conclusion, a grasped target with all joints moving, and the choice of a joint path.

use crate::setup::{Data, data, examples, model, properties, runs, truth, whole};
use poinsot::case::read_case;
use poinsot::identify::identify_tables;
use poinsot::simulate::simulate_case;
use poinsot::{Identified, Question};
use poinsot_dynamics::Tree;
use poinsot_identify::{BodyEstimate, Estimate, TENSOR};
use poinsot_model::{EstimateSet, Model, read_model};
use poinsot_papers::xu2017::sensitivity::path_sensitivity;
use poinsot_spatial::{InertialParameters, MassProperties};
use poinsot_telemetry::Table;

pub fn request(method: &str, variant: Option<&str>) -> Question {
    Question {
        variant: variant.map(str::to_owned),
        ..Question::by(method)
    }
}

pub fn ask(model: &Model, tables: Vec<Table>, variant: &str) -> Identified {
    identify_tables(model.clone(), tables, &request("xu2017", Some(variant)))
        .expect("the question suits the method")
}

/// Largest error of the numbers given, relative to mass, size and inertia; and how many there are.
pub fn errors(found: &BodyEstimate, truth: &MassProperties) -> (f64, usize) {
    let L = truth.radius_of_gyration();
    let scale = truth.mass * L * L;
    let mut list = Vec::new();
    list.extend(found.mass.value.map(|m| (m / truth.mass - 1.0).abs()));
    for k in 0..3 {
        list.extend(
            found.com[k]
                .value
                .map(|c| (c - truth.p_BoBcm_B[k]).abs() / L),
        );
    }
    for (n, e) in found.inertia.iter().zip(TENSOR) {
        list.extend(n.value.map(|i| (i - truth.I_BBcm_B[e]).abs() / scale));
    }
    (list.iter().copied().fold(0.0, f64::max), list.len())
}

fn known(mut model: Model, unknown: impl Fn(usize) -> bool) -> Model {
    for (b, (body, pi)) in model.bodies.iter_mut().zip(truth()).enumerate() {
        if !unknown(b) {
            body.estimate = EstimateSet::default();
            body.nominal = pi.mass_properties().unwrap_or(MassProperties::ZERO);
        }
    }
    model
}

/// The robot as one body: what the equivalent single body is about.
pub fn one_body(tree: &Tree, example: &Model, inertia_only: bool) -> Model {
    let mut model = example.clone();
    let nominal: Vec<InertialParameters> = example
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let guess = whole(tree, &nominal);
    let right = whole(tree, &truth());
    model.bodies.truncate(1);
    model.joints.clear();
    model.sensors.retain(|s| !s.kind.is_scalar());
    model.bodies[0].nominal = guess;
    if inertia_only {
        model.bodies[0].nominal.mass = right.mass;
        model.bodies[0].nominal.p_BoBcm_B = right.p_BoBcm_B;
        model.bodies[0].estimate = EstimateSet {
            inertia: true,
            ..EstimateSet::default()
        };
    }
    model
}

/// The second use as printed: mass and mass centre of one body known, here the base; C1 shows attitude alone.
/// The answer, and the relative error of the mass of the whole.
pub fn base_mass_known(example: &Model, variant: &str) -> (Estimate, f64) {
    let mut m = example.clone();
    let right = properties(&truth())[0];
    m.bodies[0].nominal.mass = right.mass;
    m.bodies[0].nominal.p_BoBcm_B = right.p_BoBcm_B;
    m.bodies[0].estimate = EstimateSet {
        inertia: true,
        ..EstimateSet::default()
    };
    let mut tables = runs(&m, &crate::setup::ALL);
    tables[0]
        .channels
        .retain(|c| !c.name.starts_with("r_") && !c.name.starts_with("v_"));
    let e = ask(&m, tables, variant).estimate;
    let mass = e.system.as_ref().and_then(|s| s.0.mass.value);
    (e, mass.map_or(f64::NAN, |m| (m / 476.0 - 1.0).abs()))
}

/// Sec. 6, uses 1 to 5, noise-free, linear in both orders.
pub fn uses() {
    let example = model("xu2017/model.toml");
    let tree = Tree::new(&example);
    let total = whole(&tree, &truth());
    let all = properties(&truth());
    let arms = ["C2", "C3", "C4", "C5", "C6", "C7"];
    for variant in ["linear", "linear-inward", "swarm"] {
        println!("--method xu2017 --variant {variant}");
        let e = ask(&example, runs(&example, &crate::setup::ALL), variant).estimate;
        let (worst, n) = e
            .system
            .as_ref()
            .map_or((f64::NAN, 0), |s| errors(&s.0, &total));
        println!(
            "  1 all bodies, C1..C7: {} of {} combinations; the whole: {n} of ten, worst {worst:.1e}",
            e.identifiability.determined.len(),
            e.identifiability.parameters
        );
        let single = one_body(&tree, &example, true);
        let mut turning = runs(&single, &["C1"]);
        for table in &mut turning {
            table
                .channels
                .retain(|c| !c.name.starts_with("r_") && !c.name.starts_with("v_"));
        }
        let e = ask(&single, turning, variant).estimate;
        let (worst, n) = errors(&e.bodies[0], &total);
        println!(
            "  2 mass and mass centre known, C1 without velocity: {} of ten known or found, worst {worst:.1e}",
            n
        );
        let (e, worst) = base_mass_known(&example, variant);
        println!(
            "  2 as printed, mass and mass centre of the base known, C1 without velocity, C2..C7: {} of {} combinations; base tensor {}, mass of the whole off by {worst:.1e}",
            e.identifiability.determined.len(),
            e.identifiability.parameters,
            if e.bodies[0].inertia.iter().any(|n| n.value.is_some()) {
                "partly found"
            } else {
                "not found"
            },
        );
        let m = known(example.clone(), |b| b > 0);
        let e = ask(&m, runs(&m, &arms), variant).estimate;
        println!(
            "  3 base known, C2..C7, no thrust: {} of {} combinations",
            e.identifiability.determined.len(),
            e.identifiability.parameters
        );
        let m = known(example.clone(), |b| b == 0);
        let e = ask(&m, runs(&m, &arms), variant).estimate;
        let (worst, n) = errors(&e.bodies[0], &all[0]);
        println!("  3 arm known, C2..C7, no thrust: base {n} of ten, worst {worst:.1e}");
        let m = known(example.clone(), |b| b == 6);
        let e = ask(&m, runs(&m, &["C7"]), variant).estimate;
        let (worst, n) = errors(&e.bodies[6], &all[6]);
        println!("  4 grasped target, C7 alone: B6 {n} of ten, worst {worst:.1e}");
        println!(
            "  5 velocities only: uses 3 and 4 read rates, velocity, attitude, joints; no thrust, no acceleration"
        );
    }
}

/// The grasped target with all joints moving, noise as in the simulated data.
pub fn target() {
    let case = read_case(&examples().join("cases/xu2017_target_all_joints.toml")).expect("case");
    let vehicle = read_model(&case.model).expect("model");
    let true_body = vehicle.bodies[6].nominal;
    let mut off = vehicle.clone();
    off.bodies[6].nominal.mass *= 1.2;
    off.bodies[6].nominal.p_BoBcm_B *= 0.8;
    off.bodies[6].nominal.I_BBcm_B *= 1.3;
    let table = simulate_case(&case, &vehicle).expect("runs").table;
    println!(
        "Grasped target, all six joints moving at once, drifting and turning, noise as in the simulated data"
    );
    println!(
        "(gyro 1e-5 rad/s, tracker 5e-5 rad, position 1e-4 m, velocity 1e-5 m/s, encoders 2.4e-5 rad, joint rates 2e-5 rad/s)"
    );
    for (method, variant) in [("xu2017", Some("linear")), ("auto", None)] {
        let found = identify_tables(off.clone(), vec![table.clone()], &request(method, variant));
        let e = found.expect("suits").estimate;
        let b = &e.bodies[6];
        println!(
            "{method}, {}: status {}",
            variant.unwrap_or("default"),
            e.status.name()
        );
        println!(
            "  {:8} {:>11} {:>11} {:>10} {:>10} {:>7}",
            "", "truth", "value", "sigma", "error", "sigmas"
        );
        let row = |name: &str, n: &poinsot_identify::Number, t: f64| {
            let (v, s) = (n.value.unwrap_or(f64::NAN), n.sigma.unwrap_or(f64::NAN));
            println!(
                "  {name:8} {t:11.6} {v:11.6} {s:10.1e} {:10.1e} {:7.2}",
                v - t,
                (v - t) / s
            );
        };
        row("mass", &b.mass, true_body.mass);
        for k in 0..3 {
            row(
                ["com_x", "com_y", "com_z"][k],
                &b.com[k],
                true_body.p_BoBcm_B[k],
            );
        }
        for (k, at) in TENSOR.into_iter().enumerate() {
            row(
                ["I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz"][k],
                &b.inertia[k],
                true_body.I_BBcm_B[at],
            );
        }
    }
}

/// Sec. 5.6: sensitivity of candidate paths of each joint, and the one to take.
pub fn sensitivity() {
    let d: Data = data(&["C1"]);
    let bodies: Vec<InertialParameters> = d
        .model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let normal = vec![0.0; d.tree.dof()];
    println!(
        "Sensitivity of [P; H] per natural unit of the base side, rms over the path (nominal numbers); weakest of the seven directions that a joint shows"
    );
    println!(
        "  joint  path                 base rate rad/s   m        mc (largest)  I (largest)   strongest  weakest   take"
    );
    for joint in 0..d.tree.dof() {
        let candidates: Vec<(String, Vec<(f64, f64)>)> = [
            (15.0, 60.0),
            (30.0, 60.0),
            (60.0, 60.0),
            (30.0, 30.0),
            (90.0, 60.0),
        ]
        .iter()
        .map(|&(degrees, period): &(f64, f64)| {
            let (a, w) = (degrees.to_radians(), std::f64::consts::TAU / period);
            let path = (0..600).map(|k| {
                let t = period * f64::from(k) / 600.0;
                (a * (w * t).sin(), a * w * (w * t).cos())
            });
            (format!("+-{degrees} deg in {period} s"), path.collect())
        })
        .collect();
        let scores: Vec<_> = candidates
            .iter()
            .filter_map(|(name, path)| {
                Some((
                    name,
                    path_sensitivity(&d.tree, &bodies, &normal, joint, path)?,
                ))
            })
            .collect();
        let best = scores.iter().map(|s| s.1.weakest()).fold(0.0, f64::max);
        for (name, s) in &scores {
            let c = &s.coefficients;
            let largest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
            println!(
                "  {:5}  {name:20} {:12.4} {:11.2e} {:12.2e} {:12.2e} {:12.2e} {:9.2e}   {}",
                joint + 1,
                s.largest_rate,
                c[0],
                largest(&c[1..4]),
                largest(&c[4..]),
                s.singular.first().copied().unwrap_or(0.0),
                s.weakest(),
                if s.weakest() == best { "<-" } else { "" }
            );
        }
    }
}
