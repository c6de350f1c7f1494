//! Conventions of what two channels measure alike: attitude and gyro, an angle or a place and its rate, a position and a velocity, a
//! direction and the gyro. One search compares them in every reading of one table.

mod change;
pub(crate) mod pairs;
pub(crate) mod reading;

pub(crate) use change::line;
pub use change::{Change, Line, Repair, UNIT_FACTORS, unit_mistake};

use crate::{Axes, Channel, Dimension, Order, Sense, Table, Turned, classify, full_name};
use pairs::{Pairs, Sums};
use poinsot_files::{Faults, Place, rounded};
use reading::{Hypothesis, Row, axes, rate_units};
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::PI;

/// Factor by which another reading must fit better to contradict the declared one.
const DECISIVE: f64 = 5.0;
/// Fraction of the rate above which the residual means that a reading does not fit.
const EXPLAINED: f64 = 0.3;
/// Residuals below this fraction of the rate count as equal: the resolution of averaged rates.
const RESOLUTION: f64 = 1e-3;
/// Largest bias of a gyro, rad/s: 0.3 deg/s, that of a cheap one when it is turned on.
pub(crate) const BIAS: f64 = 5e-3;
/// Difference of two residuals, as a fraction of the rate, that are one: those of two readings that no motion can tell apart.
const SAME: f64 = 1e-7;
/// Most readings of a test that are kept, and named in an error.
const KEPT: usize = 21;
const NAMED: usize = 4;
/// Rotation, rad, below which attitudes differ by round-off only.
const ROUND_OFF: f64 = 1e-12;
/// Share of the rate of a direction in the body up to which the measured vector rests in inertial axes.
const AT_REST: f64 = 0.1;
/// The declared convention of attitude and gyro.
const DECLARED: &str = "xyzw, Hamilton, body to inertial, gyro in rad/s and body axes";

/// What the comparison says about the declared reading.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", tag = "verdict")]
pub enum Verdict {
    /// No other reading fits clearly better.
    #[default]
    DeclaredFits,
    /// Another reading fits at least five times better.
    DeclaredContradicted,
    /// The data do not decide.
    Undecided {
        /// Why.
        reason: String,
    },
}

/// The comparison of two measurements of one motion.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct ConventionTest {
    /// What both are: an attitude and a gyro, a direction and a gyro, or a position and a rate.
    pub kinds: [&'static str; 2],
    /// Their channels, for example `q_x..q_w` and `omega_x..z`.
    pub between: [String; 2],
    /// Intervals compared.
    pub intervals: usize,
    /// Unit of the rates.
    pub unit: String,
    /// Root mean square of the rate from the first of both as declared.
    pub rate: f64,
    /// Least-squares factor of the second to the rate of the first as declared: 1 where both agree, 0.01745 where a gyro is deg/s, 0.001 where
    /// the times are ms. `None` of a direction.
    pub scale: Option<f64>,
    /// The declared reading, and those with another unit or another order and sense of the quaternion.
    pub readings: Vec<Hypothesis>,
    /// Those that fit best, the simplest first; of two that no motion can tell apart the simpler one.
    pub good: Vec<Hypothesis>,
    /// The verdict on the declared reading.
    pub verdict: Verdict,
}

