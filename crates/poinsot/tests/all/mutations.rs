//! Random mistakes in shipped models and telemetry: is an answer ever confident and wrong?
//!
//! A mutation is drawn from its number: a vehicle, a mistake and its size. Its class is set before the fit: *covered* by the
//! declared uncertainty, *harmless*, *visible* (a fit to samples without noise leaves a chi-square above 50) or *invisible*.
//! An answer is wrong where a number of it errs by more than five of its sigmas, and confident where it ends with exit code 0.
//! A cause is *listed* where the table of sensitivities names the number that is wrong.

mod mutation;

use crate::faults::{Craft, off_nominal};
use crate::tables::{self, processor_s};
use mutation::{Class, Mutation};
use poinsot::case::read_case;
use poinsot::trials::{Bound, Study, judged};
use poinsot::{Identified, Question, identify_tables};
use poinsot_model::{Model, Origin, read_model};
use poinsot_telemetry::{Table, check_conventions};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Sigmas beyond which a number is wrong.
const WRONG: f64 = 5.0;
/// Chi-square of the noise-free samples beyond which a mistake is visible.
const VISIBLE: f64 = 50.0;
/// Highest sample rate of a record, Hz: the satellites are simulated at up to 50.
const RATE_HZ: f64 = 10.0;
const SEED: u64 = 0x6d75_7461_7465;

pub struct Vehicle {
    name: &'static str,
    pub study: Study,
}

/// All vehicles, with nominal errors of a few percent and known numbers within the uncertainty of a drawing.
fn vehicles() -> Vec<Vehicle> {
    let shipped = |name: &str| {
        let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
        cases.join(name).with_extension("toml")
    };
    let cases: [(&'static str, PathBuf); 8] = [
        ("satellite", Craft::Satellite.path()),
        ("two-link arm", Craft::Arm.path()),
        ("low orbit", Craft::LowOrbit.path()),
        ("STSAT-3", shipped("stsat3_three_slews")),
        ("pyramid", shipped("pyramid")),
        ("tug", shipped("tug_thrusters")),
        ("cubesat", shipped("cubesat")),
        ("grasped target", shipped("xu2017_table13")),
    ];
    let vehicle = |(name, path): (_, PathBuf)| {
        let mut case = read_case(&path).unwrap();
        case.rate_hz = case.rate_hz.min(RATE_HZ);
        let truth = read_model(&case.model).unwrap();
        let model = off_nominal(truth.clone().with_usual_uncertainty(Origin::Cad));
        let study = Study::of_case(&case, &truth, model).unwrap();
        Vehicle { name, study }
    };
    cases.into_iter().map(vehicle).collect()
}

/// What came of one mutation.
struct Trial {
    /// Its number, vehicle, mistake and class, and why the answer is not confident.
    text: String,
    kind: &'static str,
    class: Class,
    /// Exit code 0.
    confident: bool,
    /// Largest error, sigmas; nothing determined: zero.
    worst: f64,
    /// Whether the table of sensitivities names the number that is wrong.
    listed: bool,
    seconds: f64,
}

impl Trial {
    fn wrong(&self) -> bool {
        self.confident && self.worst > WRONG
    }
}

/// The table *Random mistakes* of `docs/validation/faults.md`.
#[test]
#[ignore = "takes most of an hour"]
fn stat_table_of_random_mistakes() {
    let all = vehicles();
    let numbers = (0..tables::trials(2000)).into_par_iter();
    let done: Vec<Trial> = numbers.map(|number| trial(&all, number)).collect();
    let mut rows: BTreeMap<(Class, &str), Vec<&Trial>> = BTreeMap::new();
    for t in &done {
        rows.entry((t.class, t.kind)).or_default().push(t);
        rows.entry((t.class, "all")).or_default().push(t);
    }
    tables::heading(&[
        "class",
        "mistake",
        "trials",
        "exit code 0",
        "of these beyond 5 sigma",
        "of these not listed",
        "longest s",
    ]);
    for ((class, kind), list) in rows {
        let count = |of: &dyn Fn(&Trial) -> bool| list.iter().filter(|t| of(t)).count();
        tables::row(&[
            class.words().to_owned(),
            kind.to_owned(),
            list.len().to_string(),
            count(&|t| t.confident).to_string(),
            count(&Trial::wrong).to_string(),
            count(&|t| t.wrong() && !t.listed).to_string(),
            format!("{:.1}", list.iter().fold(0.0, |a, t| t.seconds.max(a))),
        ]);
    }
    let without_cause = |t: &&Trial| !t.confident && t.class <= Class::Harmless;
    for t in done.iter().filter(|t| t.wrong() || without_cause(t)) {
        println!("{}: {:.1} sigma", t.text, t.worst);
    }
    let hidden = |t: &&Trial| t.wrong() && (t.class != Class::Invisible || !t.listed);
    let hidden: Vec<&String> = done.iter().filter(hidden).map(|t| &t.text).collect();
    assert!(hidden.is_empty(), "{hidden:?}");
}

fn trial(all: &[Vehicle], number: u64) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    rng.set_stream(number);
    let mutation = Mutation::draw(all, &mut rng);
    let vehicle = mutation.vehicle;
    let class = class(&mutation);
    let start = processor_s();
    let (mut tables, biases) = vehicle.study.draw(number);
    let model = mutation.apply(&mut tables, &mut rng);
    let truth = vehicle.study.expected(&biases, &Bound::new());
    let answer = as_read(model, tables);
    let (confident, worst, listed, said) = match &answer {
        Err(refused) => (false, 0.0, false, refused.clone()),
        Ok(found) => {
            let all = judged(&found.estimate, &truth);
            let masses = all.determined().filter(|n| is_mass(&found.model, &n.name));
            let z = masses.filter_map(|n| n.z()).map(f64::abs);
            (
                found.passes(),
                z.fold(0.0, f64::max),
                listed(found, &mutation),
                found.estimate.doubts().join("; "),
            )
        }
    };
    let (name, mistake, words) = (vehicle.name, mutation.words(), class.words());
    Trial {
        text: format!("{number} {name}: {mistake} ({words}): {said}"),
        kind: mutation.kind(),
        class,
        confident,
        worst,
        listed,
        seconds: processor_s() - start,
    }
}

