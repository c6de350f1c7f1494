//! A table of all numbers, one row each; undetermined numbers have empty cells.

use super::{Exported, Source};
use crate::written::csv_text;
use poinsot_formats::NumberFile;

const HEADER: [&str; 7] = [
    "body", "quantity", "unit", "value", "sigma", "nominal", "source",
];

pub(super) fn text(source: &Source) -> Exported {
    let unreliable = source.marks().next().is_some();
    let cell = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:?}"));
    let row = |body: &str, quantity: &str, unit: &str, n: &NumberFile| {
        let place = [body, quantity, unit].map(str::to_owned);
        let values = [n.value, n.sigma, Some(n.nominal)].map(cell);
        let source = match n.source.as_deref() {
            Some(word) if unreliable && n.value.is_some() => format!("{word} (not reliable)"),
            word => word.unwrap_or("not determined").to_owned(),
        };
        let row = place.into_iter().chain(values);
        row.chain([source]).collect::<Vec<_>>()
    };
    let e = source.estimate;
    let mut rows = vec![HEADER.map(str::to_owned).to_vec()];
    for (name, body) in &e.bodies {
        let numbers = body.addressed("");
        let own = |(address, unit, number): &(String, &str, NumberFile)| {
            row(name, address.trim_start_matches('.'), unit, number)
        };
        rows.extend(numbers.iter().map(own));
    }
    let nuisance = e.nuisance.iter();
    rows.extend(nuisance.map(|(name, number)| row("", name, "", number)));
    Exported {
        text: csv_text(rows),
        ..Exported::default()
    }
}
