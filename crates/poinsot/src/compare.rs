//! The command `compare`: consistency of several results of one vehicle.
//!
//! Let result i have numbers `x_i` with covariance `C_i`. If the results are independent and the vehicle did not
//! change, the differences `x_i - x_1` have covariance `C_1 + delta_ij C_i`. Their squared Mahalanobis norm is then
//! chi-square distributed (Rao 1973, 8b). Consistent results are averaged with information weights.

mod statistics;

use crate::error::Error;
use indexmap::IndexMap;
use poinsot_files::significant;
use poinsot_formats::{
    Address, COMPARISON, ComparedAnswerFile, ComparedNumberFile, ComparisonFile, DIFFER_BELOW,
    EstimateFile, JointTestFile, NumberFile, read_estimate,
};
use poinsot_telemetry::Origin;
use statistics::{Answers, Mean, pooled, test};
use std::collections::HashSet;
use std::path::PathBuf;

/// If independent results would agree this well with a smaller probability, they are assumed to share telemetry.
const TOO_GOOD: f64 = 1.0e-3;

/// Significant figures of a time in messages.
const DIGITS: i32 = 4;

/// Compares results of one vehicle: folders of `identify --out`, or their `estimate.json`; two or more.
///
/// # Errors
/// Fewer than two answers, files that cannot be read, or answers of different vehicles.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// use poinsot::compare::compare;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-compare-{}", std::process::id()));
/// // Two answers from records with other noise.
/// let second = simulate::simulate_trial(&case, &model, 1)?.table;
/// let other = identify_tables(model, vec![second], &Question::default())?;
/// let answers = vec![out.join("first"), out.join("second")];
/// write_estimate(&answers[0], &identified)?;
/// write_estimate(&answers[1], &other)?;
/// assert_eq!(compare(&answers)?.verdict, "agree");
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare(answers: &[PathBuf]) -> Result<ComparisonFile, Error> {
    let answers = answers.iter().map(|path| read_estimate(path));
    let answers = answers.collect::<Result<Vec<_>, _>>()?;
    compare_estimates(&answers)
}

/// Compares results in memory, each with its name.
///
/// # Errors
/// Fewer than two answers, or answers of different vehicles.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// use poinsot::compare::compare_estimates;
///
/// let second = simulate::simulate_trial(&case, &model, 1)?.table;
/// let other = identify_tables(model, vec![second], &Question::default())?;
/// let answers = [("a".into(), estimate_file(&identified)), ("b".into(), estimate_file(&other))];
/// let found = compare_estimates(&answers)?;
/// assert!(found.passes());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_estimates(answers: &[(PathBuf, EstimateFile)]) -> Result<ComparisonFile, Error> {
    let [(_, first), _, ..] = answers else {
        let (found, problem) = (answers.len(), "at least two answers are compared");
        let advice = "give two folders of identify --out";
        return Err(Error::usage("ANSWER", found, problem, advice));
    };
    let names = |e: &EstimateFile| e.bodies.keys().cloned().collect::<Vec<_>>().join(", ");
    let mut strange = answers
        .iter()
        .filter(|(_, e)| !e.bodies.keys().eq(first.bodies.keys()));
    if let Some((path, other)) = strange.next() {
        let (own, wanted) = (names(other), names(first));
        let problem = format!("its bodies are {own}, those of the first answer {wanted}");
        return Err(Error::report(path, problem, "give answers of one vehicle"));
    }
    let files: Vec<&EstimateFile> = answers.iter().map(|(_, file)| file).collect();
    let common = Answers::common(&files);
    let tests = tests(&common);
    let agreement = tests.first().map(|t| t.p);
    let differ = agreement.is_some_and(|p| p < DIFFER_BELOW);
    let verdict = match (tests.is_empty(), differ) {
        (true, _) => "not_comparable",
        (false, true) => "differ",
        (false, false) => "agree",
    };
    let means = if differ { None } else { pooled(&common) };
    let numbers = (0..common.names.len()).map(|k| {
        let mean = means.as_ref().map(|m| m[k]);
        (common.names[k].clone(), number(&common, k, mean))
    });
    let described = answers.iter().map(|(path, e)| ComparedAnswerFile {
        path: path.display().to_string(),
        method: e.method_in_words(),
        status: e.status.clone(),
    });
    Ok(ComparisonFile {
        schema: COMPARISON.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        model: first.model.clone(),
        verdict: verdict.to_owned(),
        answers: described.collect(),
        numbers: numbers.collect(),
        tests,
        not_compared: not_compared(&files, &common),
        doubts: doubts(&files, agreement),
    })
}

