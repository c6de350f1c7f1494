//! Findings of a study as a document.

use poinsot_figures::{Document, Section, Table};
use poinsot_files::short;
use poinsot_formats::{FoundCellFile, StudyFindingsFile};

/// The findings as a document: tables, then the numbers for the paper's page.
pub fn study_document(found: &StudyFindingsFile) -> Document {
    let title = format!("{} {}: {}", found.paper, found.study, found.summary);
    let mut document = Document::new(title);
    for table in &found.tables {
        let mut text = Table::new(&[]);
        text.head.clone_from(&table.columns);
        for row in &table.rows {
            text.push(row.iter().map(cell).collect());
        }
        document.push(Section::table(&table.title, text));
    }
    if !found.statements.is_empty() {
        let mut text = Table::new(&["in the paper", "number"]);
        for s in &found.statements {
            text.push(vec![s.in_the_paper.clone(), s.number.clone()]);
        }
        let title = format!("Numbers of docs/methods/{}.md", found.paper);
        document.push(Section::table(&title, text));
    }
    document
}

fn cell(cell: &FoundCellFile) -> String {
    let number = |x: &Option<f64>| x.map_or("-".to_owned(), short);
    match cell {
        FoundCellFile::Word(text) => text.clone(),
        FoundCellFile::Number(x) => number(x),
        FoundCellFile::Pair(a, b) => format!("{} {}", number(a), number(b)),
    }
}
