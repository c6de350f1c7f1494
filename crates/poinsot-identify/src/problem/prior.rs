//! Priors: declared sigmas of nominal values, as rows in addition to those of the sensors.

use crate::problem::Problem;
use crate::problem::parameters::{Equations, Parameters};
use crate::problem::quantity::{Quantity, TenParameters, mass_property, unit};
use nalgebra::{DMatrix, Matrix4};
use poinsot_formats::address;
use poinsot_model::{Model, Nuisance, Prior};
use poinsot_solve::BlockQr;
use poinsot_spatial::{
    InertialParameters, MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS, pseudo_inertia,
};
use statrs::function::erf::erfc;

/// Smallest share of a declared variance for a test against the data.
pub(crate) const LEAST_SHARE: f64 = 1.0e-6;

/// One row: `gradient . dx = residual`, both over the sigma.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PriorRow {
    pub gradient: Vec<f64>,
    pub residual: f64,
    /// What is declared; `None` of a row that is not about one number.
    pub about: Option<Declared>,
}

impl PriorRow {
    /// Adds the row to a system of fitted numbers, of `others` that it does not tell of, and of a right-hand side.
    pub fn add_to(&self, stacked: &mut BlockQr, fitted: usize, others: usize) {
        stacked.push(1, |_, j| match j {
            j if j < fitted => self.gradient.get(j).copied().unwrap_or(0.0),
            j if j < fitted + others => 0.0,
            _ => self.residual,
        });
    }
}

/// One number with its declared sigma.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Declared {
    pub name: String,
    pub unit: &'static str,
    pub nominal: f64,
    pub sigma: f64,
}

/// Priors that the data contradict.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Conflict {
    pub text: String,
    /// Factor on every variance that covers the shift of the answer by the priors of mass properties. Calibrations (a
    /// bias, a random torque) act on the answer through others, and a bound on that would be far above what they do.
    pub ratio: f64,
}

/// One test of declared numbers against the data.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PriorTest {
    /// What was declared.
    pub of: &'static str,
    /// Name and value of the statistic.
    pub statistic: (&'static str, f64),
    /// Degrees of freedom of a chi-square; how many numbers were compared otherwise.
    pub count: usize,
    pub p: f64,
    pub contradicted: bool,
}

impl PriorTest {
    /// Of the largest of several differences in sigmas.
    pub fn of_largest(of: &'static str, z: f64, count: usize, limit: f64) -> Self {
        Self {
            of,
            statistic: ("largest difference, sigma", z.abs()),
            count,
            p: chance_of_largest(z, count),
            contradicted: z.abs() > limit,
        }
    }
}

/// Chance of a difference as large as the largest of so many, sigmas: at most the sum of that of all (Bonferroni); 1 of none.
pub(crate) fn chance_of_largest(z: f64, count: usize) -> f64 {
    (count.max(1) as f64 * erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2)).min(1.0)
}

/// Rows of the declared priors at a value of the unknowns, and their contribution to chi-square.
#[derive(Debug, Clone, Default)]
pub(crate) struct PriorRows {
    pub rows: Vec<PriorRow>,
    pub chi2: f64,
}

impl PriorRows {
    fn push(&mut self, gradient: Vec<f64>, residual: f64, about: Option<Declared>) {
        self.chi2 += residual * residual;
        self.rows.push(PriorRow {
            gradient,
            residual,
            about,
        });
    }

    /// Deviations from zero with this covariance, over its root.
    fn whitened(&mut self, covariance: DMatrix<f64>, deviations: &[Quantity]) {
        let n = deviations.len();
        let root = covariance.cholesky().map(|c| c.l());
        let inverse = root.and_then(|l| l.solve_lower_triangular(&DMatrix::identity(n, n)));
        let Some(inverse) = inverse else { return };
        for i in 0..n {
            let mut gradient = vec![0.0; deviations[i].gradient.len()];
            let mut residual = 0.0;
            for (j, deviation) in deviations.iter().enumerate().take(i + 1) {
                let slopes = gradient.iter_mut().zip(&deviation.gradient);
                slopes.for_each(|(sum, own)| *sum += inverse[(i, j)] * own);
                residual -= inverse[(i, j)] * deviation.value;
            }
            self.push(gradient, residual, None);
        }
    }

    fn gaussian(&mut self, quantity: &Quantity, declared: Declared) {
        let sigma = declared.sigma;
        let gradient = quantity.gradient.iter().map(|g| g / sigma).collect();
        let residual = (declared.nominal - quantity.value) / sigma;
        self.push(gradient, residual, Some(declared));
    }
}

