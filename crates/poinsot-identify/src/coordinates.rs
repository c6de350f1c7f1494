//! Steps that keep every unknown body physical.
//!
//! Answer, covariance and identifiability are stated in the ten linear parameters of each body; only the *steps* of
//! the fit are taken in other coordinates. A step that leaves every body inside what positive mass can have is taken
//! as it is; one that would not goes nine tenths of the way to the edge, where that is worth it. Close to the edge
//! steps are taken in log-Cholesky coordinates (Rucker and Wensing 2022), in which none leaves: the coordinate
//! that is pressed against the edge falls and loses its weight, and the others settle as if it stood still. Far
//! from the edge the logarithms would only bend a problem that is straight.

use crate::loss::Loss;
use crate::parameters::{Equations, Parameters, TENSOR, UnknownKind, rotation_properties};
use crate::spectrum::Spectrum;
use faer::Mat;
use nalgebra::SymmetricEigen;
use poinsot_model::EstimateSet;
use poinsot_spatial::{InertialParameters, LogCholesky, Vector3, pseudo_inertia};

/// In which coordinates the fit steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coordinates {
    /// Linear, with log-Cholesky wherever a step would leave the physical bodies: the answer is always one.
    #[default]
    LogCholesky,
    /// Linear throughout: an impossible tensor is possible.
    Linear,
}

impl Coordinates {
    /// Names for the command line.
    pub const NAMES: [&'static str; 2] = ["log-cholesky", "linear"];

    /// By its name.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "log-cholesky" => Some(Self::LogCholesky),
            "linear" => Some(Self::Linear),
            _ => None,
        }
    }
}

/// How a maximum-likelihood fit is done.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitOptions {
    /// Loss of a reading.
    pub loss: Loss,
    /// Coordinates of the steps.
    pub coordinates: Coordinates,
    /// Leaves out the look for what would explain a misfit. It changes no number, only the verdict.
    pub undiagnosed: bool,
}

impl From<Loss> for FitOptions {
    fn from(loss: Loss) -> Self {
        Self {
            loss,
            ..Self::default()
        }
    }
}

/// Smallest eigenvalue of the new pseudo-inertia over the present one that is inside.
const INSIDE: f64 = 1.0e-3;
/// The same over the nominal one for a start.
const START: f64 = 0.05;
/// Part of a plain step to the edge that is worth taking.
pub(crate) const WORTH: f64 = 0.2;
/// Longest step of a logarithm.
const LONGEST: f64 = 1.5;
/// Smallest principal second moment, over mass times squared radius of gyration, that is not at the edge.
const EDGE: f64 = 1.0e-6;
/// The same at which a logarithm falls no further.
const FLOOR: f64 = 1.0e-10;

/// One unknown body in free coordinates.
struct Body {
    theta: LogCholesky,
    /// Free coordinates of `theta`, none for a body of which the mass alone is unknown.
    free: Vec<usize>,
    /// Unknowns that belong to it, with the function of the parameters that each is.
    unknowns: Vec<(usize, Element)>,
}

/// What an unknown is of the ten parameters of its body.
#[derive(Clone, Copy)]
enum Element {
    /// Parameter k about the origin.
    Origin(usize),
    /// Element e of the tensor about the mass centre.
    Central(usize),
}

impl Element {
    fn of(self, body: &InertialParameters) -> f64 {
        match self {
            Self::Origin(k) => body.to_array()[k],
            Self::Central(e) => body
                .mass_properties()
                .map_or(f64::NAN, |p| p.I_BBcm_B[TENSOR[e]]),
        }
    }
}

/// Free coordinates of all unknown bodies at one value of the unknowns.
pub(crate) struct Chart {
    bodies: Vec<Body>,
    /// Unknowns outside of any body: steps as they are, in natural units.
    others: Vec<usize>,
    /// Coordinates over all: those of each body in turn, then the others.
    width: usize,
}

