//! The vehicle drawn from the model, with moving joints; a suspected part is marked.

use super::Answer;
use super::curves::group;
use super::poles::INSTANTS;
use super::tensor::equivalent_box;
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
const SENSOR: usize = 5;
const NOMINAL: usize = 7;
/// Corners of a box along a line over its edges, which has three of them twice. Bit k: the side along axis k.
const EDGES: [u8; 16] = [0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4];
/// Lengths of arrows relative to the largest half-edge; a wheel's arrow extends beyond the body.
const WHEEL_REACH: f64 = 1.6;
const THRUSTER_REACH: f64 = 0.4;
const JOINT_REACH: f64 = 0.15;
/// Distance of places with one label, relative to the same.
const NEAR: f64 = 0.05;

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

/// The vehicle, estimated and nominal. That of a rejected model has the first suspect of the diagnostics marked.
pub(super) fn drawn(answer: &Answer) -> Scene {
    let (e, vehicle) = (&answer.estimate, &answer.data.vehicle);
    let mut suspects = e.diagnostics.iter().flat_map(|d| &d.suspects);
    let suspect = suspects.next().filter(|_| e.is_withheld());
    let suspect = suspect.map(|s| s.name.as_str());
    let motion = joint_motion(answer);
    let mut scene = Builder::scene(vehicle, suspect, |b| role(answer, b), motion.as_ref());
    let bodies = vehicle.bodies.iter().enumerate();
    let nominal = bodies.filter_map(|(body, b)| edges(body, &nominal(answer, b)?));
    scene.curves.extend(nominal);
    scene.title = "the vehicle, axes of the base, m".to_owned();
    scene.note = "Box: a body as the homogeneous box with its mass and inertia, estimated where determined, else nominal; lines on its edges: nominal. Arrows: wheels, thrusters, joint axes. Lines connect frame origins and joints.".to_owned();
    scene
}

/// Rotation from the axes of a body to those of the base.
fn rotation(b: &DrawnBody) -> Matrix3 {
    Matrix3::from_row_slice(&b.rotation.concat())
}

fn centre(b: &DrawnBody) -> Vector3 {
    Vector3::from(b.origin_m) + rotation(b) * Vector3::from(b.com_m)
}

/// An estimated body with its nominal numbers.
fn nominal(answer: &Answer, b: &DrawnBody) -> Option<DrawnBody> {
    let found = answer.estimate.bodies.get(&b.name);
    let found = found.filter(|_| b.estimated && !answer.estimate.is_withheld())?;
    Some(DrawnBody {
        mass_kg: found.mass_kg.nominal,
        com_m: found.com_m.map(|n| n.nominal),
        inertia_kg_m2: found.inertia_kg_m2.map(|n| n.nominal),
        ..b.clone()
    })
}

/// The edges of a nominal body.
fn edges(body: usize, b: &DrawnBody) -> Option<Curve> {
    let axes = half_edges(b)?;
    let corner = |corner: u8| {
        let side = |k: usize| if corner >> k & 1 == 0 { -1.0 } else { 1.0 };
        let from_centre: Vector3 = (0..3).map(|k| side(k) * axes[k]).sum();
        Some((centre(b) + from_centre).into())
    };
    Some(Curve {
        name: "nominal".to_owned(),
        points: EDGES.map(corner).to_vec(),
        colour: NOMINAL,
        body,
        ..Curve::default()
    })
}

/// The vehicle as it moves during a manoeuvre.
pub(super) fn flying(flown: &Flown) -> Figure {
    let role = |b: &DrawnBody| if b.estimated { WANTED } else { KNOWN };
    let mut scene = Builder::scene(&flown.vehicle, None, role, Some(&flown.motion));
    if let Some(tree) = &mut scene.tree {
        tree.group = group(0);
    }
    scene.title = "the vehicle during the manoeuvre, axes of the base at the start, m".to_owned();
    scene.note = "A body is drawn as the homogeneous box with its nominal mass and inertia. Lines connect frame origins and joints. The mass centre of the whole rests.".to_owned();
    Figure::scene("manoeuvre", scene)
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
    /// Largest half-edge of a body, m.
    size: f64,
    scene: Scene,
}

