//! Compares a vehicle with telemetry: its motion in a case, or a held-back record.

use super::Mover;
use super::compared::Compared;
use super::motion::{scenario, turn};
use crate::bind::bind;
use crate::case::Case;
use crate::channel_names::names;
use crate::error::Error;
use crate::simulate::perfect_table;
use nalgebra::Quaternion;
use poinsot_dynamics::Tree;
use poinsot_files::Place;
use poinsot_formats::InSigmasFile;
use poinsot_identify::{
    CompletedVehicle, HeldBack, PredictedChannel, Prediction, SegmentFit, held_back,
};
use poinsot_model::{JointKind, Model, Sensor, SensorKind, printed_unit};
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_telemetry::{Channel, Table};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Largest number of points of a curve of held-back telemetry.
const POINTS: usize = 100_000;

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
/// let gyro = compared.iter().find(|c| c.name == "gyro").unwrap();
/// // The difference is the noise.
/// assert!((gyro.sigmas.unwrap().rms - 1.0).abs() < 0.3);
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
    scenario.times = times;
    let exact = perfect_table(case, &mover.model, &mover.bodies, scenario)?;
    let list: Vec<Compared> = groups(&mover.model)
        .into_iter()
        .filter_map(|group| group.compare(&exact, table, case.duration_s))
        .collect();
    if list.is_empty() {
        return Err(Error::one(
            "E0703",
            Place::file(case.path()),
            "the telemetry has no attitude, rate, position, velocity, acceleration or joint sample during the case",
            "give telemetry with times from the start of the case",
        ));
    }
    Ok(list)
}

