//! What is computed for the states of a group.

use super::error::BatchError;
use super::rows::{COLUMNS, Group, PER_BODY, Rows, TWIST};
use crate::algebra::Real;
use crate::forward_dynamics::{ForwardDynamics, JointInput, Singular};
use crate::inertial::Inertial;
use crate::kinematics::Kinematics;
use crate::lanes::Lanes;
use crate::momentum::of_bodies;
use crate::regressor::body_columns;
use crate::symmetric::Symmetric;
use crate::tree::Tree;
use fearless_simd::Simd;
use poinsot_spatial::InertialParameters;

/// What is done with the states of one group.
pub(super) trait Kernel {
    type Scratch<S: Simd>;

    fn scratch<S: Simd>(&self, tree: &Tree, zero: Lanes<S>) -> Self::Scratch<S>;

    /// Puts what body `i` gives as soon as it is placed and moves.
    #[inline(always)]
    fn body<S: Simd>(&self, _i: usize, _kinematics: &Kinematics<Lanes<S>>, _rows: &mut Rows) {}

    /// Fills the rows of the group. The kinematics are placed and move.
    #[inline(always)]
    fn fill<S: Simd>(
        &self,
        _scratch: &mut Self::Scratch<S>,
        _kinematics: &Kinematics<Lanes<S>>,
        _rates: &[Lanes<S>],
        _group: &Group<S>,
        _rows: &mut Rows,
    ) -> Result<(), BatchError> {
        Ok(())
    }
}

pub(super) struct Regressor;

impl Kernel for Regressor {
    type Scratch<S: Simd> = ();

    fn scratch<S: Simd>(&self, _: &Tree, _: Lanes<S>) {}

    #[inline(always)]
    fn body<S: Simd>(&self, i: usize, k: &Kinematics<Lanes<S>>, rows: &mut Rows) {
        let mut columns = [[k.v[i].x.all(0.0); TWIST]; COLUMNS];
        body_columns(&k.R[i], &k.p[i], &k.v[i], &k.w[i], &mut columns);
        if let Some(numbers) = columns.as_flattened().first_chunk::<PER_BODY>() {
            rows.put(PER_BODY * i, numbers);
        }
    }
}

pub(super) struct Momentum<'a> {
    pub bodies: &'a [InertialParameters],
}

impl Kernel for Momentum<'_> {
    type Scratch<S: Simd> = Vec<Inertial<Lanes<S>>>;

    fn scratch<S: Simd>(&self, tree: &Tree, zero: Lanes<S>) -> Self::Scratch<S> {
        spread(tree, self.bodies, zero)
    }

    #[inline(always)]
    fn fill<S: Simd>(
        &self,
        bodies: &mut Self::Scratch<S>,
        kinematics: &Kinematics<Lanes<S>>,
        _: &[Lanes<S>],
        group: &Group<S>,
        rows: &mut Rows,
    ) -> Result<(), BatchError> {
        let zero = Lanes::new(group.simd, 0.0);
        let (l, h) = of_bodies(bodies.iter().copied(), kinematics, zero);
        rows.put(0, &[l.x, l.y, l.z, h.x, h.y, h.z]);
        Ok(())
    }
}

/// The bodies of the first vehicle in every lane.
pub(super) fn spread<T: Real>(
    tree: &Tree,
    bodies: &[InertialParameters],
    zero: T,
) -> Vec<Inertial<T>> {
    let of = |body: &InertialParameters| {
        let Inertial { mass, mc, I } = Inertial::of(body);
        Inertial {
            mass: zero.all(mass),
            mc: mc.spread(zero),
            I: Symmetric::new([I.xx, I.xy, I.yy, I.xz, I.yz, I.zz].map(|x| zero.all(x))),
        }
    };
    bodies.iter().take(tree.bodies()).map(of).collect()
}

pub(super) struct Dynamics<'a> {
    pub bodies: &'a [InertialParameters],
    pub forces: &'a [f64],
    pub wrench: &'a [f64],
}

/// Workspace of the articulated bodies.
pub(super) struct DynamicsScratch<S: Simd> {
    bodies: Vec<Inertial<Lanes<S>>>,
    dynamics: ForwardDynamics<Lanes<S>>,
    inputs: Vec<JointInput<Lanes<S>>>,
    /// Acceleration of the base, then of the joints.
    found: Vec<Lanes<S>>,
}

impl Dynamics<'_> {
    /// The first state of the group that has no unique acceleration: each by itself.
    #[cold]
    fn first_singular<S: Simd>(
        &self,
        group: &Group<S>,
        kinematics: &Kinematics<Lanes<S>>,
        why: Singular,
    ) -> BatchError {
        let tree = group.tree;
        let mut one = Kinematics::new(tree);
        let inputs = vec![JointInput::Force(0.0); tree.dof()];
        let rates = vec![0.0; tree.dof()];
        for lane in 0..group.count {
            for (R, of) in one.R.iter_mut().zip(&kinematics.R) {
                *R = of.map(|x| x.to_array()[lane]);
            }
            for (p, of) in one.p.iter_mut().zip(&kinematics.p) {
                *p = of.map(|x| x.to_array()[lane]);
            }
            let mut dynamics = ForwardDynamics::new(tree);
            dynamics.set_bodies(tree, group.bodies_of(lane, self.bodies), &one);
            let solved = dynamics.solve(tree, &one, &rates, &inputs, &mut rates.clone());
            if let Err(why) = solved {
                return BatchError::Singular(group.first + lane, why);
            }
        }
        BatchError::Singular(group.first, why)
    }
}

impl Kernel for Dynamics<'_> {
    type Scratch<S: Simd> = DynamicsScratch<S>;

    fn scratch<S: Simd>(&self, tree: &Tree, zero: Lanes<S>) -> Self::Scratch<S> {
        DynamicsScratch {
            bodies: spread(tree, self.bodies, zero),
            dynamics: ForwardDynamics::over(tree, zero),
            inputs: vec![JointInput::Force(zero); tree.dof()],
            found: vec![zero; TWIST + tree.dof()],
        }
    }

    #[inline(always)]
    fn fill<S: Simd>(
        &self,
        scratch: &mut Self::Scratch<S>,
        kinematics: &Kinematics<Lanes<S>>,
        rates: &[Lanes<S>],
        group: &Group<S>,
        rows: &mut Rows,
    ) -> Result<(), BatchError> {
        let DynamicsScratch {
            bodies,
            dynamics,
            inputs,
            found,
        } = scratch;
        let tree = group.tree;
        group.gather(self.bodies, bodies);
        dynamics.set_inertias(tree, bodies.iter().copied(), kinematics);
        let [force, torque] = group.rows(self.wrench, TWIST).pair(group.simd);
        dynamics.add_wrench(0, &force, &torque);
        let forces = group.rows(self.forces, tree.dof());
        for (j, input) in inputs.iter_mut().enumerate() {
            *input = JointInput::Force(forces.number(group.simd, j));
        }
        let (base, joints) = found.split_at_mut(TWIST);
        dynamics
            .solve(tree, kinematics, rates, inputs, joints)
            .map_err(|why| self.first_singular(group, kinematics, why))?;
        let (a, alpha) = dynamics.acceleration(0);
        base.copy_from_slice(&[a.x, a.y, a.z, alpha.x, alpha.y, alpha.z]);
        rows.put_all(found);
        Ok(())
    }
}
