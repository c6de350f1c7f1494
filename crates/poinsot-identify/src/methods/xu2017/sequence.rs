//! Sec. 3.1: the locked robot first, then joint after joint, 1..n or n..1, with the bookkeeping of (43)-(46).

use super::error::Xu2017Error;
use super::least_squares::{Answer, Rows, answer, shown};
use super::roles::{Roles, joint_name, roles};
use super::single_body::{
    Form, Part, Push, Single, SingleObjective, SingleRow, accelerations, momenta, solve_single,
};
use super::swarm::{Flight, Objective, Particle, Range, Swarm, fly};
use super::two_body::{
    MomentumRow, Side, TwoBodyObjective, TwoBodyReading, rows, transported, transported_back,
};
use super::{Kind, particle, properties, sum};
use crate::impulse;
use crate::problem::Problem;
use crate::segment::Segment;
use poinsot_dynamics::{Kinematics, body_momentum};
use poinsot_model::MomentumKnowledge;
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Random motions that say what a joint can show at all.
const MOTIONS: usize = 40;
/// Sigmas that count as rest.
const REST: f64 = 5.0;
/// A swarm whose cost stays above this share of its first best has not arrived.
const ARRIVED: f64 = 1.0e-6;
/// Share of the cost that the declared noise leaves, below which costs say the same.
const UNSEEN: f64 = 0.1;

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

