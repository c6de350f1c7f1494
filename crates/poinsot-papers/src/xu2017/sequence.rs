//! Sec. 3.1: the locked robot, then each joint, 1..n or n..1, with the composition rules (43)-(46).

mod bodies;
mod known;
mod mass;
mod readings;
mod report;
mod steps;

use super::least_squares::Answer;
use super::roles::{Roles, joint_name, roles};
use super::single_body::{
    Form, Part, Single, SingleObjective, SingleRow, accelerations, solve_single,
};
use super::swarm::{Objective, Range, Swarm, fly};
use super::{Kind, particle, properties};
use crate::xu2017::error;
use poinsot_dynamics::Kinematics;
use poinsot_files::Faults;
use poinsot_identify::{Problem, Segment};
use poinsot_model::MomentumKnowledge;
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};
pub use report::{Found, Searched, StepReport};

/// Sigmas that count as rest.
const REST: f64 = 5.0;

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
    let mut normal = Kinematics::new(problem.tree);
    normal.place(problem.tree, &roles.normal);
    let nominal = problem.model.bodies.iter().map(|b| b.nominal.parameters());
    let mut work = Work {
        problem,
        solver,
        order,
        normal,
        weighed: true,
        found: Found {
            bodies: nominal.collect(),
            total: None,
            normal: roles.normal.clone(),
            steps: Vec::new(),
            form: None,
            notes: Vec::new(),
        },
        roles,
    };
    let unknown: Vec<usize> = (0..problem.model.bodies.len())
        .filter(|&b| work.roles.unknown[b])
        .collect();
    match (unknown.as_slice(), work.roles.moving_segments()) {
        // Fourth use: all else is known, so any motion determines the body.
        ([one], 1..) => work.one_body(*one)?,
        (_, 0) => {
            work.single_body()?;
            work.share_out(&vec![None; problem.tree.dof()]);
        }
        _ => {
            if !work.roles.single.is_empty() {
                work.single_body()?;
            }
            let outers = work.joints()?;
            work.share_out(&outers);
            work.keep_known(&outers);
        }
    }
    Ok(work.found)
}