/// Priors of sensors and thrusters: calibration, part of the experiment.
pub(crate) fn calibration(problem: &Problem, parameters: &Parameters, x: &[f64]) -> PriorRows {
    let mut out = PriorRows::default();
    let registry = problem.registry();
    known_numbers(parameters, x, &mut out);
    earlier(problem.model, parameters, x, &mut out);
    for (at, unknown) in parameters.unknowns.iter().enumerate() {
        let declared = registry.entry(&unknown.kind).map(|entry| entry.declared);
        let told = is_told(problem.model, &unknown.name, unknown.unit);
        if let Some(Nuisance::Prior(sigma)) = declared.filter(|_| !told) {
            let declared = Declared {
                name: unknown.name.clone(),
                unit: unknown.unit,
                nominal: unknown.nominal,
                sigma,
            };
            out.gaussian(&Quantity::unknown(at, x), declared);
        }
    }
    out
}

/// Known numbers about the values of the model: deviations over the root of their declared covariance.
fn known_numbers(parameters: &Parameters, x: &[f64], out: &mut PriorRows) {
    let places = parameters.known_places();
    if places.is_empty() {
        return;
    }
    let deviations = places.iter().map(|k| deviation(parameters, *k, x));
    out.whitened(
        parameters.known_covariance(),
        &deviations.collect::<Vec<_>>(),
    );
}

/// What an earlier answer told: numbers about the values of the model, less what known numbers move, over the root of their
/// covariance. Numbers without effect on this record drop out.
fn earlier(model: &Model, parameters: &Parameters, x: &[f64], out: &mut PriorRows) {
    let Some(told) = &model.knowledge.posterior else {
        return;
    };
    let unknown = |at: &str| {
        let mut all = parameters.unknowns.iter();
        all.position(|u| address(&u.name, u.unit) == at)
    };
    let known = told.known.iter();
    let known: Vec<_> = known
        .filter_map(|k| Some((unknown(&k.address)?, &k.slopes)))
        .collect();
    let (mut places, mut deviations) = (Vec::new(), Vec::new());
    for (at, number) in told.numbers.iter().enumerate() {
        let of_body = deviation_of_body(parameters, number, x);
        let own = of_body.or_else(|| Some(deviation(parameters, unknown(number)?, x)));
        let Some(mut own) = own else { continue };
        for (place, slopes) in &known {
            own.value -= slopes[at] * deviation(parameters, *place, x).value;
            own.gradient[*place] -= slopes[at];
        }
        places.push(at);
        deviations.push(own);
    }
    let n = places.len();
    let covariance = DMatrix::from_fn(n, n, |i, j| told.covariance[places[i]][places[j]]);
    out.whitened(covariance, &deviations);
}

/// An unknown less its nominal value.
fn deviation(parameters: &Parameters, place: usize, x: &[f64]) -> Quantity {
    let mut own = Quantity::unknown(place, x);
    own.value -= parameters.unknowns[place].nominal;
    own
}

/// A number of a body, by its address, less its nominal value.
fn deviation_of_body(parameters: &Parameters, at: &str, x: &[f64]) -> Option<Quantity> {
    let named = |(body, name): (usize, &String)| {
        let is = |of: &&str| address(&format!("{name}.{of}"), "") == at;
        let number = MASS_PROPERTY_NAMES.iter().position(is)?;
        Some((body, number))
    };
    let names = parameters.body_names.iter().enumerate();
    let mut own = names.filter(|(_, name)| at.starts_with(name.as_str()));
    let (body, number) = own.find_map(named)?;
    if !parameters.estimate[body].has(number) {
        return None;
    }
    let mut quantity = mass_property(parameters, body, number, x)?;
    quantity.value -= parameters.nominal_properties[body].to_array()[number];
    Some(quantity)
}

/// Whether an earlier answer told of a number, so that its declared prior does not count again.
fn is_told(model: &Model, name: &str, unit: &str) -> bool {
    let told = model.knowledge.posterior.as_ref();
    told.is_some_and(|told| told.place(&address(name, unit)).is_some())
}

/// Priors of mass properties (CAD). `None` where an entropic prior meets a body that is not physical.
pub(crate) fn design(problem: &Problem, parameters: &Parameters, x: &[f64]) -> Option<PriorRows> {
    let mut out = PriorRows::default();
    for (at, body) in problem.model.bodies.iter().enumerate() {
        let Some(prior) = &body.prior else { continue };
        if !body.estimate.any() {
            continue;
        }
        body_rows(&mut out, (problem.model, parameters), at, prior, x)?;
    }
    Some(out)
}

fn body_rows(
    out: &mut PriorRows,
    (model, parameters): (&Model, &Parameters),
    at: usize,
    prior: &Prior,
    x: &[f64],
) -> Option<()> {
    let (asked, body) = (parameters.estimate[at], &parameters.body_names[at]);
    let nominal = parameters.nominal_properties[at].to_array();
    let mut any_told = false;
    for (k, nominal) in nominal.into_iter().enumerate() {
        let name = format!("{body}.{}", MASS_PROPERTY_NAMES[k]);
        if is_told(model, &name, "") {
            any_told = true;
            continue;
        }
        let quantity = asked.has(k).then(|| mass_property(parameters, at, k, x));
        if let (Some(sigma), Some(quantity)) = (prior.sigma(k), quantity.flatten()) {
            let declared = Declared {
                name,
                unit: MASS_PROPERTY_UNITS[k],
                nominal,
                sigma,
            };
            out.gaussian(&quantity, declared);
        }
    }
    let momentum = parameters.equations == Equations::Momentum;
    if let Some(sigma) = prior.entropic.filter(|_| momentum && !any_told) {
        let ten = TenParameters::of_body(parameters, at, x);
        entropic(out, &ten, &parameters.nominal[at], sigma)?;
    }
    Some(())
}

