//! Pages as a forge shows them: numbers of the README are those of their tables, nothing is included, links lead to tracked files.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of the repository, its words separated by single blanks.
fn words(name: &str) -> String {
    let text = fs::read_to_string(root().join(name)).unwrap();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Cells of the rows of tables of a page.
fn rows(name: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join(name)).unwrap();
    let rows = text.lines().filter(|line| line.starts_with('|'));
    let cells = |line: &str| {
        line.split('|')
            .map(|cell| cell.trim().to_owned())
            .collect::<Vec<_>>()
    };
    rows.map(|line| cells(line.trim_matches('|'))).collect()
}

/// The cells of a column, in the rows whose first cell is given.
fn column(rows: &[Vec<String>], names: &[&str], at: usize) -> Vec<f64> {
    let cell = |name: &&str| {
        let row = rows.iter().find(|row| row[0] == *name).unwrap();
        row[at].trim_end_matches(" %").parse().unwrap()
    };
    names.iter().map(cell).collect()
}

/// "0.8, 0.9, 1.3 and 3.3 %", by size.
fn list(mut percent: Vec<f64>) -> String {
    percent.sort_by(f64::total_cmp);
    let [a, b, c, d]: [f64; 4] = percent.try_into().unwrap();
    format!("{a:.1}, {b:.1}, {c:.1} and {d:.1} %")
}

