//! Consistency of a result file, beyond its schema.

use crate::body::BodyFile;
use crate::estimate::EstimateFile;
use crate::number::NumberFile;
use poinsot_files::{Fault, Place};

/// Valid values of the status of a result.
const STATUS: [&str; 5] = [
    "converged",
    "partial",
    "not_identifiable",
    "iteration_limit",
    "rejected",
];
/// Valid effects of a test on the answer.
const EFFECTS: [&str; 6] = [
    "none",
    "widens_sigmas",
    "makes_partial",
    "against_answer",
    "withholds_numbers",
    "rejects_model",
];
/// Valid values of the source of a number.
const SOURCES: [&str; 3] = ["data", "prior", "known"];
/// Largest number; its square is finite.
const LARGEST: f64 = 1.0e100;
/// Relative tolerance for two numbers that must be equal; they are written with all digits.
const SAME: f64 = 1.0e-9;

/// A fault of a file whose parts contradict each other, without the name of the file.
pub(crate) fn contradiction(key: &str, value: String, problem: &str) -> Fault {
    let advice = "write the file again with `poinsot identify --out DIR`";
    Fault::new("E0604", Place::default().key(key), problem, advice).with_value(value)
}

/// Contradictions in a result; empty if consistent.
///
/// ```
#[doc = include_str!("../doc/estimate.txt")]
/// assert!(contradictions(&estimate).is_empty());
/// estimate.status = "finished".to_owned();
/// assert_eq!(contradictions(&estimate)[0].place.key, "status");
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn contradictions(file: &EstimateFile) -> Vec<Fault> {
    let mut found = Vec::new();
    let mut say = |key: String, value: String, problem: &str| {
        found.push(contradiction(&key, value, problem));
    };
    if !STATUS.contains(&file.status.as_str()) {
        let words = STATUS.join(", ");
        let problem = format!("the status is none of {words}");
        say("status".to_owned(), quoted(&file.status), &problem);
    }
    for (name, number) in &file.nuisance {
        size(&format!("nuisance.{name}"), number, &mut say);
    }
    for (name, body) in &file.bodies {
        numbers(name, body, &mut say);
        moments(&format!("bodies.{name}"), body, &mut say);
    }
    covariance(file, &mut say);
    evidence(file, &mut say);
    let ranks = &file.identifiability;
    if ranks.rank > ranks.parameters {
        let key = "identifiability.rank".to_owned();
        let problem = format!("there are {} unknown mass properties", ranks.parameters);
        say(key, ranks.rank.to_string(), &problem);
    }
    found
}

/// Status, reliability and `doubts` follow from the rows of the evidence. Earlier versions wrote no rows.
fn evidence(file: &EstimateFile, say: &mut impl FnMut(String, String, &str)) {
    let rows = &file.evidence;
    for (k, row) in rows.iter().enumerate() {
        if !EFFECTS.contains(&row.effect.as_str()) {
            let problem = format!("the effect is none of {}", EFFECTS.join(", "));
            let key = format!("evidence[{k}].effect");
            say(key, quoted(&row.effect), &problem);
        }
        if let Some(p) = row.p.filter(|p| !(0.0..=1.0).contains(p)) {
            let key = format!("evidence[{k}].p");
            say(key, p.to_string(), "a p-value is from 0 to 1");
        }
    }
    if rows.is_empty() {
        return;
    }
    if file.doubts != file.evidence_against() {
        let problem = "they are not the words of the rows of evidence against the answer";
        say("doubts".to_owned(), format!("{:?}", file.doubts), problem);
    }
    let any = |effect: &str| rows.iter().any(|row| row.effect == effect);
    let status = match (any("rejects_model"), any("withholds_numbers")) {
        (true, _) => Some("rejected"),
        (false, true) => Some("iteration_limit"),
        (false, false) => None,
    };
    let own = Some(file.status.as_str()).filter(|_| file.is_withheld());
    if own != status {
        let problem = "it does not follow from the effects of the rows of evidence";
        say("status".to_owned(), quoted(&file.status), problem);
    }
    if file.covariance_trustworthy && rows.iter().any(|row| row.is_against_answer()) {
        let key = "covariance_trustworthy".to_owned();
        let problem = "a row of evidence is against the answer";
        say(key, "true".to_owned(), problem);
    }
}

fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

fn text(x: Option<f64>) -> String {
    x.map_or("null".to_owned(), |x| x.to_string())
}

/// A number is of a size that some vehicle has, and its sigma is not negative.
fn size(key: &str, number: &NumberFile, say: &mut impl FnMut(String, String, &str)) {
    if number.sigma.is_some_and(|s| s < 0.0) {
        let key = format!("{key}.sigma");
        say(key, text(number.sigma), "a sigma is not negative");
    }
    let parts = [("value", number.value), ("sigma", number.sigma)];
    for (part, x) in parts.into_iter().chain([("nominal", Some(number.nominal))]) {
        if x.is_some_and(|x| x.abs() > LARGEST) {
            let key = format!("{key}.{part}");
            say(key, text(x), "no vehicle has such a number");
        }
    }
}

fn numbers(name: &str, body: &BodyFile, say: &mut impl FnMut(String, String, &str)) {
    for (address, _, number) in body.addressed(name) {
        let key = |end: &str| format!("bodies.{address}.{end}");
        size(&format!("bodies.{address}"), &number, say);
        let source = number.source.as_deref();
        if let Some(word) = source.filter(|s| !SOURCES.contains(s)) {
            let problem = "a source is data, prior or known";
            say(key("source"), quoted(word), problem);
        }
        if source.is_some() != number.value.is_some() {
            let problem = "a number has a value where it has a source, and only there";
            say(key("value"), text(number.value), problem);
        }
    }
    let mass = body.mass_kg.value;
    if let Some(mass) = mass.filter(|m| *m < 0.0) {
        let key = format!("bodies.{name}.mass_kg.value");
        say(key, mass.to_string(), "a mass is not negative");
    }
}

/// The sum of the principal moments equals the trace of the tensor, and they are in ascending order.
fn moments(key: &str, body: &BodyFile, say: &mut impl FnMut(String, String, &str)) {
    let Some(principal) = &body.principal else {
        return;
    };
    let [a, b, c] = principal.moments_kg_m2;
    let tensor = &body.inertia_kg_m2;
    let trace = [&tensor.xx, &tensor.yy, &tensor.zz].map(|n| n.value);
    let key = format!("{key}.principal.moments_kg_m2");
    let value = format!("[{a}, {b}, {c}]");
    if !(a <= b && b <= c) {
        say(key, value, "principal moments ascend");
    } else if let [Some(x), Some(y), Some(z)] = trace
        && (x + y + z - a - b - c).abs() > SAME * (x.abs() + y.abs() + z.abs())
    {
        let problem = "their sum is not the trace of inertia_kg_m2";
        say(key, value, problem);
    }
}

/// The matrix is square and symmetric, and its diagonal equals the squared sigmas of the bodies.
fn covariance(file: &EstimateFile, say: &mut impl FnMut(String, String, &str)) {
    let covariance = &file.covariance;
    let (names, matrix) = (&covariance.names, &covariance.matrix);
    let square = matrix.len() == names.len() && matrix.iter().all(|row| row.len() == names.len());
    if !square || covariance.units.len() != names.len() {
        let key = "covariance.matrix".to_owned();
        let rows = format!("{} rows", matrix.len());
        let problem = format!("{} names need as many rows, columns and units", names.len());
        return say(key, rows, &problem);
    }
    for (i, row) in matrix.iter().enumerate() {
        for (j, x) in row.iter().enumerate().take(i) {
            if *x != matrix[j][i] {
                let key = format!("covariance.matrix[{i}][{j}]");
                say(key, text(*x), "the matrix is not symmetric");
            }
        }
    }
    for (name, body) in &file.bodies {
        for (address, _, number) in body.addressed(name) {
            let at = names.iter().position(|n| *n == address);
            if let (Some(at), Some(sigma)) = (at, number.sigma)
                && let Some(variance) = matrix[at][at]
                && (variance - sigma * sigma).abs() > SAME * variance.abs().max(sigma * sigma)
            {
                let key = format!("covariance.matrix[{at}][{at}]");
                let problem = format!("it is not the square of the sigma of {address}");
                say(key, variance.to_string(), &problem);
            }
        }
    }
}
