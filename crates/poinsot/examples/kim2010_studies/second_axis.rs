//! Three slews about different axes in the paper's time, with the sensors of the shipped model.

use crate::slew::cases;
use poinsot::case::{parse_case, read_case};
use poinsot::simulate::simulate_trial;
use poinsot::{Question, identify_tables};
use poinsot_model::read_model;
use poinsot_papers::kim2010::NAMES;

/// Trials with other noise.
const TRIALS: u64 = 20;
/// Where each of the six stands in the answer's order xx, xy, yy, xz, yz, zz.
const PLACE: [usize; 6] = [0, 2, 5, 1, 4, 3];

/// Errors of one method, elements in the order of the paper's tables.
pub struct Errors {
    pub name: String,
    /// Root mean square over the trials, kg m2.
    pub rms: [f64; 6],
    /// Sigma that the method states (mean), kg m2; `None` for the paper's.
    pub sigma: Option<[f64; 6]>,
}

pub fn errors() -> Result<Vec<Errors>, Box<dyn std::error::Error>> {
    let path = cases().join("stsat3_three_slews.toml");
    let text = std::fs::read_to_string(&path)?;
    let case = parse_case(&path, text.clone())?;
    let truth = read_model(&read_case(&path)?.model)?;
    let nominal = read_model(cases().join("../stsat3/model.toml"))?;
    let I = truth.bodies[0].nominal.I_BBcm_B;
    let wanted = [
        I[(0, 0)],
        I[(1, 1)],
        I[(2, 2)],
        I[(0, 1)],
        I[(1, 2)],
        I[(2, 0)],
    ];
    let mut list = Vec::new();
    let methods = [
        ("linear", None, false),
        ("kim2010", Some("suggested"), false),
        ("kim2010", Some("iterated"), false),
        ("kim2010", Some("suggested"), true),
        ("kim2010", Some("iterated"), true),
        ("linear", None, true),
        ("maximum_likelihood", None, true),
    ];
    for (method, variant, noisy) in methods {
        let mut squares = [0.0; 6];
        let mut sigmas = [0.0; 6];
        let trials = if noisy { TRIALS } else { 1 };
        for trial in 0..trials {
            let mut vehicle = truth.clone();
            let mut case = case.clone();
            if !noisy {
                // Perfect instruments: the channels are those of the exact motion.
                vehicle.sensors.clear();
                let exact = text.replace("sensors_only = true", "sensors_only = false");
                case = parse_case(&path, exact)?;
            }
            let mut table = simulate_trial(&case, &vehicle, trial)?.table;
            table
                .channels
                .retain(|c| !c.name.starts_with("r_") && !c.name.starts_with("v_"));
            let request = Question {
                variant: variant.map(str::to_owned),
                ..Question::by(method)
            };
            let estimate = identify_tables(nominal.clone(), vec![table], &request)?.estimate;
            for (k, place) in PLACE.into_iter().enumerate() {
                let number = estimate.bodies[0].inertia[place];
                let value = number
                    .value
                    .ok_or(format!("{method}: {} is open", NAMES[k]))?;
                squares[k] += (value - wanted[k]).powi(2) / trials as f64;
                sigmas[k] += number.sigma.unwrap_or(f64::NAN) / trials as f64;
            }
        }
        let variant = variant.map_or(String::new(), |v| format!(" {v}"));
        let kind = if noisy { "" } else { ", noise-free" };
        list.push(Errors {
            name: format!("{method}{variant}{kind}"),
            rms: squares.map(f64::sqrt),
            sigma: sigmas.iter().all(|s| s.is_finite()).then_some(sigmas),
        });
    }
    Ok(list)
}
