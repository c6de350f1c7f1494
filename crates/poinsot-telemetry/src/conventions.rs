//! Tests the conventions of attitude and gyro: body rates derived from the quaternions are compared with the gyro
//! under every combination of conventions.

use crate::hypothesis::{Axes, DECISIVE, DECLARED, EXPLAINED, GyroUnit, Hypothesis, Order, Sense};
use crate::median::median_step;
use crate::rate_pairs::Pairs;
use crate::{Channel, Table, direction_axes, full_name};
use poinsot_files::{Faults, Place, rounded};
use schemars::JsonSchema;
use serde::Serialize;

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

/// Residuals below this fraction of the rate count as equal: the resolution of averaged rates.
const RESOLUTION: f64 = 1e-3;
/// Rotation, rad, below which attitudes differ by round-off only.
const ROUND_OFF: f64 = 1e-12;

/// Compares an attitude (q_x, q_y, q_z, q_w) with a gyro (omega_x, omega_y, omega_z).
///
/// The gyro is in body axes ([`mount`](crate::mount) turns one that is not). Returns `None` if the channels of one sensor
/// have different times, or the sensors overlap in fewer than 8 intervals.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// // The body turns at a constant rate; the gyro measures it.
/// let [x, y, z] = &gyro(1.0)[..] else { unreachable!() };
/// let test = test_conventions(attitude.each_ref(), [x, y, z]).unwrap();
/// assert_eq!(test.verdict, Verdict::DeclaredFits);
/// assert!((test.scale - 1.0).abs() < 1.0e-6);
/// ```
pub fn test_conventions(attitude: [&Channel; 4], gyro: [&Channel; 3]) -> Option<ConventionTest> {
    let pairs = Pairs::collect(attitude, gyro)?;
    let step_s = median_step(&gyro[0].time_s)?;
    let mut all = Vec::with_capacity(4 * 8 * 48);
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
    let declared = *all.iter().find(|h| h.is_declared())?;
    let sums = pairs.sums(Order::Xyzw, Sense::BodyToInertial);
    let rate = (sums.aa / sums.n).sqrt();
    let level = |h: &Hypothesis| h.residual_rad_s.max(RESOLUTION * rate);
    let lowest = all.iter().map(level).fold(f64::INFINITY, f64::min);
    let good = all.iter().copied().filter(|h| level(h) <= 1.5 * lowest);
    let mut good: Vec<Hypothesis> = good.collect();
    good.sort_by(|a, b| {
        (a.departures().cmp(&b.departures())).then(a.residual_rad_s.total_cmp(&b.residual_rad_s))
    });
    let best = *good.first()?;
    let is_twin = |h: &Hypothesis| {
        h.order != best.order
            && h.sense != best.sense
            && h.gyro_unit == best.gyro_unit
            && (h.residual_rad_s - best.residual_rad_s).abs() <= 1e-7 * (rate + best.residual_rad_s)
    };
    let twin = good.iter().position(is_twin).filter(|_| rate > 0.0);
    let twin = twin.map(|k| good.remove(k));
    let still = rate * pairs.longest_s() < ROUND_OFF;
    let verdict = verdict(still, [lowest, level(&declared), rate]);
    let only =
        |test: &dyn Fn(&Hypothesis) -> bool| all.iter().copied().filter(|h| test(h)).collect();
    let as_declared = |h: &Hypothesis| h.gyro_axes == Axes::IDENTITY;
    Some(ConventionTest {
        attitude: format!("{}..q_w", full_name(&attitude[0].sensor, "q_x")),
        gyro: format!("{}..z", full_name(&gyro[0].sensor, "omega_x")),
        intervals: pairs.turns.len(),
        rate_rad_s: rate,
        scale: sums.along(Axes::IDENTITY) / sums.gg,
        declared,
        attitude_readings: only(&|h| as_declared(h) && h.gyro_unit == GyroUnit::AsDeclared),
        gyro_units: only(&|h| {
            as_declared(h) && h.order == Order::Xyzw && h.sense == Sense::BodyToInertial
        }),
        best,
        twin,
        as_good: good.into_iter().skip(1).take(20).collect(),
        verdict,
    })
}

/// What the lowest residual and that of the declared convention say beside the rate, rad/s.
fn verdict(still: bool, [lowest, declared, rate]: [f64; 3]) -> Verdict {
    if still {
        undecided("the attitude does not move")
    } else if lowest > EXPLAINED * rate {
        let why =
            "motion too small, or attitude and gyro too noisy: no convention explains the rates";
        undecided(why)
    } else if declared >= DECISIVE * lowest {
        Verdict::DeclaredContradicted
    } else if declared <= 2.0 * lowest {
        Verdict::DeclaredFits
    } else {
        undecided("another convention fits better, but not clearly")
    }
}

fn undecided(reason: &str) -> Verdict {
    Verdict::Undecided {
        reason: reason.to_owned(),
    }
}

const READINGS: [(Order, Sense); 4] = [
    (Order::Xyzw, Sense::BodyToInertial),
    (Order::Xyzw, Sense::InertialToBody),
    (Order::Wxyz, Sense::BodyToInertial),
    (Order::Wxyz, Sense::InertialToBody),
];

/// Tests every attitude against every gyro. A named sensor is compared with unnamed ones and with its own.
///
/// ```
#[doc = include_str!("../doc/spin.txt")]
/// // One attitude and one gyro: one comparison.
/// let channels = attitude.into_iter().chain(gyro(1.0)).collect();
/// let tests = convention_tests(&Table { channels, ..Table::default() });
/// assert_eq!((tests.len(), &tests[0].verdict), (1, &Verdict::DeclaredFits));
/// ```
pub fn convention_tests(table: &Table) -> Vec<ConventionTest> {
    let sensors = |name: &str| -> Vec<&str> {
        let of = table.channels.iter().filter(|c| c.name == name);
        of.map(|c| c.sensor.as_str()).collect()
    };
    let mut tests = Vec::new();
    for attitude in sensors("q_x") {
        for gyro in sensors("omega_x") {
            if let Some(test) = test_sensors(table, attitude, gyro) {
                tests.push(test);
            }
        }
    }
    tests
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
    let of = |sensor: &str, name: &str| table.sensor_channel(sensor, name);
    let q = |name| of(attitude, name);
    let w = |name| of(gyro, name);
    test_conventions(
        [q("q_x")?, q("q_y")?, q("q_z")?, q("q_w")?],
        [w("omega_x")?, w("omega_y")?, w("omega_z")?],
    )
}

/// Returns an error if attitude and gyro, or a direction and the gyro, clearly contradict the declared conventions.
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
    convention_tests(table)
        .iter()
        .try_for_each(ConventionTest::check)?;
    direction_axes::check(table)
}

impl ConventionTest {
    /// # Errors
    /// E0215 if the declared convention is contradicted.
    pub fn check(&self) -> Result<(), Faults> {
        if self.verdict != Verdict::DeclaredContradicted {
            return Ok(());
        }
        let (attitude, gyro, best) = (&self.attitude, &self.gyro, &self.best);
        let residual = rounded(self.declared.residual_rad_s, 4);
        let least = rounded(best.residual_rad_s, 4);
        let problem = format!(
            "attitude '{attitude}' and gyro '{gyro}' contradict the declared {DECLARED}: residual {residual} rad/s, but {least} rad/s with {best}"
        );
        let advice = "correct the map or the file";
        Err(Faults::one("E0215", Place::default(), problem, advice))
    }
}
