//! Writes a checked vehicle as a `poinsot.model/1` file that reads back equal: fills the rows of `file/`.

use crate::file::{
    BodyFile, EnvironmentFile, Gravity, InertiaFile, JointFile, ModeFile, ModeParameter, ModelFile,
    MomentumFile, MomentumVectorFile, MomentumWord, NamesFile, NoiseFile, NuisanceFile,
    NuisanceWord, OrbitFile, Parameter, SensorFile, SensorType, Sigmas, SlopeFile,
    SpringDamperFile, SpringParameter, ThrusterFile, WheelFile, Which,
};
use crate::knowledge::{KnownNumber, Origin};
use crate::vehicle::{
    Body, Environment, FlexibleMode, Joint, JointKind, Model, MomentumKnowledge, Nuisance, Orbit,
    Sensor, SlowError, SpringDamper, SpringNumber, Thruster, Wheel,
};
use poinsot_spatial::{MassProperties, Matrix3, Vector3, principal_axes};
use poinsot_telemetry::TelemetryMap;
use std::collections::HashMap;

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
    crate::toml_text::text(&file_of(model))
}

/// The rows of a file, filled.
pub(crate) fn file_of(model: &Model) -> ModelFile {
    let mut sigmas = uncertainties(model);
    let mut own = |table, k| sigmas.remove(&(table, k));
    let known = &model.knowledge;
    let exact = known.uncertain.is_empty();
    let momentum = MomentumFile {
        linear_N_s: Some(momentum(model.momentum.linear)),
        angular_N_m_s: Some(momentum(model.momentum.angular)),
    };
    let around = &model.environment;
    ModelFile {
        schema: Some(crate::MODEL_SCHEMA.to_owned()),
        name: Some(model.name.clone()),
        source: (!exact && !known.assumed).then_some(Origin::Cad),
        exact: exact.then_some(true),
        nominal_within: known.nominal_within,
        thrust_correlation: Some(known.thrust_correlation).filter(|c| *c > 0.0),
        body: each(&model.bodies, |k, b| body(b, own("body", k))),
        joint: each(&model.joints, |k, j| joint(model, j, own("joint", k))),
        wheel: each(&model.wheels, |k, w| wheel(model, w, own("wheel", k))),
        thruster: each(&model.thrusters, |k, t| {
            thruster(model, t, own("thruster", k))
        }),
        mode: each(&model.modes, |_, m| mode(model, m)),
        panel: None,
        tank: None,
        sensor: each(&model.sensors, |k, s| sensor(model, s, own("sensor", k))),
        momentum: Some(momentum),
        environment: (*around != Environment::default()).then(|| environment(around)),
        telemetry: (model.telemetry != TelemetryMap::default()).then(|| model.telemetry.clone()),
    }
}

/// The entries of a list of tables; none for an empty list.
fn each<T, F>(list: &[T], mut entry: impl FnMut(usize, &T) -> F) -> Option<Vec<F>> {
    let all: Vec<F> = list.iter().enumerate().map(|(k, t)| entry(k, t)).collect();
    (!all.is_empty()).then_some(all)
}

/// Uncertainties that differ from those of a drawing, by table and index.
fn uncertainties(model: &Model) -> HashMap<(&'static str, usize), Sigmas> {
    let uncertain = &model.knowledge.uncertain;
    let known: HashMap<KnownNumber, f64> = uncertain.iter().map(|u| (u.number, u.sigma)).collect();
    let mut all: HashMap<_, Sigmas> = HashMap::new();
    let numbers = model.known_numbers().into_iter();
    for number in numbers.filter(|_| !known.is_empty()) {
        let sigma = known.get(&number).copied().unwrap_or(0.0);
        if sigma != number.usual_sigma(Origin::Cad) {
            let (table, k, key) = number.key();
            all.entry((table, k))
                .or_default()
                .insert(key.to_owned(), sigma);
        }
    }
    all
}

fn body(body: &Body, uncertainty: Option<Sigmas>) -> BodyFile {
    let stands_in = |given: &MassProperties| given.nearest_physical() == body.nominal;
    let told = body.given.filter(stands_in).unwrap_or(body.nominal);
    let (e, I) = (body.estimate, &told.I_BBcm_B);
    let asked = [
        (Parameter::Mass, e.mass),
        (Parameter::Com, e.com),
        (Parameter::Inertia, e.inertia),
    ];
    BodyFile {
        name: Some(body.name.clone()),
        mass_kg: Some(body.nominal.mass),
        com_m: Some(body.nominal.p_BoBcm_B.into()),
        inertia_kg_m2: Some(InertiaFile {
            xx: Some(I[(0, 0)]),
            yy: Some(I[(1, 1)]),
            zz: Some(I[(2, 2)]),
            xy: Some(I[(0, 1)]),
            xz: Some(I[(0, 2)]),
            yz: Some(I[(1, 2)]),
        }),
        estimate: Which::of(asked),
        prior: body.prior,
        uncertainty,
        ..BodyFile::default()
    }
}

