//! The unknowns of the linear problem: the estimated numbers and their map to the ten parameters of every body.

mod effects;
mod known_numbers;
mod registry;
mod sensor_errors;

pub(crate) use effects::Part;
pub(crate) use registry::{Entry, GRADIENT, Registry};
pub use registry::{KnownUnknown, UnknownKind};
pub use sensor_errors::ErrorGroup;

use crate::problem::refusal;
use poinsot_dynamics::propagation::{Mode, PassiveJoints};
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_files::{Faults, check_memory};
use poinsot_model::{EstimateSet, Model, Nuisance};
use poinsot_spatial::{
    InertialParameters, MassProperties, PARAMETER_NAMES, Vector3, elements, parallel_axis,
};
pub use poinsot_spatial::{TENSOR, tensor_index, tensor_name};

/// One unknown number.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// Meaning.
    pub kind: UnknownKind,
    /// Name as it appears in the result, for example `bus.I_BBo_xx`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value in the model.
    pub nominal: f64,
    /// Natural unit in which identifiability is judged: m, m L or m L^2 of its body.
    pub natural: f64,
}

impl Unknown {
    /// Of a name and a unit, with its value in the model and its natural unit.
    pub(crate) fn new(
        kind: UnknownKind,
        (name, unit): (String, &'static str),
        (nominal, natural): (f64, f64),
    ) -> Self {
        Self {
            kind,
            name,
            unit,
            nominal,
            natural,
        }
    }
}

/// Which equations of motion can be written for the data at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equations {
    /// Linear and angular momentum about the inertial origin: six rows a sample. Unknowns are barycentric.
    Momentum,
    /// Angular momentum about the mass centre of one rigid body: three rows a sample.
    Rotation,
}

impl Equations {
    /// Rows of one sample.
    pub(crate) fn rows(self) -> usize {
        match self {
            Self::Momentum => 6,
            Self::Rotation => 3,
        }
    }
}

/// The unknowns, the known remainder and the maps between them and the bodies.
#[derive(Debug, Clone)]
pub struct Parameters {
    /// Which equations they belong to.
    pub equations: Equations,
    /// Unknowns: mass properties first, then nuisances.
    pub unknowns: Vec<Unknown>,
    /// How many of them are mass properties.
    pub mass_unknowns: usize,
    /// Barycentric parameters of every body with the unknowns set to zero.
    pub known: Vec<InertialParameters>,
    /// Nominal parameters of every body.
    pub nominal: Vec<InertialParameters>,
    /// Names of the bodies.
    pub body_names: Vec<String>,
    /// Estimated quantities, per body.
    pub estimate: Vec<EstimateSet>,
    /// Nominal mass properties of every body.
    pub nominal_properties: Vec<MassProperties>,
    /// Natural unit of mass and length per body, kg and m.
    pub natural: Vec<(f64, f64)>,
    /// Spin axis and tilt axes of every wheel, in its host.
    pub wheel_axes: Vec<(Vector3, [Vector3; 2])>,
    /// Gravitational parameter of the gravity gradient, where one acts, m3/s2.
    pub gm: Option<f64>,
    /// Nominal modes.
    pub modes: Vec<Mode>,
    /// Joints that nominal springs move.
    pub passive: PassiveJoints,
}

const AXES: [&str; 3] = ["x", "y", "z"];
/// Memory of all fits of an answer over the cube of its unknown numbers, bytes: every cause that is tried has a covariance. Measured with
/// the biases of 50, 100 and 200 gyros: 73, 530 and 3,280 MiB.
const OF_CUBE: f64 = 20.0;

