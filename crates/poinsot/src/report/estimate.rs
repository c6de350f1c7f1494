//! `estimate.json` as a report reads it.

use crate::diagnostics_file::DiagnosticsFile;
use serde::Deserialize;
use serde_json::{Map, Value};

/// The result file.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct EstimateFile {
    pub schema: String,
    pub poinsot: String,
    pub method: String,
    pub variant: Option<String>,
    pub status: String,
    #[serde(default)]
    pub iterations: usize,
    #[serde(default)]
    pub model: String,
    pub inputs: Vec<Input>,
    bodies: Map<String, Value>,
    pub covariance: Covariance,
    #[serde(default)]
    pub system: Vec<Body>,
    pub momentum: Vec<Momentum>,
    nuisance: Map<String, Value>,
    pub identifiability: Identifiability,
    pub fit: Vec<Fit>,
    #[serde(default)]
    pub diagnostics: Option<DiagnosticsFile>,
    pub covariance_trustworthy: bool,
    #[serde(default)]
    pub doubts: Vec<String>,
    pub repairs: Vec<String>,
    #[serde(default)]
    pub ignored_columns: Vec<String>,
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Input {
    pub path: String,
    pub sha256: String,
    #[serde(default)]
    pub segment: usize,
    pub time_s: Option<[f64; 2]>,
    pub rows: Option<u64>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Body {
    pub mass_kg: Number,
    pub com_m: Triple,
    pub inertia_kg_m2: Tensor,
    pub physically_consistent: Option<bool>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Number {
    pub value: Option<f64>,
    pub sigma: Option<f64>,
    pub nominal: f64,
    pub source: Option<String>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Triple {
    value: [Option<f64>; 3],
    sigma: [Option<f64>; 3],
    nominal: [f64; 3],
    source: [Option<String>; 3],
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Tensor {
    value: Elements<Option<f64>>,
    sigma: Elements<Option<f64>>,
    nominal: Elements<f64>,
    source: Elements<Option<String>>,
}

/// Tensor elements by name.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Elements<T> {
    pub xx: T,
    pub yy: T,
    pub zz: T,
    pub xy: T,
    pub xz: T,
    pub yz: T,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Covariance {
    pub names: Vec<String>,
    pub matrix: Vec<Vec<Option<f64>>>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Momentum {
    pub linear_N_s: Triple,
    pub angular_N_m_s: Triple,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Identifiability {
    pub parameters: usize,
    pub rank: usize,
    pub structural_rank: usize,
    pub sigmas_natural: Vec<Option<f64>>,
    pub identifiable: Vec<Determined>,
    pub not_identifiable: Vec<Open>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Determined {
    pub combination: String,
    pub unit: String,
    pub value: Option<f64>,
    pub sigma: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Open {
    pub combination: String,
    pub reason: String,
    pub remedy: String,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Fit {
    #[serde(default)]
    pub segment: String,
    pub samples: usize,
    pub chi2_per_dof: Option<f64>,
    channels: Map<String, Value>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct ChannelFit {
    pub rms: Option<f64>,
    #[serde(default)]
    pub unit: String,
    pub chi2_per_number: Option<f64>,
    pub whiteness_p: Option<f64>,
}

/// Entries in the order of the file; one that has another shape is left out.
fn entries<T: serde::de::DeserializeOwned>(map: &Map<String, Value>) -> Vec<(String, T)> {
    map.iter()
        .filter_map(|(name, value)| Some((name.clone(), T::deserialize(value).ok()?)))
        .collect()
}

impl EstimateFile {
    /// Whether numbers were found and are not shown, since the model contradicts the data or did not settle.
    pub fn withheld(&self) -> bool {
        ["rejected", "iteration_limit"].contains(&self.status.as_str())
    }

    pub fn bodies(&self) -> Vec<(String, Body)> {
        entries(&self.bodies)
    }

    pub fn nuisance(&self) -> Vec<(String, Number)> {
        entries(&self.nuisance)
    }

    /// Method with its variant.
    pub fn method(&self) -> String {
        let method = self.method.replace('_', " ");
        match &self.variant {
            Some(variant) => format!("{method} ({variant})"),
            None => method,
        }
    }
}

impl Fit {
    pub fn channels(&self) -> Vec<(String, ChannelFit)> {
        entries(&self.channels)
    }
}

impl Number {
    pub fn is_known(&self) -> bool {
        self.source.as_deref() == Some("known")
    }
}

impl Triple {
    pub fn number(&self, k: usize) -> Number {
        Number {
            value: self.value[k],
            sigma: self.sigma[k],
            nominal: self.nominal[k],
            source: self.source[k].clone(),
        }
    }
}

impl<T> Elements<T> {
    /// In the order of the file.
    pub fn all(&self) -> [(&'static str, &T); 6] {
        [
            ("xx", &self.xx),
            ("yy", &self.yy),
            ("zz", &self.zz),
            ("xy", &self.xy),
            ("xz", &self.xz),
            ("yz", &self.yz),
        ]
    }
}

impl Tensor {
    /// In the order of the file.
    pub fn numbers(&self) -> [(&'static str, Number); 6] {
        let (v, s, n, w) = (
            self.value.all(),
            self.sigma.all(),
            self.nominal.all(),
            self.source.all(),
        );
        std::array::from_fn(|k| {
            let number = Number {
                value: *v[k].1,
                sigma: *s[k].1,
                nominal: *n[k].1,
                source: w[k].1.clone(),
            };
            (v[k].0, number)
        })
    }
}

impl Body {
    /// All ten with name and unit.
    pub fn numbers(&self) -> Vec<(String, &'static str, Number)> {
        let mut all = vec![("mass".to_owned(), "kg", self.mass_kg.clone())];
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            all.push((format!("com {axis}"), "m", self.com_m.number(k)));
        }
        for (element, number) in self.inertia_kg_m2.numbers() {
            all.push((format!("I {element}"), "kg m²", number));
        }
        all
    }

    /// Whether anything of it was asked for.
    pub fn asked(&self) -> bool {
        self.numbers().iter().any(|(_, _, n)| !n.is_known())
    }
}
