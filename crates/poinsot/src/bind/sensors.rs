//! Three-axis sensors: their columns and samples on the grid. Any number of each kind, on any body.

use crate::channel_names::axes;
use nalgebra::Quaternion;
use poinsot_identify::{SensorRecord, SensorSample, SensorValue};
use poinsot_model::{Model, Sensor, SensorKind, SlowError};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use poinsot_telemetry::{Channel, Table, median_step, resample};

/// Half-width of the polynomial that differentiates a channel, in samples: a quartic through five.
pub(super) const HALF_WIDTH: usize = 2;
/// Times closer than this are equal, s.
pub(super) const SAME: f64 = 1.0e-9;

/// Longest interval of an increment relative to the usual one; if it is longer, the previous sample is missing.
const WHOLE_INTERVAL: f64 = 1.5;

/// White noise, in steps, above which rounding errors are independent even at rest.
const DITHER: f64 = 0.25;
/// Fraction of a step within which two samples count as equal.
const ONE_LEVEL: f64 = 0.9;
/// Columns of the vector in N whose direction a sensor measures.
pub(super) const REFERENCE: &str = "reference";

/// Values of a channel at some times; `None` without a sample.
pub(super) type Column = Vec<Option<f64>>;
/// The attitude of a quaternion of any length, scalar last.
pub(super) fn rotation([x, y, z, w]: [f64; 4]) -> UnitQuaternion {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// Three columns as vectors.
pub(super) fn vectors([x, y, z]: &[Column; 3]) -> Vec<Option<Vector3>> {
    let all = x.iter().zip(y).zip(z);
    all.map(|((x, y), z)| Some(Vector3::new((*x)?, (*y)?, (*z)?)))
        .collect()
}

/// Place of a time among increasing ones.
fn place(times: &[f64], t: f64) -> Option<usize> {
    let k = times.partition_point(|own| *own < t - SAME);
    times.get(k).filter(|own| (*own - t).abs() <= SAME)?;
    Some(k)
}

/// The samples of a channel at grid times; `None` elsewhere.
pub(super) fn own_values(channel: &Channel, grid: &[f64]) -> Vec<Option<f64>> {
    let own = |t: &f64| channel.values.get(place(&channel.time_s, *t)?).copied();
    grid.iter().map(own).collect()
}

pub(super) struct SensorColumns<'a> {
    /// Index in the model; `None` for an undeclared attitude sensor.
    pub sensor: Option<usize>,
    pub kind: SensorKind,
    /// Three axes, or four quaternion components.
    pub parts: Vec<&'a Channel>,
    /// Reference vector in N, if telemetry has it.
    pub reference: Option<[&'a Channel; 3]>,
    /// Times at which every part has a sample, s.
    time_s: Vec<f64>,
    /// Index of the sample in each part, at these times.
    at: Vec<[u32; 4]>,
}

/// The columns of a sensor with the times of their samples.
pub(super) fn columns_of<'a>(
    model: &Model,
    table: &'a Table,
    sensor: usize,
) -> Option<SensorColumns<'a>> {
    let of = &model.sensors[sensor];
    let parts = parts_of(model, table, sensor)?;
    let is_direction = of.kind == SensorKind::Direction;
    let reference = || axes(table, &of.name, REFERENCE).or_else(|| axes(table, "", REFERENCE));
    let reference = is_direction.then(reference).flatten();
    Some(SensorColumns {
        reference,
        ..SensorColumns::new(Some(sensor), of.kind, parts)
    })
}

/// The columns of a sensor. Columns without a sensor name belong to the only sensor of the kind without own columns.
pub(super) fn parts_of<'a>(
    model: &Model,
    table: &'a Table,
    sensor: usize,
) -> Option<Vec<&'a Channel>> {
    let of = &model.sensors[sensor];
    named(table, of.kind, &of.name).or_else(|| {
        let mut nameless = without_own(model, table, of.kind);
        match (nameless.next(), nameless.next()) {
            (Some(only), None) if only == sensor => named(table, of.kind, ""),
            _ => None,
        }
    })
}

