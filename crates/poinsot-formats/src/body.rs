//! Mass properties of one body.

use crate::number::{Axes, Elements, NumberFile, TensorFile, VectorFile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mass properties of one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyFile {
    /// Mass, kg.
    pub mass_kg: NumberFile,
    /// Mass centre from the origin of the body's frame, in its axes, m.
    pub com_m: VectorFile,
    /// Inertia tensor about the mass centre, in the body's axes, kg m2.
    pub inertia_kg_m2: TensorFile,
    /// Principal moments and axes; null where the tensor is not determined.
    pub principal: Option<PrincipalFile>,
    /// The ten parameters about the origin of the body's frame.
    pub barycentric: BarycentricFile,
    /// Whether a distribution of positive mass has this tensor; null where it is not determined.
    pub physically_consistent: Option<bool>,
}

/// Principal moments and axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PrincipalFile {
    /// Moments in ascending order, kg m2.
    pub moments_kg_m2: [f64; 3],
    /// Rotation from principal axes to body axes: quaternion, Hamilton, scalar last.
    pub axes_xyzw: [f64; 4],
}

/// Mass, first moment and inertia about the origin of the body's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BarycentricFile<N = NumberFile> {
    /// Mass, kg.
    pub m_kg: N,
    /// First moment of mass, kg m.
    pub mc_kg_m: Axes<N>,
    /// Inertia tensor about the origin, kg m2.
    pub I_BBo_kg_m2: Elements<N>,
}

/// Mass, mass centre and inertia alone, in the same places as of a whole body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MassFile<N> {
    /// Mass, kg.
    pub mass_kg: N,
    /// Mass centre from the origin of the body's frame, in its axes, m.
    pub com_m: Axes<N>,
    /// Inertia tensor about the mass centre, in the body's axes, kg m2.
    pub inertia_kg_m2: Elements<N>,
}

impl<N> MassFile<N> {
    /// From mass, mass centre and inertia in the order of mass properties; [`Elements::of`] has that of the inertia.
    pub fn of([mass_kg, x, y, z, tensor @ ..]: [N; 10]) -> Self {
        Self {
            mass_kg,
            com_m: Axes { x, y, z },
            inertia_kg_m2: Elements::of(tensor),
        }
    }

    /// Maps each number; in the order of [`Self::of`].
    pub fn map<U>(&self, value: impl FnMut(&N) -> U) -> [U; 10] {
        ten(&self.mass_kg, &self.com_m, &self.inertia_kg_m2).map(value)
    }
}

/// The numbers of a body in the order of mass properties.
fn ten<'n, N>(mass: &'n N, vector: &'n Axes<N>, tensor: &'n Elements<N>) -> [&'n N; 10] {
    let Axes { x, y, z } = vector;
    let [xx, xy, yy, xz, yz, zz] = tensor.map(|n| n);
    [mass, x, y, z, xx, xy, yy, xz, yz, zz]
}

impl<N: Clone> MassFile<N> {
    /// Mass, mass centre and inertia with name and unit.
    pub fn numbers(&self) -> Vec<(String, &'static str, N)> {
        numbers(&self.mass_kg, &self.com_m, &self.inertia_kg_m2)
    }
}

fn numbers<N: Clone>(
    mass: &N,
    com: &Axes<N>,
    inertia: &Elements<N>,
) -> Vec<(String, &'static str, N)> {
    let mut all = vec![("mass".to_owned(), "kg", mass.clone())];
    for (axis, number) in com.named() {
        all.push((format!("com {axis}"), "m", number.clone()));
    }
    for (element, number) in inertia.named() {
        all.push((format!("I {element}"), "kg m²", number.clone()));
    }
    all
}

impl<N> BarycentricFile<N> {
    /// From the ten parameters in their order.
    pub fn of([m_kg, x, y, z, tensor @ ..]: [N; 10]) -> Self {
        Self {
            m_kg,
            mc_kg_m: Axes { x, y, z },
            I_BBo_kg_m2: Elements::of(tensor),
        }
    }

    /// Maps each parameter.
    pub fn map<U>(&self, value: impl FnMut(&N) -> U) -> [U; 10] {
        ten(&self.m_kg, &self.mc_kg_m, &self.I_BBo_kg_m2).map(value)
    }
}

impl BarycentricFile {
    /// How many of the ten parameters the data determine.
    pub fn determined(&self) -> usize {
        let determined = self.map(NumberFile::is_from_data).into_iter();
        determined.filter(|d| *d).count()
    }
}

impl BodyFile {
    /// Maps mass, mass centre and inertia; in the order of [`MassFile::of`].
    pub fn map<U>(&self, value: impl FnMut(&NumberFile) -> U) -> [U; 10] {
        ten(&self.mass_kg, &self.com_m, &self.inertia_kg_m2).map(value)
    }

    /// Mass, mass centre and inertia with name and unit.
    pub fn numbers(&self) -> Vec<(String, &'static str, NumberFile)> {
        numbers(&self.mass_kg, &self.com_m, &self.inertia_kg_m2)
    }

    /// The same numbers by address, for a body of this name, with ASCII units.
    pub fn addressed(&self, body: &str) -> Vec<(String, &'static str, NumberFile)> {
        let mut all = vec![(format!("{body}.mass_kg"), "kg", self.mass_kg.clone())];
        for (axis, number) in self.com_m.named() {
            all.push((format!("{body}.com_m.{axis}"), "m", number.clone()));
        }
        for (element, number) in self.inertia_kg_m2.named() {
            let address = format!("{body}.inertia_kg_m2.{element}");
            all.push((address, "kg m2", number.clone()));
        }
        all
    }

    /// Whether any of its numbers was requested.
    pub fn is_asked(&self) -> bool {
        self.numbers().iter().any(|(_, _, n)| !n.is_known())
    }
}
