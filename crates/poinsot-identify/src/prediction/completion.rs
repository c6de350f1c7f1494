//! A vehicle that moves as estimated although some numbers are undetermined.
//!
//! The data determine combinations of the parameters, and motion under any forces depends on these alone if the data
//! are sensitive to all of them. So any parameters with the determined combinations predict the same; here those
//! nearest to the nominal ones in natural units:
//!
//! ```text
//! min |D^-1 (x - x_nominal)|   with   C x = values of the determined combinations
//! ```
//!
//! They are no estimate of single numbers and need not be physical. The caller tests whether the prediction depends on
//! the rest: [`Completion::open`] spans it.

use crate::certify::combination::{Combination, split};
use crate::problem::parameters::{Equations, Parameters, UnknownKind};
use crate::solution::estimate::DeterminedCombination;
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use poinsot_dynamics::Tree;
use poinsot_files::{Faults, Place};
use poinsot_model::Model;
use poinsot_spatial::InertialParameters;

/// Smallest independent part of a combination, relative to its length.
const DEPENDENT: f64 = 1.0e-10;

/// E0701: the estimate gives no vehicle to simulate.
fn refused(problem: impl std::fmt::Display, advice: &str) -> Faults {
    let problem = format!("this estimate cannot be simulated: {problem}");
    Faults::one("E0701", Place::label("estimate"), problem, advice)
}

fn dependent() -> Faults {
    refused(
        "its determined combinations are inconsistent with each other: the file was changed",
        "write it again with identify",
    )
}

/// Parameters that predict what the estimate determines.
#[derive(Debug, Clone)]
pub struct Completion {
    parameters: Parameters,
    /// Values of the unknowns, in the order of the parameters.
    pub x: Vec<f64>,
    /// How far they lie from the nominal ones, natural units (1: 100 %), root of the sum of squares.
    pub distance: f64,
    /// A basis of the undetermined directions, each with one unique parameter; coefficients in the parameters' units.
    pub open: Vec<Combination>,
}

/// The bodies, wheels and thrusters of a vehicle at one value of the unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct CompletedVehicle {
    /// Barycentric parameters, one per body.
    pub bodies: Vec<InertialParameters>,
    /// Spin inertia of wheels that were unknown: index and value, kg m2.
    pub spin_inertia: Vec<(usize, f64)>,
    /// Factor of the force of thrusters whose scale was unknown: index and factor.
    pub thrust_factor: Vec<(usize, f64)>,
}

/// Completes the determined combinations of an estimate with the nominal numbers of its model. `rank` directions are
/// determined.
///
/// # Errors
/// The combinations do not belong to this model, or are not all that is determined.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let estimate = linear(&problem)?;
/// let (determined, rank) = (&estimate.identifiability.determined, estimate.identifiability.rank);
/// let completion = complete(&model, &tree, determined, rank)?;
/// // What the data do not show keeps its nominal number.
/// assert_eq!(completion.vehicle().bodies.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn complete(
    model: &Model,
    tree: &Tree,
    determined: &[DeterminedCombination],
    rank: usize,
) -> Result<Completion, Faults> {
    let nothing = determined.is_empty();
    let linear = determined.iter().filter(|c| !c.coefficients.is_empty());
    let determined: Vec<&DeterminedCombination> = linear.collect();
    let linear = determined.len();
    if nothing {
        let problem = "it has no determined combination (status rejected, or nothing identified), so it cannot predict";
        return Err(refused(problem, "give an estimate from more data"));
    }
    if linear < rank {
        return Err(refused(
            format_args!(
                "it determines {rank} directions but has only {linear} linear combinations, which do not fix a prediction"
            ),
            "validate against the model instead, or give an estimate with translation measured",
        ));
    }
    // The unknowns of an estimate from rotation alone have other names.
    let equations = [Equations::Momentum, Equations::Rotation];
    let mut unknown = "";
    for parameters in equations.map(|e| Parameters::new(model, tree, e, true)) {
        let Ok(parameters) = parameters else { continue };
        match stranger(&parameters, &determined) {
            Some(name) => unknown = name,
            None => return complete_parameters(&parameters, &determined),
        }
    }
    Err(refused(
        format_args!("it has the parameter '{unknown}', which is not an unknown of this model"),
        "give the model file that the estimate was made with",
    ))
}

/// A parameter of the combinations that the model does not estimate.
fn stranger<'d>(
    parameters: &Parameters,
    determined: &[&'d DeterminedCombination],
) -> Option<&'d str> {
    let known = |name: &str| parameters.unknowns.iter().any(|u| u.name == name);
    let mut names = determined.iter().flat_map(|c| &c.coefficients);
    names
        .find(|(name, _)| !known(name))
        .map(|(name, _)| name.as_str())
}

