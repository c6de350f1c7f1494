//! The reference orbit: a Kepler ellipse in N.

#[cfg(not(feature = "std"))]
use nalgebra::{ComplexField, RealField};
use poinsot_spatial::Vector3;

/// A Kepler ellipse about the attracting body, in the inertial axes N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Semi-major axis, m.
    pub semi_major_axis: f64,
    /// Eccentricity, below 1.
    pub eccentricity: f64,
    /// Inclination to the xy plane of N, rad.
    pub inclination: f64,
    /// Right ascension of the ascending node from x of N, rad.
    pub raan: f64,
    /// Argument of periapsis from the node, rad.
    pub argument_of_periapsis: f64,
    /// True anomaly at the epoch, rad.
    pub true_anomaly: f64,
    /// Epoch, s; `None` is the zero of the times.
    pub epoch: Option<f64>,
}

/// Most Newton steps of Kepler's equation.
const STEPS: usize = 50;

/// Position from the attracting body's centre, m, and velocity, m/s, in N at a time, s.
///
/// `E - e sin E = M` by Newton's method from `M + e sin M` (Vallado 2013, algorithm 2), then the perifocal position
/// turned by argument of periapsis, inclination and node.
///
/// ```
/// use poinsot_dynamics::{Orbit, orbit_state};
/// use std::f64::consts::PI;
///
/// let (gm, a) = (3.986_004_418e14, 7.0e6_f64);
/// let orbit = Orbit {
///     semi_major_axis: a,
///     eccentricity: 0.0,
///     inclination: 0.0,
///     raan: 0.0,
///     argument_of_periapsis: 0.0,
///     true_anomaly: 0.0,
///     epoch: None,
/// };
/// // A circle: half a period later the vehicle is on the other side, with the same speed.
/// let half_period = PI * (a * a * a / gm).sqrt();
/// let (p, v) = orbit_state(gm, &orbit, half_period);
/// assert!((p.x + a).abs() < 1.0e-6 * a);
/// assert!((v.norm() - (gm / a).sqrt()).abs() < 1.0e-6);
/// ```
pub fn orbit_state(gm: f64, orbit: &Orbit, time: f64) -> (Vector3, Vector3) {
    let (a, e) = (orbit.semi_major_axis, orbit.eccentricity);
    let n = (gm / a.powi(3)).sqrt();
    let root = (1.0 - e * e).sqrt();
    let (s, c) = orbit.true_anomaly.sin_cos();
    let E0 = (root * s).atan2(e + c);
    let M = E0 - e * E0.sin() + n * (time - orbit.epoch.unwrap_or(0.0));
    let mut E = M + e * M.sin();
    for _ in 0..STEPS {
        let step = (E - e * E.sin() - M) / (1.0 - e * E.cos());
        E -= step;
        if step.abs() < 1.0e-15 * (1.0 + E.abs()) {
            break;
        }
    }
    let (s, c) = E.sin_cos();
    let (toward, across) = perifocal_axes(orbit);
    let rate = n / (1.0 - e * c);
    (
        (toward * (c - e) + across * (root * s)) * a,
        (across * (root * c) - toward * s) * (a * rate),
    )
}

/// Unit vectors to the periapsis and perpendicular to it in the orbit plane, in N.
fn perifocal_axes(orbit: &Orbit) -> (Vector3, Vector3) {
    let (so, co) = orbit.raan.sin_cos();
    let (si, ci) = orbit.inclination.sin_cos();
    let (sw, cw) = orbit.argument_of_periapsis.sin_cos();
    let node = Vector3::new(co, so, 0.0);
    let up = Vector3::new(-so * ci, co * ci, si);
    (node * cw + up * sw, up * cw - node * sw)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GM: f64 = 3.986004418e14;

    #[test]
    fn exact_orbit_keeps_energy_momentum_and_the_law_of_gravity() {
        let orbit = Orbit {
            semi_major_axis: 8.0e6,
            eccentricity: 0.3,
            inclination: 1.1,
            raan: -0.7,
            argument_of_periapsis: 2.2,
            true_anomaly: 0.4,
            epoch: Some(30.0),
        };
        let (r0, v0) = orbit_state(GM, &orbit, 30.0);
        let h = r0.cross(&v0);
        // Position at the epoch from the conic section.
        let p = 8.0e6 * (1.0 - 0.09);
        assert!((r0.norm() - p / (1.0 + 0.3 * 0.4_f64.cos())).abs() < 1.0e-6);
        assert!((h.normalize().z - 1.1_f64.cos()).abs() < 1.0e-14);
        for k in 0..20 {
            let t = 500.0 * f64::from(k);
            let (r, v) = orbit_state(GM, &orbit, t);
            let energy = 0.5 * v.norm_squared() - GM / r.norm();
            assert!((energy / (-GM / 1.6e7) - 1.0).abs() < 1.0e-13);
            assert!((r.cross(&v) - h).norm() < 1.0e-13 * h.norm());
            let d = 1.0;
            let pull =
                (orbit_state(GM, &orbit, t + d).1 - orbit_state(GM, &orbit, t - d).1) / (2.0 * d);
            let law = -r * (GM / r.norm().powi(3));
            assert!((pull - law).norm() < 1.0e-6 * law.norm());
        }
    }
}