fn joint(model: &Model, joint: &Joint, uncertainty: Option<Sigmas>) -> JointFile {
    let locked = joint.locked_at;
    let [turns, slides] =
        [JointKind::Revolute, JointKind::Prismatic].map(|kind| joint.kind == kind);
    JointFile {
        name: Some(joint.name.clone()),
        kind: Some(joint.kind),
        parent: body_name(model, joint.parent),
        child: body_name(model, joint.child),
        origin_m: Some(joint.p_PoCo_P.into()),
        rotation_matrix: rotation(&joint.R_PC_zero),
        axis: (turns || slides).then(|| joint.axis_C.into()),
        locked_at_rad: locked.filter(|_| turns),
        locked_at_m: locked.filter(|_| slides),
        spring_damper: joint
            .spring_damper
            .map(|s| spring_damper(&s, slides, &joint.spring_unknown)),
        uncertainty,
        ..JointFile::default()
    }
}

fn spring_damper(
    spring: &SpringDamper,
    slides: bool,
    unknown: &[SpringNumber],
) -> SpringDamperFile {
    let asked = SpringParameter::ALL.map(|(key, number)| (key, unknown.contains(&number)));
    let numbers = [spring.stiffness, spring.damping, spring.rest].map(Some);
    let [turning, sliding] = match slides {
        true => [[None; 3], numbers],
        false => [numbers, [None; 3]],
    };
    SpringDamperFile {
        stiffness_N_m_per_rad: turning[0],
        stiffness_N_per_m: sliding[0],
        damping_N_m_s_per_rad: turning[1],
        damping_N_s_per_m: sliding[1],
        rest_rad: turning[2],
        rest_m: sliding[2],
        estimate: Which::of(asked),
    }
}

fn wheel(model: &Model, wheel: &Wheel, uncertainty: Option<Sigmas>) -> WheelFile {
    WheelFile {
        name: Some(wheel.name.clone()),
        body: body_name(model, wheel.body),
        axis: Some(wheel.axis_B.into()),
        spin_inertia_kg_m2: Some(wheel.spin_inertia),
        at_rest: wheel.at_rest.then_some(true),
        estimate: wheel.estimate.then_some(true),
        misalignment: nuisance(wheel.misalignment, "sigma_rad"),
        uncertainty,
        ..WheelFile::default()
    }
}

fn thruster(model: &Model, thruster: &Thruster, uncertainty: Option<Sigmas>) -> ThrusterFile {
    let propellant = thruster.propellant.as_ref();
    ThrusterFile {
        name: Some(thruster.name.clone()),
        body: body_name(model, thruster.body),
        position_m: Some(thruster.p_BoT_B.into()),
        force_direction: Some(thruster.direction_B.into()),
        never_fires: thruster.never_fires.then_some(true),
        scale: nuisance(thruster.scale, "sigma"),
        specific_impulse_s: propellant.map(|p| p.specific_impulse),
        propellant_m: propellant.map(|p| p.p_BoF_B.into()),
        uncertainty,
        ..ThrusterFile::default()
    }
}

fn mode(model: &Model, flexible: &FlexibleMode) -> ModeFile {
    let (mode, e) = (&flexible.mode, &flexible.estimate);
    let vector = |v: &Vector3| (*v != Vector3::zeros()).then(|| (*v).into());
    let S = &mode.inertia_slope;
    let asked = [
        (ModeParameter::Frequency, e.frequency),
        (ModeParameter::Damping, e.damping),
        (ModeParameter::Translation, e.translation),
        (ModeParameter::Rotation, e.rotation),
        (ModeParameter::InertiaSlope, e.inertia_slope),
    ];
    ModeFile {
        name: Some(flexible.name.clone()),
        body: body_name(model, mode.body),
        frequency_Hz: Some(mode.frequency_Hz),
        damping_ratio: Some(mode.damping_ratio),
        translation_kg05: vector(&mode.translation),
        rotation_kg05_m: vector(&mode.rotation),
        inertia_slope_kg05_m: (*S != Matrix3::zeros()).then(|| SlopeFile {
            xx: Some(S[(0, 0)]),
            yy: Some(S[(1, 1)]),
            zz: Some(S[(2, 2)]),
            xy: Some(S[(0, 1)]),
            xz: Some(S[(0, 2)]),
            yz: Some(S[(1, 2)]),
        }),
        estimate: Which::of(asked),
    }
}