impl Chart {
    /// `None` where no unknown body is physical: then there is nothing to keep.
    pub fn new(parameters: &Parameters, mass_unknowns: usize, x: &[f64]) -> Option<Self> {
        let all = bodies_at(parameters, x);
        let mut bodies = Vec::new();
        let mut others: Vec<usize> = (0..mass_unknowns).collect();
        for (index, set) in parameters.estimate.iter().enumerate() {
            let unknowns = unknowns_of(parameters, mass_unknowns, index);
            if unknowns.is_empty() {
                continue;
            }
            // A body that is none to begin with cannot be kept one.
            let Some(theta) = LogCholesky::from_parameters(&all[index]) else {
                continue;
            };
            others.retain(|u| unknowns.iter().all(|(own, _)| own != u));
            bodies.push(Body {
                theta,
                free: free(parameters.equations, *set),
                unknowns,
            });
        }
        let own: usize = bodies.iter().map(Body::width).sum();
        (!bodies.is_empty()).then(|| Self {
            width: own + others.len(),
            bodies,
            others,
        })
    }

    /// Slope of the mass unknowns over the coordinates, in natural units.
    fn slope(&self, natural: &[f64], x: &[f64]) -> Mat<f64> {
        let mut out = Mat::zeros(natural.len(), self.width);
        let mut at = 0;
        for body in &self.bodies {
            body.fill_slope(&mut out, at, natural, x);
            at += body.width();
        }
        for (k, u) in self.others.iter().enumerate() {
            out[(*u, at + k)] = 1.0;
        }
        out
    }

    /// The change of the mass unknowns, natural units, for a step of the coordinates.
    pub fn retract(&self, step: &[f64], natural: &[f64], x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; natural.len()];
        let mut at = 0;
        for body in &self.bodies {
            let moved = body.moved(&step[at..at + body.width()], x);
            for (u, value) in moved {
                out[u] = (value - x[u]) / natural[u];
            }
            at += body.width();
        }
        for (k, u) in self.others.iter().enumerate() {
            out[*u] = step[at + k];
        }
        out
    }
}

impl Body {
    fn width(&self) -> usize {
        self.free.len().max(1)
    }

    fn fill_slope(&self, out: &mut Mat<f64>, at: usize, natural: &[f64], x: &[f64]) {
        if self.free.is_empty() {
            // The mass alone: its logarithm.
            for (u, _) in &self.unknowns {
                out[(*u, at)] = x[*u] / natural[*u];
            }
            return;
        }
        let pi = self.theta.parameters();
        let jacobian = self.theta.jacobian();
        for (k, coordinate) in self.free.iter().enumerate() {
            let d = &jacobian[*coordinate];
            for (u, element) in &self.unknowns {
                let slope = match element {
                    Element::Origin(i) => d[*i],
                    Element::Central(e) => central_slope(&pi, d, *e),
                };
                out[(*u, at + k)] = slope / natural[*u];
            }
        }
    }

    /// Values of its unknowns after a step; logarithms move by no more than [`LONGEST`], nor below the floor.
    fn moved(&self, step: &[f64], x: &[f64]) -> Vec<(usize, f64)> {
        if self.free.is_empty() {
            let factor = step[0].clamp(-LONGEST, LONGEST).exp();
            return self
                .unknowns
                .iter()
                .map(|(u, _)| (*u, x[*u] * factor))
                .collect();
        }
        let mut theta = self.theta;
        let largest = theta.theta[1..4]
            .iter()
            .fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let floor = largest + 0.5 * FLOOR.ln();
        for (coordinate, d) in self.free.iter().zip(step) {
            let now = &mut theta.theta[*coordinate];
            match coordinate {
                0 => *now += d.clamp(-LONGEST, LONGEST),
                1..=3 => *now = (*now + d.clamp(-LONGEST, LONGEST)).max(floor.min(*now)),
                _ => *now += d,
            }
        }
        let body = theta.parameters();
        self.unknowns
            .iter()
            .map(|(u, element)| (*u, element.of(&body)))
            .collect()
    }
}

/// Slope of an element of the tensor about the mass centre, `I_Bo - (s.s 1 - s s^T) / m` with the first moment s.
fn central_slope(pi: &InertialParameters, d: &[f64; 10], element: usize) -> f64 {
    let (i, j) = TENSOR[element];
    let (m, s) = (pi.mass, pi.mc_B);
    let (dm, ds) = (d[0], Vector3::new(d[1], d[2], d[3]));
    let unit = f64::from(u8::from(i == j));
    let square = s.norm_squared() * unit - s[i] * s[j];
    let change = 2.0 * s.dot(&ds) * unit - ds[i] * s[j] - s[i] * ds[j];
    d[4 + element] - change / m + dm * square / (m * m)
}

