//! The page: self-contained, safe against hostile names, consistent with the fit.

use crate::shared::identified;
use poinsot::report::report_data;
use poinsot::simulate::simulate;
use poinsot::{EstimateFile, Identified, IdentifyRequest, estimate_file, identify};
use poinsot_formats::ReportData;
use poinsot_report::{Detail, estimate_document, report_html, result_page};
use scraper::{Html, Node, Selector};
use serde_json::Value;
use std::path::Path;

/// Size limit of the page of a shipped example, bytes.
const LIMIT: usize = 1_000_000;

fn ma2008() -> Identified {
    identified(
        "ma2008/model_noisy.toml",
        &["ma2008/traj1/telemetry_noisy.csv"],
        "auto",
    )
}

fn documents(identified: &Identified) -> (Value, ReportData) {
    let command = ["poinsot", "identify", "--out", "a b"].map(str::to_owned);
    let estimate = serde_json::to_value(estimate_file(identified)).unwrap();
    (estimate, report_data(identified, &command))
}

fn typed(estimate: &Value) -> EstimateFile {
    serde_json::from_value(estimate.clone()).unwrap()
}

fn page(identified: &Identified) -> String {
    let (estimate, data) = documents(identified);
    report_html(typed(&estimate), data).unwrap()
}

/// Elements with their attribute names, in order; a hostile text must not change them.
fn skeleton(html: &str) -> Vec<String> {
    Html::parse_document(html)
        .tree
        .nodes()
        .filter_map(|n| match n.value() {
            Node::Element(e) => {
                let mut names: Vec<&str> = e.attrs().map(|a| a.0).collect();
                names.sort_unstable();
                Some(format!("{} {}", e.name(), names.join(",")))
            }
            Node::Comment(_) => Some("comment".to_owned()),
            _ => None,
        })
        .collect()
}

/// Replaces every name and message by a text; equal names stay equal.
fn rename(value: &mut Value, from: &str, to: &str) {
    match value {
        Value::String(s) => *s = s.replace(from, to),
        Value::Array(all) => all.iter_mut().for_each(|v| rename(v, from, to)),
        Value::Object(map) => {
            let old = std::mem::take(map);
            for (key, mut v) in old {
                rename(&mut v, from, to);
                map.insert(key.replace(from, to), v);
            }
        }
        _ => {}
    }
}

/// The truth that `simulate` wrote is shown; one of another seed, a changed one and one of an earlier version are refused or marked.
#[test]
fn exact_a_truth_of_other_telemetry_is_not_shown() {
    let folder = tempfile::tempdir().unwrap();
    let doc = Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
    let written = simulate(&doc.join("case.toml"), &folder.path().join("a")).unwrap();
    let request = IdentifyRequest::new(doc.join("model.toml"), [written.telemetry]);
    let identified = identify(&request).unwrap();
    let shown = || {
        let data = report_data(&identified, &[]);
        (data.truth.is_some(), data.truth_note)
    };
    assert_eq!(shown(), (true, String::new()));
    let case = std::fs::read_to_string(doc.join("case.toml")).unwrap();
    let other = folder.path().join("case.toml");
    std::fs::copy(doc.join("model.toml"), folder.path().join("model.toml")).unwrap();
    std::fs::write(&other, case.replace("seed = 1", "seed = 2")).unwrap();
    let mixed = simulate(&other, &folder.path().join("b")).unwrap().truth;
    let text = std::fs::read_to_string(&mixed).unwrap();
    let from = text.find("  \"files\": {").unwrap();
    let to = from + text[from..].find("},\n").unwrap() + 3;
    let end = text.rfind(",\n  \"sha256\"").unwrap();
    let old = text[..from].replacen("truth/3", "truth/2", 1) + &text[to..end] + "\n}\n";
    for (text, is_shown, note) in [
        (
            text.clone(),
            false,
            "truth.json beside the telemetry is not used: it is that of another telemetry.csv",
        ),
        (
            text.replacen('4', "5", 1),
            false,
            "checksum (sha256) is not that of its content",
        ),
        (
            old,
            true,
            "Unchecked: truth.json does not name its telemetry",
        ),
    ] {
        std::fs::write(&written.truth, text).unwrap();
        let found = shown();
        assert!(found.0 == is_shown && found.1.contains(note), "{found:?}");
        let page = page(&identified);
        assert!(page.contains(note), "{note}");
    }
}

#[test]
fn exact_the_page_of_a_file_without_checksum_says_so() {
    let doc = Path::new(env!("CARGO_MANIFEST_DIR")).join("../poinsot-report/doc");
    let text = std::fs::read_to_string(doc.join("campaign.json")).unwrap();
    let end = text
        .rfind(",\n  \"sha256\"")
        .unwrap_or(text.trim_end().len() - 1);
    let old = text[..end].replacen("campaign/2", "campaign/1", 1) + "}";
    let page = result_page(&doc.join("campaign.json"), old.as_bytes(), |_| None).unwrap();
    let note = "Unchecked: poinsot.campaign/1 has no checksum. ";
    assert!(page.subtitle.starts_with(note), "{}", page.subtitle);
}

