//! The answer: numbers with sigma and source, and the undetermined directions.

use crate::diagnosis::Diagnostics;
use crate::diagnosis::octaves::Octave;
use crate::solution::evidence::{self, Effect, Remark, RemarkKind};
pub use poinsot_formats::{
    MethodReportFile as MethodReport, PrincipalFile as Principal,
    ReportedNumberFile as ReportedNumber,
};

/// Status of an answer. The names are those of the result file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Every requested number is determined.
    Converged,
    /// Some are.
    Partial,
    /// None is.
    NotIdentifiable,
    /// The iteration ended before convergence.
    IterationLimit,
    /// The rigid model contradicts the data.
    Rejected,
}

impl Status {
    /// Each with its name in the result file.
    const ALL: [(Self, &'static str); 5] = [
        (Self::Converged, "converged"),
        (Self::Partial, "partial"),
        (Self::NotIdentifiable, "not_identifiable"),
        (Self::IterationLimit, "iteration_limit"),
        (Self::Rejected, "rejected"),
    ];

    /// Name in the result file.
    pub fn name(self) -> &'static str {
        let own = Self::ALL.iter().find(|(status, _)| *status == self);
        own.map_or("", |(_, name)| name)
    }

    /// The status of this name.
    pub fn named(name: &str) -> Option<Self> {
        let own = Self::ALL.into_iter().find(|(_, own)| *own == name);
        own.map(|(status, _)| status)
    }

    /// That of an answer with these numbers, before any remark.
    pub(crate) fn of_numbers(bodies: &[BodyEstimate], found: &Identifiability) -> Self {
        let open = bodies
            .iter()
            .filter(|b| b.asked)
            .flat_map(BodyEstimate::numbers)
            .any(|n| n.source == Source::Open);
        match (found.rank, open) {
            (0, _) => Self::NotIdentifiable,
            (_, true) => Self::Partial,
            (_, false) => Self::Converged,
        }
    }

    /// The status after a remark with this effect.
    pub(crate) fn after(self, effect: Effect) -> Self {
        match (effect, self) {
            (Effect::RejectsModel, _) | (_, Self::Rejected) => Self::Rejected,
            (Effect::WithholdsNumbers, _) => Self::IterationLimit,
            (Effect::MakesPartial, Self::Converged) => Self::Partial,
            (_, unchanged) => unchanged,
        }
    }
}

impl Estimate {
    /// Adds a remark. Status and reliability follow.
    pub fn add(&mut self, remark: Remark) {
        self.status = self.status.after(remark.effect);
        self.remarks.push(remark);
    }

    /// Adds several remarks in their order.
    pub fn add_all(&mut self, remarks: impl IntoIterator<Item = Remark>) {
        remarks.into_iter().for_each(|remark| self.add(remark));
    }

    /// The remarks of a kind, in words.
    pub fn said(&self, kind: RemarkKind) -> Vec<&str> {
        let all = self.remarks.iter().filter(|r| r.kind == kind);
        all.map(|r| r.words.as_str()).collect()
    }

    /// Warnings.
    pub fn warnings(&self) -> Vec<&str> {
        self.said(RemarkKind::Warning)
    }

    /// Every test that was made, the most important first.
    pub fn tests(&self) -> impl Iterator<Item = &Remark> {
        self.remarks.iter().filter(|r| r.kind == RemarkKind::Test)
    }

    /// Remark against the answer in words, the most important first; empty if every check passed.
    pub fn doubts(&self) -> Vec<String> {
        evidence::doubts(&self.remarks)
    }

    /// Whether any test is evidence against the answer.
    pub fn is_doubted(&self) -> bool {
        let mut rows = self.remarks.iter();
        rows.any(|row| row.effect.is_against_answer())
    }

    /// Whether a covariance is stated without evidence against it.
    pub fn covariance_trustworthy(&self) -> bool {
        self.states_covariance && !self.is_doubted()
    }

    /// Whether every requested number is determined and no evidence contradicts the answer.
    pub fn passes(&self) -> bool {
        self.status == Status::Converged && !self.is_doubted()
    }
}

/// Source of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The telemetry.
    Data,
    /// A declared prior.
    Prior,
    /// Given in the model as known.
    Known,
    /// None: the number is undetermined.
    Open,
}

