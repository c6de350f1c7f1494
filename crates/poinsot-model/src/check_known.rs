//! Uncertainty of the known numbers: declared per number, by source, or exact.

use crate::finding::{Findings, Key};
use crate::knowledge::{Knowledge, Origin, Uncertain};
use crate::vehicle::Model;
use toml::{Table, Value};

/// Uncertainties of all numbers of a checked model; `order` has the place of each body in the file.
pub(crate) fn known(
    file: &Table,
    order: &[usize],
    model: &Model,
    findings: &mut Findings<'_>,
) -> Knowledge {
    let mut out = Knowledge::default();
    for number in model.known_numbers() {
        let (table, mut at, key) = number.key();
        if table == "body" {
            at = order.get(at).copied().unwrap_or(at);
        }
        let entry = file.get(table).and_then(|list| list.get(at)?.as_table());
        let sigma = entry.and_then(|entry| entry.get("uncertainty")?.get(key)?.as_float());
        if let Some(sigma) = sigma {
            if !number.is_known(model) {
                let name = entry.and_then(|entry| entry.get("name")?.as_str());
                findings.note(
                    &Key::entry(table, at, name).at("uncertainty").at(key),
                    "the uncertainty has no effect: the number is estimated, it defines the axes of its body, or the momentum of the wheel is measured; remove it",
                );
            }
            out.uncertain.push(Uncertain { number, sigma });
            continue;
        }
        // A table's own declaration precedes that of the model.
        let states = |t: &&Table| t.contains_key("exact") || t.contains_key("source");
        let own = entry.into_iter().chain([file]).find(states);
        let stated = |key: &str| own.and_then(|own| own.get(key));
        if stated("exact").and_then(Value::as_bool) == Some(true) {
            continue;
        }
        out.assumed |= own.is_none() && number.is_known(model);
        let origin = match stated("source").and_then(Value::as_str) {
            Some("measured") => Origin::Measured,
            _ => Origin::Cad,
        };
        let sigma = number.usual_sigma(origin);
        out.uncertain.push(Uncertain { number, sigma });
    }
    out.uncertain.retain(|u| u.sigma > 0.0);
    let number = |key: &str| file.get(key).and_then(Value::as_float);
    out.nominal_within = number("nominal_within");
    out.thrust_correlation = number("thrust_correlation").unwrap_or(0.0);
    out
}
