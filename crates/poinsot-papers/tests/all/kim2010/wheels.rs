//! The method on user files: certificate first.

use super::shipped;
use poinsot::{Identified, IdentifyRequest, estimate_file};
use poinsot_report::{Detail, estimate_document};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn answer(model: &Path, telemetry: &Path, variant: &str) -> Result<Identified, poinsot::Error> {
    let mut request = IdentifyRequest::new(model, [telemetry]).by("kim2010");
    request.question.variant = Some(variant.to_owned());
    poinsot::identify(&request)
}

/// Exit code (0 passed, 1 not passed, 2 error), JSON and error text.
fn identify(model: &Path, telemetry: &Path, variant: &str) -> (u8, Value, String) {
    match answer(model, telemetry, variant) {
        Ok(found) => {
            let json = serde_json::to_value(estimate_file(&found)).unwrap();
            (u8::from(!found.passes()), json, String::new())
        }
        Err(error) => (2, Value::Null, error.to_string()),
    }
}

fn stsat3() -> PathBuf {
    shipped().join("stsat3/model.toml")
}

fn paper_noisy() -> PathBuf {
    shipped().join("stsat3/paper/telemetry_noisy.csv")
}

fn number(json: &Value, name: &str) -> f64 {
    let list = json["method_report"]["numbers"].as_array().unwrap();
    let found = list.iter().find(|n| n["name"] == name);
    found.unwrap_or_else(|| panic!("no {name}"))["value"]
        .as_f64()
        .unwrap()
}

/// A copy of the noisy file of the paper's slew with every row passed through `change`.
fn changed(
    folder: &Path,
    header: impl Fn(&str) -> String,
    change: impl Fn(&[&str], &mut [f64]),
) -> PathBuf {
    let source = std::fs::read_to_string(paper_noisy()).unwrap();
    let mut lines = source.lines();
    let head = lines.next().unwrap();
    let names: Vec<&str> = head.split(',').collect();
    let mut out = header(head) + "\n";
    for line in lines {
        let mut row: Vec<f64> = line
            .split(',')
            .map(|x| x.parse().unwrap_or(f64::NAN))
            .collect();
        change(&names, &mut row);
        let cells: Vec<String> = row
            .iter()
            .map(|x| {
                if x.is_nan() {
                    String::new()
                } else {
                    x.to_string()
                }
            })
            .collect();
        out += &(cells.join(",") + "\n");
    }
    let path = folder.join("telemetry.csv");
    std::fs::write(&path, out).unwrap();
    path
}

fn column(names: &[&str], name: &str) -> usize {
    names.iter().position(|n| *n == name).unwrap()
}

#[test]
fn unit_baselines_print_beside_a_certificate_of_three_of_six() {
    for variant in [
        "batch",
        "conventional",
        "pre-estimate",
        "suggested",
        "iterated",
    ] {
        let (code, json, _) = identify(&stsat3(), &paper_noisy(), variant);
        assert_eq!(code, 1, "{variant}");
        assert_eq!(json["status"], "partial");
        assert_eq!(json["method"], "kim2010");
        assert_eq!(json["variant"], variant);
        assert_eq!(json["identifiability"]["rank"], 3);
        for element in ["xx", "yy", "zz", "xy", "xz", "yz"] {
            let value = &json["bodies"]["spacecraft"]["inertia_kg_m2"][element]["value"];
            assert!(value.is_null(), "{variant} {element}");
        }
        assert!(number(&json, "inertia_xx") > 1.0);
        let note = json["method_report"]["note"].as_str().unwrap();
        assert!(
            note.contains("no answer") && note.contains("3 of 6"),
            "{note}"
        );
    }
    let found = answer(&stsat3(), &paper_noisy(), "suggested").unwrap();
    let screen = estimate_document(&estimate_file(&found), Detail::Answer).to_string();
    let certificate = screen.find("not identifiable from these data").unwrap();
    assert!(
        certificate
            < screen
                .find("results of method kim2010 in its own terms")
                .unwrap()
    );
}

