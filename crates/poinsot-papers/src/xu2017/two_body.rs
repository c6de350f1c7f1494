//! The equivalent two-body system: one joint moves, momentum is conserved, (38)-(52).
//!
//! Momentum is linear in the barycentric parameters of both sides; the other side follows from the searched one by
//! (43), (44), (46). Every sample therefore gives rows in ten numbers: [`rows`].

use super::properties;
use super::swarm::{Cost, Mean, Particle};
use nalgebra::{SMatrix, SVector};
use poinsot_dynamics::{Kinematics, body_momentum};
use poinsot_solve::lanes::V;
use poinsot_spatial::{InertialParameters, Matrix3, UnitQuaternion, Vector3};

/// Frame and motion of a side, (38), in base axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// `A~`: rotation from the side's frame to the base.
    pub R: Matrix3,
    /// Origin of the frame from the base origin, m.
    pub p: Vector3,
    /// Velocity of the origin, m/s.
    pub v: Vector3,
    /// Angular velocity, rad/s.
    pub w: Vector3,
}

impl Side {
    /// A body as a side.
    pub fn of(kinematics: &Kinematics, body: usize) -> Self {
        Self {
            R: kinematics.R[body],
            p: kinematics.p[body],
            v: kinematics.v[body],
            w: kinematics.w[body],
        }
    }
}

/// One sample of the robot with both sides of the unlocked joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoBodyReading {
    /// Attitude.
    pub R_NB: UnitQuaternion,
    /// Base origin in N, m.
    pub p_NoBo_N: Vector3,
    /// Base side: the base's own frame.
    pub inner: Side,
    /// Tip side: the frame of the body behind the joint.
    pub outer: Side,
    /// Linear momentum, angular momentum and first moment of separately known bodies, about the base origin, in base
    /// axes.
    pub rest: [Vector3; 3],
}

impl TwoBodyReading {
    /// Both sides of the joint before a body, with N at the base origin and along its axes.
    pub(super) fn in_base(kinematics: &Kinematics, outer: usize) -> Self {
        Self {
            R_NB: UnitQuaternion::identity(),
            p_NoBo_N: Vector3::zeros(),
            inner: Side::of(kinematics, 0),
            outer: Side::of(kinematics, outer),
            rest: [Vector3::zeros(); 3],
        }
    }
}

/// Momentum of one sample as a function of the ten numbers `x` of one body, about the base origin in base axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentumRow {
    /// Without the body: linear momentum, first moment, angular momentum, `[l; s; h]`.
    pub constant: SVector<f64, 9>,
    /// Derivative with respect to its ten parameters.
    pub slope: SMatrix<f64, 9, 10>,
    /// Attitude.
    pub R_NB: UnitQuaternion,
    /// Base origin in N, m.
    pub p_NoBo_N: Vector3,
}

/// (47) and (48) of both sides about the base origin, with the first moment of the whole for (42).
fn momentum(
    reading: &TwoBodyReading,
    inner: &InertialParameters,
    outer: &InertialParameters,
) -> SVector<f64, 9> {
    let [mut l, mut h, mut s] = reading.rest;
    for (side, body) in [(&reading.inner, inner), (&reading.outer, outer)] {
        let (dl, dh) = body_momentum(body, &side.R, &side.p, &side.v, &side.w);
        l += dl;
        h += dh;
        s += side.R * body.mc_B + side.p * body.mass;
    }
    SVector::from_iterator(l.iter().chain(s.iter()).chain(h.iter()).copied())
}

/// Rows of (49) in the ten numbers of the searched body; `compose` gives both sides from it, (43)-(46).
///
/// ```
/// use poinsot_papers::xu2017::{Side, TwoBodyReading, rows};
/// use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
///
/// // Both sides move along x at 1 m/s.
/// let side = Side { R: Matrix3::identity(), p: Vector3::zeros(), v: Vector3::x(), w: Vector3::zeros() };
/// let reading = TwoBodyReading {
///     R_NB: UnitQuaternion::identity(),
///     p_NoBo_N: Vector3::zeros(),
///     inner: side,
///     outer: side,
///     rest: [Vector3::zeros(); 3],
/// };
/// // The searched body is on both sides: each kilogram adds 2 N s.
/// let row = rows(&[reading], |body| [*body, *body])[0];
/// assert_eq!(row.slope[(0, 0)], 2.0);
/// ```
pub fn rows(
    readings: &[TwoBodyReading],
    compose: impl Fn(&InertialParameters) -> [InertialParameters; 2],
) -> Vec<MomentumRow> {
    let none = compose(&InertialParameters::ZERO);
    let units: [[InertialParameters; 2]; 10] =
        std::array::from_fn(|k| compose(&InertialParameters::unit(k)));
    let of = |reading: &TwoBodyReading| {
        let constant = momentum(reading, &none[0], &none[1]);
        let mut slope = SMatrix::<f64, 9, 10>::zeros();
        for (k, [inner, outer]) in units.iter().enumerate() {
            slope.set_column(k, &(momentum(reading, inner, outer) - constant));
        }
        MomentumRow {
            constant,
            slope,
            R_NB: reading.R_NB,
            p_NoBo_N: reading.p_NoBo_N,
        }
    };
    readings.iter().map(of).collect()
}