impl Parameters {
    /// The unknowns of a model under the equations that the data allow.
    ///
    /// # Errors
    /// The problem is not linear.
    pub fn new(
        model: &Model,
        tree: &Tree,
        equations: Equations,
        thrusters_fire: bool,
    ) -> Result<Self, Faults> {
        let mut parameters = Self::all_known(model, tree, &model.nominal_parameters());
        parameters.equations = equations;
        parameters.estimate = model.bodies.iter().map(|b| b.estimate).collect();
        match equations {
            Equations::Momentum => {
                for body in 0..model.bodies.len() {
                    parameters.add_body(body)?;
                }
            }
            Equations::Rotation => parameters.add_rotation(model, thrusters_fire)?,
        }
        parameters.mass_unknowns = parameters.unknowns.len();
        if parameters.mass_unknowns > refusal::MOST_NUMBERS {
            let numbers = parameters.mass_unknowns;
            let advice = "take estimate out of bodies that are known well enough";
            let what = "mass properties to estimate";
            return Err(refusal::too_many(numbers, what, advice));
        }
        parameters.add_nuisances(model, tree);
        if parameters.unknowns.is_empty() {
            return Err(refusal::nothing_unknown());
        }
        let count = parameters.unknowns.len();
        let bytes = OF_CUBE * (count as f64).powi(3);
        check_memory(&format!("the fits of {count} unknown numbers"), bytes)?;
        Ok(parameters)
    }

    /// No mass property unknown: the bodies are as given, what remains are the nuisances that the model declares.
    pub fn without_mass(model: &Model, tree: &Tree, bodies: &[InertialParameters]) -> Self {
        let mut parameters = Self::all_known(model, tree, bodies);
        parameters.add_nuisances(model, tree);
        parameters
    }

    /// Nothing unknown as yet.
    fn all_known(model: &Model, tree: &Tree, bodies: &[InertialParameters]) -> Self {
        let properties: Vec<MassProperties> = model.bodies.iter().map(|b| b.nominal).collect();
        Self {
            equations: Equations::Momentum,
            unknowns: Vec::new(),
            mass_unknowns: 0,
            known: bodies.to_vec(),
            natural: natural_units(tree, &properties, bodies),
            nominal: bodies.to_vec(),
            body_names: model.bodies.iter().map(|b| b.name.clone()).collect(),
            estimate: vec![EstimateSet::default(); model.bodies.len()],
            nominal_properties: properties,
            wheel_axes: wheel_axes(model),
            gm: gradient_gm(model),
            modes: model.modes.iter().map(|m| m.mode).collect(),
            passive: model.passive_joints(tree),
        }
    }

    /// The same unknowns of a vehicle whose known numbers differ; `None` if the problem is not valid for it.
    pub(crate) fn of_vehicle(&self, model: &Model, tree: &Tree) -> Option<Self> {
        let fires = self.unknowns.iter();
        let fires = fires
            .clone()
            .any(|u| matches!(u.kind, UnknownKind::MassCentre(_)));
        let other = Self::new(model, tree, self.equations, fires).ok()?;
        let mut out = self.clone();
        (out.known, out.nominal) = (other.known, other.nominal);
        out.nominal_properties = other.nominal_properties;
        (out.modes, out.passive) = (other.modes, other.passive);
        // Tilts stay about the directions of the nominal vehicle.
        let axes = out.wheel_axes.iter_mut().zip(other.wheel_axes);
        axes.for_each(|(own, new)| own.0 = new.0);
        let own = out.unknowns.iter_mut().zip(other.unknowns);
        for (unknown, new) in own.take(self.mass_unknowns) {
            unknown.kind = new.kind;
        }
        Some(out)
    }

    /// These unknowns without the known numbers, and the place of each in the whole list.
    pub(crate) fn without_known(&self) -> (Self, Vec<usize>) {
        let asked = |k: &usize| self.unknowns[*k].kind.known().is_none();
        let kept: Vec<usize> = (0..self.len()).filter(asked).collect();
        let mut out = self.clone();
        out.unknowns.retain(|u| u.kind.known().is_none());
        (out, kept)
    }