fn sensor(model: &Model, sensor: &Sensor, uncertainty: Option<Sigmas>) -> SensorFile {
    let unit = model.unit_of(sensor);
    let sigmas = |c: &Matrix3| toml::Value::try_from(noise(c)).ok();
    let (walks, processes): (Vec<&SlowError>, Vec<&SlowError>) =
        sensor.slow.iter().partition(|s| s.is_walk());
    let (walk, process) = (walks.first(), processes.first());
    let lasting = process.and_then(|s| sigmas(&s.covariance));
    let white = sensor.noise_covariance.as_ref().and_then(sigmas);
    // Noise that all lasts has no part of its own.
    let (white, lasting) = match white {
        None => (lasting, None),
        white => (white, lasting),
    };
    let step = Some(sensor.quantisation).filter(|lsb| *lsb > 0.0);
    let errors = [
        (format!("noise_{unit}"), white),
        (format!("slow_{unit}"), lasting),
        (
            format!("walk_{unit}_s05"),
            walk.and_then(|s| sigmas(&s.covariance)),
        ),
        (format!("quantisation_{unit}"), step.map(toml::Value::Float)),
    ];
    let errors = errors.map(|(key, value)| Some((key, value?)));
    let names = sensor.of.iter().filter_map(|k| model.measured(sensor, *k));
    SensorFile {
        name: Some(sensor.name.clone()),
        kind: Some(SensorType(sensor.kind.declared_as())),
        body: body_name(model, sensor.body).filter(|_| sensor.body != 0),
        seen_from: body_name(model, sensor.seen_from).filter(|_| sensor.kind.is_relative()),
        of: (sensor.kind.is_scalar()).then(|| NamesFile::Many(names.map(str::to_owned).collect())),
        sample_errors: errors.into_iter().flatten().collect(),
        correlation_s: process.map(|s| s.correlation_s),
        bias: nuisance(sensor.bias, &format!("sigma_{unit}")),
        scale: nuisance(sensor.scale, "sigma"),
        misalignment: nuisance(sensor.misalignment, "sigma_rad"),
        nonorthogonality: nuisance(sensor.nonorthogonality, "sigma_rad"),
        lag: nuisance(sensor.lag, "sigma_s"),
        rotation_matrix: rotation(&sensor.R_BS),
        position_m: (sensor.p_BoS_B != Vector3::zeros()).then(|| sensor.p_BoS_B.into()),
        reference_N: sensor.reference_N.map(Into::into),
        uncertainty,
        ..SensorFile::default()
    }
}

fn environment(around: &Environment) -> EnvironmentFile {
    EnvironmentFile {
        gravity: around.point_mass_gm.map(|_| Gravity::PointMass),
        gm_m3_s2: around.point_mass_gm,
        gravity_gradient: around.gravity_gradient.then_some(true),
        orbit: around.orbit.as_ref().map(orbit),
        disturbance_torque: nuisance(around.disturbance_torque, "sigma_N_m"),
        disturbance_torque_inertial: nuisance(around.disturbance_torque_inertial, "sigma_N_m"),
        drag_torque: nuisance(around.drag_torque, "sigma_kg_m2"),
        random_torque: around.random_torque,
    }
}

fn orbit(orbit: &Orbit) -> OrbitFile {
    OrbitFile {
        semi_major_axis_m: Some(orbit.semi_major_axis),
        eccentricity: Some(orbit.eccentricity),
        inclination_rad: Some(orbit.inclination),
        raan_rad: Some(orbit.raan),
        argument_of_periapsis_rad: Some(orbit.argument_of_periapsis),
        true_anomaly_rad: Some(orbit.true_anomaly),
        epoch_s: orbit.epoch,
    }
}

fn rotation(R: &Matrix3) -> Option<[[f64; 3]; 3]> {
    (*R != Matrix3::identity()).then(|| R.transpose().into())
}

fn noise(covariance: &Matrix3) -> NoiseFile {
    let diagonal = covariance.diagonal();
    if *covariance == Matrix3::from_diagonal(&diagonal) {
        return match diagonal.iter().all(|v| *v == diagonal.x) {
            true => NoiseFile::Scalar(diagonal.x.sqrt()),
            false => NoiseFile::Axes(diagonal.map(f64::sqrt).into()),
        };
    }
    let (variances, axes) = principal_axes(covariance);
    let sigmas = Vector3::from(variances.map(|v| v.max(0.0).sqrt()));
    let root = axes * Matrix3::from_diagonal(&sigmas) * axes.transpose();
    NoiseFile::Matrix((0.5 * (root + root.transpose())).into())
}

fn nuisance(value: Nuisance, unit_key: &str) -> Option<NuisanceFile> {
    match value {
        Nuisance::Known => None,
        Nuisance::Estimate => Some(NuisanceFile::Word(NuisanceWord::Estimate)),
        Nuisance::Prior(sigma) => {
            let sigmas = Sigmas::from([(unit_key.to_owned(), sigma)]);
            Some(NuisanceFile::Sigma(sigmas))
        }
    }
}

fn momentum(value: MomentumKnowledge) -> MomentumVectorFile {
    match value {
        MomentumKnowledge::Estimate => MomentumVectorFile::Word(MomentumWord::Estimate),
        MomentumKnowledge::Known(v) if v == Vector3::zeros() => {
            MomentumVectorFile::Word(MomentumWord::Zero)
        }
        MomentumKnowledge::Known(v) => MomentumVectorFile::Known(v.into()),
    }
}

fn body_name(model: &Model, body: usize) -> Option<String> {
    model.bodies.get(body).map(|b| b.name.clone())
}
