//! A prediction as text: one sentence, then the numbers.

use crate::estimate::{WHOLE, body_title, open_sentences, sensitivities};
use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_formats::{
    KnownNumbersFile, MassFile, PredictedNumberFile, PredictionFile, SensitivityFile, WantedFile,
};

type Body = MassFile<PredictedNumberFile>;

/// How well a known number may be measured, of its value.
const MEASURED: f64 = 0.01;

/// The prediction as a document.
///
/// ```
/// use poinsot_formats::PredictionFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/prediction.json"));
/// let prediction: PredictionFile = serde_json::from_str(text)?;
/// let document = poinsot_report::prediction_document(&prediction);
/// assert!(document.verdict.contains("box"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prediction_document(prediction: &PredictionFile) -> Document {
    document(prediction, false)
}

/// The document for the terminal, or for the page: with the peaks of the motion, without undetermined numbers.
pub(crate) fn document(p: &PredictionFile, page: bool) -> Document {
    let enough = match p.wants.is_empty() {
        true => p.status == "converged",
        false => p.wants.iter().all(|w| w.met),
    };
    let bodies = p.bodies.iter().map(|(name, b)| (body_title(name), b));
    let whole = p.system.iter().map(|b| (WHOLE.to_owned(), b));
    let shown = bodies.chain(whole).filter(|(_, b)| is_shown(b));
    let shown = shown.map(|(title, b)| context! { title, numbers => b.numbers() });
    let known = p.known_numbers.as_ref();
    let sensitive = known.map(|known| sensitivities(known, &p.covariance));
    let missed = p.wants.iter().filter(|w| !w.met);
    let limited = missed.filter_map(|w| limited(w, known?));
    let context = context! {
        page, sensitive,
        limited => limited.collect::<Vec<Value>>(),
        shown => shown.collect::<Vec<Value>>(),
        open => open_sentences(&p.identifiability.not_identifiable),
        ..Value::from_serialize(p)
    };
    let tone = if enough { Tone::Good } else { Tone::Fair };
    TEMPLATES.document("prediction.txt", context).toned(tone)
}

/// What a wanted sigma owes to the known numbers, where the data alone reach it: the one that has the largest share, and
/// the sigma with that one measured to 1 %.
fn limited(want: &WantedFile, known: &KnownNumbersFile) -> Option<Value> {
    let sigma = want.sigma?;
    let data = known.sigma_data.get(&want.name)?;
    let share = |s: &SensitivityFile| s.variance_share.get(&want.name).copied().unwrap_or(0.0);
    let all = known.sensitivities.iter().map(|s| (s, share(s)));
    let (largest, share) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let better = (MEASURED * largest.value.abs() / largest.sigma).min(1.0);
    let then = sigma * (1.0 - share * (1.0 - better * better)).max(0.0).sqrt();
    let words = context! { name => want.name, data, number => largest.number, share, then };
    Some(words).filter(|_| *data <= want.wanted_sigma)
}

/// Whether any single number of a body will be determined.
pub(crate) fn is_shown(body: &Body) -> bool {
    body.numbers()
        .iter()
        .any(|n| predicted_sigma(&n.2).is_some())
}

pub(crate) fn predicted_sigma(n: &PredictedNumberFile) -> Option<f64> {
    n.sigma.filter(|_| n.source.is_some() && !n.is_known())
}

/// "2 min of this manoeuvre: bus mass to 0.1 %, mass centre to 4 mm, Ixx to 0.3 %, ...; Ixy not identifiable."
///
/// ```
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/prediction.json"));
/// let prediction: poinsot_formats::PredictionFile = serde_json::from_str(text)?;
/// assert_eq!(poinsot_report::prediction_sentence(&prediction), prediction.in_words);
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn prediction_sentence(prediction: &PredictionFile) -> String {
    let bodies = prediction.bodies.iter();
    let bodies = bodies.map(|(name, b)| (name.as_str(), b));
    let (mut shown, silent): (Vec<_>, Vec<_>) = bodies.partition(|b| is_shown(b.1));
    let whole = prediction.system.iter();
    let whole = whole.filter(|b| !silent.is_empty() && is_shown(b));
    shown.extend(whole.map(|b| ("system", b)));
    let context = context! {
        shown,
        silent => silent.iter().map(|b| b.0).collect::<Vec<_>>(),
        duration => duration(prediction.duration_s),
        ..Value::from_serialize(prediction)
    };
    TEMPLATES.lines("prediction_sentence.txt", context).concat()
}

/// A duration without unnecessary decimals.
fn duration(s: f64) -> String {
    let (value, unit) = if s < 120.0 {
        (s, "s")
    } else {
        (s / 60.0, "min")
    };
    format!("{} {unit}", (100.0 * value).round() / 100.0)
}