impl Work<'_> {
    /// The equivalent single body, Sec. 3.2.
    fn single_body(&mut self) -> Result<(), Faults> {
        let problem = self.problem;
        let segments: Vec<&Segment> = self
            .roles
            .single
            .iter()
            .map(|&k| &problem.segments[k])
            .collect();
        let measured = |s: &&Segment| s.accelerations.as_ref().is_some_and(|a| a.a_NS_B.is_some());
        let form = if segments.iter().all(measured) {
            Form::Acceleration
        } else {
            Form::Momentum
        };
        let rows: Vec<Vec<SingleRow>> = segments
            .iter()
            .map(|s| match form {
                Form::Acceleration => accelerations(&self.pushes(s)),
                Form::Momentum => self.impulses(s),
            })
            .collect();
        self.weighed =
            self.roles.part == Part::Inertia || rows.iter().flatten().any(|r| r.D.is_some());
        if !self.weighed {
            let note = match self.roles.moving_segments() {
                0 => {
                    "translation is not measured: the mass keeps its nominal value, which does not affect the answer"
                }
                _ => {
                    "the thrust segments show no translation: the mass of the whole follows from the first joint that moves"
                }
            };
            self.found.notes.push(note.to_owned());
        }
        let nominal = properties_of(&self.composite(0, |_| true))?;
        let linear = solve_single(&rows, form, &nominal, self.roles.part);
        let all: Vec<SingleRow> = rows.into_iter().flatten().collect();
        let objective = SingleObjective::new(&all);
        let mut range = self.range(&nominal);
        if self.roles.part == Part::Inertia || all.iter().any(|r| r.D.is_none()) {
            let x = particle(&nominal);
            let fixed: &[usize] = match self.roles.part {
                Part::Inertia => &[0, 7, 8, 9],
                Part::All => &[0],
            };
            for &d in fixed {
                (range.low[d], range.high[d]) = (x[d], x[d]);
            }
        }
        let name = "equivalent single body".to_owned();
        self.found.form = Some(form);
        let found = self.finish(Searched::Single, name, linear, &objective, range)?;
        self.found.total = Some(found.parameters());
        Ok(())
    }

    /// All two-body steps; returns the tip side of every moving joint, in the frame of its body.
    fn joints(&mut self) -> Result<Vec<Option<InertialParameters>>, Faults> {
        let dof = self.problem.tree.dof();
        let mut outers = vec![None; dof];
        let mut order: Vec<usize> = (0..dof)
            .filter(|&j| !self.roles.of_joint[j].is_empty())
            .collect();
        if self.order == Order::Inward {
            order.reverse();
        }
        if self.found.total.is_none() {
            // Third use: a known side of some joint sets the scale.
            let first = order.iter().position(|&j| {
                let child = self.child(j);
                self.known(|b| self.carries(child, b)) || self.known(|b| !self.carries(child, b))
            });
            let first = order.remove(first.ok_or_else(error::no_scale)?);
            outers[first] = Some(self.beside_known(first)?);
        } else if let Some(&joint) = order.first().filter(|_| !self.weighed) {
            self.weigh(joint)?;
        }
        for joint in order {
            outers[joint] = Some(self.split(joint)?);
        }
        Ok(outers)
    }

    /// Returns the linear solution, or runs the swarm and keeps both.
    fn finish(
        &mut self,
        part: Searched,
        name: String,
        linear: Answer<MassProperties>,
        objective: &dyn Objective,
        range: Range,
    ) -> Result<MassProperties, Faults> {
        if !linear.finite {
            return Err(error::not_finite());
        }
        let mut cost_linear = [0.0];
        objective.costs(&[particle(&linear.value)], &mut cost_linear);
        let flight = (self.solver.kind == Kind::Swarm).then(|| {
            let swarm = Swarm {
                seed: self.solver.swarm.seed + 1000 * self.found.steps.len() as u64,
                ..self.solver.swarm.clone()
            };
            (fly(&swarm, &range, objective, |_, _, _| {}), range)
        });
        let found = match &flight {
            Some((flight, _)) => properties(&flight.best),
            None => linear.value,
        };
        let smallest = linear.singular.get(linear.rank.wrapping_sub(1));
        let condition = match (linear.singular.first(), smallest) {
            (Some(a), Some(b)) => a / b,
            _ => f64::INFINITY,
        };
        self.found.steps.push(StepReport {
            part,
            name,
            found,
            linear: linear.value,
            cost_linear: cost_linear[0],
            cost_noise: self.cost_noise(),
            rank: linear.rank,
            condition,
            flight,
        });
        Ok(found)
    }

    /// Momentum equivalent to the velocity noise; accelerations have no declared noise.
    fn cost_noise(&self) -> f64 {
        let accelerations = self.found.form == Some(Form::Acceleration);
        let segments = self.problem.segments.iter();
        let seen = segments.filter(|s| s.samples.translation.is_some()).count();
        if seen == 0 || accelerations && self.roles.moving_segments() == 0 {
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
        for at in segments {
            let segment = &self.problem.segments[at];
            let s = &segment.samples;
            let rate = s.w_NB_B.first().map_or(0.0, |w| w.norm());
            let speed = s
                .translation
                .as_ref()
                .and_then(|t| t.v_NBo_N.first())
                .map_or(0.0, |v| v.norm());
            let still = |x: f64, variance: f64| x <= REST * variance.sqrt() + 1.0e-12;
            if !still(rate, noise.gyro.trace()) || !still(speed, noise.velocity.trace()) {
                return Err(error::not_at_rest(&segment.label, rate, speed, "swarm"));
            }
        }
        let note = "assumed: zero momentum, as in (49), because the base is at rest within the noise at first";
        if !self.found.notes.iter().any(|n| n == note) {
            self.found.notes.push(note.to_owned());
        }
        Ok(())
    }

    fn words(&self, part: Searched) -> String {
        let joint = |j| joint_name(self.problem, j);
        match part {
            Searched::Single => "equivalent single body".to_owned(),
            Searched::Inner(j) => format!("base side of {}", joint(j)),
            Searched::Outer(j) => format!("tip side of {}", joint(j)),
            Searched::Body(b) => self.problem.model.bodies[b].name.clone(),
        }
    }
}

fn properties_of(pi: &InertialParameters) -> Result<Single, Faults> {
    pi.mass_properties()
        .ok_or_else(poinsot_identify::refusal::no_motion)
}

/// Mass properties, NaN if the mass is not positive: the cost of such a solution is still computed.
fn properties_or_nan(pi: &InertialParameters) -> MassProperties {
    pi.mass_properties().unwrap_or(MassProperties {
        mass: pi.mass,
        p_BoBcm_B: Vector3::repeat(f64::NAN),
        I_BBcm_B: pi.I_BBo_B,
    })
}
