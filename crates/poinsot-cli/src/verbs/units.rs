//! `poinsot units`

use super::{Outcome, print, print_json};
use crate::arguments::Units;
use poinsot_telemetry::{Dimension, Unit, units};

/// A unit as JSON: its value in SI is `value * factor / divisor`.
#[derive(serde::Serialize)]
struct Entry {
    #[serde(flatten)]
    unit: Unit,
    si: &'static str,
}

pub fn run(arguments: &Units) -> Outcome {
    if arguments.json {
        let entry = |unit: Unit| Entry {
            unit,
            si: unit.dimension.si(),
        };
        let all: Vec<Entry> = units().map(entry).collect();
        print_json(&serde_json::json!({ "schema": "poinsot.units/1", "units": all }));
        return Ok(0);
    }
    let mut dimensions: Vec<Dimension> = Vec::new();
    for unit in units() {
        if !dimensions.contains(&unit.dimension) {
            dimensions.push(unit.dimension);
        }
    }
    for dimension in dimensions {
        let of: Vec<&str> = units()
            .filter(|u| u.dimension == dimension)
            .map(|u| u.symbol)
            .collect();
        print(&format!(
            "{:21} {:8} {}\n",
            dimension.words(),
            dimension.si(),
            of.join(", ")
        ));
    }
    Ok(0)
}
