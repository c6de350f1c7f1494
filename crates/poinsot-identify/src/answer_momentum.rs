//! Initial momentum of every segment and the nuisances, from the heads of the triangles.

use crate::answer_body::Judge;
use crate::estimate::{MomentumEstimate, NamedNumber, Number};
use crate::linear::{Reduced, Solved};
use crate::parameters::{Equations, UnknownKind};
use crate::quantity::TenParameters;
use crate::segment::Segment;
use faer::Mat;
use nalgebra::DMatrix;
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_model::MomentumKnowledge;
use poinsot_spatial::Vector3;

/// A vector with its gradient over the unknowns (three rows) and its own covariance given them.
struct VectorQuantity {
    value: Vector3,
    gradient: [Vec<f64>; 3],
    own: nalgebra::Matrix3<f64>,
}

/// Momentum at the first sample of a segment: linear, and angular about the system's mass centre.
pub(crate) fn momentum(
    judge: &Judge,
    solved: &Solved,
    tree: &Tree,
    segment: &Segment,
    reduced: &Reduced,
) -> MomentumEstimate {
    let n = solved.parameters.len();
    let (mean, slope, covariance) = head(&reduced.triangle.r, reduced.start.columns(), &solved.x);
    let pick = |from: usize, known: MomentumKnowledge| match known {
        MomentumKnowledge::Known(value) => VectorQuantity {
            value,
            gradient: std::array::from_fn(|_| vec![0.0; n]),
            own: nalgebra::Matrix3::zeros(),
        },
        MomentumKnowledge::Estimate => VectorQuantity {
            value: Vector3::new(mean[from], mean[from + 1], mean[from + 2]),
            gradient: std::array::from_fn(|k| slope[from + k].clone()),
            own: covariance.fixed_view::<3, 3>(from, from).into_owned(),
        },
    };
    let linear = pick(0, reduced.start.linear);
    let at = if reduced.start.linear == MomentumKnowledge::Estimate {
        3
    } else {
        0
    };
    let mut angular = pick(at, reduced.start.angular);
    if solved.parameters.equations == Equations::Momentum {
        about_mass_centre(solved, tree, segment, &linear, &mut angular);
    }
    let linear_open = solved.parameters.equations == Equations::Rotation;
    MomentumEstimate {
        linear: numbers(judge, &linear, reduced.start.linear, linear_open),
        angular: numbers(judge, &angular, reduced.start.angular, false),
    }
}

/// Values of `P` and `H` about the inertial origin at the first sample, N s and N m s.
pub(crate) fn start_values(solved: &Solved, reduced: &Reduced) -> (Vector3, Vector3) {
    let (mean, _, _) = head(&reduced.triangle.r, reduced.start.columns(), &solved.x);
    let mut left = mean.chunks_exact(3);
    let mut pick = |known: MomentumKnowledge| match known {
        MomentumKnowledge::Known(value) => value,
        MomentumKnowledge::Estimate => left
            .next()
            .map_or_else(Vector3::zeros, Vector3::from_row_slice),
    };
    let linear = pick(reduced.start.linear);
    (linear, pick(reduced.start.angular))
}

/// `h_cm = H - p_cm x P` with the mass centre a function of the unknowns.
fn about_mass_centre(
    solved: &Solved,
    tree: &Tree,
    segment: &Segment,
    linear: &VectorQuantity,
    angular: &mut VectorQuantity,
) {
    let s = &segment.samples;
    let mut kinematics = Kinematics::new(tree);
    kinematics.place(tree, s.joint_position.get(..tree.dof()).unwrap_or(&[]));
    let ten = TenParameters::of_system(&solved.parameters, &kinematics, &solved.x);
    let centre = [0, 1, 2].map(|k| ten.mass_centre(k));
    let R = s.R_NB.first().copied().unwrap_or_default();
    let c = R * Vector3::new(centre[0].value, centre[1].value, centre[2].value);
    let P = linear.value;
    angular.value -= c.cross(&P);
    let cross = poinsot_spatial::skew(&c);
    angular.own += cross * linear.own * cross.transpose();
    for u in 0..solved.x.len() {
        let dc = R * Vector3::new(
            centre[0].gradient[u],
            centre[1].gradient[u],
            centre[2].gradient[u],
        );
        let dP = Vector3::new(
            linear.gradient[0][u],
            linear.gradient[1][u],
            linear.gradient[2][u],
        );
        let step = dc.cross(&P) + c.cross(&dP);
        for k in 0..3 {
            angular.gradient[k][u] -= step[k];
        }
    }
}