/// The entropic prior (Lee, Wensing, Park 2020): the Bregman divergence of the log-determinant between
/// pseudo-inertias, `d = tr(J J0^-1) - log det(J J0^-1) - 4`, over `2 sigma^2`; a body scaled by
/// `1 + sigma` costs one. Its rows are the Newton step of `d`: gradient and Hessian in the ten parameters.
fn entropic(
    out: &mut PriorRows,
    ten: &TenParameters,
    nominal: &InertialParameters,
    sigma: f64,
) -> Option<()> {
    let J = pseudo_inertia(&ten.inertial());
    let J0_inverse = pseudo_inertia(nominal).cholesky()?.inverse();
    let J_factor = J.cholesky()?;
    let J_inverse = J_factor.inverse();
    let basis: Vec<Matrix4<f64>> = (0..10)
        .map(|k| pseudo_inertia(&InertialParameters::from_array(&unit(k))))
        .collect();
    let scale = 1.0 / (2.0 * sigma * sigma);
    let images: Vec<Matrix4<f64>> = basis.iter().map(|e| J_inverse * e).collect();
    // chi2 = scale d: half its gradient and half its Hessian make the normal equations.
    let slope = DMatrix::from_fn(10, 1, |k, _| {
        0.5 * scale * ((J0_inverse - J_inverse) * basis[k]).trace()
    });
    let hessian = DMatrix::from_fn(10, 10, |i, k| 0.5 * scale * (images[i] * images[k]).trace());
    let L = hessian.cholesky()?.l();
    let residual = L.solve_lower_triangular(&slope)?;
    let rows = L.transpose();
    for k in 0..10 {
        let gradient = (0..ten.gradient[0].len())
            .map(|u| (0..10).map(|i| rows[(k, i)] * ten.gradient[i][u]).sum())
            .collect();
        out.rows.push(PriorRow {
            gradient,
            residual: -residual[(k, 0)],
            about: None,
        });
    }
    let log_ratio = J_factor.determinant().ln() + J0_inverse.determinant().ln();
    out.chi2 += scale * ((J * J0_inverse).trace() - log_ratio - 4.0);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_spatial::{MassProperties, Matrix3, Vector3};

    fn ten(parameters: &InertialParameters) -> TenParameters {
        TenParameters {
            value: parameters.to_array(),
            gradient: (0..10)
                .map(|i| (0..10).map(|k| f64::from(u8::from(i == k))).collect())
                .collect(),
        }
    }

    fn body(scale: f64) -> InertialParameters {
        MassProperties {
            mass: 12.0 * scale,
            p_BoBcm_B: Vector3::new(0.1, -0.2, 0.3),
            I_BBcm_B: Matrix3::from_diagonal(&Vector3::new(1.0, 1.3, 0.7)) * scale,
        }
        .parameters()
    }

    #[test]
    fn exact_entropic_prior_of_a_scaled_body() {
        // d((1 + e) J0, J0) = 4 (e - log(1 + e)): by hand from the definition.
        let mut rows = PriorRows::default();
        entropic(&mut rows, &ten(&body(1.1)), &body(1.0), 0.1).unwrap();
        let expected = 4.0 * (0.1 - 1.1_f64.ln()) / (2.0 * 0.01);
        assert!((rows.chi2 - expected).abs() < 1e-10);
    }

    #[test]
    fn prop_entropic_rows_are_half_the_slope_of_chi2() {
        let mut x = body(1.0).to_array();
        x[0] += 1.0;
        x[4] += 0.3;
        x[5] -= 0.1;
        let at = |x: &[f64; 10]| {
            let mut rows = PriorRows::default();
            entropic(
                &mut rows,
                &ten(&InertialParameters::from_array(x)),
                &body(1.0),
                0.2,
            )
            .unwrap();
            rows
        };
        let rows = at(&x);
        for k in 0..10 {
            let from_rows: f64 = rows.rows.iter().map(|r| -r.gradient[k] * r.residual).sum();
            let mut ends = [x, x];
            ends[0][k] += 1e-5;
            ends[1][k] -= 1e-5;
            let slope = (at(&ends[0]).chi2 - at(&ends[1]).chi2) / 2e-5;
            assert!(
                (2.0 * from_rows - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                "{k}"
            );
        }
    }
}