impl ConventionTest {
    /// Compares readings, the first of which is the declared one.
    fn of(
        kinds: [&'static str; 2],
        between: [String; 2],
        unit: &str,
        pairs: &[&Pairs],
        readings: Vec<Hypothesis>,
    ) -> Option<Self> {
        let sums: Vec<Sums> = pairs.iter().map(|pairs| pairs.as_declared()).collect();
        let squares: f64 = sums.iter().map(|s| s.rate().powi(2)).sum();
        let scale = |s: &Sums| s.along(Axes::IDENTITY) / s.gg;
        let longest_s = pairs.iter().map(|p| p.longest_s()).fold(0.0, f64::max);
        let rate = (squares / sums.len() as f64).sqrt();
        let mut test = Self {
            intervals: pairs.iter().map(|p| p.turns.len()).sum(),
            unit: unit.to_owned(),
            scale: sums.first().filter(|_| kinds[0] != "direction").map(scale),
            kinds,
            between,
            rate,
            ..Self::default()
        };
        test.decide(readings, rate * longest_s < ROUND_OFF)?;
        Some(test)
    }

    /// The verdict, and the readings that are kept.
    fn decide(&mut self, all: Vec<Hypothesis>, still: bool) -> Option<()> {
        let rate = self.rate;
        let level = |h: &Hypothesis| h.residual.max(RESOLUTION * rate);
        let lowest = all.iter().map(level).fold(f64::INFINITY, f64::min);
        let declared = level(all.first()?);
        let undecided = |reason: String| Verdict::Undecided { reason };
        let [kind, other] = self.kinds;
        self.verdict = if still {
            undecided(format!("the {kind} does not move"))
        } else if lowest > EXPLAINED * rate {
            undecided(format!(
                "motion too small, or {kind} and {other} too noisy: no convention explains the rates"
            ))
        } else if declared >= DECISIVE * lowest {
            Verdict::DeclaredContradicted
        } else if declared <= 2.0 * lowest {
            Verdict::DeclaredFits
        } else {
            undecided("another convention fits better, but not clearly".to_owned())
        };
        // Readings of one row that turns no axes are listed.
        let is_listed = |h: &&Hypothesis| h.repairs().len() < 2 && h.is_along();
        self.readings = all.iter().filter(is_listed).cloned().collect();
        // Of a place and its rate, either may be wrong: one reading.
        self.readings.dedup_by_key(|h| h.residual);
        let mut good: Vec<Hypothesis> =
            (all.into_iter().filter(|h| level(h) <= 1.5 * lowest)).collect();
        good.sort_by(|a, b| {
            (a.departures().cmp(&b.departures())).then(a.residual.total_cmp(&b.residual))
        });
        // Exchanging order and sense together only turns the body's and the inertial axes by fixed rotations that permute axes.
        let twin = |a: &Hypothesis, b: &Hypothesis| {
            let off = (a.residual - b.residual).abs();
            a.order() != b.order() && off <= SAME * (rate + a.residual)
        };
        for h in good {
            if self.good.len() < KEPT && !self.good.iter().any(|g| twin(g, &h)) {
                self.good.push(h);
            }
        }
        Some(())
    }

    /// Not contradicted where the bias of a gyro explains as much.
    fn or_offset(mut self, (offset, left): (f64, f64)) -> Self {
        let lowest = self.good.first().map_or(0.0, |h| h.residual);
        if self.is_contradicted() && offset < BIAS && left <= 2.0 * lowest {
            let offset = rounded(offset, 2);
            let reason = format!("a gyro bias of {offset} rad/s explains the rates as well");
            self.verdict = Verdict::Undecided { reason };
        }
        self
    }

    /// Whether another reading fits clearly better than the declared one.
    pub fn is_contradicted(&self) -> bool {
        self.verdict == Verdict::DeclaredContradicted
    }

    /// A reading in words.
    pub(crate) fn words<'a>(&self, of: &'a Hypothesis) -> &'a str {
        match (of.is_declared(), self.kinds[0]) {
            (false, _) => &of.words,
            (true, "attitude") => DECLARED,
            (true, _) => "as declared",
        }
    }

    /// Repairs after which both agree, the simplest first, each a list of changes that belong together.
    pub fn ways(&self) -> Vec<Vec<Repair>> {
        self.good.iter().map(Hypothesis::repairs).collect()
    }

    /// How many readings are as simple as the first, and what they say.
    pub(crate) fn simplest(&self) -> (usize, String) {
        let least = self.good.first().map(Hypothesis::departures);
        let own = |h: &&Hypothesis| Some(h.departures()) == least;
        let words: Vec<&str> = self
            .good
            .iter()
            .filter(own)
            .map(|h| self.words(h))
            .collect();
        let named = words.get(..NAMED).unwrap_or(&words);
        (words.len(), named.join(" or "))
    }

    /// E0215, with the readings that fit best.
    pub fn fault(&self) -> Faults {
        let ([a, b], [kind, other], unit) = (&self.between, self.kinds, &self.unit);
        let what = match kind {
            "attitude" => &format!("the declared {DECLARED}"),
            _ => "each other",
        };
        let first = |of: &[Hypothesis]| of.first().map_or(0.0, |h| h.residual);
        let [declared, least] = [&self.readings, &self.good].map(|of| rounded(first(of), 4));
        let best = self.simplest().1;
        let problem = format!(
            "{kind} '{a}' and {other} '{b}' are inconsistent with {what}: residual {declared} {unit}, but {least} {unit} with {best}"
        );
        let advice = "correct the map or the file";
        Faults::one("E0215", Place::default(), problem, advice)
    }
}

