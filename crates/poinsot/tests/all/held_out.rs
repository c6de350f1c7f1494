//! The last part of every record against the prediction of a fit without it.

use crate::shared::{shipped, stsat3};
use poinsot::{Identified, IdentifyRequest, identify};
use poinsot_identify::HeldOut;
use std::path::Path;

fn identified(telemetry: &Path, time_s: Option<[f64; 2]>) -> Identified {
    let mut request = IdentifyRequest::new(shipped().join("stsat3/model.toml"), [telemetry]);
    request.reading.time_s = time_s;
    identify(&request).unwrap()
}

fn held_out(identified: &Identified) -> HeldOut {
    let found = identified.estimate.diagnostics.as_ref().unwrap();
    found.held_out.clone().unwrap()
}

fn chi2(identified: &Identified) -> f64 {
    identified.estimate.diagnostics.as_ref().unwrap().chi2
}

/// Reference: the kept rows are fitted again. The chi-square of all rows minus theirs is what the first-order
/// statistic must give. Measured: 1.3e-10 relative.
#[test]
fn exact_the_held_out_rows_cost_what_a_fit_without_them_saves() {
    let telemetry = stsat3().join("multiaxis/telemetry_noisy.csv");
    let text = std::fs::read_to_string(&telemetry).unwrap();
    let times: Vec<f64> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().parse().unwrap())
        .collect();
    let kept = (0.8 * times.len() as f64) as usize;
    let whole = identified(&telemetry, None);
    let beginning = identified(&telemetry, Some([times[0], times[kept - 1]]));
    let saved = chi2(&whole) - chi2(&beginning);
    let found = held_out(&whole);
    assert_eq!(found.numbers, 6 * (times.len() - kept));
    assert!(
        (found.chi2 / saved - 1.0).abs() < 1e-8,
        "{found:?}, {saved}"
    );
    assert!(found.p > 1e-3, "{found:?}");
}

/// A vehicle that changes before the record ends, represented by a change of gyro scale.
#[test]
fn stat_an_end_that_does_not_follow_from_the_beginning_is_not_predicted() {
    let text = std::fs::read_to_string(stsat3().join("multiaxis/telemetry_noisy.csv")).unwrap();
    let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let rows = text.lines().count() - 1;
    let mut out = head.join(",") + "\n";
    for (at, line) in text.lines().skip(1).enumerate() {
        let late = at > rows * 8 / 10;
        let cells = line.split(',').zip(&head).map(|(cell, name)| {
            match late && name.starts_with("omega") {
                true => (1.3 * cell.parse::<f64>().unwrap()).to_string(),
                false => cell.to_owned(),
            }
        });
        out += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    let folder = tempfile::tempdir().unwrap();
    let telemetry = folder.path().join("telemetry.csv");
    std::fs::write(&telemetry, out).unwrap();
    let found = held_out(&identified(&telemetry, None));
    assert!(found.p < 1e-6, "{found:?}");
}
