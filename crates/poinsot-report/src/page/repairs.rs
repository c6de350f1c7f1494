//! Table of repairs: what, in which record, for which parts. Equal repairs of several parts or records are merged.

use super::Answer;
use indexmap::IndexMap;
use minijinja::{Value, context};
use poinsot_formats::Vehicle;

/// Placeholder for the name of a part.
const PART: &str = "…";

/// Rows of repair, records and parts.
pub(super) fn rows(answer: &Answer) -> Vec<Value> {
    let labels: Vec<&str> = answer
        .estimate
        .fit
        .iter()
        .map(|f| f.segment.as_str())
        .collect();
    let names = names(&answer.data.vehicle);
    let mut rows: IndexMap<(String, &str), Vec<&str>> = IndexMap::new();
    for repair in &answer.estimate.repairs {
        let (label, what) = split(repair, &labels);
        let part = names.iter().copied().find(|n| holds(what, n));
        let what = part.map_or_else(|| what.to_owned(), |n| what.replace(n, PART));
        rows.entry((what, label)).or_default().extend(part);
    }
    // Records with the same parts share a row.
    let mut merged: IndexMap<(String, Vec<&str>), Vec<&str>> = IndexMap::new();
    for ((what, label), parts) in rows {
        let records = merged.entry((what, parts)).or_default();
        if !label.is_empty() {
            records.push(label);
        }
    }
    let row = |((what, parts), records): ((String, Vec<&str>), Vec<&str>)| {
        let what = match parts.as_slice() {
            [one] => what.replace(PART, one),
            _ => what,
        };
        let parts = if parts.len() > 1 { parts } else { Vec::new() };
        context! { what, records => records.join(", "), parts => parts.join(", ") }
    };
    merged.into_iter().map(row).collect()
}

/// The record named at the start of a repair, and the rest.
fn split<'a>(repair: &'a str, labels: &[&'a str]) -> (&'a str, &'a str) {
    let found = labels.iter().find_map(|label| {
        let rest = repair.strip_prefix(label)?.strip_prefix(": ")?;
        Some((*label, rest))
    });
    found.unwrap_or(("", repair.trim_start_matches(": ")))
}

/// Whether a text contains a part's name as a whole word.
fn holds(text: &str, name: &str) -> bool {
    let goes_on = |at: usize| text[at + name.len()..].starts_with(char::is_alphanumeric);
    text.match_indices(name).any(|(at, _)| !goes_on(at)) && !name.is_empty()
}

/// Names of joints, wheels, thrusters and sensors, longest first.
fn names(vehicle: &Vehicle) -> Vec<&str> {
    let joints = vehicle.joints.iter().map(|j| j.name.as_str());
    let pointers = vehicle.wheels.iter().chain(&vehicle.thrusters);
    let sensors = vehicle.sensors.iter().map(|s| s.name.as_str());
    let mut all: Vec<&str> = joints
        .chain(pointers.map(|p| p.name.as_str()))
        .chain(sensors)
        .collect();
    all.sort_by_key(|name| std::cmp::Reverse(name.len()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_repair_is_split_into_record_and_text() {
        let labels = ["C1.csv", "a/C1.csv"];
        assert_eq!(split("a/C1.csv: no x", &labels), ("a/C1.csv", "no x"));
        assert_eq!(split("assumed: y", &labels), ("", "assumed: y"));
        assert!(holds("no channel 'joint1_rad'", "joint1"));
        assert!(!holds("no channel 'joint12_rad'", "joint1"));
    }
}