pub(super) fn named<'a>(
    table: &'a Table,
    kind: SensorKind,
    sensor: &str,
) -> Option<Vec<&'a Channel>> {
    let find = |name: &&str| table.sensor_channel(sensor, name);
    kind.columns().iter().map(find).collect()
}

/// Sensors of a kind without columns of their own name.
pub(super) fn without_own<'a>(
    model: &'a Model,
    table: &'a Table,
    kind: SensorKind,
) -> impl Iterator<Item = usize> + 'a {
    let all = model.sensors.iter().enumerate();
    let own = all.filter(move |(_, s)| s.kind == kind);
    own.filter(move |(_, s)| named(table, kind, &s.name).is_none())
        .map(|(k, _)| k)
}

/// Every sensor with columns in a table, in an order independent of declaration order.
pub(super) fn sensor_columns<'a>(model: &Model, table: &'a Table) -> Vec<SensorColumns<'a>> {
    let mut all = Vec::new();
    for kind in SensorKind::with_axes() {
        let mut own: Vec<SensorColumns> = (0..model.sensors.len())
            .filter(|k| model.sensors[*k].kind == kind)
            .filter_map(|k| columns_of(model, table, k))
            .filter(|c| !c.time_s.is_empty())
            .collect();
        let name = |c: &SensorColumns| c.sensor.map(|k| model.sensors[k].name.as_str());
        own.sort_by(|a, b| name(a).cmp(&name(b)));
        if own.is_empty() && kind == SensorKind::Attitude && model.sensors_of(kind).next().is_none()
        {
            let parts = named(table, kind, "");
            own.extend(parts.map(|parts| SensorColumns::new(None, kind, parts)));
        }
        all.append(&mut own);
    }
    all
}

impl<'a> SensorColumns<'a> {
    /// A missing component drops the whole sample.
    fn new(sensor: Option<usize>, kind: SensorKind, parts: Vec<&'a Channel>) -> Self {
        let mut next = [0; 4];
        let times = parts.first().map_or(&[][..], |first| &first.time_s);
        let mut time_s = Vec::with_capacity(times.len());
        let mut at = Vec::with_capacity(times.len());
        for (i, t) in times.iter().enumerate() {
            next[0] = i;
            let complete = parts.iter().zip(&mut next).skip(1).all(|(part, next)| {
                let behind = |k: &usize| part.time_s.get(*k).is_some_and(|x| *x < t - SAME);
                while behind(next) {
                    *next += 1;
                }
                part.time_s.get(*next).is_some_and(|x| *x <= t + SAME)
            });
            if complete {
                time_s.push(*t);
                at.push(next.map(|k| k as u32));
            }
        }
        Self {
            sensor,
            kind,
            parts,
            reference: None,
            time_s,
            at,
        }
    }

    /// Times of the samples and of the starts of their intervals, s.
    pub fn times(&self) -> Vec<f64> {
        let own = self.time_s.iter().copied();
        own.chain(self.starts()).collect()
    }

    /// Start of the interval of each sample: the previous sample, or one step back if that is missing; none where a sample is of an
    /// instant.
    fn starts(&self) -> Vec<f64> {
        if self.kind != SensorKind::VelocityIncrement {
            return Vec::new();
        }
        let t = &self.time_s;
        let step = median_step(t).unwrap_or_default();
        (0..t.len())
            .map(|i| {
                let before = i.checked_sub(1).map(|b| t[b]);
                before
                    .filter(|b| t[i] - b <= WHOLE_INTERVAL * step)
                    .unwrap_or(t[i] - step)
            })
            .collect()
    }

