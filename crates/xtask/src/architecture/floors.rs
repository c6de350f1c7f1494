//! Floors of the crates: 0 without imports of the workspace, otherwise one above the highest import.

use crate::fault::Fault;
use crate::repository::{read, root};
use std::collections::BTreeMap;
use std::fs;
use toml::Table;

/// Crates of each floor with their subjects, from floor 0.
pub type Floors = Vec<Vec<(String, &'static str)>>;

/// Crates of the product, with their subjects in a few words.
const SUBJECTS: [(&str, &str); 15] = [
    ("poinsot-files", "files in and out"),
    ("poinsot-solve", "least squares"),
    ("poinsot-spatial", "one rigid body"),
    ("poinsot-dynamics", "motion of a tree of bodies"),
    ("poinsot-figures", "plots, scenes, pages"),
    ("poinsot-formats", "result files"),
    ("poinsot-telemetry", "channels with unit and time"),
    ("poinsot-model", "the vehicle"),
    ("poinsot-report", "results for a reader"),
    ("poinsot-identify", "estimators"),
    ("poinsot-papers", "published methods"),
    ("poinsot", "one function per command"),
    ("poinsot-design", "search over manoeuvres"),
    ("poinsot-cli", "arguments and exit codes"),
    ("poinsot-py", "the Python module"),
];
/// Crates that test, show or maintain the product. None is imported by it.
const BESIDE: [&str; 5] = [
    "poinsot-book",
    "poinsot-fuzz",
    "poinsot-testkit",
    "poinsot-without-std",
    "xtask",
];

/// Reads the imports of every crate from its manifest.
pub fn read_floors() -> Result<Floors, Fault> {
    floors(&imports()?)
}

/// Imports between the crates of the workspace, without those of tests.
fn imports() -> Result<BTreeMap<String, Vec<String>>, Fault> {
    let folder = root().join("crates");
    let entries = fs::read_dir(&folder).map_err(|why| Fault::file(&folder, why))?;
    let mut found = BTreeMap::new();
    for entry in entries.flatten() {
        let path = entry.path().join("Cargo.toml");
        let manifest: Table = read(&path)?
            .parse()
            .map_err(|why| Fault::file(&path, why))?;
        let names = manifest
            .get("dependencies")
            .and_then(toml::Value::as_table)
            .into_iter()
            .flat_map(Table::keys)
            .filter(|name| name.starts_with("poinsot"))
            .cloned();
        let name = entry.file_name().to_string_lossy().into_owned();
        found.insert(name, names.collect());
    }
    Ok(found)
}

fn floors(imports: &BTreeMap<String, Vec<String>>) -> Result<Floors, Fault> {
    let subject = |name: &str| SUBJECTS.iter().find(|(known, _)| *known == name);
    let mut heights: BTreeMap<&str, usize> = BTreeMap::new();
    let mut left: Vec<&str> = Vec::new();
    for name in imports.keys() {
        if subject(name).is_some() {
            left.push(name);
        } else if !BESIDE.contains(&name.as_str()) {
            return Err(Fault::Failed(format!(
                "architecture: {name} has no subject; add it to SUBJECTS or BESIDE"
            )));
        }
    }
    // Cargo allows no circle, so that every round places a crate, unless the product imports a crate beside it.
    while !left.is_empty() {
        let before = left.len();
        left.retain(|name| {
            let below: Option<Vec<usize>> = imports[*name]
                .iter()
                .map(|below| heights.get(below.as_str()).copied())
                .collect();
            let Some(below) = below else { return true };
            heights.insert(name, below.into_iter().max().map_or(0, |most| most + 1));
            false
        });
        if left.len() == before {
            return Err(Fault::Failed(format!(
                "architecture: {left:?} import crates that are not part of the product"
            )));
        }
    }
    let most = heights.values().max().copied().unwrap_or_default();
    let mut out = vec![Vec::new(); most + 1];
    for (name, subject) in SUBJECTS {
        if let Some(height) = heights.get(name) {
            out[*height].push((name.to_owned(), subject));
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(crates: &[(&str, &[&str])]) -> BTreeMap<String, Vec<String>> {
        crates
            .iter()
            .map(|(name, below)| {
                let below = below.iter().map(|b| (*b).to_owned()).collect();
                ((*name).to_owned(), below)
            })
            .collect()
    }

    #[test]
    fn unit_a_crate_is_one_floor_above_its_highest_import() {
        let imports = list(&[
            ("poinsot", &["poinsot-model", "poinsot-files"]),
            ("poinsot-model", &["poinsot-files"]),
            ("poinsot-files", &[]),
            ("xtask", &[]),
        ]);
        let names: Vec<Vec<_>> = floors(&imports)
            .unwrap()
            .into_iter()
            .map(|floor| floor.into_iter().map(|(name, _)| name).collect())
            .collect();
        assert_eq!(names, [["poinsot-files"], ["poinsot-model"], ["poinsot"]]);
    }

    #[test]
    fn unit_the_product_imports_no_crate_beside_it() {
        let testkit = list(&[("poinsot", &["poinsot-testkit"]), ("poinsot-testkit", &[])]);
        assert!(floors(&testkit).is_err());
        assert!(floors(&list(&[("poinsot-new", &[])])).is_err());
    }

    #[test]
    fn unit_the_table_of_floors_is_current() {
        let table = read(&root().join("ARCHITECTURE.md")).unwrap();
        for (floor, crates) in read_floors().unwrap().iter().enumerate() {
            for (name, _) in crates {
                let row = format!("| {floor} | `{name}` |");
                assert!(table.contains(&row), "ARCHITECTURE.md has no row {row}");
            }
        }
        for name in BESIDE {
            let row = format!("| beside | `{name}` |");
            assert!(table.contains(&row), "ARCHITECTURE.md has no row {row}");
        }
    }
}
