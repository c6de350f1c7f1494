//! One mistake: in a known number of the model, or in the telemetry.

use super::Vehicle;
use poinsot_model::{KnownNumber, Model, Origin};
use poinsot_telemetry::{Channel, Table};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// What is known of a mistake before anything is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Within two sigmas of what is declared: intervals must cover it.
    Covered,
    /// Nothing is wrong with what is left.
    Harmless,
    Visible,
    Invisible,
}

impl Class {
    pub fn words(self) -> &'static str {
        match self {
            Self::Covered => "covered",
            Self::Harmless => "harmless",
            Self::Visible => "visible",
            Self::Invisible => "invisible",
        }
    }
}

/// Declared sigmas that intervals must cover.
const COVERED: f64 = 2.0;
/// Range of a known number's error, sigmas of a drawing.
const KNOWN: [f64; 2] = [0.3, 30.0];
/// Range of a share of a column.
const SHARE: [f64; 2] = [1.0e-4, 0.3];
/// Range of an error in the root mean square of a column.
const ADDED: [f64; 2] = [1.0e-4, 0.3];
/// Range of a lag, sampling intervals.
const LAG: [f64; 2] = [0.01, 3.0];
/// Range of what noise is multiplied by.
const NOISE: [f64; 2] = [1.5, 5.0];
/// Range of the share of samples that are lost or wrong.
const LOST: [f64; 2] = [0.01, 0.5];

/// What is done to a group of columns that one sensor gives.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Scale,
    Bias,
    Drift,
    Lag,
    Reverse,
    Degrees,
    Exchange,
    Noise,
    Lost,
    Outliers,
    Stuck,
    Rounded,
}

const WAYS: [Way; 12] = [
    Way::Scale,
    Way::Bias,
    Way::Drift,
    Way::Lag,
    Way::Reverse,
    Way::Degrees,
    Way::Exchange,
    Way::Noise,
    Way::Lost,
    Way::Outliers,
    Way::Stuck,
    Way::Rounded,
];

enum Mistake {
    /// A component of a known number, in sigmas of a drawing.
    Known(KnownNumber, usize, f64),
    /// Something done to the columns of a sensor, or to one of them, by a size.
    Columns(Way, String, Option<usize>, f64),
}

pub struct Mutation<'a> {
    pub vehicle: &'a Vehicle,
    mistake: Mistake,
}

impl<'a> Mutation<'a> {
    pub fn draw(all: &'a [Vehicle], rng: &mut ChaCha8Rng) -> Self {
        let vehicle = &all[pick(rng, all.len())];
        let model = &vehicle.study.model;
        let known: Vec<KnownNumber> = model.uncertain().map(|u| u.number).collect();
        // As many mistakes in the model as in the telemetry; force and mounting are no numbers of a model.
        let numbers: Vec<KnownNumber> = known
            .into_iter()
            .filter(|n| !matches!(n, KnownNumber::Force(_) | KnownNumber::Mounting(_)))
            .collect();
        let mistake = match rng.random::<bool>() && !numbers.is_empty() {
            true => {
                let number = numbers[pick(rng, numbers.len())];
                let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
                let component = pick(rng, number.components());
                Mistake::Known(number, component, sign * within(KNOWN, rng))
            }
            false => {
                let groups = groups(&vehicle.study.exact[0]);
                let group = groups[pick(rng, groups.len())].clone();
                let way = WAYS[pick(rng, WAYS.len())];
                let range = match way {
                    Way::Scale => SHARE,
                    Way::Bias | Way::Drift | Way::Rounded => ADDED,
                    Way::Lag => LAG,
                    Way::Noise => NOISE,
                    Way::Lost | Way::Outliers | Way::Stuck => LOST,
                    Way::Reverse | Way::Degrees | Way::Exchange => [1.0, 1.0],
                };
                // All columns of a sensor have one clock, one unit, one noise.
                let alone = matches!(way, Way::Scale | Way::Bias | Way::Drift | Way::Reverse);
                let one = alone && rng.random::<bool>();
                let at = one.then(|| rng.random_range(0..3));
                Mistake::Columns(way, group, at, within(range, rng))
            }
        };
        Self { vehicle, mistake }
    }

