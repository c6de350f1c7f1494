//! Conclusions from the evidence, the most important first.

use super::EXCESS;
use super::types::{ChannelDiagnosis, Diagnostics, FaultKind, Finding, Suspect};
use poinsot_model::rounded;

/// Largest number of alternatives named with the first cause.
const TIES: usize = 3;
/// Share of the misfit from which a suspect is named as the cause.
const CAUSE: f64 = 0.6;
/// Mean square of a sensor's residual below which its noise is declared too large: sigmas are half as large again as they
/// need be.
const OVERSTATED: f64 = 0.44;

pub(super) fn findings(d: &Diagnostics) -> Vec<Finding> {
    let misfit = d.excess_sigmas > EXCESS;
    let best = d.suspects.first().filter(|s| s.decrease > 0.0);
    let mut list: Vec<Finding> = best
        .map(|best| cause(best, &d.suspects[1..], misfit))
        .into_iter()
        .collect();
    let caused = best.is_some_and(|b| b.explains > CAUSE || !misfit || b.fault.is_noise_fault());
    if misfit && !caused {
        let lines = d.lines.iter().map(|line| {
            let text = format!(
                "{}: a spectral line at {:.3} Hz has {:.0} % of the gyro residual's power; the vehicle is not rigid (flexing, slosh) or has an unmodelled rotor",
                line.segment,
                line.frequency_hz,
                100.0 * line.share
            );
            Finding::new(FaultKind::NotRigid, text)
        });
        list.splice(0..0, lines);
    }
    if misfit {
        list.extend(d.channels.iter().filter_map(too_large));
        if list.is_empty() {
            let text = format!(
                "chi-square is {:.0} standard deviations above its expectation for the declared noise, and no known fault explains it",
                d.excess_sigmas
            );
            list.push(Finding::new(FaultKind::Unexplained, text));
        }
    }
    let overstated = d.channels.iter().filter_map(too_small);
    list.extend(overstated.filter(|_| !misfit));
    list
}

/// The best suspect, with indistinguishable alternatives.
fn cause(best: &Suspect, others: &[Suspect], misfit: bool) -> Finding {
    let gain = match (misfit, best.fault.is_noise_fault()) {
        (true, false) => format!("would explain {:.0} % of the misfit", 100.0 * best.explains),
        _ => format!("would reduce chi-square by {:.0}", best.decrease),
    };
    let values: Vec<String> = best
        .values
        .iter()
        .map(|v| value(&v.name, v.value, v.unit))
        .collect();
    let values = (!values.is_empty()).then(|| format!(": {}", values.join(", ")));
    let values = values.unwrap_or_default();
    let tied: Vec<&Suspect> = others.iter().filter(|s| s.tied).take(TIES).collect();
    let names: Vec<&str> = tied.iter().map(|s| s.name.as_str()).collect();
    let or = match names.is_empty() {
        true => String::new(),
        false => format!(
            "; the data cannot distinguish it from {}",
            names.join(", or ")
        ),
    };
    Finding {
        fault: best.fault,
        or: tied.iter().map(|s| s.fault).collect(),
        text: format!("{} {gain}{values}{or}{}", best.name, best.fault.advice()),
    }
}

fn value(name: &str, value: f64, unit: &str) -> String {
    let unit = if unit == "1" { "" } else { unit };
    format!("{name} = {} {unit}", rounded(value, 4))
        .trim()
        .to_owned()
}

/// A sensor whose residual is larger than declared, whatever the cause.
fn too_large(c: &ChannelDiagnosis) -> Option<Finding> {
    let numbers = c.numbers as f64;
    let ratio = c.typical_chi2_per_number;
    // The standard deviation of a median is 1.5 times that of a mean.
    if ratio <= 1.0 + 1.5 * EXCESS * (2.0 / numbers).sqrt() {
        return None;
    }
    let colour = ["", " and correlated in time"][usize::from(!c.is_white())];
    let text = format!(
        "residual of the {} is {:.2} times as large as declared{colour}",
        c.name,
        ratio.sqrt()
    );
    Some(Finding::new(FaultKind::Unexplained, text))
}

/// A sensor whose residual is far smaller than declared.
fn too_small(c: &ChannelDiagnosis) -> Option<Finding> {
    let numbers = c.numbers as f64;
    let ratio = c.chi2_per_number;
    let by_chance = 1.0 - EXCESS * (2.0 / numbers).sqrt();
    (ratio < OVERSTATED.min(by_chance)).then(|| {
        let text = format!(
            "the declared noise of the {} is too large: its residual is {} times that; declare the actual noise",
            c.name,
            rounded(ratio.sqrt(), 3)
        );
        Finding::new(FaultKind::NoiseOverstated, text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::{Suspect, SuspectValue};

    fn said(decrease: f64) -> Vec<String> {
        let suspect = Suspect {
            name: "drag".to_owned(),
            decrease,
            explains: 0.0,
            values: vec![SuspectValue::other(
                "environment.drag_x".to_owned(),
                1.0e-3,
                "kg m2",
            )],
            numbers: 3,
            times: 1,
            fault: FaultKind::Drag,
            tied: true,
            repair: None,
        };
        let found = findings(&Diagnostics {
            chi2: 100.0,
            dof: 100,
            suspects: vec![suspect],
            ..Diagnostics::default()
        });
        found.into_iter().map(|f| f.text).collect()
    }

    #[test]
    fn regress_no_finding_lowers_chi_square_by_less_than_nothing() {
        let good = "drag would reduce chi-square by 50: environment.drag_x = 0.001 kg m2; write drag_torque = \"estimate\" in [environment]";
        assert_eq!(said(50.0), [good]);
        assert!(said(-0.3).is_empty());
    }
}
