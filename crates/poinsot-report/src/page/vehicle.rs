//! The vehicle drawn from the model, with moving joints; a suspected part is marked.

use super::Answer;
use super::tensor::{equivalent_ellipsoid, matrix};
use super::trust::group;
use poinsot_figures::{Arrow, Curve, Ellipsoid, Figure, Hinge, Point, Scene, Spot, Tree};
use poinsot_formats::{DrawnBody, DrawnJoint, Pointer, Vehicle};
use poinsot_spatial::{Matrix3, Vector3};

/// Legend text and colour of a body, by its status.
const DETERMINED: (&str, usize) = ("determined", 0);
const OPEN: (&str, usize) = ("not all determined", 4);
const KNOWN: (&str, usize) = ("known", 6);
const WANTED: (&str, usize) = ("to be determined", 0);
const WITHHELD: (&str, usize) = ("withheld", 6);
const SUSPECT: (&str, usize) = ("suspected", 1);
const JOINT: usize = 3;
const WHEEL: usize = 2;
const THRUSTER: usize = 7;
/// Lengths of arrows relative to the largest semi-axis; a wheel's arrow extends beyond the body.
const WHEEL_REACH: f64 = 1.6;
const THRUSTER_REACH: f64 = 0.4;
const JOINT_REACH: f64 = 0.15;
/// Largest number of instants of the joint motion.
const INSTANTS: usize = 300;

/// The vehicle of an answer as a figure.
pub(super) fn drawn(answer: &Answer) -> Figure {
    Figure::scene("vehicle", of_answer(answer, &[]))
}

/// The vehicle, with the first suspect of the diagnostics marked.
pub(super) fn suspected(answer: &Answer) -> Scene {
    let d = answer.estimate.diagnostics.iter();
    let names: Vec<&str> = d
        .flat_map(|d| &d.suspects)
        .map(|s| s.name.as_str())
        .collect();
    of_answer(answer, names.get(..1).unwrap_or(&[]))
}

/// The vehicle as it moves during a manoeuvre.
pub(super) fn flying(flown: Flown) -> Figure {
    let role = |b: &DrawnBody| if b.estimated { WANTED } else { KNOWN };
    let words = "A body is drawn as the homogeneous ellipsoid with its nominal mass and inertia. Lines connect frame origins and joints. The mass centre of the whole rests.";
    let mut scene = Builder::new(&flown.vehicle, &role, &[]).scene(Some(flown.motion));
    scene.title = "the vehicle during the manoeuvre, axes of the base at the start, m".to_owned();
    scene.note = words.to_owned();
    Figure::scene("manoeuvre", scene)
}

/// Whether a suspect, such as `wheel wheel2`, is this part.
fn named(suspect: &str, part: &str) -> bool {
    let cut = |c: char| !(c.is_alphanumeric() || c == '_' || c == '-');
    suspect == part || suspect.split(cut).any(|word| word == part)
}

fn of_answer(answer: &Answer, suspects: &[&str]) -> Scene {
    let role = |b: &DrawnBody| role(answer, b);
    let mut scene = Builder::new(&answer.data.vehicle, &role, suspects).scene(joint_motion(answer));
    scene.title = "the vehicle, axes of the base, m".to_owned();
    scene.note = "A body is drawn as the homogeneous ellipsoid with its mass and inertia: estimated where determined, else nominal. Lines connect frame origins and joints."
        .to_owned();
    scene
}

fn role(answer: &Answer, b: &DrawnBody) -> (&'static str, usize) {
    let found = answer.estimate.bodies.get(&b.name);
    let all = || found.iter().flat_map(|b| b.numbers()).map(|n| n.2);
    match b.estimated {
        false => KNOWN,
        true if answer.estimate.is_withheld() => WITHHELD,
        true if all().all(|n| n.is_known() || n.value.is_some()) => DETERMINED,
        true => OPEN,
    }
}

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

/// The joint motion during the first record with motion.
fn joint_motion(answer: &Answer) -> Option<Motion> {
    let segments = &answer.data.segments;
    let record = segments.iter().position(|s| !s.joints.is_empty())?;
    let s = &segments[record];
    let rows = s.joints.iter();
    Some(Motion {
        time_s: s.time_s.clone(),
        joints: rows.map(|r| (r.name.clone(), r.values.clone())).collect(),
        base: Vec::new(),
        group: group(record),
    })
}

struct Builder<'a> {
    vehicle: &'a Vehicle,
    /// Legend text and colour of a body.
    role: &'a dyn Fn(&DrawnBody) -> (&'static str, usize),
    suspects: &'a [&'a str],
    size: f64,
    tree: Tree,
    scene: Scene,
}

fn vector(at: &Point) -> Vector3 {
    Vector3::from(*at)
}

