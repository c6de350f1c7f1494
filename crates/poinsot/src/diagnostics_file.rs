//! Evidence about the fit, for the result file.

use poinsot_formats::{
    ChannelFile, DiagnosticsFile, DriftFile, FindingFile, HeldOutFile, LagFile, LineFile,
    SuspectFile, ValueFile, address, finite,
};
use poinsot_identify::{Diagnostics, HeldOut, MomentumDrift};

/// Tests of the residuals for the result file.
pub(crate) fn diagnostics_file(d: &Diagnostics) -> DiagnosticsFile {
    DiagnosticsFile {
        chi2: finite(d.chi2),
        dof: d.dof,
        deviance: finite(d.deviance),
        excess_sigmas: finite(d.excess_sigmas),
        channels: d.channels.iter().map(channel).collect(),
        held_out: d.held_out.as_ref().map(held_out),
        momentum_drift: d.drift.iter().map(drift).collect(),
        lags: d.lags.iter().map(lag).collect(),
        suspects: d.suspects.iter().map(suspect).collect(),
        lines: d.lines.iter().map(line).collect(),
        findings: d.findings.iter().map(finding).collect(),
    }
}

fn channel(c: &poinsot_identify::ChannelDiagnosis) -> (String, ChannelFile) {
    let file = ChannelFile {
        readings: c.readings,
        chi2_per_number: finite(c.chi2_per_number),
        typical_chi2_per_number: finite(c.typical_chi2_per_number),
        outliers: c.outliers,
        outlier_share: c.outlier_share(),
        whiteness_p: c.whiteness_p,
    };
    (c.name.to_owned(), file)
}

fn held_out(h: &HeldOut) -> HeldOutFile {
    HeldOutFile {
        share: h.share,
        numbers: h.numbers,
        chi2: h.chi2,
        p: h.p,
    }
}

fn drift(d: &MomentumDrift) -> DriftFile {
    DriftFile {
        segment: d.segment.clone(),
        torque_N_m: d.torque_N_m.map(finite),
        torque_sigma_N_m: d.torque_sigma_N_m.map(finite),
        force_N: d.force_N.map(|f| f.map(finite)),
        force_sigma_N: d.force_sigma_N.map(|f| f.map(finite)),
        p: finite(d.p),
    }
}

fn lag(l: &poinsot_identify::SensorLag) -> LagFile {
    LagFile {
        between: l.between.clone(),
        lag_s: l.lag_s,
        sigma_s: l.sigma_s,
        p: finite(l.p),
    }
}

fn suspect(s: &poinsot_identify::Suspect) -> SuspectFile {
    let value = |v: &poinsot_identify::SuspectValue| ValueFile {
        name: address(&v.name, v.unit),
        value: finite(v.value),
        unit: v.unit.to_owned(),
    };
    SuspectFile {
        fault: s.fault.name().to_owned(),
        name: s.name.clone(),
        decrease_of_chi2: finite(s.decrease),
        explains: s.explains,
        values: s.values.iter().map(value).collect(),
    }
}

fn line(l: &poinsot_identify::SpectralLine) -> LineFile {
    LineFile {
        segment: l.segment.clone(),
        frequency_hz: l.frequency_hz,
        share: l.share,
    }
}

fn finding(f: &poinsot_identify::Finding) -> FindingFile {
    FindingFile {
        fault: f.fault.name().to_owned(),
        text: f.text.clone(),
    }
}
