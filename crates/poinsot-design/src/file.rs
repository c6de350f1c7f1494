//! A design as `design.json` (`poinsot.design/2`) and as a document.

use crate::result::{Designed, Relaxed};
use poinsot_formats::{
    DESIGN, DesignFile, DesignVerificationFile, DesignedNumberFile, LimitUseFile, RelaxedFile,
    SearchFile, ShorterFile, VerifiedNumberFile, finite,
};
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
    let limits = designed.limits.iter().map(|l| LimitUseFile {
        what: l.what.clone(),
        unit: l.unit.to_owned(),
        value: l.value,
        limit: l.limit,
        margin: l.margin,
        active: l.is_active(),
    });
    let points = |all: &[Relaxed]| {
        let point = |r: &Relaxed| RelaxedFile {
            what: r.what.clone(),
            factor: r.factor,
            worst_ratio: r.ratio,
        };
        all.iter().map(point).collect()
    };
    let verification = designed.verification.as_ref();
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
        shorter: designed.shorter.map(|s| ShorterFile {
            missed_s: s.missed_s,
            stopped: s.stopped,
        }),
        worst_ratio: finite(designed.worst_ratio()),
        robust_log_ratio: designed.robust.map(|r| r.searched),
        robust_log_ratio_others: designed.robust.and_then(|r| r.others),
        nominal_log_ratio_others: designed.robust.and_then(|r| r.nominal),
        wants: wants.collect(),
        limits: limits.collect(),
        relaxed: points(&designed.relaxed),
        front: points(&designed.front),
        against_duration: designed.against_duration.clone(),
        search: SearchFile {
            evaluations: designed.evaluations,
            starts: designed.starts.clone(),
            settled: designed.settled,
        },
        verification: verification.map(|v| DesignVerificationFile {
            flights: v.flights,
            failed: v.failed.clone(),
            limits_broken: v.limits_broken,
            agrees: v.agrees(),
            numbers: v
                .numbers
                .iter()
                .map(|n| VerifiedNumberFile {
                    name: n.name.clone(),
                    rms_ratio: n.rms_ratio,
                    band: [n.band.low, n.band.high],
                    flights: n.flights,
                })
                .collect(),
        }),
    };
    file.in_words = design_sentence(&file);
    file
}
