//! The table of readings: one row for each change of what is read, with the mistake in words.

use super::change::{Change, Repair};
use crate::median::median_step;
use crate::{Axes, Channel, Order, Sense};
use poinsot_files::rounded;
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::PI;
use std::sync::Arc;

/// What puts rates right, and the mistake.
const UNITS: [(Change, &str); 8] = [
    (Change::Factor(PI / 180.0), "gyro in deg/s"),
    (Change::Factor(PI / 30.0), "gyro in rpm"),
    (
        Change::Factor(180.0 / PI),
        "gyro in rad/s (it is mapped as deg/s)",
    ),
    (
        Change::Factor(30.0 / PI),
        "gyro in rad/s (it is mapped as rpm)",
    ),
    (
        Change::Clock(1.0e-3),
        "times in ms used as s (or a gyro in mrad/s)",
    ),
    (
        Change::Clock(1.0e3),
        "times in s used as ms (or a gyro used as mrad/s)",
    ),
    (Change::Clock(60.0), "times in min used as s"),
    (
        Change::Increments,
        "angles since the sample before in the columns of the gyro (increments = true)",
    ),
];

/// A row of the table: a change of what is read.
#[derive(Debug, PartialEq)]
pub(super) struct Row {
    /// The mistake.
    words: String,
    /// What puts it right.
    repair: Repair,
}

/// A row, or none where nothing changes.
pub(super) type Cell = Option<Arc<Row>>;

impl Row {
    fn with(words: String, channels: &[String], change: Change) -> Cell {
        let channels = channels.to_vec();
        let repair = Repair { channels, change };
        Some(Arc::new(Self { words, repair }))
    }

    /// Channels times a factor, or in other axes.
    pub fn of(channels: &[String], change: Change) -> Cell {
        let names = channels.join(", ");
        let words = match change {
            Change::Factor(x) => format!("{names} times {}", rounded(x, 6)),
            Change::Axes(axes) => format!("{names} in the axes {axes}"),
            Change::Turned(turned) => {
                let [what, axes, usual] = turned.words();
                format!("{what} in {axes} axes, not in {usual} axes")
            }
            _ => names,
        };
        Self::with(words, channels, change)
    }

    /// The order and sense of a quaternion.
    pub fn attitude(channels: &[String], order: Order, sense: Sense) -> Cell {
        let changes = [
            (order == Order::Wxyz, "quaternion scalar first (wxyz)"),
            (
                sense == Sense::InertialToBody,
                "quaternion inertial to body (or body to inertial in JPL algebra)",
            ),
        ];
        let words: Vec<&str> = changes.iter().filter(|c| c.0).map(|c| c.1).collect();
        let first = channels.get(..1).filter(|_| !words.is_empty())?;
        Self::with(words.join(", "), first, Change::Attitude(order, sense))
    }

    /// How far it departs from what is declared; a permutation counts more than a sign.
    fn departures(&self) -> usize {
        match self.repair.change {
            Change::Attitude(order, sense) => {
                2 * usize::from(order == Order::Wxyz)
                    + 2 * usize::from(sense == Sense::InertialToBody)
            }
            Change::Axes(axes) => {
                let signs = axes.sign.iter().filter(|s| **s < 0).count();
                4 * usize::from(axes.axis != Axes::IDENTITY.axis) + 3 * signs
            }
            Change::Factor(x) if x < 0.0 => 3 + 2 * usize::from(x != -1.0),
            _ => 2,
        }
    }
}

/// The units of a gyro, with the factor of its numbers, as declared first. `None` without samples.
pub(super) fn rate_units(gyro: &[&Channel], names: &[String]) -> Option<Vec<(f64, Cell)>> {
    let step_s = median_step(&gyro.first()?.time_s)?;
    let unit = |(change, words): (Change, &str)| {
        let time = ["time_s".to_owned()];
        let (x, channels) = match change {
            Change::Clock(x) => (x, &time[..]),
            Change::Factor(x) => (x, names),
            _ => (1.0 / step_s, names),
        };
        (x, Row::with(words.to_owned(), channels, change))
    };
    let declared = std::iter::once((1.0, None));
    Some(declared.chain(UNITS.map(unit)).collect())
}

/// All axes of a vector, as declared first.
pub(super) fn axes(names: &[String], words: &str) -> Vec<(Axes, Cell)> {
    let of = |axes: Axes| Row::with(format!("{words} {axes}"), names, Change::Axes(axes));
    let cell = |axes| (axes, of(axes).filter(|_| axes != Axes::IDENTITY));
    Axes::all().map(cell).collect()
}

/// A reading of two measurements of one motion: rows of the table that hold together.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Hypothesis {
    /// How it departs from what is declared; empty for the declared reading.
    pub words: String,
    /// Root mean square of the difference of both rates, of turns what is left of them per second.
    pub residual: f64,
    #[serde(skip)]
    rows: Vec<Arc<Row>>,
}

impl Hypothesis {
    pub(super) fn of<const N: usize>(cells: [&Cell; N], residual: f64) -> Self {
        let rows: Vec<Arc<Row>> = cells.into_iter().flatten().cloned().collect();
        let words: Vec<&str> = rows.iter().map(|row| row.words.as_str()).collect();
        Self {
            words: words.join(", "),
            residual,
            rows,
        }
    }

    /// Whether it is the declared one.
    pub fn is_declared(&self) -> bool {
        self.rows.is_empty()
    }

    /// What makes it the declared one.
    pub fn repairs(&self) -> Vec<Repair> {
        self.rows.iter().map(|row| row.repair.clone()).collect()
    }

    /// Whether the axes are those that are declared.
    pub fn is_along(&self) -> bool {
        let turns =
            |row: &Arc<Row>| matches!(row.repair.change, Change::Turned(_) | Change::Axes(_));
        !self.rows.iter().any(turns)
    }

    pub(super) fn departures(&self) -> usize {
        self.rows.iter().map(|row| row.departures()).sum()
    }

    /// Order of the quaternion.
    pub(super) fn order(&self) -> Order {
        let of = |row: &Arc<Row>| match row.repair.change {
            Change::Attitude(order, _) => Some(order),
            _ => None,
        };
        self.rows.iter().find_map(of).unwrap_or(Order::Xyzw)
    }
}
