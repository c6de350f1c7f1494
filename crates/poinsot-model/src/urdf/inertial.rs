//! Checks the mass properties of links and converts them to link axes.

use super::Remark;
use super::raw::{Inertial, Link, Robot};
use super::tree::Order;
use crate::check_body::{PHYSICAL_TOLERANCE, SMALLEST_MASS};
use crate::vehicle::JointKind;
use poinsot_files::{excerpt, list, short};
use poinsot_spatial::{MassProperties, Matrix3, Rotation3, Vector3, principal_axes};
use std::collections::HashMap;

/// Fixed-axis roll, pitch, yaw: the rotation `Rz(yaw) Ry(pitch) Rx(roll)` from the frame to its parent.
pub(crate) fn rotation([roll, pitch, yaw]: [f64; 3]) -> Matrix3 {
    Rotation3::from_euler_angles(roll, pitch, yaw).into_inner()
}

/// Mass properties of every link in its own frame; zero if it has none.
pub(super) fn check(
    robot: &mut Robot,
    order: &Order,
    allow_massless: bool,
    remarks: &mut Vec<Remark>,
) -> Vec<MassProperties> {
    let all: Vec<MassProperties> = robot.links.iter().map(|l| one(l, remarks)).collect();
    units(robot, remarks);
    // With unreadable numbers, massless moving links cannot be determined.
    if !remarks.iter().any(|r| r.code == Some("E0107")) {
        let moved = moving_without_mass(robot, order, &all, allow_massless, remarks);
        for joint in moved {
            robot.joints[joint].kind = JointKind::Fixed;
        }
    }
    all
}

/// What a program writes for zero: a share of a mass at a millimetre, or at the distance of the mass centre.
const ROUNDING: f64 = 1.0e-12;
const SMALLEST_SIZE: f64 = 1.0e-3;

/// The same with zeros for what is zero but for rounding.
fn rounded(inertial: &Inertial) -> Inertial {
    let mut own = inertial.clone();
    if own.mass.abs() < SMALLEST_MASS {
        own.mass = 0.0;
    }
    let size = Vector3::from(own.xyz).norm().max(SMALLEST_SIZE);
    let mass = match own.mass {
        0.0 => SMALLEST_MASS,
        mass => ROUNDING * mass.max(SMALLEST_MASS),
    };
    let zero = mass * size * size;
    if own.elements.iter().all(|x| x.abs() <= zero) {
        own.elements = [0.0; 6];
    }
    own
}

fn one(link: &Link, remarks: &mut Vec<Remark>) -> MassProperties {
    let mut judge = Remarks { link, remarks };
    let Some(inertial) = &link.inertial.as_ref().map(rounded) else {
        judge.push(None, "no <inertial>: assumed massless".to_owned(), "");
        return MassProperties::ZERO;
    };
    if !judge.has_mass(inertial) {
        return MassProperties::ZERO;
    }
    let [xx, xy, xz, yy, yz, zz] = inertial.elements;
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let turn = rotation(inertial.rpy);
    // Exactly symmetric, as in a model file.
    let turned = turn * tensor * turn.transpose();
    let found = MassProperties {
        mass: inertial.mass,
        p_BoBcm_B: Vector3::from(inertial.xyz),
        I_BBcm_B: (turned + turned.transpose()) * 0.5,
    };
    if inertial.elements == [0.0; 6] {
        let problem = "the inertia is zero in all elements: a point mass".to_owned();
        judge.push(None, problem, "");
        return match inertial.mass {
            0.0 => MassProperties::ZERO,
            _ => found,
        };
    }
    if [xx, yy, zz] == [1.0; 3] && xy == 0.0 {
        let problem = "the inertia is 1 kg m2 about every axis; is it a placeholder?".to_owned();
        judge.push(None, problem, "");
    }
    // Moments do not depend on the axes; the original axes have the least rounding.
    let (moments, _) = principal_axes(&tensor);
    judge.gyration(inertial.mass, &moments);
    judge.density(&found);
    judge.moments(&moments);
    found
}

/// Plausible radii of gyration of a link in metres and kilograms, m.
const GYRATION: [f64; 2] = [1.0e-3, 5.0];
/// Side of a cube over its radius of gyration, and density of osmium, kg/m3, with a margin for thin bodies, which are smaller.
const SIDE: f64 = 2.45;
const DENSEST: f64 = 3.0e5;
/// Moments below this fraction of the largest count as zero.
const ZERO_MOMENT: f64 = 1.0e-12;

struct Remarks<'a> {
    link: &'a Link,
    remarks: &'a mut Vec<Remark>,
}

