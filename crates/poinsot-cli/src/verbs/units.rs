//! `poinsot units`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Units;
use poinsot::units_file;
use poinsot_telemetry::{Dimension, units};

pub fn run(arguments: &Units) -> Outcome {
    shown(&arguments.print, || print_json(&units_file()), list);
    Ok(0)
}

fn list() {
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
}
