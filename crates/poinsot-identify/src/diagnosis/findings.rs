//! What the evidence means, in words, the most important first.

use super::EXCESS;
use super::types::{ChannelDiagnosis, Diagnostics, FaultKind, Finding, Suspect};
use poinsot_model::rounded;

/// Share of outliers worth a word.
const OUTLIER_SHARE: f64 = 1.0e-3;
/// Share of the misfit from which a suspect is taken to be the cause.
const CAUSE: f64 = 0.6;
/// Probability below which a residual is not white.
const COLOURED: f64 = 1.0e-4;

pub(super) fn findings(d: &Diagnostics) -> Vec<Finding> {
    let misfit = d.excess_sigmas > EXCESS;
    let mut list: Vec<(f64, Finding)> = Vec::new();
    let excess = (d.chi2 - d.dof as f64).max(f64::MIN_POSITIVE);
    for channel in &d.channels {
        if let Some(text) = outliers(channel) {
            let numbers = 3.0 * channel.readings as f64;
            let over =
                (channel.chi2_per_number - channel.typical_chi2_per_number.max(1.0)) * numbers;
            list.push((over / excess, finding(FaultKind::Outliers, text)));
        }
    }
    if let Some(best) = d.suspects.first().filter(|s| s.decrease > 0.0) {
        let gain = match misfit {
            true => format!("would explain {:.0} % of the misfit", 100.0 * best.explains),
            false => format!("would lower chi-square by {:.0}", best.decrease),
        };
        let values: Vec<String> = best
            .values
            .iter()
            .map(|(n, v, u)| value(n, *v, u))
            .collect();
        let text = format!(
            "{} {gain}: {}{}",
            best.name,
            values.join(", "),
            advice(best)
        );
        let share = if misfit { best.explains } else { 1.0 };
        list.push((share, finding(best.fault, text)));
    }
    let caused = list.iter().any(|(share, _)| *share > CAUSE);
    if misfit && !caused {
        for line in &d.lines {
            let text = format!(
                "{}: a line at {:.3} Hz holds {:.0} % of the gyro residual: the vehicle is not rigid (flexing, slosh), or something unmodelled turns in it",
                line.segment,
                line.frequency_hz,
                100.0 * line.share
            );
            list.push((CAUSE, finding(FaultKind::NotRigid, text)));
        }
    }
    if misfit {
        for channel in &d.channels {
            list.extend(too_large(channel, excess, caused));
        }
        if list.is_empty() {
            let text = format!(
                "chi-square lies {:.0} standard deviations above what the declared noise allows, and no known fault explains it",
                d.excess_sigmas
            );
            list.push((0.0, finding(FaultKind::Unexplained, text)));
        }
    }
    list.sort_by(|a, b| b.0.total_cmp(&a.0));
    list.into_iter().map(|(_, f)| f).collect()
}

fn finding(fault: FaultKind, text: String) -> Finding {
    Finding { fault, text }
}

/// What would take a suspect into the model, or out of the data; begins with a separator.
fn advice(suspect: &Suspect) -> &'static str {
    match suspect.fault {
        FaultKind::GyroBias | FaultKind::SensorBias => "; write bias = \"estimate\" for it",
        FaultKind::GyroScale | FaultKind::SensorScale => "; write scale = \"estimate\" for it",
        FaultKind::GyroMisalignment | FaultKind::SensorMisalignment => {
            "; write misalignment = \"estimate\" for it"
        }
        FaultKind::Nonorthogonality => "; write nonorthogonality = \"estimate\" for it",
        FaultKind::Lag => "; correct its times, or write lag = \"estimate\" for it",
        FaultKind::WheelSign => "; turn the axis round, or the sign of the column",
        FaultKind::WheelScale => "; write estimate = true for it",
        FaultKind::Units => "; correct the unit in [telemetry.columns]",
        FaultKind::Thrust => "; check its firings, or write scale = \"estimate\" for it",
        FaultKind::Torque => "; write disturbance_torque = \"estimate\" in [environment]",
        FaultKind::Drag => "; write drag_torque = \"estimate\" in [environment]",
        // Forces that drift with the momentum are no unknown of the model file.
        FaultKind::MomentumDrift if suspect.name.contains("angular") => {
            "; write disturbance_torque_inertial = \"estimate\" in [environment]"
        }
        _ => "",
    }
}

fn value(name: &str, value: f64, unit: &str) -> String {
    let unit = if unit == "1" { "" } else { unit };
    format!("{name} = {} {unit}", rounded(value, 4))
        .trim()
        .to_owned()
}

fn outliers(c: &ChannelDiagnosis) -> Option<String> {
    (c.outlier_share() > OUTLIER_SHARE && c.outliers > 1).then(|| {
        format!(
            "{} of {} readings of the {} ({:.1} %) are outliers, beyond one in a million; a robust loss bounds what they do (--variant student_t)",
            c.outliers,
            c.readings,
            c.name,
            100.0 * c.outlier_share()
        )
    })
}

/// A sensor whose residual is larger than declared: white, the declaration is wrong; coloured, the model is.
fn too_large(c: &ChannelDiagnosis, excess: f64, caused: bool) -> Option<(f64, Finding)> {
    let numbers = 3.0 * c.readings.max(1) as f64;
    let ratio = c.typical_chi2_per_number;
    // A median scatters 1.5 times as much as a mean.
    if ratio <= 1.0 + 1.5 * EXCESS * (2.0 / numbers).sqrt() {
        return None;
    }
    let share = (ratio - 1.0) * numbers / excess;
    let white = c.whiteness_p.is_none_or(|p| p > COLOURED);
    Some(match white && !caused {
        true => (
            share,
            finding(
                FaultKind::NoiseUnderstated,
                format!(
                    "the noise of the {} is {:.2} times the declared one: the residual is white, so it is the declaration that is wrong; declare {} times as much",
                    c.name,
                    ratio.sqrt(),
                    rounded(ratio.sqrt(), 3)
                ),
            ),
        ),
        false => (
            0.0,
            finding(
                FaultKind::Unexplained,
                format!(
                    "residual of the {} is {:.2} times its declared noise{}",
                    c.name,
                    ratio.sqrt(),
                    if white { "" } else { " and correlated in time" }
                ),
            ),
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Suspect;

    fn said(decrease: f64) -> Vec<String> {
        let suspect = Suspect {
            name: "drag".to_owned(),
            decrease,
            explains: 0.0,
            values: vec![("environment.drag_x".to_owned(), 1.0e-3, "kg m2")],
            fault: FaultKind::Drag,
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
        let good = "drag would lower chi-square by 50: environment.drag_x = 0.001 kg m2; write drag_torque = \"estimate\" in [environment]";
        assert_eq!(said(50.0), [good]);
        assert!(said(-0.3).is_empty());
    }
}
