//! The result of a campaign as a terminal document.

use super::plan::Plan;
use super::result::Folded;
use crate::trials::{statistics_document, statistics_of};
use poinsot_figures::{Document, Section};
use poinsot_formats::{CampaignFile, MethodResultFile};
use poinsot_report::table_document;

/// Largest number of cells times methods with separate tables.
const DETAILED: usize = 3;

/// The result; for a small campaign also the statistics of each method with their bands.
pub fn campaign_document(plan: &Plan, folded: &Folded, result: &CampaignFile) -> Vec<Document> {
    let mut documents = Vec::new();
    let methods = plan.method_labels();
    if result.cells.len() * methods.len() <= DETAILED {
        for (cell, (sums, file)) in folded.cells.iter().zip(&result.cells).enumerate() {
            for (k, label) in methods.iter().enumerate() {
                let mut words = vec![title(plan, cell as u64)];
                if methods.len() > 1 {
                    words.push((*label).to_owned());
                }
                let statistics = statistics_of(&sums.methods[k]);
                let mut document = statistics_document(&words.join(", "), &statistics);
                document.push(Section::list(
                    "limits of a calibrated estimator",
                    asked(&file.methods[k]),
                ));
                documents.push(document);
            }
        }
    }
    documents.push(table_document(result));
    documents
}

fn title(plan: &Plan, cell: u64) -> String {
    let point = plan.point(cell).into_iter();
    let at: String = point.map(|(n, x)| format!(", {n} = {x}")).collect();
    let name = &plan.experiment(cell).name;
    match plan.file.about.as_str() {
        "" => format!("{name}{at}"),
        about => format!("{name}: {about}{at}"),
    }
}

fn asked(method: &MethodResultFile) -> Vec<String> {
    match method.misses.as_slice() {
        [] => vec!["calibrated: RMSE/bound <= 1.05, |bias| < 0.1 sigma, coverage 94 to 96 %, NEES in its band, spread within 5 % of predicted".to_owned()],
        misses => misses.iter().map(|m| format!("missed: {m}")).collect(),
    }
}
