//! `poinsot units`

use super::{Outcome, print, print_json, shown};
use crate::arguments::Units;
use poinsot::units_file;
use poinsot_telemetry::{Dimension, Unit, units};

pub fn run(arguments: &Units) -> Outcome {
    shown(&arguments.print, || print_json(&units_file()), list);
    Ok(0)
}

fn list() {
    let all: Vec<Unit> = units().collect();
    let mut seen: Vec<Dimension> = all.iter().map(|u| u.dimension).collect();
    seen.dedup();
    for dimension in seen {
        let of = all.iter().filter(|u| u.dimension == dimension);
        let of: Vec<&str> = of.map(|u| u.symbol).collect();
        let (words, si, of) = (dimension.words(), dimension.si(), of.join(", "));
        print(&format!("{words:21} {si:8} {of}\n"));
    }
}