    pub fn kind(&self) -> &'static str {
        match &self.mistake {
            Mistake::Known(number, ..) => match number {
                KnownNumber::Mass(_) => "known mass",
                KnownNumber::MassCentre(_) => "known mass centre",
                KnownNumber::Inertia(_) => "known inertia",
                KnownNumber::SpinInertia(_) => "spin inertia",
                KnownNumber::WheelAxis(_) => "wheel axis",
                KnownNumber::JointOrigin(_) => "joint origin",
                KnownNumber::JointAxis(_) => "joint axis",
                KnownNumber::ForceDirection(_) => "thruster direction",
                KnownNumber::ForcePosition(_) => "thruster position",
                KnownNumber::SpecificImpulse(_) => "specific impulse",
                KnownNumber::PropellantPlace(_) => "propellant place",
                KnownNumber::Force(_) | KnownNumber::Mounting(_) => "reading",
            },
            Mistake::Columns(way, ..) => match way {
                Way::Scale => "scale",
                Way::Bias => "offset",
                Way::Drift => "drift",
                Way::Lag => "lag",
                Way::Reverse => "sign",
                Way::Degrees => "degrees for radians",
                Way::Exchange => "two columns exchanged",
                Way::Noise => "more noise than declared",
                Way::Lost => "samples lost",
                Way::Outliers => "outliers",
                Way::Stuck => "stuck",
                Way::Rounded => "rounded",
            },
        }
    }

    /// Name of the known number that is wrong.
    pub fn known_name(&self) -> Option<String> {
        match &self.mistake {
            Mistake::Known(number, component, _) => {
                Some(number.name(&self.vehicle.study.model, *component))
            }
            Mistake::Columns(..) => None,
        }
    }

    pub fn words(&self) -> String {
        match &self.mistake {
            Mistake::Known(_, _, sigmas) => {
                format!(
                    "{} {sigmas:.2} sigma off",
                    self.known_name().unwrap_or_default()
                )
            }
            Mistake::Columns(_, group, at, size) => {
                let at = at.map_or_else(String::new, |k| format!(" column {k}"));
                format!("{} of {group}{at}, {size:.3e}", self.kind())
            }
        }
    }

    pub fn class_by_size(&self) -> Option<Class> {
        match &self.mistake {
            Mistake::Known(_, _, sigmas) => (sigmas.abs() <= COVERED).then_some(Class::Covered),
            Mistake::Columns(Way::Lost, ..) => Some(Class::Harmless),
            // No sample without noise shows it.
            Mistake::Columns(Way::Noise, ..) => Some(Class::Visible),
            Mistake::Columns(..) => None,
        }
    }

    /// Makes the mistake: in the tables, or in the model that is returned.
    pub fn apply(&self, tables: &mut [Table], rng: &mut ChaCha8Rng) -> Model {
        let nominal = &self.vehicle.study.model;
        let mut model = nominal.clone();
        match &self.mistake {
            Mistake::Known(number, component, sigmas) => {
                let sigma = number.usual_sigma(Origin::Cad);
                let change = sigmas * number.absolute(nominal, *component, sigma);
                number.shift(nominal, &mut model, *component, change);
            }
            Mistake::Columns(way, group, at, size) => {
                for (table, exact) in tables.iter_mut().zip(&self.vehicle.study.exact) {
                    spoil(table, exact, (*way, group), (*at, *size), rng);
                }
            }
        }
        model
    }
}

fn pick(rng: &mut ChaCha8Rng, count: usize) -> usize {
    rng.random_range(0..count)
}

