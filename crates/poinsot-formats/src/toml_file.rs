//! Parses TOML into a typed file and reports all faults of its structure, not only the first.

use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::de::{DeTable, DeValue, Error};
use toml::{Deserializer, Spanned};

/// Largest number of faults reported per file.
const MOST: usize = 20;

/// One fault of the structure of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShapeFault {
    /// Byte range in the file.
    pub span: Range<usize>,
    /// What is wrong.
    pub problem: String,
    /// For an unknown key or word: the text read, and the valid ones.
    pub unknown: Option<(String, Vec<String>)>,
}

impl ShapeFault {
    fn of(error: &Error) -> Self {
        let message = error.message().lines().next().unwrap_or_default();
        let mut quoted = message.split('`').skip(1).step_by(2).map(str::to_owned);
        let unknown = match (message.starts_with("unknown"), quoted.next()) {
            (true, Some(name)) => Some((name, quoted.collect())),
            _ => None,
        };
        let problem = message.split(", expected one of").next();
        Self {
            span: error.span().unwrap_or_default(),
            problem: problem.unwrap_or_default().to_owned(),
            unknown,
        }
    }
}

/// Reads a file. A key that does not fit is recorded and removed, and the rest is parsed again.
///
/// # Errors
/// All faults found. Invalid TOML gives one fault, and a missing top-level key ends the list.
pub fn parse_toml<T: DeserializeOwned>(text: &str) -> Result<T, Vec<ShapeFault>> {
    let mut table = DeTable::parse(text).map_err(|e| vec![ShapeFault::of(&e)])?;
    let mut faults = Vec::new();
    let mut taken: Vec<String> = Vec::new();
    loop {
        let error = match T::deserialize(Deserializer::from(table.clone())) {
            Ok(file) if faults.is_empty() => return Ok(file),
            Ok(_) => return Err(faults),
            Err(error) => error,
        };
        let fault = ShapeFault::of(&error);
        let missing = fault.problem.strip_prefix("missing field");
        // The missing key was removed before, so its table cannot be parsed; remove the table.
        let known = missing.is_some_and(|m| taken.iter().any(|t| m.contains(&format!("`{t}`"))));
        let key = take_out(table.get_mut(), &fault.span);
        if !known {
            faults.push(fault);
        }
        match key {
            Some(key) if faults.len() < MOST => taken.push(key),
            _ => return Err(faults),
        }
    }
}

/// Removes the innermost key, or table of a list, whose key or value has these bytes. Returns its name.
fn take_out(table: &mut DeTable<'_>, at: &Range<usize>) -> Option<String> {
    let inner = table.iter_mut().find_map(|(_, v)| within(v.get_mut(), at));
    if inner.is_some() {
        return inner;
    }
    let covers = |span: Range<usize>| span.start <= at.start && at.end <= span.end;
    let found = table
        .iter()
        .find(|(key, value)| covers(key.span()) || covers(value.span()));
    let key = found?.0.get_ref().to_string();
    table.remove(key.as_str());
    Some(key)
}

fn within(value: &mut DeValue<'_>, at: &Range<usize>) -> Option<String> {
    match value {
        DeValue::Table(table) => take_out(table, at),
        DeValue::Array(items) => {
            let inner = items.iter_mut().find_map(|item| within(item.get_mut(), at));
            inner.or_else(|| {
                let table = |item: &Spanned<DeValue<'_>>| item.get_ref().is_table();
                let mut items_there = items.iter();
                let k = items_there.position(|item| table(item) && item.span() == *at)?;
                let all = std::mem::replace(items, std::iter::empty().collect());
                let others = all.into_iter().enumerate();
                *items = others.filter(|(i, _)| *i != k).map(|(_, x)| x).collect();
                Some(String::new())
            })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlanFile;
    use crate::case::CaseFile;

    #[test]
    fn unit_every_fault_of_a_file_is_told() {
        let text = "schema = \"poinsot.case/2\"\nmodle = 1\nmodel = \"m.toml\"\nduration_s = \"long\"\n\
            [output]\nrate_hz = 10\nrete_hz = 1\n[[firing]]\nthruster = \"a\"\non_s = 1\noff_s = 2\nforce_N = true\n";
        let faults = parse_toml::<CaseFile>(text).unwrap_err();
        let at = |f: &ShapeFault| text[..f.span.start].matches('\n').count() + 1;
        let mut lines: Vec<usize> = faults.iter().map(at).collect();
        lines.sort_unstable();
        assert_eq!(lines, [2, 4, 7, 12], "{faults:?}");
        let unknown = faults.iter().filter_map(|f| f.unknown.as_ref());
        let unknown: Vec<&str> = unknown.map(|u| u.0.as_str()).collect();
        assert_eq!(unknown, ["modle", "rete_hz"]);
        let missing = parse_toml::<PlanFile>("schema = \"poinsot.plan/1\"\n").unwrap_err();
        assert_eq!(missing[0].problem, "missing field `experiment`");
        assert_eq!(parse_toml::<PlanFile>("schema = ").unwrap_err().len(), 1);
    }
}