#[test]
fn unit_hostile_names_change_no_element() {
    let identified = ma2008();
    let (mut estimate, data) = documents(&identified);
    let mut data = serde_json::to_value(data).unwrap();
    estimate["warnings"] = serde_json::json!(["link1 looks odd"]);
    estimate["repairs"] = serde_json::json!(["link1 was taken as locked"]);
    estimate["ignored_columns"] = serde_json::json!(["link1", "acc_x"]);
    estimate["model"] = "link1".into();
    estimate["fit"][0]["segment"] = "link1".into();
    data["segments"][0]["label"] = "link1".into();
    data["command"] = serde_json::json!(["poinsot", "link1"]);
    let read = |v: &Value| serde_json::from_value::<ReportData>(v.clone()).unwrap();
    let tame = report_html(typed(&estimate), read(&data)).unwrap();
    for hostile in [
        "<script>alert(1)</script>",
        "</script><script>alert(1)</script>",
        "--><img src=x onerror=alert(1)>",
        "\" onload=\"alert(1)\" x=\"",
        "' onclick='alert(1)",
        "</style></svg></td></table><h1>",
        "{{ 7 * 7 }}{% include 'x' %}",
        "\u{2028}\u{2029}\u{202e}\0<!--",
        "javascript:alert(1)",
        "&lt;b&gt;",
    ] {
        let (mut e, mut d) = (estimate.clone(), data.clone());
        rename(&mut e, "link1", hostile);
        rename(&mut d, "link1", hostile);
        let wild = report_html(typed(&e), read(&d)).unwrap();
        assert!(
            skeleton(&tame) == skeleton(&wild),
            "{hostile:?} changed the page"
        );
        assert!(!wild.contains("49{%"));
    }
}

/// The next action says what helps, not what is wrong once more.
#[test]
fn unit_a_fit_that_does_not_converge_repeats_no_warning_as_what_to_do() {
    let (mut estimate, _) = documents(&ma2008());
    let warning = "the covariance is not trustworthy: the iteration did not converge";
    estimate["status"] = "iteration_limit".into();
    estimate["warnings"] = serde_json::json!([warning]);
    let text = estimate_document(&typed(&estimate), Detail::Answer).to_string();
    assert_eq!(text.matches(&warning[1..]).count(), 1, "{text}");
}

#[test]
fn unit_page_is_complete_and_names_no_address() {
    let html = page(&ma2008());
    assert!(html.len() < LIMIT, "{} bytes", html.len());
    let document = Html::parse_document(&html);
    for selector in [
        "[src]",
        "link",
        "iframe",
        "object",
        "embed",
        "form",
        "base",
        "[style]",
        "[onclick]",
        "img",
    ] {
        let found = document.select(&Selector::parse(selector).unwrap()).count();
        assert_eq!(found, 0, "{selector}");
    }
    for a in document.select(&Selector::parse("a").unwrap()) {
        assert!(a.attr("href").unwrap().starts_with('#'));
    }
    // The licence of what the page holds of others.
    for words in [
        "Copyright (c) 2022 Leon Sorokin",
        "THE SOFTWARE IS PROVIDED \"AS IS\"",
    ] {
        assert!(html.contains(words), "{words}");
    }
    let mut rest = html.clone();
    // An XML namespace and uPlot's home page, never fetched.
    rest = rest.replace("http://www.w3.org/2000/svg", "");
    rest = rest.replace("/*! https://github.com/leeoniya/uPlot (v1.6.32) */", "");
    for word in [
        "http:",
        "https:",
        "//cdn",
        "@import",
        "url(",
        "fetch(",
        "XMLHttpRequest",
    ] {
        assert!(!rest.contains(word), "{word}");
    }
}

#[test]
fn unit_policy_allows_what_is_there_and_nothing_else() {
    let html = page(&identified(
        "stsat3/model.toml",
        &["stsat3/paper/telemetry.parquet"],
        "auto",
    ));
    let document = Html::parse_document(&html);
    let meta = Selector::parse("meta[http-equiv]").unwrap();
    let policy = document
        .select(&meta)
        .next()
        .unwrap()
        .attr("content")
        .unwrap();
    assert!(policy.starts_with("default-src 'none';"));
    assert!(!policy.contains("unsafe"));
    let count = |s: &str| document.select(&Selector::parse(s).unwrap()).count();
    assert_eq!(
        policy.matches("'sha256-").count(),
        count("style") + count("script:not([type])")
    );
    let sections = [
        "answer",
        "motion",
        "open",
        "numbers",
        "trust",
        "flown",
        "known",
        "provenance",
    ];
    for section in sections {
        assert_eq!(count(&format!("section#{section} h2")), 1, "{section}");
    }
    assert_eq!(count("table"), count("table > caption"));
    assert_eq!(count("th"), count("th[scope]"));
}