    /// How many are no nuisances, which come first: what a step decides, while the others follow.
    pub(crate) fn decided_by_steps(&self) -> usize {
        let decided = self.unknowns.iter().filter(|u| !u.kind.is_nuisance());
        decided.count()
    }

    /// Place of a number among the unknowns.
    pub(crate) fn place(&self, kind: &UnknownKind) -> Option<usize> {
        self.unknowns.iter().position(|u| u.kind.is_same(kind))
    }

    /// Whether any known number is among the unknowns.
    pub(crate) fn has_known(&self) -> bool {
        self.unknowns.iter().any(|u| u.kind.known().is_some())
    }

    /// Whether any of them delays the inputs.
    pub(crate) fn delay_inputs(&self) -> bool {
        self.unknowns.iter().any(|u| u.kind.delays_inputs())
    }

    /// What the registry holds and the model declares unknown.
    fn add_nuisances(&mut self, model: &Model, tree: &Tree) {
        let registry = Registry {
            model,
            tree,
            segments: &[],
        };
        let kinds = registry.groups().into_iter().flatten();
        let entries = kinds.filter_map(|kind| registry.entry(&kind));
        let declared = entries.filter(|entry| entry.declared != Nuisance::Known);
        self.unknowns.extend(declared.map(|entry| entry.unknown));
    }

