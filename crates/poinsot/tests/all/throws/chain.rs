//! From throws to objects, with the uncertainty of every step: box, block, object.

use super::recording::Recording;
use super::truth::Known;
use super::{Fault, Throws};
use crate::tables;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use poinsot_identify::TENSOR;
use poinsot_spatial::parallel_axis;

/// Covariance of the six tensor elements in the order of [`TENSOR`].
pub type Covariance = SMatrix<f64, 6, 6>;

/// A body in units of J: inertia about its mass centre with locked rotor, mass centre from the accelerometer, body axes, m.
#[derive(Clone)]
pub struct Body {
    pub I: Matrix3<f64>,
    pub p: Vector3<f64>,
    pub I_cov: Covariance,
    pub p_cov: Matrix3<f64>,
}

/// Result of the throws of one body.
pub struct Bodies {
    pub each: Vec<Body>,
    pub together: Body,
    /// Ratio of observed to stated scatter of the throws, at least one.
    pub scatter: f64,
}

/// One answer for an object.
pub struct Answer {
    pub name: String,
    /// Principal moments minus the known ones, %.
    pub error: [f64; 3],
    /// Their sigma, %.
    pub sigma: [f64; 3],
    /// The paper's measure: norm of the error of the three moments over their norm, %.
    pub published: f64,
}

impl Answer {
    /// How many of the 95 % intervals of the moments hold the known one.
    fn held(&self) -> usize {
        let pairs = self.error.iter().zip(&self.sigma);
        pairs.filter(|(e, s)| e.abs() <= 1.959_964 * **s).count()
    }
}

/// All answers for one object.
pub struct Object {
    pub name: String,
    pub throws: Vec<Answer>,
    pub together: Answer,
    /// Ratio of observed to stated scatter of the throws.
    pub scatter: f64,
}

impl Object {
    /// Mean and largest |error| over throws and moments, %.
    pub fn errors(&self) -> (f64, f64) {
        mean_and_worst(self.throws.iter().flat_map(|t| t.error))
    }

    /// Share of the intervals that hold the truth.
    pub fn held(&self) -> f64 {
        let held: usize = self.throws.iter().map(Answer::held).sum();
        held as f64 / (3 * self.throws.len()) as f64
    }
}

fn mean_and_worst(all: impl Iterator<Item = f64>) -> (f64, f64) {
    let all: Vec<f64> = all.map(f64::abs).collect();
    let sum: f64 = all.iter().sum();
    (
        sum / all.len() as f64,
        all.iter().copied().fold(0.0, f64::max),
    )
}

/// All results.
pub struct Found {
    pub J: f64,
    J_sigma: f64,
    /// J from each throw of the block.
    pub each_J: Vec<f64>,
    /// The box alone, in units of J.
    pub the_box: Bodies,
    /// Principal moments of the block with that J, minus the known ones, %: a check of shape.
    pub proof_error: [f64; 3],
    pub objects: Vec<Object>,
}

/// Calibrates on `device_only` and `proof_body` and identifies the objects, given the bodies of a group of throws. The known
/// inertia of the objects is used only for the errors.
pub fn identify(
    throws: &Throws,
    bodies: impl Fn(&str, &[Recording]) -> Result<Bodies, Fault>,
) -> Result<Found, Fault> {
    let of = |group: &str| bodies(group, throws.group(group));
    let the_box = of("device_only")?;
    let proofs = of("proof_body")?;
    let known = &throws.truth.proof_body;
    let chain = |the_box| Chain {
        box_mass: throws.truth.box_mass,
        the_box,
    };
    let bench = chain(&the_box.together);
    let J = bench.spin(&proofs.together, known);
    // The observed scatter of the throws gives the uncertainty of their mean, for any declared noise.
    let each_J: Vec<f64> = proofs.each.iter().map(|b| bench.spin(b, known)).collect();
    let boxes = the_box.each.iter();
    let by_box: Vec<f64> = boxes
        .map(|b| chain(b).spin(&proofs.together, known))
        .collect();
    let J_sigma = (variance_of_mean(&each_J) + variance_of_mean(&by_box)).sqrt();
    let mut objects = Vec::new();
    for known in &throws.truth.objects {
        let found = of(&known.name)?;
        let answer = |name: &str, body| bench.answer(name, body, known, (J, J_sigma));
        let own = throws.group(&known.name).iter().zip(&found.each);
        objects.push(Object {
            name: known.name.clone(),
            throws: own.map(|(t, body)| answer(&t.name, body)).collect(),
            together: answer("all", &found.together),
            scatter: found.scatter,
        });
    }
    let block = principal(&bench.object(&proofs.together, known.mass, J));
    Ok(Found {
        J,
        J_sigma,
        each_J,
        proof_error: percent(&block, known),
        objects,
        the_box,
    })
}

