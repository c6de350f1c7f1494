//! Numbers of a result: scalar, vector in body axes, symmetric tensor with named elements.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One number of the answer. Value, sigma and source are null where the data do not determine it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NumberFile {
    /// Value, in the unit of the key.
    pub value: Option<f64>,
    /// One sigma; zero for a known number.
    pub sigma: Option<f64>,
    /// Value in the model before identification.
    pub nominal: f64,
    /// "data", "prior" or "known".
    pub source: Option<String>,
}

/// One number of the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrueNumberFile {
    /// Value, in the unit of the key.
    pub value: f64,
}

/// One number of a prediction: there is no measurement yet, so it has no value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictedNumberFile {
    /// Value in the model, assumed true.
    pub nominal: f64,
    /// One sigma of the answer: the Cramer-Rao bound, and with wheels what the choice of their motion between samples adds; null
    /// where the number is not identifiable.
    pub sigma: Option<f64>,
    /// "data", "prior" or "known"; null where the number is not identifiable.
    pub source: Option<String>,
}

/// Components of a vector.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Axes<T> {
    /// Component x.
    pub x: T,
    /// Component y.
    pub y: T,
    /// Component z.
    pub z: T,
}

/// The six elements of a symmetric tensor. Products of inertia are tensor elements: xy = -integral x y dm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Elements<T> {
    /// Element xx.
    pub xx: T,
    /// Element yy.
    pub yy: T,
    /// Element zz.
    pub zz: T,
    /// Element xy.
    pub xy: T,
    /// Element xz.
    pub xz: T,
    /// Element yz.
    pub yz: T,
}

/// A vector of a result.
pub type VectorFile = Axes<NumberFile>;
/// A symmetric tensor of a result.
pub type TensorFile = Elements<NumberFile>;

impl NumberFile {
    /// Whether the model declares it as known.
    pub fn is_known(&self) -> bool {
        self.source.as_deref() == Some("known")
    }

    /// Whether the data determine it.
    pub fn is_from_data(&self) -> bool {
        self.source.as_deref() == Some("data")
    }

    /// Whether nothing determines it.
    pub fn is_open(&self) -> bool {
        self.source.is_none()
    }
}

impl PredictedNumberFile {
    /// Whether the model declares it as known.
    pub fn is_known(&self) -> bool {
        self.source.as_deref() == Some("known")
    }
}

impl<T> Axes<T> {
    /// From the three components.
    pub fn of([x, y, z]: [T; 3]) -> Self {
        Self { x, y, z }
    }

    /// Every component with its name.
    pub fn named(&self) -> [(&'static str, &T); 3] {
        [("x", &self.x), ("y", &self.y), ("z", &self.z)]
    }

    /// Maps each component.
    pub fn map<U>(&self, mut value: impl FnMut(&T) -> U) -> [U; 3] {
        self.named().map(|(_, t)| value(t))
    }
}

impl<T> Elements<T> {
    /// Every element with its name, in the order of the file.
    pub fn named(&self) -> [(&'static str, &T); 6] {
        [
            ("xx", &self.xx),
            ("yy", &self.yy),
            ("zz", &self.zz),
            ("xy", &self.xy),
            ("xz", &self.xz),
            ("yz", &self.yz),
        ]
    }

    /// From the elements in the order of inertial parameters: xx, xy, yy, xz, yz, zz.
    pub fn of([xx, xy, yy, xz, yz, zz]: [T; 6]) -> Self {
        Self {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        }
    }

    /// Maps each element; in the order of [`Self::of`].
    pub fn map<'t, U>(&'t self, value: impl FnMut(&'t T) -> U) -> [U; 6] {
        let Self { xx, yy, zz, .. } = self;
        [xx, &self.xy, yy, &self.xz, &self.yz, zz].map(value)
    }
}

/// The numbers, if none is missing.
///
/// ```
/// use poinsot_formats::all_known;
///
/// assert_eq!(all_known([Some(1.0), Some(2.0)]), Some([1.0, 2.0]));
/// assert_eq!(all_known([Some(1.0), None]), None);
/// ```
pub fn all_known<const N: usize>(numbers: [Option<f64>; N]) -> Option<[f64; N]> {
    let all = numbers.iter().all(Option::is_some);
    all.then(|| numbers.map(Option::unwrap_or_default))
}

/// The number, or null if infinite or NaN, which JSON cannot hold.
///
/// ```
/// use poinsot_formats::finite;
///
/// assert_eq!((finite(1.5), finite(f64::INFINITY)), (Some(1.5), None));
/// ```
pub fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