/// Channels compared together.
struct Group<'m> {
    name: String,
    unit: &'static str,
    channels: Vec<String>,
    sensor: Option<&'m Sensor>,
    /// Whether channels without a sensor name are its own.
    unnamed: bool,
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
        let slides = joint.kind == JointKind::Prismatic;
        for kind in [SensorKind::JointPosition, SensorKind::JointRate] {
            let what = match kind {
                SensorKind::JointRate => "rate of joint",
                _ => "joint",
            };
            list.push(Group {
                name: format!("{what} {}", joint.name),
                unit: printed_unit(kind.unit(slides)),
                channels: names(model, kind, &[k]),
                sensor: model.sensors_of(kind).find(|s| s.of.contains(&k)),
                unnamed: true,
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
    };
    let all: Vec<&Sensor> = model.sensors_of(kind).collect();
    let first = all.iter().position(|s| s.body == 0);
    match all.as_slice() {
        [] => vec![group(None, kind.word().to_owned(), true)],
        [one] => vec![group(Some(*one), kind.word().to_owned(), true)],
        _ => {
            let named = all.iter().enumerate().map(|(k, sensor)| {
                let name = format!("{} {}", kind.word(), sensor.name);
                group(Some(*sensor), name, first == Some(k))
            });
            named.collect()
        }
    }
}

/// Values at the wanted times; both lists ascend, and every wanted time exists.
fn at(channel: &Channel, wanted: &[f64]) -> Vec<f64> {
    let index = |t: &f64| channel.time_s.partition_point(|own| own < t);
    let value = |i: usize| channel.values.get(i).copied().unwrap_or(f64::NAN);
    wanted.iter().map(|t| value(index(t))).collect()
}

impl Group<'_> {
    fn find<'t>(&self, table: &'t Table, name: &str) -> Option<&'t Channel> {
        let own = self
            .sensor
            .and_then(|s| table.sensor_channel(&s.name, name));
        own.or_else(|| table.channel(name).filter(|_| self.unnamed))
    }

    fn compare(&self, exact: &Table, measured: &Table, until: f64) -> Option<Compared> {
        let of = |table| {
            let found = self.channels.iter().map(|name| self.find(table, name));
            found.collect::<Option<Vec<&Channel>>>()
        };
        let (found, computed) = (of(measured)?, of(exact)?);
        let has = |c: &&Channel, t: &f64| c.time_s.binary_search_by(|own| own.total_cmp(t)).is_ok();
        let together = |t: &f64| (0.0..=until).contains(t) && found.iter().all(|c| has(c, t));
        let times = found.first()?.time_s.iter().copied();
        let times: Vec<f64> = times.filter(together).collect();
        if times.is_empty() {
            return None;
        }
        let model: Vec<Vec<f64>> = computed.iter().map(|c| at(c, &times)).collect();
        let against: Vec<Vec<f64>> = found.iter().map(|c| at(c, &times)).collect();
        let (difference_components, difference) = if self.channels.len() == 4 {
            let turn = |k| turn(&quaternion(&against, k), &quaternion(&model, k));
            let turns: Vec<Vector3> = (0..times.len()).map(turn).collect();
            let row = |k| turns.iter().map(|v| v[k]).collect();
            let names = ["turn_x", "turn_y", "turn_z"].map(str::to_owned).to_vec();
            (names, (0..3).map(row).collect::<Vec<Vec<f64>>>())
        } else {
            let rows = model.iter().zip(&against);
            let rows = rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect());
            (self.channels.clone(), rows.collect())
        };
        let compared = Compared {
            name: self.name.clone(),
            unit: self.unit,
            time_s: times,
            components: self.channels.clone(),
            model,
            against,
            sigmas: self.sigmas(&difference),
            difference_components,
            difference,
            ..Compared::default()
        };
        Some(compared.measured())
    }

    /// Differences in units of the declared noise including rounding, per axis.
    fn sigmas(&self, difference: &[Vec<f64>]) -> Option<InSigmasFile> {
        let sensor = self.sensor?;
        let covariance = sensor.noise_covariance.unwrap_or_default();
        let step = sensor.quantisation * sensor.quantisation / 12.0;
        let (mut square, mut count, mut largest) = (0.0, 0_usize, 0.0_f64);
        for (k, row) in difference.iter().enumerate() {
            let axis = if sensor.kind.is_scalar() { 0 } else { k };
            let sigma = (covariance[(axis, axis)] + step).sqrt();
            if sigma <= 0.0 {
                return None;
            }
            count += row.len();
            for x in row {
                square += (x / sigma).powi(2);
                largest = largest.max((x / sigma).abs());
            }
        }
        Some(InSigmasFile {
            rms: (square / count.max(1) as f64).sqrt(),
            largest,
            whiteness_p: None,
        })
    }
}

fn quaternion(rows: &[Vec<f64>], k: usize) -> UnitQuaternion {
    let part = |row: usize| {
        let x = rows.get(row).and_then(|r| r.get(k));
        x.copied().unwrap_or(f64::NAN)
    };
    UnitQuaternion::new_normalize(Quaternion::new(part(3), part(0), part(1), part(2)))
}

/// Chi-square per degree of freedom of noise 10 % larger than declared, the usual accuracy of a declaration.
const ALLOWED: f64 = 1.21;
/// p-value below which a misfit counts.
const BY_CHANCE: f64 = 1.0e-6;

/// Results of the comparison with held-back telemetry.
pub struct HeldBackFindings {
    /// One entry per quantity and segment.
    pub compared: Vec<Compared>,
    /// Chi-square per degree of freedom, largest over the segments.
    pub chi2_per_dof: f64,
    /// Whether the chi-square of a segment is significantly larger than noise explains.
    pub beyond_noise: bool,
    /// Findings of the residuals, and whether the initial state could be fitted.
    pub warnings: Vec<String>,
    /// Assumptions of reading and binding.
    pub repairs: Vec<String>,
}