/// The answer of `identify`, with the check of files on reading; or why it is refused.
fn as_read(model: Model, tables: Vec<Table>) -> Result<Identified, String> {
    for table in &tables {
        check_conventions(table).map_err(|e| e.to_string())?;
    }
    identify_tables(model, tables, &Question::default()).map_err(|e| e.to_string())
}

/// Whether an address is one of a body.
fn is_mass(model: &Model, address: &str) -> bool {
    let body = address.split('.').next();
    model.bodies.iter().any(|b| Some(b.name.as_str()) == body)
}

fn listed(found: &Identified, mutation: &Mutation) -> bool {
    let name = mutation.known_name();
    let effects = &found.estimate.known_numbers.effects;
    name.is_some_and(|name| effects.iter().any(|e| e.name == name))
}

/// Set before the trial: by the size of the mistake in its declared uncertainty, and by the chi-square that samples without
/// noise leave. Known numbers have their declared uncertainty there: what it explains, no data can show.
fn class(mutation: &Mutation) -> Class {
    if let Some(class) = mutation.class_by_size() {
        return class;
    }
    let mut tables = mutation.vehicle.study.exact.clone();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let model = mutation.apply(&mut tables, &mut rng);
    // It is visible, too, where it is refused on reading.
    let left = as_read(model, tables).map(|found| found.estimate.diagnostics);
    match left.is_ok_and(|d| d.is_some_and(|d| d.chi2 <= VISIBLE)) {
        true => Class::Invisible,
        false => Class::Visible,
    }
}
