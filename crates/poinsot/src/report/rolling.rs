//! Section 3: Poinsot's picture (Poinsot 1834). The inertia ellipsoid `x . I x = const` touches, at the
//! pole `x = w sqrt(const / w . I w)`, a plane whose normal is `I w`. Moving freely the plane is invariable
//! and the ellipsoid rolls on it; the pole draws the polhode.

use super::Answer;
use super::data::Segment;
use super::numbers::{NINETY_FIVE, interval, plus_minus, value};
use super::tensor::{best, inertia_ellipsoid, matrix, principal, principal_sigmas};
use minijinja::{Value, context};
use nalgebra::{Quaternion, UnitQuaternion};
use poinsot_formats::BodyFile;
use poinsot_report::{
    Arrow, Curve, Ellipsoid, Figure, PageError, Part, Point, Rolling, Scene, Spot, render,
    significant,
};
use poinsot_spatial::{Matrix3, Vector3};

/// Most instants kept.
const INSTANTS: usize = 500;
/// Share of the fastest rate below which a pole is not drawn.
const SLOW: f64 = 0.03;
/// Change of momentum per energy below which a motion counts as free.
const FREE: f64 = 0.02;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let bodies = &e.bodies;
    let whole = e.system.first().filter(|_| bodies.len() > 1);
    let chosen = match whole {
        Some(system) => Some((
            "the whole vehicle, joints as at the first sample",
            &system.body,
            answer.truth.system(),
        )),
        None => bodies
            .first()
            .map(|(name, b)| (name.as_str(), b, answer.truth.body(name))),
    };
    let segment = answer.data.segments.iter().find(|s| !s.time_s.is_empty());
    let mut figures = Vec::new();
    let context = match chosen {
        Some((name, body, truth)) => {
            let (I, estimated) = best(body);
            let sigmas = moment_sigmas(answer, name, body, &I).filter(|_| estimated);
            let truth = true_tensor(&truth);
            let scene = scene(name, &I, estimated, sigmas, truth.as_ref(), segment);
            figures.extend(scene.map(|s| Figure::scene("poinsot", s)));
            let scene = figures.first().map(Figure::html).transpose()?;
            context! {
                name, estimated,
                scene => scene.map(|s| s.value()),
                moments => moments(&I, estimated, sigmas, truth.as_ref()),
                truth => truth.is_some(),
            }
        }
        None => context! { name => "", estimated => false },
    };
    Ok(Part {
        id: "motion",
        title: "Poinsot's picture",
        body: render(
            "rolling.html",
            include_str!("templates/rolling.html"),
            context,
        )?,
        figures,
    })
}

fn true_tensor(truth: &[Option<f64>; 10]) -> Option<Matrix3> {
    let mut six = [0.0; 6];
    for (out, found) in six.iter_mut().zip(&truth[4..]) {
        *out = (*found)?;
    }
    Some(matrix(&six))
}

/// Sigmas of the principal moments, with correlations where the result file has them.
fn moment_sigmas(answer: &Answer, name: &str, body: &BodyFile, I: &Matrix3) -> Option<[f64; 3]> {
    let (_, axes) = principal(I)?;
    let numbers = body.inertia_kg_m2.named();
    let mut sigmas = [0.0; 6];
    for (out, (_, n)) in sigmas.iter_mut().zip(&numbers) {
        *out = n.sigma?;
    }
    let covariance = &answer.estimate.covariance;
    let rows: Option<Vec<usize>> = numbers
        .iter()
        .map(|(element, _)| {
            let wanted = format!("{name}.inertia_kg_m2.{element}");
            covariance.names.iter().position(|n| *n == wanted)
        })
        .collect();
    let mut six = [[0.0; 6]; 6];
    let full = rows.is_some_and(|rows| {
        rows.iter().enumerate().all(|(i, a)| {
            rows.iter().enumerate().all(|(j, b)| {
                let entry = covariance
                    .matrix
                    .get(*a)
                    .and_then(|r| r.get(*b))
                    .copied()
                    .flatten();
                six[i][j] = entry.unwrap_or(0.0);
                entry.is_some()
            })
        })
    });
    Some(principal_sigmas(&axes, &sigmas, full.then_some(&six)))
}

fn moments(
    I: &Matrix3,
    estimated: bool,
    sigmas: Option<[f64; 3]>,
    truth: Option<&Matrix3>,
) -> Vec<Value> {
    let Some((moments, axes)) = principal(I) else {
        return Vec::new();
    };
    let truth = truth.and_then(principal).map(|t| t.0);
    (0..3)
        .map(|k| {
            let sigma = sigmas.map(|s| s[k]);
            let axis = axes[k].iter().map(|x| format!("{x:+.4}").replace('-', "\u{2212}"));
            context! {
                name => format!("I{}", k + 1),
                value => if estimated { value(Some(moments[k]), sigma) } else { significant(moments[k], 6) },
                half => plus_minus(sigma),
                interval => interval(Some(moments[k]), sigma),
                axis => axis.collect::<Vec<_>>().join("  "),
                truth => truth.map(|t| significant(t[k], 8)),
            }
        })
        .collect()
}

