//! What a filter knows before its first sample: the unknown numbers of its body, and what is known with a sigma.

use super::{Rigid, TenByTen, on_base, slopes};
use crate::error::{Error, unsupported};
use crate::mass_numbers::names;
use crate::posterior::posterior;
use nalgebra::{DMatrix, DVector};
use poinsot_dynamics::SensorKind;
use poinsot_formats::{EstimateFile, address};
use poinsot_model::{Body, KnownNumber, Model, Posterior, Uncertain, across};
use poinsot_onboard::{Configuration, MOUNTING, of_wheel};
use poinsot_spatial::MassProperties;

/// Prior sigma of a body without a declared one, relative to its natural units.
const PRIOR: f64 = 0.2;
/// Sigma in natural units of what is known beside something unknown: mass and mass centre have one parameter in common.
const KNOWN: f64 = 1.0e-6;

/// A component of a known number that the filter has a place for.
struct Known {
    place: usize,
    number: KnownNumber,
    component: usize,
    sigma: f64,
    /// Among the known numbers of an answer, with its estimate less the value of the model.
    told: Option<usize>,
    shift: f64,
}

/// What a prior follows from.
pub struct Prior<'a> {
    pub model: &'a Model,
    pub rigid: &'a Rigid,
    pub body: &'a Body,
    pub nominal: &'a MassProperties,
    pub answer: Option<&'a EstimateFile>,
}

