//! Conventions of what two channels measure alike: attitude and gyro, an angle or a place and its rate, a position and a velocity, a
//! direction and the gyro. One search compares them in every reading.

mod change;
pub(crate) mod pairs;
pub(crate) mod reading;

pub(crate) use change::line;
pub use change::{Change, Line, Repair};

use crate::median::median_step;
use crate::{Axes, Channel, Dimension, Order, Sense, Table, classify, full_name};
use pairs::Pairs;
use poinsot_files::{Faults, Place, rounded};
use reading::{DECLARED, GyroUnit, Hypothesis};
use schemars::JsonSchema;
use serde::Serialize;

/// Factor by which another reading must fit better to contradict the declared one.
const DECISIVE: f64 = 5.0;
/// Fraction of the rate above which the residual means that a reading does not fit.
const EXPLAINED: f64 = 0.3;
/// Residuals below this fraction of the rate count as equal: the resolution of averaged rates.
const RESOLUTION: f64 = 1e-3;
/// Rotation, rad, below which attitudes differ by round-off only.
const ROUND_OFF: f64 = 1e-12;
/// Share of the rate of a direction in the body up to which the measured vector rests in inertial axes.
const AT_REST: f64 = 0.1;

/// What the comparison says about the declared reading.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", tag = "verdict")]
pub enum Verdict {
    /// No other reading fits clearly better.
    DeclaredFits,
    /// Another reading fits at least five times better.
    DeclaredContradicted,
    /// The data do not decide.
    Undecided {
        /// Why.
        reason: String,
    },
}

/// The comparison of one attitude with one gyro.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ConventionTest {
    /// The attitude channels, for example `q_x..q_w`.
    pub attitude: String,
    /// The gyro channels, for example `omega_x..z`.
    pub gyro: String,
    /// Intervals compared.
    pub intervals: usize,
    /// Root mean square of the body rate from the attitude as declared, rad/s.
    pub rate_rad_s: f64,
    /// Least-squares factor gyro to attitude rate as declared; 1 where both agree, 0.01745 where the gyro is deg/s, 0.001 where the times are ms.
    pub scale: f64,
    /// The declared reading.
    pub declared: Hypothesis,
    /// The four different readings of the quaternion, with gyro unit and axes as declared.
    pub attitude_readings: Vec<Hypothesis>,
    /// The units of the gyro, with all else as declared.
    pub gyro_units: Vec<Hypothesis>,
    /// The simplest of the readings that fit best.
    pub best: Hypothesis,
    /// The reading that no motion can tell from the best: exchanging order and sense together only turns the body's
    /// and the inertial axes by fixed rotations that permute axes.
    pub twin: Option<Hypothesis>,
    /// Others that fit as well as the best: this motion cannot tell them apart.
    pub as_good: Vec<Hypothesis>,
    /// The verdict on the declared reading.
    pub verdict: Verdict,
}

/// Two measurements of one motion that contradict each other as they are declared.
#[derive(Debug, Clone, PartialEq)]
pub struct Contradiction {
    /// The channels.
    pub between: [String; 2],
    /// In words, with the reading that fits best.
    pub problem: String,
    /// Repairs after which both agree, the simplest first. Each is a list of changes that belong together.
    pub ways: Vec<Vec<Repair>>,
}

/// What a search over readings finds.
struct Search {
    declared: Hypothesis,
    /// Those that fit best, the simplest first.
    good: Vec<Hypothesis>,
    verdict: Verdict,
}

/// Compares readings of a motion with this root mean square of the rate, rad/s.
fn search(all: Vec<Hypothesis>, rate: f64, still: bool) -> Option<Search> {
    let declared = *all.iter().find(|h| h.is_declared())?;
    let level = |h: &Hypothesis| h.residual_rad_s.max(RESOLUTION * rate);
    let lowest = all.iter().map(level).fold(f64::INFINITY, f64::min);
    let mut good = all;
    good.retain(|h| level(h) <= 1.5 * lowest);
    good.sort_by(|a, b| {
        (a.departures().cmp(&b.departures())).then(a.residual_rad_s.total_cmp(&b.residual_rad_s))
    });
    let undecided = |reason: &str| Verdict::Undecided {
        reason: reason.to_owned(),
    };
    let verdict = if still {
        undecided("the attitude does not move")
    } else if lowest > EXPLAINED * rate {
        undecided(
            "motion too small, or attitude and gyro too noisy: no convention explains the rates",
        )
    } else if level(&declared) >= DECISIVE * lowest {
        Verdict::DeclaredContradicted
    } else if level(&declared) <= 2.0 * lowest {
        Verdict::DeclaredFits
    } else {
        undecided("another convention fits better, but not clearly")
    };
    Some(Search {
        declared,
        good,
        verdict,
    })
}

