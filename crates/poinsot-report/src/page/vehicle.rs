//! The vehicle drawn from the model, with moving joints; a suspected part is marked.

use super::Answer;
use super::curves::group;
use super::tensor::equivalent_ellipsoid;
use poinsot_figures::{Arrow, Curve, Ellipsoid, Figure, Hinge, Point, Scene, Spot, Tree};
use poinsot_formats::{DrawnBody, DrawnJoint, Pointer, Vehicle};
use poinsot_spatial::{Matrix3, Vector3, tensor};

/// Legend text and colour of a body.
type Role = (&'static str, usize);

const DETERMINED: Role = ("determined", 0);
const OPEN: Role = ("not all determined", 4);
const KNOWN: Role = ("known", 6);
const WANTED: Role = ("to be determined", 0);
const WITHHELD: Role = ("withheld", 6);
const SUSPECT: Role = ("suspected", 1);
const JOINT: usize = 3;
const WHEEL: usize = 2;
const THRUSTER: usize = 7;
/// Lengths of arrows relative to the largest semi-axis; a wheel's arrow extends beyond the body.
const WHEEL_REACH: f64 = 1.6;
const THRUSTER_REACH: f64 = 0.4;
const JOINT_REACH: f64 = 0.15;
/// Largest number of instants of the joint motion.
const INSTANTS: usize = 300;

/// A vehicle and how it moves.
pub struct Flown {
    /// The vehicle at the first instant.
    pub vehicle: Vehicle,
    /// Its motion.
    pub motion: Motion,
}

/// Instants of a motion.
#[derive(Debug, Clone, Default)]
pub struct Motion {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Positions of every joint that moves, rad or m.
    pub joints: Vec<(String, Vec<f64>)>,
    /// Attitude of the base since the first instant, and its place relative to the mass centre of the whole; empty where
    /// the picture is in axes of the base.
    pub base: Vec<([f64; 4], Point)>,
    /// Group of plots over the same time.
    pub group: String,
}

/// The vehicle of an answer as a figure.
pub(super) fn drawn(answer: &Answer) -> Figure {
    Figure::scene("vehicle", of_answer(answer, None))
}

/// The vehicle, with the first suspect of the diagnostics marked.
pub(super) fn suspected(answer: &Answer) -> Scene {
    let mut suspects = answer.estimate.diagnostics.iter().flat_map(|d| &d.suspects);
    of_answer(answer, suspects.next().map(|s| s.name.as_str()))
}

/// The vehicle as it moves during a manoeuvre.
pub(super) fn flying(flown: &Flown) -> Figure {
    let role = |b: &DrawnBody| if b.estimated { WANTED } else { KNOWN };
    let builder = Builder::new(&flown.vehicle, None);
    let mut scene = builder.scene(role, Some(&flown.motion));
    if let Some(tree) = &mut scene.tree {
        tree.group = group(0);
    }
    scene.title = "the vehicle during the manoeuvre, axes of the base at the start, m".to_owned();
    scene.note = "A body is drawn as the homogeneous ellipsoid with its nominal mass and inertia. Lines connect frame origins and joints. The mass centre of the whole rests.".to_owned();
    Figure::scene("manoeuvre", scene)
}

fn of_answer(answer: &Answer, suspect: Option<&str>) -> Scene {
    let builder = Builder::new(&answer.data.vehicle, suspect);
    let mut scene = builder.scene(|b| role(answer, b), joint_motion(answer).as_ref());
    scene.title = "the vehicle, axes of the base, m".to_owned();
    scene.note = "A body is drawn as the homogeneous ellipsoid with its mass and inertia: estimated where determined, else nominal. Lines connect frame origins and joints.".to_owned();
    scene
}

fn role(answer: &Answer, b: &DrawnBody) -> Role {
    let found = answer.estimate.bodies.get(&b.name);
    let mut all = found.iter().flat_map(|b| b.numbers()).map(|n| n.2);
    match b.estimated {
        false => KNOWN,
        true if answer.estimate.is_withheld() => WITHHELD,
        true if all.all(|n| n.is_known() || n.value.is_some()) => DETERMINED,
        true => OPEN,
    }
}

/// The joint motion during the first record with motion.
fn joint_motion(answer: &Answer) -> Option<Motion> {
    let mut segments = answer.data.segments.iter().enumerate();
    let (record, s) = segments.find(|(_, s)| !s.joints.is_empty())?;
    let joints = s.joints.iter().map(|r| (r.name.clone(), r.values.clone()));
    Some(Motion {
        time_s: s.time_s.clone(),
        joints: joints.collect(),
        base: Vec::new(),
        group: group(record),
    })
}

struct Builder<'a> {
    vehicle: &'a Vehicle,
    suspect: Option<&'a str>,
    /// Largest semi-axis of a body, m.
    size: f64,
    scene: Scene,
}

impl<'a> Builder<'a> {
    fn new(vehicle: &'a Vehicle, suspect: Option<&'a str>) -> Self {
        Self {
            vehicle,
            suspect,
            size: 0.0,
            scene: Scene::default(),
        }
    }

    fn scene(mut self, role: impl Fn(&DrawnBody) -> Role, motion: Option<&Motion>) -> Scene {
        for (k, b) in self.vehicle.bodies.iter().enumerate() {
            let role = match self.is_suspect(&b.name) {
                true => SUSPECT,
                false => role(b),
            };
            self.body(k, b, role);
        }
        self.joints();
        self.pointers(&self.vehicle.wheels, WHEEL, WHEEL_REACH);
        self.pointers(&self.vehicle.thrusters, THRUSTER, THRUSTER_REACH);
        self.scene.tree = motion.map(|motion| self.tree(motion));
        self.scene
    }