/// Rows of linear and angular momentum in a [`MomentumRow`].
pub(super) const LINES: [usize; 6] = [0, 1, 2, 6, 7, 8];

/// The six equations of every row in base axes.
pub(super) fn equations(list: &[MomentumRow]) -> Vec<[f64; 10]> {
    let of = |row: &MomentumRow| LINES.map(|i| std::array::from_fn(|j| row.slope[(i, j)]));
    list.iter().flat_map(of).collect()
}

/// The inverse of [`InertialParameters::transported`], the parallel-axis theorem of (44) before division by the mass.
pub fn transported_back(body: &InertialParameters, R: &Matrix3, p: &Vector3) -> InertialParameters {
    let inverse = R.transpose();
    body.transported(&inverse, &-(inverse * p))
}

const L: usize = 9;
/// Numbers of a sample: the tensor does not enter linear momentum and first moment.
const NUMBERS: usize = L + 6 * 4 + 3 * 10;

/// The cost (52), averaged over the samples, for many particles.
///
/// `H` of (51) is taken about the origin of the inertial frame, which is the system's mass centre. (42) locates the
/// base there, so `H = h - (s/M) x l` in base axes.
pub type TwoBodyObjective = Mean<TwoBodyCost, NUMBERS>;

/// (52): `|P| + |H|`.
pub struct TwoBodyCost {
    /// Total mass without the searched body, or the given total mass, kg.
    constant: f64,
    /// 1 if the searched body adds its mass, otherwise 0.
    slope: f64,
}

impl TwoBodyObjective {
    /// From rows with zero momentum; `total` is the total mass, if known, and `rest` that of all but the searched body.
    pub fn new(rows: &[MomentumRow], total: Option<f64>, rest: f64) -> Self {
        let cost = TwoBodyCost {
            constant: total.unwrap_or(rest),
            slope: f64::from(u8::from(total.is_none())),
        };
        let numbers = |row: &MomentumRow| {
            let upper = row.slope.fixed_view::<6, 4>(0, 0);
            let lower = row.slope.fixed_view::<3, 10>(6, 0);
            let all = row.constant.iter().chain(upper.iter()).chain(lower.iter());
            all.copied().collect()
        };
        Self::of(cost, rows.iter().map(numbers))
    }
}

impl Cost<NUMBERS> for TwoBodyCost {
    /// Ten parameters, and the reciprocal of the total mass.
    type Body = ([V; 10], V);

    #[inline(always)]
    fn body(&self, x: &Particle) -> ([V; 10], V) {
        let ten = properties(x).parameters().to_array();
        let mass = self.constant + self.slope * x[0];
        (ten.map(V::all), V::all(1.0 / mass))
    }

    #[inline(always)]
    fn cost(s: &[V; NUMBERS], &(x, inverse_mass): &([V; 10], V)) -> V {
        let mut upper = [s[0], s[1], s[2], s[3], s[4], s[5]];
        for j in 0..4 {
            for i in 0..6 {
                upper[i] = upper[i].plus(s[L + 6 * j + i], x[j]);
            }
        }
        let mut h = [s[6], s[7], s[8]];
        for j in 0..10 {
            for i in 0..3 {
                h[i] = h[i].plus(s[L + 24 + 3 * j + i], x[j]);
            }
        }
        let [lx, ly, lz, sx, sy, sz] = upper;
        let [cx, cy, cz] = [sx * inverse_mass, sy * inverse_mass, sz * inverse_mass];
        let hx = h[0].less(cy, lz).plus(cz, ly);
        let hy = h[1].less(cz, lx).plus(cx, lz);
        let hz = h[2].less(cx, ly).plus(cy, lx);
        let P = (lx * lx).plus(ly, ly).plus(lz, lz);
        let H = (hx * hx).plus(hy, hy).plus(hz, hz);
        P.root() + H.root()
    }
}
