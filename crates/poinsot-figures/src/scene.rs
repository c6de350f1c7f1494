//! A rotatable 3D scene: shaded ellipsoids, curves, arrows, and a body rolling on a plane.
//!
//! In print and without WebGL2 it is a static SVG; `space.js` draws the same numbers.

use crate::error::PageError;
use crate::markup::{Html, escape, island};
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt::Write;

/// A point or vector.
pub type Point = [f64; 3];

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;
/// View direction of the static picture: azimuth and elevation, rad.
const YAW: f64 = -0.9;
const PITCH: f64 = 0.42;

/// An ellipsoid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ellipsoid {
    /// Name in the legend, or empty.
    pub name: String,
    /// Centre.
    pub centre: Point,
    /// Semi-axes as vectors.
    pub axes: [Point; 3],
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Drawn translucent.
    pub faint: bool,
}

/// A curve; `None` is a gap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Name in the legend, or empty.
    pub name: String,
    /// Points.
    pub points: Vec<Option<Point>>,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Time of each point as a fraction, 0 to 1; if given, it sets the colour.
    pub shares: Option<Vec<f64>>,
}

/// An arrow with a label at its tip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Arrow {
    /// Start.
    pub from: Point,
    /// Tip.
    pub to: Point,
    /// Label.
    pub label: String,
    /// Colour, 0 to 7.
    pub colour: usize,
}

/// A marked point with a label.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spot {
    /// Position.
    pub at: Point,
    /// Label.
    pub label: String,
    /// Colour, 0 to 7.
    pub colour: usize,
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
    /// Sequence of shapes of the first ellipsoid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub morph: Option<Morph>,
    /// Remark below the figure.
    #[serde(skip)]
    pub note: String,
}

/// Closed sequence of shapes of one ellipsoid about the origin.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Morph {
    /// Semi-axes of each shape.
    pub axes: Vec<[Point; 3]>,
    /// Description of each shape.
    pub words: Vec<String>,
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
    /// Body of each ellipsoid.
    pub ellipsoids: Vec<usize>,
    /// Body of each curve.
    pub curves: Vec<usize>,
    /// Body of each arrow.
    pub arrows: Vec<usize>,
    /// Body of each marked point.
    pub spots: Vec<usize>,
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
}

impl Scene {
    /// The scene as a figure: static picture, data and canvas element.
    ///
    /// # Errors
    /// The numbers have no JSON form.
    pub fn html(&self) -> Result<Html, PageError> {
        let view = View::around(self);
        let data = island(&Island {
            scene: self,
            centre: view.centre,
            extent: self.extent(),
        })?;
        let data = data.as_str();
        let title = escape(&self.title);
        let mut out = format!("<figure class=\"scene\"><figcaption><b>{title}</b>");
        for (name, kind, colour) in self.legend() {
            let name = escape(name);
            let _ = write!(out, "<span class=\"key {kind} c{colour}\">{name}</span>");
        }
        let _ = write!(
            out,
            "</figcaption><div class=\"stage\"><svg class=\"still\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\">"
        );
        self.draw(&mut out);
        let _ = write!(
            out,
            "</svg></div><script type=\"application/json\" class=\"scene-data\">{data}</script>"
        );
        if !self.note.is_empty() {
            let _ = write!(out, "<p class=\"note\">{}</p>", escape(&self.note));
        }
        out.push_str("</figure>");
        Ok(Html(out))
    }

    /// The static picture for a separate file: size and elements.
    pub(crate) fn drawing(&self) -> ([f64; 2], String) {
        let mut out = String::new();
        self.draw(&mut out);
        ([WIDTH, HEIGHT], out)
    }

    /// Name, mark and colour of each legend entry.
    pub(crate) fn legend(&self) -> Vec<(&str, &'static str, usize)> {
        let named = self.ellipsoids.iter().map(|e| {
            let kind = if e.faint { "bars" } else { "solid" };
            (e.name.as_str(), kind, e.colour)
        });
        let curves = self.curves.iter().map(|c| {
            let kind = if c.shares.is_some() { "ramp" } else { "line" };
            (c.name.as_str(), kind, c.colour)
        });
        let plane = self.rolling.iter().map(|r| (r.plane.as_str(), "bars", 6));
        let all = named.chain(curves).filter(|n| !n.0.is_empty());
        all.chain(plane).collect()
    }

