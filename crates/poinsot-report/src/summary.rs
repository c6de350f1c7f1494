//! The result in one sentence of at most twenty words, and the next action, for terminal and page.

use poinsot_files::{rounded, significant};
use poinsot_formats::{BodyFile, EstimateFile, HALF_WIDTH_95, NumberFile, UndeterminedFile};

/// Chi-square per degree of freedom above which it is given as the reason of a rejection.
const MISFIT: f64 = 1.2;

/// The result with its numbers.
pub(crate) fn sentence(e: &EstimateFile) -> String {
    let i = &e.identifiability;
    match e.status.as_str() {
        "converged" => determined(e),
        "partial" => format!(
            "{} of {} independent combinations are determined; {}.",
            i.rank,
            i.parameters,
            single(e)
        ),
        "not_identifiable" => format!(
            "None of the {} unknown mass properties is determined by these data.",
            i.parameters
        ),
        "rejected" => {
            let chi2 = largest_chi2(e);
            if chi2 > MISFIT {
                let times = rounded(chi2, 2);
                format!(
                    "The rigid model does not fit: chi-square is {times} times its expectation."
                )
            } else {
                format!(
                    "{} contradict the rigid model.",
                    counted(e.warnings.len(), "finding", "findings")
                )
            }
        }
        "iteration_limit" => "No fit of the whole record converged.".to_owned(),
        other => format!("Status {other}."),
    }
}

/// The next action; `None` if none is needed.
pub(crate) fn action(e: &EstimateFile) -> Option<String> {
    let first = |all: &[String]| all.first().cloned();
    let against = e.evidence_against();
    let found = match e.status.as_str() {
        "partial" | "not_identifiable" if against.is_empty() => {
            let open = &e.identifiability.not_identifiable;
            serves_most(open).map(|o| o.remedy.clone())
        }
        "rejected" => {
            let findings = e.diagnostics.iter().flat_map(|d| &d.findings);
            findings
                .map(|f| f.text.clone())
                .next()
                .or_else(|| first(&e.warnings))
                .map(|why| format!("correct the model or the telemetry: {why}"))
        }
        _ => (against.first()).map(|why| format!("explain the failed test first: {why}")),
    }?;
    let mut letters = found.trim().trim_end_matches('.').chars();
    let head = letters.next()?.to_uppercase();
    Some(format!("{head}{}.", letters.as_str()))
}

/// The direction whose remedy resolves most directions, the first if equal; numbers in brackets are ignored in the
/// comparison.
fn serves_most(open: &[UndeterminedFile]) -> Option<&UndeterminedFile> {
    let head = |o: &UndeterminedFile| o.remedy.split(" (").next().map(str::to_owned);
    let count = |o: &&UndeterminedFile| open.iter().filter(|p| head(p) == head(o)).count();
    open.iter().rev().max_by_key(count)
}

/// Largest chi-square per degree of freedom of a segment.
pub(crate) fn largest_chi2(e: &EstimateFile) -> f64 {
    let all = e.fit.iter().filter_map(|f| f.chi2_per_dof);
    all.fold(0.0, f64::max)
}

/// Requested numbers of one kind, with their widest 95 % half width.
struct Kind {
    count: usize,
    widest: Option<f64>,
}

impl Kind {
    fn of<'a>(bodies: impl Iterator<Item = &'a BodyFile>, places: std::ops::Range<usize>) -> Self {
        let asked: Vec<NumberFile> = bodies
            .flat_map(|b| {
                b.numbers().into_iter().map(|n| n.2).collect::<Vec<_>>()[places.clone()].to_vec()
            })
            .filter(|n| !n.is_known())
            .collect();
        let sigmas = asked.iter().map(|n| n.sigma.filter(|s| s.is_finite()));
        let widest = sigmas
            .collect::<Option<Vec<f64>>>()
            .and_then(|all| all.into_iter().reduce(f64::max));
        Self {
            count: asked.len(),
            widest: widest.map(|s| HALF_WIDTH_95 * s),
        }
    }
}

fn determined(e: &EstimateFile) -> String {
    let asked = || e.bodies.values().filter(|b| b.is_asked());
    let bodies = asked().count();
    let [mass, centre, inertia] = [0..1, 1..4, 4..10].map(|places| Kind::of(asked(), places));
    let all = mass.count + centre.count + inertia.count;
    let what = match (bodies, mass.count, centre.count, inertia.count) {
        (1, 0, 0, 6) => "All six inertia terms".to_owned(),
        (1, 1, 3, 6) => "All ten mass properties".to_owned(),
        (1, 0, 0, n) => counted(n, "inertia term", "inertia terms"),
        (1, ..) => format!("All {all} requested numbers"),
        _ => format!("All {all} requested numbers of {bodies} bodies"),
    };
    let kinds = [
        ("inertia", inertia, "kg m2"),
        ("mass centre", centre, "m"),
        ("mass", mass, "kg"),
    ];
    let width = kinds
        .into_iter()
        .find_map(|(name, kind, unit)| Some((name, kind.count, kind.widest?, unit)));
    let (verb, tail) = match e.evidence_against().is_empty() {
        true => ("are known", ""),
        false => ("are fitted", ", but a test failed"),
    };
    match width {
        Some((_, count, half, unit)) if count == all => {
            format!(
                "{what} {verb} to {} {unit} (95 %){tail}.",
                significant(half, 2)
            )
        }
        Some((name, _, half, unit)) => {
            format!(
                "{what} {verb}, {name} to {} {unit} (95 %){tail}.",
                significant(half, 2)
            )
        }
        None => format!("{what} are fitted; the method states no interval{tail}."),
    }
}

/// Number of requested numbers that are determined individually.
fn single(e: &EstimateFile) -> String {
    let asked: Vec<NumberFile> = e
        .bodies
        .values()
        .flat_map(BodyFile::numbers)
        .map(|n| n.2)
        .filter(|n| !n.is_known())
        .collect();
    match asked.iter().filter(|n| n.value.is_some()).count() {
        0 => "no single number is".to_owned(),
        n => format!("{n} of {} single numbers are", asked.len()),
    }
}

pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