impl Remarks<'_> {
    fn push(&mut self, code: Option<&'static str>, problem: String, remedy: &str) {
        let inertial = self.link.inertial.as_ref();
        let byte = inertial.map_or(self.link.byte, |i| i.byte);
        let remark = Remark::new(code, byte, problem, remedy);
        self.remarks.push(remark.on(named(self.link)));
    }

    /// Whether the link has mass, or neither mass nor inertia.
    fn has_mass(&mut self, inertial: &Inertial) -> bool {
        if inertial.mass < 0.0 {
            let problem = format!("the mass is negative: {} kg", short(inertial.mass));
            let remedy = "give a positive mass";
            self.push(Some("E0115"), problem, remedy);
            return false;
        }
        if inertial.mass == 0.0 {
            let empty = inertial.elements == [0.0; 6];
            let code = (!empty).then_some("E0116");
            let remedy = "give it a mass, or zero inertia";
            let problem = "the mass is zero".to_owned();
            self.push(code, problem, remedy);
            return empty;
        }
        true
    }

    /// Inconsistent units of mass and inertia.
    fn gyration(&mut self, mass: f64, moments: &[f64; 3]) {
        let largest = largest(moments);
        if mass <= 0.0 || largest == 0.0 {
            return;
        }
        let radius = (largest / mass).sqrt();
        let size = match radius {
            r if r > GYRATION[1] => format!("{} m", short(r)),
            r if r < GYRATION[0] => format!("{} mm", short(1e3 * r)),
            _ => return,
        };
        let problem =
            format!("the radius of gyration is {size}; are mass in kg and inertia in kg m2?");
        self.push(None, problem, "");
    }

    /// A mass in grams.
    fn density(&mut self, found: &MassProperties) {
        let side = SIDE * found.radius_of_gyration();
        if side > 0.0 && found.mass > DENSEST * side.powi(3) {
            let problem = format!(
                "a body of {} kg with this inertia is denser than any metal; is the mass in grams?",
                short(found.mass)
            );
            self.push(None, problem, "");
        }
    }

    /// Unphysical principal moments.
    fn moments(&mut self, moments: &[f64; 3]) {
        let [a, b, c] = *moments;
        let zero = ZERO_MOMENT * largest(moments);
        let remedy = "correct the numbers; they are tensor elements (ixy = -integral x y dm) about the mass centre";
        let listed = list(moments);
        if a < -zero {
            let problem = format!("the smallest principal moment is negative: {listed} kg m2");
            self.push(Some("E0115"), problem, remedy);
            return;
        }
        if a <= zero {
            let problem = format!("a principal moment is zero: {listed} kg m2");
            self.push(None, problem, "");
        }
        if a + b < c * (1.0 - PHYSICAL_TOLERANCE) {
            let problem = format!(
                "these principal moments are not physical: {listed} kg m2, the largest exceeds the sum of the other two"
            );
            self.push(Some("E0115"), problem, remedy);
        }
    }
}

fn largest(moments: &[f64; 3]) -> f64 {
    moments.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
}

/// Distance of a joint from its parent beyond which it is in mm, m, and angle that is more than a turn, rad.
const FAR: f64 = 50.0;
const TURN: f64 = 6.3;

/// Notes joints whose origins look like millimetres or degrees.
fn units(robot: &Robot, remarks: &mut Vec<Remark>) {
    for joint in &robot.joints {
        let far = Vector3::from(joint.xyz).norm();
        let turn = joint.rpy.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let (apart, angle) = (short(far), short(turn));
        let apart = format!("the joint is {apart} m from its parent; is it in mm?");
        let angle = format!("the angle {angle} rad is more than a turn; is it in degrees?");
        let told = [(far > FAR, apart), (turn > TURN, angle)].into_iter();
        let subject = format!("joint \"{}\" <origin>", excerpt(&joint.name, 60));
        for (_, problem) in told.filter(|told| told.0) {
            let note = Remark::new(None, joint.byte, problem, "");
            remarks.push(note.on(&subject));
        }
    }
}

fn named(link: &Link) -> String {
    format!("link \"{}\"", excerpt(&link.name, 60))
}

/// Reports joints that move no mass: momentum does not depend on their rate.
///
/// Where massless links are allowed, returns these joints: what they move has no effect.
fn moving_without_mass(
    robot: &Robot,
    order: &Order,
    all: &[MassProperties],
    allowed: bool,
    remarks: &mut Vec<Remark>,
) -> Vec<usize> {
    let mut carried: Vec<f64> = all.iter().map(|m| m.mass).collect();
    let joint_of = |k: usize| {
        let joint = order.carried_by.get(k).copied().flatten()?;
        robot.joints.get(joint)
    };
    let names = robot.links.iter().enumerate();
    let names = names.map(|(k, link)| (link.name.as_str(), k));
    // Of equal names the first.
    let index: HashMap<&str, usize> = names.rev().collect();
    for &k in order.links.iter().rev() {
        let own = carried.get(k).copied().unwrap_or(0.0);
        let parent = joint_of(k).and_then(|joint| index.get(joint.parent.as_str()).copied());
        if let Some(sum) = parent.and_then(|p| carried.get_mut(p)) {
            *sum += own;
        }
    }
    let whole = order.links.first().and_then(|k| carried.get(*k).copied());
    if whole == Some(0.0) {
        let remark = Remark::new(Some("E0116"), 0, "no link has mass", "give the base a mass");
        remarks.push(remark.on("robot"));
        return Vec::new();
    }
    let mut still = Vec::new();
    for &k in &order.links {
        let Some(joint) = joint_of(k) else { continue };
        if joint.kind != JointKind::Fixed && carried.get(k) == Some(&0.0) {
            let Some(link) = robot.links.get(k) else {
                continue;
            };
            still.extend(order.carried_by.get(k).copied().flatten());
            let problem = format!(
                "the link moves on joint \"{}\", but neither it nor its outboard bodies have mass",
                excerpt(&joint.name, 60)
            );
            let remedy =
                "give it an <inertial>, make its joint fixed, or import it by --allow-massless";
            let code = (!allowed).then_some("E0116");
            remarks.push(Remark::new(code, link.byte, problem, remedy).on(named(link)));
        }
    }
    still
}
