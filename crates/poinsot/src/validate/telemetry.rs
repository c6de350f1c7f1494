//! Compares a vehicle with telemetry: its motion in a case, or a held-back record.

use super::Mover;
use super::compared::{Compared, Group, turn_names};
use super::motion::scenario;
use crate::bind::bind;
use crate::case::Case;
use crate::channel_names::names;
use crate::error::Error;
use crate::simulate::perfect_table;
use poinsot_dynamics::Tree;
use poinsot_files::Place;
use poinsot_formats::{ComparedQuantityFile, InSigmasFile};
use poinsot_identify::{
    CompletedVehicle, HeldBack, PredictedChannel, Prediction, SegmentFit, held_back,
};
use poinsot_model::{JointKind, Model, Sensor, SensorKind, printed_unit};
use poinsot_spatial::UnitQuaternion;
use poinsot_telemetry::Table;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Largest number of points of a curve of held-back telemetry.
pub(super) const POINTS: usize = 100_000;

/// Compares the motion of a vehicle in a case with telemetry, at the times of the samples.
///
/// # Errors
/// The case does not fit the vehicle or cannot be computed, or the telemetry has no sample within its duration.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::validate::{Mover, compare_with_telemetry};
///
/// let table = simulate::simulate_case(&case, &model)?.table;
/// let compared = compare_with_telemetry(&case, &Mover::of_model(model), &table)?;
/// let gyro = compared.iter().find(|c| c.file.quantity == "gyro").unwrap();
/// // The difference is the noise.
/// assert!((gyro.file.sigmas.unwrap().rms - 1.0).abs() < 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_with_telemetry(
    case: &Case,
    mover: &Mover,
    table: &Table,
) -> Result<Vec<Compared>, Error> {
    let mut scenario = scenario(case, mover)?;
    let inside = |t: &f64| (0.0..=case.duration_s).contains(t);
    let sampled = table.channels.iter().flat_map(|c| c.time_s.iter().copied());
    // The motion starts at zero, even if the first sample is later.
    let mut times: Vec<f64> = sampled.filter(inside).chain([0.0]).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    scenario.times = times.into();
    let exact = perfect_table(case, &mover.model, &mover.bodies, scenario)?;
    let list: Vec<Compared> = groups(&mover.model)
        .into_iter()
        .filter_map(|group| group.compare(&exact, table, case.duration_s))
        .collect();
    if list.is_empty() {
        let place = Place::file(case.path());
        let problem = "the telemetry has no attitude, rate, position, velocity, acceleration or joint sample during the case";
        let advice = "give telemetry with times from the start of the case";
        return Err(Error::one("E0703", place, problem, advice));
    }
    Ok(list)
}

/// Possible measurements of all declared sensors, and of base and joints without one.
fn groups(model: &Model) -> Vec<Group<'_>> {
    let mut list: Vec<Group> = SensorKind::with_axes()
        // An increment has no value at an instant.
        .filter(|kind| *kind != SensorKind::VelocityIncrement)
        .flat_map(|kind| of_kind(model, kind))
        .collect();
    for (k, joint) in model.joints.iter().enumerate() {
        if joint.kind == JointKind::Fixed {
            continue;
        }
        for (kind, what) in [
            (SensorKind::JointPosition, "joint"),
            (SensorKind::JointRate, "rate of joint"),
        ] {
            list.push(Group {
                name: format!("{what} {}", joint.name),
                unit: printed_unit(kind.unit(joint.slides())),
                channels: names(model, kind, &[k]),
                sensor: model.sensors_of(kind).find(|s| s.of.contains(&k)),
                unnamed: true,
                attitude: UnitQuaternion::new_normalize,
            });
        }
    }
    list
}

/// The sensors of a kind with axes. Channels without a sensor name are those of the only one, of the first one on the base where
/// there are several, or of the base itself.
fn of_kind(model: &Model, kind: SensorKind) -> Vec<Group<'_>> {
    let group = |sensor, name, unnamed| Group {
        name,
        unit: printed_unit(kind.unit(false)),
        channels: names(model, kind, &[]),
        sensor,
        unnamed,
        attitude: UnitQuaternion::new_normalize,
    };
    let all: Vec<&Sensor> = model.sensors_of(kind).collect();
    let first = all.iter().position(|s| s.body == 0);
    match all.as_slice() {
        [] | [_] => vec![group(all.first().copied(), kind.word().to_owned(), true)],
        _ => {
            let named = all.iter().enumerate().map(|(k, sensor)| {
                let name = format!("{} {}", kind.word(), sensor.name);
                group(Some(*sensor), name, first == Some(k))
            });
            named.collect()
        }
    }
}