/// Evenly in its logarithm.
fn within([low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

/// What columns of one sensor have in common: `omega_`, `q_`, `sun direction_`, `wheel2_rad_s`.
fn group_of(channel: &Channel) -> String {
    let name = channel.name.as_str();
    let own = ["omega_", "q_", "v_", "r_", "direction_"];
    let found = own.into_iter().find(|prefix| name.starts_with(prefix));
    let group = found.unwrap_or(name);
    format!("{} {group}", channel.sensor)
        .trim_start()
        .to_owned()
}

fn groups(table: &Table) -> Vec<String> {
    let mut list: Vec<String> = Vec::new();
    for channel in &table.channels {
        let name = group_of(channel);
        if !list.contains(&name) {
            list.push(name);
        }
    }
    list
}

fn spoil(
    table: &mut Table,
    exact: &Table,
    (way, group): (Way, &str),
    (at, size): (Option<usize>, f64),
    rng: &mut ChaCha8Rng,
) {
    let places: Vec<usize> = (0..table.channels.len())
        .filter(|k| group_of(&table.channels[*k]) == group)
        .collect();
    let times = Arc::clone(&table.channels[places[0]].time_s);
    let samples = times.len();
    let sizes = places.iter().map(|k| rms(&exact.channels[*k].values));
    let largest = sizes.fold(0.0, f64::max);
    match way {
        Way::Exchange => exchange(table, &places),
        Way::Lost => {
            let keep: Vec<bool> = (0..samples).map(|_| rng.random::<f64>() > size).collect();
            let left = |x: &[f64]| -> Vec<f64> {
                let pairs = x.iter().zip(&keep);
                pairs.filter(|p| *p.1).map(|p| *p.0).collect()
            };
            for k in places {
                let c = &mut table.channels[k];
                c.values = left(&c.values);
                c.time_s = left(&times).into();
            }
        }
        Way::Outliers => {
            let wrong: Vec<f64> = (0..samples)
                .map(|_| match rng.random::<f64>() < 0.1 * size {
                    true => rng.random::<f64>() - 0.5,
                    false => 0.0,
                })
                .collect();
            for k in places {
                let pairs = table.channels[k].values.iter_mut().zip(&wrong);
                pairs.for_each(|(x, e)| *x += e * largest);
            }
        }
        _ => {
            let one = at.map(|k| vec![places[k % places.len()]]);
            for k in one.unwrap_or(places) {
                let exact = &exact.channels[k].values;
                spoil_alone(&mut table.channels[k], exact, way, size, largest);
            }
        }
    }
}

/// Exchanges the first two columns of a sensor, or its only one with another of the same unit.
fn exchange(table: &mut Table, places: &[usize]) {
    let first = &table.channels[places[0]];
    let alike = |k: &usize| {
        let c = &table.channels[*k];
        !places.contains(k) && c.unit == first.unit && c.values.len() == first.values.len()
    };
    let other = (0..table.channels.len()).find(alike);
    if let Some(second) = places.get(1).copied().or(other) {
        let values = std::mem::take(&mut table.channels[places[0]].values);
        let values = std::mem::replace(&mut table.channels[second].values, values);
        table.channels[places[0]].values = values;
    }
}

fn spoil_alone(c: &mut Channel, exact: &[f64], way: Way, size: f64, largest: f64) {
    let (first, last) = (c.time_s[0], c.time_s[c.time_s.len() - 1]);
    let (span, samples) = (last - first, c.values.len());
    let added = size * largest;
    for (i, x) in c.values.iter_mut().enumerate() {
        let noise = *x - exact.get(i).copied().unwrap_or(*x);
        match way {
            Way::Scale => *x *= 1.0 + size,
            Way::Bias => *x += added,
            Way::Drift => *x += added * (c.time_s[i] - first) / span,
            Way::Reverse => *x = -*x,
            Way::Degrees => *x = x.to_degrees(),
            Way::Noise => *x += (size - 1.0) * noise,
            Way::Rounded => *x = (*x / added).round() * added,
            _ => {}
        }
    }
    if way == Way::Lag {
        let late = size * span / samples.max(2) as f64;
        c.time_s = c.time_s.iter().map(|t| t + late).collect();
    }
    if way == Way::Stuck {
        let from = ((1.0 - size) * samples as f64) as usize;
        let from = from.min(samples - 1);
        let held = c.values[from];
        c.values[from..].fill(held);
    }
}

fn rms(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|x| x * x).sum();
    (squares / values.len().max(1) as f64).sqrt()
}
