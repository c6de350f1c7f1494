//! The floors of ARCHITECTURE.md, compared with the manifests: imports point down.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The floor of each crate; `None` for one beside the product.
type Floors = BTreeMap<String, Option<u32>>;

#[test]
fn unit_crates_import_lower_floors_alone() {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut imports = BTreeMap::new();
    for folder in fs::read_dir(root().join("crates")).unwrap() {
        let folder = folder.unwrap();
        let manifest = fs::read_to_string(folder.path().join("Cargo.toml")).unwrap();
        imports.insert(
            folder.file_name().into_string().unwrap(),
            imported(&manifest),
        );
    }
    let wrong = wrong(&floors(&page), &imports);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn unit_planted_imports_upwards_are_found() {
    let page = "| 0 | `poinsot-a` | x |\n| 1 | `poinsot-b` | x |\n| beside | `poinsot-kit` | x |\n";
    let manifest = |name: &str| {
        format!("[dependencies]\n{name}.workspace = true\n[dev-dependencies]\npoinsot-kit = {{}}\n")
    };
    let wrong_of = |name: &str, imports: &str| {
        let imports = BTreeMap::from([(name.to_owned(), imported(&manifest(imports)))]);
        wrong(&floors(page), &imports).len()
    };
    assert_eq!(wrong_of("poinsot-b", "poinsot-a"), 0);
    assert_eq!(wrong_of("poinsot-kit", "poinsot-b"), 0);
    assert_eq!(wrong_of("poinsot-a", "poinsot-b"), 1);
    assert_eq!(wrong_of("poinsot-b", "poinsot-kit"), 1);
    assert_eq!(wrong_of("poinsot-new", "poinsot-a"), 1);
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Rows `| floor | crate | ...`.
fn floors(page: &str) -> Floors {
    let rows = page.lines().filter_map(|line| {
        let mut cells = line.split('|').map(str::trim).skip(1);
        let floor = cells
            .next()
            .filter(|f| *f == "beside" || f.parse::<u32>().is_ok())?;
        Some((
            cells.next()?.trim_matches('`').to_owned(),
            floor.parse().ok(),
        ))
    });
    rows.collect()
}

/// Crates of the workspace that a manifest imports, those of tests left out.
fn imported(manifest: &str) -> Vec<String> {
    let mut section = "";
    let mut found = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            section = line;
        } else if section == "[dependencies]" && line.starts_with("poinsot") {
            let name = line.split(['.', ' ', '=']).next().unwrap_or(line);
            found.push(name.to_owned());
        }
    }
    found
}

/// Crates without a floor, and imports that do not point down.
fn wrong(floors: &Floors, imports: &BTreeMap<String, Vec<String>>) -> Vec<String> {
    let mut out = Vec::new();
    for (name, below) in imports {
        let Some(own) = floors.get(name) else {
            out.push(format!("{name}: no row in ARCHITECTURE.md"));
            continue;
        };
        for other in below {
            let is_below = match (own, floors.get(other).copied().flatten()) {
                (Some(own), Some(other)) => other < *own,
                (own, _) => own.is_none(),
            };
            if !is_below {
                out.push(format!("{name} imports {other}"));
            }
        }
    }
    out
}
