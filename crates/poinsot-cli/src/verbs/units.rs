//! `poinsot units`

use super::{Outcome, print, print_json};
use crate::arguments::Units;
use poinsot::units_file;
use poinsot_telemetry::{Dimension, units};

pub fn run(arguments: &Units) -> Outcome {
    if arguments.print.json {
        print_json(&units_file());
        return Ok(0);
    }
    if arguments.print.quiet {
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