impl<'a> Builder<'a> {
    fn scene(
        vehicle: &'a Vehicle,
        suspect: Option<&'a str>,
        role: impl Fn(&DrawnBody) -> Role,
        motion: Option<&Motion>,
    ) -> Scene {
        let mut own = Self {
            vehicle,
            suspect,
            size: 0.0,
            scene: Scene::default(),
        };
        for (k, b) in vehicle.bodies.iter().enumerate() {
            let role = if own.is_suspect(&b.name) {
                SUSPECT
            } else {
                role(b)
            };
            own.body(k, b, role);
        }
        own.joints();
        own.sensors();
        own.pointers(&vehicle.wheels, WHEEL, WHEEL_REACH);
        own.pointers(&vehicle.thrusters, THRUSTER, THRUSTER_REACH);
        own.scene.tree = motion.map(|motion| own.tree(motion));
        own.scene
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
        let Some(axes) = half_edges(b) else {
            return;
        };
        self.size = axes.iter().map(|a| a.norm()).fold(self.size, f64::max);
        self.scene.ellipsoids.push(Ellipsoid {
            name: name.to_owned(),
            centre: centre(b).into(),
            axes: axes.map(Point::from),
            boxed: true,
            colour,
            body,
            ..Ellipsoid::default()
        });
        self.spot(body, centre(b).into(), &b.name, colour);
    }

    fn sensors(&mut self) {
        for s in &self.vehicle.sensors {
            if let Some(at) = s.at_m {
                self.spot(self.index(&s.body), at, &s.name, SENSOR);
            }
        }
    }

    /// A named place; names of one place stand together.
    fn spot(&mut self, body: usize, at: Point, label: &str, colour: usize) {
        let near = NEAR * self.size;
        let beside = |s: &&mut Spot| (Vector3::from(s.at) - Vector3::from(at)).norm() < near;
        match self.scene.spots.iter_mut().find(beside) {
            Some(spot) => spot.label.push_str(&format!(", {label}")),
            None => self.scene.spots.push(Spot {
                at,
                label: label.to_owned(),
                colour,
                body,
            }),
        }
    }

    fn joints(&mut self) {
        for j in &self.vehicle.joints {
            let (parent, child) = (self.index(&j.parent), self.index(&j.child));
            let from = self.vehicle.bodies.get(parent);
            let from = from.map_or([0.0; 3], |b| b.origin_m);
            self.scene.curves.push(Curve {
                points: vec![Some(from), Some(j.origin_m)],
                colour: KNOWN.1,
                body: parent,
                ..Curve::default()
            });
            if j.kind != "fixed" {
                let reach = Vector3::from(j.axis) * (JOINT_REACH * self.size);
                self.arrow(child, &j.origin_m, -reach, String::new(), JOINT);
                self.arrow(child, &j.origin_m, reach, String::new(), JOINT);
                self.spot(child, j.origin_m, &j.name, JOINT);
            }
        }
    }

    fn pointers(&mut self, list: &[Pointer], colour: usize, reach: f64) {
        for p in list {
            let by = Vector3::from(p.direction) * (reach * self.size);
            let (colour, label, tail) = match self.is_suspect(&p.name) {
                // To both sides, so that no body hides it.
                true => (SUSPECT.1, format!("{} (suspected)", p.name), by),
                false => (colour, p.name.clone(), Vector3::zeros()),
            };
            let from = Vector3::from(p.at_m) - tail;
            self.arrow(self.index(&p.body), &from.into(), by + tail, label, colour);
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

/// Half-edges of the box of a body, axes of the base.
fn half_edges(b: &DrawnBody) -> Option<[Vector3; 3]> {
    let axes = equivalent_box(b.mass_kg, &tensor(b.inertia_kg_m2))?;
    Some(axes.map(|a| rotation(b) * a))
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
