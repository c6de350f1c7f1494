//! Numbers of an answer: scalar, vector in body axes, symmetric tensor with named elements.

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

/// A vector: components x, y, z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VectorFile {
    /// Values, in the unit of the key.
    pub value: [Option<f64>; 3],
    /// One sigma each.
    pub sigma: [Option<f64>; 3],
    /// Values in the model.
    pub nominal: [f64; 3],
    /// Sources as of a single number.
    pub source: [Option<String>; 3],
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

/// A symmetric tensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TensorFile {
    /// Values, in the unit of the key.
    pub value: Elements<Option<f64>>,
    /// One sigma each.
    pub sigma: Elements<Option<f64>>,
    /// Values in the model.
    pub nominal: Elements<f64>,
    /// Sources as of a single number.
    pub source: Elements<Option<String>>,
}

impl NumberFile {
    /// Whether the model gives it as known.
    pub fn is_known(&self) -> bool {
        self.source.as_deref() == Some("known")
    }
}

impl VectorFile {
    /// Component 0, 1 or 2.
    pub fn number(&self, k: usize) -> NumberFile {
        NumberFile {
            value: self.value[k],
            sigma: self.sigma[k],
            nominal: self.nominal[k],
            source: self.source[k].clone(),
        }
    }

    /// From its three components.
    pub fn of(numbers: [NumberFile; 3]) -> Self {
        Self {
            value: numbers.each_ref().map(|n| n.value),
            sigma: numbers.each_ref().map(|n| n.sigma),
            nominal: numbers.each_ref().map(|n| n.nominal),
            source: numbers.map(|n| n.source),
        }
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

    /// One value per element name.
    pub fn by_name(mut value: impl FnMut(&'static str) -> T) -> Self {
        Self {
            xx: value("xx"),
            yy: value("yy"),
            zz: value("zz"),
            xy: value("xy"),
            xz: value("xz"),
            yz: value("yz"),
        }
    }
}

impl TensorFile {
    /// Every element with its name, in the order of the file.
    pub fn named(&self) -> [(&'static str, NumberFile); 6] {
        let (value, sigma) = (self.value.named(), self.sigma.named());
        let (nominal, source) = (self.nominal.named(), self.source.named());
        std::array::from_fn(|k| {
            let number = NumberFile {
                value: *value[k].1,
                sigma: *sigma[k].1,
                nominal: *nominal[k].1,
                source: source[k].1.clone(),
            };
            (value[k].0, number)
        })
    }

    /// From one number per element name.
    pub fn of(number: impl Fn(&'static str) -> NumberFile) -> Self {
        Self {
            value: Elements::by_name(|e| number(e).value),
            sigma: Elements::by_name(|e| number(e).sigma),
            nominal: Elements::by_name(|e| number(e).nominal),
            source: Elements::by_name(|e| number(e).source),
        }
    }
}

/// JSON has no infinity and no NaN: such a number is null.
pub fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
