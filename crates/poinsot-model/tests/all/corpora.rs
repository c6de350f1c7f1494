//! Robots and XML files of other authors: loaded or rejected with the right error, and the defects of an independent
//! scan.

use poinsot_model::{parse_model, parse_urdf, read_urdf, write_model};
use poinsot_testkit::outside::outside;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn all_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// Names of the scan, with words of ours.
const NAMES: [(&str, &[&str]); 13] = [
    ("link without <inertial>", &["no <inertial>"]),
    ("violates triangle inequality", &["are not physical"]),
    ("placeholder identity inertia", &["a placeholder"]),
    ("joint refers to missing link", &["there is no link"]),
    (
        "duplicate link names",
        &["have this name", "without name", "E0109"],
    ),
    ("link with two parents (loop)", &["has two parents"]),
    (
        "root count != 1",
        &[
            "have no parent",
            "no link is the base",
            "form a loop",
            "has no link",
            "E0119",
        ],
    ),
    ("unexpanded xacro tags", &["E0121"]),
    ("mimic joint", &["mimics"]),
    ("XML not well-formed", &["E0120"]),
    ("singular inertia", &["principal moment is zero"]),
    ("all-zero inertia", &["zero in all elements"]),
    ("zero mass", &["the mass is zero"]),
];
const MORE: [(&str, &[&str]); 2] = [
    (
        "moving joint without <axis> (defaults to x)",
        &["no axis is given"],
    ),
    ("radius of gyration > 5 m", &[" m; are mass"]),
];

#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_real_robots_have_the_defects_of_the_scan() {
    let folder = outside("corpora/urdf_files_dataset");
    let text = std::fs::read_to_string(folder.join("defects_found.json")).unwrap();
    let scan: Value = serde_json::from_str(&text).unwrap();
    let base = folder.join("all");
    let files: Vec<PathBuf> = all_files(&base)
        .into_iter()
        .filter(|p| {
            p.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("urdf"))
        })
        .collect();
    assert_eq!(files.len(), 322);
    let name_of = |path: &Path| path.strip_prefix(&base).unwrap().display().to_string();
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    let (mut loaded, mut refused) = (0, 0);
    for path in &files {
        let start = Instant::now();
        let urdf = read_urdf(path);
        assert!(start.elapsed().as_secs_f64() < 1.0, "{}", path.display());
        match &urdf.model {
            Ok(model) => {
                loaded += 1;
                // A loaded model can be written and read again.
                parse_model(&write_model(model), "m.toml")
                    .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            }
            Err(error) => {
                refused += 1;
                let first = error.to_string();
                assert!(first.starts_with("E01"), "{first}");
            }
        }
        found.push((name_of(path), urdf.remarks));
    }
    println!("{loaded} loaded, {refused} refused");
    let mut wrong = String::new();
    for (name, words) in NAMES.iter().chain(&MORE) {
        let theirs: BTreeSet<String> = scan[name]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_str().unwrap().to_owned())
            .collect();
        let ours: BTreeSet<String> = found
            .iter()
            .filter(|(_, told)| told.iter().any(|t| words.iter().any(|w| t.contains(w))))
            .map(|(n, _)| n.clone())
            .collect();
        let more: Vec<_> = ours.difference(&theirs).collect();
        let less: Vec<_> = theirs.difference(&ours).collect();
        if !more.is_empty() || !less.is_empty() {
            wrong.push_str(&format!(
                "{name}: only here {more:?}; only in the scan {less:?}\n"
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(
        scan.as_object()
            .unwrap()
            .keys()
            .all(|k| NAMES.iter().chain(&MORE).any(|(n, _)| n == k))
    );
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn cli_xml_that_breaks_parsers_is_refused_in_time() {
    let folder = outside("corpora/xml_roxmltree");
    let mut files = 0;
    for path in all_files(&folder)
        .iter()
        .filter(|p| p.extension().is_some_and(|e| e == "xml"))
    {
        let Ok(text) = std::fs::read_to_string(path) else {
            continue;
        };
        let start = Instant::now();
        let urdf = parse_urdf(&text, "x.urdf");
        assert!(start.elapsed().as_secs_f64() < 1.0, "{}", path.display());
        assert!(urdf.model.is_err(), "{}", path.display());
        files += 1;
    }
    println!("{files} files");
    assert!(files > 80, "{files}");
}