/// Free coordinates of a body for what is unknown of it: alpha with the mass, t with the mass centre, the factor of
/// the second moment with the inertia.
fn free(equations: Equations, set: EstimateSet) -> Vec<usize> {
    let rotation = equations == Equations::Rotation;
    if !set.inertia {
        return Vec::new();
    }
    let mut free: Vec<usize> = Vec::new();
    if set.mass && !rotation {
        free.push(0);
    }
    free.extend(1..7);
    if set.com && !rotation {
        free.extend(7..10);
    }
    free
}

/// The unknowns that make up a body's mass and inertia.
fn unknowns_of(
    parameters: &Parameters,
    mass_unknowns: usize,
    body: usize,
) -> Vec<(usize, Element)> {
    let set = parameters.estimate[body];
    let list = parameters.unknowns[..mass_unknowns].iter().enumerate();
    list.filter_map(|(u, unknown)| match &unknown.kind {
        UnknownKind::Barycentric(parts) => {
            let at = parts.first()?.0;
            let element = match (at % 10).checked_sub(4) {
                Some(e) if !set.com => Element::Central(e),
                _ => Element::Origin(at % 10),
            };
            (at / 10 == body).then_some((u, element))
        }
        UnknownKind::CentralInertia(e) => (body == 0).then_some((u, Element::Central(*e))),
        _ => None,
    })
    .collect()
}

fn bodies_at(parameters: &Parameters, x: &[f64]) -> Vec<InertialParameters> {
    match parameters.equations {
        Equations::Momentum => parameters.bodies(x),
        Equations::Rotation => vec![rotation_properties(parameters, x).parameters()],
    }
}

/// How much of a change of the mass unknowns, natural units, leaves every unknown body inside: 1 for all of it,
/// else the part that goes nine tenths of the way to the edge.
pub(crate) fn inside(parameters: &Parameters, natural: &[f64], x: &[f64], step: &[f64]) -> f64 {
    let mut moved = x.to_vec();
    for ((m, z), unit) in moved.iter_mut().zip(step).zip(natural) {
        *m += z * unit;
    }
    share_to(parameters, x, &moved, INSIDE)
}

/// Smallest eigenvalue of one pseudo-inertia over another; `None` where the other is not positive definite.
fn smallest_share(before: &InertialParameters, after: &InertialParameters) -> Option<f64> {
    let L = pseudo_inertia(before).cholesky()?.l();
    let half = L.solve_lower_triangular(&pseudo_inertia(after))?;
    let share = L.solve_lower_triangular(&half.transpose())?;
    let symmetric = (share + share.transpose()) * 0.5;
    if symmetric.iter().any(|x| !x.is_finite()) {
        return Some(f64::NEG_INFINITY);
    }
    Some(SymmetricEigen::new(symmetric).eigenvalues.min())
}

/// How far from a physical point towards another the bodies stay physical, at most 1.
pub(crate) fn physical_share(parameters: &Parameters, from: &[f64], to: &[f64]) -> f64 {
    share_to(parameters, from, to, START)
}

fn share_to(parameters: &Parameters, from: &[f64], to: &[f64], least: f64) -> f64 {
    let (a, b) = (bodies_at(parameters, from), bodies_at(parameters, to));
    let mut share: f64 = 1.0;
    for ((a, b), set) in a.iter().zip(&b).zip(&parameters.estimate) {
        // (1 - s) + s l > 0 for the smallest eigenvalue l of b over a.
        if let Some(l) = smallest_share(a, b).filter(|l| set.any() && *l < least) {
            share = share.min(0.9 / (1.0 - l.max(-1.0e9)));
        }
    }
    share
}

/// Names of the unknown bodies that stand at the edge of what positive mass can have.
pub(crate) fn at_the_edge(parameters: &Parameters, x: &[f64]) -> Vec<String> {
    let bodies = bodies_at(parameters, x);
    let mut names = Vec::new();
    for (index, body) in bodies.iter().enumerate() {
        if !parameters.estimate[index].any() {
            continue;
        }
        let Some(p) = body.mass_properties() else {
            continue;
        };
        let moment = p.I_BBcm_B.trace() / 2.0;
        let sigma = nalgebra::Matrix3::identity() * moment - p.I_BBcm_B;
        if SymmetricEigen::new(sigma).eigenvalues.min() < EDGE * moment {
            names.push(parameters.body_names[index].clone());
        }
    }
    names
}

