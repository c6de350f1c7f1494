//! Probe: one fit a throw.
#![allow(non_snake_case)]
mod likelihood;
#[path = "../tudelft_throw/throws/mod.rs"]
#[allow(dead_code)]
mod throws;
use likelihood::{Declared, fit};
use nalgebra::Vector3;
use poinsot_model::{RandomTorque, parse_model};
use std::path::Path;
use throws::recording::{read_logs, read_recording};
use throws::{Fault, MODEL, Settings};

fn main() -> Result<(), Fault> {
    let folder = Path::new("/work/shared/data/real/tudelft_throw");
    let args: Vec<f64> = std::env::args()
        .skip(2)
        .map(|a| a.parse().unwrap())
        .collect();
    let group = std::env::args().nth(1).unwrap();
    let settings = Settings {
        cut_off_hz: f64::INFINITY,
        start_s: args[3],
        ..Settings::default()
    };
    let model = parse_model(MODEL, "model.toml")?;
    for log in read_logs(folder)?
        .iter()
        .filter(|l| l.group == group)
        .take(args[4] as usize)
    {
        let throw = read_recording(folder, &model, log, &settings)?;
        let started = std::time::Instant::now();
        let declared = Declared {
            gyro: Vector3::repeat(args[0]),
            torque: RandomTorque {
                sigma_N_m: args[1],
                correlation_s: args[2],
            },
        };
        let f = fit(&model, &[&throw], &declared)?;
        let e = f.I_over_J.symmetric_eigen();
        let s: Vec<f64> = (0..6).map(|k| f.covariance[(k, k)].sqrt()).collect();
        println!(
            "{} {:?} sig {:.2?} dev {:.1} rms {:.4?} com {:.2?} {:.2}s",
            log.name,
            e.eigenvalues.as_slice(),
            s,
            f.deviance,
            f.residual.as_slice(),
            (f.p_Sc_B * 1e3).as_slice(),
            started.elapsed().as_secs_f64()
        );
    }
    Ok(())
}