/// Sentences of the README with the numbers that its tables have.
fn sentences() -> Vec<String> {
    // RMSE over bound and coverage of the mass properties, in the results of the campaigns.
    let experiments = [
        "ma_traj1",
        "ma_traj2",
        "stsat3_multiaxis",
        "tug_thrusters",
        "xu_target",
    ];
    let (mut rmse, mut coverage) = (Vec::new(), Vec::new());
    for name in experiments {
        let text = fs::read_to_string(root().join(format!("validation/campaign/{name}.json")));
        let result: serde_json::Value = serde_json::from_str(&text.unwrap()).unwrap();
        assert_eq!(result["trials"], 10_000, "{name}");
        let numbers = &result["cells"][0]["methods"][0]["numbers"];
        for number in numbers.as_object().unwrap().values() {
            rmse.push(number["rmse_over_bound"]["value"].as_f64().unwrap());
            coverage.push(100.0 * number["coverage_all"]["value"].as_f64().unwrap());
        }
    }
    let least = |all: &[f64]| all.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    let throws = rows("data/tudelft_throw/README.md");
    // The second table, by maximum likelihood.
    let first = throws.iter().rposition(|row| row[0] == "object").unwrap();
    let objects = [
        "config_empty",
        "config_a",
        "config_b, never tuned on",
        "config_c, never tuned on",
    ];
    let faults = rows("docs/validation/faults.md");
    let named = |row: &&Vec<String>| row.len() == 4 && row[1..] == ["100", "100", "100"];
    assert_eq!(faults.iter().filter(named).count(), 15, "kinds of fault");
    let arm = rows("docs/methods/xu2017/tables.md");
    let arm = arm.iter().find(|row| row[0] == "combinations determined");
    let truth = fs::read_to_string(root().join("data/stsat3/multiaxis/truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
    let [xx, yy, zz] =
        ["xx", "yy", "zz"].map(|k| &truth["bodies"]["spacecraft"]["inertia_kg_m2"]["value"][k]);
    let known = rows("docs/reference/interface.md");
    let known = column(&known, &["spin inertia of a wheel"], 1);
    let trees = fs::read_to_string(root().join("validation/trees/trees.jsonl")).unwrap();
    let trees = trees.lines().count();
    let manifest = words("Cargo.toml");
    let (_, rust) = manifest.split_once("rust-version = \"").unwrap();
    // Sigmas of the answer with exactly known wheels, the first table of the first fit.
    let fit = words("docs/tutorial/first_fit.md");
    let sigma = ["I_xx", "I_yy", "I_zz", "I_xy", "I_xz", "I_yz"].map(|name| {
        let (_, row) = fit.split_once(&format!("{name} ")).unwrap();
        row.split(' ').nth(1).unwrap().parse::<f64>().unwrap()
    });
    let sigma = most(&sigma);
    vec![
        format!(
            "10,000 simulated trials of each of five experiments: RMSE {:.2} to {:.2} times the Cramer-Rao bound, {:.1} to {:.1} % of the 95 % intervals contain the truth",
            least(&rmse),
            most(&rmse),
            least(&coverage),
            most(&coverage)
        ),
        format!(
            "moments {} on four objects; by the authors' measure {}. They publish {} %.",
            list(column(&throws[first..], &objects, 2)),
            list(column(&throws[first..], &objects, 4)),
            column(&throws[..first], &["published (mean)"], 2)[0]
        ),
        "Fifteen kinds of sensor and model fault, each [named](docs/validation/faults.md) in 100 of 100 trials".to_owned(),
        format!("at most {} combinations are identifiable", arm.unwrap()[1]),
        format!("The simulated truth is {xx}, {yy} and {zz} kg m2"),
        format!("sigma is at most [{sigma:.5} kg m2]"),
        format!("The spin inertias of the wheels, known to {} %", known[0]),
        format!("with Rust {} or newer", &rust[..4]),
        format!("Momentum of {},{:03} random trees", trees / 1000, trees % 1000),
    ]
}

#[test]
fn prop_readme_numbers_are_those_of_their_tables() {
    let page = words("README.md");
    for sentence in sentences() {
        assert!(page.contains(&sentence), "README.md lacks: {sentence}");
    }
    assert!(page.split(' ').count() <= 700);
}

/// Prose of a page: without blocks of code, and without code within a line.
fn prose(text: &str) -> String {
    let blocks = text.split("```").step_by(2).collect::<String>();
    let lines = blocks.lines().filter(|line| !line.starts_with("    "));
    lines
        .flat_map(|line| line.split('`').step_by(2).chain(["\n"]))
        .collect()
}

/// Targets of links and pictures within the repository.
fn targets(prose: &str) -> Vec<&str> {
    let ends = [("](", ')'), ("src=\"", '"'), ("href=\"", '"')];
    let found = ends.iter().flat_map(|(begin, end)| {
        let rest = prose.split(begin).skip(1);
        rest.filter_map(|rest| rest.split(*end).next())
    });
    let path = |target: &&str| !target.contains("://") && !target.starts_with("mailto:");
    let found = found.filter(path).filter_map(|t| t.split('#').next());
    found.filter(|t| !t.is_empty()).collect()
}

/// What a forge cannot show of a page.
fn faults(page: &str, text: &str, tracked: &BTreeSet<PathBuf>) -> Vec<String> {
    let prose = prose(text);
    let mut out = Vec::new();
    if prose.contains("{{#") {
        out.push(format!("{page}: a directive of mdBook"));
    }
    let folder = Path::new(page).parent().unwrap();
    for target in targets(&prose) {
        let mut path = PathBuf::new();
        for part in folder.join(target).components() {
            match part {
                Component::ParentDir => drop(path.pop()),
                Component::CurDir => {}
                part => path.push(part),
            }
        }
        if !tracked.iter().any(|file| file.starts_with(&path)) {
            out.push(format!("{page}: git does not track {target}"));
        }
    }
    out
}

#[test]
fn regress_pages_include_nothing_and_link_to_tracked_files() {
    let listed = Command::new("git")
        .arg("-C")
        .arg(root())
        .arg("ls-files")
        .output();
    let listed = match listed {
        Ok(listed) if listed.status.success() => String::from_utf8(listed.stdout).unwrap(),
        _ => return eprintln!("skipped: not a checkout"),
    };
    let tracked: BTreeSet<PathBuf> = listed.lines().map(PathBuf::from).collect();
    // Templates of generated pages are no pages.
    let pages = listed
        .lines()
        .filter(|file| file.ends_with(".md") && !file.starts_with("crates/"));
    let pages: Vec<&str> = pages.collect();
    assert!(pages.len() > 80, "only {} pages", pages.len());
    let read = |page: &&str| fs::read_to_string(root().join(page)).unwrap_or_default();
    let all = pages
        .iter()
        .flat_map(|page| faults(page, &read(page), &tracked));
    let all: Vec<String> = all.collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn unit_what_a_forge_cannot_show_is_found() {
    let tracked = BTreeSet::from(["docs/a.md", "data/b.csv"].map(PathBuf::from));
    let of = |text: &str| faults("docs/x.md", text, &tracked).len();
    assert_eq!(
        of("[a](a.md#b), [b](../data), `[c](c.md)`, [d](https://d.org)\n```\n[e](e.md)\n```\n"),
        0
    );
    assert_eq!(of("{{#include a.md}}"), 1);
    assert_eq!(of("![picture](picture.svg) [a](../a.md)"), 2);
}