impl Found {
    /// Prints the table of `data/tudelft_throw/README.md` and every throw of an object.
    pub fn print(&self) {
        let signed = |e: &[f64; 3]| e.map(|x| format!("{x:+.2}")).join(" ");
        let (J, sigma) = (1.0e6 * self.J, 1.0e6 * self.J_sigma);
        let block = signed(&self.proof_error);
        println!("J = {J:.4}e-6 +- {sigma:.4}e-6 kg m2; block with it: {block} %");
        tables::heading(&[
            "object",
            "throws",
            "mean %",
            "worst %",
            "by the paper's measure, mean %",
            "worst %",
            "95 % intervals that hold",
            "throws with all three",
            "all throws together %",
            "scatter over stated",
        ]);
        for object in &self.objects {
            let count = object.throws.len();
            let (mean, worst) = object.errors();
            let (by_norm, worst_norm) = mean_and_worst(object.throws.iter().map(|t| t.published));
            let whole = object.throws.iter().filter(|t| t.held() == 3).count();
            tables::row(&[
                object.name.clone(),
                count.to_string(),
                format!("{mean:.2}"),
                format!("{worst:.1}"),
                format!("{by_norm:.2}"),
                format!("{worst_norm:.1}"),
                format!("{:.0} % of {}", 100.0 * object.held(), 3 * count),
                format!("{whole} of {count}"),
                signed(&object.together.error),
                format!("{:.2}", object.scatter),
            ]);
        }
        for object in &self.objects {
            println!(
                "\n{}: error of the principal moments and sigma, %",
                object.name
            );
            for t in &object.throws {
                println!("  {:8} {}   {:.2?}", t.name, signed(&t.error), t.sigma);
            }
        }
    }
}

fn variance_of_mean(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
}

struct Chain<'a> {
    box_mass: f64,
    the_box: &'a Body,
}

impl Chain<'_> {
    fn answer(&self, name: &str, body: &Body, known: &Known, J: (f64, f64)) -> Answer {
        let moments = principal(&self.object(body, known.mass, J.0));
        let truth = Vector3::from(principal(&known.I_cm));
        let error = Vector3::from(moments) - truth;
        Answer {
            name: name.to_owned(),
            error: percent(&moments, known),
            sigma: self.sigma(body, known, J),
            published: 100.0 * error.norm() / truth.norm(),
        }
    }

    /// J from box and known block by the traces, which do not depend on the orientation of the box:
    /// `J tr(I_c/J - I_b/J) = tr I_o + tr I_parallel`.
    fn spin(&self, both: &Body, block: &Known) -> f64 {
        let apart = self.apart(&both.p, block.mass);
        (block.I_cm + apart).trace() / (both.I - self.the_box.I).trace()
    }

    /// `I_o = J (I_c/J - I_b/J) - I_parallel`, about its mass centre.
    fn object(&self, both: &Body, mass: f64, J: f64) -> Matrix3<f64> {
        (both.I - self.the_box.I) * J - self.apart(&both.p, mass)
    }

    /// Inertia of the two mass centres about the common one: the reduced mass at the distance
    /// `p_bo = p_bc (m_b + m_o) / m_o`.
    fn apart(&self, p_Sc: &Vector3<f64>, mass: f64) -> Matrix3<f64> {
        let whole = self.box_mass + mass;
        let p_bo = (p_Sc - self.the_box.p) * (whole / mass);
        parallel_axis(self.box_mass * mass / whole, &p_bo)
    }

    /// Sigma of the principal moments, %, to first order in all inputs.
    fn sigma(&self, both: &Body, known: &Known, (J, J_sigma): (f64, f64)) -> [f64; 3] {
        let eigen = self.object(both, known.mass, J).symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let moments = principal(&known.I_cm);
        std::array::from_fn(|k| {
            let v: Vector3<f64> = eigen.eigenvectors.column(order[k]).into();
            let along = |M: &Matrix3<f64>| (v.transpose() * M * v)[0];
            let g = SVector::<f64, 6>::from_fn(|e, _| {
                let (i, j) = TENSOR[e];
                J * v[i] * v[j] * if i == j { 1.0 } else { 2.0 }
            });
            let tensors = (g.transpose() * (both.I_cov + self.the_box.I_cov) * g)[0];
            let scale = along(&(both.I - self.the_box.I)) * J_sigma;
            let step = 1.0e-6;
            let slope = Vector3::from_fn(|axis, _| {
                let mut d = Vector3::zeros();
                d[axis] = step;
                let there = self.apart(&(both.p + d), known.mass);
                let back = self.apart(&(both.p - d), known.mass);
                along(&(there - back)) / (2.0 * step)
            });
            let centres = (slope.transpose() * (both.p_cov + self.the_box.p_cov) * slope)[0];
            100.0 * (tensors + scale * scale + centres).sqrt() / moments[k]
        })
    }
}

/// Principal moments, ascending.
pub fn principal(tensor: &Matrix3<f64>) -> [f64; 3] {
    let mut moments: [f64; 3] = tensor.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    moments
}

fn percent(found: &[f64; 3], known: &Known) -> [f64; 3] {
    let known = principal(&known.I_cm);
    std::array::from_fn(|k| 100.0 * (found[k] / known[k] - 1.0))
}

/// A symmetric matrix from its elements in the order of [`TENSOR`].
pub fn symmetric(elements: [f64; 6]) -> Matrix3<f64> {
    let mut out = Matrix3::zeros();
    for ((i, j), value) in TENSOR.into_iter().zip(elements) {
        out[(i, j)] = value;
        out[(j, i)] = value;
    }
    out
}
