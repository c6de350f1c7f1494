//! Describes a case as text.

use super::{Case, Design, Open, Want};
use crate::error::{Error, Fault};
use poinsot_model::Model;
use poinsot_report::{CheckedCase, case_lines};

/// Describes a case with a model, one statement per line; `faults` are those found without the model.
///
/// # Errors
/// All faults that `simulate`, `predict` and `design` would report, in file order.
pub(crate) fn describe_case(
    case: &Case,
    model: &Model,
    mut faults: Vec<Fault>,
) -> Result<Vec<String>, Error> {
    let wants = kept(case.wants(model), &mut faults);
    kept(case.limits(model), &mut faults);
    let design = kept(case.design(model), &mut faults);
    // A wheel moved by the design needs no motion in the case.
    let open = match &design {
        Some(design) => design.as_ref().map(Design::open).unwrap_or_default(),
        None => Open {
            wheels: (0..model.wheels.len()).collect(),
            ..Open::default()
        },
    };
    let scenario = kept(case.bind_around(model, open), &mut faults);
    let (Some(wants), Some(design), Some(scenario), []) =
        (wants, design, scenario, faults.as_slice())
    else {
        faults.sort_by_key(|f| f.place.line);
        faults.dedup();
        return Err(Error::sorted(faults));
    };
    let want = |w: Want| (w.name, w.sigma, w.unit);
    Ok(case_lines(&CheckedCase {
        file: &case.file,
        model: format!("{} ({})", model.name, case.model.display()),
        duration_s: case.duration_s,
        rate_hz: case.rate_hz,
        rows: scenario.times.count(),
        seed: case.seed,
        wants: wants.into_iter().map(want).collect(),
        design: design.map(|d| [d.joints.len(), d.wheels.len()]),
    }))
}

/// The value read; its faults are added to `faults`.
fn kept<T>(read: Result<T, Error>, faults: &mut Vec<Fault>) -> Option<T> {
    read.map_err(|error| faults.extend(error.list)).ok()
}