const READINGS: [(Order, Sense); 4] = [
    (Order::Xyzw, Sense::BodyToInertial),
    (Order::Xyzw, Sense::InertialToBody),
    (Order::Wxyz, Sense::BodyToInertial),
    (Order::Wxyz, Sense::InertialToBody),
];

/// Compares an attitude with a gyro in body axes ([`mount`](crate::mount) turns one that is not). `None` if the channels of one
/// sensor have different times, or the sensors overlap in fewer than 8 intervals.
fn test_conventions(attitude: &[&Channel], gyro: &[&Channel]) -> Option<ConventionTest> {
    let pairs = Pairs::collect(attitude, gyro)?;
    let (q, w) = (attitude.first()?, gyro.first()?);
    let step_s = median_step(&w.time_s)?;
    let mut all = Vec::with_capacity(4 * GyroUnit::ALL.len() * 48);
    for (order, sense) in READINGS {
        let sums = pairs.sums(order, sense);
        for gyro_unit in GyroUnit::ALL {
            all.extend(Axes::all().map(|gyro_axes| Hypothesis {
                order,
                sense,
                gyro_unit,
                gyro_axes,
                residual_rad_s: sums.residual(gyro_unit.factor(step_s), gyro_axes),
            }));
        }
    }
    let only =
        |test: &dyn Fn(&Hypothesis) -> bool| all.iter().copied().filter(|h| test(h)).collect();
    let as_declared = |h: &Hypothesis| h.gyro_axes == Axes::IDENTITY;
    let attitude_readings = only(&|h| as_declared(h) && h.gyro_unit == GyroUnit::AsDeclared);
    let gyro_units =
        only(&|h| as_declared(h) && h.order == Order::Xyzw && h.sense == Sense::BodyToInertial);
    let sums = pairs.as_declared();
    let rate = sums.rate();
    let still = rate * pairs.longest_s() < ROUND_OFF;
    let Search {
        declared,
        mut good,
        verdict,
    } = search(all, rate, still)?;
    let best = *good.first()?;
    let is_twin = |h: &Hypothesis| {
        h.order != best.order
            && h.sense != best.sense
            && h.gyro_unit == best.gyro_unit
            && (h.residual_rad_s - best.residual_rad_s).abs() <= 1e-7 * (rate + best.residual_rad_s)
    };
    let twin = good.iter().position(is_twin).filter(|_| rate > 0.0);
    let twin = twin.map(|k| good.remove(k));
    Some(ConventionTest {
        attitude: format!("{}..q_w", full_name(&q.sensor, "q_x")),
        gyro: format!("{}..z", full_name(&w.sensor, "omega_x")),
        intervals: pairs.turns.len(),
        rate_rad_s: rate,
        scale: sums.along(Axes::IDENTITY) / sums.gg,
        declared,
        attitude_readings,
        gyro_units,
        best,
        twin,
        as_good: good.into_iter().skip(1).take(20).collect(),
        verdict,
    })
}

/// Tests every attitude against every gyro. A named sensor is compared with unnamed ones and with its own.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// // One attitude and one gyro: one comparison.
/// let channels = attitude.into_iter().chain(gyro(1.0)).collect();
/// let tests = convention_tests(&Table { channels, ..Table::default() });
/// assert_eq!(tests.len(), 1);
/// ```
pub fn convention_tests(table: &Table) -> Vec<ConventionTest> {
    let [attitudes, gyros] = ["q", "omega"].map(|prefix| table.vectors(prefix));
    let pairs = attitudes
        .iter()
        .flat_map(|q| gyros.iter().map(move |w| (q, w)));
    pairs
        .filter_map(|(q, w)| test_conventions(&table.at(q), &table.at(w)))
        .collect()
}

