//! Trial flights of a designed manoeuvre. Each has a vehicle of the prior and new sensor noise; its error is compared
//! with the predicted sigma.

use crate::reliability::ALLOWED;
use crate::trial::Question;
use crate::vehicles::drawn;
use crate::watch::fine_times;
use poinsot::Error;
use poinsot::case::{Case, Want};
use poinsot::predict::{covariance_name, wanted_sigma};
use poinsot::trials::{Band, Bound, Row, Study};
use poinsot_files::{check_memory, check_time};
use poinsot_formats::{Address, DesignVerificationFile, VerifiedNumberFile, address};
use poinsot_identify::Estimate;
use poinsot_model::Model;
use rayon::prelude::*;

/// First random stream of trial flights.
const FLIGHT_STREAM: u64 = 1 << 33;
/// Tolerance on a limit, relative: round-off.
const ROUNDED: f64 = 2.0e-6;
/// Memory of the outcome of a flight, bytes.
const OF_FLIGHT: f64 = 128.0;

/// Quantities of a body.
const MASSES: [&str; 3] = ["mass_kg", "com_m", "inertia_kg_m2"];

/// One flight: error over predicted sigma of every wanted number, and whether a limit was exceeded.
type Outcome = Result<(Vec<f64>, bool), String>;

/// Checks that memory and time are there for so many trial flights.
///
/// # Errors
/// E0006 with both figures.
pub(crate) fn check_flights(case: &Case, model: &Model, flights: u64) -> Result<(), Error> {
    let what = format!("the {flights} trial flights");
    check_memory(&what, flights as f64 * OF_FLIGHT)?;
    check_time(&what, flights as f64 * case.check_fit(model)?)
}

/// Runs the trial flights of a manoeuvre.
///
/// # Errors
/// The case does not fit its model.
pub(crate) fn verify(
    case: &Case,
    question: &Question,
    flights: u64,
) -> Result<DesignVerificationFile, Error> {
    let one = |k: u64| flight(case, question, k);
    let all: Vec<Outcome> = (0..flights).into_par_iter().map(one).collect();
    let (mut failed, mut flown) = (Vec::new(), Vec::new());
    for (k, outcome) in all.into_iter().enumerate() {
        match outcome {
            Err(why) => failed.push(format!("flight {k}: {why}")),
            Ok(flight) => flown.push(flight),
        }
    }
    let answered = flown.len() as u64;
    let limits_broken = flown.iter().filter(|flight| flight.1).count() as u64;
    let band = Band::of_rms(answered.max(1));
    let number = |(i, want): (usize, &Want)| {
        let ratios = flown.iter().map(|flight| flight.0[i]);
        let squares = ratios.fold(0.0, |sum, ratio| sum + ratio * ratio);
        VerifiedNumberFile {
            name: want.name.clone(),
            rms_ratio: (squares / answered.max(1) as f64).sqrt(),
            band: [band.low, band.high],
            flights: answered,
        }
    };
    let numbers = question.wants.iter().enumerate().map(number);
    let numbers: Vec<VerifiedNumberFile> = numbers.collect();
    let held = numbers.iter().all(|n| band.holds(n.rms_ratio));
    Ok(DesignVerificationFile {
        flights,
        agrees: held && failed.is_empty() && limits_broken <= expected_at_most(flights),
        failed,
        numbers,
        limits_broken,
    })
}

/// Largest number of flights beyond a limit that chance gives with a probability of 1 % or more, where the limits hold for all but
/// [`ALLOWED`] of the vehicles (Poisson).
fn expected_at_most(flights: u64) -> u64 {
    let mean = ALLOWED * flights as f64;
    let (mut term, mut below, mut count) = ((-mean).exp(), 0.0, 0);
    while below + term < 0.99 {
        below += term;
        count += 1;
        term *= mean / count as f64;
    }
    count
}

fn flight(case: &Case, question: &Question, k: u64) -> Outcome {
    let model = &question.model;
    let words = |e: Error| e.to_string();
    let model = &of_trial(model);
    let truth = drawn(model, question.design.seed, FLIGHT_STREAM + k);
    let mut study = Study::of_case(case, &truth, without_priors(model)).map_err(words)?;
    study.diagnose = false;
    let predicted = study.predicted().map_err(words)?;
    let row = study.trial(k, &Bound::new());
    let answer = row.answer()?;
    let ratio = |want: &Want| {
        let sigma = wanted_sigma(&predicted, want);
        let error = error_of(&predicted, answer, want);
        match (error, sigma) {
            (Some(error), Some(sigma)) => Ok(error / sigma),
            _ => Err(format!("{} is not determined", want.name)),
        }
    };
    let ratios: Result<Vec<f64>, String> = question.wants.iter().map(ratio).collect();
    let mut scenario = case.bind(&truth).map_err(|e| e.to_string())?;
    scenario.times = fine_times(case);
    let course = question.course(&truth, &scenario).map_err(words)?;
    let worst = course.worst(&question.watch);
    Ok((ratios?, worst.iter().any(|w| w.1 > ROUNDED)))
}

/// What is known so far of the bodies alone: trials draw neither known numbers nor errors of sensors from it.
fn of_trial(model: &Model) -> Model {
    let mut model = model.clone();
    if let Some(posterior) = &mut model.knowledge.posterior {
        let quantity = |at: &str| Address::parse(at).quantity().to_owned();
        *posterior = posterior.exact_of(|at| MASSES.contains(&quantity(at).as_str()));
    }
    model
}

/// Removes priors: they describe the population of vehicles, not this vehicle.
fn without_priors(model: &Model) -> Model {
    let mut model = model.clone();
    model.bodies.iter_mut().for_each(|b| b.prior = None);
    model
}

fn error_of(bound: &Estimate, answer: &Row, want: &Want) -> Option<f64> {
    let mut sum = 0.0;
    for term in &want.terms {
        let name = address(&covariance_name(bound.bodies.get(term.body)?, term), "");
        sum += term.factor * answer.number(&name)?.error()?;
    }
    Some(sum)
}
