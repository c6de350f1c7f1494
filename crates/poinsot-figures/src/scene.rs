//! A rotatable 3D scene: shaded ellipsoids and boxes, curves, arrows, and a body rolling on a plane.
//!
//! In print and without WebGL2 it is a static SVG; `space.js` draws the same numbers.

use crate::drawing::{Drawing, Key, px};
use crate::error::PageError;
use crate::template::{Html, island};
use minijinja::{Value, context};
use serde::Serialize;
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::fmt::Write;

/// A point or vector.
pub type Point = [f64; 3];

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;
/// View direction of the static picture: azimuth and elevation, rad.
const YAW: f64 = -0.9;
const PITCH: f64 = 0.42;
/// Half the size of a scene with boxes over the diagonal of its bounds.
const CORNER: f64 = 0.36;

/// An ellipsoid, or a box.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Ellipsoid {
    /// Name in the legend, which has equal entries once; or empty.
    pub name: String,
    /// Centre.
    pub centre: Point,
    /// Semi-axes as vectors; of a box, its orthogonal half-edges.
    pub axes: [Point; 3],
    /// Whether it is a box.
    pub boxed: bool,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Drawn translucent.
    pub faint: bool,
    /// Body of the tree; zero without.
    pub body: usize,
}

/// A curve; `None` is a gap.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Curve {
    /// Name in the legend, or empty.
    pub name: String,
    /// Points.
    pub points: Vec<Option<Point>>,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Time of each point as a fraction, 0 to 1; if given, it sets the colour.
    pub shares: Option<Vec<f64>>,
    /// Body of the tree; zero without.
    pub body: usize,
}

/// An arrow with a label at its tip.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Arrow {
    /// Start.
    pub from: Point,
    /// Tip.
    pub to: Point,
    /// Label.
    pub label: String,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Body of the tree; zero without.
    pub body: usize,
}

/// A marked point with a label.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Spot {
    /// Position.
    pub at: Point,
    /// Label.
    pub label: String,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Body of the tree; zero without.
    pub body: usize,
}

/// All items above are fixed to a rotating body; a plane touches the body at the pole.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Rolling {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Attitude of the body in scene axes, scalar last.
    pub q_xyzw: Vec<[f64; 4]>,
    /// Point of contact with the plane, in body axes; `None` if undefined.
    pub pole: Vec<Option<Point>>,
    /// Normal of the plane in body axes, unit.
    pub normal: Vec<Point>,
    /// Name of the plane.
    pub plane: String,
    /// Whether the plane is invariable, so that it is fixed in space and carries the herpolhode.
    pub free: bool,
    /// Group of plots over the same time.
    pub group: String,
}

/// A 3D scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Scene {
    /// Title.
    pub title: String,
    /// Ellipsoids.
    pub ellipsoids: Vec<Ellipsoid>,
    /// Curves.
    pub curves: Vec<Curve>,
    /// Arrows.
    pub arrows: Vec<Arrow>,
    /// Marked points.
    pub spots: Vec<Spot>,
    /// Motion, if any.
    pub rolling: Option<Rolling>,
    /// Bodies connected by joints; without it, all items belong to one body.
    pub tree: Option<Tree>,
    /// A scene without motion of its own, shown on the right at the same size, turning with this one.
    #[serde(skip)]
    pub beside: Option<Box<Scene>>,
    /// Remark below the figure.
    #[serde(skip)]
    pub note: String,
}

/// Bodies connected by joints, drawn in their pose at the first time.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Tree {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Group of plots over the same time.
    pub group: String,
    /// Attitude of the base since the first time, scalar last; empty if it rests.
    pub base_q_xyzw: Vec<[f64; 4]>,
    /// Displacement of the origin of the base since the first time, in its axes of then.
    pub base_shift: Vec<Point>,
    /// Number of bodies.
    pub bodies: usize,
    /// Joints; a parent's before its children's.
    pub joints: Vec<Hinge>,
}

