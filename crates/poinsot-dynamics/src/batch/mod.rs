//! Kernels over many states of one tree, several side by side in vector registers.
//!
//! Arrays hold one state a row, without gaps. As many states go through one recursion as the processor's vectors hold:
//! eight, four or two. Every state gives the same bits in any batch, at any place, on any number of threads and with any
//! number of lanes; only sines and cosines differ from the kernels of one state, in the last bit.

mod error;
mod free_motion;
mod kernels;
mod motion;
mod rows;

use crate::kinematics::Kinematics;
use crate::lanes::{Lanes, Work, in_lanes};
use crate::tree::Tree;
use error::expect;
use fearless_simd::Simd;
use kernels::{Dynamics, Kernel, Momentum, Regressor};
use poinsot_spatial::InertialParameters;
use rows::{PER_BODY, Rows, TWIST, groups};

pub use error::BatchError;
pub use motion::{Steps, integrate};

/// Joint positions (rad or m), joint rates and base twists (linear part first) of many states.
#[derive(Debug, Clone, Copy)]
pub struct States<'a> {
    /// One per joint coordinate and state.
    pub q: &'a [f64],
    /// One per joint coordinate and state.
    pub rates: &'a [f64],
    /// `v_NBo_B` m/s, `w_NB_B` rad/s: six per state.
    pub twist: &'a [f64],
}

impl States<'_> {
    /// Number of states, if all arrays have it.
    fn count(&self, tree: &Tree) -> Result<usize, BatchError> {
        let count = self.twist.len() / TWIST;
        expect("V", self.twist.len(), count * TWIST)?;
        expect("q", self.q.len(), count * tree.dof())?;
        expect("dq", self.rates.len(), count * tree.dof())?;
        Ok(count)
    }
}

/// Fills `Y`, `(states, 10 bodies, 6)`: the columns of [`crate::momentum_regressor`].
///
/// # Errors
/// An array has the wrong length.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // Two states of six plus two numbers; 2 bodies of 10 columns of 6 numbers each.
/// let twist = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// let states = batch::States { q: &[0.0, 0.0], rates: &[0.0, 0.0], twist: &twist };
/// let mut Y = vec![0.0; 2 * 120];
/// batch::momentum_regressor(&tree, states, &mut Y)?;
/// // Mass moving along x at 1 m/s; the tensor's zz element turning about z at 1 rad/s.
/// assert_eq!(Y[..6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// assert_eq!(Y[120 + 54..120 + 60], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
/// # Ok::<(), batch::BatchError>(())
/// ```
pub fn momentum_regressor(tree: &Tree, states: States, Y: &mut [f64]) -> Result<(), BatchError> {
    let width = PER_BODY * tree.bodies();
    expect("out", Y.len(), states.count(tree)? * width)?;
    run(tree, states, Regressor, width, Y)
}

/// Fills `out`, `(states, 6)`, by [`crate::momentum`]: the same bodies in all states.
///
/// # Errors
/// An array has the wrong length.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // Two states: a shift along x, and a turn about z.
/// let twist = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// let states = batch::States { q: &[0.0, 0.0], rates: &[0.0, 0.0], twist: &twist };
/// let mut out = [0.0; 12];
/// batch::momentum(&tree, &bodies, states, &mut out)?;
/// assert_eq!(out, [3.0, 0.0, 0.0, 0.0, 0.0, -0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 5.5]);
/// # Ok::<(), batch::BatchError>(())
/// ```
pub fn momentum(
    tree: &Tree,
    bodies: &[InertialParameters],
    states: States,
    out: &mut [f64],
) -> Result<(), BatchError> {
    expect("bodies", bodies.len(), tree.bodies())?;
    expect("out", out.len(), states.count(tree)? * TWIST)?;
    run(tree, states, Momentum { bodies }, TWIST, out)
}

/// Fills `out`, `(states, 6 + joint coordinates)`: acceleration of the base origin, angular acceleration of the base,
/// joint accelerations ([`crate::ForwardDynamics::solve`]).
///
/// `forces` holds one per joint coordinate and state, N m or N, `wrench` the force and torque on the base about its
/// origin in base axes, six per state. `bodies` are those of the vehicle, or those of one vehicle per state.
///
/// # Errors
/// An array has the wrong length, or a vehicle has no inertia about a joint or of the whole.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // One state at rest, with 1 N m of motor torque.
/// let states = batch::States { q: &[0.0], rates: &[0.0], twist: &[0.0; 6] };
/// let mut out = [0.0; 7];
/// batch::forward_dynamics(&tree, &bodies, states, &[1.0], &[0.0; 6], &mut out)?;
/// // The momentum stays zero: the base turns back by 0.44 of the joint's acceleration.
/// assert!((out[5] + 0.44 * out[6]).abs() < 1.0e-12 && out[6] > 0.0);
/// # Ok::<(), batch::BatchError>(())
/// ```
pub fn forward_dynamics(
    tree: &Tree,
    bodies: &[InertialParameters],
    states: States,
    forces: &[f64],
    wrench: &[f64],
    out: &mut [f64],
) -> Result<(), BatchError> {
    let (count, width) = (states.count(tree)?, TWIST + tree.dof());
    expect("tau", forces.len(), count * tree.dof())?;
    expect("wrench", wrench.len(), count * TWIST)?;
    expect("out", out.len(), count * width)?;
    if bodies.len() != tree.bodies() {
        expect("bodies", bodies.len(), count * tree.bodies())?;
    }
    let kernel = Dynamics {
        bodies,
        forces,
        wrench,
    };
    run(tree, states, kernel, width, out)
}