/// Tests one attitude sensor against one gyro by name (empty: unnamed). `None` if channels are missing or cannot be
/// compared.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// // The conjugate quaternions: inertial to body.
/// let mut channels: Vec<Channel> = attitude.into_iter().chain(gyro(1.0)).collect();
/// for channel in &mut channels[..3] {
///     channel.values.iter_mut().for_each(|q| *q = -*q);
/// }
/// let test = test_sensors(&Table { channels, ..Table::default() }, "", "").unwrap();
/// assert_eq!(test.best.sense, Sense::InertialToBody);
/// ```
pub fn test_sensors(table: &Table, attitude: &str, gyro: &str) -> Option<ConventionTest> {
    let attitude = table.vector(Some(attitude), "q")?;
    test_conventions(&attitude, &table.vector(Some(gyro), "omega")?)
}

/// Returns an error if two measurements of one motion clearly contradict each other.
///
/// Assumes that every gyro measures in body axes on the body of the attitude.
///
/// # Errors
/// E0215 names the convention that fits best.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// let table = |sign| Table {
///     channels: attitude.iter().cloned().chain(gyro(sign)).collect(),
///     ..Table::default()
/// };
/// assert!(check_conventions(&table(1.0)).is_ok());
/// // A gyro of opposite sense contradicts the attitude.
/// assert!(check_conventions(&table(-1.0)).is_err());
/// ```
pub fn check_conventions(table: &Table) -> Result<(), Faults> {
    match contradictions(table).first() {
        Some(first) => Err(first.fault()),
        None => Ok(()),
    }
}

/// What contradicts each other, with the repairs that would put it right.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// let channels = attitude.into_iter().chain(gyro(57.3)).collect();
/// let found = contradictions(&Table { channels, ..Table::default() });
/// let mut map = TelemetryMap::default();
/// let lines = found[0].ways[0][0].declare(&mut map).unwrap();
/// assert_eq!(lines[0].text, r#"omega_x = { column = "omega_x", unit = "deg/s" }"#);
/// ```
pub fn contradictions(table: &Table) -> Vec<Contradiction> {
    let tests = convention_tests(table);
    let mut all: Vec<Contradiction> = tests.iter().filter_map(|t| t.contradiction()).collect();
    all.extend(of_directions(table));
    all.extend(places(table).filter_map(|(place, rate)| of_place(&place, &rate)));
    all
}

impl Search {
    /// The simplest reading, where it contradicts the declared one.
    fn contradicting(&self) -> Option<&Hypothesis> {
        let contradicted = self.verdict == Verdict::DeclaredContradicted;
        self.good.first().filter(|_| contradicted)
    }
}

/// Directions that rest in inertial axes against the first gyro: they turn in the body by the opposite of its rate. The gyro may be in
/// another unit, and where several directions say the same, in other axes; else each direction may be in other axes of its sensor.
fn of_directions(table: &Table) -> Vec<Contradiction> {
    let Some(gyro) = table.vector(None, "omega") else {
        return Vec::new();
    };
    let channels = table.channels.iter().filter(|c| c.name == "direction_x");
    let resting =
        channels.filter_map(|c| Some((c.sensor.as_str(), resting(table, &c.sensor, &gyro)?)));
    let resting: Vec<(&str, Pairs)> = resting.collect();
    let mean_square = |of: &dyn Fn(&Pairs) -> f64| {
        let squares = resting.iter().map(|(_, pairs)| of(pairs).powi(2));
        (squares.sum::<f64>() / resting.len().max(1) as f64).sqrt()
    };
    let step_s = gyro.first().and_then(|c| median_step(&c.time_s));
    let read = |unit: GyroUnit, axes: Axes| {
        let rates = (axes, unit.factor(step_s.unwrap_or(1.0)));
        let residual = mean_square(&|pairs| pairs.turned(Axes::IDENTITY, rates));
        Hypothesis::of_rates(unit, axes, residual)
    };
    let units = GyroUnit::ALL.map(|unit| read(unit, Axes::IDENTITY));
    let axes = Axes::all().filter(|axes| *axes != Axes::IDENTITY && resting.len() > 1);
    let axes = axes.map(|axes| read(GyroUnit::AsDeclared, axes));
    let rate = mean_square(&|pairs| pairs.as_declared().rate());
    let names: Vec<String> = gyro.iter().map(|c| full_name(&c.sensor, &c.name)).collect();
    let all = resting.iter().map(|own| full_name(own.0, "direction_x..z"));
    let all = all.collect::<Vec<_>>().join(", ");
    let found = search(units.into_iter().chain(axes).collect(), rate, rate == 0.0);
    let words = |h: &Hypothesis| h.to_string();
    if let Some(found) = against_gyro(found, all, words, |h| h.repairs("", &names)) {
        return vec![found];
    }
    let each = resting.iter();
    each.filter_map(|(sensor, pairs)| of_direction(sensor, pairs))
        .collect()
}

