//! Counts in what a reader sees: at one, a noun has no plural.
#![allow(clippy::unwrap_used)]

use poinsot_figures::Document;
use poinsot_formats::{
    CampaignFile, ComparisonFile, DesignFile, PredictionFile, ValidationFile, read_estimate,
};
use poinsot_report::{
    Detail, campaign_document, campaign_page, comparison_document, design_document,
    design_sentence, estimate_document, estimate_lines, parse_report_data, prediction_document,
    report_html, several_document, validation_document,
};
use serde::de::DeserializeOwned;

fn read<T: DeserializeOwned>(text: &str) -> T {
    serde_json::from_str(text).unwrap()
}

/// A "1" before a word in the plural; singular words that end in `s` are few.
fn plurals_at_one(text: &str) -> Vec<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let bare = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric()).to_owned();
    let is_plural = |word: &str| {
        let letters = word.len() > 2 && word.chars().all(|c| c.is_ascii_lowercase());
        letters && word.ends_with('s') && !["is", "has", "was", "ms", "misses"].contains(&word)
    };
    let pairs = words
        .windows(2)
        .filter(|w| w[0].trim_start_matches('(') == "1");
    let wrong = pairs.filter(|w| is_plural(&bare(w[1])));
    wrong.map(|w| w.join(" ")).collect()
}

fn documents() -> Vec<String> {
    let mut campaign: CampaignFile = read(include_str!("../doc/campaign.json"));
    (campaign.trials, campaign.planned) = (1, 1);
    for method in campaign.cells.iter_mut().flat_map(|c| &mut c.methods) {
        method.trials = 1;
    }
    let mut design: DesignFile = read(include_str!("../doc/design.json"));
    design.search.evaluations = 1;
    let prediction: PredictionFile = read(include_str!("../doc/prediction.json"));
    let validation: ValidationFile = read(include_str!("../doc/validation.json"));
    let comparison: ComparisonFile = read(include_str!("../doc/comparison.json"));
    let doc = concat!(env!("CARGO_MANIFEST_DIR"), "/../poinsot-formats/doc");
    let (_, estimate) = read_estimate(doc.as_ref()).unwrap();
    let mut all: Vec<Document> = campaign_document(&campaign);
    all.extend([
        design_document(&design),
        prediction_document(&prediction),
        several_document(&[prediction]),
        validation_document(&validation),
        comparison_document(&comparison),
        estimate_document(&estimate, Detail::Everything),
    ]);
    let mut texts: Vec<String> = all.iter().map(Document::to_string).collect();
    texts.push(design_sentence(&design));
    texts.extend(estimate_lines(&estimate));
    texts.push(campaign_page(&campaign).unwrap().subtitle);
    texts
}

#[test]
fn prop_no_plural_stands_after_a_one() {
    assert_eq!(plurals_at_one("with 1 cells, 1 trial"), ["1 cells,"]);
    for text in documents() {
        assert_eq!(plurals_at_one(&text), [""; 0], "{text}");
    }
}

/// The rejected estimate with one finding, and the one with one number.
#[test]
fn prop_the_sentence_agrees_in_number() {
    let doc = concat!(env!("CARGO_MANIFEST_DIR"), "/../poinsot-formats/doc");
    let (_, mut estimate) = read_estimate(doc.as_ref()).unwrap();
    estimate.status = "rejected".to_owned();
    estimate.warnings = vec!["the wheel".to_owned()];
    estimate.fit.clear();
    let text = estimate_document(&estimate, Detail::Answer).verdict;
    assert!(text.contains("1 finding is inconsistent"), "{text}");
    estimate.warnings.push("the gyro".to_owned());
    let text = estimate_document(&estimate, Detail::Answer).verdict;
    assert!(text.contains("2 findings are inconsistent "), "{text}");
}

/// The page shows the correlation of every pair of estimates once, and the vehicle beside the ellipsoid.
#[test]
fn exact_the_page_has_every_correlation_once() {
    let doc = concat!(env!("CARGO_MANIFEST_DIR"), "/../poinsot-formats/doc");
    let (_, estimate) = read_estimate(doc.as_ref()).unwrap();
    let data = parse_report_data(include_bytes!("../doc/report_data.json")).unwrap();
    let n = estimate.covariance.names.len();
    let html = report_html(estimate, data).unwrap();
    let cells = html.matches("class=\"spot cell ").count();
    assert_eq!(cells, n * (n - 1) / 2);
    assert!(html.contains("\"boxed\":true"));
}
