//! Sec. 3.1: the locked robot first, then joint after joint, 1..n or n..1, with the bookkeeping of (43)-(46).

mod bodies;
mod known;
mod mass;
mod readings;
mod report;

use super::error::Xu2017Error;
use super::least_squares::{Answer, Rows, answer, shown};
use super::roles::{Roles, joint_name, roles};
use super::single_body::{
    Form, Part, Single, SingleObjective, SingleRow, accelerations, solve_single,
};
use super::swarm::{Objective, Range, Swarm, fly};
use super::two_body::{
    MomentumRow, TwoBodyObjective, TwoBodyReading, rows, transported, transported_back,
};
use super::{Kind, particle, properties, sum};
use nalgebra::SVector;
use poinsot_dynamics::Kinematics;
use poinsot_identify::{Problem, Segment};
use poinsot_model::MomentumKnowledge;
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use readings::side;
pub use report::{Found, Searched, StepReport};

/// Random motions that say what a joint can show at all.
const MOTIONS: usize = 40;
/// Sigmas that count as rest.
const REST: f64 = 5.0;

/// Joints from the base to the tip, or back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// 1..n: the base side is searched, as in (62).
    Outward,
    /// n..1: the tip side is searched.
    Inward,
}

/// How a step is solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// Linear solution or swarm.
    pub kind: Kind,
    /// The swarm.
    pub swarm: Swarm,
    /// Half-width of the search range as a share of the nominal mass, moments of inertia and radius of
    /// gyration.
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

/// Everything that the steps share.
struct Work<'a> {
    problem: &'a Problem<'a>,
    roles: Roles,
    solver: &'a Solver,
    order: Order,
    /// Placement in the normal configuration.
    normal: Kinematics,
    /// Whether the mass of the whole is known or was seen in translation.
    weighed: bool,
    found: Found,
}

