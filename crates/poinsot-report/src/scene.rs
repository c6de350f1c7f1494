//! A turnable picture in space: wire ellipsoids, curves, arrows, and a body that rolls on a plane.
//!
//! On paper and without JavaScript a still SVG; `scene.js` draws the same numbers on a canvas.

use crate::error::PageError;
use crate::markup::{Html, escape, island};
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt::Write;

/// A point or vector.
pub type Point = [f64; 3];

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;
/// The still looks from here: azimuth and elevation, rad.
const YAW: f64 = -0.9;
const PITCH: f64 = 0.42;

/// An ellipsoid as a wire mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ellipsoid {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Centre.
    pub centre: Point,
    /// Semi-axes as vectors.
    pub axes: [Point; 3],
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Drawn faintly.
    pub faint: bool,
}

/// A curve; `None` breaks it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Points.
    pub points: Vec<Option<Point>>,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Dashed.
    pub dashed: bool,
    /// Drawn faintly.
    pub faint: bool,
}

/// An arrow with a word at its tip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Arrow {
    /// Foot.
    pub from: Point,
    /// Tip.
    pub to: Point,
    /// Word.
    pub label: String,
    /// Colour, 0 to 7.
    pub colour: usize,
}

/// A marked point with a word beside it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spot {
    /// Place.
    pub at: Point,
    /// Word.
    pub label: String,
    /// Colour, 0 to 7.
    pub colour: usize,
}

/// Everything above belongs to a body that turns; a plane touches it at the pole.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Rolling {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Attitude of the body in the space of the picture, scalar last.
    pub q_xyzw: Vec<[f64; 4]>,
    /// Where the plane touches, in body axes; `None` where that is not defined.
    pub pole: Vec<Option<Point>>,
    /// Normal of the plane in body axes, unit.
    pub normal: Vec<Point>,
    /// What the plane is called.
    pub plane: String,
    /// Shown first as seen from space, where the plane lies still.
    pub from_space: bool,
}

/// A picture in space.
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
    /// The motion, where there is one.
    pub rolling: Option<Rolling>,
    /// A remark under the picture.
    #[serde(skip)]
    pub note: String,
}

impl Scene {
    /// The picture as a figure: still, data, and a place for the canvas.
    ///
    /// # Errors
    /// The numbers have no JSON form.
    pub fn html(&self) -> Result<Html, PageError> {
        let data = island(self)?;
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

    /// The still picture for a file of its own: size and elements.
    pub(crate) fn drawing(&self) -> ([f64; 2], String) {
        let mut out = String::new();
        self.draw(&mut out);
        ([WIDTH, HEIGHT], out)
    }

    /// Name, mark and colour of what the legend shows.
    pub(crate) fn legend(&self) -> Vec<(&str, &'static str, usize)> {
        let named = self.ellipsoids.iter().map(|e| {
            let kind = if e.faint { "dashed" } else { "line" };
            (e.name.as_str(), kind, e.colour)
        });
        let curves = self.curves.iter().map(|c| {
            let kind = if c.dashed { "dashed" } else { "line" };
            (c.name.as_str(), kind, c.colour)
        });
        let plane = self.rolling.iter().map(|r| (r.plane.as_str(), "bars", 6));
        let all = named.chain(curves).filter(|n| !n.0.is_empty());
        all.chain(plane).collect()
    }

    fn draw(&self, out: &mut String) {
        let view = View::around(self);
        for e in &self.ellipsoids {
            let class = if e.faint { "wire faint" } else { "wire" };
            for line in mesh(e) {
                let (front, back) = view.split(&line, &e.centre);
                let c = e.colour;
                let _ = write!(
                    out,
                    "<path class=\"{class} back c{c}\" d=\"{back}\"/><path class=\"{class} c{c}\" d=\"{front}\"/>"
                );
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
        for c in &self.curves {
            let dashed = if c.dashed { " dashed" } else { "" };
            let faint = if c.faint { " faint" } else { "" };
            let colour = c.colour;
            let mut draw = |d: &str, back: &str| {
                let _ = write!(
                    out,
                    "<path class=\"curve{dashed}{faint}{back} c{colour}\" d=\"{d}\"/>"
                );
            };
            if self.rolling.is_some() {
                let (front, back) = view.split(&c.points, &[0.0; 3]);
                draw(&back, " back");
                draw(&front, "");
            } else {
                draw(&view.path(&c.points), "");
            }
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

    /// Half the size of what is drawn about the origin of the view.
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
    /// The instant shown on paper: the middle of what is defined.
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

    /// The parts before and behind the centre.
    fn split(&self, line: &[Option<Point>], centre: &Point) -> (String, String) {
        let (mut front, mut back) = (String::new(), String::new());
        for pair in line.windows(2) {
            let [Some(from), Some(to)] = pair else {
                continue;
            };
            let middle = [0, 1, 2].map(|k| (from[k] + to[k]) / 2.0 - centre[k]);
            let side = if dot(&middle, &self.towards) >= 0.0 {
                &mut front
            } else {
                &mut back
            };
            let (a, b) = (self.text(from), self.text(to));
            if side.ends_with(&a) {
                let _ = write!(side, "L{b}");
            } else {
                let _ = write!(side, "M{a}L{b}");
            }
        }
        (front, back)
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