/// Chi-square per degree of freedom of noise 10 % larger than declared, the usual accuracy of a declaration.
const ALLOWED: f64 = 1.21;
/// p-value below which a misfit counts.
const BY_CHANCE: f64 = 1.0e-6;

/// Telemetry beside the prediction of the vehicle. Pose, momentum and declared nuisance parameters of the record are
/// fitted, but no number of the vehicle.
pub(super) struct HeldBackFindings {
    found: HeldBack,
    /// Assumptions of binding.
    pub repairs: Vec<String>,
}

impl HeldBackFindings {
    /// Compares telemetry with the prediction; `points` is the largest number of points of a curve.
    ///
    /// # Errors
    /// Model and telemetry do not match.
    pub fn of(mover: &Mover, tables: &[Table], points: Option<usize>) -> Result<Self, Error> {
        let tree = Tree::new(&mover.model);
        let bound = bind(&mover.model, &tree, tables)?;
        let factors = mover.thrust_factor.iter().copied().enumerate();
        let vehicle = CompletedVehicle {
            bodies: mover.bodies.clone(),
            spin_inertia: Vec::new(),
            thrust_factor: factors.collect(),
        };
        let problem = bound.problem(&mover.model, &tree);
        Ok(Self {
            found: held_back(&problem, &vehicle, points)?,
            repairs: bound.repairs,
        })
    }

    /// Chi-square per degree of freedom, largest over the segments; infinite if an initial state could not be fitted.
    pub fn chi2_per_dof(&self) -> f64 {
        let all = self.found.fit.iter().map(|f| f.chi2_per_dof);
        match self.found.converged {
            true => all.fold(0.0, f64::max),
            false => f64::INFINITY,
        }
    }

    /// Whether the chi-square of a segment is significantly larger than noise explains.
    pub fn beyond_noise(&self) -> bool {
        !self.found.converged || self.found.fit.iter().any(beyond_noise)
    }

    /// Findings of the residuals, and whether the initial state could be fitted.
    pub fn warnings(&self) -> Vec<String> {
        let unfit = "the initial state of the record could not be fitted: its end cannot be tested";
        let unfit = (!self.found.converged).then(|| unfit.to_owned());
        self.found.findings.iter().cloned().chain(unfit).collect()
    }

    /// One entry per quantity and segment.
    pub fn compared(&self) -> Vec<Compared> {
        let found = &self.found;
        let segments = found.fit.iter().zip(&found.worst).zip(&found.predictions);
        let many = found.fit.len() > 1;
        segments
            .flat_map(|((fit, worst), prediction)| of_segment(fit, worst, prediction, many))
            .collect()
    }
}

/// Whether a segment fits worse than noise 10 % larger than declared, with a p-value below 1e-6.
fn beyond_noise(fit: &SegmentFit) -> bool {
    let octaves = fit.channels.iter().flat_map(|c| &c.octaves);
    let numbers = octaves.map(|o| o.numbers).sum::<usize>() as f64;
    let chance =
        ChiSquared::new(numbers.max(1.0)).map_or(1.0, |c| c.sf(fit.chi2_per_dof * numbers));
    fit.chi2_per_dof.is_nan() || fit.chi2_per_dof > ALLOWED && chance < BY_CHANCE
}

fn of_segment(
    fit: &SegmentFit,
    worst: &[f64],
    prediction: &Prediction,
    many: bool,
) -> Vec<Compared> {
    let curves = |name: &str| prediction.channels.iter().find(|c| c.name == name);
    let channels = fit.channels.iter().zip(worst);
    channels
        .filter_map(|(channel, worst)| {
            let mut one = of_curves(curves(&channel.name)?);
            if many {
                one.file.quantity = format!("{} of {}", channel.name, fit.label);
            }
            one.file.sigmas = channel.chi2_per_number.map(|chi2| InSigmasFile {
                rms: chi2.sqrt(),
                largest: *worst,
                whiteness_p: channel.whiteness_p,
            });
            Some(one)
        })
        .collect()
}

/// Report curves are measured minus predicted; here the sign is reversed.
fn of_curves(curves: &PredictedChannel) -> Compared {
    let same = curves.residual.len() == curves.components.len();
    let negative = |row: &Vec<f64>| row.iter().map(|x| -x).collect();
    let compared = Compared {
        file: ComparedQuantityFile {
            quantity: curves.name.clone(),
            unit: curves.residual_unit.clone(),
            ..ComparedQuantityFile::default()
        },
        time_s: curves.time_s.clone(),
        components: curves.components.clone(),
        model: curves.predicted.clone(),
        against: curves.measured.clone(),
        difference_components: match same {
            true => curves.components.clone(),
            false => turn_names(),
        },
        difference: curves.residual.iter().map(negative).collect(),
    };
    compared.measured()
}
