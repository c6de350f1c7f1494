use schemars::JsonSchema;
use serde::Deserialize;

/// Knowledge of a nuisance parameter.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum NuisanceFile {
    /// A word.
    Word(NuisanceWord),
    /// One sigma about the nominal value.
    Sigma(Box<SigmaFile>),
}

/// Known or unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum NuisanceWord {
    /// Taken as exact.
    None,
    /// Unknown.
    Estimate,
}

/// One sigma about the nominal value; exactly one key, in the unit of the number.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(crate) struct SigmaFile {
    /// One sigma of a scale factor, no unit.
    pub sigma: Option<f64>,
    /// One sigma, rad.
    pub sigma_rad: Option<f64>,
    /// One sigma, rad/s.
    pub sigma_rad_s: Option<f64>,
    /// One sigma, m.
    pub sigma_m: Option<f64>,
    /// One sigma, m/s.
    pub sigma_m_s: Option<f64>,
    /// One sigma, m/s2.
    pub sigma_m_s2: Option<f64>,
    /// One sigma, N.
    pub sigma_N: Option<f64>,
    /// One sigma, N m.
    pub sigma_N_m: Option<f64>,
    /// One sigma of a coefficient of drag, kg m2.
    pub sigma_kg_m2: Option<f64>,
    /// One sigma of a lag, s.
    pub sigma_s: Option<f64>,
}

impl SigmaFile {
    /// Every key with its value.
    pub fn entries(&self) -> [(&'static str, Option<f64>); 10] {
        [
            ("sigma", self.sigma),
            ("sigma_rad", self.sigma_rad),
            ("sigma_rad_s", self.sigma_rad_s),
            ("sigma_m", self.sigma_m),
            ("sigma_m_s", self.sigma_m_s),
            ("sigma_m_s2", self.sigma_m_s2),
            ("sigma_N", self.sigma_N),
            ("sigma_N_m", self.sigma_N_m),
            ("sigma_kg_m2", self.sigma_kg_m2),
            ("sigma_s", self.sigma_s),
        ]
    }
}
