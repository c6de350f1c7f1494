//! Random vehicles with only attitude and rate measured: answers compared with the truth.

use crate::vehicle::{
    Dice, Flight, ask, fly, moving, noisy, rotation_only, sensors, tree, with_wheels,
};
use poinsot::Identified;
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_identify::{Barycentric, TENSOR};
use poinsot_model::Model;
use poinsot_spatial::InertialParameters;

/// Noise of attitude (rad) and rate (rad/s), one sigma.
pub const NOISE: f64 = 1.0e-5;
/// Largest relative error of the nominal numbers.
const OFF: f64 = 0.2;
/// Joints of the vehicles, one letter each (r revolute); all carry three wheels.
pub const JOINTS: [&str; 12] = [
    "", "r", "rr", "r", "rr", "r", "rr", "r", "rr", "r", "rr", "r",
];

/// True vehicle `k`, and its answer from 1,000 rows in two records.
pub fn flown(k: usize) -> (Model, Identified) {
    let seed = 1_000 + k as u64;
    let mut truth = with_wheels(tree(seed, JOINTS[k % JOINTS.len()]));
    truth.sensors = sensors(NOISE);
    let records = [seed, seed + 50].map(|s| {
        let flight = Flight {
            rate_hz: 25.0,
            ..moving(&truth, s)
        };
        noisy(rotation_only(fly(&truth, &flight)), s, NOISE)
    });
    let answer = ask(
        &nominal(&truth, seed),
        records.to_vec(),
        "maximum_likelihood",
    );
    (truth, answer)
}

/// The nominal vehicle: every number with an error of up to 20 %.
fn nominal(truth: &Model, seed: u64) -> Model {
    let mut dice = Dice::new(seed ^ 0x0ff);
    let mut model = truth.clone();
    let mut factor = || 1.0 + dice.between(-OFF, OFF);
    for body in &mut model.bodies {
        body.nominal.mass *= factor();
        for x in body.nominal.p_BoBcm_B.iter_mut() {
            *x *= factor();
        }
        body.nominal.I_BBcm_B *= factor();
    }
    model
}

/// Error of each printed linear combination, in its sigma.
pub fn combinations(truth: &Model, answer: &Identified) -> Vec<f64> {
    let of = |name: &str| {
        let mut bodies = truth.bodies.iter();
        let body = bodies.find_map(|b| Some((b, name.strip_prefix(&b.name)?.strip_prefix('.')?)));
        let (body, number) = body.unwrap();
        match number.strip_prefix("I_BBcm_") {
            Some(element) => body.nominal.I_BBcm_B[at(element)],
            None => parameter(&body.nominal.parameters(), number),
        }
    };
    let all = answer.estimate.identifiability.determined.iter();
    let all = all.filter(|c| !c.coefficients.is_empty());
    all.map(|c| {
        let true_value: f64 = c.coefficients.iter().map(|(n, a)| a * of(n)).sum();
        (c.value - true_value) / c.sigma
    })
    .collect()
}

/// A barycentric parameter by its name in an answer.
fn parameter(pi: &InertialParameters, name: &str) -> f64 {
    match name.split_once('_') {
        None => pi.mass,
        Some(("mc", axis)) => pi.mc_B["xyz".find(axis).unwrap()],
        Some((_, tensor)) => pi.I_BBo_B[at(tensor.rsplit('_').next().unwrap())],
    }
}

/// Row and column of an element such as `xy`.
fn at(element: &str) -> (usize, usize) {
    let axis = |k: usize| "xyz".find(&element[k..=k]).unwrap();
    (axis(0), axis(1))
}

/// Error of each printed nonlinear function, in its sigma.
pub fn functions(truth: &Model, answer: &Identified) -> Vec<f64> {
    let pi: Vec<InertialParameters> = truth
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let Some(all) = Barycentric::new(&Tree::new(truth), &pi) else {
        return Vec::new();
    };
    let names: Vec<&str> = truth.bodies.iter().map(|b| b.name.as_str()).collect();
    let found = answer.estimate.identifiability.determined.iter();
    let found = found.filter(|c| c.coefficients.is_empty());
    found
        .map(|q| {
            let (what, of) = q.text.split_once(" of ").unwrap();
            let body = |name: &str| names.iter().position(|n| *n == name).unwrap();
            let element = at(&what[2..]);
            let true_value = match of.split_once(" and ") {
                None => all.K[body(of)][element],
                Some((a, b)) => {
                    let pair = (body(a), body(b));
                    let own = all.D.iter().find(|d| (d.0, d.1) == pair);
                    own.unwrap().2[element]
                }
            };
            (q.value - true_value) / q.sigma
        })
        .collect()
}

/// Errors of the mass properties of the whole, at the joint positions of the answer, in sigma.
pub fn system(truth: &Model, answer: &Identified) -> Vec<f64> {
    let Some((found, position)) = &answer.estimate.system else {
        return Vec::new();
    };
    let tree = Tree::new(truth);
    let kinematics = Kinematics::at(&tree, position);
    let pi: Vec<InertialParameters> = truth
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let I = composite(&pi, &kinematics).I_SScm_B();
    let all = found.inertia.iter().zip(TENSOR);
    all.filter_map(|(n, element)| Some((n.value? - I[element]) / n.sigma?))
        .collect()
}

/// The largest absolute value; zero if empty.
pub fn worst(all: &[f64]) -> f64 {
    all.iter().fold(0.0, |a, b| f64::max(a, b.abs()))
}
