//! Sec. 3.1: the locked robot, then each joint, 1..n or n..1, with the composition rules (43)-(46).

mod parts;
mod steps;

use super::least_squares::Answer;
use super::roles::{Roles, roles};
use super::single_body::{
    Form, Part, Single, SingleObjective, SingleRow, accelerations, solve_single,
};
use super::swarm::{Flight, Objective, Range, Swarm};
use super::{Kind, particle, properties};
use poinsot_dynamics::Kinematics;
use poinsot_files::{Faults, Place, rounded};
use poinsot_identify::{Problem, Segment};
use poinsot_model::MomentumKnowledge;
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};

/// Sigmas that count as rest.
const REST: f64 = 5.0;
/// A swarm whose cost stays above this fraction of its first best has not converged.
const ARRIVED: f64 = 1.0e-6;
/// Fraction of the noise cost below which cost differences are negligible.
const UNSEEN: f64 = 0.1;

/// Joints from base to tip, or reverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// 1..n: solves for the base side, as in (62).
    Outward,
    /// n..1: solves for the tip side.
    Inward,
}

/// Solver of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// Linear solution or swarm.
    pub kind: Kind,
    /// The swarm.
    pub swarm: Swarm,
    /// Half-width of the search range relative to nominal mass, moments of inertia and radius of gyration.
    pub share: f64,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            kind: Kind::Linear,
            swarm: Swarm::default(),
            share: 0.5,
        }
    }
}

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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Found {
    /// Barycentric parameters of every body about its own origin.
    pub bodies: Vec<InertialParameters>,
    /// The locked robot in the normal configuration about the base origin.
    pub total: Option<InertialParameters>,
    /// Steps in the order taken.
    pub steps: Vec<StepReport>,
    /// Form of (35) used.
    pub form: Option<Form>,
    /// Assumptions made.
    pub notes: Vec<String>,
}

/// Common data of the steps.
struct Work<'a> {
    problem: &'a Problem<'a>,
    roles: Roles,
    solver: &'a Solver,
    order: Order,
    /// Placement in the normal configuration.
    normal: Kinematics,
    /// Whether the total mass is known or determined from translation.
    weighed: bool,
    found: Found,
}

/// Identifies every unknown body of a problem.
///
/// # Errors
/// The method cannot be applied.
///
/// ```
#[doc = include_str!("../../doc/record.txt")]
/// use poinsot_papers::xu2017::{Order, Solver, sequence};
///
/// let input = record("xu2017", "xu2017/model.toml", "xu2017/C1/telemetry.parquet")?;
/// let found = sequence(&problem(&input), Order::Outward, &Solver::default())?;
/// // One step, the locked robot as a single body, with all ten numbers.
/// assert_eq!((found.steps.len(), found.total.is_some()), (1, true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sequence(problem: &Problem, order: Order, solver: &Solver) -> Result<Found, Faults> {
    let roles = roles(problem)?;
    let normal = Kinematics::at(problem.tree, &roles.normal);
    let nominal = problem.model.bodies.iter().map(|b| b.nominal.parameters());
    let mut work = Work {
        problem,
        solver,
        order,
        normal,
        weighed: true,
        found: Found {
            bodies: nominal.collect(),
            ..Found::default()
        },
        roles,
    };
    let bodies = 0..problem.model.bodies.len();
    let unknown: Vec<usize> = bodies.filter(|&b| work.roles.unknown[b]).collect();
    let moving = work.roles.moving_segments();
    if let ([one], 1..) = (unknown.as_slice(), moving) {
        // Fourth use: all else is known, so any motion determines the body.
        work.one_body(*one)?;
        return Ok(work.found);
    }
    if !work.roles.single.is_empty() {
        work.single_body()?;
    }
    let outers = match moving {
        0 => vec![None; problem.tree.dof()],
        _ => work.joints()?,
    };
    work.share_out(&outers);
    work.keep_known(&outers);
    Ok(work.found)
}