/// The direction of a sensor whose vector rests in inertial axes.
fn resting(table: &Table, sensor: &str, gyro: &[&Channel]) -> Option<Pairs> {
    let pairs = Pairs::collect(&table.vector(Some(sensor), "direction")?, gyro)?;
    let rate = pairs.as_declared().rate();
    let reference = table.vector(Some(sensor), "reference");
    let reference = reference.and_then(|r| Pairs::collect(&r, gyro));
    let moves = reference.is_some_and(|r| r.as_declared().rate() > AT_REST * rate);
    (!moves).then_some(pairs)
}

/// A direction in all axes of its sensor against the gyro.
fn of_direction(sensor: &str, pairs: &Pairs) -> Option<Contradiction> {
    let rate = pairs.as_declared().rate();
    let read = |axes: Axes| {
        let residual = pairs.turned(axes, (Axes::IDENTITY, 1.0));
        Hypothesis::of_rates(GyroUnit::AsDeclared, axes, residual)
    };
    let found = search(Axes::all().map(read).collect(), rate, false);
    let channels = ["x", "y", "z"].map(|k| full_name(sensor, &format!("direction_{k}")));
    let direction = full_name(sensor, "direction_x..z");
    let words = |h: &Hypothesis| format!("body axes = sensor {}", h.gyro_axes);
    against_gyro(found, direction, words, |h| vec![h.axes_of(&channels)])
}

/// A direction that contradicts the gyro.
fn against_gyro(
    found: Option<Search>,
    direction: String,
    words: impl Fn(&Hypothesis) -> String,
    way: impl Fn(&Hypothesis) -> Vec<Repair>,
) -> Option<Contradiction> {
    let found = found?;
    let best = found.contradicting()?;
    Some(Contradiction {
        problem: problem(
            &format!("direction '{direction}' and gyro contradict each other"),
            [&found.declared, best],
            "rad/s",
            &words(best),
        ),
        between: [direction, "the gyro".to_owned()],
        ways: found.good.iter().map(way).collect(),
    })
}

/// How far the declared reading and the best one are off, and what the best one is.
fn problem(between: &str, of: [&Hypothesis; 2], unit: &str, best: &str) -> String {
    let [declared, least] = of.map(|h| rounded(h.residual_rad_s, 4));
    format!("{between}: residual {declared} {unit}, but {least} {unit} with {best}")
}

/// Angles and displacements of joints, and positions, each with its rate by the same sensor.
fn places(table: &Table) -> impl Iterator<Item = (Vec<&Channel>, Vec<&Channel>)> {
    let of = |place| {
        let Channel { name, sensor, .. }: &Channel = place;
        let own = classify(name)?;
        match (own.vector(), own.dimension) {
            (None, Dimension::Angle | Dimension::Length) => {
                let rate = table.sensor_channel(sensor, &format!("{name}_s"))?;
                Some((vec![place], vec![rate]))
            }
            (Some(("r", "x")), _) => {
                let of = |prefix| table.vector(Some(sensor), prefix);
                Some((of("r")?, of("v")?))
            }
            _ => None,
        }
    };
    table.channels.iter().filter_map(of)
}

