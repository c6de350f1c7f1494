//! Numbers and covariance for on-board software: determined numbers only.

use super::{Exported, Source};
use crate::error::Error;
use poinsot_formats::{ONBOARD, OnboardBodyFile, OnboardFile};

pub(super) fn text(source: &Source) -> Result<Exported, Error> {
    let e = source.estimate;
    let (bodies, left_out) = source.bodies();
    if bodies.is_empty() {
        return Err(source.nothing(&left_out, ""));
    }
    let body = |found: &poinsot_model::BodyProperties| {
        let own = &found.properties;
        let numbers = OnboardBodyFile {
            mass_kg: own.mass,
            com_m: own.p_BoBcm_B.into(),
            inertia_kg_m2: [0, 1, 2].map(|i| [0, 1, 2].map(|j| own.I_BBcm_B[(i, j)])),
        };
        (found.body.clone(), numbers)
    };
    let finite = |row: &Vec<Option<f64>>| row.iter().copied().collect::<Option<Vec<f64>>>();
    let matrix: Option<Vec<Vec<f64>>> = e.covariance.matrix.iter().map(finite).collect();
    let file = OnboardFile {
        schema: ONBOARD.to_owned(),
        poinsot: e.poinsot.clone(),
        model: e.model.clone(),
        epoch: e.epoch.clone(),
        reliable: e.unreliable().is_empty(),
        bodies: bodies.iter().map(body).collect(),
        covariance_names: e.covariance.names.clone(),
        covariance_units: e.covariance.units.clone(),
        covariance: matrix.ok_or_else(|| {
            source.fault("its covariance is incomplete", "identify with more data")
        })?,
    };
    let mut text =
        serde_json::to_string_pretty(&file).map_err(|e| source.fault(&e.to_string(), ""))?;
    text.push('\n');
    Ok(Exported {
        text,
        left_out,
        ..Exported::default()
    })
}
