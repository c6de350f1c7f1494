//! Mass properties with sigma and source, for each body and for the whole vehicle.

use crate::fit::triangle::ConditionalEstimate;
use crate::problem::parameters::{
    Equations, Parameters, Unknown, UnknownKind, rotation_properties,
};
use crate::problem::quantity::{Quantity, TenParameters, mass_property};
use crate::solution::estimate::{BodyEstimate, Number, Principal, Source};
use crate::solution::solved::{CHANGE, Solution};
use nalgebra::Rotation3;
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_model::EstimateSet;
use poinsot_spatial::{MassProperties, Matrix3, Vector3, pseudo_inertia, tensor};

/// Value and sigma of quantities; `None` for an undetermined one.
pub(crate) struct QuantityEstimator<'a> {
    /// What is estimated from.
    pub solution: &'a Solution,
    /// Factor on sigma where the residual is larger than declared.
    inflation: f64,
    rejected: bool,
    /// Nuisances as functions of the mass properties, and their conditional covariance.
    pub nuisances: ConditionalEstimate,
}

impl<'a> QuantityEstimator<'a> {
    pub(crate) fn new(solution: &'a Solution, inflation: f64, rejected: bool) -> Self {
        Self {
            solution,
            inflation,
            rejected,
            nuisances: solution.shared.nuisance_estimate(&solution.x),
        }
    }

    /// A gradient over all unknowns as one over the mass properties, and the variance that the known numbers in it and the
    /// choice between two wheel motions add.
    fn folded(&self, gradient: &[f64]) -> (Vec<f64>, f64) {
        let m = self.solution.spectrum.natural.len();
        let (used, behind) = gradient.split_at(m.min(gradient.len()));
        let mut used = used.to_vec();
        let mut own = 0.0;
        for (i, a) in behind.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            for (sum, slope) in used.iter_mut().zip(&self.nuisances.slope[i]) {
                *sum += a * slope;
            }
            for (j, b) in behind.iter().enumerate().filter(|(_, b)| **b != 0.0) {
                own += a * b * self.nuisances.covariance[(i, j)];
            }
        }
        if let Some(other) = self.solution.other_wheel_motion() {
            own += other.variance(gradient);
        }
        (used, own)
    }

    /// The number for a quantity; `at` evaluates it for other values of the unknowns.
    pub(crate) fn number(
        &self,
        quantity: &Quantity,
        nominal: f64,
        at: impl Fn(&[f64]) -> Quantity,
    ) -> Number {
        let (used, own) = self.folded(&quantity.gradient);
        let used = used.as_slice();
        if own == 0.0 && used.iter().all(|g| *g == 0.0) {
            return Number::known(quantity.value);
        }
        if self.rejected || !quantity.value.is_finite() {
            return Number::undetermined(nominal);
        }
        let accurate = self.solution.spectrum.is_accurate(used, self.inflation);
        let sigma = self.solution.spectrum.sigma_within(used, self.inflation);
        match sigma.filter(|_| accurate) {
            Some(sigma) if self.solution.holds(quantity, sigma, at) => {
                let sigma = sigma.hypot(own.sqrt()) * self.inflation;
                let mut number = Number::data(quantity.value, sigma, nominal);
                if self
                    .solution
                    .data_alone()
                    .is_some_and(|d| d.sigma(used).is_none())
                {
                    number.source = Source::Prior;
                }
                number
            }
            _ => Number::undetermined(nominal),
        }
    }

    /// Sigma of a number with this gradient and a variance of its own; `None` if it is undetermined.
    pub(crate) fn sigma_with(&self, gradient: &[f64], own: f64) -> Option<f64> {
        if self.rejected {
            return None;
        }
        let (used, known) = self.folded(gradient);
        let (spectrum, own) = (&self.solution.spectrum, own + known);
        // What hardly depends on the mass properties needs none of them.
        let sigma = match spectrum.change(&used) <= CHANGE * own.sqrt() {
            true => 0.0,
            false => spectrum.sigma_within(&used, self.inflation)?,
        };
        Some((sigma * sigma + own).sqrt() * self.inflation)
    }
}

/// One body.
pub(crate) fn body(estimator: &QuantityEstimator, at: usize) -> BodyEstimate {
    let parameters = &estimator.solution.parameters;
    let asked = parameters.estimate[at];
    let nominal = parameters.nominal_properties[at];
    let name = parameters.body_names[at].clone();
    if !asked.any() {
        return BodyEstimate::known(name, &nominal);
    }
    let of = |k: usize, x: &[f64]| mass_property(parameters, at, k, x);
    let ten = |x: &[f64]| TenParameters::of_body(parameters, at, x);
    let open = open_barycentric(parameters, asked, &estimator.solution.x);
    let numbers = estimator.numbers(asked, &nominal, of);
    let barycentric = estimator.barycentric(&nominal, ten, open);
    of_numbers(name, numbers, barycentric)
}

