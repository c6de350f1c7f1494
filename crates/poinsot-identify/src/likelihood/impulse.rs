//! Impulse of the thrusters between samples, with the force turning with the body.

use crate::motion::{Running, cubic_between, joint_between};
use crate::problem::Problem;
use crate::problem::parameters::Equations;
use crate::problem::segment::{Firing, Segment};
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_model::{Nuisance, Thruster};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3, skew};

/// Gauss-Legendre nodes and weights on [0, 1], four points: exact to the seventh order.
const GAUSS_4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Impulse since the first sample, in N: what the thrusters added to the momentum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impulse {
    /// `integral F dt`, N s.
    pub linear: Vector3,
    /// `integral p_NoT x F dt` about the inertial origin, or `integral p_BoT x F dt` turned to N where
    /// only rotation is seen, N m s.
    pub angular: Vector3,
    /// `integral R_NB [F_B]x dt`, N s: the angular impulse per unit shift of the mass centre.
    pub per_mass_centre: Matrix3,
}

impl Impulse {
    fn add(&mut self, other: &Self) {
        self.linear += other.linear;
        self.angular += other.angular;
        self.per_mass_centre += other.per_mass_centre;
    }
}

/// Impulses at every sample: of all thrusters at their declared force, and of each thruster whose
/// scale is unknown (in the order of the model).
pub struct Impulses {
    /// All thrusters.
    pub total: Vec<Impulse>,
    /// Each thruster with an unknown scale.
    pub scaled: Vec<Vec<Impulse>>,
}

/// Integrates the thrust of a segment from sample to sample.
///
/// Attitude between samples follows the cubic in the rotation vector that meets both attitudes and both
/// angular velocities; position likewise with the velocities; joints likewise with their rates.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A vehicle without thrusters has no impulses.
/// let impulses = thrust_impulses(&tree, &model.thrusters, &segments[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn thrust_impulses(tree: &Tree, thrusters: &[Thruster], segment: &Segment) -> Impulses {
    let scaled: Vec<usize> = (0..thrusters.len())
        .filter(|&k| thrusters[k].scale != Nuisance::Known)
        .collect();
    let samples = segment.samples.time_s.len();
    let mut out = Impulses {
        total: Vec::with_capacity(samples),
        scaled: vec![Vec::with_capacity(samples); scaled.len()],
    };
    let mut sums = vec![Impulse::default(); 1 + scaled.len()];
    let mut kinematics = Kinematics::new(tree);
    let mut running = Running::new(&segment.firings);
    for k in 0..samples {
        out.total.push(sums[0]);
        for (list, sum) in out.scaled.iter_mut().zip(&sums[1..]) {
            list.push(*sum);
        }
        if k + 1 == samples {
            break;
        }
        let (from, to) = (segment.samples.time_s[k], segment.samples.time_s[k + 1]);
        for (_, firing) in running.between(from, to) {
            if firing.start_s >= to {
                continue;
            }
            let step = one_interval(tree, thrusters, segment, k, firing, &mut kinematics);
            sums[0].add(&step);
            if let Some(at) = scaled.iter().position(|&s| s == firing.thruster) {
                sums[1 + at].add(&step);
            }
        }
    }
    out
}

/// Share of a row's information about the thrust from which accumulated noise is too large.
const TOO_MUCH: f64 = 0.5;