/// Places against their rates: signs, degrees, and of vectors the axes.
fn of_place(place: &[&Channel], rate: &[&Channel]) -> Option<Contradiction> {
    let sums = Pairs::collect(place, rate)?.as_declared();
    let units = match place {
        [angle] if angle.unit == "rad" => &GyroUnit::OF_ANGLES[..],
        _ => &GyroUnit::OF_PLACES[..],
    };
    let axes: Vec<Axes> = match place {
        [_] => vec![Axes::IDENTITY, Axes::REVERSED],
        _ => Axes::all().collect(),
    };
    let read = |unit: &GyroUnit, axes: Axes| {
        let residual = sums.residual(unit.factor(1.0), axes);
        Hypothesis::of_rates(*unit, axes, residual)
    };
    let all = units
        .iter()
        .flat_map(|u| axes.iter().map(move |a| read(u, *a)));
    // One mistake: other axes of a vector in its unit.
    let one = |h: &Hypothesis| {
        place.len() == 1 || h.gyro_unit == GyroUnit::AsDeclared || h.gyro_axes == Axes::IDENTITY
    };
    let found = search(all.filter(one).collect(), sums.rate(), sums.aa == 0.0)?;
    let best = found.contradicting()?;
    let names = |of: &[&Channel]| -> Vec<String> {
        of.iter().map(|c| full_name(&c.sensor, &c.name)).collect()
    };
    let (places, rates) = (names(place), names(rate));
    let between = [&places, &rates].map(|all| all.join(", "));
    // Either may be wrong: both are tried.
    let factor = best.gyro_unit.factor(1.0);
    let mut either = [
        (&rates, factor, best.gyro_axes),
        (&places, 1.0 / factor, best.gyro_axes.inverse()),
    ];
    // Degrees used as radians are more usual than the reverse.
    either.sort_by(|a, b| a.1.total_cmp(&b.1));
    let change = |x: f64, axes: Axes| match place {
        [_] => Change::Factor(f64::from(axes.sign[0]) * x),
        _ if axes == Axes::IDENTITY => Change::Factor(x),
        _ => Change::Axes(axes),
    };
    let words = either.map(|(names, x, axes)| match change(x, axes) {
        Change::Factor(x) => format!("{} times {}", names.join(", "), rounded(x, 6)),
        _ => format!("{} in the axes {axes}", names.join(", ")),
    });
    let way = |(names, x, axes): (&Vec<String>, f64, Axes)| {
        vec![Repair {
            channels: names.clone(),
            change: change(x, axes),
        }]
    };
    let (words, ways) = (words.join(" or "), either.map(way).to_vec());
    let [place, rate_of] = &between;
    Some(Contradiction {
        problem: problem(
            &format!("'{place}' and its rate '{rate_of}' contradict each other"),
            [&found.declared, best],
            &rate.first()?.unit,
            &words,
        ),
        between,
        ways,
    })
}

impl Contradiction {
    /// Whether it is that of a [`ConventionTest`].
    pub(crate) fn is_of_attitude(&self) -> bool {
        self.between[0].ends_with("q_w")
    }

    /// E0215.
    pub fn fault(&self) -> Faults {
        let advice = "correct the map or the file";
        Faults::one("E0215", Place::default(), &self.problem, advice)
    }
}

impl ConventionTest {
    /// # Errors
    /// E0215 if the declared convention is contradicted.
    pub fn check(&self) -> Result<(), Faults> {
        match self.contradiction() {
            Some(found) => Err(found.fault()),
            None => Ok(()),
        }
    }

    /// What it says against the declared reading.
    fn contradiction(&self) -> Option<Contradiction> {
        if self.verdict != Verdict::DeclaredContradicted {
            return None;
        }
        let (attitude, gyro, best) = (&self.attitude, &self.gyro, &self.best);
        let first = attitude.strip_suffix("..q_w").unwrap_or(attitude);
        let prefix = gyro.strip_suffix("x..z").unwrap_or(gyro);
        let rates = ["x", "y", "z"].map(|k| format!("{prefix}{k}"));
        let others = self.twin.iter().chain(&self.as_good);
        // What no map can say of the simplest reading, another that fits would hide.
        let readings = std::iter::once(best)
            .chain(others)
            .filter(|_| !best.is_inertial());
        Some(Contradiction {
            between: [attitude.clone(), gyro.clone()],
            problem: problem(
                &format!(
                    "attitude '{attitude}' and gyro '{gyro}' contradict the declared {DECLARED}"
                ),
                [&self.declared, best],
                "rad/s",
                &best.to_string(),
            ),
            ways: readings.map(|h| h.repairs(first, &rates)).collect(),
        })
    }
}
