//! Plants bugs and shows which tests notice: validation/planted/bugs.toml, one at a time, in a scratch copy.

mod copy;
mod hunt;

use crate::fault::Fault;
use crate::repository::{name_of, read, root, write};
use serde::{Deserialize, Serialize};
use serde_json::ser::PrettyFormatter;
use serde_json::{Map, Serializer, Value};
use std::path::PathBuf;

const LIST: &str = "validation/planted/bugs.toml";
/// Failing tests that are listed for a bug; enough to show who notices it.
const LISTED: usize = 3;
/// Columns of the name in the printed list: the longest name has 27 letters.
const NAME_COLUMNS: usize = 28;

#[derive(Deserialize)]
struct List {
    bug: Vec<Bug>,
}

/// One mistake.
#[derive(Deserialize)]
struct Bug {
    name: String,
    what: String,
    file: String,
    right: String,
    wrong: String,
    tests: Vec<String>,
}

/// Tests that catch each bug, by its name; empty for one that survived.
struct Results(Map<String, Value>);

/// Hunts the named bugs; without names all that no test has caught yet, or all.
pub fn run(names: &[String], fresh: bool, check: bool) -> Result<(), Fault> {
    let bugs = bugs()?;
    let files = copy::sources(&bugs)?;
    if check {
        println!("{} bugs find their place", bugs.len());
        return Ok(());
    }
    if let Some(name) = names
        .iter()
        .find(|name| bugs.iter().all(|bug| bug.name != **name))
    {
        return Err(Fault::Use(format!(
            "planted: no bug '{name}'; {LIST} lists all"
        )));
    }
    copy::write_tree(&files)?;
    let binaries = hunt::build()?;
    let mut results = Results::read(fresh)?;
    for bug in &bugs {
        // Survivors are tried again: a test may have come.
        if names.contains(&bug.name) || (names.is_empty() && results.caught(bug).is_empty()) {
            let caught = hunt::hunt(bug, &binaries)?;
            println!(
                "{:NAME_COLUMNS$} {}",
                bug.name,
                caught.first().map_or("SURVIVES", String::as_str)
            );
            results.0.insert(bug.name.clone(), caught.into());
            results.write()?;
        }
    }
    let page = root().join("docs/validation/planted.md");
    write(&page, text_of_page(&bugs, &results))?;
    let caught = bugs
        .iter()
        .filter(|bug| !results.caught(bug).is_empty())
        .count();
    println!("{caught} of {} caught; {}", bugs.len(), name_of(&page));
    let survives = |bug: &Bug| results.has(bug) && results.caught(bug).is_empty();
    // The list above names the survivors.
    (!bugs.iter().any(survives))
        .then_some(())
        .ok_or(Fault::Ended(1))
}

fn bugs() -> Result<Vec<Bug>, Fault> {
    let list: List = toml::from_str(&read(&root().join(LIST))?)
        .map_err(|why| Fault::Failed(format!("{LIST}: {why}")))?;
    for (at, bug) in list.bug.iter().enumerate() {
        if list.bug[..at].iter().any(|before| before.name == bug.name) {
            return Err(Fault::Failed(format!(
                "{LIST}: two bugs have the name '{}'; rename one",
                bug.name
            )));
        }
    }
    Ok(list.bug)
}

impl Results {
    fn path() -> PathBuf {
        copy::scratch().join("results.json")
    }

    fn read(fresh: bool) -> Result<Self, Fault> {
        let path = Self::path();
        if fresh || !path.exists() {
            return Ok(Self(Map::new()));
        }
        let results = serde_json::from_str(&read(&path)?).map_err(|why| Fault::file(&path, why))?;
        Ok(Self(results))
    }

    fn write(&self) -> Result<(), Fault> {
        let mut bytes = Vec::new();
        let mut out = Serializer::with_formatter(&mut bytes, PrettyFormatter::with_indent(b" "));
        self.0
            .serialize(&mut out)
            .map_err(|why| Fault::file(&Self::path(), why))?;
        write(&Self::path(), bytes)
    }

    fn has(&self, bug: &Bug) -> bool {
        self.0.contains_key(&bug.name)
    }

    fn caught(&self, bug: &Bug) -> Vec<&str> {
        let tests = self.0.get(&bug.name).and_then(Value::as_array);
        tests
            .into_iter()
            .flatten()
            .filter_map(Value::as_str)
            .collect()
    }
}

/// The choice of targets that PLANTED_TARGETS makes.
fn chosen_targets() -> Option<String> {
    std::env::var("PLANTED_TARGETS")
        .ok()
        .filter(|choice| !choice.is_empty())
}

fn text_of_page(bugs: &[Bug], results: &Results) -> String {
    let rows: Vec<_> = bugs.iter().map(|bug| row(bug, results)).collect();
    let count = bugs
        .iter()
        .filter(|bug| !results.caught(bug).is_empty())
        .count();
    let built = chosen_targets().map_or(String::new(), |choice| {
        format!(
            "Only a choice of the tests was built (`{choice}`); what these miss, others may notice."
        )
    });
    format!(
        "# Planted bugs\n\n\
         Each of these mistakes is put into a copy of the sources, alone, and the tests are run\n\
         (`scripts/planted`; the list is `{LIST}`). A test counts when it fails with the bug and\n\
         passes without. Packages run from the bottom of the tree upwards until one has a catch; of it the first {LISTED}\n\
         failures are named, so that a bug may be caught by more tests than stand here.\n\n\
         {count} of {} are caught. {built}\n\n\
         | bug | what is wrong | caught | by |\n|---|---|---|---|\n{}\n",
        bugs.len(),
        rows.join("\n")
    )
}

fn row(bug: &Bug, results: &Results) -> String {
    let tests = results.caught(bug);
    let caught = match (results.has(bug), tests.is_empty()) {
        (false, _) => "not run",
        (true, false) => "yes",
        (true, true) => "**no**",
    };
    let tests: Vec<_> = tests
        .iter()
        .take(LISTED)
        .map(|test| format!("`{test}`"))
        .collect();
    format!(
        "| `{}` | {} | {caught} | {} |",
        bug.name,
        bug.what,
        tests.join("<br>")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_rows_show_who_catches_a_bug() {
        let bug = Bug {
            name: "a".to_owned(),
            what: "wrong sign".to_owned(),
            file: String::new(),
            right: String::new(),
            wrong: String::new(),
            tests: Vec::new(),
        };
        let mut results = Results(Map::new());
        assert_eq!(row(&bug, &results), "| `a` | wrong sign | not run |  |");
        results
            .0
            .insert("a".to_owned(), Vec::<String>::new().into());
        assert_eq!(row(&bug, &results), "| `a` | wrong sign | **no** |  |");
        results.0.insert("a".to_owned(), vec!["x t", "y u"].into());
        assert_eq!(
            row(&bug, &results),
            "| `a` | wrong sign | yes | `x t`<br>`y u` |"
        );
    }
}