impl<'a> Builder<'a> {
    fn new(
        vehicle: &'a Vehicle,
        role: &'a dyn Fn(&DrawnBody) -> (&'static str, usize),
        suspects: &'a [&'a str],
    ) -> Self {
        Self {
            vehicle,
            role,
            suspects,
            size: 0.0,
            tree: Tree::default(),
            scene: Scene::default(),
        }
    }

    fn scene(mut self, motion: Option<Motion>) -> Scene {
        self.bodies();
        self.joints();
        self.pointers(&self.vehicle.wheels, WHEEL, WHEEL_REACH);
        self.pointers(&self.vehicle.thrusters, THRUSTER, THRUSTER_REACH);
        if let Some(motion) = motion {
            self.moving(&motion);
        }
        self.scene
    }

    fn is_suspect(&self, name: &str) -> bool {
        self.suspects.iter().any(|s| named(s, name))
    }

    /// Index of a body; the base if the name is unknown.
    fn body(&self, name: &str) -> usize {
        let place = self.vehicle.bodies.iter().position(|b| b.name == name);
        place.unwrap_or(0)
    }

    fn role(&self, b: &DrawnBody) -> (&'static str, usize) {
        match self.is_suspect(&b.name) {
            true => SUSPECT,
            false => (self.role)(b),
        }
    }

    fn bodies(&mut self) {
        let mut named: Vec<&str> = Vec::new();
        for (k, b) in self.vehicle.bodies.iter().enumerate() {
            let [r0, r1, r2] = b.rotation;
            let R = Matrix3::from_row_slice(&[r0, r1, r2].concat());
            let centre = vector(&b.origin_m) + R * vector(&b.com_m);
            let [xx, xy, yy, xz, yz, zz] = b.inertia_kg_m2;
            let I = matrix(&[xx, yy, zz, xy, xz, yz]);
            let Some(axes) = equivalent_ellipsoid(b.mass_kg, &I) else {
                continue;
            };
            let axes = axes.map(|a| Point::from(R * vector(&a)));
            let longest = axes.iter().map(|a| vector(a).norm());
            self.size = longest.fold(self.size, f64::max);
            let (role, colour) = self.role(b);
            let first = !named.contains(&role);
            named.push(role);
            self.tree.ellipsoids.push(k);
            self.scene.ellipsoids.push(Ellipsoid {
                name: if first { role } else { "" }.to_owned(),
                centre: centre.into(),
                axes,
                colour,
                faint: false,
            });
            self.tree.spots.push(k);
            self.scene.spots.push(Spot {
                at: centre.into(),
                label: b.name.clone(),
                colour,
            });
        }
    }

    fn joints(&mut self) {
        let vehicle = self.vehicle;
        for j in &vehicle.joints {
            let (parent, child) = (self.body(&j.parent), self.body(&j.child));
            let from = vehicle.bodies.get(parent).map_or([0.0; 3], |b| b.origin_m);
            self.tree.curves.push(parent);
            self.scene.curves.push(Curve {
                name: String::new(),
                points: vec![Some(from), Some(j.origin_m)],
                colour: KNOWN.1,
                shares: None,
            });
            if j.kind != "fixed" {
                let reach = vector(&j.axis) * (JOINT_REACH * self.size);
                self.arrow(child, &j.origin_m, &(-reach), "", JOINT);
                // Joints at one position share a label.
                let here = |o: &&DrawnJoint| o.origin_m == j.origin_m;
                let together: Vec<&str> = vehicle
                    .joints
                    .iter()
                    .filter(here)
                    .map(|o| o.name.as_str())
                    .collect();
                let first = together.first() == Some(&j.name.as_str());
                let label = if first {
                    together.join(", ")
                } else {
                    String::new()
                };
                self.arrow(child, &j.origin_m, &reach, &label, JOINT);
            }
        }
    }

    fn pointers(&mut self, list: &'a [Pointer], colour: usize, reach: f64) {
        for p in list {
            let by = vector(&p.direction) * (reach * self.size);
            let (colour, label) = match self.is_suspect(&p.name) {
                true => (SUSPECT.1, format!("{} (suspected)", p.name)),
                false => (colour, p.name.clone()),
            };
            self.arrow(self.body(&p.body), &p.at_m, &by, &label, colour);
        }
    }

    fn arrow(&mut self, body: usize, from: &Point, by: &Vector3, label: &str, colour: usize) {
        self.tree.arrows.push(body);
        self.scene.arrows.push(Arrow {
            from: *from,
            to: (vector(from) + by).into(),
            label: label.to_owned(),
            colour,
        });
    }

    fn moving(&mut self, motion: &Motion) {
        let stride = motion.time_s.len().div_ceil(INSTANTS).max(1);
        let hinge = |j: &DrawnJoint| Hinge {
            parent: self.body(&j.parent),
            child: self.body(&j.child),
            origin: j.origin_m,
            axis: j.axis,
            slides: j.kind == "prismatic",
            moved: moved(motion, &j.name, stride),
        };
        self.tree.joints = self.vehicle.joints.iter().map(hinge).collect();
        self.tree.time_s = motion.time_s.iter().copied().step_by(stride).collect();
        self.tree.bodies = self.vehicle.bodies.len();
        self.tree.group = motion.group.clone();
        let base = motion.base.iter().step_by(stride);
        self.tree.base_q_xyzw = base.clone().map(|b| b.0.map(short)).collect();
        let first = motion.base.first().map_or([0.0; 3], |b| b.1);
        let shift = |b: &([f64; 4], Point)| [0, 1, 2].map(|k| short(b.1[k] - first[k]));
        self.tree.base_shift = base.map(shift).collect();
        self.scene.tree = Some(std::mem::take(&mut self.tree));
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
