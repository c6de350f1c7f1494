//! The problem of an estimator.

use crate::problem::parameters::{Equations, Parameters, Registry};
use crate::problem::refusal::{self, NO_VELOCITY, too_few_samples, too_many};
use crate::problem::segment::{Noise, Observations, Segment};
use poinsot_dynamics::Tree;
use poinsot_dynamics::propagation::MOST_MODES;
use poinsot_files::{Faults, Pace};
use poinsot_model::{JointKind, Model};

/// The identification problem: a vehicle and its segments of telemetry.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// Vehicle with nominal numbers.
    pub model: &'a Model,
    /// Its kinematics.
    pub tree: &'a Tree,
    /// Data.
    pub segments: &'a [Segment],
    /// Declared noise.
    pub noise: &'a Noise,
    /// Half-width of the 95 % interval in natural units up to which a number is given (docs/reference/interface.md: 1.0).
    pub relative_accuracy: f64,
    /// The pace of its evaluations; where it is over, no vehicle can move any more, and no sample is read. `None`: without a limit of
    /// time.
    pub pace: Option<&'a Pace>,
}

/// Fewest evaluations of a fit.
const EVALUATIONS: usize = 8;

/// Half-width of a normal's 95 % interval, sigmas.
pub(crate) const INTERVAL: f64 = 1.96;

/// Why a problem has no solution: codes E04xx.
pub use poinsot_files::Faults as ProblemError;

impl<'a> Problem<'a> {
    /// The same vehicle and noise with other records.
    pub(crate) fn with_segments(&self, segments: &'a [Segment]) -> Self {
        Self { segments, ..*self }
    }

    /// The same records of another vehicle.
    pub(crate) fn with_model(&self, model: &'a Model) -> Self {
        Self { model, ..*self }
    }

    /// Whether there is time for one more evaluation.
    pub(crate) fn has_time(&self) -> bool {
        self.pace.is_none_or(|p| p.check(1, EVALUATIONS).is_ok())
    }

    /// Sigma in natural units up to which a number is given.
    pub(crate) fn largest_sigma(&self) -> f64 {
        self.relative_accuracy / INTERVAL
    }

