//! The steps of one moving joint, Sec. 3.3: one side from the momentum, the other from (43)-(46).

use super::super::least_squares::{Rows, answer, shown};
use super::super::two_body::{
    MomentumRow, TwoBodyObjective, TwoBodyReading, equations, rows, transported, transported_back,
};
use super::super::{Kind, natural, sum};
use super::{Order, Searched, Work, properties_of, properties_or_nan};
use crate::xu2017::error;
use nalgebra::SVector;
use poinsot_dynamics::Kinematics;
use poinsot_files::Faults;
use poinsot_spatial::{InertialParameters, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of random motions that define the identifiable directions of a joint.
const MOTIONS: usize = 40;

impl Work<'_> {
    /// A joint with one side known: solves for the other side, and so for the whole.
    pub(super) fn beside_known(&mut self, joint: usize) -> Result<InertialParameters, Faults> {
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

    /// A joint of a robot with known whole: solves for one side; the other is the difference, (43)-(46).
    pub(super) fn split(&mut self, joint: usize) -> Result<InertialParameters, Faults> {
        let child = self.child(joint);
        let total = self.found.total.ok_or_else(error::no_scale)?;
        let (R, p) = (self.normal.R[child], self.normal.p[child]);
        let rest = |inner: &InertialParameters| transported_back(&sum(&total, inner, -1.0), &R, &p);
        if self.known(|b| !self.carries(child, b)) {
            return Ok(rest(&self.composite(0, |b| !self.carries(child, b))));
        }
        let readings = self.readings(joint)?;
        // `compose` subtracts the searched side from the whole, so rows are affine in it.
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

    /// One unknown body, with any joints in motion.
    pub(super) fn one_body(&mut self, body: usize) -> Result<(), Faults> {
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

    /// Solves (49) for one side, by the swarm or linearly. Samples are listed per segment.
    fn two_body(
        &mut self,
        part: Searched,
        readings: &[(usize, Vec<TwoBodyReading>)],
        compose: &dyn Fn(&InertialParameters) -> [InertialParameters; 2],
        nominal: &InertialParameters,
        total: Option<f64>,
    ) -> Result<InertialParameters, Faults> {
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
        // The linear parameters directly, without conversion to a mass centre.
        Ok(if self.solver.kind == Kind::Linear {
            barycentric
        } else {
            found.parameters()
        })
    }

    /// Directions that some motion of the joint can excite; a revolute joint leaves three of ten unobservable.
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
    pub(super) fn motions(&self, joint: usize) -> Vec<TwoBodyReading> {
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
                TwoBodyReading::in_base(&kinematics, child)
            })
            .collect()
    }
}

/// The six equations of a sample in N: momentum about the inertial origin is zero, or that of the segment. `extra`
/// holds columns of further unknowns.
pub(super) fn push(
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
