//! Writes a checked vehicle as a `poinsot.model/1` file that reads back equal.

use crate::knowledge::{KnownNumber, Origin};
use crate::toml_text::{line, number, quoted, section};
use crate::vehicle::{
    Body, EstimateSet, Joint, JointKind, Model, MomentumKnowledge, Nuisance, Sensor, SensorKind,
    Thruster, Wheel,
};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use std::collections::HashMap;

/// One sigma of every uncertain number.
type Sigmas = HashMap<KnownNumber, f64>;

/// The text of a model file. Numbers are written with all their digits; `notes` are not written.
///
/// Anisotropic noise in rotated axes is written as a square root and reads back to round-off; everything else reads
/// back exactly.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// // What is written reads back equal.
/// let again = parse_model(&write_model(&model), "again.toml")?;
/// assert_eq!(again.bodies, model.bodies);
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn write_model(model: &Model) -> String {
    let mut out = String::new();
    line(&mut out, "schema", quoted(crate::MODEL_SCHEMA));
    line(&mut out, "name", quoted(&model.name));
    if model.knowledge.uncertain.is_empty() {
        line(&mut out, "exact", "true".to_owned());
    } else if !model.knowledge.assumed {
        line(&mut out, "source", quoted(Origin::Cad.word()));
    }
    if let Some(factor) = model.knowledge.nominal_within {
        line(&mut out, "nominal_within", number(factor));
    }
    let known = model.knowledge.uncertain.iter();
    let known: Sigmas = known.map(|u| (u.number, u.sigma)).collect();
    for (k, body) in model.bodies.iter().enumerate() {
        write_body(&mut out, body);
        let numbers = [
            ("mass", KnownNumber::Mass(k)),
            ("com_m", KnownNumber::MassCentre(k)),
            ("inertia", KnownNumber::Inertia(k)),
        ];
        uncertainty(&mut out, &known, &numbers);
    }
    for (k, joint) in model.joints.iter().enumerate() {
        write_joint(&mut out, model, joint);
        let numbers = [
            ("origin_m", KnownNumber::JointOrigin(k)),
            ("axis_rad", KnownNumber::JointAxis(k)),
        ];
        uncertainty(&mut out, &known, &numbers);
    }
    for (k, wheel) in model.wheels.iter().enumerate() {
        write_wheel(&mut out, model, wheel);
        let numbers = [
            ("spin_inertia", KnownNumber::SpinInertia(k)),
            ("axis_rad", KnownNumber::WheelAxis(k)),
        ];
        uncertainty(&mut out, &known, &numbers);
    }
    for (k, thruster) in model.thrusters.iter().enumerate() {
        write_thruster(&mut out, model, thruster);
        let numbers = [
            ("force", KnownNumber::Force(k)),
            ("direction_rad", KnownNumber::ForceDirection(k)),
            ("position_m", KnownNumber::ForcePosition(k)),
            ("specific_impulse", KnownNumber::SpecificImpulse(k)),
            ("propellant_m", KnownNumber::PropellantPlace(k)),
        ];
        let without_propellant = &numbers[..3];
        let numbers = match thruster.propellant {
            Some(_) => numbers.as_slice(),
            None => without_propellant,
        };
        uncertainty(&mut out, &known, numbers);
    }
    for (k, sensor) in model.sensors.iter().enumerate() {
        write_sensor(&mut out, model, sensor);
        if sensor.turns() {
            uncertainty(
                &mut out,
                &known,
                &[("mounting_rad", KnownNumber::Mounting(k))],
            );
        }
    }
    section(&mut out, "[momentum]");
    line(&mut out, "linear_N_s", momentum(model.momentum.linear));
    line(&mut out, "angular_N_m_s", momentum(model.momentum.angular));
    write_environment(&mut out, model);
    crate::write_telemetry::write_telemetry(&mut out, &model.telemetry);
    out
}

fn write_wheel(out: &mut String, model: &Model, wheel: &Wheel) {
    section(out, "[[wheel]]");
    line(out, "name", quoted(&wheel.name));
    line(out, "body", body_name(model, wheel.body));
    line(out, "axis", vector(&wheel.axis_B));
    line(out, "spin_inertia_kg_m2", number(wheel.spin_inertia));
    if wheel.estimate {
        line(out, "estimate", "true".to_owned());
    }
    nuisance(out, "misalignment", wheel.misalignment, "sigma_rad");
}

fn write_thruster(out: &mut String, model: &Model, thruster: &Thruster) {
    section(out, "[[thruster]]");
    line(out, "name", quoted(&thruster.name));
    line(out, "body", body_name(model, thruster.body));
    line(out, "position_m", vector(&thruster.p_BoT_B));
    line(out, "force_direction", vector(&thruster.direction_B));
    if let Some(propellant) = &thruster.propellant {
        let specific = propellant.specific_impulse;
        line(out, "specific_impulse_s", number(specific));
        line(out, "propellant_m", vector(&propellant.p_BoF_B));
    }
    nuisance(out, "scale", thruster.scale, "sigma");
}

