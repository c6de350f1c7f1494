//! Flexible modes: numbers of each, and that the vehicle can carry them.

use crate::check_rotation::check_axis;
use crate::file::{
    ModeEstimateFile, ModeFile, ModeParameter, ModelFile, PanelFile, SlopeFile, TankFile,
};
use crate::finding::{Findings, Key};
use crate::vehicle::{FlexibleMode, Mode, ModeEstimate, Model};
use poinsot_dynamics::propagation::MOST_MODES;
use poinsot_dynamics::{Composite, Kinematics, Vehicle, composite};
use poinsot_files::short;
use poinsot_spatial::{Matrix3, Matrix6, Vector3, Vector6};
use std::f64::consts::TAU;

pub(crate) fn check_modes(
    file: &ModelFile,
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Vec<FlexibleMode> {
    let modes = file.mode.iter().flatten();
    let mut all: Vec<FlexibleMode> = modes.filter_map(|own| mode(own, resolve)).collect();
    for (k, own) in file.panel.iter().flatten().enumerate() {
        let key = Key::entry("panel", k, own.name.as_deref());
        all.extend(panel(own, &key, resolve, findings));
    }
    for (k, own) in file.tank.iter().flatten().enumerate() {
        let key = Key::entry("tank", k, own.name.as_deref());
        all.extend(tank(own, &key, resolve, findings));
    }
    if all.len() > MOST_MODES {
        findings.refuse(
            "E0119",
            &Key::top("mode").index(MOST_MODES),
            format!("the file has {} modes", all.len()),
            format!("keep to the {MOST_MODES} of the lowest frequencies"),
        );
    }
    all
}

/// A panel that turns by `y / sqrt(I)` about its hinge, I its inertia there.
fn panel(
    file: &PanelFile,
    key: &Key,
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Option<FlexibleMode> {
    let body = resolve(file.body.as_deref()?)?;
    let axis = check_axis(&file.axis?, &key.at("axis"), "axis", findings)?;
    let (mass, stiffness) = (file.mass_kg?, file.stiffness_N_m_per_rad?);
    let (hinge, com) = (Vector3::from(file.hinge_m?), Vector3::from(file.com_m?));
    let own = file.inertia_kg_m2.as_ref()?;
    let part = |x: Option<f64>| x.unwrap_or(0.0);
    let (xy, xz, yz) = (part(own.xy), part(own.xz), part(own.yz));
    let I = Matrix3::new(own.xx?, xy, xz, xy, own.yy?, yz, xz, yz, own.zz?);
    let (swing, at) = (axis.cross(&com), hinge + com);
    let about = axis.dot(&(I * axis)) + mass * swing.norm_squared();
    if about.is_nan() || about <= 0.0 {
        let problem = format!(
            "the panel has the inertia {} kg m2 about its hinge",
            short(about)
        );
        let remedy = "give the positive inertia of a body that has this mass";
        findings.refuse("E0115", &key.at("inertia_kg_m2"), problem, remedy);
        return None;
    }
    let root = about.sqrt();
    let turned = skew(&axis) * I - I * skew(&axis);
    Some(FlexibleMode {
        name: file.name.clone()?,
        mode: Mode {
            body,
            frequency_Hz: (stiffness / about).sqrt() / TAU,
            damping_ratio: ratio(file.damping_N_m_s_per_rad, stiffness, about, key, findings)?,
            translation: swing * (mass / root),
            rotation: (I * axis + at.cross(&swing) * mass) / root,
            inertia_slope: (turned + slope_of(&at, &(swing * mass))) / root,
        },
        estimate: estimate(file.estimate.as_ref()),
    })
}

/// A mass that moves along some directions.
fn tank(
    file: &TankFile,
    key: &Key,
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Vec<FlexibleMode> {
    let body = file.body.as_deref().and_then(resolve);
    let (Some(name), Some(body), Some(at), Some(mass), Some(stiffness)) = (
        &file.name,
        body,
        file.position_m,
        file.mass_kg,
        file.stiffness_N_per_m,
    ) else {
        return Vec::new();
    };
    let Some(damping) = ratio(file.damping_N_s_per_m, stiffness, mass, key, findings) else {
        return Vec::new();
    };
    let directions = match file.axis {
        None => ["x", "y", "z"]
            .into_iter()
            .zip([Vector3::x(), Vector3::y(), Vector3::z()])
            .map(|(axis, e)| (format!("{name}_{axis}"), e))
            .collect(),
        Some(axis) => {
            let axis = check_axis(&axis, &key.at("axis"), "axis", findings);
            axis.map(|e| vec![(name.clone(), e)]).unwrap_or_default()
        }
    };
    let (at, root) = (Vector3::from(at), mass.sqrt());
    let moving = |(name, e): (String, Vector3)| FlexibleMode {
        name,
        mode: Mode {
            body,
            frequency_Hz: (stiffness / mass).sqrt() / TAU,
            damping_ratio: damping,
            translation: e * root,
            rotation: at.cross(&e) * root,
            inertia_slope: slope_of(&at, &(e * root)),
        },
        estimate: estimate(file.estimate.as_ref()),
    };
    directions.into_iter().map(moving).collect()
}

/// Share of critical damping; `None` where nothing oscillates.
fn ratio(
    damping: Option<f64>,
    stiffness: f64,
    inertia: f64,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<f64> {
    let ratio = damping.unwrap_or(0.0) / (2.0 * (stiffness * inertia).sqrt());
    if ratio < 1.0 {
        return Some(ratio);
    }
    let problem = format!("the damping is {} times the critical one", short(ratio));
    findings.refuse(
        "E0115",
        key,
        problem,
        "give a smaller damping, or a stiffer spring",
    );
    None
}

/// Slope of the inertia about a point where what has this first moment per slope moves at `at` from it.
fn slope_of(at: &Vector3, moved: &Vector3) -> Matrix3 {
    Matrix3::identity() * (2.0 * at.dot(moved)) - at * moved.transpose() - moved * at.transpose()
}

fn skew(a: &Vector3) -> Matrix3 {
    a.cross_matrix()
}

fn mode(file: &ModeFile, resolve: &impl Fn(&str) -> Option<usize>) -> Option<FlexibleMode> {
    let vector = |key: Option<[f64; 3]>| Vector3::from(key.unwrap_or_default());
    let slope = file.inertia_slope_kg05_m.as_ref();
    Some(FlexibleMode {
        name: file.name.clone()?,
        mode: Mode {
            body: resolve(file.body.as_deref()?)?,
            frequency_Hz: file.frequency_Hz?,
            damping_ratio: file.damping_ratio.unwrap_or(0.0),
            translation: vector(file.translation_kg05),
            rotation: vector(file.rotation_kg05_m),
            inertia_slope: slope.map_or_else(Matrix3::zeros, tensor),
        },
        estimate: estimate(file.estimate.as_ref()),
    })
}

fn tensor(file: &SlopeFile) -> Matrix3 {
    let six = [file.xx, file.yy, file.zz, file.xy, file.xz, file.yz];
    let [xx, yy, zz, xy, xz, yz] = six.map(|x| x.unwrap_or(0.0));
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn estimate(file: Option<&ModeEstimateFile>) -> ModeEstimate {
    let has = |what: ModeParameter| match file {
        None => false,
        Some(ModeEstimateFile::All(all)) => *all,
        Some(ModeEstimateFile::Some(list)) => list.contains(&what),
    };
    ModeEstimate {
        frequency: has(ModeParameter::Frequency),
        damping: has(ModeParameter::Damping),
        translation: has(ModeParameter::Translation),
        rotation: has(ModeParameter::Rotation),
        inertia_slope: has(ModeParameter::InertiaSlope),
    }
}

/// Reports modes that carry more than the vehicle has where its joints stand: what follows the base at once must keep a positive
/// mass and inertia. The model has no other fault.
///
/// The slopes of the modes after those that the file has as such are taken from the body's origin to the mass centre of the vehicle.
pub(crate) fn check_carried(model: &mut Model, file: &ModelFile, findings: &mut Findings<'_, '_>) {
    if model.modes.is_empty() {
        return;
    }
    let vehicle = Vehicle::from(&*model);
    let mut kinematics = Kinematics::new(&vehicle.tree);
    kinematics.place(&vehicle.tree, &vehicle.locked_at);
    let whole = composite(&vehicle.bodies, &kinematics);
    let declared = file.mode.as_ref().map_or(0, Vec::len);
    for own in model.modes.iter_mut().skip(declared) {
        let (R, p) = (kinematics.R[own.mode.body], kinematics.p[own.mode.body]);
        let centre = R.transpose() * (whole.p_BoScm_B() - p);
        own.mode.inertia_slope -= slope_of(&centre, &own.mode.translation);
    }
    let mut follows = about_centre(&whole);
    for (k, mode) in model.modes.iter().enumerate() {
        let key = Key::entry("mode", k, Some(&mode.name));
        let carried = participation(&mode.mode, &kinematics, &whole);
        if carried == Vector6::zeros() {
            let text = "nothing excites this mode: it participates neither in translation nor in rotation; give one";
            findings.note(&key.at("frequency_Hz"), text.to_owned());
        }
        let moved = mode.mode.translation.norm_squared();
        if moved >= whole.mass {
            let problem = format!(
                "the mode moves {} kg, but the vehicle has {} kg",
                short(moved),
                short(whole.mass)
            );
            let remedy = "correct it: the square of its length is below the mass of the vehicle";
            findings.refuse("E0115", &key.at("translation_kg05"), problem, remedy);
            continue;
        }
        let rest = follows - carried * carried.transpose();
        if rest.cholesky().is_some() {
            follows = rest;
            continue;
        }
        findings.refuse(
            "E0115",
            &key.at("rotation_kg05_m"),
            "no positive inertia is left of the vehicle without what this mode and those before it carry",
            "correct the participations: the squares of their rotations are below the vehicle's moments of inertia",
        );
    }
}

/// Mass and inertia about the mass centre.
fn about_centre(whole: &Composite) -> Matrix6 {
    let mut out = Matrix6::identity() * whole.mass;
    out.fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&whole.I_SScm_B());
    out
}

/// Linear momentum of a mode and its angular momentum about the mass centre, per rate of the amplitude, in base axes.
fn participation(mode: &Mode, kinematics: &Kinematics, whole: &Composite) -> Vector6 {
    let R = kinematics.R[mode.body];
    let arm = kinematics.p[mode.body] - whole.p_BoScm_B();
    let l = R * mode.translation;
    let h = R * mode.rotation + arm.cross(&l);
    Vector6::new(l.x, l.y, l.z, h.x, h.y, h.z)
}