fn numbers(
    judge: &Judge,
    quantity: &VectorQuantity,
    given: MomentumKnowledge,
    open: bool,
) -> [Number; 3] {
    [0, 1, 2].map(|k| {
        let value = quantity.value[k];
        match given {
            _ if open => Number::open(0.0),
            MomentumKnowledge::Known(known) => Number::known(known[k]),
            MomentumKnowledge::Estimate => match judge.sigma(&quantity.gradient[k]) {
                Some(sigma) => {
                    let total = (sigma * sigma + quantity.own[(k, k)]).sqrt();
                    Number::data(value, total, 0.0)
                }
                None => Number::open(0.0),
            },
        }
    })
}

/// Solves the head `R_hh h + R_hx x = d` of a triangle: mean, slope over x, covariance given x.
fn head(r: &Mat<f64>, h: usize, x: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>, DMatrix<f64>) {
    let n = x.len();
    let square = DMatrix::from_fn(h, h, |i, j| r[(i, j)]);
    let inverse = square
        .solve_upper_triangular(&DMatrix::identity(h, h))
        .unwrap_or_else(|| DMatrix::zeros(h, h));
    let slope = -&inverse * DMatrix::from_fn(h, n, |i, j| r[(i, h + j)]);
    let constant = &inverse * DMatrix::from_fn(h, 1, |i, _| r[(i, h + n)]);
    let mean = (0..h)
        .map(|i| {
            constant[(i, 0)]
                + x.iter()
                    .enumerate()
                    .map(|(j, v)| slope[(i, j)] * v)
                    .sum::<f64>()
        })
        .collect();
    let rows = (0..h)
        .map(|i| slope.row(i).iter().copied().collect())
        .collect();
    (mean, rows, &inverse * inverse.transpose())
}

/// Spin inertias, thruster scales and biases.
pub(crate) fn nuisances(judge: &Judge, solved: &Solved) -> Vec<NamedNumber> {
    let parameters = &solved.parameters;
    let p = solved.nuisances;
    let biases = parameters.len() - p;
    // The shared triangle holds the biases first; their slope runs over the other unknowns.
    let mut x = vec![0.0; parameters.len() - p];
    x.copy_from_slice(&solved.x[..biases]);
    let (_, slope, covariance) = head(&solved.shared, p, &x);
    parameters
        .unknowns
        .iter()
        .enumerate()
        .filter_map(|(at, unknown)| {
            let number = match unknown.kind {
                UnknownKind::SpinInertia(_) | UnknownKind::ThrusterScale(_) => {
                    let mut gradient = vec![0.0; parameters.len()];
                    gradient[at] = 1.0;
                    decide(judge.sigma(&gradient), solved.x[at], unknown.nominal)
                }
                UnknownKind::GyroBias(_) => {
                    let k = at - biases;
                    let seen = solved.shared[(k, k)].abs() > f64::MIN_POSITIVE;
                    let sigma = judge
                        .sigma(&slope[k])
                        .filter(|_| seen)
                        .map(|s| (s * s + covariance[(k, k)]).sqrt());
                    decide(sigma, solved.x[at], unknown.nominal)
                }
                _ => return None,
            };
            Some(NamedNumber {
                name: unknown.name.clone(),
                unit: unknown.unit,
                number,
            })
        })
        .collect()
}

fn decide(sigma: Option<f64>, value: f64, nominal: f64) -> Number {
    match sigma {
        Some(sigma) => Number::data(value, sigma, nominal),
        None => Number::open(nominal),
    }
}