/// Uncertainties of one table that differ from those of a drawing.
fn uncertainty(out: &mut String, known: &Sigmas, numbers: &[(&str, KnownNumber)]) {
    if known.is_empty() {
        return;
    }
    let entries: Vec<String> = numbers
        .iter()
        .filter_map(|(key, of)| {
            let sigma = known.get(of).copied().unwrap_or(0.0);
            (sigma != of.usual_sigma(Origin::Cad)).then(|| format!("{key} = {}", number(sigma)))
        })
        .collect();
    if !entries.is_empty() {
        line(out, "uncertainty", format!("{{ {} }}", entries.join(", ")));
    }
}

fn write_body(out: &mut String, body: &Body) {
    section(out, "[[body]]");
    line(out, "name", quoted(&body.name));
    line(out, "mass_kg", number(body.nominal.mass));
    line(out, "com_m", vector(&body.nominal.p_BoBcm_B));
    line(out, "inertia_kg_m2", inertia(&body.nominal.I_BBcm_B));
    if body.estimate == EstimateSet::ALL {
        line(out, "estimate", "true".to_owned());
    } else if body.estimate.any() {
        let e = body.estimate;
        let words = [
            ("\"mass\"", e.mass),
            ("\"com\"", e.com),
            ("\"inertia\"", e.inertia),
        ];
        let words: Vec<&str> = words
            .iter()
            .filter(|(_, on)| *on)
            .map(|(w, _)| *w)
            .collect();
        line(out, "estimate", format!("[{}]", words.join(", ")));
    }
    if let Some(prior) = &body.prior {
        let sigmas = [
            ("mass_kg", prior.mass),
            ("com_m", prior.com),
            ("inertia_kg_m2", prior.inertia),
            ("entropic", prior.entropic),
        ];
        let sigmas: Vec<String> = sigmas
            .iter()
            .filter_map(|(name, sigma)| Some(format!("{name} = {}", number((*sigma)?))))
            .collect();
        line(out, "prior", format!("{{ {} }}", sigmas.join(", ")));
    }
}

fn write_joint(out: &mut String, model: &Model, joint: &Joint) {
    section(out, "[[joint]]");
    line(out, "name", quoted(&joint.name));
    let (kind, locked_at) = match joint.kind {
        JointKind::Revolute => ("revolute", "locked_at_rad"),
        JointKind::Prismatic => ("prismatic", "locked_at_m"),
        JointKind::Fixed => ("fixed", ""),
    };
    line(out, "type", quoted(kind));
    line(out, "parent", body_name(model, joint.parent));
    line(out, "child", body_name(model, joint.child));
    line(out, "origin_m", vector(&joint.p_PoCo_P));
    if joint.R_PC_zero != Matrix3::identity() {
        line(out, "rotation_matrix", matrix(&joint.R_PC_zero));
    }
    if joint.kind != JointKind::Fixed {
        line(out, "axis", vector(&joint.axis_C));
        if joint.locked_at != 0.0 {
            line(out, locked_at, number(joint.locked_at));
        }
        if let Some(spring) = &joint.spring_damper {
            let keys = match joint.kind {
                JointKind::Prismatic => ["stiffness_N_per_m", "damping_N_s_per_m", "rest_m"],
                _ => ["stiffness_N_m_per_rad", "damping_N_m_s_per_rad", "rest_rad"],
            };
            let numbers = [spring.stiffness, spring.damping, spring.rest].map(number);
            let entries: Vec<String> = keys
                .iter()
                .zip(&numbers)
                .map(|(key, number)| format!("{key} = {number}"))
                .collect();
            line(
                out,
                "spring_damper",
                format!("{{ {} }}", entries.join(", ")),
            );
        }
    }
}

fn write_sensor(out: &mut String, model: &Model, sensor: &Sensor) {
    section(out, "[[sensor]]");
    line(out, "name", quoted(&sensor.name));
    line(out, "type", quoted(sensor.kind.declared_as().word()));
    if sensor.body != 0 {
        line(out, "body", body_name(model, sensor.body));
    }
    if sensor.kind.is_relative() {
        line(out, "seen_from", body_name(model, sensor.seen_from));
    }
    if sensor.kind.is_scalar() {
        let names: Vec<String> = sensor
            .of
            .iter()
            .map(|k| read_name(model, sensor.kind, *k))
            .collect();
        line(out, "of", format!("[{}]", names.join(", ")));
    }
    let unit = model.unit_of(sensor);
    if let Some(covariance) = &sensor.noise_covariance {
        line(out, &format!("noise_{unit}"), noise(covariance));
    }
    if sensor.correlation_s > 0.0 {
        line(out, "correlation_s", number(sensor.correlation_s));
    }
    if sensor.quantisation > 0.0 {
        line(
            out,
            &format!("quantisation_{unit}"),
            number(sensor.quantisation),
        );
    }
    nuisance(out, "bias", sensor.bias, &format!("sigma_{unit}"));
    nuisance(out, "scale", sensor.scale, "sigma");
    nuisance(out, "misalignment", sensor.misalignment, "sigma_rad");
    nuisance(
        out,
        "nonorthogonality",
        sensor.nonorthogonality,
        "sigma_rad",
    );
    nuisance(out, "lag", sensor.lag, "sigma_s");
    if sensor.R_BS != Matrix3::identity() {
        line(out, "rotation_matrix", matrix(&sensor.R_BS));
    }
    if sensor.p_BoS_B != Vector3::zeros() {
        line(out, "position_m", vector(&sensor.p_BoS_B));
    }
    if let Some(reference) = &sensor.reference_N {
        line(out, "reference_N", vector(reference));
    }
}

