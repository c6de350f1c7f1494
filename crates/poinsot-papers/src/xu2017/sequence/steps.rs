//! The steps of one moving joint, Sec. 3.3: one side from the momentum, the other from (43)-(46).

use super::super::least_squares::{Rows, answer, shown};
use super::super::two_body::{
    LINES, MomentumRow, TwoBodyObjective, TwoBodyReading, equations, rows, transported_back,
};
use super::super::{Kind, natural};
use super::{Order, Searched, Work, no_scale, not_finite, properties_of};
use nalgebra::SVector;
use poinsot_dynamics::Kinematics;
use poinsot_files::Faults;
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Number of random motions that define the identifiable directions of a joint.
const MOTIONS: usize = 40;

/// Samples of a segment, with its index.
type Readings = (usize, Vec<TwoBodyReading>);

impl Work<'_> {
    /// One joint: solves for one side, from the momentum. The other side is the difference from the whole, (43)-(46), or
    /// is known and gives the whole. Returns the tip side.
    pub(super) fn split(&mut self, joint: usize) -> Result<InertialParameters, Faults> {
        let child = self.child(joint);
        let (R, p) = (self.normal.R[child], self.normal.p[child]);
        let [inner_known, _] = self.sides_known(joint);
        let inner = self.composite(0, |b| !self.carries(child, b));
        let outer = self.composite(child, |b| self.carries(child, b));
        let total = self.found.total;
        let inward = total.map_or(inner_known, |_| self.order == Order::Inward);
        // Both sides from the searched one: affine in it.
        let compose = |x: &InertialParameters| match (total, inward) {
            (Some(total), false) => [*x, transported_back(&total.with_added(-1.0, x), &R, &p)],
            (Some(total), true) => [total.with_added(-1.0, &x.transported(&R, &p)), *x],
            (None, false) => [*x, outer],
            (None, true) => [inner, *x],
        };
        if let Some(total) = total.filter(|_| inner_known) {
            return Ok(transported_back(&total.with_added(-1.0, &inner), &R, &p));
        }
        let (part, nominal) = match inward {
            false => (Searched::Inner(joint), inner),
            true => (Searched::Outer(joint), outer),
        };
        let readings = self.readings(joint)?;
        let mass = total.map(|t| t.mass);
        let found = self.two_body(part, &readings, &compose, &nominal, mass)?;
        let [inner, outer] = compose(&found);
        let whole = inner.with_added(1.0, &outer.transported(&R, &p));
        self.found.total.get_or_insert(whole);
        Ok(outer)
    }

    /// One unknown body, with any joints in motion.
    pub(super) fn one_body(&mut self, body: usize) -> Result<(), Faults> {
        let segments = self.roles.of_joint.iter().flatten();
        let mut list: Vec<usize> = segments.chain(&self.roles.together).copied().collect();
        list.sort_unstable();
        if !self.roles.single.is_empty() {
            let note = "segments with thrust are not used: one body among known ones follows from the momentum alone";
            self.found.notes.push(note.to_owned());
        }
        let of = |at: usize| Ok((at, self.measured(at, body, None)?));
        let readings: Vec<Readings> = list.into_iter().map(of).collect::<Result<_, Faults>>()?;
        let compose = |x: &InertialParameters| [InertialParameters::ZERO, *x];
        let nominal = self.found.bodies[body];
        let part = Searched::Body(body);
        self.found.bodies[body] = self.two_body(part, &readings, &compose, &nominal, None)?;
        Ok(())
    }

    /// Empty equations of these segments: without known momentum each has six more unknowns.
    fn system(&self, readings: &[Readings], unknowns: usize) -> Rows {
        let each = if self.momentum_is_free() { 6 } else { 0 };
        Rows::new(each * readings.len(), unknowns)
    }

    /// Solves (49) for one side, by the swarm or linearly. Samples are listed per segment.
    fn two_body(
        &mut self,
        part: Searched,
        readings: &[Readings],
        compose: &dyn Fn(&InertialParameters) -> [InertialParameters; 2],
        nominal: &InertialParameters,
        total: Option<f64>,
    ) -> Result<InertialParameters, Faults> {
        let properties = properties_of(nominal)?;
        let natural = natural(&properties);
        let mut system = self.system(readings, 10);
        let mut all = Vec::new();
        for (k, (_, list)) in readings.iter().enumerate() {
            let list = rows(list, compose);
            list.iter().for_each(|row| push(&mut system, row, &[], k));
            all.extend(list);
        }
        // Directions that some motion of the joint can excite; a revolute joint leaves three of ten unobservable.
        let seen = match part {
            Searched::Inner(joint) | Searched::Outer(joint) => {
                shown(&equations(&rows(&self.motions(joint), compose)), &natural)
            }
            _ => None,
        };
        let linear = answer(system, &natural, &nominal.to_array(), seen.as_ref());
        let linear = linear.map(|x| InertialParameters::from_array(&std::array::from_fn(|k| x[k])));
        if self.solver.kind == Kind::Swarm {
            self.check_rest(readings.iter().map(|r| r.0))?;
        }
        let objective = TwoBodyObjective::new(&all, total, self.rest_mass(part));
        let range = self.range(&properties);
        let barycentric = linear.value;
        // Without a positive mass there is no mass centre: the cost of such a solution is still computed.
        let as_properties = linear.map(|x| {
            x.mass_properties().unwrap_or(MassProperties {
                mass: x.mass,
                p_BoBcm_B: Vector3::repeat(f64::NAN),
                I_BBcm_B: x.I_BBo_B,
            })
        });
        let found = self.finish(part, as_properties, &objective, range)?;
        // The linear parameters directly, without conversion to a mass centre.
        Ok(match self.solver.kind {
            Kind::Linear => barycentric,
            Kind::Swarm => found.parameters(),
        })
    }

    /// Determines the total mass from the motion of one joint, if thrust segments have no translation: the second use of
    /// the Conclusion as printed.
    ///
    /// Attitude determines tensor and mass centre of the locked robot. The parameters of the whole, and so the momentum
    /// of a moving joint, are then affine in the total mass. The ten numbers of one side and the mass are eleven
    /// unknowns of a linear problem.
    pub(super) fn weigh(&mut self, joint: usize) -> Result<(), Faults> {
        let whole = properties_of(&self.found.total.ok_or_else(no_scale)?)?;
        let of_mass = |mass: f64| MassProperties { mass, ..whole }.parameters();
        let child = self.child(joint);
        let (R, p) = (self.normal.R[child], self.normal.p[child]);
        // Rows in the base side, and their change for one kilogram more.
        let pairs = |list: &[TwoBodyReading]| {
            let of = |mass: f64| {
                let total = of_mass(mass);
                rows(list, |x| {
                    [*x, transported_back(&total.with_added(-1.0, x), &R, &p)]
                })
            };
            let pairs = of(whole.mass).into_iter().zip(of(whole.mass + 1.0));
            let with_change = pairs.map(|(row, heavy)| (row, heavy.constant - row.constant));
            with_change.collect::<Vec<(MomentumRow, SVector<f64, 9>)>>()
        };
        let nominal = self.composite(0, |b| !self.carries(child, b));
        let mut units = natural(&properties_of(&nominal)?).to_vec();
        let mut start = nominal.to_array().to_vec();
        units.push(whole.mass);
        start.push(whole.mass);
        let eleven = |(row, change): &(MomentumRow, SVector<f64, 9>)| {
            let element = |i: usize, j: usize| if j < 10 { row.slope[(i, j)] } else { change[i] };
            LINES.map(|i| std::array::from_fn(|j| element(i, j)))
        };
        let shown_rows = pairs(&self.motions(joint));
        let shown_rows: Vec<[f64; 11]> = shown_rows.iter().flat_map(eleven).collect();
        let seen = shown(&shown_rows, &units);
        let readings = self.readings(joint)?;
        let mut system = self.system(&readings, 11);
        for (k, (_, list)) in readings.iter().enumerate() {
            for (mut row, change) in pairs(list) {
                // The unknown is the mass itself, so its nominal part is removed from the constant.
                row.constant -= change * whole.mass;
                push(&mut system, &row, &[change], k);
            }
        }
        let found = answer(system, &units, &start, seen.as_ref());
        let mass = found.value[10];
        if !found.finite || mass.is_nan() || mass <= 0.0 {
            return Err(not_finite());
        }
        self.found.total = Some(of_mass(mass));
        Ok(())
    }

    /// Random motions of one joint and the base.
    pub(super) fn motions(&self, joint: usize) -> Vec<TwoBodyReading> {
        let (child, tree) = (self.child(joint), self.problem.tree);
        let mut rng = ChaCha8Rng::seed_from_u64(2017);
        let mut number = || (rng.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let mut kinematics = Kinematics::new(tree);
        let mut q = self.roles.normal.clone();
        let mut rates = vec![0.0; q.len()];
        let motion = |_| {
            q[joint] = self.roles.normal[joint] + number();
            rates[joint] = number();
            let mut vector = || Vector3::new(number(), number(), number());
            let (v, w) = (vector(), vector());
            kinematics.place(tree, &q);
            kinematics.set_velocities(tree, &v, &w, &rates);
            TwoBodyReading::in_base(&kinematics, child)
        };
        (0..MOTIONS).map(motion).collect()
    }
}

/// The six equations of a sample in N: momentum about the inertial origin is zero, or that of its segment. `extra` holds
/// columns of further unknowns.
fn push(system: &mut Rows, row: &MomentumRow, extra: &[SVector<f64, 9>], segment: usize) {
    let to_N = |column: &[f64]| {
        let P = row.R_NB * Vector3::from_column_slice(&column[..3]);
        let H = row.R_NB * Vector3::from_column_slice(&column[6..9]) + row.p_NoBo_N.cross(&P);
        [P.x, P.y, P.z, H.x, H.y, H.z]
    };
    let own = (0..10).map(|j| to_N(row.slope.column(j).as_slice()));
    let more = extra.iter().map(|column| to_N(column.as_slice()));
    let columns: Vec<[f64; 6]> = own.chain(more).collect();
    let constant = to_N(row.constant.as_slice());
    for i in 0..6 {
        let mut left = vec![0.0; system.head];
        if let Some(momentum) = left.get_mut(6 * segment + i) {
            *momentum = -1.0;
        }
        left.extend(columns.iter().map(|column| column[i]));
        system.push(&left, -constant[i]);
    }
}