    /// The samples at grid times; positions relative to `origin`.
    pub fn record(&self, model: &Model, grid: &[f64], origin: &Vector3) -> SensorRecord {
        let starts = self.starts();
        let declared = self.sensor.map(|k| &model.sensors[k]);
        let references = declared.map(|s| self.references(s)).unwrap_or_default();
        let mut samples = Vec::with_capacity(self.time_s.len());
        let own = self.time_s.iter().enumerate();
        samples.extend(own.filter_map(|(i, t)| {
            Some(SensorSample {
                from: place(grid, starts.get(i).copied().unwrap_or(*t))?,
                to: place(grid, *t)?,
                value: self.value(i, (origin, &references))?,
            })
        }));
        let noise = declared.and_then(covariance).unwrap_or_default();
        SensorRecord {
            sensor: self.sensor,
            body: declared.map_or(0, |s| s.body),
            seen_from: declared.map_or(0, |s| s.seen_from),
            p_BoS_B: declared.map_or_else(Vector3::zeros, |s| s.p_BoS_B),
            slow: declared.map_or_else(Vec::new, |s| {
                let turned = |slow: &SlowError| SlowError {
                    covariance: in_body(s, slow.covariance),
                    ..*slow
                };
                s.slow.iter().map(turned).collect()
            }),
            samples,
            name: declared.map_or_else(|| self.kind.word().to_owned(), |s| label(model, s)),
            // Samples are in body axes, but sensor errors are in sensor axes.
            ..SensorRecord::of_base(self.kind, declared.map_or(noise, |s| in_body(s, noise)))
        }
    }

    /// Directions measured on the base, each with its time and the vector in N.
    pub fn directions(&self, model: &Model) -> Vec<(f64, Vector3, Vector3)> {
        let declared = self.sensor.map(|k| &model.sensors[k]);
        let references = declared.map(|s| self.references(s)).unwrap_or_default();
        let origin = Vector3::zeros();
        let all = self.time_s.iter().enumerate();
        let seen = all.filter_map(|(i, t)| match self.value(i, (&origin, &references))? {
            SensorValue::Direction {
                seen_B,
                reference_N,
                ..
            } => Some((*t, seen_B, reference_N)),
            _ => None,
        });
        seen.collect()
    }

    /// The unit vector in N of each direction sample; empty for other kinds.
    fn references(&self, sensor: &Sensor) -> Vec<Option<Vector3>> {
        let unit = |v: Vector3| v.try_normalize(0.0);
        match (self.kind, sensor.reference_N, self.reference) {
            (SensorKind::Direction, Some(constant), _) => vec![Some(constant); self.time_s.len()],
            (SensorKind::Direction, None, Some(axes)) => {
                let all = vectors(&axes.map(|c| resample(c, &self.time_s, None)));
                all.into_iter().map(|v| unit(v?)).collect()
            }
            _ => Vec::new(),
        }
    }

    fn value(
        &self,
        i: usize,
        (origin, references): (&Vector3, &[Option<Vector3>]),
    ) -> Option<SensorValue> {
        let at = self.at.get(i)?;
        let part = |k: usize| self.parts.get(k)?.values.get(*at.get(k)? as usize).copied();
        let (x, y, z) = (part(0)?, part(1)?, part(2)?);
        Some(match self.kind {
            kind if kind.is_rotation() => SensorValue::Attitude(rotation([x, y, z, part(3)?])),
            SensorKind::Position => SensorValue::Vector(Vector3::new(x, y, z) - origin),
            SensorKind::Direction => SensorValue::direction(
                Vector3::new(x, y, z).try_normalize(0.0)?,
                (*references.get(i)?)?,
            ),
            _ => SensorValue::Vector(Vector3::new(x, y, z)),
        })
    }
}

/// Name of a sensor in results: its kind, followed by its name if several share the kind.
fn label(model: &Model, sensor: &Sensor) -> String {
    match model.sensors_of(sensor.kind).nth(1) {
        None => sensor.kind.word().to_owned(),
        Some(_) => format!("{}.{}", sensor.kind.word(), sensor.name),
    }
}

/// A covariance in a sensor's axes in those of its samples.
fn in_body(sensor: &Sensor, covariance: Matrix3) -> Matrix3 {
    match sensor.turns() {
        true => sensor.R_BS * covariance * sensor.R_BS.transpose(),
        false => covariance,
    }
}