/// Everything that the steps share.
struct Work<'a> {
    problem: &'a Problem<'a>,
    roles: Roles,
    solver: &'a Solver,
    order: Order,
    /// Placement in the normal configuration.
    normal: Kinematics,
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
        if self.roles.part == Part::All && rows.iter().flatten().any(|r| r.D.is_none()) {
            self.found.notes.push(
                "translation is not seen: the mass stays at its nominal value, which no number of the answer rests on".to_owned(),
            );
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

    /// Samples of (35): thrust in base axes with the accelerations.
    fn pushes(&self, segment: &Segment) -> Vec<Push> {
        let Some(measured) = &segment.accelerations else {
            return Vec::new();
        };
        let s = &segment.samples;
        (0..s.time_s.len().min(measured.dw_NB_B.len()))
            .map(|k| {
                let (F_B, T_B) = self.thrust(segment, s.time_s[k]);
                Push {
                    w_NB_B: s.w_NB_B[k],
                    dw_NB_B: measured.dw_NB_B[k],
                    a_NS_B: measured.a_NS_B.as_ref().map(|a| a[k]),
                    p_BoS_B: measured.p_BoS_B,
                    F_B,
                    T_B,
                }
            })
            .collect()
    }

    /// Force and moment about the base origin just after a time.
    fn thrust(&self, segment: &Segment, time: f64) -> (Vector3, Vector3) {
        let on = segment
            .firings
            .iter()
            .filter(|f| f.start_s <= time + 1.0e-9 && time + 1.0e-9 < f.end_s);
        on.fold((Vector3::zeros(), Vector3::zeros()), |(F, T), firing| {
            let thruster = &self.problem.model.thrusters[firing.thruster];
            let R = &self.normal.R[thruster.body];
            let f = R * thruster.direction_B * firing.force;
            let r = self.normal.p[thruster.body] + R * thruster.p_BoT_B;
            (F + f, T + r.cross(&f))
        })
    }

    /// (35) integrated, with the impulse about the base origin.
    fn impulses(&self, segment: &Segment) -> Vec<SingleRow> {
        let mut turning = segment.clone();
        turning.samples.translation = None;
        let tree = self.problem.tree;
        let sums = impulse::integrate(tree, &self.problem.model.thrusters, &turning);
        let since: Vec<_> = sums
            .total
            .iter()
            .map(|i| (i.linear, i.angular, i.per_mass_centre))
            .collect();
        let s = &segment.samples;
        let velocity = s.translation.as_ref().map(|t| t.v_NBo_N.as_slice());
        momenta(&s.R_NB, velocity, &s.w_NB_B, &since)
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
                .for_each(|row| push(&mut system, row, head, heads));
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
        let child = self.child(joint);
        let mut rng = ChaCha8Rng::seed_from_u64(2017);
        let mut number = || (rng.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let mut kinematics = Kinematics::new(self.problem.tree);
        let mut q = self.roles.normal.clone();
        let mut rates = vec![0.0; q.len()];
        let readings: Vec<TwoBodyReading> = (0..MOTIONS)
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
            .collect();
        let list: Vec<[f64; 10]> = rows(&readings, compose)
            .iter()
            .flat_map(|row| {
                let slope = row.slope;
                [0, 1, 2, 6, 7, 8].map(|i| std::array::from_fn(|j| slope[(i, j)]))
            })
            .collect();
        shown(&list, natural)
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

    /// Readings of the segments in which a joint moves alone.
    fn readings(&self, joint: usize) -> Result<Vec<(usize, Vec<TwoBodyReading>)>, Xu2017Error> {
        let child = self.child(joint);
        let of = |&at: &usize| Ok((at, self.measured(at, child, Some(joint))?));
        self.roles.of_joint[joint].iter().map(of).collect()
    }

    /// Both sides at every sample: with `alone` all other joints stand in the normal configuration; without,
    /// every joint moves and all bodies but `body` are known.
    fn measured(
        &self,
        at: usize,
        body: usize,
        alone: Option<usize>,
    ) -> Result<Vec<TwoBodyReading>, Xu2017Error> {
        let (tree, segment) = (self.problem.tree, &self.problem.segments[at]);
        let s = &segment.samples;
        let translation = s.translation.as_ref().ok_or(Xu2017Error::NoVelocity {
            label: segment.label.clone(),
            what: "the momentum of a moving joint",
        })?;
        let dof = tree.dof();
        let mut kinematics = Kinematics::new(tree);
        let mut q = self.roles.normal.clone();
        let mut rates = vec![0.0; dof];
        let list = (0..s.time_s.len()).map(|k| {
            for j in (0..dof).filter(|&j| alone.is_none_or(|a| a == j)) {
                q[j] = s.joint_position[k * dof + j];
                rates[j] = s.joint_rate[k * dof + j];
            }
            let v = s.R_NB[k].inverse() * translation.v_NBo_N[k];
            kinematics.place(tree, &q);
            kinematics.set_velocities(tree, &v, &s.w_NB_B[k], &rates);
            let mut rest = [Vector3::zeros(); 3];
            if alone.is_none() {
                for (b, pi) in self
                    .found
                    .bodies
                    .iter()
                    .enumerate()
                    .filter(|(b, _)| *b != body)
                {
                    let m = &kinematics;
                    let (l, h) = body_momentum(pi, &m.R[b], &m.p[b], &m.v[b], &m.w[b]);
                    let first = m.R[b] * pi.mc_B + m.p[b] * pi.mass;
                    rest = [rest[0] + l, rest[1] + h, rest[2] + first];
                }
            }
            TwoBodyReading {
                R_NB: s.R_NB[k],
                p_NoBo_N: translation.p_NoBo_N[k],
                inner: side(&kinematics, 0),
                outer: side(&kinematics, body),
                rest,
            }
        });
        Ok(list.collect())
    }

    /// Bodies from the whole and the tip sides: what a part carries beyond itself is taken off, (43)-(46).
    /// Bodies that no moving joint parts are one; the first unknown of them takes the difference.
    fn share_out(&mut self, outers: &[Option<InertialParameters>]) {
        let Some(total) = self.found.total else {
            return;
        };
        let bodies = self.problem.model.bodies.len();
        // The body at the root of what each body is rigidly part of.
        let mut root: Vec<usize> = vec![0; bodies];
        for b in 1..bodies {
            let cut = (0..outers.len()).find(|&j| self.child(j) == b && outers[j].is_some());
            root[b] = cut.map_or(root[self.parent(b)], |_| b);
        }
        for r in (0..bodies).filter(|&r| root[r] == r) {
            let whole = (0..outers.len())
                .find(|&j| r != 0 && self.child(j) == r)
                .and_then(|j| outers[j])
                .unwrap_or(total);
            let mut own = whole;
            for (j, outer) in outers.iter().enumerate() {
                let c = self.child(j);
                let Some(outer) = outer.filter(|_| root[self.parent(c)] == r && c != r) else {
                    continue;
                };
                own = sum(&own, &self.moved(&outer, c, r), -1.0);
            }
            let members: Vec<usize> = (0..bodies).filter(|&b| root[b] == r).collect();
            let Some(&takes) = members.iter().find(|&&b| self.roles.unknown[b]) else {
                continue;
            };
            for &b in members.iter().filter(|&&b| b != takes) {
                own = sum(&own, &self.moved(&self.found.bodies[b], b, r), -1.0);
            }
            self.found.bodies[takes] = self.moved(&own, r, takes);
        }
    }

    /// Parameters of something fixed to body `from`, about and along the frame of body `to`, in the normal
    /// configuration.
    fn moved(&self, what: &InertialParameters, from: usize, to: usize) -> InertialParameters {
        let n = &self.normal;
        let inverse = n.R[to].transpose();
        transported(
            what,
            &(inverse * n.R[from]),
            &(inverse * (n.p[from] - n.p[to])),
        )
    }

    /// Nominal bodies as one, in the frame of body `frame`.
    fn composite(&self, frame: usize, takes: impl Fn(usize) -> bool) -> InertialParameters {
        let bodies = self.problem.model.bodies.iter().enumerate();
        bodies
            .filter(|(b, _)| takes(*b))
            .fold(InertialParameters::ZERO, |all, (b, body)| {
                sum(&all, &self.moved(&body.nominal.parameters(), b, frame), 1.0)
            })
    }

    fn child(&self, joint: usize) -> usize {
        self.problem.model.joints[self.problem.tree.coordinates[joint]].child
    }

    fn parent(&self, body: usize) -> usize {
        self.problem.tree.links[body].parent
    }

    /// Whether body `b` hangs on body `root` or is it.
    fn carries(&self, root: usize, mut b: usize) -> bool {
        while b != root && b != 0 {
            b = self.parent(b);
        }
        b == root
    }

    fn known(&self, among: impl Fn(usize) -> bool) -> bool {
        (0..self.roles.unknown.len()).all(|b| !among(b) || !self.roles.unknown[b])
    }

    fn rest_mass(&self, part: Searched) -> f64 {
        let takes = |b: usize| match part {
            Searched::Single => false,
            Searched::Inner(j) => self.carries(self.child(j), b),
            Searched::Outer(j) => !self.carries(self.child(j), b),
            Searched::Body(body) => b != body,
        };
        self.composite(0, takes).mass
    }

    fn range(&self, nominal: &MassProperties) -> Range {
        let share = self.solver.share;
        let x = particle(nominal);
        let I = nominal.I_BBcm_B;
        let products = share * I.trace().abs() / 3.0;
        let length = share * nominal.radius_of_gyration().max(1.0e-3);
        let mut half: Particle = [products; 10];
        half[0] = share * x[0];
        (1..4).for_each(|d| half[d] = share * x[d].abs());
        (7..10).for_each(|d| half[d] = length);
        Range::around(&x, &half)
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

fn side(kinematics: &Kinematics, body: usize) -> Side {
    Side {
        R: kinematics.R[body],
        p: kinematics.p[body],
        v: kinematics.v[body],
        w: kinematics.w[body],
    }
}

/// The six equations of a sample in N: momentum about the inertial origin, zero or that of the segment.
fn push(system: &mut Rows, row: &MomentumRow, head: Option<usize>, heads: usize) {
    let to_N = |column: &[f64]| {
        let l = Vector3::from_column_slice(&column[..3]);
        let h = Vector3::from_column_slice(&column[6..9]);
        let P = row.R_NB * l;
        (P, row.R_NB * h + row.p_NoBo_N.cross(&P))
    };
    let columns: Vec<(Vector3, Vector3)> = (0..10)
        .map(|j| to_N(row.slope.column(j).as_slice()))
        .collect();
    let (P, H) = to_N(row.constant.as_slice());
    for i in 0..6 {
        let pick = |c: &(Vector3, Vector3)| if i < 3 { c.0[i] } else { c.1[i - 3] };
        let mut left = vec![0.0; heads + 10];
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
    pi.mass_properties()
        .ok_or(Xu2017Error::Problem(crate::problem::ProblemError::NoMotion))
}

/// Mass, mass centre and tensor even where the mass is not positive: the cost of an odd solution is asked for.
fn properties_or_nan(pi: &InertialParameters) -> MassProperties {
    pi.mass_properties().unwrap_or(MassProperties {
        mass: pi.mass,
        p_BoBcm_B: Vector3::repeat(f64::NAN),
        I_BBcm_B: pi.I_BBo_B,
    })
}
