//! Random mistakes in shipped models and telemetry: is an answer ever confident and wrong?
//!
//!     cargo run --release -p poinsot --example mutations -- [--trials 2000] [--first 0]
//!
//! A mutation is drawn from its number: a vehicle, a mistake and its size. Its class is set before the fit: *covered* by the
//! declared uncertainty, *harmless*, *visible* (a fit to samples without noise leaves a chi-square above 50) or *invisible*.
//! An answer is wrong where a number of it errs by more than five of its sigmas, and confident where it ends with exit code 0.
//! A cause is *listed* where the table of sensitivities names the number that is wrong.
#![allow(non_snake_case)]

mod mutation;
mod vehicles;

use mutation::{Class, Mutation};
use poinsot::{Identified, Question, identify_tables};
use poinsot_model::Model;
use poinsot_telemetry::{Table, check_conventions};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::error::Error;
use vehicles::{Vehicle, vehicles};

/// Sigmas beyond which a number is wrong.
const WRONG: f64 = 5.0;
/// Chi-square of the noise-free samples beyond which a mistake is visible.
const VISIBLE: f64 = 50.0;
/// Rows of a record that a trial of that time may have; a longer one has as much more.
const ROWS: f64 = 1000.0;
/// Seconds of processor time beyond which a trial is named on the way.
const SLOW_S: f64 = 5.0;
const SEED: u64 = 0x6d75_7461_7465;

/// What came of one mutation.
struct Trial {
    number: u64,
    vehicle: &'static str,
    mistake: String,
    kind: &'static str,
    class: Class,
    /// Exit code 0.
    confident: bool,
    /// Largest error, sigmas; nothing determined: zero.
    worst: f64,
    /// Whether the table of sensitivities names the number that is wrong.
    listed: bool,
    said: String,
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut trials, mut first) = (2000_u64, 0_u64);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or(format!("{word}: a number is missing"))?;
        match word.as_str() {
            "--trials" => trials = value.parse()?,
            "--first" => first = value.parse()?,
            _ => return Err(format!("{word}: known are --trials N, --first N").into()),
        }
    }
    let all = vehicles()?;
    let run = |number: u64| trial(&all, number);
    let done: Vec<Trial> = (first..first + trials)
        .into_par_iter()
        .map(run)
        .collect::<Result<_, _>>()
        .map_err(|e: String| e)?;
    print_table(&done);
    for t in done.iter().filter(|t| t.worst > WRONG && t.confident) {
        println!(
            "\n{} {}: {} ({}): {:.1} sigma, exit code 0, {}",
            t.number,
            t.vehicle,
            t.mistake,
            t.class.words(),
            t.worst,
            if t.listed { "listed" } else { "not listed" }
        );
    }
    for t in done
        .iter()
        .filter(|t| !t.confident && matches!(t.class, Class::Harmless | Class::Covered))
    {
        println!("\n{} {}: {}: {}", t.number, t.vehicle, t.mistake, t.said);
    }
    Ok(())
}

fn trial(all: &[Vehicle], number: u64) -> Result<Trial, String> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    rng.set_stream(number);
    let mutation = Mutation::draw(all, &mut rng);
    let vehicle = mutation.vehicle;
    let class = class(&mutation)?;
    let start = processor_s();
    let (mut tables, biases) = vehicle.study.draw(number);
    let model = mutation.apply(&mut tables, &mut rng);
    let truth = vehicle.study.true_numbers(&biases);
    let answer = as_read(model, tables);
    let (confident, worst, listed, said) = match &answer {
        Err(refused) => (false, 0.0, false, refused.clone()),
        Ok(found) => {
            let errors = poinsot::trials::judged(&found.estimate, &truth);
            let z = errors
                .numbers
                .iter()
                .filter(|n| is_mass(&found.model, &n.name));
            let worst = z.map(|n| (n.error / n.sigma).abs()).fold(0.0, f64::max);
            let said = match found.estimate.doubts().join("; ") {
                none if none.is_empty() => "not every number asked for is determined".to_owned(),
                doubts => doubts,
            };
            (found.passes(), worst, listed(found, &mutation), said)
        }
    };
    let seconds = processor_s() - start;
    let rows = vehicle.rows();
    if seconds > SLOW_S * (rows as f64 / ROWS).max(1.0) {
        eprintln!(
            "{number} {}: {}: {seconds:.1} s, {rows} rows",
            vehicle.name,
            mutation.words()
        );
    }
    Ok(Trial {
        number,
        vehicle: vehicle.name,
        mistake: mutation.words(),
        kind: mutation.kind(),
        class,
        confident,
        worst,
        listed,
        said,
    })
}

/// The answer of `identify`, with the check of files on reading; or why it is refused.
fn as_read(model: Model, tables: Vec<Table>) -> Result<Identified, String> {
    for table in &tables {
        check_conventions(table).map_err(|e| e.to_string())?;
    }
    identify_tables(model, tables, &Question::default()).map_err(|e| e.to_string())
}

/// Processor time of this thread, s; zero if unknown. Exact with one thread.
fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.unwrap_or(0.0) * 1.0e-9
}

/// Whether an address is one of a body.
fn is_mass(model: &Model, address: &str) -> bool {
    let mut bodies = model.bodies.iter();
    bodies.any(|b| {
        address
            .strip_prefix(&b.name)
            .is_some_and(|rest| rest.starts_with('.'))
    })
}

fn listed(found: &Identified, mutation: &Mutation) -> bool {
    let name = mutation.known_name();
    let effects = &found.estimate.known_numbers.effects;
    name.is_some_and(|name| effects.iter().any(|e| e.name == name))
}

/// Set before the trial: by the size of the mistake in its declared uncertainty, and by the chi-square that samples without
/// noise leave. Known numbers have their declared uncertainty there: what it explains, no data can show.
fn class(mutation: &Mutation) -> Result<Class, String> {
    if let Some(class) = mutation.class_by_size() {
        return Ok(class);
    }
    let mut tables: Vec<Table> = mutation.vehicle.study.exact.clone();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let model = mutation.apply(&mut tables, &mut rng);
    let Ok(found) = as_read(model, tables) else {
        // It is refused on reading.
        return Ok(Class::Visible);
    };
    let chi2 = found.estimate.diagnostics.map_or(f64::INFINITY, |d| d.chi2);
    Ok(match chi2 > VISIBLE {
        true => Class::Visible,
        false => Class::Invisible,
    })
}

fn print_table(trials: &[Trial]) {
    let mut rows: BTreeMap<(Class, &str), Vec<&Trial>> = BTreeMap::new();
    for t in trials {
        rows.entry((t.class, t.kind)).or_default().push(t);
    }
    println!(
        "| class | mistake | trials | exit code 0 | of these beyond 5 sigma | of these not listed |"
    );
    println!("|---|---|---|---|---|---|");
    let mut sums = [0; 4];
    for ((class, kind), list) in rows {
        let confident = list.iter().filter(|t| t.confident).count();
        let wrong = |t: &&&Trial| t.confident && t.worst > WRONG;
        let beyond = list.iter().filter(wrong).count();
        let unlisted = list.iter().filter(wrong).filter(|t| !t.listed).count();
        let counts = [list.len(), confident, beyond, unlisted];
        println!(
            "| {} | {kind} | {} | {} | {} | {} |",
            class.words(),
            counts[0],
            counts[1],
            counts[2],
            counts[3]
        );
        sums.iter_mut().zip(counts).for_each(|(s, c)| *s += c);
    }
    println!(
        "| all | | {} | {} | {} | {} |",
        sums[0], sums[1], sums[2], sums[3]
    );
}