/// Declared covariance of a sensor's samples including rounding; `None` if neither is declared.
pub(crate) fn covariance(sensor: &Sensor) -> Option<Matrix3> {
    let step = sensor.quantisation * sensor.quantisation / 12.0;
    match sensor.covariance() {
        Some(c) => Some(c + Matrix3::identity() * step),
        None => (step > 0.0).then(|| Matrix3::identity() * step),
    }
}

/// The base sensors used for the aligned samples of the linear method, one of each kind.
pub(super) struct BaseSensors<'m> {
    pub model: &'m Model,
    of: Vec<(SensorKind, usize)>,
}

impl<'m> BaseSensors<'m> {
    /// For each kind, the sensor present in most tables, then one on the base, then that with the most samples per variance. Of gyros and
    /// attitudes, one on a link where none is on the base.
    pub fn new(model: &'m Model, tables: &[Table]) -> Self {
        let worth = |k: usize| {
            let lengths = tables.iter().filter_map(|t| columns_of(model, t, k));
            let lengths: Vec<usize> = lengths.map(|c| c.time_s.len()).collect();
            let variance = covariance(&model.sensors[k]).map_or(0.0, |c| c.trace());
            let samples = lengths.iter().sum::<usize>() as f64;
            (lengths.len(), samples / variance)
        };
        let best = |kind: SensorKind| {
            let all = model.sensors.iter().enumerate();
            let turns = matches!(kind, SensorKind::Gyro | SensorKind::Attitude);
            let own = all.filter(|(_, s)| s.kind == kind && (s.body == 0 || turns));
            own.map(|(k, s)| (k, (s.body == 0, worth(k)), &s.name))
                .max_by(|a, b| {
                    let (own, other) = (a.1, b.1);
                    let tables = own.1.0.cmp(&other.1.0);
                    let order = tables.then(own.0.cmp(&other.0));
                    let order = order.then(own.1.1.total_cmp(&other.1.1));
                    order.then_with(|| b.2.cmp(a.2))
                })
        };
        let of = SensorKind::with_axes().filter_map(|kind| Some((kind, best(kind)?.0)));
        Self {
            model,
            of: of.collect(),
        }
    }

    /// Index in the model.
    pub fn index(&self, kind: SensorKind) -> Option<usize> {
        self.of.iter().find(|l| l.0 == kind).map(|l| l.1)
    }

    /// Its columns; columns without a sensor name if the model declares no such sensor.
    pub fn columns<'a>(&self, table: &'a Table, kind: SensorKind) -> Option<Vec<&'a Channel>> {
        let model = self.model;
        match self.index(kind) {
            Some(sensor) => parts_of(model, table, sensor),
            None if model.sensors_of(kind).next().is_none() => named(table, kind, ""),
            None => None,
        }
    }

    pub fn sensor(&self, kind: SensorKind) -> Option<&'m Sensor> {
        self.index(kind).map(|k| &self.model.sensors[k])
    }
}

/// Whether the rounded position of a joint never changes: the joint is locked.
pub(super) fn is_locked(model: &Model, joint: usize, position: &Channel) -> bool {
    scalar_sensor(model, SensorKind::JointPosition, joint)
        .and_then(rounding)
        .is_some_and(|step| runs(&position.values, step).len() == 1)
}

/// The sensor of one number of a joint or wheel.
pub(super) fn scalar_sensor(model: &Model, kind: SensorKind, of: usize) -> Option<&Sensor> {
    model.sensors_of(kind).find(|s| s.of.contains(&of))
}

/// Rounding step of a sensor whose noise does not hide it.
pub(super) fn rounding(sensor: &Sensor) -> Option<f64> {
    let step = sensor.quantisation;
    let sigma = sensor.noise_covariance.map_or(0.0, |c| c[(0, 0)].sqrt());
    (step > 0.0 && sigma < DITHER * step).then_some(step)
}

/// First and last index of each run of equal samples.
pub(super) fn runs(values: &[f64], step: f64) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut from = 0;
    for k in 1..=values.len() {
        if k == values.len() || (values[k] - values[from]).abs() > ONE_LEVEL * step {
            found.push((from, k - 1));
            from = k;
        }
    }
    found
}