    fn push(&mut self, kind: UnknownKind, number: (String, &'static str), values: (f64, f64)) {
        self.unknowns.push(Unknown::new(kind, number, values));
    }

    /// Unknowns of one body under the momentum equations: linear unless the mass centre alone is estimated.
    fn add_body(&mut self, body: usize) -> Result<(), Faults> {
        let asked = self.estimate[body];
        if !asked.any() {
            return Ok(());
        }
        let name = self.body_names[body].clone();
        if asked.com && !asked.inertia {
            return Err(refusal::nonlinear(&name));
        }
        let (m, l) = self.natural[body];
        let pi = self.nominal[body].to_array();
        let given = self.nominal_properties[body];
        let at = 10 * body;
        let mut known = InertialParameters::ZERO;
        if asked.mass {
            let mut column = vec![(at, 1.0)];
            if !asked.com {
                // A known mass centre ties first moment and parallel-axis part to the mass.
                let c = given.p_BoBcm_B;
                column.extend((0..3).map(|k| (at + 1 + k, c[k])));
                let shift = elements(&parallel_axis(1.0, &c));
                column.extend((0..6).map(|k| (at + 4 + k, shift[k])));
            }
            let number = (format!("{name}.m"), "kg");
            self.push(UnknownKind::Barycentric(column), number, (pi[0], m));
        } else {
            known.mass = given.mass;
            if !asked.com {
                known = MassProperties {
                    I_BBcm_B: Default::default(),
                    ..given
                }
                .parameters();
            }
        }
        if asked.com {
            for k in 0..3 {
                let kind = UnknownKind::Barycentric(vec![(at + 1 + k, 1.0)]);
                let number = (format!("{name}.{}", PARAMETER_NAMES[1 + k]), "kg m");
                self.push(kind, number, (pi[1 + k], m * l));
            }
        }
        if asked.inertia {
            // With the mass centre unknown the tensor about Bo is the linear one; else the central one.
            let (point, value) = if asked.com {
                ("BBo", self.nominal[body].I_BBo_B)
            } else {
                ("BBcm", given.I_BBcm_B)
            };
            for (k, &e) in TENSOR.iter().enumerate() {
                let kind = UnknownKind::Barycentric(vec![(at + 4 + k, 1.0)]);
                let number = (format!("{name}.I_{point}_{}", tensor_name(k)), "kg m2");
                self.push(kind, number, (value[e], m * l * l));
            }
        } else {
            known.I_BBo_B += given.I_BBcm_B;
        }
        self.known[body] = known;
        Ok(())
    }

    /// Unknowns of one rigid body of which only the rotation is seen.
    fn add_rotation(&mut self, model: &Model, thrusters_fire: bool) -> Result<(), Faults> {
        let asked = self.estimate[0];
        if model.bodies.len() != 1 {
            return Err(refusal::rotation_of_tree(model.bodies.len()));
        }
        let (m, l) = self.natural[0];
        let given = self.nominal_properties[0];
        let name = self.body_names[0].clone();
        // Without thrusters the mass centre never enters: it is omitted and reported as unobservable.
        if asked.com && thrusters_fire {
            for (k, axis) in AXES.iter().enumerate() {
                let number = (format!("{name}.com_{axis}"), "m");
                self.push(UnknownKind::MassCentre(k), number, (given.p_BoBcm_B[k], l));
            }
        }
        if asked.inertia {
            for (k, &e) in TENSOR.iter().enumerate() {
                let number = (format!("{name}.I_BBcm_{}", tensor_name(k)), "kg m2");
                let value = (given.I_BBcm_B[e], m * l * l);
                self.push(UnknownKind::CentralInertia(k), number, value);
            }
        }
        Ok(())
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.unknowns.len()
    }

    /// Whether there is nothing to find; never true for a constructed problem.
    pub fn is_empty(&self) -> bool {
        self.unknowns.is_empty()
    }

    /// Nominal values of the unknowns.
    pub fn nominal_vector(&self) -> Vec<f64> {
        self.unknowns.iter().map(|u| u.nominal).collect()
    }

    /// Natural scales of the first unknowns.
    pub(crate) fn natural_vector(&self, count: usize) -> Vec<f64> {
        self.unknowns[..count].iter().map(|u| u.natural).collect()
    }

    /// Barycentric parameters of every body for values of the unknowns.
    ///
    /// Where only rotation is seen the mass is the nominal one: it does not matter then.
    pub fn bodies(&self, x: &[f64]) -> Vec<InertialParameters> {
        if self.equations == Equations::Rotation {
            return vec![rotation_properties(self, x).parameters()];
        }
        let mut pi: Vec<[f64; 10]> = self.known.iter().map(|b| b.to_array()).collect();
        for (unknown, value) in self.unknowns.iter().zip(x) {
            if let UnknownKind::Barycentric(column) = &unknown.kind {
                for (at, coefficient) in column {
                    pi[at / 10][at % 10] += coefficient * value;
                }
            }
        }
        pi.iter().map(InertialParameters::from_array).collect()
    }

    /// The modes for values of the unknowns.
    pub fn modes_at(&self, x: &[f64]) -> Vec<Mode> {
        let mut modes = self.modes.clone();
        for (unknown, value) in self.unknowns.iter().zip(x) {
            if let UnknownKind::Mode(k, number) = unknown.kind {
                modes[k].set(number, *value);
            }
        }
        modes
    }

    /// The passive joints for values of the unknowns.
    pub fn passive_at(&self, x: &[f64]) -> PassiveJoints {
        let mut passive = self.passive.clone();
        for (unknown, value) in self.unknowns.iter().zip(x) {
            if let UnknownKind::Spring(k, number) = unknown.kind
                && let Some(spring) = passive.spring_mut(k)
            {
                *number.of(spring) = *value;
            }
        }
        passive
    }

    /// How each unknown moves the barycentric parameters at `x`: pairs of index `10 body + k` and slope.
    /// Empty for unknowns that move no body.
    pub fn slopes(&self, x: &[f64]) -> Vec<Vec<(usize, f64)>> {
        let given = (self.equations == Equations::Rotation).then(|| rotation_properties(self, x));
        self.unknowns
            .iter()
            .map(|unknown| match (&unknown.kind, &given) {
                (UnknownKind::Barycentric(parts), _) => parts.clone(),
                (UnknownKind::Known(known), _) => known.slopes.clone(),
                (UnknownKind::CentralInertia(k), _) => vec![(4 + k, 1.0)],
                (UnknownKind::MassCentre(axis), Some(body)) => mass_centre_slope(body, *axis),
                _ => Vec::new(),
            })
            .collect()
    }
}

/// Slope of the barycentric parameters over a component of the mass centre at fixed mass and central
/// inertia: `d(m c)` and `d(m (c.c 1 - c c^T))`.
fn mass_centre_slope(body: &MassProperties, axis: usize) -> Vec<(usize, f64)> {
    let (m, c) = (body.mass, body.p_BoBcm_B);
    let e = Vector3::ith(axis, 1.0);
    let shift =
        (nalgebra::Matrix3::identity() * (2.0 * c[axis]) - e * c.transpose() - c * e.transpose())
            * m;
    let shift = elements(&shift);
    let moments = (0..6).map(|k| (4 + k, shift[k]));
    [(1 + axis, m)].into_iter().chain(moments).collect()
}

/// Per wheel the spin axis and the two axes about which it may be tilted, in the host's axes.
fn wheel_axes(model: &Model) -> Vec<(Vector3, [Vector3; 2])> {
    let wheels = model.wheels.iter();
    wheels.map(|w| (w.axis_B, w.tilt_axes())).collect()
}

/// Gravitational parameter of the centre, m3/s2, if the gravity gradient is included.
fn gradient_gm(model: &Model) -> Option<f64> {
    let around = &model.environment;
    around.point_mass_gm.filter(|_| around.gravity_gradient)
}

/// Natural unit of mass and length per body; a massless nominal body has those of the vehicle.
fn natural_units(
    tree: &Tree,
    properties: &[MassProperties],
    nominal: &[InertialParameters],
) -> Vec<(f64, f64)> {
    let whole = composite(nominal, &Kinematics::new(tree)).mass_properties();
    let (mass, length) = whole.map_or((1.0, 1.0), |p| (p.mass, p.radius_of_gyration()));
    let length = if length > 0.0 { length } else { 1.0 };
    properties
        .iter()
        .map(|b| {
            let m = if b.mass > 0.0 { b.mass } else { mass };
            let l = b.radius_of_gyration();
            (m, if l > 0.0 { l } else { length })
        })
        .collect()
}

/// Component names of a vector.
///
/// ```
/// assert_eq!(poinsot_identify::axis_name(2), "z");
/// ```
pub fn axis_name(k: usize) -> &'static str {
    AXES[k % 3]
}