fn number(common: &Answers, k: usize, mean: Option<Mean>) -> ComparedNumberFile {
    let values: Vec<f64> = common.values.iter().map(|x| x[k]).collect();
    let sigmas = common.covariances.iter().map(|c| c[(k, k)].sqrt());
    let sigmas: Vec<f64> = sigmas.collect();
    let last = values.len() - 1;
    ComparedNumberFile {
        unit: common.units[k].clone(),
        difference: values[last] - values[0],
        difference_sigma: sigmas[0].hypot(sigmas[last]),
        p: test(common, &[k]).p,
        values,
        sigmas,
        pooled: mean.map(|m| m.value),
        pooled_sigma: mean.map(|m| m.sigma),
    }
}

/// Tests of all numbers together, and of the groups of each body.
fn tests(common: &Answers) -> Vec<JointTestFile> {
    let all: Vec<usize> = (0..common.names.len()).collect();
    if all.is_empty() {
        return Vec::new();
    }
    let mut groups = IndexMap::from([("all numbers".to_owned(), all)]);
    for (k, name) in common.names.iter().enumerate() {
        groups.entry(group(name)).or_default().push(k);
    }
    let of = |(what, members): (String, Vec<usize>)| JointTestFile {
        what,
        ..test(common, &members)
    };
    groups.into_iter().map(of).collect()
}

/// Group of an address: `bus.inertia_kg_m2.xy` belongs to the inertia of bus.
fn group(address: &str) -> String {
    let parts = Address::parse(address);
    let what = match parts.quantity() {
        "mass_kg" => "mass",
        "com_m" => "mass centre",
        "inertia_kg_m2" => "inertia",
        _ => return address.to_owned(),
    };
    format!("{what} of {}", parts.owner())
}

/// Numbers requested in some result but not determined in all, and known numbers with different values.
fn not_compared(files: &[&EstimateFile], common: &Answers) -> Vec<String> {
    let addressed = |file: &&EstimateFile| -> Vec<_> {
        let bodies = file.bodies.iter();
        bodies.flat_map(|(name, b)| b.addressed(name)).collect()
    };
    let all: Vec<Vec<_>> = files.iter().map(addressed).collect();
    let compared: HashSet<&str> = common.names.iter().map(String::as_str).collect();
    let first = all.first().into_iter().flatten().enumerate();
    let other = first.filter(|(_, (name, ..))| !compared.contains(name.as_str()));
    other
        .filter_map(|(k, (name, unit, _))| {
            let numbers: Vec<&NumberFile> = all.iter().map(|file| &file[k].2).collect();
            Some(format!("{name}: {}", why_not(&numbers, unit)?))
        })
        .collect()
}

/// Why a number is not compared; `None` if it is known and the same.
fn why_not(numbers: &[&NumberFile], unit: &str) -> Option<String> {
    if numbers.iter().all(|n| n.is_known()) {
        let values = numbers.iter().filter_map(|n| n.value);
        let values: Vec<String> = values.map(|x| x.to_string()).collect();
        let differ = numbers.iter().any(|n| n.value != numbers[0].value);
        let values = values.join(", ");
        return differ.then(|| format!("given as known with different values ({values} {unit})"));
    }
    let open = (1..).zip(numbers).filter(|(_, n)| n.value.is_none());
    let open: Vec<String> = open.map(|(i, _)| i32::to_string(&i)).collect();
    Some(match open.is_empty() {
        true => "known in one answer and estimated in another".to_owned(),
        false => format!("undetermined in answer {}", open.join(", ")),
    })
}

