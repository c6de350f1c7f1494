//! Mass properties with sigma and source, for each body and for the whole vehicle.

use crate::fit::alternatives::OtherWheelMotion;
use crate::fit::triangle::ConditionalEstimate;
use crate::problem::parameters::{Equations, TENSOR, UnknownKind, rotation_properties};
use crate::problem::quantity::{Quantity, TenParameters};
use crate::solution::estimate::{BodyEstimate, Number, Principal, Source};
use crate::solution::solved::Solution;
use crate::solution::unobservable_set::UnobservableSet;
use nalgebra::Rotation3;
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_model::EstimateSet;
use poinsot_solve::Spectrum;
use poinsot_spatial::{MassProperties, Matrix3, Vector3, pseudo_inertia};

/// Value and sigma of quantities; `None` for an undetermined one.
pub(crate) struct QuantityEstimator<'a> {
    spectrum: &'a Spectrum,
    /// What the data say without the priors of mass properties.
    data_alone: Option<&'a Spectrum>,
    /// A quantity that is constant along it is determined.
    unobservable_set: &'a UnobservableSet,
    /// Factor on sigma where the residual is larger than declared.
    inflation: f64,
    rejected: bool,
    /// Nuisances as functions of the mass properties, and their conditional covariance.
    nuisances: ConditionalEstimate,
    other_wheel_motion: Option<&'a OtherWheelMotion>,
}

impl<'a> QuantityEstimator<'a> {
    pub(crate) fn new(solution: &'a Solution, inflation: f64, rejected: bool) -> Self {
        let spectrum = &solution.spectrum;
        Self {
            spectrum,
            data_alone: solution.data_alone(),
            unobservable_set: &solution.unobservable_set,
            inflation,
            rejected,
            other_wheel_motion: solution.other_wheel_motion(),
            nuisances: solution.shared.nuisance_estimate(&solution.x),
        }
    }

