//! A table of all numbers, one row each; undetermined numbers have empty cells.

use super::{Exported, Source};
use crate::error::Error;
use poinsot_formats::NumberFile;

const HEADER: [&str; 7] = [
    "body", "quantity", "unit", "value", "sigma", "nominal", "source",
];

/// CSV by RFC 4180.
pub(super) fn text(source: &Source) -> Result<Exported, Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = |row: [String; 7]| writer.write_record(row);
    let cell = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:?}"));
    let row = |body: &str, quantity: &str, unit: &str, n: &NumberFile| {
        let source = n
            .source
            .clone()
            .unwrap_or_else(|| "not determined".to_owned());
        [
            body.to_owned(),
            quantity.to_owned(),
            unit.to_owned(),
            cell(n.value),
            cell(n.sigma),
            cell(Some(n.nominal)),
            source,
        ]
    };
    let e = source.estimate;
    let mut written = write(HEADER.map(str::to_owned));
    for (name, body) in &e.bodies {
        for (address, unit, number) in body.addressed("") {
            let quantity = address.trim_start_matches('.');
            written = written.and_then(|()| write(row(name, quantity, unit, &number)));
        }
    }
    for (name, number) in &e.nuisance {
        written = written.and_then(|()| write(row("", name, "", number)));
    }
    let bytes = written
        .map_err(|error| error.to_string())
        .and_then(|()| writer.into_inner().map_err(|error| error.to_string()))
        .and_then(|bytes| String::from_utf8(bytes).map_err(|error| error.to_string()));
    Ok(Exported {
        text: bytes.map_err(|why| source.fault(why))?,
        left_out: Vec::new(),
        no_field: Vec::new(),
    })
}
