//! The reference orbit at the grid times: from telemetry, or from the elements in the model.

use super::BindError;
use super::channels::Channels;
use nalgebra::Vector3;
use poinsot_dynamics::orbit_state;
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::{differentiate, resample, resample_hermite};

/// Position and velocity in N, m and m/s, at one time; `None` if telemetry has no value there.
type OrbitPoint = Option<(Vector3<f64>, Vector3<f64>)>;

/// Half-width of the polynomial that differentiates positions, in samples.
const HALF_WIDTH: usize = 2;

/// The orbit at every time of the grid; empty without gravity gradient.
pub(super) fn orbit_at(model: &Model, channels: &Channels, grid: &[f64]) -> Vec<OrbitPoint> {
    let around = &model.environment;
    let Some(gm) = around.point_mass_gm.filter(|_| around.gravity_gradient) else {
        return Vec::new();
    };
    let axis = |k: &str| channels.find(None, &format!("orbit_{k}"));
    if let (Some(x), Some(y), Some(z)) = (axis("x"), axis("y"), axis("z")) {
        let columns = [x, y, z].map(|c| {
            let rate = differentiate(c, HALF_WIDTH, None);
            (
                resample_hermite(c, &rate, grid, None),
                resample(&rate, grid, None),
            )
        });
        let at = |k: usize| -> OrbitPoint {
            let [x, y, z] = &columns;
            Some((
                Vector3::new(x.0[k]?, y.0[k]?, z.0[k]?),
                Vector3::new(x.1[k]?, y.1[k]?, z.1[k]?),
            ))
        };
        return (0..grid.len()).map(at).collect();
    }
    let Some(orbit) = &around.orbit else {
        return vec![None; grid.len()];
    };
    grid.iter()
        .map(|t| Some(orbit_state(gm, orbit, *t)))
        .collect()
}

/// Reports the source of the orbit; a gravity gradient needs one.
///
/// # Errors
/// Neither columns nor elements are given.
pub(super) fn check_orbit(
    model: &Model,
    channels: &Channels,
    repairs: &mut Vec<String>,
) -> Result<(), BindError> {
    let around = &model.environment;
    let positions = model.sensors_of(SensorKind::Position).next().is_some();
    if around.point_mass_gm.is_some() && !around.gravity_gradient && !positions {
        return Err(BindError::Unsupported {
            what: "[environment] gravity = \"point_mass\" alone has no effect: N is in free fall with the vehicle; add gravity_gradient = true, or remove it".to_owned(),
        });
    }
    if !around.gravity_gradient {
        return Ok(());
    }
    let read = ["orbit_x", "orbit_y", "orbit_z"]
        .iter()
        .all(|name| channels.find(None, name).is_some());
    match (read, around.orbit.is_some()) {
        (false, false) => Err(channels.missing(
            "orbit_x orbit_y orbit_z",
            "the gravity gradient needs the orbit; add its positions from the attracting body in inertial axes, m, or its elements as [environment] orbit",
        )),
        (true, true) => {
            repairs.push(format!(
                "{}: orbit from its columns, not from the elements of the model",
                channels.label
            ));
            Ok(())
        }
        _ => Ok(()),
    }
}