    /// A gradient over all unknowns as one over the mass properties, and the variance that the known numbers in it and the
    /// choice between two wheel motions add.
    fn folded(&self, gradient: &[f64]) -> (Vec<f64>, f64) {
        let m = self.spectrum.natural.len();
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
        if let Some(other) = self.other_wheel_motion {
            let change = other.change(gradient);
            own += other.covariance(change, change);
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
        match self.spectrum.sigma_within(used, self.inflation) {
            Some(sigma) if self.unobservable_set.holds(quantity, sigma, at) => {
                let sigma = sigma.hypot(own.sqrt()) * self.inflation;
                let mut number = Number::data(quantity.value, sigma, nominal);
                if self.data_alone.is_some_and(|d| d.sigma(used).is_none()) {
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
        let sigma = self.spectrum.sigma_within(&used, self.inflation)?;
        Some((sigma * sigma + own + known).sqrt() * self.inflation)
    }
}

/// One body.
pub(crate) fn body(estimator: &QuantityEstimator, solution: &Solution, at: usize) -> BodyEstimate {
    let parameters = &solution.parameters;
    let asked = parameters.estimate[at];
    let nominal = parameters.nominal_properties[at];
    let name = parameters.body_names[at].clone();
    if !asked.any() {
        return BodyEstimate::known(name, &nominal);
    }
    match parameters.equations {
        Equations::Momentum => {
            let ten = |x: &[f64]| TenParameters::of_body(parameters, at, x);
            from_ten(estimator, name, asked, &nominal, &ten(&solution.x), ten)
        }
        Equations::Rotation => rotation_body(estimator, solution, name, asked, &nominal),
    }
}

/// The whole vehicle with the joints where they are in `kinematics`.
pub(crate) fn system(
    estimator: &QuantityEstimator,
    solution: &Solution,
    tree: &Tree,
    joint_position: &[f64],
) -> BodyEstimate {
    let mut kinematics = Kinematics::new(tree);
    kinematics.place(tree, joint_position);
    let parameters = &solution.parameters;
    let ten = |x: &[f64]| TenParameters::of_system(parameters, &kinematics, x);
    let nominal = ten(&parameters.nominal_vector())
        .inertial()
        .mass_properties()
        .unwrap_or(MassProperties::ZERO);
    from_ten(
        estimator,
        "system".to_owned(),
        EstimateSet::ALL,
        &nominal,
        &ten(&solution.x),
        ten,
    )
}

fn from_ten(
    estimator: &QuantityEstimator,
    name: String,
    asked: EstimateSet,
    nominal: &MassProperties,
    ten: &TenParameters,
    at: impl Fn(&[f64]) -> TenParameters,
) -> BodyEstimate {
    let nominal_pi = nominal.parameters().to_array();
    let mass = estimator.number(&ten.parameter(0), nominal.mass, |x| at(x).parameter(0));
    let com = [0, 1, 2].map(|k| {
        if !asked.com {
            return Number::known(nominal.p_BoBcm_B[k]);
        }
        estimator.number(&ten.mass_centre(k), nominal.p_BoBcm_B[k], |x| {
            at(x).mass_centre(k)
        })
    });
    let inertia = [0, 1, 2, 3, 4, 5].map(|k| {
        if !asked.inertia {
            return Number::known(nominal.I_BBcm_B[TENSOR[k]]);
        }
        estimator.number(&ten.central_inertia(k), nominal.I_BBcm_B[TENSOR[k]], |x| {
            at(x).central_inertia(k)
        })
    });
    let barycentric = std::array::from_fn(|k| {
        estimator.number(&ten.parameter(k), nominal_pi[k], |x| at(x).parameter(k))
    });
    BodyEstimate::from_numbers(name, mass, com, inertia, barycentric)
}

fn rotation_body(
    estimator: &QuantityEstimator,
    solution: &Solution,
    name: String,
    asked: EstimateSet,
    nominal: &MassProperties,
) -> BodyEstimate {
    let parameters = &solution.parameters;
    let answer = rotation_properties(parameters, &solution.x);
    let pick = |wanted: &dyn Fn(&UnknownKind) -> bool, value: f64, nominal: f64, asked: bool| {
        let at = parameters.unknowns.iter().position(|u| wanted(&u.kind));
        match at {
            _ if !asked => Number::known(nominal),
            None => Number::undetermined(nominal),
            Some(at) => {
                let mut gradient = vec![0.0; parameters.len()];
                gradient[at] = 1.0;
                let quantity = Quantity { value, gradient };
                estimator.number(&quantity, nominal, |x| Quantity {
                    value: x[at],
                    gradient: quantity.gradient.clone(),
                })
            }
        }
    };
    // Rotation alone never shows the mass.
    let mass = if asked.mass {
        Number::undetermined(nominal.mass)
    } else {
        Number::known(nominal.mass)
    };
    let com = [0, 1, 2].map(|k| {
        let wanted = move |u: &UnknownKind| *u == UnknownKind::MassCentre(k);
        pick(
            &wanted,
            answer.p_BoBcm_B[k],
            nominal.p_BoBcm_B[k],
            asked.com,
        )
    });
    let inertia = [0, 1, 2, 3, 4, 5].map(|k| {
        let wanted = move |u: &UnknownKind| *u == UnknownKind::CentralInertia(k);
        let e = TENSOR[k];
        pick(
            &wanted,
            answer.I_BBcm_B[e],
            nominal.I_BBcm_B[e],
            asked.inertia,
        )
    });
    let nominal_pi = nominal.parameters().to_array();
    let ten = |x: &[f64]| TenParameters::of_body(parameters, 0, x);
    // Parameters that depend on an unknown mass, or on a mass centre that these data do not determine.
    let by_mass = MassProperties {
        mass: 1.0,
        I_BBcm_B: Matrix3::zeros(),
        ..answer
    };
    let by_mass = by_mass.parameters().to_array();
    let centre = |u: &UnknownKind| matches!(u, UnknownKind::MassCentre(_));
    let centre_is_open = asked.com && !parameters.unknowns.iter().any(|u| centre(&u.kind));
    let barycentric = std::array::from_fn(|k| match k {
        0 => mass,
        _ if centre_is_open || (asked.mass && by_mass[k] != 0.0) => {
            Number::undetermined(nominal_pi[k])
        }
        _ => estimator.number(&ten(&solution.x).parameter(k), nominal_pi[k], |x| {
            ten(x).parameter(k)
        }),
    });
    BodyEstimate::from_numbers(name, mass, com, inertia, barycentric)
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
        let pi = nominal.parameters().to_array();
        let mut body = Self::from_numbers(
            name,
            Number::known(nominal.mass),
            [0, 1, 2].map(|k| Number::known(nominal.p_BoBcm_B[k])),
            TENSOR.map(|e| Number::known(nominal.I_BBcm_B[e])),
            pi.map(Number::known),
        );
        body.asked = false;
        body
    }

    /// A body of these numbers: centre of mass in B, m; moments and products of inertia about it in the order of
    /// [`TENSOR`], kg m2; the ten parameters. Principal axes and physical consistency follow from them.
    pub fn from_numbers(
        name: String,
        mass: Number,
        com: [Number; 3],
        inertia: [Number; 6],
        barycentric: [Number; 10],
    ) -> Self {
        let tensor = all(&inertia).map(|t| tensor(&t));
        let principal = tensor.map(|I| {
            let (moments, axes) = MassProperties {
                mass: 1.0,
                p_BoBcm_B: Vector3::zeros(),
                I_BBcm_B: I,
            }
            .principal();
            let q = nalgebra::UnitQuaternion::from_rotation_matrix(
                &Rotation3::from_matrix_unchecked(axes),
            );
            Principal {
                moments_kg_m2: moments,
                axes_xyzw: [q.i, q.j, q.k, q.w],
            }
        });
        let physically_consistent = tensor.map(|I| {
            let candidate = MassProperties {
                mass: mass.value.unwrap_or(1.0),
                p_BoBcm_B: Vector3::zeros(),
                I_BBcm_B: I,
            };
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

fn tensor(t: &[f64; 6]) -> Matrix3 {
    let mut m = Matrix3::zeros();
    for (value, (i, j)) in t.iter().zip(TENSOR) {
        m[(i, j)] = *value;
        m[(j, i)] = *value;
    }
    m
}
