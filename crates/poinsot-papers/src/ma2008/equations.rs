//! Both steps as rows of linear equations: (10)-(13), (18)-(20), and the increments of option 2 in N.

use super::arm::Reading;
use super::solve::{Step, solve};
use nalgebra::SMatrix;
use poinsot_spatial::{MassProperties, Matrix3, Vector3, skew, tensor, tensor_regressor};

/// Step 1 of one sample in N: columns `[a, Omega | v]` of (13); momentum is `m_S (a m_R/m_S + Omega rho_S + v)`.
pub type LinearRows = SMatrix<f64, 3, 5>;
/// Step 2 of one sample in N: columns `[B | g]` of (20); angular momentum is `B y + g`.
pub type AngularRows = SMatrix<f64, 3, 7>;

/// Writes columns into rows.
pub(super) fn put<const W: usize, const N: usize>(
    rows: &mut SMatrix<f64, 3, W>,
    at: usize,
    columns: &SMatrix<f64, 3, N>,
) {
    rows.fixed_columns_mut::<N>(at).copy_from(columns);
}

/// Known momentum of the system, in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Linear, N s.
    pub p_C_N: Vector3,
    /// Angular, about the system's mass centre, N m s.
    pub h_C_N: Vector3,
}

/// Known parts of the momentum, in N: option 1 of a step uses its part, option 2 does not.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Given {
    /// Linear, N s.
    pub p_C_N: Option<Vector3>,
    /// Angular, about the system's mass centre, N m s.
    pub h_C_N: Option<Vector3>,
}

impl From<Option<Known>> for Given {
    fn from(known: Option<Known>) -> Self {
        Self {
            p_C_N: known.map(|k| k.p_C_N),
            h_C_N: known.map(|k| k.h_C_N),
        }
    }
}

/// Solution of both steps.
#[derive(Debug, Clone)]
pub struct TwoStep {
    /// Step 1 in `x = [m_R/m_S, rho_S]`.
    pub linear: Step<4>,
    /// Step 2 in `y`, [`poinsot_spatial::elements`] of the tensor; `None` if step 1 is rank-deficient.
    pub angular: Option<Step<6>>,
    /// Mass of the arm, kg.
    pub arm_mass: f64,
}

impl TwoStep {
    /// Step 1 alone.
    pub(super) fn first(rows: &[LinearRows], arm_mass: f64) -> Self {
        Self {
            linear: solve::<4, 5>(rows),
            angular: None,
            arm_mass,
        }
    }

    /// Mass of the base, kg.
    pub fn mass(&self) -> f64 {
        self.arm_mass / self.linear.x[0]
    }

    /// Mass centre of the base from its origin, in B, m.
    pub fn rho_S(&self) -> Vector3 {
        self.linear.x.fixed_rows::<3>(1).into_owned()
    }

    /// The base, if step 2 is solved.
    pub fn base(&self) -> Option<MassProperties> {
        Some(MassProperties {
            mass: self.mass(),
            p_BoBcm_B: self.rho_S(),
            I_BBcm_B: self.I_S()?,
        })
    }

    /// Central inertia of the base, kg m2, if step 2 is solved.
    pub fn I_S(&self) -> Option<Matrix3> {
        self.angular.as_ref().map(|step| tensor(step.x.into()))
    }
}