/// Values of the unknowns of the rotation of one body as those of barycentric unknowns; mass and other missing unknowns
/// at their nominal values.
pub(crate) fn lifted_vector(from: &Parameters, x: &[f64], parameters: &Parameters) -> Vec<f64> {
    let body = rotation_properties(from, x);
    let pi = body.parameters().to_array();
    let with_centre = parameters.estimate[0].com;
    parameters
        .unknowns
        .iter()
        .map(|unknown| match &unknown.kind {
            UnknownKind::Barycentric(parts) => {
                let k = parts.first().map_or(0, |(at, _)| at % 10);
                match k.checked_sub(4) {
                    Some(e) if !with_centre => body.I_BBcm_B[TENSOR[e]],
                    _ => pi[k],
                }
            }
            _ => {
                let place = from.place(&unknown.kind);
                let found = place.and_then(|k| x.get(k));
                found.copied().unwrap_or(unknown.nominal)
            }
        })
        .collect()
}

/// Values of the rotation unknowns: mass centre and central inertia of the base.
pub fn rotation_properties(parameters: &Parameters, x: &[f64]) -> MassProperties {
    let mut ten = parameters.nominal_properties[0].to_array();
    for (unknown, value) in parameters.unknowns.iter().zip(x) {
        match unknown.kind {
            UnknownKind::MassCentre(k) => ten[1 + k] = *value,
            UnknownKind::CentralInertia(k) => ten[4 + k] = *value,
            _ => {}
        }
    }
    MassProperties::from_array(&ten)
}
