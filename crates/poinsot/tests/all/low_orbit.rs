//! Position and velocity on an orbit, as from a receiver: no reference orbit, no gap, one segment.

use poinsot::case::parse_case;
use poinsot::simulate::simulate_case;
use poinsot::{Question, estimate_file, identify_tables};
use poinsot_model::{Model, SensorKind, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};

const GM: f64 = 3.986_004_418e14;
const RADIUS: f64 = 6_378_136.6;
const J2: f64 = 1.082_635_9e-3;

/// Gradient of the potential of a point mass with J2 by differences: the definition, not the program's formula.
fn gravity(r: &Vector3) -> Vector3 {
    let potential = |r: Vector3| {
        let (d, s) = (r.norm(), r.z / r.norm());
        GM / d * (1.0 - J2 * (RADIUS / d).powi(2) * (1.5 * s * s - 0.5))
    };
    let step = 50.0;
    Vector3::from_fn(|k, _| {
        let mut e = Vector3::zeros();
        e[k] = step;
        let (near, far) = (
            potential(r + e) - potential(r - e),
            potential(r + e * 2.0) - potential(r - e * 2.0),
        );
        (8.0 * near - far) / (12.0 * step)
    })
}

fn vector(table: &Table, prefix: &str, k: usize) -> Vector3 {
    let axis = |a: &str| table.channel(&format!("{prefix}_{a}")).unwrap().values[k];
    Vector3::new(axis("x"), axis("y"), axis("z"))
}

/// Adds an orbit in free fall to a motion: the added position obeys `z'' = g(x + z)`, the gravity at the vehicle.
fn on_orbit(table: &mut Table) {
    let times = table.channel("r_x").unwrap().time_s.clone();
    let mut z = Vector3::new(6.2e6, -2.0e6, 2.3e6);
    let mut w = Vector3::new(3.1e3, 6.4e3, -2.8e3);
    let mut rows = vec![(z, w)];
    for k in 1..times.len() {
        let h = times[k] - times[k - 1];
        let (a, b) = (vector(table, "r", k - 1), vector(table, "r", k));
        let fall = |s: f64, z: Vector3| gravity(&(z + a * (1.0 - s) + b * s));
        // Fourth-order Runge-Kutta.
        let (w1, g1) = (w, fall(0.0, z));
        let (w2, g2) = (w + g1 * (h / 2.0), fall(0.5, z + w1 * (h / 2.0)));
        let (w3, g3) = (w + g2 * (h / 2.0), fall(0.5, z + w2 * (h / 2.0)));
        let (w4, g4) = (w + g3 * h, fall(1.0, z + w3 * h));
        z += (w1 + w2 * 2.0 + w3 * 2.0 + w4) * (h / 6.0);
        w += (g1 + g2 * 2.0 + g3 * 2.0 + g4) * (h / 6.0);
        rows.push((z, w));
    }
    for channel in &mut table.channels {
        let axis = |name: &str| ["x", "y", "z"].iter().position(|a| name.ends_with(a));
        let pick: fn(&(Vector3, Vector3)) -> Vector3 = match channel.name.split('_').next() {
            Some("r") => |row| row.0,
            Some("v") => |row| row.1,
            _ => continue,
        };
        let k = axis(&channel.name).unwrap();
        for (x, row) in channel.values.iter_mut().zip(&rows) {
            *x += pick(row)[k];
        }
    }
}

fn flown() -> (Model, Table) {
    let path: PathBuf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases/tug_thrusters.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("duration_s = 120.0", "duration_s = 600.0");
    let case = parse_case(&path, text.replace("rate_hz = 10", "rate_hz = 4")).unwrap();
    let mut model = read_model(&case.model).unwrap();
    // A receiver with carrier-phase measurements.
    for sensor in &mut model.sensors {
        if sensor.kind == SensorKind::Position {
            sensor.noise_covariance = Some(poinsot_spatial::Matrix3::identity() * 0.02 * 0.02);
        }
    }
    let mut table = simulate_case(&case, &model).unwrap().table;
    on_orbit(&mut table);
    model.environment.point_mass_gm = Some(GM);
    (model, table)
}

#[test]
fn exact_ten_minutes_of_low_orbit_are_one_segment() {
    let (model, table) = flown();
    assert!(vector(&table, "r", 0).norm() > 6.9e6 && vector(&table, "v", 0).norm() > 7.0e3);
    let truth = model.bodies[0].nominal;
    let identified = identify_tables(model, vec![table], &Question::default()).unwrap();
    let file = estimate_file(&identified);
    assert_eq!(
        (file.status.as_str(), file.fit.len()),
        ("converged", 1),
        "{:?}",
        file.doubts
    );
    assert!(file.doubts.is_empty(), "{:?}", file.doubts);
    let said = file.repairs.join(";");
    assert!(
        said.contains("relative to free fall") && said.contains("3 m over the record"),
        "{said}"
    );
    let bus = &file.bodies["bus"];
    let wanted = [
        truth.mass,
        truth.p_BoBcm_B.x,
        truth.p_BoBcm_B.y,
        truth.p_BoBcm_B.z,
    ];
    for ((name, _, number), wanted) in bus.addressed("bus").into_iter().zip(wanted) {
        let (value, sigma) = (number.value.unwrap(), number.sigma.unwrap());
        assert!(
            (value - wanted).abs() < 3.5 * sigma,
            "{name}: {value} +- {sigma}, {wanted}"
        );
    }
}

#[test]
fn unit_a_momentum_given_beside_an_orbit_is_refused() {
    let (mut model, table) = flown();
    model.momentum.linear = poinsot_model::MomentumKnowledge::Known(Vector3::zeros());
    let error = identify_tables(model, vec![table], &Question::default())
        .err()
        .unwrap();
    assert!(
        error
            .to_string()
            .contains("write linear_N_s = \"estimate\""),
        "{error}"
    );
}