/// The states of one call, compiled for every instruction set that the machine may have.
struct Run<'a, K> {
    tree: &'a Tree,
    states: States<'a>,
    kernel: K,
    width: usize,
    out: &'a mut [f64],
}

fn run<K: Kernel>(
    tree: &Tree,
    states: States,
    kernel: K,
    width: usize,
    out: &mut [f64],
) -> Result<(), BatchError> {
    in_lanes(Run {
        tree,
        states,
        kernel,
        width,
        out,
    })
}

impl<K: Kernel> Work for Run<'_, K> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let (tree, states, kernel, width) = (self.tree, self.states, self.kernel, self.width);
        let zero = Lanes::new(simd, 0.0);
        let mut kinematics = Kinematics::over(tree, zero);
        let mut scratch = kernel.scratch(tree, zero);
        let mut q = vec![zero; tree.dof()];
        let mut rates = q.clone();
        for (group, of) in groups(tree, simd, width, self.out) {
            let at = group.rows(states.q, tree.dof());
            let moving = group.rows(states.rates, tree.dof());
            for (j, (q, rate)) in q.iter_mut().zip(&mut rates).enumerate() {
                *q = at.number(simd, j);
                *rate = moving.number(simd, j);
            }
            [kinematics.v[0], kinematics.w[0]] = group.rows(states.twist, TWIST).pair(simd);
            let mut rows = Rows::new(of, width);
            for (i, link) in tree.links.iter().enumerate() {
                if i > 0 {
                    kinematics.place_body(i, link, &q);
                    kinematics.move_body(i, link, &rates);
                }
                kernel.body(i, &kinematics, &mut rows);
            }
            kernel.fill(&mut scratch, &kinematics, &rates, &group, &mut rows)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{at_level, levels};
    use crate::tree::{Link, Motion};
    use poinsot_spatial::{MassProperties, Matrix3, Vector3};

    /// States: one group of eight lanes, and a part of another one.
    const COUNT: usize = 11;

    /// An arm of two joints.
    fn arm() -> (Tree, Vec<InertialParameters>) {
        let hinge = |parent, motion, axis| {
            let p_PoCo_P = Vector3::new(0.7, 0.1, -0.2);
            Link::new(parent, motion, p_PoCo_P, Matrix3::identity(), axis)
        };
        let oblique = Vector3::new(0.6, 0.0, 0.8);
        let tree = Tree {
            links: vec![
                Link::base(),
                hinge(0, Motion::Revolute(0), oblique),
                hinge(1, Motion::Prismatic(1), Vector3::y()),
            ],
            rotors: vec![],
            coordinates: vec![0, 1],
        };
        let body = |mass: f64| MassProperties {
            mass,
            p_BoBcm_B: Vector3::new(0.1, -0.2, 0.3),
            I_BBcm_B: Matrix3::from_diagonal(&Vector3::new(1.0, 1.2, 0.9)) * mass,
        };
        let bodies = [40.0, 5.0, 3.0].map(|mass| body(mass).parameters());
        (tree, bodies.to_vec())
    }

    #[test]
    fn exact_two_four_and_eight_lanes_give_the_same_bits() {
        let (tree, bodies) = arm();
        let numbers = |n: usize, turn: f64| -> Vec<f64> {
            (0..n * COUNT).map(|k| (turn * k as f64).sin()).collect()
        };
        let (q, rates, twist) = (numbers(2, 1.1), numbers(2, 0.7), numbers(6, 1.9));
        let (forces, wrench) = (numbers(2, 2.3), numbers(6, 0.3));
        let states = States {
            q: &q,
            rates: &rates,
            twist: &twist,
        };
        let rows = |level| {
            let mut Y = vec![f64::NAN; COUNT * PER_BODY * 3];
            let regressor = Run {
                tree: &tree,
                states,
                kernel: Regressor,
                width: PER_BODY * 3,
                out: &mut Y,
            };
            at_level(level, regressor).unwrap();
            let mut accelerations = vec![f64::NAN; COUNT * 8];
            let dynamics = Run {
                tree: &tree,
                states,
                kernel: Dynamics {
                    bodies: &bodies,
                    forces: &forces,
                    wrench: &wrench,
                },
                width: 8,
                out: &mut accelerations,
            };
            at_level(level, dynamics).unwrap();
            let bits = |x: f64| x.to_bits();
            Y.into_iter()
                .chain(accelerations)
                .map(bits)
                .collect::<Vec<_>>()
        };
        let [two, more @ ..] = &levels()[..] else {
            panic!("every machine has a level");
        };
        let two = rows(*two);
        for level in more {
            assert!(rows(*level) == two, "{level:?}");
        }
    }
}