/// Solves both steps for segments with a common base; each segment has its own momentum, known or unknown.
///
/// With known momentum (option 1) the rows are those of (13) and (20). Otherwise (option 2) they are differences from
/// the first sample of the segment.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// // Option 1: the momentum is known, zero.
/// let none = Known { p_C_N: Vector3::zeros(), h_C_N: Vector3::zeros() };
/// let found = two_step(&[samples], Some(none));
/// assert!((found.mass() - m_S).abs() < 1.0e-6 && (found.rho_S() - rho_S).norm() < 1.0e-9);
/// assert!((found.I_S().unwrap() - I_S).norm() < 1.0e-6);
/// ```
pub fn two_step(segments: &[Vec<Reading>], given: impl Into<Given>) -> TwoStep {
    let given = given.into();
    let arm_mass = segments.iter().flatten().next().map_or(0.0, |s| s.arm.mass);
    // Step 1: A x = b, (11)-(13) or (15)-(17). The natural scale of x is unknown here, so columns are scaled equally.
    let known = given.p_C_N.map(|p| known_rows(0, &(p / arm_mass)));
    let rows = differences(segments, linear_rows, known);
    let mut answer = TwoStep::first(&rows, arm_mass);
    if answer.linear.structural_rank < 4 {
        return answer;
    }
    // Step 2: B y = c, (18)-(20) or (22)-(24), with mass and mass centre of step 1.
    let (m_S, rho_S) = (answer.mass(), answer.rho_S());
    let of = |s: &Reading| angular_rows(s, m_S, &rho_S);
    let rows = differences(segments, of, given.h_C_N.map(|h| known_rows(6, &h)));
    answer.angular = Some(solve::<6, 7>(&rows));
    answer
}

/// Rows of step 1, (10) and (13), including the arm's motion: `a = v + w x rho_R + u`.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// // Momentum is m_S (T x), with x = [m_R/m_S, rho_S, 1]: here zero.
/// let x = SVector::<f64, 5>::new(100.0 / m_S, rho_S.x, rho_S.y, rho_S.z, 1.0);
/// assert!((linear_rows(&samples[0]) * x).norm() < 1.0e-12);
/// ```
#[inline]
pub fn linear_rows(s: &Reading) -> LinearRows {
    let (w, arm) = (&s.w_NB_B, &s.arm);
    let a = s.v_NBo_B + w.cross(&arm.rho_R) + arm.u;
    let mut rows = LinearRows::zeros();
    rows.set_column(0, &(s.R_NB * a));
    put(&mut rows, 1, &(s.R_NB * skew(w)));
    rows.set_column(4, &(s.R_NB * s.v_NBo_B));
    rows
}

/// Rows of step 2, (20), including the arm's motion: `g = I_R w + h_R + mu d x (w x d + u)`, `d = rho_R - rho_S`.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// // Angular momentum is T [y, 1], with the six elements of the tensor: here zero.
/// let [xx, xy, yy, xz, yz, zz] = poinsot_spatial::elements(&I_S);
/// let y = SVector::from([xx, xy, yy, xz, yz, zz, 1.0]);
/// assert!((angular_rows(&samples[0], m_S, &rho_S) * y).norm() < 1.0e-9);
/// ```
#[inline]
pub fn angular_rows(s: &Reading, m_S: f64, rho_S: &Vector3) -> AngularRows {
    let (w, arm) = (&s.w_NB_B, &s.arm);
    let mu = arm.mass * m_S / (m_S + arm.mass);
    let d = arm.rho_R - rho_S;
    let g = arm.I_R * w + arm.h_R + d.cross(&(w.cross(&d) + arm.u)) * mu;
    let mut rows = AngularRows::zeros();
    put(&mut rows, 0, &(s.R_NB * tensor_regressor(w)));
    rows.set_column(6, &(s.R_NB * g));
    rows
}

/// Rows of one column alone: of a momentum that is known.
fn known_rows<const W: usize>(at: usize, column: &Vector3) -> SMatrix<f64, 3, W> {
    let mut rows = SMatrix::zeros();
    put(&mut rows, at, column);
    rows
}

/// The rows of all samples minus the known momentum (option 1), or minus the first row of the segment (option 2,
/// without the first row).
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// // Option 2 has no row for the first sample of a segment.
/// assert_eq!(differences(&[samples], linear_rows, None).len(), 6);
/// ```
pub fn differences<const W: usize>(
    segments: &[Vec<Reading>],
    rows: impl Fn(&Reading) -> SMatrix<f64, 3, W>,
    known: Option<SMatrix<f64, 3, W>>,
) -> Vec<SMatrix<f64, 3, W>> {
    let mut out = Vec::new();
    for segment in segments {
        let Some(first) = segment.first() else {
            continue;
        };
        let (reference, skip) = match known {
            Some(known) => (known, 0),
            None => (rows(first), 1),
        };
        out.extend(segment.iter().skip(skip).map(|s| rows(s) - reference));
    }
    out
}