/// Basilisk's noise-free run: the diagonals are the row sums, the suggested products zero.
#[test]
fn xval_basilisk_paper_run_gives_the_row_sums() {
    let data = shipped().join("stsat3/paper/telemetry.parquet");
    let (code, json, _) = identify(&stsat3(), &data, "suggested");
    assert_eq!(code, 1);
    for (name, wanted) in [
        ("inertia_xx", 14.150),
        ("inertia_yy", 17.520),
        ("inertia_zz", 20.730),
    ] {
        assert!((number(&json, name) - wanted).abs() < 5e-4, "{name}");
    }
    for name in ["inertia_xy", "inertia_yz", "inertia_xz"] {
        assert!(
            number(&json, name).abs() < 1e-6,
            "{name} {}",
            number(&json, name)
        );
    }
}

/// Basilisk's six slews with spinning wheels: batch and iteration reach the true values. The paper's approximations do
/// not, and their sigma and exit code show it.
#[test]
fn xval_basilisk_rich_run_of_every_variant() {
    let data = shipped().join("stsat3/multiaxis/telemetry.parquet");
    let wanted = [
        ("xx", 13.916),
        ("yy", 16.954),
        ("zz", 19.894),
        ("xy", 0.085),
        ("xz", 0.133),
        ("yz", 0.5896),
    ];
    for (variant, exact) in [
        ("batch", true),
        ("iterated", true),
        ("conventional", false),
        ("pre-estimate", false),
        ("suggested", false),
    ] {
        let (code, json, _) = identify(&stsat3(), &data, variant);
        assert_eq!(code, u8::from(!exact), "{variant}");
        let inertia = &json["bodies"]["spacecraft"]["inertia_kg_m2"];
        let apart = wanted.map(|(name, value)| {
            let number = |key: &str| inertia[name][key].as_f64().unwrap();
            let error = (number("value") - value).abs();
            assert!(error <= number("sigma"), "{variant} {name} {error}");
            error
        });
        let worst = apart.into_iter().fold(0.0, f64::max);
        assert!(if exact { worst < 1e-8 } else { worst > 0.1 }, "{variant}");
        let doubts = json["doubts"].as_array().unwrap();
        assert_eq!(doubts.is_empty(), exact, "{doubts:?}");
    }
}

#[test]
fn unit_a_flipped_wheel_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let data = changed(folder.path(), str::to_owned, |names, row| {
        row[column(names, "wheel2_rad_s")] *= -1.0;
    });
    let (code, json, _) = identify(&stsat3(), &data, "suggested");
    assert_eq!(code, 1);
    assert_eq!(json["status"], "rejected");
    assert!(json["bodies"]["spacecraft"]["inertia_kg_m2"]["yy"]["value"].is_null());
}

#[test]
fn unit_a_quaternion_in_the_wrong_order_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let data = changed(folder.path(), str::to_owned, |names, row| {
        let q = column(names, "q_x");
        row[q..q + 4].rotate_right(1);
    });
    let (code, json, error) = identify(&stsat3(), &data, "suggested");
    let said = error + &json.to_string();
    assert_ne!(code, 0);
    assert!(
        said.contains("scalar first") || said.contains("order"),
        "{code} {said}"
    );
}

#[test]
fn unit_what_the_method_cannot_do_is_refused() {
    let model = shipped().join("ma2008/model.toml");
    let data = shipped().join("ma2008/traj1/telemetry.parquet");
    let (code, _, error) = identify(&model, &data, "suggested");
    assert_eq!(code, 2);
    assert!(
        error.contains("E0425") && error.contains("bodies"),
        "{error}"
    );
    let (code, _, error) = identify(&stsat3(), &paper_noisy(), "swarm");
    assert_eq!(code, 2);
    assert!(
        error.contains("kim2010 has no such variant; use one of suggested, batch"),
        "{error}"
    );
}
