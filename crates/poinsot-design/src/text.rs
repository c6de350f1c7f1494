//! A design in one sentence.

use crate::result::Designed;
use poinsot_files::significant;

/// The result in one sentence.
pub(crate) fn sentence(designed: &Designed) -> String {
    let seconds = significant(designed.duration_s, 4);
    let of = format!(
        "{} wanted numbers of {}",
        designed.wants.len(),
        designed.model.name
    );
    let hidden = designed.wants.iter().find(|r| r.sigma.is_none());
    if let Some(hidden) = hidden {
        return format!(
            "No manoeuvre of this kind determines {} within the limits ({seconds} s, {of}).",
            hidden.want.name
        );
    }
    if let Some(broken) = designed.broken().next() {
        return format!(
            "No manoeuvre was found within the limits: {} is broken.",
            broken.what
        );
    }
    let worst = designed.worst_ratio();
    let ratio = significant(worst, 3);
    match designed.is_reached() {
        true => {
            format!("{seconds} s reach all {of}: the largest sigma is {ratio} of the wanted one.")
        }
        false => {
            let active: Vec<&str> = designed
                .limits
                .iter()
                .filter(|l| l.is_active())
                .map(|l| l.what.as_str())
                .take(3)
                .collect();
            let by = match active.is_empty() {
                true => "the duration".to_owned(),
                false => active.join(", "),
            };
            format!(
                "{seconds} s do not reach all {of}: the largest sigma is {ratio} of the wanted one. Active limits: {by}."
            )
        }
    }
}