/// Why two records are assumed to overlap in time.
#[derive(Clone, Copy, PartialEq)]
enum Shared {
    /// Both have the same content.
    Content,
    /// Both have dates.
    Dates,
    /// Neither has a date, and they start at different counts: they may have a common clock.
    Counts,
}

/// The longest time shared by a record of each result. Records without a date and with equal first counts are no
/// evidence, because counts often restart with every record.
fn overlap(one: &EstimateFile, other: &EstimateFile) -> Option<(f64, Shared)> {
    let origin = |file: &EstimateFile| {
        let epoch = file.epoch.as_ref()?;
        Origin::of_date(epoch.at.as_deref()?, epoch.scale.as_deref()?)
    };
    let count = |file: &EstimateFile| file.epoch.as_ref().and_then(|e| e.own_count_s);
    let dated = origin(one).zip(origin(other)).map(|(a, b)| a.until(&b));
    let counted = || Some(count(other)? - count(one)?);
    let shift = dated.or_else(counted);
    let pairs = one.inputs.iter();
    let pairs = pairs.flat_map(|a| other.inputs.iter().map(move |b| (a, b)));
    pairs
        .filter_map(|(a, b)| {
            let same = a.sha256 == b.sha256;
            // If one of two equal files has no date, the times cannot be compared, only the durations.
            let unknown = same.then(|| a.time_s[0] - b.time_s[0]);
            let [from, to] = b.time_s.map(|t| Some(t + shift.or(unknown)?));
            let (from, to) = (from?, to?);
            let why = match (same, dated) {
                (true, _) => Shared::Content,
                (false, Some(_)) => Shared::Dates,
                (false, None) if from != a.time_s[0] => Shared::Counts,
                (false, None) => return None,
            };
            let seconds = a.time_s[1].min(to) - a.time_s[0].max(from);
            (seconds > 0.0).then_some((seconds, why))
        })
        .max_by(|x, y| x.0.total_cmp(&y.0))
}

/// Why the results are not independent or not reliable.
fn doubts(files: &[&EstimateFile], agreement: Option<f64>) -> Vec<String> {
    let mut out = Vec::new();
    for (i, file) in (1..).zip(files) {
        if let Some(doubt) = file.evidence_against().first() {
            out.push(format!("answer {i} is not reliable: {doubt}"));
        } else if !file.covariance_trustworthy {
            out.push(format!("the covariance of answer {i} is not trustworthy"));
        }
        let unchecked = file.unchecked().into_iter();
        out.extend(unchecked.map(|why| format!("answer {i} is {why}")));
    }
    let before = out.len();
    for (j, file) in (1..).zip(files) {
        for (i, earlier) in (1..j).zip(files) {
            let Some((seconds, shared)) = overlap(earlier, file) else {
                continue;
            };
            let seconds = significant(seconds, DIGITS);
            let what = match shared {
                Shared::Content => {
                    format!("answers {i} and {j} use the same telemetry for {seconds} s")
                }
                Shared::Dates => {
                    format!("the telemetry of answers {i} and {j} overlaps by {seconds} s")
                }
                Shared::Counts => format!(
                    "the telemetry of answers {i} and {j} has no dates; with one clock it overlaps by {seconds} s (declare `epoch` in the map)"
                ),
            };
            out.push(format!("{what}: they are not independent, so differences are smaller than their stated sigma"));
        }
    }
    if agreement.is_some_and(|p| p > 1.0 - TOO_GOOD) && out.len() == before {
        let what = "the answers agree better than independent answers: they may share a record";
        out.push(what.to_owned());
    }
    let uses_prior = |f: &&EstimateFile| {
        let mut numbers = f.bodies.values().flat_map(|b| b.numbers());
        numbers.any(|(_, _, n)| n.source.as_deref() == Some("prior"))
    };
    if files.iter().filter(|f| uses_prior(f)).count() > 1 {
        let what = "more than one answer uses a prior: a shared prior is counted in each answer";
        out.push(what.to_owned());
    }
    out
}
