//! A filled file as text.

use serde::Serialize;
use toml_edit::visit_mut::{VisitMut, visit_value_mut};
use toml_edit::{DocumentMut, Item, Table, Value};

/// The text of a file: tables, and tables of tables, are sections; all else is on one line.
pub(crate) fn text(file: &impl Serialize) -> String {
    let mut document: DocumentMut = toml_edit::ser::to_document(file).unwrap_or_default();
    Numbers.visit_document_mut(&mut document);
    sections(document.as_table_mut(), true);
    document.to_string()
}

/// Numbers of any size with the fewest digits.
struct Numbers;

impl VisitMut for Numbers {
    fn visit_value_mut(&mut self, value: &mut Value) {
        let short = value.as_float().and_then(|x| format!("{x:?}").parse().ok());
        match short {
            Some(short) => *value = short,
            None => visit_value_mut(self, value),
        }
    }
}

fn sections(table: &mut Table, top: bool) {
    for (_, item) in table.iter_mut() {
        let tables = item
            .as_inline_table()
            .is_some_and(|own| top || own.iter().any(|(_, value)| value.is_inline_table()));
        let whole = std::mem::take(item);
        let whole = match tables {
            true => whole.into_table().map(Item::Table),
            false => whole.into_array_of_tables().map(Item::ArrayOfTables),
        };
        *item = whole.unwrap_or_else(|item| item);
        match item {
            Item::Table(own) => sections(own, false),
            Item::ArrayOfTables(all) => all.iter_mut().for_each(|own| sections(own, false)),
            _ => {}
        }
    }
}
