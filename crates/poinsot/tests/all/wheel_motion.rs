//! What wheels do between their samples: where the data can hardly tell, the sigmas hold the choice.

use crate::shared::rows;
use poinsot::case::parse_case;
use poinsot::trials::{Band, Row, Study};
use poinsot_model::read_model;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Trials of each hypothesis.
const TRIALS: u64 = 400;
const RATE_HZ: f64 = 10.0;
const DURATION_S: f64 = 33.3;
/// Speeds at nine nodes, rad/s: a manoeuvre of 33 s, for which both hypotheses differ by one sigma of the answer and by one
/// unit of -2 ln L.
const SPEEDS: [[f64; 9]; 3] = [
    [0.0, -345.0, 7.0, -199.0, -611.0, -443.0, 27.0, 312.0, 0.0],
    [0.0, -365.0, -97.0, 408.0, 704.0, 354.0, 490.0, 378.0, 0.0],
    [0.0, 257.0, 736.0, 901.0, 504.0, 13.0, -308.0, 19.0, 0.0],
];

fn model() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases/stsat3_truth.toml")
}

/// STSAT-3 with wheel speeds that are smooth, or that have the same values at the samples and constant torque between them.
fn study(smooth: bool) -> Study {
    let mut text = format!(
        "schema = \"poinsot.case/1\"\nmodel = {:?}\nduration_s = {DURATION_S}\n[initial]\nmomentum_zero = true\n[output]\nrate_hz = {RATE_HZ}\nsensors_only = true\n",
        model().display().to_string()
    );
    for (k, nodes) in SPEEDS.iter().enumerate() {
        let (times, speeds, way) = match smooth {
            true => (even(nodes.len() - 1), nodes.to_vec(), "cubic_clamped"),
            false => sampled(nodes),
        };
        let _ = write!(
            text,
            "[[wheel_motion]]\nwheel = \"wheel{}\"\ntime_s = {times:?}\nspeed_rad_s = {speeds:?}\ninterpolation = \"{way}\"\n",
            k + 1
        );
    }
    let truth = read_model(model()).unwrap();
    let case = parse_case(Path::new("between.toml"), text).unwrap();
    let mut study = Study::of_case(&case, &truth, truth.clone()).unwrap();
    study.diagnose = false;
    study
}

fn even(steps: usize) -> Vec<f64> {
    let at = |k: usize| DURATION_S * k as f64 / steps as f64;
    (0..=steps).map(at).collect()
}

/// Values of the clamped cubic spline at the samples (the natural equations, solved by Thomas).
fn sampled(nodes: &[f64; 9]) -> (Vec<f64>, Vec<f64>, &'static str) {
    let h = DURATION_S / 8.0;
    // Slopes m at the nodes: m0 = m8 = 0, m[k-1] + 4 m[k] + m[k+1] = 3 (y[k+1] - y[k-1]) / h.
    let mut upper = [0.0; 9];
    let mut m = [0.0; 9];
    for k in 1..8 {
        let pivot = 4.0 - upper[k - 1];
        upper[k] = 1.0 / pivot;
        m[k] = (3.0 * (nodes[k + 1] - nodes[k - 1]) / h - m[k - 1]) / pivot;
    }
    for k in (1..8).rev() {
        m[k] -= upper[k] * m[k + 1];
    }
    let count = (DURATION_S * RATE_HZ).round() as usize;
    let times = even(count);
    let value = |t: &f64| {
        let k = ((t / h) as usize).min(7);
        let s = t / h - k as f64;
        let (a, b) = (nodes[k], nodes[k + 1]);
        let (p, q) = (h * m[k], h * m[k + 1]);
        a + s * (p + s * (3.0 * (b - a) - 2.0 * p - q + s * (2.0 * (a - b) + p + q)))
    };
    let speeds = times.iter().map(value).collect();
    (times, speeds, "linear")
}

#[test]
fn stat_a_wheel_motion_that_the_data_can_hardly_tell_is_in_the_sigmas() {
    for smooth in [true, false] {
        let study = study(smooth);
        let predicted = study.predicted().unwrap().bodies[0].inertia;
        let bound = study.bound().unwrap().bodies[0].inertia;
        let trials = rows(&study, 0..TRIALS);
        let answers: Vec<&Row> = trials.iter().filter(|r| r.status.is_some()).collect();
        assert_eq!(answers.len() as u64, TRIALS);
        let band = Band::of_rms(TRIALS);
        for k in 0..6 {
            let sigma = predicted[k].sigma.unwrap();
            let all = || answers.iter().map(|a| a.determined().nth(k).unwrap());
            let errors = || all().map(|n| n.error().unwrap());
            let square = errors().map(|e| (e / sigma).powi(2)).sum::<f64>();
            let rms = (square / TRIALS as f64).sqrt();
            let stated = all()
                .map(|n| (n.sigma.unwrap() / sigma).powi(2))
                .sum::<f64>();
            let stated = (stated / TRIALS as f64).sqrt();
            let held = all().filter(|n| n.z().unwrap().abs() < 1.959_964);
            let held = held.count() as f64 / TRIALS as f64;
            let alone = bound[k].sigma.unwrap() / sigma;
            println!(
                "smooth {smooth}, {k}: rms {rms:.3}, stated {stated:.3}, coverage {held:.3}, bound {alone:.3}"
            );
            assert!(rms > band.low && rms < band.high, "{rms} {band:?}");
            assert!((stated - 1.0).abs() < 0.02, "{stated}");
            // The 99.9 % band of a binomial share.
            assert!(
                (held - 0.95).abs() < 3.3 * (0.05 * 0.95 / TRIALS as f64).sqrt(),
                "{held}"
            );
        }
        // The bound of one who knows the motion is lower: for the diagonal elements by several per cent.
        let diagonal = [0, 2, 5].map(|k| bound[k].sigma.unwrap() / predicted[k].sigma.unwrap());
        assert!(diagonal.iter().all(|b| *b < 0.98), "{diagonal:?}");
    }
}