    /// Whether the suspect, such as `wheel wheel2`, is this part.
    fn is_suspect(&self, part: &str) -> bool {
        let cut = |c: char| !(c.is_alphanumeric() || c == '_' || c == '-');
        let names = |s: &str| s == part || s.split(cut).any(|word| word == part);
        self.suspect.is_some_and(names)
    }

    /// Index of a body; the base if the name is unknown.
    fn index(&self, name: &str) -> usize {
        let place = self.vehicle.bodies.iter().position(|b| b.name == name);
        place.unwrap_or(0)
    }

    fn body(&mut self, body: usize, b: &DrawnBody, (name, colour): Role) {
        let R = Matrix3::from_row_slice(&b.rotation.concat());
        let centre = Vector3::from(b.origin_m) + R * Vector3::from(b.com_m);
        let Some(axes) = equivalent_ellipsoid(b.mass_kg, &tensor(b.inertia_kg_m2)) else {
            return;
        };
        let axes = axes.map(|a| R * Vector3::from(a));
        self.size = axes.iter().map(|a| a.norm()).fold(self.size, f64::max);
        let named = self.scene.ellipsoids.iter().any(|e| e.name == name);
        self.scene.ellipsoids.push(Ellipsoid {
            name: if named { "" } else { name }.to_owned(),
            centre: centre.into(),
            axes: axes.map(Point::from),
            colour,
            faint: false,
            body,
        });
        self.scene.spots.push(Spot {
            at: centre.into(),
            label: b.name.clone(),
            colour,
            body,
        });
    }

    fn joints(&mut self) {
        for j in &self.vehicle.joints {
            let (parent, child) = (self.index(&j.parent), self.index(&j.child));
            let from = self.vehicle.bodies.get(parent);
            self.scene.curves.push(Curve {
                points: vec![
                    Some(from.map_or([0.0; 3], |b| b.origin_m)),
                    Some(j.origin_m),
                ],
                colour: KNOWN.1,
                body: parent,
                ..Curve::default()
            });
            if j.kind != "fixed" {
                let reach = Vector3::from(j.axis) * (JOINT_REACH * self.size);
                self.arrow(child, &j.origin_m, -reach, String::new(), JOINT);
                self.arrow(child, &j.origin_m, reach, self.label(j), JOINT);
            }
        }
    }

    /// Names of all joints at one position, at the first of them.
    fn label(&self, joint: &DrawnJoint) -> String {
        let joints = self.vehicle.joints.iter();
        let here = joints.filter(|o| o.origin_m == joint.origin_m);
        let together: Vec<&str> = here.map(|o| o.name.as_str()).collect();
        match together.first() == Some(&joint.name.as_str()) {
            true => together.join(", "),
            false => String::new(),
        }
    }

    fn pointers(&mut self, list: &[Pointer], colour: usize, reach: f64) {
        for p in list {
            let by = Vector3::from(p.direction) * (reach * self.size);
            let (colour, label) = match self.is_suspect(&p.name) {
                true => (SUSPECT.1, format!("{} (suspected)", p.name)),
                false => (colour, p.name.clone()),
            };
            self.arrow(self.index(&p.body), &p.at_m, by, label, colour);
        }
    }

    fn arrow(&mut self, body: usize, from: &Point, by: Vector3, label: String, colour: usize) {
        self.scene.arrows.push(Arrow {
            from: *from,
            to: (Vector3::from(*from) + by).into(),
            label,
            colour,
            body,
        });
    }

    fn tree(&self, motion: &Motion) -> Tree {
        let stride = motion.time_s.len().div_ceil(INSTANTS).max(1);
        let hinge = |j: &DrawnJoint| Hinge {
            parent: self.index(&j.parent),
            child: self.index(&j.child),
            origin: j.origin_m,
            axis: j.axis,
            slides: j.kind == "prismatic",
            moved: moved(motion, &j.name, stride),
        };
        let base = motion.base.iter().step_by(stride);
        let first = motion.base.first().map_or([0.0; 3], |b| b.1);
        let shift = |b: &([f64; 4], Point)| [0, 1, 2].map(|k| short(b.1[k] - first[k]));
        Tree {
            joints: self.vehicle.joints.iter().map(hinge).collect(),
            time_s: motion.time_s.iter().copied().step_by(stride).collect(),
            bodies: self.vehicle.bodies.len(),
            group: motion.group.clone(),
            base_q_xyzw: base.clone().map(|b| b.0.map(short)).collect(),
            base_shift: base.map(shift).collect(),
        }
    }
}

/// Positions of a joint relative to the first.
fn moved(motion: &Motion, joint: &str, stride: usize) -> Vec<f64> {
    let row = motion.joints.iter().find(|r| r.0 == joint);
    let values = row.map_or(&[][..], |r| &r.1);
    let first = values.first().copied().unwrap_or(0.0);
    let since = |x: &f64| short(x - first);
    values.iter().step_by(stride).map(since).collect()
}

/// Rounded to 0.1 mrad or 0.1 mm, less than a picture shows.
fn short(x: f64) -> f64 {
    (x * 1.0e4).round() / 1.0e4
}
