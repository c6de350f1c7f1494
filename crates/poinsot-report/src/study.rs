//! Findings of a study as a document.

use crate::templates::TEMPLATES;
use poinsot_figures::Document;
use poinsot_formats::StudyFindingsFile;

/// The findings as a document: tables, then the numbers for the paper's page.
pub fn study_document(found: &StudyFindingsFile) -> Document {
    TEMPLATES.document("study.txt", found)
}