fn scene(
    name: &str,
    I: &Matrix3,
    estimated: bool,
    sigmas: Option<[f64; 3]>,
    truth: Option<&Matrix3>,
    segment: Option<&Segment>,
) -> Option<Scene> {
    let (moments, axes) = principal(I)?;
    // Semi-axes near one: the ellipsoid of a body with this mean moment is the unit sphere.
    let size = (moments.iter().sum::<f64>() / 3.0).sqrt();
    let semi = inertia_ellipsoid(I, size)?;
    let mut scene = Scene {
        title: format!("inertia ellipsoid of {name}"),
        ..Scene::default()
    };
    let ellipsoid = |name: &str, axes, colour, faint| Ellipsoid {
        name: name.to_owned(),
        centre: [0.0; 3],
        axes,
        colour,
        faint,
    };
    let own = if estimated {
        "inertia (energy) ellipsoid"
    } else {
        "nominal inertia ellipsoid, not identified"
    };
    scene.ellipsoids.push(ellipsoid(own, semi, 0, false));
    let mut note = band(&mut scene, &moments, &semi, sigmas);
    if let Some(axes) = truth.and_then(|t| inertia_ellipsoid(t, size)) {
        scene.ellipsoids.push(ellipsoid("truth", axes, 2, true));
    }
    for (k, axis) in axes.iter().enumerate() {
        let tip = axis * (size / moments[k].sqrt());
        scene.spots.push(Spot {
            at: tip.into(),
            label: format!("I{}", k + 1),
            colour: 3,
        });
        scene.arrows.push(Arrow {
            from: (-tip).into(),
            to: tip.into(),
            label: String::new(),
            colour: 3,
        });
    }
    for (k, label) in ["x", "y", "z"].into_iter().enumerate() {
        let mut to = [0.0; 3];
        to[k] = 1.5;
        scene.arrows.push(Arrow {
            from: [0.0; 3],
            to,
            label: label.to_owned(),
            colour: 6,
        });
    }
    if let Some(motion) = segment.and_then(|s| Poles::new(s, I, size)) {
        note.push_str(&motion.add_to(&mut scene, I));
    }
    scene.note = note;
    Some(scene)
}

/// The 95 % band of the ellipsoid, drawn wider where it would be thinner than a line.
fn band(
    scene: &mut Scene,
    moments: &[f64; 3],
    semi: &[Point; 3],
    sigmas: Option<[f64; 3]>,
) -> String {
    let Some(sigmas) = sigmas else {
        return "The tensor is not identified: the ellipsoid is that of the nominal numbers, without any claim. ".to_owned();
    };
    let shares = [0, 1, 2].map(|k| 0.5 * NINETY_FIVE * sigmas[k] / moments[k]);
    let widest = shares.iter().copied().fold(0.0, f64::max);
    if !(widest > 0.0 && widest.is_finite()) {
        return String::new();
    }
    let wider = if widest < 0.03 {
        let wanted = 0.08 / widest;
        let power = 10.0_f64.powf(wanted.log10().floor());
        [5.0, 2.0, 1.0]
            .into_iter()
            .map(|f| f * power)
            .find(|w| *w <= wanted)
            .unwrap_or(power)
    } else {
        1.0
    };
    for (side, name) in [(1.0, "95 % band"), (-1.0, "")] {
        let axes = [0, 1, 2].map(|k| {
            let factor: f64 = 1.0 + side * wider * shares[k];
            semi[k].map(|x| x * factor.max(0.02))
        });
        let name = match (name, wider > 1.0) {
            ("", _) => String::new(),
            (name, true) => format!("{name}, drawn {} times too wide", significant(wider, 1)),
            (name, false) => name.to_owned(),
        };
        scene.ellipsoids.push(Ellipsoid {
            name,
            centre: [0.0; 3],
            axes,
            colour: 5,
            faint: true,
        });
    }
    format!(
        "The 95 % interval of the semi-axes is ± {} % at most. ",
        significant(100.0 * widest, 2)
    )
}

/// The motion as poles on the ellipsoid.
struct Poles {
    time_s: Vec<f64>,
    q_NB: Vec<UnitQuaternion<f64>>,
    pole: Vec<Option<Vector3>>,
    normal: Vec<Vector3>,
}