impl Work<'_> {
    /// The equivalent single body, Sec. 3.2.
    fn single_body(&mut self) -> Result<(), Faults> {
        let problem = self.problem;
        let segments = self.roles.single.iter().map(|&k| &problem.segments[k]);
        let segments: Vec<&Segment> = segments.collect();
        let measured = |s: &&Segment| s.accelerations.as_ref().is_some_and(|a| a.a_NS_B.is_some());
        let form = match segments.iter().all(measured) {
            true => Form::Acceleration,
            false => Form::Momentum,
        };
        let rows = |s: &&Segment| match form {
            Form::Acceleration => accelerations(&self.pushes(s)),
            Form::Momentum => self.impulses(s),
        };
        let rows: Vec<Vec<SingleRow>> = segments.iter().map(rows).collect();
        let part = self.roles.part;
        self.weighed = part == Part::Inertia || rows.iter().flatten().any(|r| r.D.is_some());
        if !self.weighed {
            self.found.notes.push(match self.roles.moving_segments() {
                0 => "translation is not measured: the mass keeps its nominal value, which does not affect the answer",
                _ => "the thrust segments show no translation: the mass of the whole follows from the first joint that moves",
            }.to_owned());
        }
        let nominal = properties_of(&self.composite(0, |_| true))?;
        let linear = solve_single(&rows, form, &nominal, part);
        let all: Vec<SingleRow> = rows.into_iter().flatten().collect();
        let mut range = self.range(&nominal);
        let x = particle(&nominal);
        let fixed: &[usize] = match part {
            Part::Inertia => &[0, 7, 8, 9],
            Part::All if all.iter().any(|r| r.D.is_none()) => &[0],
            Part::All => &[],
        };
        for &d in fixed {
            (range.low[d], range.high[d]) = (x[d], x[d]);
        }
        self.found.form = Some(form);
        let objective = SingleObjective::new(&all);
        let found = self.finish(Searched::Single, linear, &objective, range)?;
        self.found.total = Some(found.parameters());
        Ok(())
    }

    /// All two-body steps; returns the tip side of every moving joint, in the frame of its body.
    fn joints(&mut self) -> Result<Vec<Option<InertialParameters>>, Faults> {
        let dof = self.problem.tree.dof();
        let moved = (0..dof).filter(|&j| !self.roles.of_joint[j].is_empty());
        let mut order: Vec<usize> = moved.collect();
        if self.order == Order::Inward {
            order.reverse();
        }
        if self.found.total.is_none() {
            // Third use: a known side of some joint sets the scale.
            let known = |&j: &usize| self.sides_known(j).contains(&true);
            let first = order.iter().position(known).ok_or_else(no_scale)?;
            let joint = order.remove(first);
            order.insert(0, joint);
        } else if let Some(&joint) = order.first().filter(|_| !self.weighed) {
            self.weigh(joint)?;
        }
        let mut outers = vec![None; dof];
        for joint in order {
            outers[joint] = Some(self.split(joint)?);
        }
        Ok(outers)
    }

    /// Returns the linear solution, or runs the swarm and keeps both.
    fn finish(
        &mut self,
        part: Searched,
        linear: Answer<MassProperties>,
        objective: &dyn Objective,
        range: Range,
    ) -> Result<MassProperties, Faults> {
        if !linear.finite {
            return Err(not_finite());
        }
        let mut cost_linear = [0.0];
        objective.costs(&[particle(&linear.value)], &mut cost_linear);
        let mut flight = None;
        if self.solver.kind == Kind::Swarm {
            let swarm = Swarm {
                seed: self.solver.swarm.seed + 1000 * self.found.steps.len() as u64,
                ..self.solver.swarm.clone()
            };
            flight = Some((swarm.fly(&range, objective)?, range));
        }
        let best = flight.as_ref().map(|(flight, _)| properties(&flight.best));
        let found = best.unwrap_or(linear.value);
        let smallest = linear.singular.get(linear.rank.wrapping_sub(1));
        let ends = linear.singular.first().zip(smallest);
        self.found.steps.push(StepReport {
            part,
            name: self.name(part),
            found,
            linear: linear.value,
            cost_linear: cost_linear[0],
            cost_noise: self.cost_noise(),
            rank: linear.rank,
            condition: ends.map_or(f64::INFINITY, |(a, b)| a / b),
            flight,
        });
        Ok(found)
    }

    /// Momentum equivalent to the velocity noise; accelerations have no declared noise.
    fn cost_noise(&self) -> f64 {
        let accelerations = self.found.form == Some(Form::Acceleration);
        let mut segments = self.problem.segments.iter();
        let seen = segments.any(|s| s.samples.translation.is_some());
        if !seen || accelerations && self.roles.moving_segments() == 0 {
            return 0.0;
        }
        self.composite(0, |_| true).mass * self.problem.noise.velocity.trace().sqrt()
    }

    fn momentum_is_free(&self) -> bool {
        let zero = MomentumKnowledge::Known(Vector3::zeros());
        let given = self.problem.model.momentum;
        given.linear != zero || given.angular != zero
    }

    /// The swarm's objective assumes zero momentum: checks that the vehicle starts at rest.
    fn check_rest(&mut self, segments: impl Iterator<Item = usize>) -> Result<(), Faults> {
        if !self.momentum_is_free() {
            return Ok(());
        }
        let noise = self.problem.noise;
        for segment in segments.map(|at| &self.problem.segments[at]) {
            let s = &segment.samples;
            let velocity = s.translation.as_ref().and_then(|t| t.v_NBo_N.first());
            let [rate, speed] = [s.w_NB_B.first(), velocity].map(|v| v.map_or(0.0, |v| v.norm()));
            let still = |x: f64, variance: f64| x <= REST * variance.sqrt() + 1.0e-12;
            if !still(rate, noise.gyro.trace()) || !still(speed, noise.velocity.trace()) {
                let place = Place::item("segment", &segment.label);
                let what = format!(
                    "the vehicle moves at {} rad/s and {} m/s at the first sample: the objective (52) assumes zero momentum, so variant swarm must start at rest",
                    rounded(rate, 2),
                    rounded(speed, 2)
                );
                let advice = "use --variant linear, which takes the momentum as unknown";
                return Err(Faults::one("E0538", place, what, advice));
            }
        }
        let note = "assumed: zero momentum, as in (49), because the base is at rest within the noise at first";
        if !self.found.notes.iter().any(|n| n == note) {
            self.found.notes.push(note.to_owned());
        }
        Ok(())
    }
}

/// Neither thrust nor a known body sets the scale.
fn no_scale() -> Faults {
    let what = "no thruster fires with the joints locked, and no body fixes the scale of the momentum equations (35)";
    let advice =
        "add a segment with thrust, take estimate out of the base or the arm, or use --method auto";
    Faults::one("E0533", Place::default(), what, advice)
}

fn not_finite() -> Faults {
    let what = "the equations hold a number that is not finite";
    let advice = "check units and magnitudes of the telemetry";
    Faults::one("E0540", Place::default(), what, advice)
}

fn properties_of(pi: &InertialParameters) -> Result<Single, Faults> {
    let found = pi.mass_properties();
    found.ok_or_else(poinsot_identify::refusal::no_motion)
}