#[test]
fn unit_every_plot_has_units_or_none_to_have() {
    let html = page(&ma2008());
    let document = Html::parse_document(&html);
    let axis = Selector::parse("text.axis").unwrap();
    let mut labels: Vec<String> = document.select(&axis).map(|t| t.text().collect()).collect();
    let data = Selector::parse("script.curves-data").unwrap();
    for island in document.select(&data) {
        let curves: Value = serde_json::from_str(&island.text().collect::<String>()).unwrap();
        for axis in ["x", "y"] {
            let [label, unit] = [0, 1].map(|k| curves[axis][k].as_str().unwrap());
            labels.push(match unit {
                "" => label.to_owned(),
                unit => format!("{label} [{unit}]"),
            });
        }
    }
    assert!(labels.len() > 15, "{labels:?}");
    for label in labels.iter().filter(|l| !l.contains('[')) {
        assert!(
            ["correlation", "step", "cost"].contains(&label.as_str()),
            "{label}"
        );
    }
}

/// At most twenty words including a number, equal in terminal and page.
#[test]
fn unit_the_answer_is_one_short_sentence_with_a_number() {
    let open = identified(
        "stsat3/model.toml",
        &["stsat3/paper/telemetry.parquet"],
        "auto",
    );
    for (identified, word) in [(ma2008(), "Determined"), (open, "Partly determined")] {
        let html = page(&identified);
        let document = Html::parse_document(&html);
        let text = |s: &str| -> String {
            let found = document.select(&Selector::parse(s).unwrap()).next();
            found.unwrap().text().collect()
        };
        let sentence = text("p.sentence");
        assert!(sentence.split(' ').count() <= 20, "{sentence}");
        assert!(
            sentence.contains(|c: char| c.is_ascii_digit()),
            "{sentence}"
        );
        assert_eq!(text("p.status"), word);
        assert!(
            !html.contains('\u{2212}'),
            "a minus sign that no sheet reads"
        );
    }
}

#[test]
fn unit_same_question_same_bytes() {
    assert!(page(&ma2008()) == page(&ma2008()));
}

#[test]
fn unit_files_of_different_runs_are_refused() {
    let (estimate, _) = documents(&ma2008());
    let other = identified(
        "stsat3/model.toml",
        &["stsat3/paper/telemetry.parquet"],
        "auto",
    );
    let why = report_html(typed(&estimate), documents(&other).1).unwrap_err();
    assert!(why.contains("different runs"), "{why}");
}

/// The curves against the fit, which computes its residuals separately.
#[test]
fn exact_curves_show_the_residual_that_was_fitted() {
    let identified = ma2008();
    let prediction = &identified.predictions[0];
    let fit = &identified.estimate.fit[0];
    for channel in &prediction.channels {
        let fitted = fit
            .channels
            .iter()
            .find(|c| c.name == channel.name)
            .unwrap();
        let all: Vec<f64> = channel.residual.iter().flatten().copied().collect();
        let rms = (all.iter().map(|r| r * r).sum::<f64>() / all.len() as f64).sqrt();
        // One of two samples is kept: 4000 numbers, so within a few times 1 / sqrt(2 * 4000).
        assert!(
            (rms / fitted.rms - 1.0).abs() < 0.04,
            "{}: {rms} {}",
            channel.name,
            fitted.rms
        );
        let counted: u64 = channel.histogram.iter().flatten().sum();
        assert_eq!(counted, 3 * channel.samples as u64, "{}", channel.name);
    }
    // Without torque the predicted momentum is constant.
    for row in &prediction.momentum.predicted {
        let worst = row.iter().map(|h| (h - row[0]).abs()).fold(0.0, f64::max);
        assert!(worst < 1.0e-6, "{worst}");
    }
}

#[test]
fn unit_many_segments_stay_small() {
    let runs =
        ["C1", "C2", "C3", "C4", "C5", "C6", "C7"].map(|c| format!("xu2017/{c}/telemetry.parquet"));
    let runs: Vec<&str> = runs.iter().map(String::as_str).collect();
    let html = page(&identified("xu2017/model.toml", &runs, "linear"));
    assert!(html.len() < LIMIT, "{} bytes", html.len());
}

/// The page knows findings by the names of the file.
#[test]
fn exact_the_page_names_findings_as_the_diagnosis_does() {
    use poinsot_identify::FaultKind;
    assert_eq!(poinsot_report::NOT_RIGID, FaultKind::NotRigid.name());
    let of_noise = [FaultKind::NoiseOverstated, FaultKind::NoiseUnderstated];
    assert_eq!(poinsot_report::OF_NOISE, of_noise.map(FaultKind::name));
}