impl Source {
    /// Name in the result file; `None` is written as null.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Data => Some("data"),
            Self::Prior => Some("prior"),
            Self::Known => Some("known"),
            Self::Open => None,
        }
    }
}

/// One number of the answer. Value and sigma are absent where the data do not determine it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number {
    /// Value.
    pub value: Option<f64>,
    /// One sigma; zero for a known number.
    pub sigma: Option<f64>,
    /// Value in the model.
    pub nominal: f64,
    /// Where the value comes from.
    pub source: Source,
}

impl Number {
    /// A number taken from the model.
    pub fn known(nominal: f64) -> Self {
        Self {
            value: Some(nominal),
            sigma: Some(0.0),
            nominal,
            source: Source::Known,
        }
    }

    /// An undetermined number.
    pub fn undetermined(nominal: f64) -> Self {
        Self {
            value: None,
            sigma: None,
            nominal,
            source: Source::Open,
        }
    }

    /// A number the data determine.
    pub fn data(value: f64, sigma: f64, nominal: f64) -> Self {
        Self {
            value: Some(value),
            sigma: Some(sigma),
            nominal,
            source: Source::Data,
        }
    }
}

/// Mass properties of one body or of the whole vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEstimate {
    /// Name.
    pub name: String,
    /// Whether any of its numbers was requested.
    pub asked: bool,
    /// Mass, kg.
    pub mass: Number,
    /// Mass centre from the body's origin, body axes, m.
    pub com: [Number; 3],
    /// Central inertia, tensor elements in the order xx, xy, yy, xz, yz, zz, kg m2.
    pub inertia: [Number; 6],
    /// The ten barycentric parameters about the body's origin.
    pub barycentric: [Number; 10],
    /// Principal moments, kg m2, and axes as a rotation (body from principal), if all are determined.
    pub principal: Option<Principal>,
    /// Whether the properties are physical; `None` if some are undetermined.
    pub physically_consistent: Option<bool>,
}

/// Momentum at the first sample of a segment, in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentumEstimate {
    /// Linear, N s.
    pub linear: [Number; 3],
    /// Angular about the system mass centre, N m s.
    pub angular: [Number; 3],
}

/// A nuisance number with its name and unit.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedNumber {
    /// Name, for example `gyro.bias_x`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Number.
    pub number: Number,
}

/// A combination of parameters, or a function of them that is no combination, that the data determine.
#[derive(Debug, Clone, PartialEq)]
pub struct DeterminedCombination {
    /// In words and numbers.
    pub text: String,
    /// Name and coefficient of each parameter; empty of a function that is not linear.
    pub coefficients: Vec<(String, f64)>,
    /// Unit of the leading parameter.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// One sigma.
    pub sigma: f64,
}

/// An unobservable direction of the parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct UnobservableCombination {
    /// In words.
    pub text: String,
    /// Name and coefficient of each parameter.
    pub coefficients: Vec<(String, f64)>,
    /// Why it is unobservable.
    pub reason: String,
    /// What would resolve it.
    pub remedy: String,
    /// Values of each changed parameter at evenly spaced points of equal prediction, the answer in the middle; empty
    /// without a path.
    pub walk: Vec<(String, Vec<f64>)>,
}

/// Identifiable and unobservable directions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Identifiability {
    /// Number of unknown mass properties (momentum and biases not counted).
    pub parameters: usize,
    /// Identified directions.
    pub rank: usize,
    /// Directions above round-off.
    pub structural_rank: usize,
    /// Rank at the answer and at the ends of the path of equal prediction; empty if the path is linear.
    pub ranks: Vec<usize>,
    /// Sigma of each direction in natural units, best first.
    pub sigmas_natural: Vec<f64>,
    /// Determined combinations; if they are fewer than the rank, other functions follow.
    pub determined: Vec<DeterminedCombination>,
    /// Unobservable directions.
    pub open: Vec<UnobservableCombination>,
}

/// Fit of one segment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SegmentFit {
    /// Name of the segment.
    pub label: String,
    /// Samples used.
    pub samples: usize,
    /// Chi-square per degree of freedom with the declared noise.
    pub chi2_per_dof: f64,
    /// One entry per sensor.
    pub channels: Vec<ChannelFit>,
}

