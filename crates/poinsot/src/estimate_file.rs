//! Converts an estimate to the result file, `poinsot.estimate/3`.

use crate::channel_names::position;
use crate::identify::Identified;
use poinsot_formats::{
    Axes, BarycentricFile, BodyFile, ChannelFile, CheckFile, CovarianceFile, DeterminedFile,
    DiagnosticsFile, ESTIMATE, Elements, EpochFile, EstimateFile, EvidenceFile, FindingFile,
    IdentifiabilityFile, InputFile, KnownNumbersFile, MomentumFile, NumberFile, ReferenceFile,
    SegmentFitFile, SensitivityFile, SensorFitFile, SuspectFile, SystemFile, UndeterminedFile,
    ValueFile, address, finite,
};
use poinsot_identify::{
    BodyEstimate, DeterminedCombination, Diagnostics, Estimate, Identifiability, KnownEffect,
    MomentumEstimate, Number, Remark, RemarkKind, SegmentFit, UnobservableCombination,
};
use poinsot_model::Model;
use poinsot_telemetry::checks::Finding;

/// The estimate as result file.
///
/// ```
#[doc = include_str!("../doc/answer.txt")]
/// let file = estimate_file(&identified);
/// assert_eq!(file.status, "converged");
/// let I_zz = &file.bodies["bus"].inertia_kg_m2.zz;
/// assert!((I_zz.value.unwrap() - 2.5).abs() < 3.0 * I_zz.sigma.unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate_file(identified: &Identified) -> EstimateFile {
    let e = &identified.estimate;
    let owned = |words: Vec<&str>| words.into_iter().map(str::to_owned).collect();
    EstimateFile {
        schema: ESTIMATE.to_owned(),
        poinsot: env!("CARGO_PKG_VERSION").to_owned(),
        method: e.method.clone(),
        variant: e.variant.clone(),
        status: e.status.name().to_owned(),
        iterations: e.iterations,
        model: identified.model.name.clone(),
        reference: reference(&identified.model),
        epoch: Some(epoch(identified)),
        model_file: identified.model_file.clone(),
        map_file: identified.map_file.clone(),
        inputs: inputs(identified),
        bodies: e.bodies.iter().map(|b| (b.name.clone(), body(b))).collect(),
        covariance: covariance(e),
        system: system(identified),
        momentum: e.momentum.iter().map(momentum).collect(),
        nuisance: nuisance(e),
        identifiability: identifiability(&e.identifiability),
        fit: e.fit.iter().map(segment_fit).collect(),
        diagnostics: e.diagnostics.as_ref().map(diagnostics),
        known_numbers: known_numbers(e),
        covariance_trustworthy: e.covariance_trustworthy(),
        doubts: e.doubts(),
        evidence: e.tests().map(evidence).collect(),
        method_report: e.method_report.clone(),
        telemetry_checks: identified.findings.iter().map(check).collect(),
        repairs: owned(identified.repairs()),
        ignored_columns: owned(e.said(RemarkKind::Ignored)),
        warnings: owned(e.warnings()),
    }
}

/// Frames and points, with the name of the base.
pub(crate) fn reference(model: &Model) -> ReferenceFile {
    let base = model.bodies.first();
    ReferenceFile::of_base(base.map_or("", |b| b.name.as_str()))
}

/// Addresses of the rows of a covariance.
fn rows(e: &Estimate) -> impl Iterator<Item = String> + '_ {
    let rows = e.covariance_names.iter().zip(&e.covariance_units);
    rows.map(|(name, unit)| address(name, unit))
}

pub(crate) fn covariance(e: &Estimate) -> CovarianceFile {
    CovarianceFile {
        names: rows(e).collect(),
        units: e.covariance_units.iter().map(|u| (*u).to_owned()).collect(),
        matrix: e.covariance.iter().map(|row| finite_list(row)).collect(),
    }
}

/// Origin of all times; the files' own count if they have no dates.
fn epoch(identified: &Identified) -> EpochFile {
    let date = identified.origin.and_then(|origin| origin.date());
    let parts = date.as_deref().and_then(|date| date.split_once(' '));
    let own = identified.origin.map_or(0.0, |origin| origin.own_zero_s());
    EpochFile {
        at: parts.map(|(at, _)| at.to_owned()),
        scale: parts.map(|(_, scale)| scale.to_owned()),
        own_count_s: date.is_none().then_some(own),
    }
}

fn inputs(identified: &Identified) -> Vec<InputFile> {
    let segments = identified.inputs.iter().enumerate();
    segments
        .flat_map(|(segment, files)| files.iter().map(move |f| (segment, f)))
        .map(|(segment, f)| InputFile {
            path: f.path.clone(),
            sha256: f.sha256.clone(),
            segment,
            time_s: f.time_s,
            rows: f.rows,
        })
        .collect()
}

fn finite_list(list: &[f64]) -> Vec<Option<f64>> {
    list.iter().copied().map(finite).collect()
}

fn body(b: &BodyEstimate) -> BodyFile {
    BodyFile {
        mass_kg: number(&b.mass),
        com_m: Axes::of(b.com.each_ref().map(number)),
        inertia_kg_m2: Elements::of(b.inertia.each_ref().map(number)),
        principal: b.principal.clone(),
        barycentric: BarycentricFile::of(b.barycentric.each_ref().map(number)),
        physically_consistent: b.physically_consistent,
    }
}

fn number(n: &Number) -> NumberFile {
    NumberFile {
        value: n.value.and_then(finite),
        sigma: n.sigma.and_then(finite),
        nominal: n.nominal,
        source: n.source.name().map(str::to_owned),
    }
}

