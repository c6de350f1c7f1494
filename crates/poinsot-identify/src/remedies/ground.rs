//! What the experiment determines already, and what one more record or number adds to it.

use super::{Change, Effort, Row, percent};
use crate::fit::experiment::Experiment;
use crate::fit::triangle::Shared;
use crate::likelihood::{Head, Sight};
use crate::problem::Problem;
use crate::problem::parameters::{Equations, Parameters, UnknownKind};
use crate::problem::quantity::TenParameters;
use crate::solution::estimate::OpenCombination;
use crate::solution::solved::Solved;
use poinsot_model::EstimateSet;
use poinsot_solve::{BlockQr, Spectrum};

/// Accuracy of a number that is given, natural units.
const GIVEN: f64 = 1.0e-3;

/// What the experiment tells already, in barycentric unknowns.
pub(super) struct Ground<'a> {
    pub problem: &'a Problem<'a>,
    pub parameters: Parameters,
    pub x: Vec<f64>,
    rows: Vec<Row>,
    mass: usize,
    pub head: Head,
    pub sight: Sight,
    pub wheels_smooth: bool,
    pub spin: Vec<f64>,
}

impl<'a> Ground<'a> {
    pub fn new(problem: &'a Problem<'a>, solved: &Solved) -> Option<Self> {
        let own = &solved.parameters;
        let rotation = own.equations == Equations::Rotation;
        let parameters = if rotation {
            Parameters::new(problem.model, problem.tree, Equations::Momentum, true).ok()?
        } else {
            own.clone()
        };
        let x = match rotation {
            true => crate::problem::parameters::lifted_vector(own, &solved.x, &parameters),
            false => solved.x.clone(),
        };
        let mass = parameters
            .unknowns
            .iter()
            .filter(|u| !u.kind.is_nuisance())
            .count();
        let experiment = Experiment::new(problem, own);
        let head = solved.point(&experiment).heads.first().copied()?;
        Some(Self {
            rows: known_rows(solved, &parameters, &x),
            spin: experiment.nominal_spin.clone(),
            sight: experiment.sight,
            wheels_smooth: solved.wheels_smooth,
            problem,
            parameters,
            x,
            mass,
            head,
        })
    }

    /// An open direction as a unit vector in natural units.
    pub fn direction(&self, open: &OpenCombination) -> Vec<f64> {
        let mut z = vec![0.0; self.mass];
        for (name, coefficient) in &open.coefficients {
            let at = |name: &str| {
                let unknowns = self.parameters.unknowns[..self.mass].iter();
                unknowns.clone().position(|u| u.name == name)
            };
            // About the mass centre and about the origin a tensor changes alike, the mass centre held.
            let found = at(name).or_else(|| at(&name.replace("I_BBcm", "I_BBo")));
            if let Some(u) = found {
                z[u] += coefficient / self.parameters.unknowns[u].natural;
            }
        }
        let length = z.iter().map(|x| x * x).sum::<f64>().sqrt();
        z.iter()
            .map(|x| x / length.max(f64::MIN_POSITIVE))
            .collect()
    }

    pub fn spectrum(&self, more: &[&Row]) -> Option<Spectrum> {
        let n = self.parameters.len();
        let mut stacked = BlockQr::new(n + 1);
        let all: Vec<&Row> = self.rows.iter().chain(more.iter().copied()).collect();
        stacked.push(all.len(), |i, j| all[i].get(j).copied().unwrap_or(0.0));
        let triangle = stacked.finish();
        let natural: Vec<f64> = self.parameters.unknowns[..self.mass]
            .iter()
            .map(|u| u.natural)
            .collect();
        let size = (0..self.mass)
            .map(|j| {
                let square: f64 = (0..=j).map(|i| triangle.r[(i, j)].powi(2)).sum();
                square.sqrt() * natural[j]
            })
            .fold(0.0, f64::max);
        let shared = Shared::new(&self.parameters, &triangle);
        Spectrum::new(
            &shared.block(),
            &natural,
            &vec![0.0; self.mass * self.mass],
            size,
            self.problem.relative_accuracy,
        )
        .ok()
    }

    pub fn changes(&self) -> Vec<Change> {
        let mut list = self.records().unwrap_or_default();
        for (body, set) in self.parameters.estimate.iter().enumerate() {
            list.extend(self.given(body, *set));
        }
        list
    }

    /// Mass, mass centre or inertia of a body, given.
    fn given(&self, body: usize, set: EstimateSet) -> Vec<Change> {
        let ten = TenParameters::of_body(&self.parameters, body, &self.x);
        let (m, l) = self.parameters.natural[body];
        let name = &self.parameters.body_names[body];
        let row = |gradient: Vec<f64>, sigma: f64| -> Row {
            gradient.iter().map(|g| g / sigma).collect()
        };
        let mut list = Vec::new();
        let mut add = |what: &str, rows: Vec<Row>| {
            list.push(Change {
                text: format!("give {what} of {name} (sigma {})", percent(GIVEN)),
                effort: Effort::Number,
                rows,
            });
        };
        if set.mass {
            add("the mass", vec![row(ten.parameter(0).gradient, GIVEN * m)]);
        }
        if set.com {
            let rows = (0..3).map(|k| row(ten.mass_centre(k).gradient, GIVEN * l));
            add("the mass centre", rows.collect());
        }
        if set.inertia {
            let rows = (0..6).map(|k| row(ten.central_inertia(k).gradient, GIVEN * m * l * l));
            add("the inertia", rows.collect());
        }
        list
    }
}

/// The rows of a solved problem over the unknowns given, barycentric for those of a rotation alone.
fn known_rows(solved: &Solved, parameters: &Parameters, x: &[f64]) -> Vec<Row> {
    let own = &solved.parameters;
    let n = own.len();
    let (front, back): (Vec<usize>, Vec<usize>) =
        (0..n).partition(|k| own.unknowns[*k].kind.is_nuisance());
    let order: Vec<usize> = front.into_iter().chain(back).collect();
    // Gradient of each of the own unknowns over those wanted.
    let ten = TenParameters::of_body(parameters, 0, x);
    let width = parameters.len();
    let gradients: Vec<Vec<f64>> = own
        .unknowns
        .iter()
        .map(|u| match u.kind {
            UnknownKind::CentralInertia(k) => ten.central_inertia(k).gradient,
            UnknownKind::MassCentre(k) => ten.mass_centre(k).gradient,
            _ => {
                let at = parameters.unknowns.iter().position(|p| p.name == u.name);
                let mut unit = vec![0.0; width];
                if let Some(at) = at {
                    unit[at] = 1.0;
                }
                unit
            }
        })
        .collect();
    let r = &solved.shared.r;
    (0..n)
        .map(|i| {
            let mut row = vec![0.0; width];
            for (column, unknown) in order.iter().enumerate().skip(i) {
                let value = r[(i, column)];
                for (sum, g) in row.iter_mut().zip(&gradients[*unknown]) {
                    *sum += value * g;
                }
            }
            row
        })
        .collect()
}