    fn draw(&self, out: &mut String) {
        let view = View::around(self);
        let mut solids: Vec<&Ellipsoid> = self.ellipsoids.iter().collect();
        solids.sort_by(|a, b| {
            dot(&a.centre, &view.towards).total_cmp(&dot(&b.centre, &view.towards))
        });
        for e in solids {
            let class = if e.faint { "ghost" } else { "body" };
            let (outline, c) = (view.path(&view.outline(e)), e.colour);
            let _ = write!(out, "<path class=\"{class} c{c}\" d=\"{outline}z\"/>");
            if !e.faint {
                for line in mesh(e) {
                    let front = view.front(&line, Some(e));
                    let _ = write!(out, "<path class=\"wire\" d=\"{front}\"/>");
                }
            }
        }
        if let Some((pole, normal)) = self.rolling.as_ref().and_then(Rolling::still) {
            let half = 0.8 * self.extent();
            let (u, v) = tangents(&normal);
            let corner = |a: f64, b: f64| {
                let at = [0, 1, 2].map(|k| pole[k] + half * (a * u[k] + b * v[k]));
                view.text(&at)
            };
            let _ = write!(
                out,
                "<path class=\"plane\" d=\"M{}L{}L{}L{}z\"/>",
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0)
            );
        }
        // A path on the body is hidden behind the body.
        let body = self.rolling.as_ref().and_then(|_| self.ellipsoids.first());
        for c in &self.curves {
            let (d, colour) = (view.front(&c.points, body), c.colour);
            let _ = write!(out, "<path class=\"curve c{colour}\" d=\"{d}\"/>");
        }
        for a in &self.arrows {
            let (from, to) = (view.text(&a.from), view.text(&a.to));
            let [x, y] = view.place(&a.to);
            let (x, y, word) = (x + 5.0, y - 4.0, escape(&a.label));
            let _ = write!(
                out,
                "<path class=\"arrow c{}\" d=\"M{from}L{to}\"/><text x=\"{x:.1}\" y=\"{y:.1}\">{word}</text>",
                a.colour
            );
        }
        if let Some((pole, _)) = self.rolling.as_ref().and_then(Rolling::still) {
            let [x, y] = view.place(&pole);
            let _ = write!(
                out,
                "<circle class=\"spot c1\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\"/>"
            );
        }
        for s in &self.spots {
            let [x, y] = view.place(&s.at);
            let word = escape(&s.label);
            let (c, right, low) = (s.colour, x + 7.0, y + 14.0);
            let _ = write!(
                out,
                "<circle class=\"spot c{c}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/><text x=\"{right:.1}\" y=\"{low:.1}\">{word}</text>"
            );
        }
    }

    /// Half the size of the drawing about the origin of the view.
    fn extent(&self) -> f64 {
        let (low, high) = self.bounds();
        let half = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max) / 2.0;
        if half > 0.0 && half.is_finite() {
            half
        } else {
            1.0
        }
    }

    fn bounds(&self) -> (Point, Point) {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut take = |p: &Point| {
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        };
        for e in self
            .ellipsoids
            .iter()
            .filter(|e| !e.faint || self.ellipsoids.len() < 2)
        {
            for k in 0..3 {
                let reach = e.axes.iter().map(|a| a[k] * a[k]).sum::<f64>().sqrt();
                let mut p = e.centre;
                p[k] += reach;
                take(&p);
                p[k] -= 2.0 * reach;
                take(&p);
            }
        }
        self.curves
            .iter()
            .flat_map(|c| &c.points)
            .flatten()
            .for_each(&mut take);
        self.arrows.iter().for_each(|a| take(&a.to));
        self.spots.iter().for_each(|s| take(&s.at));
        (low, high)
    }
}

impl Rolling {
    /// The instant of the static picture: the middle of the defined ones.
    fn still(&self) -> Option<(Point, Point)> {
        let defined: Vec<(Point, Point)> = self
            .pole
            .iter()
            .zip(&self.normal)
            .filter_map(|(p, n)| p.map(|p| (p, *n)))
            .collect();
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
        let centre = [0, 1, 2].map(|k| {
            let c = (low[k] + high[k]) / 2.0;
            if scene.rolling.is_some() || !c.is_finite() {
                0.0
            } else {
                c
            }
        });
        let (sy, cy) = YAW.sin_cos();
        let (sp, cp) = PITCH.sin_cos();
        let mut view = Self {
            right: [-sy, cy, 0.0],
            up: [-sp * cy, -sp * sy, cp],
            towards: [cp * cy, cp * sy, sp],
            centre,
            scale: 1.0,
        };
        let diagonal = (0..3)
            .map(|k| (high[k] - low[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        let round = if diagonal > 0.0 && diagonal.is_finite() {
            diagonal
        } else {
            2.0
        };
        view.scale = 1.15 * HEIGHT / round;
        if scene.rolling.is_some() {
            view.scale = 0.36 * HEIGHT / scene.extent();
        }
        view
    }

    fn place(&self, p: &Point) -> [f64; 2] {
        let d = [0, 1, 2].map(|k| p[k] - self.centre[k]);
        [
            WIDTH / 2.0 + self.scale * dot(&d, &self.right),
            HEIGHT / 2.0 - self.scale * dot(&d, &self.up),
        ]
    }

    fn text(&self, p: &Point) -> String {
        let [x, y] = self.place(p);
        format!("{x:.1} {y:.1}")
    }

    fn path(&self, points: &[Option<Point>]) -> String {
        let mut d = String::new();
        let mut pen = 'M';
        for p in points {
            match p {
                Some(p) => {
                    let _ = write!(d, "{pen}{}", self.text(p));
                    pen = 'L';
                }
                None => pen = 'M',
            }
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

    /// Outline of an ellipsoid: its farthest point in each direction of the picture plane.
    fn outline(&self, e: &Ellipsoid) -> Vec<Option<Point>> {
        (0..72)
            .map(|k| {
                let (s, c) = (TAU * f64::from(k) / 72.0).sin_cos();
                let d = [0, 1, 2].map(|i| c * self.right[i] + s * self.up[i]);
                let along = e.axes.map(|a| dot(&a, &d));
                let length = dot(&along, &along).sqrt().max(f64::MIN_POSITIVE);
                Some([0, 1, 2].map(|i| {
                    let reach: f64 = (0..3).map(|a| along[a] * e.axes[a][i]).sum();
                    e.centre[i] + reach / length
                }))
            })
            .collect()
    }
}

/// Meridians and parallels.
fn mesh(e: &Ellipsoid) -> Vec<Vec<Option<Point>>> {
    let at = |lat: f64, lon: f64| {
        let s = [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()];
        Some([0, 1, 2].map(|k| e.centre[k] + (0..3).map(|a| s[a] * e.axes[a][k]).sum::<f64>()))
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
