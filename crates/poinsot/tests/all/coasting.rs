//! A spin with a small nutation, seen by a gyro alone, from a model whose nutation has another frequency: chi-square has a minimum for
//! every whole turn of the difference. Truth: the closed form of the torque-free top.

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
const BIAS: f64 = 0.01;
const SECONDS: usize = 600;

/// Rates of a record whose columns are in deg/s.
pub fn rates(path: &Path) -> Vec<Vector3<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let row = |line: &str| {
        let mut cells = line.split(',').skip(1).map(|c| c.parse::<f64>().unwrap());
        Vector3::from_fn(|_, _| cells.next().unwrap().to_radians())
    };
    text.lines().skip(1).map(row).collect()
}

/// Angular frequency of the nutation of an answer, whose body turns at the mean of the measured rates less the bias.
pub fn nutation(file: &EstimateFile, rates: &[Vector3<f64>], body: &str) -> f64 {
    let tensor = &file.bodies[body].inertia_kg_m2;
    let number = |name: &str| {
        let mut all = tensor.named().into_iter();
        all.find(|(own, _)| *own == name).unwrap().1.value.unwrap()
    };
    let I = Matrix3::new(
        number("xx"),
        number("xy"),
        number("xz"),
        number("xy"),
        number("yy"),
        number("yz"),
        number("xz"),
        number("yz"),
        number("zz"),
    );
    let mean = rates.iter().sum::<Vector3<f64>>() / rates.len() as f64;
    let bias = ["x", "y", "z"].map(|axis| {
        let name = format!("gyro.bias_rad_s.{axis}");
        file.nuisance[&name].value.unwrap()
    });
    frequency(&I, mean - Vector3::from(bias))
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
    let spin = Vector3::new(NOISE, 0.5, 0.0) - Vector3::x() * (0.5 * tilt / 1.5e-4);
    let R_NB = Matrix3::identity();
    let top = AsymmetricTop::new(&I, &Spin { R_NB, w_NB_B: spin }).unwrap();
    let mut bias = Vector3::from_fn(|_, _| BIAS * normal());
    let mut text = "time_s,x,y,z\n".to_owned();
    for k in 0..SECONDS {
        let noise = Vector3::from_fn(|_, _| NOISE * normal());
        let read = (top.at(k as f64).w_NB_B + bias + noise).map(f64::to_degrees);
        text.push_str(&format!("{k},{:.6},{:.6},{:.6}\n", read.x, read.y, read.z));
        bias += Vector3::from_fn(|_, _| 2.0e-5 * normal());
    }
    std::fs::write(path, text).unwrap();
    0.5 * TAU / top.period()
}

fn model(excess: f64) -> String {
    format!(
        r#"
schema = "poinsot.model/1"
name = "spinner"

[[body]]
name = "bus"
mass_kg = 3.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = {{ xx = 0.0385, yy = {:?}, zz = 0.0069 }}
estimate = ["inertia"]
prior = {{ inertia_kg_m2 = 2e-4 }}

[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = {NOISE:?}
walk_rad_s_s05 = 2e-5
bias = {{ sigma_rad_s = {BIAS:?} }}

[telemetry.columns]
time_s = {{ column = "time_s", unit = "s" }}
omega_x = {{ column = "x", unit = "deg/s" }}
omega_y = {{ column = "y", unit = "deg/s" }}
omega_z = {{ column = "z", unit = "deg/s" }}
"#,
        0.0385 + excess
    )
}

/// Of nominals that are two to three turns off at the end of the record, slow and fast.
#[test]
fn stat_nutation_is_found_from_the_wrong_turn() {
    let folder = tempfile::tempdir().unwrap();
    for (seed, excess) in [(1, 0.5e-4), (2, 3.0e-4), (3, 0.6e-4), (4, 2.8e-4)] {
        let [telemetry, own] = ["rates.csv", "model.toml"].map(|name| folder.path().join(name));
        let truth = record(seed, &telemetry);
        std::fs::write(&own, model(excess)).unwrap();
        let identified = identify(&IdentifyRequest {
            model: own,
            segments: vec![vec![telemetry.clone()]],
            question: Question::by("auto"),
            ..IdentifyRequest::default()
        })
        .unwrap();
        let found = nutation(&estimate_file(&identified), &rates(&telemetry), "bus");
        let turned = (found - truth) * SECONDS as f64;
        println!("{seed}: {found:.5} rad/s, truth {truth:.5}, {turned:+.2} rad at the end");
        assert!(turned.abs() < FRAC_PI_2, "{seed}: {turned}");
    }
}