/// Fit of one sensor in one segment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChannelFit {
    /// Kind: gyro, attitude, velocity, position, accelerometer, velocity_increment; `<kind>.<sensor>` where several
    /// sensors share the kind.
    pub name: String,
    /// Unit of the root mean square.
    pub unit: &'static str,
    /// Root mean square of measured less predicted, per axis.
    pub rms: f64,
    /// Chi-square per number with the declared noise; `None` if the method does not weight this sensor separately.
    pub chi2_per_number: Option<f64>,
    /// p-value of a white residual (Ljung and Box 1978, ten lags on each axis).
    pub whiteness_p: Option<f64>,
    /// Probability that white noise as declared has as much power at some frequency (Blackman and Tukey 1958, ten lags on each axis).
    pub power_p: Option<f64>,
    /// The whitened residual by octaves, the fastest first; empty if the method does not weight this sensor separately.
    pub octaves: Vec<Octave>,
}

/// Sensitivity of the answer to known numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KnownNumbers {
    /// Whether every known number is exact in the model.
    pub exact: bool,
    /// Whether some known number has no declared source and is assumed exact.
    pub assumed: bool,
    /// One sigma of each number of the covariance if every known number were exact; `None` of one that is itself known.
    pub sigma_data: Vec<Option<f64>>,
    /// Uncertain known numbers on which the readings depend, the largest share first.
    pub effects: Vec<KnownEffect>,
    /// Their covariance after the data, in the order of the effects and in their units.
    pub covariance: Vec<Vec<f64>>,
}

/// Effect of one known number on the answer.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownEffect {
    /// Name, for example `link1.mass`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value in the model; zero for a small turn, one for a factor.
    pub value: f64,
    /// Declared one sigma.
    pub sigma: f64,
    /// Estimated value and sigma, if the data reduce the sigma below 0.7 of the declared one.
    pub estimated: Option<(f64, f64)>,
    /// A step of it: 1 %, 1 mm or 1 mrad, in its unit.
    pub step: f64,
    /// The same in words.
    pub step_words: &'static str,
    /// Change of each number of the covariance with that step, the readings held; `None` of a number that is known.
    pub changes: Vec<Option<f64>>,
    /// Share of the variance of each number of the covariance that would go if this number were known exactly; shares of
    /// numbers that err together overlap.
    pub shares: Vec<Option<f64>>,
}

impl KnownEffect {
    /// The number of the covariance whose variance it has most of, and the share.
    pub fn largest(&self) -> Option<(usize, f64)> {
        let shares = self.shares.iter().enumerate();
        let present = shares.filter_map(|(k, s)| Some((k, (*s)?)));
        present.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The answer to one question.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Method.
    pub method: String,
    /// Variant of a published method.
    pub variant: Option<String>,
    /// Status: that of the numbers, after the effects of all remarks.
    pub status: Status,
    /// Iterations taken; one for a closed form.
    pub iterations: usize,
    /// Cost (minus twice the log-likelihood, up to a constant) at the start and after every accepted step of the last fit; empty for a closed form.
    pub costs: Vec<f64>,
    /// Bodies in the order of the model.
    pub bodies: Vec<BodyEstimate>,
    /// The whole vehicle at the first sample of the first segment, with the joint positions it holds
    /// for; `None` without samples.
    pub system: Option<(BodyEstimate, Vec<f64>)>,
    /// Momentum, one per segment.
    pub momentum: Vec<MomentumEstimate>,
    /// Spin inertias, thruster scales, biases.
    pub nuisance: Vec<NamedNumber>,
    /// Names of the rows of the covariance.
    pub covariance_names: Vec<String>,
    /// Units of the same.
    pub covariance_units: Vec<&'static str>,
    /// Covariance of the determined numbers, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// Identifiability.
    pub identifiability: Identifiability,
    /// Fit, one per segment.
    pub fit: Vec<SegmentFit>,
    /// Whether a covariance is stated.
    pub states_covariance: bool,
    /// All that is said of it: tests, the most important first, warnings, assumptions, repairs. The status follows from them and
    /// from the numbers.
    pub remarks: Vec<Remark>,
    /// Diagnosis of the residuals; `None` for a method without it.
    pub diagnostics: Option<Diagnostics>,
    /// Sensitivity to known numbers.
    pub known_numbers: KnownNumbers,
    /// A published method's own numbers.
    pub method_report: Option<MethodReport>,
}
