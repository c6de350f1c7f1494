//! What the experiment determines already, and the information of one more record or number.

use super::{Action, Change, Effort, GIVEN, Row};
use crate::fit::experiment::Experiment;
use crate::fit::triangle::SharedTriangle;
use crate::likelihood::InitialState;
use crate::problem::Problem;
use crate::problem::alternative::BetweenSamples;
use crate::problem::parameters::{Equations, Parameters, UnknownKind, axis_name, tensor_name};
use crate::problem::quantity::{Quantity, TenParameters};
use crate::solution::estimate::UnobservableCombination;
use crate::solution::solved::{OfLikelihood, Solution};
use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;
use nalgebra::DMatrix;
use poinsot_model::EstimateSet;
use poinsot_solve::{BlockQr, Spectrum, Triangle};

/// Information of the experiment, in barycentric unknowns.
pub(super) struct Baseline<'a> {
    pub problem: &'a Problem<'a>,
    pub parameters: Parameters,
    pub x: Vec<f64>,
    /// Over the coordinates, as those of the changes.
    rows: Vec<Row>,
    coordinates: Coordinates,
    pub initial_state: InitialState,
    pub sees_translation: bool,
    pub wheels: BetweenSamples,
}

impl<'a> Baseline<'a> {
    pub fn new(
        problem: &'a Problem<'a>,
        (solution, likelihood): (&Solution, &OfLikelihood),
    ) -> Option<Self> {
        let own = &solution.parameters;
        let rotation = own.equations == Equations::Rotation;
        let parameters = if rotation {
            Parameters::new(problem.model, problem.tree, Equations::Momentum, true).ok()?
        } else {
            own.clone()
        };
        let x = match rotation {
            true => crate::problem::parameters::lifted_vector(own, &solution.x, &parameters),
            false => solution.x.clone(),
        };
        let coordinates = match rotation {
            true => Coordinates::central(&parameters, &x)?,
            false => Coordinates::own(&parameters),
        };
        let experiment = Experiment::new(problem, own);
        let initial_state = solution
            .point(&experiment)
            .initial_states
            .first()
            .copied()?;
        let rows = known_rows(solution, &parameters, &x);
        Some(Self {
            rows: rows.iter().map(|row| coordinates.of_row(row)).collect(),
            sees_translation: experiment.sees_translation,
            wheels: likelihood.wheels,
            problem,
            parameters,
            x,
            coordinates,
            initial_state,
        })
    }

    /// An unobservable direction as a unit vector in natural units.
    pub fn direction(&self, open: &UnobservableCombination) -> Vec<f64> {
        let own = &self.coordinates;
        let mut z = vec![0.0; own.names.len()];
        for (name, coefficient) in &open.coefficients {
            if let Some(u) = own.names.iter().position(|own| own == name) {
                z[u] += coefficient / own.natural[u];
            }
        }
        let length = z.iter().map(|x| x * x).sum::<f64>().sqrt();
        z.iter()
            .map(|x| x / length.max(f64::MIN_POSITIVE))
            .collect()
    }

    /// The spectrum of the experiment with more rows.
    pub fn spectrum(&self, more: &[&Row]) -> Option<Spectrum> {
        let stacked = self.stacked(&self.rows, more);
        let block = SharedTriangle::new(&self.parameters, &stacked).block();
        let (natural, size) = (&self.coordinates.natural, self.longest(&stacked));
        Spectrum::new(&block, natural, None, size, self.problem.largest_sigma()).ok()
    }

    /// The information of the experiment with more rows, in as few rows as there are unknowns.
    pub fn condensed(&self, more: &[&Row]) -> Vec<Row> {
        let r = self.stacked(&self.rows, more).r;
        let row = |i: usize| (0..r.ncols()).map(|j| r[(i, j)]).collect();
        (0..r.nrows()).map(row).collect()
    }

    /// Number of directions that condensed rows identify together with more.
    pub fn rank(&self, condensed: &[Row], more: &[Row]) -> usize {
        let more: Vec<&Row> = more.iter().collect();
        let stacked = self.stacked(condensed, &more);
        let block = SharedTriangle::new(&self.parameters, &stacked).block();
        let (natural, size) = (&self.coordinates.natural, self.longest(&stacked));
        Spectrum::rank_of(&block, natural, size, self.problem.largest_sigma()).unwrap_or(0)
    }

    /// Triangle of rows.
    fn stacked(&self, rows: &[Row], more: &[&Row]) -> Triangle {
        let all: Vec<&Row> = rows.iter().chain(more.iter().copied()).collect();
        let mut stacked = BlockQr::new(self.parameters.len() + 1);
        stacked.push(all.len(), |i, j| all[i].get(j).copied().unwrap_or(0.0));
        stacked.finish()
    }

    /// Length of the longest column of the mass properties, natural units.
    fn longest(&self, triangle: &Triangle) -> f64 {
        let natural = self.coordinates.natural.iter().enumerate();
        let length = |(j, unit): (usize, &f64)| {
            let square: f64 = (0..=j).map(|i| triangle.r[(i, j)].powi(2)).sum();
            square.sqrt() * unit
        };
        natural.map(length).fold(0.0, f64::max)
    }

