//! The ten numbers of a body: mass, mass centre and the elements of the central inertia in the order of [`elements`].

use poinsot_dynamics::{Kinematics, composite};
use poinsot_identify::{BodyEstimate, Estimate, NamedNumber, Number, Source};
use poinsot_model::{Body, Model};
use poinsot_spatial::{InertialParameters, MassProperties, Vector3, elements, tensor};

/// Names of the ten numbers in an answer.
pub(crate) const TEN: [&str; 10] = [
    "mass",
    "com_x",
    "com_y",
    "com_z",
    "inertia_xx",
    "inertia_xy",
    "inertia_yy",
    "inertia_xz",
    "inertia_yz",
    "inertia_zz",
];

/// Units of the ten numbers.
pub(crate) const UNITS: [&str; 10] = [
    "kg", "m", "m", "m", "kg m2", "kg m2", "kg m2", "kg m2", "kg m2", "kg m2",
];

/// The ten numbers.
pub(crate) fn ten(body: &MassProperties) -> [f64; 10] {
    let c = &body.p_BoBcm_B;
    let [xx, xy, yy, xz, yz, zz] = elements(&body.I_BBcm_B);
    [body.mass, c.x, c.y, c.z, xx, xy, yy, xz, yz, zz]
}

/// The body of ten numbers.
pub(crate) fn body([mass, x, y, z, inertia @ ..]: [f64; 10]) -> MassProperties {
    MassProperties {
        mass,
        p_BoBcm_B: Vector3::new(x, y, z),
        I_BBcm_B: tensor(inertia),
    }
}

/// The ten numbers of a body of an answer.
pub(crate) fn ten_of(body: &BodyEstimate) -> [Number; 10] {
    let mut ten = [body.mass; 10];
    ten[1..4].copy_from_slice(&body.com);
    ten[4..].copy_from_slice(&body.inertia);
    ten
}

/// The natural units of the ten numbers of a body: m, L, m L^2.
pub(crate) fn natural_ten(body: &MassProperties) -> [f64; 10] {
    let (m, L) = (body.mass, body.radius_of_gyration());
    std::array::from_fn(|k| match k {
        0 => m,
        1..=3 => L,
        _ => m * L * L,
    })
}

/// A number of a method's report, without sigma.
pub(crate) fn printed(name: String, unit: &'static str, value: f64, nominal: f64) -> NamedNumber {
    NamedNumber {
        name,
        unit,
        number: Number {
            value: value.is_finite().then_some(value),
            sigma: None,
            nominal,
            source: Source::Data,
        },
    }
}

/// Bodies by a published method: its determined numbers, otherwise the numbers that it prints, otherwise nominal ones.
///
/// ```
#[doc = include_str!("../doc/record.txt")]
/// let input = record("linear", "ma2008/model.toml", "ma2008/traj1/telemetry.parquet")?;
/// let estimate = poinsot_identify::linear(&problem(&input))?;
/// let bodies = answered(&input.model, &estimate);
/// // The base was unknown, the arm keeps its nominal numbers.
/// assert!((bodies[0].mass - 1000.0).abs() < 1.0);
/// assert_eq!(bodies[1], input.model.bodies[1].nominal);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn answered(model: &Model, estimate: &Estimate) -> Vec<MassProperties> {
    let report = estimate.method_report.as_ref();
    let printed = |name: &str| {
        let report = report.filter(|_| model.bodies.len() == 1)?;
        report.numbers.iter().find(|n| n.name == name)?.number.value
    };
    let bodies = model.bodies.iter().zip(&estimate.bodies);
    let best = |(model, answer): (&Body, &BodyEstimate)| {
        let numbers = ten_of(answer);
        let number = |k: usize| {
            let value = numbers[k].value.or_else(|| printed(TEN[k]));
            value.unwrap_or(numbers[k].nominal)
        };
        match answer.asked {
            true => body(std::array::from_fn(number)),
            false => model.nominal,
        }
    };
    bodies.map(best).collect()
}

/// All bodies summed about the base origin, in the given configuration.
pub(crate) fn as_one(bodies: &[InertialParameters], kinematics: &Kinematics) -> InertialParameters {
    let c = composite(bodies, kinematics);
    InertialParameters {
        mass: c.mass,
        mc_B: c.mc,
        I_BBo_B: c.I_SBo_B,
    }
}
