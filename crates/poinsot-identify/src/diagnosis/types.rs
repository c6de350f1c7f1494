//! Diagnosis as part of the answer.

pub use crate::problem::fault::FaultKind;
use crate::problem::parameters::UnknownKind;
pub use poinsot_formats::{
    DriftFile as MomentumDrift, HeldOutFile as HeldOut, LagFile as SensorLag,
    LineFile as SpectralLine,
};
use poinsot_telemetry::Repair;

/// Probability below which a residual is not white.
pub(crate) const COLOURED: f64 = 1.0e-4;

/// Evidence for and against the fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Diagnostics {
    /// Sum of the squared whitened residuals of all readings.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// `-2 ln` of the restricted likelihood of the readings, up to a constant that no declaration of noise
    /// changes: of two declarations the better has the lower one.
    pub deviance: f64,
    /// How far chi-square lies above its expectation, in its own standard deviations.
    pub excess_sigmas: f64,
    /// Change of the mass properties with the other wheel motion between samples (smooth or piecewise linear), sigmas;
    /// zero without wheels.
    pub shift_between_readings: f64,
    /// One entry per sensor, all segments together.
    pub channels: Vec<ChannelDiagnosis>,
    /// Whether a fit to the beginning of each record predicts its end; `None` if not tested.
    pub held_out: Option<HeldOut>,
    /// Drift of the total momentum that would fit best on top of the answer: all segments, then each.
    pub drift: Vec<MomentumDrift>,
    /// Lags between sensors, one per pair.
    pub lags: Vec<SensorLag>,
    /// Significant faults that would explain the residual, the best first.
    pub suspects: Vec<Suspect>,
    /// Lines in the spectrum of the gyro residual, looked for where the fit is bad.
    pub lines: Vec<SpectralLine>,
    /// Conclusions, the most important first; empty if the fit matches the declared noise.
    pub findings: Vec<Finding>,
    /// Assumptions that no sample tells of.
    pub(crate) assumed: Vec<Assumed>,
    /// How far each mode moves.
    pub(crate) deflections: Vec<Deflection>,
}

/// Amplitude of a mode along the records, kg^1/2 m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Deflection {
    /// Largest size.
    pub largest: f64,
    /// Its mean square: the inertia, kg m2, that the mode adds on the average at most in second order, since its shape is normalised
    /// to a mean square of one by mass.
    pub mean_square: f64,
}

/// An assumption, and how the mass properties move where it fails by a stated change.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assumed {
    pub what: String,
    pub change: String,
    /// Over the mass properties among the unknowns.
    pub shift: Vec<f64>,
}

/// The residual of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelDiagnosis {
    /// As in [`crate::ChannelFit`].
    pub name: String,
    /// Readings.
    pub readings: usize,
    /// Scalars in them: three per sample, two of a direction.
    pub numbers: usize,
    /// Mean square of the whitened residual; 1 where the declared noise is right.
    pub chi2_per_number: f64,
    /// The same from the median, robust against outliers.
    pub typical_chi2_per_number: f64,
    /// Readings beyond one in a million of the typical scatter (the declared one where that is larger).
    pub outliers: usize,
    /// p-value of a white residual: the smallest over the segments, times their number.
    pub whiteness_p: Option<f64>,
}

impl ChannelDiagnosis {
    /// Whether the residual may be white.
    pub(crate) fn is_white(&self) -> bool {
        self.whiteness_p.is_none_or(|p| p > COLOURED)
    }

    /// Share of outliers.
    pub fn outlier_share(&self) -> f64 {
        self.outliers as f64 / self.readings.max(1) as f64
    }
}

/// A fault that would explain the residual.
#[derive(Debug, Clone, PartialEq)]
pub struct Suspect {
    /// In words.
    pub name: String,
    /// By how much `-2 ln L`, of additive faults chi-square, would fall.
    pub decrease: f64,
    /// Share of the misfit that it explains, at most 1; 0 where there is no misfit.
    pub explains: f64,
    /// Its numbers.
    pub values: Vec<SuspectValue>,
    /// How many numbers it has.
    pub numbers: usize,
    /// How many starts within the record were tried.
    pub times: usize,
    /// Meaning.
    pub fault: FaultKind,
    /// Whether the data cannot tell it from the first suspect.
    pub tied: bool,
    /// The change of the map that puts it right, where it is a convention of channels.
    pub repair: Option<Repair>,
}

/// A number of a suspect.
#[derive(Debug, Clone, PartialEq)]
pub struct SuspectValue {
    /// Name in the result.
    pub name: String,
    /// Value with which the suspect explains most.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// The unknown that it is; `None` of a number of the noise and of a factor of a column.
    pub kind: Option<UnknownKind>,
}

impl SuspectValue {
    /// A number that is no unknown.
    pub(super) fn other(name: String, value: f64, unit: &'static str) -> Self {
        Self {
            name,
            value,
            unit,
            kind: None,
        }
    }
}

impl Suspect {
    /// One that lowers `-2 ln L` by so much, as far as no other is known.
    pub(super) fn new(
        name: String,
        fault: FaultKind,
        decrease: f64,
        values: Vec<SuspectValue>,
    ) -> Self {
        Self {
            name,
            decrease,
            explains: 0.0,
            numbers: values.len(),
            values,
            times: 1,
            fault,
            tied: false,
            repair: None,
        }
    }

    /// Its first number, if that is an unknown.
    pub(super) fn first(&self) -> Option<(&UnknownKind, f64)> {
        let first = self.values.first()?;
        Some((first.kind.as_ref()?, first.value))
    }
}

/// A conclusion.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Meaning.
    pub fault: FaultKind,
    /// Indistinguishable alternatives.
    pub or: Vec<FaultKind>,
    /// In words, with the evidence.
    pub text: String,
}

impl Finding {
    /// Without an alternative.
    pub(crate) fn new(fault: FaultKind, text: String) -> Self {
        let or = Vec::new();
        Self { fault, or, text }
    }
}