/// A joint in its pose at the first time.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Hinge {
    /// Parent body.
    pub parent: usize,
    /// Child body.
    pub child: usize,
    /// A point on its axis.
    pub origin: Point,
    /// Unit axis.
    pub axis: Point,
    /// Whether the joint is prismatic.
    pub slides: bool,
    /// Displacement from the first position, rad or m; empty for a fixed joint.
    pub moved: Vec<f64>,
}

/// Data for `space.js`.
#[derive(Serialize)]
struct Island<'a> {
    #[serde(flatten)]
    scene: &'a Scene,
    centre: Point,
    extent: f64,
    beside: Option<Box<Island<'a>>>,
}

impl Scene {
    /// Its numbers for `space.js`.
    pub(crate) fn data(&self) -> Result<Html, PageError> {
        island(&self.island())
    }

    fn island(&self) -> Island<'_> {
        Island {
            scene: self,
            centre: View::around(self).centre,
            extent: self.extent(),
            beside: self.beside.as_ref().map(|b| Box::new(b.island())),
        }
    }

    /// Every legend entry once.
    pub(crate) fn legend(&self) -> Vec<Key<'_>> {
        let solids = self.ellipsoids.iter().map(|e| {
            let mark = if e.faint { "bars" } else { "solid" };
            (&e.name, mark, e.colour)
        });
        let curves = self.curves.iter().map(|c| {
            let mark = if c.shares.is_some() { "ramp" } else { "line" };
            (&c.name, mark, c.colour)
        });
        let plane = self.rolling.iter().map(|r| (&r.plane, "bars", 6));
        let all = solids.chain(curves).chain(plane);
        let mut entries = HashSet::new();
        let named = all.filter(|n| !n.0.is_empty() && entries.insert(*n));
        let keys = named.map(|(name, mark, colour)| Key::new(name, (mark, colour)));
        let beside = self.beside.iter().flat_map(|b| b.legend());
        keys.chain(beside).collect()
    }

    /// The static picture.
    pub(crate) fn drawing(&self) -> Result<Drawing, PageError> {
        let view = View::around(self);
        let still = self.rolling.as_ref().and_then(Rolling::still);
        // A path on the body is hidden behind the body.
        let body = self.rolling.as_ref().and_then(|_| self.ellipsoids.first());
        let curve =
            |c: &Curve| context! { colour => c.colour, path => view.front(&c.points, body) };
        let arrow = |a: &Arrow| {
            let path = view.path(&[Some(a.from), Some(a.to)]);
            context! { path, tip => view.place(&a.to), label => a.label, colour => a.colour }
        };
        let spot =
            |s: &Spot| context! { at => view.place(&s.at), label => s.label, colour => s.colour };
        let beside = self.beside.as_ref().map(|b| b.drawing()).transpose()?;
        let context = context! {
            solids => self.solids(&view),
            beside => beside.map(|drawing| drawing.elements.value()),
            plane => still.map(|(pole, normal)| self.plane(&view, &pole, &normal)),
            pole => still.map(|(pole, _)| view.place(&pole)),
            curves => self.curves.iter().map(curve).collect::<Vec<_>>(),
            arrows => self.arrows.iter().map(arrow).collect::<Vec<_>>(),
            spots => self.spots.iter().map(spot).collect::<Vec<_>>(),
        };
        Drawing::new([WIDTH, HEIGHT], "scene.svg", context)
    }

    /// Ellipsoids and boxes from back to front.
    fn solids(&self, view: &View) -> Vec<Value> {
        let depth = |e: &Ellipsoid| dot(&e.centre, &view.towards);
        let mut solids: Vec<&Ellipsoid> = self.ellipsoids.iter().collect();
        solids.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
        let drawn = |e: &&Ellipsoid| {
            let lines = match (e.faint, e.boxed) {
                (true, _) => Vec::new(),
                (_, true) => view.near_edges(e),
                _ => mesh(e),
            };
            let shield = Some(*e).filter(|e| !e.boxed);
            let wires = lines.iter().map(|line| view.front(line, shield));
            context! {
                faint => e.faint, colour => e.colour, outline => view.path(&view.outline(e)),
                wires => wires.collect::<Vec<_>>(),
            }
        };
        solids.iter().map(drawn).collect()
    }

    /// The plane that touches the body.
    fn plane(&self, view: &View, pole: &Point, normal: &Point) -> String {
        let half = 0.8 * self.extent();
        let (u, v) = tangents(normal);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let at = |[a, b]: [f64; 2]| [0, 1, 2].map(|k| pole[k] + half * (a * u[k] + b * v[k]));
        view.path(&corners.map(|c| Some(at(c))))
    }

    /// Half the size of the drawing about the origin of the view.
    fn extent(&self) -> f64 {
        let (low, high) = self.bounds();
        let across = [0, 1, 2].map(|k| high[k] - low[k]);
        // A box reaches into the corners of its bounds.
        let corner = match self.ellipsoids.iter().any(|e| e.boxed) {
            true => CORNER * dot(&across, &across).sqrt(),
            false => 0.0,
        };
        let half = across.into_iter().fold(2.0 * corner, f64::max) / 2.0;
        match half > 0.0 && half.is_finite() {
            true => half,
            false => 1.0,
        }
    }

    fn bounds(&self) -> (Point, Point) {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut take = |p: &Point, reach: &Point| {
            for k in 0..3 {
                low[k] = low[k].min(p[k] - reach[k]);
                high[k] = high[k].max(p[k] + reach[k]);
            }
        };
        let alone = self.ellipsoids.len() < 2;
        for e in self.ellipsoids.iter().filter(|e| !e.faint || alone) {
            let reach = |k: usize| match e.boxed {
                true => e.axes.iter().map(|a| a[k].abs()).sum(),
                false => e.axes.iter().map(|a| a[k] * a[k]).sum::<f64>().sqrt(),
            };
            take(&e.centre, &[0, 1, 2].map(reach));
        }
        let curves = self.curves.iter().flat_map(|c| &c.points).flatten();
        let tips = self.arrows.iter().map(|a| &a.to);
        let spots = self.spots.iter().map(|s| &s.at);
        for p in curves.chain(tips).chain(spots) {
            take(p, &[0.0; 3]);
        }
        (low, high)
    }
}

