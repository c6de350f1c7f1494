//! How the steps went and what they found.

use super::super::particle;
use super::super::single_body::Form;
use super::super::swarm::{Flight, Range};
use poinsot_spatial::{InertialParameters, MassProperties};

/// A swarm whose cost stays above this share of its first best has not arrived.
const ARRIVED: f64 = 1.0e-6;
/// Share of the cost that the declared noise leaves, below which costs say the same.
const UNSEEN: f64 = 0.1;

/// What a step works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Searched {
    /// The locked robot.
    Single,
    /// The base side of a joint coordinate.
    Inner(usize),
    /// The tip side of a joint coordinate.
    Outer(usize),
    /// One body among known ones.
    Body(usize),
}

/// How one step went.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// What was searched.
    pub part: Searched,
    /// In words.
    pub name: String,
    /// Result: mass, mass centre and central inertia in its own frame.
    pub found: MassProperties,
    /// The linear solution of the same step.
    pub linear: MassProperties,
    /// Cost (37) or (52) of the linear solution, mean over the samples.
    pub cost_linear: f64,
    /// Cost that the declared noise of the velocity alone leaves; zero where it is not seen.
    pub cost_noise: f64,
    /// Directions that the linear solution moved, of those asked for.
    pub rank: usize,
    /// Condition of these directions in natural units.
    pub condition: f64,
    /// The swarm's flight and range.
    pub flight: Option<(Flight, Range)>,
}

impl StepReport {
    /// Whether the swarm stands on a bound of its range and misses what the data say, which lies outside.
    pub fn excluded(&self) -> bool {
        let stuck =
            |f: &(Flight, Range)| !f.0.on_bound.is_empty() && !f.1.holds(&particle(&self.linear));
        self.flight.as_ref().is_some_and(stuck) && !self.arrived()
    }

    /// Whether the swarm's cost came down to that of the linear solution, as far as the declared noise lets one
    /// tell.
    pub fn arrived(&self) -> bool {
        self.flight.as_ref().is_none_or(|(flight, _)| {
            let first = flight.history.first().copied().unwrap_or(0.0);
            let floor = ARRIVED * first + UNSEEN * self.cost_noise;
            flight.cost <= 2.0 * self.cost_linear + floor
        })
    }
}

/// All bodies, and how they were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Barycentric parameters of every body about its own origin.
    pub bodies: Vec<InertialParameters>,
    /// The locked robot in the normal configuration about the base origin.
    pub total: Option<InertialParameters>,
    /// Normal configuration, rad or m.
    pub normal: Vec<f64>,
    /// Steps in the order taken.
    pub steps: Vec<StepReport>,
    /// Which form of (35) was used.
    pub form: Option<Form>,
    /// What had to be assumed.
    pub notes: Vec<String>,
}
