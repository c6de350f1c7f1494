//! An estimate as a terminal document.

use crate::checks::causes;
use crate::summary;
use crate::templates::TEMPLATES;
use crate::verdict::Standing;
use indexmap::IndexMap;
use minijinja::{Value, context};
use poinsot_figures::Document;
use poinsot_files::significant;
use poinsot_formats::{
    Address, BodyFile, CheckFile, CovarianceFile, DeterminedFile, EstimateFile, EvidenceFile,
    KnownNumbersFile, SensitivityFile, UndeterminedFile,
};

/// Detail of the printed result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detail {
    /// The summary.
    #[default]
    Answer,
    /// Also the fit and every check.
    Everything,
}

/// Title of the numbers of the whole vehicle.
pub(crate) const WHOLE: &str =
    "whole vehicle at the first sample (base axes, from the base origin)";

/// The result as a document: sentence, mass properties, undetermined numbers, failed checks, remedies. With full
/// detail also the fit and the passed checks.
///
/// ```
#[doc = include_str!("../doc/estimate.txt")]
/// use poinsot_report::{Detail, estimate_document};
///
/// let document = estimate_document(&estimate, Detail::Answer);
/// assert!(document.verdict.starts_with("box: Determined."));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate_document(e: &EstimateFile, detail: Detail) -> Document {
    let (tone, word) = Standing::of(e).display();
    let asked = e.bodies.iter().filter(|b| b.1.is_asked());
    let asked = asked.map(|(name, b)| body(body_title(name), b));
    let whole = e.system.first().filter(|_| e.bodies.len() > 1);
    let bodies = asked.chain(whole.map(|w| body(WHOLE.to_owned(), &w.body)));
    let found = e.telemetry_checks.iter().filter(|f| f.count > 0);
    let line = |f: &CheckFile| format!("{} ({}): {}: {}", f.check, f.policy, f.channel, f.text);
    let determined = e.identifiability.identifiable.iter();
    let context = context! {
        word,
        found_modes => modes_found(e).map(|row| format!(" {}", row.words)),
        modes => modes(e),
        base => e.bodies.keys().next(),
        sentence => summary::sentence(e),
        action => summary::action(e),
        withheld => e.is_withheld(),
        everything => detail == Detail::Everything,
        bodies => bodies.collect::<Vec<_>>(),
        open => open_sentences(&e.identifiability.not_identifiable),
        determined => determined.filter(|c| !is_tabled(c)).collect::<Vec<_>>(),
        causes => causes(e),
        sensitive => sensitivities(&e.known_numbers, &e.covariance),
        found => found.map(line).collect::<Vec<_>>(),
        ..Value::from_serialize(e)
    };
    TEMPLATES.document("estimate.txt", context).toned(tone)
}

/// The row of modes that the data show although the model declares none.
pub(crate) fn modes_found(e: &EstimateFile) -> Option<&EvidenceFile> {
    e.evidence.iter().find(|row| row.test == "flexible modes")
}

/// Elements and values of each key of a mode.
type ModeKeys<'a> = IndexMap<&'a str, Vec<(&'a str, String)>>;

/// Keys of each mode that the data show, with their elements and values.
fn modes(e: &EstimateFile) -> Value {
    let mut modes: IndexMap<&str, ModeKeys> = IndexMap::new();
    for (address, number) in e.nuisance.iter().filter(|_| modes_found(e).is_some()) {
        let (parts, Some(value)) = (Address::parse(address), number.value) else {
            continue;
        };
        let keys = modes.entry(parts.owner()).or_default();
        let of = keys.entry(parts.quantity()).or_default();
        let element = parts.component().unwrap_or_default();
        of.push((element, figures_of(value, number.sigma)));
    }
    modes.retain(|_, keys| keys.contains_key("frequency_Hz"));
    Value::from_serialize(modes)
}

/// A number to a hundredth of its sigma.
fn figures_of(value: f64, sigma: Option<f64>) -> String {
    let size = |x: f64| x.abs().log10().floor() as i32;
    let figures = sigma.map_or(6, |s| size(value).saturating_sub(size(s)).saturating_add(2));
    significant(value, figures.clamp(1, 9))
}

/// Title of the numbers of a body.
pub(crate) fn body_title(name: &str) -> String {
    format!("{name} (inertia about its mass centre, tensor elements)")
}

fn body(title: String, body: &BodyFile) -> Value {
    let seen = body.barycentric.determined();
    let open = body.inertia_kg_m2.named().iter().any(|(_, n)| n.is_open());
    let note = match body.physically_consistent {
        Some(false) => "no distribution of positive mass has this tensor".to_owned(),
        _ if seen > 0 && open => format!(
            "{seen} of its 10 barycentric parameters about its frame origin are determined (see the result file)"
        ),
        _ => String::new(),
    };
    context! { title, note, numbers => body.numbers() }
}

/// One line per direction; those of one remedy together, with the remedy and the reason once below them.
pub(crate) fn open_sentences(open: &[UndeterminedFile]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut told: Vec<&str> = Vec::new();
    for alike in open.chunk_by(|a, b| a.reason == b.reason) {
        let mut groups: IndexMap<&str, Vec<&str>> = IndexMap::new();
        for item in alike {
            let group = groups.entry(&item.remedy).or_default();
            group.push(&item.combination);
        }
        for (remedy, combinations) in groups {
            lines.extend(combinations.into_iter().map(str::to_owned));
            // Several changes are told once: the list is long.
            let words = match remedy.split_once(':') {
                Some((together, _)) if told.contains(&remedy) => &format!("{together}, as above"),
                _ => remedy,
            };
            lines.push(format!("    to resolve it: {words}."));
            told.push(remedy);
        }
        lines.push(format!("    why: {}.", alike[0].reason));
    }
    lines
}

/// Whether a combination is a single number of the tables.
fn is_tabled(c: &DeterminedFile) -> bool {
    match c.coefficients.first() {
        Some((address, _)) if c.coefficients.len() == 1 => {
            ["mass_kg", "inertia_kg_m2"].contains(&Address::parse(address).quantity())
        }
        _ => false,
    }
}

/// Each known number with the result number that has its largest share of variance.
pub(crate) fn sensitivities(known: &KnownNumbersFile, covariance: &CovarianceFile) -> Vec<Value> {
    let row = |s: &SensitivityFile| {
        let (most, share) = s.most_sensitive()?;
        let unit = covariance.unit_of(most).unwrap_or_default();
        Some(context! {
            share,
            number => Address::parse(&s.number).without_unit(&s.unit),
            most => Address::parse(most).without_unit(unit),
            change => s.change.get(most).copied().unwrap_or(0.0),
            change_unit => unit,
            ..Value::from_serialize(s)
        })
    };
    known.sensitivities.iter().filter_map(row).collect()
}
