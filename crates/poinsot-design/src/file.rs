//! A design as `design.json` (`poinsot.design/2`) and as a document.

use crate::result::Designed;
use poinsot_formats::{DESIGN, DesignFile, DesignedNumberFile, SearchFile, finite};
use poinsot_report::design_sentence;

/// Converts a design to its file.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// let designed = design_case(&case, model, &DesignRequest::default())?;
/// assert_eq!(design_file(&designed).wants.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn design_file(designed: &Designed) -> DesignFile {
    let wants = designed.wants.iter().map(|r| DesignedNumberFile {
        name: r.want.name.clone(),
        unit: r.want.unit.to_owned(),
        wanted_sigma: r.want.sigma,
        sigma: r.sigma,
        reference_sigma: r.reference,
    });
    let verdict = match (designed.is_reached(), designed.is_unshortened()) {
        (true, true) => "stopped",
        (true, false) => "reached",
        (false, _) => "not_reached",
    };
    let mut file = DesignFile {
        schema: DESIGN.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        case: designed.case.clone(),
        model: designed.model.name.clone(),
        verdict: verdict.to_owned(),
        in_words: String::new(),
        objective: designed.objective.to_owned(),
        duration_s: designed.duration_s,
        shorter: designed.shorter,
        worst_ratio: finite(designed.worst_ratio()),
        robust_log_ratio: designed.robust.map(|r| r.searched),
        robust_log_ratio_others: designed.robust.and_then(|r| r.others),
        nominal_log_ratio_others: designed.robust.and_then(|r| r.nominal),
        wants: wants.collect(),
        limits: designed.limits.clone(),
        relaxed: designed.relaxed.clone(),
        front: designed.front.clone(),
        against_duration: designed.against_duration.clone(),
        search: SearchFile {
            evaluations: designed.evaluations,
            starts: designed.starts.clone(),
            settled: designed.settled,
        },
        verification: designed.verification.clone(),
    };
    file.in_words = design_sentence(&file);
    file
}