    pub fn changes(&self) -> Vec<Change> {
        let mut list = self.records().unwrap_or_default();
        for (body, set) in self.parameters.estimate.iter().enumerate() {
            list.extend(self.given(body, *set));
        }
        for row in list.iter_mut().flat_map(|change| &mut change.rows) {
            *row = self.coordinates.of_row(row);
        }
        list
    }

    /// Mass, mass centre or inertia of a body, given.
    fn given(&self, body: usize, set: EstimateSet) -> Vec<Change> {
        let ten = TenParameters::of_body(&self.parameters, body, &self.x);
        let (m, l) = self.parameters.natural[body];
        let name = &self.parameters.body_names[body];
        let groups = [
            ("mass", 0..1, m),
            ("mass centre", 1..4, l),
            ("inertia", 4..10, m * l * l),
        ];
        let asked = groups
            .into_iter()
            .filter(|(_, numbers, _)| set.has(numbers.start));
        let given = asked.map(|(what, numbers, unit)| {
            let slope = |k: usize| ten.mass_property(k).gradient.into_iter();
            let rows = numbers.map(|k| slope(k).map(|g| g / (GIVEN * unit)).collect());
            Change {
                action: Action::Number(what, name.clone()),
                effort: Effort::Number,
                rows: rows.collect(),
            }
        });
        given.collect()
    }
}

/// Coordinates of a direction: the others are constant while one of them changes.
struct Coordinates {
    names: Vec<String>,
    natural: Vec<f64>,
    /// Change of each unknown mass property per unit of each coordinate; none where they are the same. Further unknowns are their own.
    slopes: Option<Mat<f64>>,
}

impl Coordinates {
    /// The unknowns that are no nuisances, themselves.
    fn own(parameters: &Parameters) -> Self {
        let unknowns = &parameters.unknowns[..parameters.decided_by_steps()];
        Self {
            names: unknowns.iter().map(|u| u.name.clone()).collect(),
            natural: unknowns.iter().map(|u| u.natural).collect(),
            slopes: None,
        }
    }

    /// Mass, mass centre and inertia about it of the one body of which only the rotation is seen.
    fn central(parameters: &Parameters, x: &[f64]) -> Option<Self> {
        let ten = TenParameters::of_body(parameters, 0, x);
        let (set, (m, l)) = (parameters.estimate[0], parameters.natural[0]);
        let name = &parameters.body_names[0];
        let all = (0..10).filter(|k| set.has(*k)).map(|k| {
            let (number, unit) = match k {
                0 => ("m".to_owned(), m),
                1..=3 => (format!("com_{}", axis_name(k - 1)), l),
                _ => (format!("I_BBcm_{}", tensor_name(k - 4)), m * l * l),
            };
            (format!("{name}.{number}"), unit, ten.mass_property(k))
        });
        let all: Vec<(String, f64, Quantity)> = all.collect();
        let n = parameters.mass_unknowns;
        let square = all.len() == n;
        let gradients = Mat::from_fn(all.len(), n, |i, j| all[i].2.gradient[j]);
        let others = parameters.unknowns[n..parameters.decided_by_steps()].iter();
        let numbers = all.into_iter().map(|(name, unit, _)| (name, unit));
        let numbers = numbers.chain(others.map(|u| (u.name.clone(), u.natural)));
        let (names, natural) = numbers.unzip();
        square.then(|| Self {
            slopes: Some(gradients.partial_piv_lu().inverse()),
            natural,
            names,
        })
    }

    /// A row over the unknowns as one over these numbers.
    fn of_row(&self, row: &Row) -> Row {
        let Some(slopes) = &self.slopes else {
            return row.clone();
        };
        let n = slopes.nrows();
        let own = (0..n).map(|j| (0..n).map(|i| row[i] * slopes[(i, j)]).sum());
        own.chain(row[n..].iter().copied()).collect()
    }
}

/// The rows of a solved problem over the unknowns given, barycentric for those of a rotation alone.
fn known_rows(solution: &Solution, parameters: &Parameters, x: &[f64]) -> Vec<Row> {
    let own = &solution.parameters;
    let n = own.len();
    let (front, back): (Vec<usize>, Vec<usize>) =
        (0..n).partition(|k| own.unknowns[*k].kind.is_nuisance());
    let order: Vec<usize> = front.into_iter().chain(back).collect();
    // Gradient of each of the own unknowns over those wanted, in the order of the triangle.
    let ten = TenParameters::of_body(parameters, 0, x);
    let width = parameters.len();
    let gradient = |k: &usize| match &own.unknowns[*k].kind {
        UnknownKind::CentralInertia(k) => ten.central_inertia(*k).gradient,
        UnknownKind::MassCentre(k) => ten.mass_centre(*k).gradient,
        kind => {
            let at = parameters.place(kind);
            (0..width)
                .map(|i| f64::from(u8::from(Some(i) == at)))
                .collect()
        }
    };
    let gradients: Vec<Row> = order.iter().map(gradient).collect();
    let gradients = DMatrix::from_fn(n, width, |i, j| gradients[i][j]);
    let r = DMatrix::from_fn(n, n, |i, j| solution.shared.r[(i, j)]);
    let rows = r.upper_triangle() * gradients;
    let rows = rows.row_iter().map(|row| row.iter().copied().collect());
    rows.collect()
}