impl Poles {
    fn new(segment: &Segment, I: &Matrix3, size: f64) -> Option<Self> {
        let n = segment.time_s.len();
        let stride = n.div_ceil(INSTANTS).max(1);
        let fastest = segment
            .omega_rad_s
            .iter()
            .map(|w| Vector3::from(*w).norm())
            .fold(0.0, f64::max);
        if !(fastest > 0.0 && fastest.is_finite()) {
            return None;
        }
        let mut poles = Self {
            time_s: Vec::new(),
            q_NB: Vec::new(),
            pole: Vec::new(),
            normal: Vec::new(),
        };
        let all = segment
            .time_s
            .iter()
            .zip(&segment.omega_rad_s)
            .zip(&segment.q_xyzw);
        for ((t, w), q) in all.step_by(stride) {
            let w = Vector3::from(*w);
            let h = I * w;
            let energy = w.dot(&h);
            let seen = w.norm() > SLOW * fastest && energy > 0.0;
            poles.time_s.push(*t);
            let q = Quaternion::new(q[3], q[0], q[1], q[2]);
            poles.q_NB.push(UnitQuaternion::from_quaternion(q));
            poles.pole.push(seen.then(|| w * (size / energy.sqrt())));
            poles.normal.push(if h.norm() > 0.0 {
                h.normalize()
            } else {
                Vector3::z()
            });
        }
        Some(poles)
    }

    /// Least and greatest distance of the plane from the centre, relative to their mean: zero where free.
    fn spread(&self) -> f64 {
        let distances: Vec<f64> = self
            .pole
            .iter()
            .zip(&self.normal)
            .filter_map(|(p, n)| p.map(|p| p.dot(n)))
            .collect();
        let low = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let high = distances.iter().copied().fold(0.0, f64::max);
        (high - low) / (0.5 * (high + low))
    }

    /// How far the normal strays in space from its mean, rad.
    fn stray(&self, mean: &Vector3) -> f64 {
        self.seen()
            .map(|k| (self.q_NB[k] * self.normal[k]).angle(mean))
            .fold(0.0, f64::max)
    }

    fn seen(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.pole.len()).filter(|k| self.pole[*k].is_some())
    }

    fn mean_normal(&self) -> Vector3 {
        let sum: Vector3 = self.seen().map(|k| self.q_NB[k] * self.normal[k]).sum();
        if sum.norm() > 1.0e-9 {
            sum.normalize()
        } else {
            Vector3::z()
        }
    }

    fn add_to(&self, scene: &mut Scene, I: &Matrix3) -> String {
        let mean = self.mean_normal();
        let free = self.spread() < FREE && self.stray(&mean) < FREE;
        let down = UnitQuaternion::rotation_between(&mean, &-Vector3::z()).unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        });
        if free && let Some(at) = self.seen().next() {
            self.momentum_ellipsoid(scene, I, at);
        }
        let point = |p: &Option<Vector3>| p.map(Point::from);
        scene.curves.push(Curve {
            name: if free {
                "polhode"
            } else {
                "path of the pole (polhode)"
            }
            .to_owned(),
            points: self.pole.iter().map(point).collect(),
            colour: 1,
            dashed: false,
            faint: false,
        });
        scene.title.push_str(" and the motion that was measured");
        scene.rolling = Some(Rolling {
            time_s: self.time_s.clone(),
            q_xyzw: self
                .q_NB
                .iter()
                .map(|q| {
                    let q = down * q;
                    [q.i, q.j, q.k, q.w].map(short)
                })
                .collect(),
            pole: self
                .pole
                .iter()
                .map(|p| p.map(|p| Point::from(p).map(short)))
                .collect(),
            normal: self
                .normal
                .iter()
                .map(|n| Point::from(*n).map(short))
                .collect(),
            plane: if free {
                "invariable plane"
            } else {
                "tangent plane, normal I ω"
            }
            .to_owned(),
            from_space: free,
        });
        if free {
            "The body moves freely: its inertia ellipsoid rolls without slip on the invariable plane, and the polhode is \
             where it meets the momentum ellipsoid; seen from space the pole draws the herpolhode on the plane."
                .to_owned()
        } else {
            "Wheels, joints or thrusters drive the body: the plane follows I ω and is not invariable; the pole wanders over \
             the ellipsoid. Directions that the pole never visits tend to be those that the data see least. No pole is drawn where \
             the body is nearly at rest."
                .to_owned()
        }
    }

    /// `x . I^2 x` as at an instant.
    fn momentum_ellipsoid(&self, scene: &mut Scene, I: &Matrix3, at: usize) {
        let (Some(pole), Some((moments, axes))) = (self.pole[at], principal(I)) else {
            return;
        };
        let h = (I * pole).norm();
        scene.ellipsoids.push(Ellipsoid {
            name: "momentum ellipsoid".to_owned(),
            centre: [0.0; 3],
            axes: [0, 1, 2].map(|k| (axes[k] * (h / moments[k])).into()),
            colour: 4,
            faint: true,
        });
    }
}

/// Six figures are enough for a picture.
fn short(x: f64) -> f64 {
    (x * 1.0e6).round() / 1.0e6
}
