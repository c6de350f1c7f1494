//! Document, section, table: numbers laid out for a reader. Knows numbers, not spacecraft.

mod document;
mod figures;
mod text;

pub use document::{Content, Document, Section, Table};
pub use figures::{number_with_sigma, significant};