fn system(identified: &Identified) -> Vec<SystemFile> {
    let Some((whole, at)) = &identified.estimate.system else {
        return Vec::new();
    };
    let joints = identified.model.moving_joints().zip(at);
    let joint_positions = joints.map(|(j, q)| (position(j), *q));
    vec![SystemFile {
        body: body(whole),
        joint_positions: joint_positions.collect(),
    }]
}

fn momentum(m: &MomentumEstimate) -> MomentumFile {
    MomentumFile {
        linear_N_s: Axes::of(m.linear.each_ref().map(number)),
        angular_N_m_s: Axes::of(m.angular.each_ref().map(number)),
    }
}

fn nuisance(e: &Estimate) -> indexmap::IndexMap<String, NumberFile> {
    let all = e.nuisance.iter();
    all.map(|n| (address(&n.name, n.unit), number(&n.number)))
        .collect()
}

/// What the known numbers add to the sigmas of an answer.
pub(crate) fn known_numbers(e: &Estimate) -> KnownNumbersFile {
    let known = &e.known_numbers;
    let named = |list: &[Option<f64>]| {
        let pairs = rows(e).zip(list);
        pairs
            .filter_map(|(name, x)| Some((name, (*x).and_then(finite)?)))
            .collect()
    };
    let effect = |n: &KnownEffect| SensitivityFile {
        number: address(&n.name, n.unit),
        unit: n.unit.to_owned(),
        value: n.value,
        sigma: n.sigma,
        estimate: n.estimated.map(|e| e.0),
        estimate_sigma: n.estimated.map(|e| e.1),
        step: n.step_words.to_owned(),
        change: named(&n.changes),
        variance_share: named(&n.shares),
    };
    KnownNumbersFile {
        exact: known.exact,
        source_assumed: known.assumed,
        sigma_data: named(&known.sigma_data),
        sensitivities: known.effects.iter().map(effect).collect(),
        covariance: known
            .covariance
            .iter()
            .map(|row| finite_list(row))
            .collect(),
    }
}

/// Identifiable and undetermined combinations for the result file.
pub(crate) fn identifiability(i: &Identifiability) -> IdentifiabilityFile {
    let determined = |c: &DeterminedCombination| DeterminedFile {
        combination: c.text.clone(),
        coefficients: addressed(&c.coefficients),
        unit: c.unit.to_owned(),
        value: finite(c.value),
        sigma: finite(c.sigma),
    };
    let open = |c: &UnobservableCombination| UndeterminedFile {
        combination: c.text.clone(),
        coefficients: addressed(&c.coefficients),
        reason: c.reason.clone(),
        remedy: c.remedy.clone(),
        walk: addressed(&c.walk),
    };
    IdentifiabilityFile {
        parameters: i.parameters,
        rank: i.rank,
        structural_rank: i.structural_rank,
        sigmas_natural: finite_list(&i.sigmas_natural),
        identifiable: i.determined.iter().map(determined).collect(),
        not_identifiable: i.open.iter().map(open).collect(),
    }
}

/// What belongs to names, by their addresses.
fn addressed<T: Clone, A: FromIterator<(String, T)>>(named: &[(String, T)]) -> A {
    let all = named.iter();
    all.map(|(name, x)| (address(name, ""), x.clone()))
        .collect()
}

fn segment_fit(f: &SegmentFit) -> SegmentFitFile {
    let channel = |c: &poinsot_identify::ChannelFit| {
        let fit = SensorFitFile {
            rms: finite(c.rms),
            unit: c.unit.to_owned(),
            chi2_per_number: c.chi2_per_number.and_then(finite),
            whiteness_p: c.whiteness_p.and_then(finite),
        };
        (c.name.to_owned(), fit)
    };
    SegmentFitFile {
        segment: f.label.clone(),
        samples: f.samples,
        chi2_per_dof: finite(f.chi2_per_dof),
        channels: f.channels.iter().map(channel).collect(),
    }
}

fn evidence(row: &Remark) -> EvidenceFile {
    EvidenceFile {
        test: row.test.clone(),
        statistic: row.statistic.map(|(name, _)| name.to_owned()),
        value: row.statistic.and_then(|(_, value)| finite(value)),
        degrees_of_freedom: row.degrees_of_freedom,
        p: row.p.and_then(finite),
        effect: row.effect.name().to_owned(),
        sigma_factor: finite(row.sigma_factor),
        words: row.words.clone(),
    }
}

fn check(f: &Finding) -> CheckFile {
    CheckFile {
        check: f.check.name().to_owned(),
        channel: f.channel.clone(),
        count: f.count,
        of: f.of,
        first_times_s: f.first_times_s.clone(),
        text: f.text.clone(),
        policy: f.policy.name().to_owned(),
    }
}

/// Tests of the residuals for the result file.
fn diagnostics(d: &Diagnostics) -> DiagnosticsFile {
    DiagnosticsFile {
        chi2: finite(d.chi2),
        dof: d.dof,
        deviance: finite(d.deviance),
        excess_sigmas: finite(d.excess_sigmas),
        channels: d.channels.iter().map(diagnosed_channel).collect(),
        held_out: d.held_out.clone(),
        momentum_drift: d.drift.clone(),
        lags: d.lags.clone(),
        suspects: d.suspects.iter().map(suspect).collect(),
        lines: d.lines.clone(),
        findings: d.findings.iter().map(fault_finding).collect(),
    }
}

fn diagnosed_channel(c: &poinsot_identify::ChannelDiagnosis) -> (String, ChannelFile) {
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

fn fault_finding(f: &poinsot_identify::Finding) -> FindingFile {
    FindingFile {
        fault: f.fault.name().to_owned(),
        text: f.text.clone(),
    }
}
