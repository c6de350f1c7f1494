//! One slew and three slews about different axes in the paper's time, with the sensors of the shipped model.

use crate::slew::cases;
use crate::trials::COLUMNS;
use poinsot::case::{parse_case, read_case};
use poinsot::simulate::simulate_trial;
use poinsot::{Question, identify_tables};
use poinsot_identify::Estimate;
use poinsot_model::read_model;
use poinsot_papers::kim2010::NAMES;

/// Trials with other noise.
const TRIALS: u64 = 20;
/// Where each of the six stands in the answer's order xx, xy, yy, xz, yz, zz.
const PLACE: [usize; 6] = [0, 2, 5, 1, 4, 3];
/// Title and case file.
pub const CASES: [(&str, &str); 3] = [
    ("one slew of 17 deg", "stsat3_kim2010.toml"),
    ("three slews of 17 deg", "stsat3_three_slews_17deg.toml"),
    ("three slews of 90 deg", "stsat3_three_slews.toml"),
];

/// What one method says, elements in the order of the paper's tables.
pub struct Answer {
    pub name: String,
    pub noisy: bool,
    /// Mean over the trials, kg m2; NaN where the method withholds the number.
    pub mean: [f64; 6],
    /// Root mean square error over the trials, kg m2.
    pub rms: [f64; 6],
    /// Sigma that the method states (mean), kg m2; `None` for the paper's.
    pub sigma: Option<[f64; 6]>,
}

/// Every column of Table 2, the iteration, the linear method and maximum likelihood on one case.
pub fn answers(case: &str) -> Result<Vec<Answer>, Box<dyn std::error::Error>> {
    let mut list = Vec::new();
    for noisy in [false, true] {
        for column in COLUMNS.into_iter().chain(["iterated"]) {
            list.push(answer(case, "kim2010", Some(column), noisy)?);
        }
        for method in ["linear", "maximum_likelihood"] {
            list.push(answer(case, method, None, noisy)?);
        }
    }
    Ok(list)
}

fn answer(
    name: &str,
    method: &str,
    variant: Option<&str>,
    noisy: bool,
) -> Result<Answer, Box<dyn std::error::Error>> {
    let path = cases().join(name);
    let mut text = std::fs::read_to_string(&path)?;
    let mut vehicle = read_model(&read_case(&path)?.model)?;
    let nominal = read_model(cases().join("../stsat3/model.toml"))?;
    let I = vehicle.bodies[0].nominal.I_BBcm_B;
    let wanted = poinsot_papers::kim2010::ELEMENTS.map(|e| I[e]);
    if !noisy {
        // Perfect instruments: the channels are those of the exact motion.
        vehicle.sensors.clear();
        text = text.replace("sensors_only = true", "sensors_only = false");
    }
    let case = parse_case(&path, text)?;
    let trials = if noisy { TRIALS } else { 1 };
    let share = 1.0 / trials as f64;
    let (mut mean, mut squares, mut sigmas) = ([0.0; 6], [0.0; 6], [0.0; 6]);
    for trial in 0..trials {
        let mut table = simulate_trial(&case, &vehicle, trial)?.table;
        table
            .channels
            .retain(|c| !c.name.starts_with("r_") && !c.name.starts_with("v_"));
        let request = Question {
            variant: variant.map(str::to_owned),
            ..Question::by(method)
        };
        let estimate = identify_tables(nominal.clone(), vec![table], &request)?.estimate;
        for (k, (value, sigma)) in numbers(&estimate).into_iter().enumerate() {
            mean[k] += value * share;
            squares[k] += (value - wanted[k]).powi(2) * share;
            sigmas[k] += sigma * share;
        }
    }
    Ok(Answer {
        name: variant.unwrap_or(method).to_owned(),
        noisy,
        mean,
        rms: squares.map(f64::sqrt),
        sigma: sigmas.iter().all(|s| s.is_finite()).then_some(sigmas),
    })
}

/// The six numbers as the method prints them, with the sigma that it states.
fn numbers(estimate: &Estimate) -> [(f64, f64); 6] {
    std::array::from_fn(|k| {
        let printed = estimate.method_report.iter().flat_map(|r| &r.numbers);
        let name = format!("inertia_{}", NAMES[k]);
        let number = printed.into_iter().find(|n| n.name == name);
        let number = number.map_or(estimate.bodies[0].inertia[PLACE[k]], |n| n.number);
        (
            number.value.unwrap_or(f64::NAN),
            number.sigma.unwrap_or(f64::NAN),
        )
    })
}
