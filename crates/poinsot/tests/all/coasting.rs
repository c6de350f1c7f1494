//! A spin with a small nutation, seen by a gyro alone, from a model whose nutation has another frequency: chi-square has a minimum for
//! every whole turn of the difference. Truth: the closed form of the torque-free top.

use crate::tables;
use nalgebra::{Matrix3, Vector3};
use poinsot::{IdentifyRequest, Question, estimate_file, identify};
use poinsot_formats::EstimateFile;
use poinsot_testkit::rigid_body::{AsymmetricTop, Spin};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

const NOISE: f64 = 1.6e-3;
const WALK: f64 = 1.0e-4;
const BIAS: f64 = 0.1;
const SECONDS: usize = 900;

/// Rates of a record whose columns are in deg/s.
pub fn rates(path: &Path) -> Vec<Vector3<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let row = |line: &str| {
        let mut cells = line.split(',').skip(1).map(|c| c.parse::<f64>().unwrap());
        Vector3::from_fn(|_, _| cells.next().unwrap().to_radians())
    };
    text.lines().skip(1).map(row).collect()
}

/// Angular frequency of the nutation of an answer, whose body turns at the mean of the measured rates less the bias; `None` without
/// numbers.
pub fn nutation(file: &EstimateFile, rates: &[Vector3<f64>], body: &str) -> Option<f64> {
    let tensor = &file.bodies[body].inertia_kg_m2;
    let values = tensor.named().map(|(_, number)| number.value);
    let [xx, yy, zz, xy, xz, yz] = values;
    let (xx, yy, zz) = (xx?, yy?, zz?);
    let (xy, xz, yz) = (xy?, xz?, yz?);
    let I = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let mean = rates.iter().sum::<Vector3<f64>>() / rates.len() as f64;
    let bias = |axis: &str| file.nuisance[&format!("gyro.bias_rad_s.{axis}")].value;
    let bias = Vector3::new(bias("x")?, bias("y")?, bias("z")?);
    Some(frequency(&I, mean - bias))
}

fn frequency(I_BBcm_B: &Matrix3<f64>, w_NB_B: Vector3<f64>) -> f64 {
    let R_NB = Matrix3::identity();
    let top = AsymmetricTop::new(I_BBcm_B, &Spin { R_NB, w_NB_B }).unwrap();
    0.5 * TAU / top.period()
}

/// The true tensor for a seed, and a record of it.
fn record(seed: u64, path: &Path) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let tilt = 1.0e-5 * normal();
    let I = Matrix3::new(0.0385, tilt, 0.0, tilt, 0.03865, 0.0, 0.0, 0.0, 0.0069);
    // About the principal axis, and by the noise of a reading off it.
    let spin = Vector3::new(NOISE + 0.42 * tilt / 1.5e-4, 0.42, 0.0);
    let R_NB = Matrix3::identity();
    let top = AsymmetricTop::new(&I, &Spin { R_NB, w_NB_B: spin }).unwrap();
    let mut bias = Vector3::from_fn(|_, _| 0.3 * BIAS * normal());
    let mut text = "time_s,x,y,z\n".to_owned();
    for k in 0..SECONDS {
        let noise = Vector3::from_fn(|_, _| NOISE * normal());
        let read = (top.at(k as f64).w_NB_B + bias + noise).map(f64::to_degrees);
        text.push_str(&format!("{k},{:.6},{:.6},{:.6}\n", read.x, read.y, read.z));
        bias += Vector3::from_fn(|_, _| WALK * normal());
    }
    std::fs::write(path, text).unwrap();
    0.5 * TAU / top.period()
}

fn model() -> String {
    format!(
        r#"
schema = "poinsot.model/1"
name = "spinner"

[[body]]
name = "bus"
mass_kg = 3.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = {{ xx = 0.0385, yy = 0.03855, zz = 0.0069 }}
estimate = ["inertia"]
prior = {{ inertia_kg_m2 = 2e-4 }}

[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = {NOISE:?}
walk_rad_s_s05 = {WALK:?}
bias = {{ sigma_rad_s = {BIAS:?} }}

[telemetry.columns]
time_s = {{ column = "time_s", unit = "s" }}
omega_x = {{ column = "x", unit = "deg/s" }}
omega_y = {{ column = "y", unit = "deg/s" }}
omega_z = {{ column = "z", unit = "deg/s" }}
"#
    )
}

/// Of a nominal that is three turns off at the end of the record, with a bias that may be a quarter of the spin. A record may be
/// withheld; none is answered with another turn.
#[test]
fn stat_nutation_is_found_from_the_wrong_turn() {
    let trials = tables::trials(2);
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("model.toml");
    std::fs::write(&own, model()).unwrap();
    let mut answered = 0;
    for seed in 1..=trials {
        let telemetry = folder.path().join("rates.csv");
        let truth = record(seed, &telemetry);
        let identified = identify(&IdentifyRequest {
            model: own.clone(),
            segments: vec![vec![telemetry.clone()]],
            question: Question::by("auto"),
            ..IdentifyRequest::default()
        })
        .unwrap();
        let found = nutation(&estimate_file(&identified), &rates(&telemetry), "bus");
        let Some(found) = found.filter(|_| identified.passes()) else {
            println!("{seed}: withheld");
            continue;
        };
        answered += 1;
        let turned = (found - truth) * SECONDS as f64;
        println!("{seed}: {found:.5} rad/s, truth {truth:.5}, {turned:+.2} rad at the end");
        assert!(turned.abs() < FRAC_PI_2, "{seed}: {turned}");
    }
    assert!(4 * answered >= 3 * trials, "{answered} of {trials}");
}
