//! Report of the steps and their results.

use super::super::particle;
use super::super::single_body::Form;
use super::super::swarm::{Flight, Range};
use poinsot_spatial::{InertialParameters, MassProperties};

/// A swarm whose cost stays above this fraction of its first best has not converged.
const ARRIVED: f64 = 1.0e-6;
/// Fraction of the noise cost below which cost differences are negligible.
const UNSEEN: f64 = 0.1;

/// Part identified by a step.
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

/// Report of one step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReport {
    /// Identified part.
    pub part: Searched,
    /// Name.
    pub name: String,
    /// Result: mass, mass centre and central inertia in its own frame.
    pub found: MassProperties,
    /// The linear solution of the same step.
    pub linear: MassProperties,
    /// Cost (37) or (52) of the linear solution, mean over the samples.
    pub cost_linear: f64,
    /// Expected cost from the declared velocity noise; zero without measured velocity.
    pub cost_noise: f64,
    /// Number of directions determined by the linear solution.
    pub rank: usize,
    /// Condition number of these directions in natural units.
    pub condition: f64,
    /// Result and range of the swarm.
    pub flight: Option<(Flight, Range)>,
}

impl StepReport {
    /// Whether the swarm stopped on a bound of its range and the linear solution lies outside.
    pub fn excluded(&self) -> bool {
        let stuck =
            |f: &(Flight, Range)| !f.0.on_bound.is_empty() && !f.1.holds(&particle(&self.linear));
        self.flight.as_ref().is_some_and(stuck) && !self.arrived()
    }

    /// Whether the swarm's cost reached that of the linear solution, within the declared noise.
    pub fn arrived(&self) -> bool {
        self.flight.as_ref().is_none_or(|(flight, _)| {
            let first = flight.history.first().copied().unwrap_or(0.0);
            let floor = ARRIVED * first + UNSEEN * self.cost_noise;
            flight.cost <= 2.0 * self.cost_linear + floor
        })
    }
}

/// All bodies, with the steps.
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
    /// Form of (35) used.
    pub form: Option<Form>,
    /// Assumptions made.
    pub notes: Vec<String>,
}