impl Rolling {
    /// The instant of the static picture: the middle of the defined ones.
    fn still(&self) -> Option<(Point, Point)> {
        let all = self.pole.iter().zip(&self.normal);
        let defined: Vec<(Point, Point)> = all.filter_map(|(p, n)| Some(((*p)?, *n))).collect();
        defined.get(defined.len() / 2).copied()
    }
}

/// Orthographic projection.
struct View {
    right: Point,
    up: Point,
    towards: Point,
    centre: Point,
    scale: f64,
}

impl View {
    fn around(scene: &Scene) -> Self {
        let (low, high) = scene.bounds();
        let middle = [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0);
        let rests = scene.rolling.is_none();
        let (sy, cy) = YAW.sin_cos();
        let (sp, cp) = PITCH.sin_cos();
        let across = [0, 1, 2].map(|k| high[k] - low[k]);
        let diagonal = Some(dot(&across, &across).sqrt()).filter(|d| *d > 0.0 && d.is_finite());
        Self {
            right: [-sy, cy, 0.0],
            up: [-sp * cy, -sp * sy, cp],
            towards: [cp * cy, cp * sy, sp],
            centre: middle.map(|c| if rests && c.is_finite() { c } else { 0.0 }),
            scale: match rests {
                true => 1.15 * HEIGHT / diagonal.unwrap_or(2.0),
                false => 0.36 * HEIGHT / scene.extent(),
            },
        }
    }

    /// Place in the picture, px.
    fn place(&self, p: &Point) -> [f64; 2] {
        let d = [0, 1, 2].map(|k| p[k] - self.centre[k]);
        [
            px(WIDTH / 2.0 + self.scale * dot(&d, &self.right)),
            px(HEIGHT / 2.0 - self.scale * dot(&d, &self.up)),
        ]
    }