/// The whole vehicle with the joints where they are in `kinematics`.
pub(crate) fn system(
    estimator: &QuantityEstimator,
    tree: &Tree,
    joint_position: &[f64],
) -> BodyEstimate {
    let kinematics = Kinematics::at(tree, joint_position);
    let parameters = &estimator.solution.parameters;
    let ten = |x: &[f64]| TenParameters::of_system(parameters, &kinematics, x);
    let nominal = ten(&parameters.nominal_vector())
        .inertial()
        .mass_properties()
        .unwrap_or(MassProperties::ZERO);
    let of = |k: usize, x: &[f64]| Some(ten(x).mass_property(k));
    let numbers = estimator.numbers(EstimateSet::ALL, &nominal, of);
    let barycentric = estimator.barycentric(&nominal, ten, [false; 10]);
    of_numbers("system".to_owned(), numbers, barycentric)
}

impl QuantityEstimator<'_> {
    /// The ten mass properties; `of` gives each at any value of the unknowns.
    fn numbers(
        &self,
        asked: EstimateSet,
        nominal: &MassProperties,
        of: impl Fn(usize, &[f64]) -> Option<Quantity>,
    ) -> [Number; 10] {
        let nominal = nominal.to_array();
        // A mass that is not asked may be known within its uncertainty.
        let own = |k: usize| of(k, &self.solution.x).filter(|_| k == 0 || asked.has(k));
        std::array::from_fn(|k| match own(k) {
            Some(own) => self.number(&own, nominal[k], |x| of(k, x).unwrap_or(own.clone())),
            None if asked.has(k) => Number::undetermined(nominal[k]),
            None => Number::known(nominal[k]),
        })
    }

    /// The ten barycentric parameters; those that are `open` are not determined.
    fn barycentric(
        &self,
        nominal: &MassProperties,
        at: impl Fn(&[f64]) -> TenParameters,
        open: [bool; 10],
    ) -> [Number; 10] {
        let (nominal, ten) = (nominal.parameters().to_array(), at(&self.solution.x));
        std::array::from_fn(|k| match open[k] {
            true => Number::undetermined(nominal[k]),
            false => self.number(&ten.parameter(k), nominal[k], |x| at(x).parameter(k)),
        })
    }
}

/// Parameters that depend on an unknown mass, or on a mass centre that these data do not determine, where rotation alone is seen: it
/// never shows the mass.
fn open_barycentric(parameters: &Parameters, asked: EstimateSet, x: &[f64]) -> [bool; 10] {
    if parameters.equations == Equations::Momentum {
        return [false; 10];
    }
    let by_mass = MassProperties {
        mass: 1.0,
        I_BBcm_B: Matrix3::zeros(),
        ..rotation_properties(parameters, x)
    };
    let by_mass = by_mass.parameters().to_array();
    let centre = |u: &Unknown| matches!(u.kind, UnknownKind::MassCentre(_));
    let centre_is_open = asked.com && !parameters.unknowns.iter().any(centre);
    std::array::from_fn(|k| centre_is_open && k > 0 || asked.mass && by_mass[k] != 0.0)
}

fn of_numbers(name: String, ten: [Number; 10], barycentric: [Number; 10]) -> BodyEstimate {
    let [mass, x, y, z, inertia @ ..] = ten;
    BodyEstimate::from_numbers(name, mass, [x, y, z], inertia, barycentric)
}

impl BodyEstimate {
    /// Mass, mass centre and inertia in the order of [`poinsot_spatial::MASS_PROPERTY_NAMES`].
    pub fn numbers(&self) -> [Number; 10] {
        let mut ten = [self.mass; 10];
        ten[1..4].copy_from_slice(&self.com);
        ten[4..].copy_from_slice(&self.inertia);
        ten
    }

    /// A body that is known: every number nominal, without sigma.
    pub fn known(name: String, nominal: &MassProperties) -> Self {
        let [ten, pi] = [nominal.to_array(), nominal.parameters().to_array()];
        let mut body = of_numbers(name, ten.map(Number::known), pi.map(Number::known));
        body.asked = false;
        body
    }

    /// A body of these numbers: centre of mass in B, m; moments and products of inertia about it in the order of
    /// [`poinsot_spatial::TENSOR`], kg m2; the ten parameters. Principal axes and physical consistency follow from them.
    pub fn from_numbers(
        name: String,
        mass: Number,
        com: [Number; 3],
        inertia: [Number; 6],
        barycentric: [Number; 10],
    ) -> Self {
        let tensor = all(&inertia).map(tensor);
        let about_centre = |mass, I_BBcm_B| MassProperties {
            mass,
            p_BoBcm_B: Vector3::zeros(),
            I_BBcm_B,
        };
        let principal = tensor.map(|I| {
            let (moments, axes) = about_centre(1.0, I).principal();
            let q = nalgebra::UnitQuaternion::from_rotation_matrix(
                &Rotation3::from_matrix_unchecked(axes),
            );
            Principal {
                moments_kg_m2: moments,
                axes_xyzw: [q.i, q.j, q.k, q.w],
            }
        });
        let physically_consistent = tensor.map(|I| {
            let candidate = about_centre(mass.value.unwrap_or(1.0), I);
            pseudo_inertia(&candidate.parameters()).cholesky().is_some()
                || candidate.check_physical(1.0e-9).is_ok()
        });
        Self {
            name,
            asked: true,
            mass,
            com,
            inertia,
            barycentric,
            principal,
            physically_consistent,
        }
    }
}

fn all<const N: usize>(numbers: &[Number; N]) -> Option<[f64; N]> {
    let mut out = [0.0; N];
    for (o, n) in out.iter_mut().zip(numbers) {
        *o = n.value?;
    }
    Some(out)
}