/// Whether position and attitude noise accumulates under thrust beyond the noise model of the rows.
///
/// The moment `p x F dt` of every interval holds the error of `p` there, and so do all rows after it; `F dt` that of
/// the attitude. The rows assume independent noise, which averages as 1/n; accumulated noise does not.
pub(crate) fn noise_accumulates(problem: &Problem) -> bool {
    if problem.linear_equations() != Equations::Momentum {
        return false;
    }
    let one = |covariance: &Matrix3| covariance.trace() / 3.0;
    let noise = problem.noise;
    let (position, attitude) = (one(&noise.position), one(&noise.attitude));
    let (velocity, rate) = (one(&noise.velocity), one(&noise.gyro));
    let bodies = problem.model.nominal_parameters();
    let whole = composite(&bodies, &Kinematics::new(problem.tree));
    let inertia = whole.I_BBo_B.trace() / 3.0;
    problem.segments.iter().any(|segment| {
        let Some(translation) = segment.samples.translation.as_ref() else {
            return false;
        };
        let impulses = thrust_impulses(problem.tree, &problem.model.thrusters, segment).total;
        let steps = impulses.windows(2);
        let square: f64 = steps
            .map(|p| (p[1].linear - p[0].linear).norm_squared())
            .sum();
        let largest = |list: &[Vector3]| list.iter().map(Vector3::norm_squared).fold(0.0, f64::max);
        let momentum = whole.mass.powi(2) * largest(&translation.v_NBo_N);
        let arm = whole.mass.powi(2) * largest(&translation.p_NoBo_N);
        let angular = inertia.powi(2) * rate + momentum * position + arm * velocity;
        let linear = whole.mass.powi(2) * velocity + momentum * attitude;
        let n = impulses.len() as f64;
        let too_much = |walk: f64, row: f64| walk * n > TOO_MUCH * row;
        square > 0.0
            && (too_much(square * position, angular) || too_much(square * attitude, linear))
    })
}

fn one_interval(
    tree: &Tree,
    thrusters: &[Thruster],
    segment: &Segment,
    k: usize,
    firing: &Firing,
    kinematics: &mut Kinematics,
) -> Impulse {
    let s = &segment.samples;
    let (t0, t1) = (s.time_s[k], s.time_s[k + 1]);
    let (from, to) = (firing.start_s.max(t0), firing.end_s.min(t1));
    let thruster = &thrusters[firing.thruster];
    let mut sum = Impulse::default();
    for (node, weight) in GAUSS_4 {
        let at = (from + node * (to - from) - t0) / (t1 - t0);
        let dt = weight * (to - from);
        let dof = tree.dof();
        if dof > 0 {
            let joints = (&*s.joint_position, &*s.joint_rate);
            let position = |j| joint_between(&s.time_s, joints, (dof, j), (k, at)).0;
            kinematics.place(tree, &(0..dof).map(position).collect::<Vec<_>>());
        }
        let R_NB = attitude_between(s, k, at);
        let R_BT = kinematics.R[thruster.body];
        let F_B = R_BT * thruster.direction_B * firing.force;
        let p_BoT_B = kinematics.p[thruster.body] + R_BT * thruster.p_BoT_B;
        let F_N = R_NB * F_B;
        let origin = match &s.translation {
            Some(t) => {
                let (a, b) = (t.p_NoBo_N[k], t.p_NoBo_N[k + 1]);
                a + cubic_between(&(b - a), [&t.v_NBo_N[k], &t.v_NBo_N[k + 1]], t1 - t0, at)
            }
            None => Vector3::zeros(),
        };
        sum.linear += F_N * dt;
        sum.angular += (origin + R_NB * p_BoT_B).cross(&F_N) * dt;
        sum.per_mass_centre += R_NB.to_rotation_matrix().matrix() * skew(&F_B) * dt;
    }
    sum
}

fn attitude_between(s: &crate::problem::segment::Samples, k: usize, at: f64) -> UnitQuaternion {
    let step = s.time_s[k + 1] - s.time_s[k];
    let turn = (s.R_NB[k].inverse() * s.R_NB[k + 1]).scaled_axis();
    let end_rate = inverse_right_jacobian(&turn) * s.w_NB_B[k + 1];
    let phi = cubic_between(&turn, [&s.w_NB_B[k], &end_rate], step, at);
    s.R_NB[k] * UnitQuaternion::from_scaled_axis(phi)
}

/// Takes body rates to rates of the rotation vector (Chirikjian 2012, eq. 10.86).
fn inverse_right_jacobian(phi: &Vector3) -> Matrix3 {
    let angle = phi.norm();
    let k = skew(phi);
    let second = if angle < 1.0e-4 {
        1.0 / 12.0
    } else {
        1.0 / (angle * angle) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin())
    };
    Matrix3::identity() + k * 0.5 + k * k * second
}