/// Tests every attitude, and every direction that rests in inertial axes, against the gyro, and every angle or position against its rate.
/// A named attitude is compared with unnamed gyros and with its own. Assumes that every gyro measures in body axes
/// ([`mount`](crate::mount) turns one that does not).
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// // One attitude and one gyro: one comparison.
/// let channels = attitude.into_iter().chain(gyro(57.3)).collect();
/// let tests = convention_tests(&Table { channels, ..Table::default() });
/// assert_eq!(tests.len(), 1);
/// let mut map = TelemetryMap::default();
/// let lines = tests[0].ways()[0][0].declare(&mut map).unwrap();
/// assert_eq!(lines[0].text, r#"omega_x = { column = "omega_x", unit = "deg/s" }"#);
/// ```
pub fn convention_tests(table: &Table) -> Vec<ConventionTest> {
    let [attitudes, gyros] = ["q", "omega"].map(|prefix| table.vectors(prefix));
    let pairs = attitudes
        .iter()
        .flat_map(|q| gyros.iter().map(move |w| (q, w)));
    let attitudes = pairs.filter_map(|(q, w)| of_attitude(&table.at(q), &table.at(w)));
    let rates = places(table).filter_map(|(place, rate)| of_place(table, &place, &rate));
    attitudes.chain(of_directions(table)).chain(rates).collect()
}

/// Returns an error if two measurements of one motion clearly contradict each other.
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
    let mut tests = convention_tests(table).into_iter();
    tests
        .find(ConventionTest::is_contradicted)
        .map_or(Ok(()), |t| Err(t.fault()))
}

/// The names of channels.
fn names(channels: &[&Channel]) -> Vec<String> {
    channels.iter().map(|c| c.full()).collect()
}

/// An attitude against a gyro: order and sense, units of the rates, axes. `None` if the channels of one sensor have different times,
/// or the sensors overlap in fewer than 8 intervals.
fn of_attitude(attitude: &[&Channel], gyro: &[&Channel]) -> Option<ConventionTest> {
    let pairs = Pairs::collect(attitude, gyro)?;
    let (q, rates) = (names(attitude), names(gyro));
    let (units, axes) = (rate_units(gyro, &rates)?, axes(&rates, "body rates = gyro"));
    // The inverse attitude turns by the opposite of an inertial rate, and no gyro has all of its axes reversed.
    let inertial = Row::of(&rates, Change::Turned(Turned::Rates));
    let senses = [Sense::BodyToInertial, Sense::InertialToBody];
    let attitudes = [Order::Xyzw, Order::Wxyz].into_iter().flat_map(|order| {
        senses.map(|sense| {
            let rows = [sense, senses[0]].map(|sense| Row::attitude(&q, order, sense));
            (sense, rows, pairs.sums(order, sense))
        })
    });
    let attitudes: Vec<_> = attitudes.collect();
    let mut readings = Vec::with_capacity(attitudes.len() * units.len() * axes.len());
    for (factor, unit) in &units {
        for (sense, [as_read, forward], sums) in &attitudes {
            readings.extend(axes.iter().map(|(own, row)| {
                let is_inertial = *sense == Sense::InertialToBody && *own == Axes::REVERSED;
                let (attitude, row) = match is_inertial {
                    true => (forward, &inertial),
                    false => (as_read, row),
                };
                Hypothesis::of([attitude, unit, row], sums.residual(*factor, *own))
            }));
        }
    }
    let between = [
        format!("{}..q_w", q.first()?),
        format!("{}..z", rates.first()?),
    ];
    let test = ConventionTest::of(["attitude", "gyro"], between, "rad/s", &[&pairs], readings)?;
    Some(test.or_offset(pairs.as_declared().offset()))
}

