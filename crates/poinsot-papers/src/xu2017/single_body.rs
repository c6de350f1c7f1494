//! The equivalent single body: all joints locked, thrusters firing, (27)-(37).

use super::least_squares::{Answer, Rows, answer};
use super::swarm::{Cost, Mean, Particle};
use super::{particle, properties, tensor_regressor};
use nalgebra::SMatrix;
use poinsot_solve::lanes::V;
use poinsot_spatial::{MassProperties, Matrix3, UnitQuaternion, Vector3, skew};

/// The locked robot: mass, mass centre from the base origin and central inertia, base axes.
pub type Single = MassProperties;

/// One sample of the locked robot under thrust, base axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Angular velocity, rad/s.
    pub w_NB_B: Vector3,
    /// Angular acceleration, rad/s2.
    pub dw_NB_B: Vector3,
    /// Inertial acceleration of the sensor point (`v_s'`), m/s2; `None` without an accelerometer.
    pub a_NS_B: Option<Vector3>,
    /// Sensor point from the base origin (`r_s`), m.
    pub p_BoS_B: Vector3,
    /// Sum of the forces, N.
    pub F_B: Vector3,
    /// Sum of `r_i x f_i` about the base origin, N m.
    pub T_B: Vector3,
}

/// (36) of one sample, or its time integral, separated from the unknowns: `g = G y + B c - A`, `h = M (D + E c) - J`.
/// Here y is the tensor in the order of (61) and c the mass centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleRow {
    /// Coefficient of the tensor in the moment.
    pub G: SMatrix<f64, 3, 6>,
    /// Coefficient of the mass centre in the moment.
    pub B: Matrix3,
    /// Moment of thrust about the base origin.
    pub A: Vector3,
    /// Motion of the base origin; `None` if translation is not measured.
    pub D: Option<Vector3>,
    /// Coefficient of the mass centre in the motion.
    pub E: Matrix3,
    /// Force of thrust.
    pub J: Vector3,
}

/// Form of the equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// (35) as printed: angular acceleration and accelerometer.
    Acceleration,
    /// (35) integrated from the first sample: rates, velocity, attitude; no acceleration needed.
    Momentum,
}

/// Rows of (36), one per sample.
///
/// ```
#[doc = include_str!("../../doc/pushed.txt")]
/// // h = M (D + E c) - J vanishes at the true mass and mass centre.
/// let row = accelerations(&samples)[0];
/// let h = (row.D.unwrap() + row.E * c) * truth.mass - row.J;
/// assert!(h.norm() < 1.0e-12);
/// ```
pub fn accelerations(samples: &[Push]) -> Vec<SingleRow> {
    let of = |s: &Push| {
        let w = skew(&s.w_NB_B);
        // w' x and w x (w x): maps a position to an acceleration, (32).
        let E = skew(&s.dw_NB_B) + w * w;
        SingleRow {
            // I w' + w x I w, (28).
            G: tensor_regressor(&s.dw_NB_B) + w * tensor_regressor(&s.w_NB_B),
            // (r_i - c) x f_i = r_i x f_i + [F]x c, (29).
            B: -skew(&s.F_B),
            A: s.T_B,
            // v_s' - w' x (r_s - c) - w x (w x (r_s - c)), (35).
            D: s.a_NS_B.map(|a| a - E * s.p_BoS_B),
            E,
            J: s.F_B,
        }
    };
    samples.iter().map(of).collect()
}

/// Rows of (36) integrated over time from the first sample, in N: change of momentum minus impulse.
///
/// Per sample: attitude, velocity of the base origin in N if measured, angular velocity in B, and the impulses
/// `integral R f`, `integral R (r x f)`, `integral R [f]x` since the first sample.
///
/// ```
/// use poinsot_papers::xu2017::momenta;
/// use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
///
/// // 2 N s along x since the first sample, and 0.1 m/s: 20 kg.
/// let (none, skew) = (Vector3::zeros(), Matrix3::zeros());
/// let velocity = [none, Vector3::x() * 0.1];
/// let impulse = [(none, none, skew), (Vector3::x() * 2.0, none, skew)];
/// let rows = momenta(&[UnitQuaternion::identity(); 2], Some(&velocity), &[none; 2], &impulse);
/// assert_eq!(rows[1].D.unwrap() * 20.0, rows[1].J);
/// ```
pub fn momenta(
    R_NB: &[UnitQuaternion],
    v_NBo_N: Option<&[Vector3]>,
    w_NB_B: &[Vector3],
    impulse: &[(Vector3, Vector3, Matrix3)],
) -> Vec<SingleRow> {
    let turned = |k: usize| *R_NB[k].to_rotation_matrix().matrix();
    let spin = |k: usize| turned(k) * tensor_regressor(&w_NB_B[k]);
    let arm = |k: usize| turned(k) * skew(&w_NB_B[k]);
    let row = |k: usize| SingleRow {
        G: spin(k) - spin(0),
        B: -impulse[k].2,
        A: impulse[k].1,
        D: v_NBo_N.map(|v| v[k] - v[0]),
        E: arm(k) - arm(0),
        J: impulse[k].0,
    };
    let count = R_NB.len().min(w_NB_B.len()).min(impulse.len());
    (0..count).map(row).collect()
}

/// Known part of the locked robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Nothing.
    All,
    /// Mass and mass centre: the second use of the Conclusion.
    Inertia,
}

