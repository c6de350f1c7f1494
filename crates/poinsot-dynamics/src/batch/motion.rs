//! Free motion of many vehicles of one tree under the same motors.

use super::error::{BatchError, expect};
use super::free_motion::{FreeMotion, JOINTS};
use super::kernels::spread;
use super::rows::{Rows, groups};
use crate::lanes::{Lanes, Work, in_lanes};
use crate::motion::joint_drive::ForceProfile;
use crate::motion::runge_kutta::RungeKutta4;
use crate::tree::Tree;
use fearless_simd::Simd;
use poinsot_spatial::InertialParameters;

/// Equal steps of one motion. Jumps of a motor force lie between two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// Time of the first state, s.
    pub start: f64,
    /// Length, s.
    pub step: f64,
    /// Number.
    pub count: u32,
}

/// Moves every vehicle by equal steps of the classical fourth-order Runge-Kutta rule, in free fall without wheels.
///
/// A row of `states` is that of [`crate::Flight::state`]: attitude, mass centre, momenta, joints. `motors` drive the
/// joint coordinates of all vehicles; `bodies` are those of all vehicles, or those of each.
///
/// # Errors
/// An array has the wrong length, or a vehicle has no inertia about a joint or of the whole.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // Attitude, mass centre, momenta, joint: at rest but for a drift of 3 N s along x.
/// let mut states = vec![0.0; 15];
/// (states[3], states[7]) = (1.0, 3.0);
/// let steps = batch::Steps { start: 0.0, step: 0.1, count: 100 };
/// batch::integrate(&tree, &bodies, &[ForceProfile::none()], steps, &mut states)?;
/// // 3 kg move by 10 m in 10 s.
/// assert!((states[4] - 10.0).abs() < 1.0e-12);
/// # Ok::<(), batch::BatchError>(())
/// ```
pub fn integrate(
    tree: &Tree,
    bodies: &[InertialParameters],
    motors: &[ForceProfile],
    steps: Steps,
    states: &mut [f64],
) -> Result<(), BatchError> {
    let width = JOINTS + 2 * tree.dof();
    let count = states.len() / width;
    expect("states", states.len(), count * width)?;
    expect("motors", motors.len(), tree.dof())?;
    if bodies.len() != tree.bodies() {
        expect("bodies", bodies.len(), count * tree.bodies())?;
    }
    in_lanes(Moving {
        tree,
        bodies,
        motors,
        steps,
        states,
    })
}

struct Moving<'a> {
    tree: &'a Tree,
    bodies: &'a [InertialParameters],
    motors: &'a [ForceProfile],
    steps: Steps,
    states: &'a mut [f64],
}

impl Work for Moving<'_> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let (tree, bodies, steps) = (self.tree, self.bodies, self.steps);
        let width = JOINTS + 2 * tree.dof();
        let zero = Lanes::new(simd, 0.0);
        let mut y = vec![zero; width];
        let mut rule = RungeKutta4::like(&y);
        let mut flow = FreeMotion::new(tree, spread(tree, bodies, zero), self.motors, zero);
        for (mut group, of) in groups(tree, simd, width, self.states) {
            group.gather(bodies, &mut flow.bodies);
            let first = std::mem::take(&mut group.first);
            let rows = group.rows(of, width);
            for (k, y) in y.iter_mut().enumerate() {
                *y = rows.number(simd, k);
            }
            for step in 0..steps.count {
                let t = steps.start + f64::from(step) * steps.step;
                flow.within = t + 0.5 * steps.step;
                let moved = rule.step(&mut flow, t, steps.step, &mut y);
                moved.map_err(|halt| BatchError::Halted(first, halt))?;
            }
            Rows::new(of, width).put_all(&y);
        }
        Ok(())
    }
}