    fn path(&self, points: &[Option<Point>]) -> String {
        let mut d = String::new();
        let mut pen = 'M';
        for p in points {
            pen = match p.map(|p| self.place(&p)) {
                Some([x, y]) => {
                    let _ = write!(d, "{pen}{x:.1} {y:.1}");
                    'L'
                }
                None => 'M',
            };
        }
        d
    }

    /// The part of a line on an ellipsoid that faces the viewer; the whole line without ellipsoid.
    fn front(&self, line: &[Option<Point>], body: Option<&Ellipsoid>) -> String {
        let Some(body) = body else {
            return self.path(line);
        };
        let seen = |p: &Point| {
            let from = [0, 1, 2].map(|k| p[k] - body.centre[k]);
            let normal = body.axes.iter().map(|a| {
                let square = dot(a, a).max(f64::MIN_POSITIVE);
                dot(a, &from) * dot(a, &self.towards) / (square * square)
            });
            normal.sum::<f64>() >= 0.0
        };
        let shown: Vec<Option<Point>> = line.iter().map(|p| p.filter(|p| seen(p))).collect();
        self.path(&shown)
    }

    /// The three edges of a box at the corner nearest to the viewer.
    fn near_edges(&self, e: &Ellipsoid) -> Vec<Vec<Option<Point>>> {
        let near = e.axes.map(|a| dot(&a, &self.towards).signum());
        let edge = |k: usize| {
            let mut far = near;
            far[k] = -far[k];
            vec![Some(point_at(e, near)), Some(point_at(e, far))]
        };
        (0..3).map(edge).collect()
    }

    /// Outline of an ellipsoid: its farthest point in each direction of the picture plane.
    fn outline(&self, e: &Ellipsoid) -> Vec<Option<Point>> {
        (0..72)
            .map(|k| {
                let (s, c) = (TAU * f64::from(k) / 72.0).sin_cos();
                let d = [0, 1, 2].map(|i| c * self.right[i] + s * self.up[i]);
                let along = e.axes.map(|a| dot(&a, &d));
                if e.boxed {
                    return Some(point_at(e, along.map(f64::signum)));
                }
                let length = dot(&along, &along).sqrt().max(f64::MIN_POSITIVE);
                Some([0, 1, 2].map(|i| {
                    let reach: f64 = (0..3).map(|a| along[a] * e.axes[a][i]).sum();
                    e.centre[i] + reach / length
                }))
            })
            .collect()
    }
}

/// The point at these shares of the axes; of a box, a corner by its signs.
fn point_at(e: &Ellipsoid, s: Point) -> Point {
    [0, 1, 2].map(|i| e.centre[i] + (0..3).map(|a| s[a] * e.axes[a][i]).sum::<f64>())
}

/// Meridians and parallels.
fn mesh(e: &Ellipsoid) -> Vec<Vec<Option<Point>>> {
    let at = |lat: f64, lon: f64| {
        let s = [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()];
        Some(point_at(e, s))
    };
    let turn = |i: usize, n: usize| TAU * i as f64 / n as f64;
    let meridians = (0..6).map(|m| (0..=48).map(|i| at(turn(i, 48), turn(m, 12))).collect());
    let parallels = (-2..=2).map(|p| {
        let lat = f64::from(p) * TAU / 12.0;
        (0..=48).map(|i| at(lat, turn(i, 48))).collect()
    });
    meridians.chain(parallels).collect()
}

fn tangents(n: &Point) -> (Point, Point) {
    let helper = if n[2].abs() < 0.9 {
        [0.0, 0.0, 1.0]
    } else {
        [1.0, 0.0, 0.0]
    };
    let u = cross(&helper, n);
    let length = dot(&u, &u).sqrt().max(1.0e-12);
    let u = u.map(|x| x / length);
    (u, cross(n, &u))
}

fn dot(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn cross(a: &Point, b: &Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