/// The linear problem in free coordinates, restricted to the directions that are identified.
pub(crate) struct ChartSteps {
    chart: Chart,
    /// `diag(s) V^T G`: what the identified directions see of each coordinate.
    A: Mat<f64>,
    /// Which coordinates are logarithms.
    logarithm: Vec<bool>,
    x: Vec<f64>,
}

/// Share of the largest singular value below which a coordinate is not seen.
const UNSEEN: f64 = 1.0e-12;

impl ChartSteps {
    /// `None` where the bodies have no chart here.
    pub fn new(parameters: &Parameters, spectrum: &Spectrum, x: &[f64]) -> Option<Self> {
        let m = spectrum.natural.len();
        let chart = Chart::new(parameters, m, x)?;
        let G = chart.slope(&spectrum.natural, x);
        let A = Mat::from_fn(spectrum.rank, chart.width, |k, j| {
            let along: f64 = (0..m)
                .map(|i| spectrum.directions[(i, k)] * G[(i, j)])
                .sum();
            spectrum.singular[k] * along
        });
        let mut logarithm = Vec::new();
        for body in &chart.bodies {
            match body.free.is_empty() {
                true => logarithm.push(true),
                false => logarithm.extend(body.free.iter().map(|k| *k <= 3)),
            }
        }
        logarithm.resize(chart.width, false);
        Some(Self {
            A,
            logarithm,
            chart,
            x: x.to_vec(),
        })
    }

    /// Change of the mass unknowns, natural units, of a damped step, and how much the linear model says that it
    /// lowers chi-square.
    ///
    /// No logarithm moves by more than [`LONGEST`]. One that wants to is held there and the rest solved again: what
    /// is pressed against the edge falls quickly, and the others settle as if it stood still.
    pub fn step(&self, spectrum: &Spectrum, rhs: &[f64], damping: f64) -> (Vec<f64>, f64) {
        let (rows, width) = (self.A.nrows(), self.chart.width);
        let b: Vec<f64> = (0..rows).map(|k| spectrum.left_along(rhs, k)).collect();
        let mut theta = vec![0.0; width];
        let mut free: Vec<usize> = (0..width).collect();
        loop {
            let left: Vec<f64> = (0..rows).map(|i| b[i] - self.seen(&theta, i)).collect();
            let found = self.solve(&free, &left, damping);
            let long = |(j, d): (&usize, &f64)| self.logarithm[*j] && d.abs() > LONGEST;
            let held: Vec<usize> = free
                .iter()
                .zip(&found)
                .filter(|pair| long(*pair))
                .map(|(j, d)| {
                    theta[*j] = LONGEST.copysign(*d);
                    *j
                })
                .collect();
            if held.is_empty() {
                for (j, d) in free.iter().zip(&found) {
                    theta[*j] = *d;
                }
                break;
            }
            free.retain(|j| !held.contains(j));
        }
        let square = |x: f64| x * x;
        let decrease = (0..rows)
            .map(|i| square(b[i]) - square(b[i] - self.seen(&theta, i)))
            .sum();
        let change = self.chart.retract(&theta, &spectrum.natural, &self.x);
        (change, decrease)
    }

    /// Row i of `A theta`.
    fn seen(&self, theta: &[f64], i: usize) -> f64 {
        theta
            .iter()
            .enumerate()
            .map(|(j, t)| self.A[(i, j)] * t)
            .sum()
    }

    /// The shortest damped solution over some of the coordinates; zero where they cannot be decomposed.
    fn solve(&self, free: &[usize], b: &[f64], damping: f64) -> Vec<f64> {
        let rows = b.len();
        let part = Mat::from_fn(rows, free.len(), |i, k| self.A[(i, free[k])]);
        let mut out = vec![0.0; free.len()];
        let Ok(svd) = part.thin_svd() else {
            return out;
        };
        let count = rows.min(free.len());
        let largest = if count > 0 { svd.S()[0] } else { 0.0 };
        for k in 0..count {
            let s = svd.S()[k];
            if s <= UNSEEN * largest {
                continue;
            }
            let along: f64 = (0..rows).map(|i| svd.U()[(i, k)] * b[i]).sum();
            for (j, o) in out.iter_mut().enumerate() {
                *o += svd.V()[(j, k)] * along * s / (s * s + damping);
            }
        }
        out
    }
}