fn complete_parameters(
    parameters: &Parameters,
    determined: &[&DeterminedCombination],
) -> Result<Completion, Faults> {
    let unknowns = &parameters.unknowns;
    let m = unknowns.iter().filter(|u| !u.kind.is_nuisance()).count();
    let (unknowns, r) = (&unknowns[..m], determined.len());
    let natural: Vec<f64> = unknowns.iter().map(|u| u.natural).collect();
    let nominal = parameters.nominal_vector();
    // Rows of C D, each of length one, and what they lack at the nominal numbers.
    let mut rows = DMatrix::<f64>::zeros(m, r);
    let mut lack = DVector::<f64>::zeros(r);
    for (k, one) in determined.iter().enumerate() {
        let mut value = one.value;
        for (name, coefficient) in &one.coefficients {
            let at = unknowns.iter().position(|u| u.name == *name);
            let at = at.ok_or_else(dependent)?;
            rows[(at, k)] = coefficient * natural[at];
            value -= coefficient * nominal[at];
        }
        let size = rows.column(k).norm();
        if !(size > 0.0 && value.is_finite()) {
            return Err(dependent());
        }
        rows.column_mut(k).scale_mut(1.0 / size);
        lack[k] = value / size;
    }
    if r > m {
        return Err(dependent());
    }
    let qr = rows.qr();
    let triangle = qr.r();
    if (0..r).any(|k| triangle[(k, k)].abs() < DEPENDENT) {
        return Err(dependent());
    }
    let along = triangle
        .tr_solve_upper_triangular(&lack)
        .ok_or_else(dependent)?;
    // The reflections applied to the unit matrix: the transposed basis, its last rows the unobservable directions.
    let mut basis = DMatrix::<f64>::identity(m, m);
    qr.q_tr_mul(&mut basis);
    let step = basis.rows(0, r).tr_mul(&along);
    let mut x = nominal;
    for (x, (z, unit)) in x.iter_mut().zip(step.iter().zip(&natural)) {
        *x += z * unit;
    }
    let open = Mat::from_fn(m, m - r, |i, k| basis[(r + k, i)]);
    Ok(Completion {
        parameters: parameters.clone(),
        x,
        distance: step.norm(),
        open: split(&open, &natural, &vec![1.0; m]).open,
    })
}

impl Completion {
    /// The vehicle as completed.
    pub fn vehicle(&self) -> CompletedVehicle {
        self.at(&self.x)
    }

    /// The vehicle moved along an unobservable direction until its unique parameter has changed by `share` of its
    /// natural unit.
    pub fn moved(&self, direction: &Combination, share: f64) -> CompletedVehicle {
        let mut x = self.x.clone();
        let lead = direction.terms.first();
        let unit = lead.map_or(0.0, |(at, _)| self.parameters.unknowns[*at].natural);
        for (at, coefficient) in &direction.terms {
            x[*at] += share * unit * coefficient;
        }
        self.at(&x)
    }

    /// Name of the unique parameter of an unobservable direction.
    pub fn name(&self, direction: &Combination) -> &str {
        let lead = direction.terms.first();
        lead.map_or("", |(at, _)| self.parameters.unknowns[*at].name.as_str())
    }

    fn at(&self, x: &[f64]) -> CompletedVehicle {
        let mut vehicle = CompletedVehicle {
            bodies: self.parameters.bodies(x),
            spin_inertia: Vec::new(),
            thrust_factor: Vec::new(),
        };
        for (unknown, value) in self.parameters.unknowns.iter().zip(x) {
            match unknown.kind {
                UnknownKind::SpinInertia(k) => vehicle.spin_inertia.push((k, *value)),
                UnknownKind::ThrusterScale(k) => vehicle.thrust_factor.push((k, 1.0 + value)),
                _ => {}
            }
        }
        vehicle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_model::parse_model;

    const MODEL: &str = r#"schema = "poinsot.model/1"
[[body]]
name = "bus"
mass_kg = 10.0
com_m = [0.1, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 2.0 }
estimate = true
"#;

    fn combination(terms: &[(&str, f64)], value: f64) -> DeterminedCombination {
        DeterminedCombination {
            text: String::new(),
            coefficients: terms.iter().map(|(n, c)| (n.to_string(), *c)).collect(),
            unit: "kg",
            value,
            sigma: 0.0,
        }
    }

    #[test]
    fn exact_completion_has_the_combinations_and_moves_nothing_else() {
        let model = parse_model(MODEL, "m.toml").unwrap();
        let tree = Tree::new(&model);
        let given = [
            combination(&[("bus.m", 1.0), ("bus.mc_x", -3.0)], 8.0),
            combination(&[("bus.I_BBo_yy", 1.0)], 1.7),
        ];
        let done = complete(&model, &tree, &given, 2).unwrap();
        let bus = done.vehicle().bodies[0];
        assert!((bus.mass - 3.0 * bus.mc_B.x - 8.0).abs() < 1e-12);
        assert!((bus.I_BBo_B[(1, 1)] - 1.7).abs() < 1e-12);
        // Parameters in no combination stay nominal to round-off.
        assert!((bus.I_BBo_B[(0, 0)] - 1.0).abs() < 1e-14 && bus.mc_B.y.abs() < 1e-14);
        assert_eq!(done.open.len(), 8);
        for direction in &done.open {
            let bus = done.moved(direction, 0.3).bodies[0];
            let off = (bus.mass - 3.0 * bus.mc_B.x - 8.0).abs();
            assert!(off < 1e-12, "{}: {off:e}", done.name(direction));
            assert!((bus.I_BBo_B[(1, 1)] - 1.7).abs() < 1e-12);
        }
    }

    #[test]
    fn unit_combinations_of_another_model_are_refused() {
        let model = parse_model(MODEL, "m.toml").unwrap();
        let tree = Tree::new(&model);
        let refusal = |given: &[DeterminedCombination]| {
            let faults = complete(&model, &tree, given, given.len()).unwrap_err();
            (faults.code(), faults.to_string())
        };
        let refused = |given: &[DeterminedCombination], words: &str| {
            let (code, said) = refusal(given);
            assert!(code == "E0701" && said.contains(words), "{said}");
        };
        refused(&[combination(&[("arm.m", 1.0)], 1.0)], "'arm.m'");
        refused(&[], "no determined combination");
        let one = combination(&[("bus.m", 1.0)], 9.0);
        let same = combination(&[("bus.m", 2.0)], 18.1);
        refused(&[one, same], "inconsistent with each other");
    }
}