/// Directions that rest in inertial axes against the first gyro: they turn in the body by the opposite of its rate.
fn of_directions(table: &Table) -> Vec<ConventionTest> {
    let Some(gyro) = table.vector(None, "omega") else {
        return Vec::new();
    };
    let channels = table.channels.iter().filter(|c| c.name == "direction_x");
    let resting =
        channels.filter_map(|c| Some((c.sensor.as_str(), resting(table, &c.sensor, &gyro)?)));
    let resting: Vec<(&str, Pairs)> = resting.collect();
    let together = (resting.len() > 1).then(|| of_resting(&resting, &gyro));
    match together.flatten().filter(ConventionTest::is_contradicted) {
        Some(together) => vec![together],
        None => resting
            .chunks(1)
            .filter_map(|one| of_resting(one, &gyro))
            .collect(),
    }
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

/// Directions against a gyro in other units, and in other axes: of the gyro where several say the same, else of the direction's sensor.
fn of_resting(all: &[(&str, Pairs)], gyro: &[&Channel]) -> Option<ConventionTest> {
    let read = |own: Axes, rates: (Axes, f64)| {
        let squares = all
            .iter()
            .map(|(_, pairs)| pairs.turned(own, rates).powi(2));
        (squares.sum::<f64>() / all.len() as f64).sqrt()
    };
    let rates = names(gyro);
    let mut readings: Vec<Hypothesis> = rate_units(gyro, &rates)?
        .iter()
        .map(|(x, row)| Hypothesis::of([row], read(Axes::IDENTITY, (Axes::IDENTITY, *x))))
        .collect();
    let of_sensor =
        |sensor: &str| ["x", "y", "z"].map(|k| full_name(sensor, &format!("direction_{k}")));
    let rows = match all {
        [(sensor, _)] => axes(&of_sensor(sensor), "body axes = sensor"),
        _ => axes(&rates, "body rates = gyro"),
    };
    readings.extend(rows.iter().skip(1).map(|(turned, row)| {
        let (own, rates) = match all.len() {
            1 => (*turned, Axes::IDENTITY),
            _ => (Axes::IDENTITY, *turned),
        };
        Hypothesis::of([row], read(own, (rates, 1.0)))
    }));
    let directions = all
        .iter()
        .map(|(sensor, _)| full_name(sensor, "direction_x..z"));
    let between = [
        directions.collect::<Vec<_>>().join(", "),
        format!("{}..z", rates.first()?),
    ];
    let pairs: Vec<&Pairs> = all.iter().map(|(_, pairs)| pairs).collect();
    ConventionTest::of(["direction", "gyro"], between, "rad/s", &pairs, readings)
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

/// Places against their rates: signs, units, and of vectors the axes. Either may be wrong: both are rows.
fn of_place(table: &Table, place: &[&Channel], rate: &[&Channel]) -> Option<ConventionTest> {
    let pairs = Pairs::collect(place, rate)?;
    let sums = pairs.as_declared();
    let [places, rates] = [place, rate].map(names);
    let unit = match place {
        [angle] if angle.unit == "rad" => PI / 180.0,
        _ => 1.0e-3,
    };
    let factors: &[f64] = match place {
        [_] => &[unit, 1.0 / unit, -1.0, -unit, -1.0 / unit],
        _ => &[unit, 1.0 / unit],
    };
    let turned = Axes::all().filter(|a| place.len() > 1 && *a != Axes::IDENTITY);
    let mut readings = vec![Hypothesis::of([], sums.residual(1.0, Axes::IDENTITY))];
    // Degrees used as radians are more usual than the reverse.
    readings.extend(factors.iter().flat_map(|x| {
        let mut either = [
            Row::of(&rates, Change::Factor(*x)),
            Row::of(&places, Change::Factor(1.0 / x)),
        ];
        either.rotate_left(usize::from(x.abs() > 1.0));
        either.map(|row| Hypothesis::of([&row], sums.residual(*x, Axes::IDENTITY)))
    }));
    readings.extend(turned.flat_map(|axes| {
        let either = [
            Row::of(&rates, Change::Axes(axes)),
            Row::of(&places, Change::Axes(axes.inverse())),
        ];
        either.map(|row| Hypothesis::of([&row], sums.residual(1.0, axes)))
    }));
    // Where they agree as declared, in no other axes.
    if place.len() > 1 && sums.residual(1.0, Axes::IDENTITY) > RESOLUTION * sums.rate() {
        for (turned, own) in [(Turned::Velocities, &rates), (Turned::Positions, &places)] {
            let residual = in_body_axes(table, turned, &place.first()?.sensor);
            let row = Row::of(own, Change::Turned(turned));
            readings.extend(residual.map(|residual| Hypothesis::of([&row], residual)));
        }
    }
    let between = [places.join(", "), rates.join(", ")];
    let unit = &rate.first()?.unit;
    ConventionTest::of(["position", "rate"], between, unit, &[&pairs], readings)
}

/// The difference of position and velocity of a sensor, one of which is in body axes; `None` without an attitude.
fn in_body_axes(table: &Table, turned: Turned, sensor: &str) -> Option<f64> {
    let mut table = table.clone();
    turned.turn(&mut table).ok()?;
    let [r, v] = ["r", "v"].map(|prefix| table.vector(Some(sensor), prefix));
    let sums = Pairs::collect(&r?, &v?)?.as_declared();
    Some(sums.residual(1.0, Axes::IDENTITY))
}