fn write_environment(out: &mut String, model: &Model) {
    let environment = &model.environment;
    if *environment == crate::Environment::default() {
        return;
    }
    section(out, "[environment]");
    if let Some(gm) = environment.point_mass_gm {
        line(out, "gravity", quoted("point_mass"));
        line(out, "gm_m3_s2", number(gm));
    }
    if environment.gravity_gradient {
        line(out, "gravity_gradient", "true".to_owned());
    }
    if let Some(orbit) = &environment.orbit {
        let elements = [
            ("semi_major_axis_m", Some(orbit.semi_major_axis)),
            ("eccentricity", Some(orbit.eccentricity)),
            ("inclination_rad", Some(orbit.inclination)),
            ("raan_rad", Some(orbit.raan)),
            (
                "argument_of_periapsis_rad",
                Some(orbit.argument_of_periapsis),
            ),
            ("true_anomaly_rad", Some(orbit.true_anomaly)),
            ("epoch_s", orbit.epoch),
        ];
        let elements = elements
            .iter()
            .filter_map(|(key, x)| Some(format!("{key} = {}", number((*x)?))));
        let elements: Vec<String> = elements.collect();
        line(out, "orbit", format!("{{ {} }}", elements.join(", ")));
    }
    nuisance(
        out,
        "disturbance_torque_inertial",
        environment.disturbance_torque_inertial,
        "sigma_N_m",
    );
    nuisance(
        out,
        "disturbance_torque",
        environment.disturbance_torque,
        "sigma_N_m",
    );
    nuisance(out, "drag_torque", environment.drag_torque, "sigma_kg_m2");
    if let Some(random) = &environment.random_torque {
        let value = format!(
            "{{ sigma_N_m = {:?}, correlation_s = {:?} }}",
            random.sigma_N_m, random.correlation_s
        );
        line(out, "random_torque", value);
    }
}

fn vector(v: &Vector3) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

fn matrix(m: &Matrix3) -> String {
    let rows: Vec<String> = m.row_iter().map(|row| vector(&row.transpose())).collect();
    format!("[{}]", rows.join(", "))
}

fn inertia(i: &Matrix3) -> String {
    format!(
        "{{ xx = {}, yy = {}, zz = {}, xy = {}, xz = {}, yz = {} }}",
        number(i[(0, 0)]),
        number(i[(1, 1)]),
        number(i[(2, 2)]),
        number(i[(0, 1)]),
        number(i[(0, 2)]),
        number(i[(1, 2)])
    )
}

fn noise(covariance: &Matrix3) -> String {
    let diagonal = covariance.diagonal();
    if *covariance == Matrix3::from_diagonal(&diagonal) {
        return if diagonal.iter().all(|v| *v == diagonal.x) {
            number(diagonal.x.sqrt())
        } else {
            vector(&diagonal.map(f64::sqrt))
        };
    }
    let (variances, axes) = MassProperties {
        mass: 1.0,
        p_BoBcm_B: Vector3::zeros(),
        I_BBcm_B: *covariance,
    }
    .principal();
    let sigmas = Vector3::from(variances.map(|v| v.max(0.0).sqrt()));
    let root = axes * Matrix3::from_diagonal(&sigmas) * axes.transpose();
    matrix(&(0.5 * (root + root.transpose())))
}

fn nuisance(out: &mut String, key: &str, value: Nuisance, unit_key: &str) {
    match value {
        Nuisance::Known => {}
        Nuisance::Estimate => line(out, key, quoted("estimate")),
        Nuisance::Prior(sigma) => line(out, key, format!("{{ {unit_key} = {} }}", number(sigma))),
    }
}

fn momentum(value: MomentumKnowledge) -> String {
    match value {
        MomentumKnowledge::Estimate => quoted("estimate"),
        MomentumKnowledge::Known(v) if v == Vector3::zeros() => quoted("zero"),
        MomentumKnowledge::Known(v) => vector(&v),
    }
}

fn body_name(model: &Model, body: usize) -> String {
    quoted(model.bodies.get(body).map_or("", |b| b.name.as_str()))
}

/// Name of the joint, wheel or thruster measured by a sensor.
fn read_name(model: &Model, kind: SensorKind, k: usize) -> String {
    let name = match kind {
        SensorKind::WheelSpeed => model.wheels.get(k).map(|w| w.name.as_str()),
        SensorKind::Thrust => model.thrusters.get(k).map(|t| t.name.as_str()),
        _ => model.joints.get(k).map(|j| j.name.as_str()),
    };
    quoted(name.unwrap_or(""))
}