/// Compares telemetry with the prediction of the vehicle. Pose, momentum and declared nuisance parameters of the
/// record are fitted, but no number of the vehicle.
///
/// # Errors
/// Model and telemetry do not match.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::validate::{Mover, compare_held_back};
///
/// let table = simulate::simulate_case(&case, &model)?.table;
/// let found = compare_held_back(&Mover::of_model(model), &[table])?;
/// assert!(!found.beyond_noise && (found.chi2_per_dof - 1.0).abs() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_held_back(mover: &Mover, tables: &[Table]) -> Result<HeldBackFindings, Error> {
    let (found, bound) = look(mover, tables, Some(POINTS))?;
    let mut warnings = found.findings.clone();
    if !found.converged {
        warnings.push(
            "the initial state of the record could not be fitted: its end cannot be tested"
                .to_owned(),
        );
    }
    let mut repairs: Vec<String> = tables.iter().flat_map(|t| t.repairs.clone()).collect();
    repairs.extend(bound);
    Ok(HeldBackFindings {
        compared: compared(&found),
        chi2_per_dof: worst(&found),
        beyond_noise: !found.converged || found.fit.iter().any(beyond_noise),
        warnings,
        repairs,
    })
}

/// Chi-square per degree of freedom only, largest over the segments.
pub(super) fn held_back_chi2(mover: &Mover, tables: &[Table]) -> Result<f64, Error> {
    Ok(worst(&look(mover, tables, None)?.0))
}

/// Whether a segment fits worse than noise 10 % larger than declared, with a p-value below 1e-6.
fn beyond_noise(fit: &SegmentFit) -> bool {
    let octaves = fit.channels.iter().flat_map(|c| &c.octaves);
    let numbers = octaves.map(|o| o.numbers).sum::<usize>() as f64;
    let chance =
        ChiSquared::new(numbers.max(1.0)).map_or(1.0, |c| c.sf(fit.chi2_per_dof * numbers));
    fit.chi2_per_dof.is_nan() || fit.chi2_per_dof > ALLOWED && chance < BY_CHANCE
}

/// Infinite if the initial state of a record could not be fitted.
fn worst(found: &HeldBack) -> f64 {
    let chi2 = found.fit.iter().map(|f| f.chi2_per_dof).fold(0.0, f64::max);
    if found.converged { chi2 } else { f64::INFINITY }
}

/// The comparison, with the assumptions of binding.
fn look(
    mover: &Mover,
    tables: &[Table],
    points: Option<usize>,
) -> Result<(HeldBack, Vec<String>), Error> {
    let tree = Tree::new(&mover.model);
    let bound = bind(&mover.model, &tree, tables)?;
    let factors = mover.thrust_factor.iter().copied().enumerate();
    let vehicle = CompletedVehicle {
        bodies: mover.bodies.clone(),
        spin_inertia: Vec::new(),
        thrust_factor: factors.collect(),
    };
    let problem = bound.problem(&mover.model, &tree);
    Ok((held_back(&problem, &vehicle, points)?, bound.repairs))
}

fn compared(found: &HeldBack) -> Vec<Compared> {
    let segments = found.fit.iter().zip(&found.worst).zip(&found.predictions);
    let many = found.fit.len() > 1;
    segments
        .flat_map(|((fit, worst), prediction)| of_segment(fit, worst, prediction, many))
        .collect()
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
                one.name = format!("{} of {}", channel.name, fit.label);
            }
            one.sigmas = channel.chi2_per_number.map(|chi2| InSigmasFile {
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
    let own = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
    let same = curves.residual.len() == curves.components.len();
    let turn = ["turn_x", "turn_y", "turn_z"];
    let negative = |row: &Vec<f64>| row.iter().map(|x| -x).collect();
    let compared = Compared {
        name: curves.name.clone(),
        unit: curves.residual_unit,
        time_s: curves.time_s.clone(),
        components: own(&curves.components),
        model: curves.predicted.clone(),
        against: curves.measured.clone(),
        difference_components: own(if same {
            &curves.components[..]
        } else {
            &turn[..]
        }),
        difference: curves.residual.iter().map(negative).collect(),
        ..Compared::default()
    };
    compared.measured()
}