/// Identifies every unknown body of a problem.
///
/// # Errors
/// The question cannot be put to this method.
pub fn sequence(problem: &Problem, order: Order, solver: &Solver) -> Result<Found, Xu2017Error> {
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
        // Fourth use: everything else is known, so the body follows from any motion.
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
    fn single_body(&mut self) -> Result<(), Xu2017Error> {
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
                    "translation is not seen: the mass stays at its nominal value, which no number of the answer rests on"
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

    /// All two-body steps; the tip side of every joint that moves, in the frame of its body.
    fn joints(&mut self) -> Result<Vec<Option<InertialParameters>>, Xu2017Error> {
        let dof = self.problem.tree.dof();
        let mut outers = vec![None; dof];
        let mut order: Vec<usize> = (0..dof)
            .filter(|&j| !self.roles.of_joint[j].is_empty())
            .collect();
        if self.order == Order::Inward {
            order.reverse();
        }
        if self.found.total.is_none() {
            // Third use: one side of some joint is known and sets the scale.
            let first = order.iter().position(|&j| {
                let child = self.child(j);
                self.known(|b| self.carries(child, b)) || self.known(|b| !self.carries(child, b))
            });
            let first = order.remove(first.ok_or(Xu2017Error::NoScale)?);
            outers[first] = Some(self.beside_known(first)?);
        } else if let Some(&joint) = order.first().filter(|_| !self.weighed) {
            self.weigh(joint)?;
        }
        for joint in order {
            outers[joint] = Some(self.split(joint)?);
        }
        Ok(outers)
    }

    /// A joint with one side known: the other side, and with it the whole.
    fn beside_known(&mut self, joint: usize) -> Result<InertialParameters, Xu2017Error> {
        let child = self.child(joint);
        let inner_known = self.known(|b| !self.carries(child, b));
        let inner = self.composite(0, |b| !self.carries(child, b));
        let outer = self.composite(child, |b| self.carries(child, b));
        let readings = self.readings(joint)?;
        let (R, p) = (self.normal.R[child], self.normal.p[child]);
        let outer = if inner_known {
            let compose = |x: &InertialParameters| [inner, *x];
            let part = Searched::Outer(joint);
            self.two_body(part, &readings, &compose, &outer, None)?
        } else {
            let compose = |x: &InertialParameters| [*x, outer];
            let part = Searched::Inner(joint);
            let inner = self.two_body(part, &readings, &compose, &inner, None)?;
            self.found.total = Some(sum(&inner, &transported(&outer, &R, &p), 1.0));
            return Ok(outer);
        };
        self.found.total = Some(sum(&inner, &transported(&outer, &R, &p), 1.0));
        Ok(outer)
    }

    /// A joint of a robot whose whole is known: one side is searched, the other is the rest, (43)-(46).
    fn split(&mut self, joint: usize) -> Result<InertialParameters, Xu2017Error> {
        let child = self.child(joint);
        let total = self.found.total.ok_or(Xu2017Error::NoScale)?;
        let (R, p) = (self.normal.R[child], self.normal.p[child]);
        let rest = |inner: &InertialParameters| transported_back(&sum(&total, inner, -1.0), &R, &p);
        if self.known(|b| !self.carries(child, b)) {
            return Ok(rest(&self.composite(0, |b| !self.carries(child, b))));
        }
        let readings = self.readings(joint)?;
        // The whole is subtracted in `compose`, so that rows are affine in the searched side.
        match self.order {
            Order::Outward => {
                let nominal = self.composite(0, |b| !self.carries(child, b));
                let compose = |x: &InertialParameters| [*x, rest(x)];
                let part = Searched::Inner(joint);
                let inner = self.two_body(part, &readings, &compose, &nominal, Some(total.mass))?;
                Ok(rest(&inner))
            }
            Order::Inward => {
                let nominal = self.composite(child, |b| self.carries(child, b));
                let compose =
                    |x: &InertialParameters| [sum(&total, &transported(x, &R, &p), -1.0), *x];
                let part = Searched::Outer(joint);
                self.two_body(part, &readings, &compose, &nominal, Some(total.mass))
            }
        }
    }

    /// One unknown body, all others known, any joints in motion.
    fn one_body(&mut self, body: usize) -> Result<(), Xu2017Error> {
        let segments = self.roles.of_joint.iter().flatten();
        let mut list: Vec<usize> = segments.chain(&self.roles.together).copied().collect();
        list.sort_unstable();
        if !self.roles.single.is_empty() {
            self.found.notes.push(
                "segments with thrust are not used: one body among known ones follows from the momentum alone"
                    .to_owned(),
            );
        }
        let mut readings = Vec::new();
        for at in list {
            let measured = self.measured(at, body, None)?;
            readings.push((at, measured));
        }
        let compose = |x: &InertialParameters| [InertialParameters::ZERO, *x];
        let nominal = self.found.bodies[body];
        let part = Searched::Body(body);
        self.found.bodies[body] = self.two_body(part, &readings, &compose, &nominal, None)?;
        Ok(())
    }

    /// Solves (49) for one side, by the swarm or linearly. Readings per segment.
    fn two_body(
        &mut self,
        part: Searched,
        readings: &[(usize, Vec<TwoBodyReading>)],
        compose: &dyn Fn(&InertialParameters) -> [InertialParameters; 2],
        nominal: &InertialParameters,
        total: Option<f64>,
    ) -> Result<InertialParameters, Xu2017Error> {
        let properties = properties_of(nominal)?;
        let natural = natural(&properties);
        let free = self.momentum_is_free();
        let heads = if free { 6 * readings.len() } else { 0 };
        let mut system = Rows::new(heads, 10);
        let mut all = Vec::new();
        for (k, (_, list)) in readings.iter().enumerate() {
            let list = rows(list, compose);
            let head = free.then_some(6 * k);
            list.iter()
                .for_each(|row| push(&mut system, row, &[], head, heads));
            all.extend(list);
        }
        let seen = self.seen(part, compose, &natural);
        let start = nominal.to_array();
        let linear = answer(system, &natural, &start, seen.as_ref());
        let linear = linear.map(|x| {
            let mut ten = [0.0; 10];
            ten.copy_from_slice(&x);
            InertialParameters::from_array(&ten)
        });
        if self.solver.kind == Kind::Swarm {
            self.check_rest(readings.iter().map(|r| r.0))?;
        }
        let rest = self.rest_mass(part);
        let objective = TwoBodyObjective::new(&all, total, rest);
        let range = self.range(&properties);
        let name = self.words(part);
        let barycentric = linear.value;
        let as_properties = linear.map(|x| properties_or_nan(&x));
        let found = self.finish(part, name, as_properties, &objective, range)?;
        // Straight from the solution, without the detour over the mass centre.
        Ok(if self.solver.kind == Kind::Linear {
            barycentric
        } else {
            found.parameters()
        })
    }

    /// Directions that some motion of the joint shows: three of ten are hidden for a revolute one.
    fn seen(
        &self,
        part: Searched,
        compose: &dyn Fn(&InertialParameters) -> [InertialParameters; 2],
        natural: &[f64; 10],
    ) -> Option<faer::Mat<f64>> {
        let (Searched::Inner(joint) | Searched::Outer(joint)) = part else {
            return None;
        };
        shown(&equations(&rows(&self.motions(joint), compose)), natural)
    }

    /// Random motions of one joint and the base.
    fn motions(&self, joint: usize) -> Vec<TwoBodyReading> {
        let child = self.child(joint);
        let mut rng = ChaCha8Rng::seed_from_u64(2017);
        let mut number = || (rng.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let mut kinematics = Kinematics::new(self.problem.tree);
        let mut q = self.roles.normal.clone();
        let mut rates = vec![0.0; q.len()];
        (0..MOTIONS)
            .map(|_| {
                q[joint] = self.roles.normal[joint] + number();
                rates[joint] = number();
                let mut vector = || Vector3::new(number(), number(), number());
                let (v, w) = (vector(), vector());
                kinematics.place(self.problem.tree, &q);
                kinematics.set_velocities(self.problem.tree, &v, &w, &rates);
                TwoBodyReading {
                    R_NB: Default::default(),
                    p_NoBo_N: Vector3::zeros(),
                    inner: side(&kinematics, 0),
                    outer: side(&kinematics, child),
                    rest: [Vector3::zeros(); 3],
                }
            })
            .collect()
    }

    /// The linear solution, or the swarm's beside it.
    fn finish(
        &mut self,
        part: Searched,
        name: String,
        linear: Answer<MassProperties>,
        objective: &dyn Objective,
        range: Range,
    ) -> Result<MassProperties, Xu2017Error> {
        if !linear.finite {
            return Err(Xu2017Error::NotFinite);
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

    /// Momentum that the noise of the velocity stands for; accelerations declare none.
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

    /// The swarm's objective takes momentum as zero: the vehicle must start at rest.
    fn check_rest(&mut self, segments: impl Iterator<Item = usize>) -> Result<(), Xu2017Error> {
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
                return Err(Xu2017Error::NotAtRest {
                    label: segment.label.clone(),
                    rate,
                    speed,
                    variant: "swarm",
                });
            }
        }
        let note = "momentum is taken as zero, as in (49): the base is at rest within the noise at the first sample";
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

/// The six equations of every row in base axes.
fn equations(list: &[MomentumRow]) -> Vec<[f64; 10]> {
    let of = |row: &MomentumRow| {
        let slope = row.slope;
        [0, 1, 2, 6, 7, 8].map(|i| std::array::from_fn(|j| slope[(i, j)]))
    };
    list.iter().flat_map(of).collect()
}

/// The six equations of a sample in N: momentum about the inertial origin, zero or that of the segment. `extra`
/// are columns of further unknowns.
fn push(
    system: &mut Rows,
    row: &MomentumRow,
    extra: &[SVector<f64, 9>],
    head: Option<usize>,
    heads: usize,
) {
    let to_N = |column: &[f64]| {
        let l = Vector3::from_column_slice(&column[..3]);
        let h = Vector3::from_column_slice(&column[6..9]);
        let P = row.R_NB * l;
        (P, row.R_NB * h + row.p_NoBo_N.cross(&P))
    };
    let own = (0..10).map(|j| to_N(row.slope.column(j).as_slice()));
    let more = extra.iter().map(|column| to_N(column.as_slice()));
    let columns: Vec<(Vector3, Vector3)> = own.chain(more).collect();
    let (P, H) = to_N(row.constant.as_slice());
    for i in 0..6 {
        let pick = |c: &(Vector3, Vector3)| if i < 3 { c.0[i] } else { c.1[i - 3] };
        let mut left = vec![0.0; heads + columns.len()];
        if let Some(head) = head {
            left[head + i] = -1.0;
        }
        for (slot, column) in left[heads..].iter_mut().zip(&columns) {
            *slot = pick(column);
        }
        system.push(&left, -pick(&(P, H)));
    }
}

/// Natural units m, m L, m L^2 of the ten parameters.
fn natural(body: &MassProperties) -> [f64; 10] {
    let (m, L) = (body.mass, body.radius_of_gyration().max(1.0e-3));
    std::array::from_fn(|k| match k {
        0 => m,
        1..=3 => m * L,
        _ => m * L * L,
    })
}

fn properties_of(pi: &InertialParameters) -> Result<Single, Xu2017Error> {
    pi.mass_properties().ok_or(Xu2017Error::Problem(
        poinsot_identify::ProblemError::NoMotion,
    ))
}

/// Mass, mass centre and tensor even where the mass is not positive: the cost of an odd solution is asked for.
fn properties_or_nan(pi: &InertialParameters) -> MassProperties {
    pi.mass_properties().unwrap_or(MassProperties {
        mass: pi.mass,
        p_BoBcm_B: Vector3::repeat(f64::NAN),
        I_BBcm_B: pi.I_BBo_B,
    })
}