    /// The registry of its unknowns.
    pub(crate) fn registry(&self) -> Registry<'_> {
        Registry {
            model: self.model,
            tree: self.tree,
            segments: self.segments,
        }
    }

    /// Whether a thruster fires in some segment.
    pub(crate) fn fires(&self) -> bool {
        self.segments.iter().any(|s| !s.firings.is_empty())
    }

    /// Whether velocity or position is measured in every segment.
    pub(crate) fn sees_translation(&self) -> bool {
        self.segments
            .iter()
            .all(|s| s.samples.translation.is_some())
    }

    /// Whether the motion of some wheel between grid times is not known from its torque.
    pub(crate) fn assumes_wheel_motion(&self) -> bool {
        let wheels = self.model.wheels.len();
        let unknown = |o: &Observations| (0..wheels).any(|w| o.is_smooth(w, true));
        self.segments.iter().any(|s| unknown(&s.observations))
    }

    /// Number of modes and passive joints.
    pub(crate) fn internal_states(&self) -> usize {
        self.model.modes.len() + self.model.passive_joints(self.tree).joints().len()
    }

    /// Whether an instrument at a point (accelerometer, velocity increments) has readings.
    pub(crate) fn sees_points(&self) -> bool {
        self.segments.iter().any(|s| s.observations.reads_points())
    }

    /// Whether flexible modes and passive joints can be identified, those of the model.
    ///
    /// # Errors
    /// E0408: a mode is on a body that joints move, or beside an accelerometer; a passive joint is beside a mode, an accelerometer or
    /// a gravity gradient, or carries a wheel or thruster.
    pub(crate) fn check_modes(&self) -> Result<(), Faults> {
        self.check_passive_joints()?;
        for own in &self.model.modes {
            if self.moves_on_base(own.mode.body) {
                let advice = "declare it on the base or on a body that is fixed to it";
                return Err(refusal::mode(
                    &own.name,
                    "joints that move its body",
                    advice,
                ));
            }
            if self.sees_points() {
                let advice = "take accelerometers and velocity increments out of the map";
                return Err(refusal::mode(&own.name, "an accelerometer", advice));
            }
        }
        Ok(())
    }

    fn check_passive_joints(&self) -> Result<(), Faults> {
        let (model, passive) = (self.model, self.model.passive_joints(self.tree));
        let Some(first) = passive.joints().first() else {
            return Ok(());
        };
        let carried = |body: usize| passive.over(body) != 0;
        let joint = &model.joints[self.tree.coordinates[first.coordinate]];
        let refuse = |with, advice| Err(refusal::passive_joint(&joint.name, with, advice));
        if !model.modes.is_empty() {
            let advice = "declare all as passive joints, or all as modes";
            return refuse("flexible modes", advice);
        }
        if self.sees_points() {
            let advice = "take accelerometers and velocity increments out of the map";
            return refuse("an accelerometer", advice);
        }
        if model.wheels.iter().any(|w| carried(w.body)) {
            let advice = "put the wheel on a body that no spring moves";
            return refuse("a wheel on what it carries", advice);
        }
        if model.thrusters.iter().any(|t| carried(t.body)) {
            let advice = "put the thruster on a body that no spring moves";
            return refuse("a thruster on what it carries", advice);
        }
        if model.thrusters.iter().any(|t| t.propellant.is_some()) {
            let advice = "take specific_impulse_s out of the thrusters";
            return refuse("propellant that is used up", advice);
        }
        if model.environment.gravity_gradient {
            let advice = "take it out of [environment]";
            return refuse("a gravity gradient", advice);
        }
        if model.joints.iter().filter(|j| j.is_passive()).count() > MOST_MODES {
            let advice = "lock the stiffest ones by locked_at_rad or locked_at_m";
            return refuse("more than five others", advice);
        }
        Ok(())
    }

    /// Whether joints move a body against the base.
    fn moves_on_base(&self, body: usize) -> bool {
        let mut at = body;
        while let Some(joint) = self.model.bodies.get(at).and_then(|b| b.joint) {
            let joint = &self.model.joints[joint];
            if joint.kind != JointKind::Fixed {
                return true;
            }
            at = joint.parent;
        }
        false
    }

    /// The unknowns of maximum likelihood: barycentric ones unless nothing but the rotation of one body is
    /// seen.
    ///
    /// # Errors
    /// The problem is not valid.
    pub(crate) fn likelihood_parameters(&self) -> Result<Parameters, ProblemError> {
        self.parameters_or_momentum(match self.sees_points() {
            true => Equations::Momentum,
            false => self.linear_equations(),
        })
    }

    /// The unknowns of these equations; where they need a velocity that is not there, those of momentum.
    ///
    /// # Errors
    /// The problem is not valid.
    pub(crate) fn parameters_or_momentum(
        &self,
        equations: Equations,
    ) -> Result<Parameters, ProblemError> {
        match self.parameters(equations) {
            Err(fault) if fault.code() == NO_VELOCITY => self.parameters(Equations::Momentum),
            other => other,
        }
    }

    /// The unknowns of these equations.
    ///
    /// # Errors
    /// The problem is not valid for them.
    pub(crate) fn parameters(&self, equations: Equations) -> Result<Parameters, ProblemError> {
        Parameters::new(self.model, self.tree, equations, self.fires())
    }

    /// The equations that the linear method can write.
    pub(crate) fn linear_equations(&self) -> Equations {
        if self.sees_translation() {
            Equations::Momentum
        } else {
            Equations::Rotation
        }
    }

    /// Whether the readings of a segment, each at its own times, can be compared with a predicted motion.
    pub(crate) fn is_observed(&self, segment: &Segment) -> bool {
        let o = &segment.observations;
        o.is_whole(self.tree.dof(), self.tree.rotors.len())
    }

    /// # Errors
    /// A segment has fewer than two samples or grid times, or its readings are not all given at these.
    pub(crate) fn check_observations(&self) -> Result<(), ProblemError> {
        self.check_samples()?;
        match self.segments.iter().find(|s| !self.is_observed(s)) {
            Some(s) => Err(too_few_samples(&s.label, s.observations.time_s.len())),
            None => Ok(()),
        }
    }

    /// # Errors
    /// A segment has fewer than two samples.
    pub(crate) fn check_samples(&self) -> Result<(), ProblemError> {
        match self.segments.iter().find(|s| s.samples.time_s.len() < 2) {
            Some(s) => Err(too_few_samples(&s.label, s.samples.time_s.len())),
            None => Ok(()),
        }
    }

    /// # Errors
    /// More known numbers are uncertain than a fit takes in.
    pub(crate) fn check_known_numbers(&self) -> Result<(), ProblemError> {
        let numbers = self.model.uncertain().map(|u| u.number.components()).sum();
        match numbers > crate::problem::refusal::MOST_NUMBERS {
            true => Err(too_many(
                numbers,
                "uncertain known numbers",
                "write exact = true into tables that are known well enough",
            )),
            false => Ok(()),
        }
    }
}
