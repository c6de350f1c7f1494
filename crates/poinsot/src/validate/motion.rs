//! Motion of two vehicles under the same torques, wheels and thrust (Xu et al. 2017, sec. 5.5).

use super::Mover;
use super::compared::Compared;
use crate::case::{Case, Scenario};
use crate::error::Error;
use crate::simulate::run;
use poinsot_dynamics::Tree;
use poinsot_files::Place;
use poinsot_model::JointKind;
use poinsot_spatial::{UnitQuaternion, Vector3};

/// The motion of a vehicle in a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Position of the base origin, in N, m.
    pub p_NoBo_N: Vec<Vector3>,
    /// `R_NB`.
    pub R_NB: Vec<UnitQuaternion>,
    /// Moving joints.
    pub joints: Vec<JointPath>,
}

/// The motion of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPath {
    /// Name.
    pub name: String,
    /// `rad` or `m`.
    pub unit: &'static str,
    /// Positions.
    pub position: Vec<f64>,
}

/// Simulates a vehicle in a case.
///
/// # Errors
/// The case does not fit the vehicle, has a controller, or the motion cannot be computed.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::validate::{Mover, path};
///
/// let path = path(&case, &Mover::of_model(model))?;
/// assert_eq!(path.time_s.len(), 51);
/// // No force acts: the mass centre, which is the base origin, stays.
/// assert!(path.p_NoBo_N.iter().all(|p| p.norm() < 1.0e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn path(case: &Case, mover: &Mover) -> Result<Path, Error> {
    let scenario = scenario(case, mover)?;
    let tree = Tree::new(&mover.model);
    let joints = tree
        .coordinates
        .iter()
        .filter_map(|k| mover.model.joints.get(*k));
    let mut path = Path {
        time_s: Vec::new(),
        p_NoBo_N: Vec::new(),
        R_NB: Vec::new(),
        joints: joints
            .map(|joint| JointPath {
                name: joint.name.clone(),
                unit: match joint.kind {
                    JointKind::Prismatic => "m",
                    _ => "rad",
                },
                position: Vec::new(),
            })
            .collect(),
    };
    run(case, &mover.model, Some(&mover.bodies), &scenario, |s| {
        path.time_s.push(s.time);
        path.p_NoBo_N.push(s.p_NoBo_N);
        path.R_NB.push(s.R_NB);
        for (joint, q) in path.joints.iter_mut().zip(&s.q) {
            joint.position.push(*q);
        }
    })?;
    Ok(path)
}

/// The scenario of a vehicle in a case, with its thruster forces.
pub(super) fn scenario(case: &Case, mover: &Mover) -> Result<Scenario, Error> {
    let mut scenario = case.bind(&mover.model)?;
    if scenario.plan.control.is_some() {
        return Err(Error::one(
            "E0702",
            Place::file(case.path()),
            "[control] would command different torques on the two vehicles",
            "prescribe wheel torques with [[wheel_motion]]",
        ));
    }
    for firing in &mut scenario.plan.firings {
        let factor = mover.thrust_factor.get(firing.thruster);
        firing.force *= factor.copied().unwrap_or(1.0);
    }
    Ok(scenario)
}

/// Compares two vehicles in a case: base position, base attitude and every common joint over time.
///
/// # Errors
/// As [`path`].
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::validate::{Mover, compare_motion};
///
/// // Twice the inertia turns half as far.
/// let mut heavy = model.clone();
/// heavy.bodies[0].nominal.I_BBcm_B *= 2.0;
/// let compared = compare_motion(&case, &Mover::of_model(model), &Mover::of_model(heavy))?;
/// assert!(compared[0].largest < 1.0e-12 && compared[1].largest > 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_motion(case: &Case, model: &Mover, against: &Mover) -> Result<Vec<Compared>, Error> {
    Ok(compare_paths(&path(case, model)?, &path(case, against)?))
}

/// Compares two paths at the same times.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::validate::{Mover, compare_paths, path};
///
/// let path = path(&case, &Mover::of_model(model))?;
/// let compared = compare_paths(&path, &path);
/// assert_eq!((compared[0].name.as_str(), compared[0].largest), ("base position", 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare_paths(model: &Path, against: &Path) -> Vec<Compared> {
    let xyz = |name: &str| {
        ["x", "y", "z"]
            .map(|axis| format!("{name}_{axis}"))
            .to_vec()
    };
    let rows = |v: &[Vector3]| (0..3).map(|k| v.iter().map(|v| v[k]).collect()).collect();
    let pairs = model.p_NoBo_N.iter().zip(&against.p_NoBo_N);
    let off: Vec<Vector3> = pairs.map(|(a, b)| a - b).collect();
    let time_s = &model.time_s;
    let position = Compared {
        name: "base position".to_owned(),
        unit: "m",
        components: xyz("r"),
        model: rows(&model.p_NoBo_N),
        against: rows(&against.p_NoBo_N),
        difference_components: xyz("r"),
        difference: rows(&off),
        ..Compared::default()
    };
    let pairs = model.R_NB.iter().zip(&against.R_NB);
    // Small rotation from the second attitude to the first, in base axes.
    let turn: Vec<Vector3> = pairs.map(|(a, b)| turn(b, a)).collect();
    let quaternions = |q: &[UnitQuaternion]| {
        let component = |k| q.iter().map(|q| q.coords[k]).collect();
        (0..4).map(component).collect()
    };
    let attitude = Compared {
        name: "base attitude".to_owned(),
        unit: "rad",
        components: ["q_x", "q_y", "q_z", "q_w"].map(str::to_owned).to_vec(),
        model: quaternions(&model.R_NB),
        against: quaternions(&against.R_NB),
        difference_components: xyz("turn"),
        difference: rows(&turn),
        ..Compared::default()
    };
    let joint = |joint: &JointPath| {
        let same = |other: &&JointPath| other.name == joint.name && other.unit == joint.unit;
        let other = against.joints.iter().find(same)?;
        let pairs = joint.position.iter().zip(&other.position);
        let name = vec![format!("{}_{}", joint.name, joint.unit)];
        Some(Compared {
            name: format!("joint {}", joint.name),
            unit: joint.unit,
            components: name.clone(),
            model: vec![joint.position.clone()],
            against: vec![other.position.clone()],
            difference_components: name,
            difference: vec![pairs.map(|(a, b)| a - b).collect()],
            ..Compared::default()
        })
    };
    let base = [position, attitude].into_iter();
    let all = base.chain(model.joints.iter().filter_map(joint));
    all.map(|one| {
        let time_s = time_s.clone();
        Compared { time_s, ..one }.measured()
    })
    .collect()
}

/// Rotation vector from attitude `from` to attitude `to`, in the axes of `from`, rad. Accurate for tiny rotations,
/// where the scalar part of a quaternion is useless.
pub(super) fn turn(from: &UnitQuaternion, to: &UnitQuaternion) -> Vector3 {
    let q = from.inverse() * to;
    let (v, w) = (q.imag(), q.w);
    let (v, w) = if w < 0.0 { (-v, -w) } else { (v, w) };
    let size = v.norm();
    if size == 0.0 {
        return Vector3::zeros();
    }
    v * (2.0 * size.atan2(w) / size)
}