/// The linear solution of (35): with the force equation divided by M it is linear in `I_cm`, `r_cm`, `1/M`.
///
/// In the momentum form the momentum of the first sample is an additional unknown, so that its noise does not affect
/// every row. Unobservable directions keep the values of `nominal`. One list of rows per segment.
///
/// ```
#[doc = include_str!("../../doc/pushed.txt")]
/// let nominal = MassProperties { mass: 90.0, ..truth };
/// let rows = accelerations(&samples);
/// let found = solve_single(&[rows], Form::Acceleration, &nominal, Part::All);
/// assert_eq!(found.rank, 10);
/// assert!((found.value.mass - truth.mass).abs() < 1.0e-6);
/// assert!((found.value.I_BBcm_B - I).norm() < 1.0e-6);
/// ```
pub fn solve_single(
    segments: &[Vec<SingleRow>],
    form: Form,
    nominal: &Single,
    part: Part,
) -> Answer<Single> {
    let m = nominal.mass;
    let x = particle(nominal);
    let known = part == Part::Inertia;
    let translation = !known && segments.iter().flatten().any(|r| r.D.is_some());
    let per_segment = match (form, translation) {
        (Form::Acceleration, _) => 0,
        (Form::Momentum, true) => 6,
        (Form::Momentum, false) => 3,
    };
    let heads = per_segment * segments.len();
    let unknowns = if known { 6 } else { 10 };
    let mut system = Rows::new(heads, unknowns);
    let mut add = |head: usize, columns: &[f64; 10], right: f64| {
        let mut left = vec![0.0; heads];
        left.get_mut(head).into_iter().for_each(|own| *own = 1.0);
        left.extend(columns);
        system.push(&left, right);
    };
    for (segment, rows) in segments.iter().enumerate() {
        let start = per_segment * segment;
        for row in rows {
            for i in 0..3 {
                let (G, B) = (row.G.row(i), row.B.row(i));
                let columns = std::array::from_fn(|j| match j {
                    0..=5 => G[j],
                    6..=8 => B[j - 6],
                    _ => 0.0,
                });
                let given = (0..3).filter(|_| known);
                let right = given.fold(row.A[i], |right, j| right - B[j] * x[7 + j]);
                add(start + i, &columns, right);
            }
            let motion = row.D.iter().filter(|_| !known).flat_map(|D| D.iter());
            for (i, D) in motion.enumerate() {
                let columns = std::array::from_fn(|j| match j {
                    0..=5 => 0.0,
                    6..=8 => m * row.E[(i, j - 6)],
                    _ => -m * row.J[i],
                });
                add(start + 3 + i, &columns, -m * D);
            }
        }
    }
    let L = nominal.radius_of_gyration().max(1.0e-3);
    let mut natural = [m * L * L; 10];
    natural[6..9].fill(L);
    natural[9] = 1.0 / m;
    let mut start = [1.0 / m; 10];
    start[..9].copy_from_slice(&x[1..]);
    let found = answer(system, &natural[..unknowns], &start[..unknowns], None);
    found.map(|y| {
        let mut x = x;
        x[1..7].copy_from_slice(&y[..6]);
        if !known {
            x[0] = 1.0 / y[9];
            x[7..].copy_from_slice(&y[6..9]);
        }
        properties(&x)
    })
}

/// The cost (37), averaged over the samples, for many particles.
pub type SingleObjective = Mean<SingleCost, 45>;

/// (37): `|g| + |h|`.
pub struct SingleCost;

impl SingleObjective {
    /// From rows of [`accelerations`] or [`momenta`].
    pub fn new(rows: &[SingleRow]) -> Self {
        let numbers = |row: &SingleRow| {
            let seen = f64::from(u8::from(row.D.is_some()));
            let (D, E, J) = (row.D.unwrap_or_default(), row.E * seen, row.J * seen);
            let moment = row.G.iter().chain(row.B.iter()).chain(row.A.iter());
            let motion = D.iter().chain(E.iter()).chain(J.iter());
            moment.chain(motion).copied().collect()
        };
        Self::of(SingleCost, rows.iter().map(numbers))
    }
}

impl Cost<45> for SingleCost {
    type Body = Particle;

    #[inline(always)]
    fn body(&self, x: &Particle) -> Particle {
        *x
    }

    #[inline(always)]
    fn cost(s: &[V; 45], x: &Particle) -> V {
        let mass = V::all(x[0]);
        let y: [V; 6] = [x[1], x[2], x[3], x[4], x[5], x[6]].map(V::all);
        let c: [V; 3] = [x[7], x[8], x[9]].map(V::all);
        let mut square_g = V::ZERO;
        let mut square_h = V::ZERO;
        for i in 0..3 {
            let mut g = V::ZERO - s[27 + i];
            let mut d = s[30 + i];
            for j in 0..6 {
                g = g.plus(s[3 * j + i], y[j]);
            }
            for j in 0..3 {
                g = g.plus(s[18 + 3 * j + i], c[j]);
                d = d.plus(s[33 + 3 * j + i], c[j]);
            }
            let h = (V::ZERO - s[42 + i]).plus(mass, d);
            square_g = square_g.plus(g, g);
            square_h = square_h.plus(h, h);
        }
        square_g.root() + square_h.root()
    }
}