impl Prior<'_> {
    /// Sets what is uncertain and the square root of its information: `R` with `R^T R` the inverse of the covariance. What is assumed is
    /// added to the list.
    pub fn set(
        &self,
        configuration: &mut Configuration,
        assumed: &mut Vec<String>,
    ) -> Result<(), Error> {
        let told = self.answer.map(|answer| posterior(self.model, answer));
        let told = &told.unwrap_or_default();
        let known = self.known_numbers(told, assumed);
        let n = known.len();
        let units = self.filter_over_model(configuration, &known);
        let covariance = self.covariance(told, &known, assumed);
        let of_known = &units * self.covariance_of_known(&known, told) * units.transpose();
        let addresses = names(&self.body.name).map(|address| told.place(&address));
        let slope = |k: usize, j: usize| Some(told.known[known[j].told?].slopes[addresses[k]?]);
        let over_model = DMatrix::from_fn(10, n, |k, j| slope(k, j).unwrap_or(0.0));
        let shifts = &units * DVector::from_iterator(n, known.iter().map(|k| k.shift));
        // R (numbers - nominal) is white with R = L^-1 S^-1, the numbers of the body less what known ones do to them; those of the body
        // that are known come first and drop out of the triangle.
        let factors = || {
            let own = covariance.cholesky()?.l().try_inverse()?;
            let root = of_known.cholesky()?.l().try_inverse()?;
            let mut rows = DMatrix::zeros(10 + n, 10 + n);
            let own = own * slopes(self.nominal);
            rows.view_mut((0, 0), (10, 10)).copy_from(&own);
            let of_body = -(own * over_model * units.try_inverse()?);
            rows.view_mut((0, 10), (10, n)).copy_from(&of_body);
            rows.view_mut((10, 10), (n, n)).copy_from(&root);
            Some(rows.qr().r())
        };
        let refused = "the covariance of the prior is not positive definite";
        let advice = "identify again, or use the model alone";
        let R = factors().ok_or_else(|| unsupported(refused, advice))?;
        // All ten where the mass centre moves: the inertia about the origin moves with it.
        let estimate = self.body.estimate;
        let first = if estimate.mass || estimate.com { 0 } else { 4 };
        configuration.uncertain[first..10].fill(true);
        for (known, shift) in known.iter().zip(&shifts) {
            configuration.uncertain[known.place] = true;
            configuration.nominal[known.place] = *shift;
        }
        for i in first..10 + n {
            for j in i..10 + n {
                configuration.prior[(i - first, j - first)] = R[(i, j)] * R[(i, i)].signum();
            }
        }
        Ok(())
    }

    /// What is known with a sigma and has a place in the filter, in the order of these.
    fn known_numbers(&self, told: &Posterior, assumed: &mut Vec<String>) -> Vec<Known> {
        let model = self.model;
        let attitude = on_base(model, SensorKind::Attitude).map(|s| &s.name);
        // Mass and mass centre of a body that turns about it do not show.
        let alone = model.bodies.len() == 1
            && model.thrusters.is_empty()
            && model.sensors_of(SensorKind::Position).next().is_none();
        let (mut out, mut exact) = (Vec::new(), Vec::new());
        for &Uncertain { number, sigma } in model.uncertain() {
            let first = match number {
                KnownNumber::SpinInertia(k) => of_wheel(k),
                KnownNumber::WheelAxis(k) => of_wheel(k) + 1,
                KnownNumber::Mounting(k) if Some(&model.sensors[k].name) == attitude => MOUNTING,
                KnownNumber::Mass(_) | KnownNumber::MassCentre(_) if alone => continue,
                _ => {
                    let name = number.name(model, 0);
                    let component = name.rsplit_once('_').filter(|_| number.components() > 1);
                    exact.push(component.map_or(name.clone(), |(of, _)| of.to_owned()));
                    continue;
                }
            };
            for component in 0..number.components() {
                let at = address(&number.name(model, component), number.unit());
                let mut found = self
                    .answer
                    .iter()
                    .flat_map(|a| &a.known_numbers.sensitivities);
                let found = found.find(|s| s.number == at);
                out.push(Known {
                    place: first + component,
                    number,
                    component,
                    sigma: number.absolute(model, component, sigma),
                    told: told.known.iter().position(|k| k.address == at),
                    shift: found.map_or(0.0, |s| s.estimate.unwrap_or(s.value) - s.value),
                });
            }
        }
        if !exact.is_empty() {
            let exact = exact.join(", ");
            assumed.push(format!(
                "assumed: exact here, where identify adds its uncertainty to sigma: {exact}"
            ));
        }
        out.sort_by_key(|known| known.place);
        out
    }

    /// Covariance of known numbers: that of an answer, or the declared one.
    fn covariance_of_known(&self, known: &[Known], told: &Posterior) -> DMatrix<f64> {
        let spin = |k: &Known| match k.number {
            KnownNumber::SpinInertia(wheel) => Some(self.model.wheels[wheel].spin_inertia),
            _ => None,
        };
        DMatrix::from_fn(known.len(), known.len(), |i, j| {
            let (one, other) = (&known[i], &known[j]);
            match (one.told, other.told) {
                (Some(a), Some(b)) => told.known_covariance[a][b],
                _ if i == j => one.sigma * one.sigma,
                (None, None) if spin(one).is_some() && spin(one) == spin(other) => {
                    self.model.knowledge.correlation(one.number) * one.sigma * other.sigma
                }
                _ => 0.0,
            }
        })
    }

    /// The filter's numbers over those of the model: a spin inertia is relative, an axis tilts about directions of its own.
    fn filter_over_model(&self, configuration: &Configuration, known: &[Known]) -> DMatrix<f64> {
        DMatrix::from_fn(known.len(), known.len(), |i, j| {
            let (own, of) = (&known[i], &known[j]);
            match own.number {
                KnownNumber::SpinInertia(k) if i == j => 1.0 / self.model.wheels[k].spin_inertia,
                KnownNumber::WheelAxis(k) if own.number == of.number => {
                    let wheel = &self.model.wheels[k];
                    let about = across(&wheel.axis_B)[of.component];
                    let about = self.rigid.kinematics.R[wheel.body] * about;
                    configuration.wheels[k].across()[own.component].dot(&about)
                }
                _ => f64::from(u8::from(i == j)),
            }
        })
    }

    /// Covariance of mass, mass centre and central inertia where the known numbers that the filter has are given: the declared prior,
    /// replaced by that of an answer where it has one.
    fn covariance(&self, told: &Posterior, known: &[Known], assumed: &mut Vec<String>) -> TenByTen {
        let (body, units) = (self.body, self.nominal.natural_units());
        let groups = [(0..1, "mass"), (1..4, "mass centre"), (4..10, "inertia")];
        let mut out = TenByTen::zeros();
        for (range, name) in groups {
            let unknown = body.estimate.has(range.start);
            let declared = body.prior.and_then(|p| p.sigma(range.start));
            if unknown && declared.is_none() && self.answer.is_none() {
                let of = &body.name;
                assumed.push(format!(
                    "assumed: sigma of the nominal {name} of '{of}' is {PRIOR} in natural units; declare [body.prior]"
                ));
            }
            for k in range {
                let usual = if unknown { PRIOR } else { KNOWN } * units[k];
                let sigma = declared.filter(|_| unknown).unwrap_or(usual);
                out[(k, k)] = sigma * sigma;
            }
        }
        let mut rest = told.clone();
        for known in known.iter().filter_map(|k| k.told) {
            rest.known[known].slopes.fill(0.0);
        }
        let addresses = names(&body.name).map(|address| told.place(&address));
        for (i, one) in addresses.iter().enumerate() {
            for (j, other) in addresses.iter().enumerate() {
                if let Some((one, other)) = one.zip(*other) {
                    out[(i, j)] = rest.between(one, other);
                }
            }
        }
        out
    }
}
