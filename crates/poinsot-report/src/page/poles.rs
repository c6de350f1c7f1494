//! The motion as poles on the inertia ellipsoid.

use super::curves::group;
use nalgebra::{Quaternion, UnitQuaternion};
use poinsot_figures::{Curve, Point, Rolling, Scene};
use poinsot_files::counted;
use poinsot_formats::Segment;
use poinsot_spatial::{Matrix3, Vector3};

/// Largest number of instants kept.
pub(super) const INSTANTS: usize = 600;
/// Rates below this fraction of the largest have no drawn pole.
const SLOW: f64 = 0.03;
/// Largest change of momentum relative to energy for torque-free motion.
const FREE: f64 = 0.02;
/// Angle between successive poles, rad, above which the path between them is unknown.
const UNTOLD: f64 = 0.35;
/// Angle between successive points of the drawn polhode, rad.
const FINE: f64 = 0.03;

#[derive(Default)]
pub(super) struct Poles {
    size: f64,
    tensor: Matrix3,
    time_s: Vec<f64>,
    q_NB: Vec<UnitQuaternion<f64>>,
    pole: Vec<Option<Vector3>>,
    normal: Vec<Vector3>,
}

impl Poles {
    pub fn new(segment: &Segment, I: &Matrix3, size: f64) -> Option<Self> {
        let stride = segment.time_s.len().div_ceil(INSTANTS).max(1);
        let rates = segment.omega_rad_s.iter().map(|w| Vector3::from(*w).norm());
        let fastest = rates.fold(0.0, f64::max);
        if !(fastest > 0.0 && fastest.is_finite()) {
            return None;
        }
        let mut poles = Self {
            size,
            tensor: *I,
            ..Self::default()
        };
        let motion = segment.time_s.iter().zip(&segment.omega_rad_s);
        for ((t, w), q) in motion.zip(&segment.q_xyzw).step_by(stride) {
            let w = Vector3::from(*w);
            let h = I * w;
            let seen = w.norm() > SLOW * fastest;
            poles.time_s.push(*t);
            let q = Quaternion::new(q[3], q[0], q[1], q[2]);
            poles.q_NB.push(UnitQuaternion::from_quaternion(q));
            poles.pole.push(poles.on_surface(&w).filter(|_| seen));
            poles.normal.push(unit(&h));
        }
        Some(poles)
    }

    /// Intersection of a direction with the ellipsoid.
    fn on_surface(&self, direction: &Vector3) -> Option<Vector3> {
        let energy = direction.dot(&(self.tensor * direction));
        (energy > 0.0).then(|| direction * (self.size / energy.sqrt()))
    }

    /// Least and greatest distance of the plane from the centre, relative to their mean: zero in torque-free motion.
    fn spread(&self) -> f64 {
        let distances = || {
            let all = self.pole.iter().zip(&self.normal);
            all.filter_map(|(p, n)| p.map(|p| p.dot(n)))
        };
        let (low, high) = (
            distances().fold(f64::INFINITY, f64::min),
            distances().fold(0.0, f64::max),
        );
        (high - low) / (0.5 * (high + low))
    }

    fn in_space(&self) -> impl Iterator<Item = Vector3> + '_ {
        let all = self.pole.iter().zip(&self.q_NB).zip(&self.normal);
        all.filter_map(|((p, q), n)| p.map(|_| q * n))
    }

    /// Largest angle between the normal in space and its mean, rad.
    fn stray(&self, mean: &Vector3) -> f64 {
        self.in_space().map(|n| n.angle(mean)).fold(0.0, f64::max)
    }

    /// The polhode with its times as fractions: great arcs between poles, broken where the path is unknown.
    fn polhode(&self) -> (Vec<Option<Point>>, Vec<f64>) {
        let (mut points, mut shares) = (Vec::new(), Vec::new());
        let last = (self.pole.len().max(2) - 1) as f64;
        let mut before: Option<Vector3> = None;
        for (k, pole) in self.pole.iter().enumerate() {
            let angle = before
                .zip(*pole)
                .map_or(f64::INFINITY, |(a, b)| a.angle(&b));
            match (before, *pole) {
                (Some(a), Some(b)) if angle < UNTOLD => {
                    let steps = (angle / FINE).ceil().max(1.0) as usize;
                    for step in 1..=steps {
                        let s = step as f64 / steps as f64;
                        let between = unit(&a).lerp(&unit(&b), s);
                        points.push(self.on_surface(&between).map(point));
                        shares.push(short((k as f64 - 1.0 + s) / last));
                    }
                }
                (_, pole) => {
                    points.extend([None, pole.map(point)]);
                    shares.extend([short(k as f64 / last); 2]);
                }
            }
            before = *pole;
        }
        (points, shares)
    }

    /// Adds polhode and motion; returns a note.
    pub fn add_to(&self, scene: &mut Scene, record: usize) -> String {
        let mean = unit(&self.in_space().sum());
        let free = self.spread() < FREE && self.stray(&mean) < FREE;
        let down = UnitQuaternion::rotation_between(&mean, &-Vector3::z()).unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        });
        let (points, shares) = self.polhode();
        let broken = points
            .windows(3)
            .filter(|w| w[0].is_some() && w[1].is_none() && w[2].is_some())
            .count();
        let (curve, plane) = match free {
            true => ("polhode and herpolhode", "invariable plane"),
            false => ("polhode", "tangent plane, normal I omega"),
        };
        scene.curves.push(Curve {
            name: format!("{curve}, dark to light with time"),
            points,
            colour: 1,
            shares: Some(shares),
            ..Curve::default()
        });
        let turned = self.q_NB.iter().map(|q| down * q);
        scene.rolling = Some(Rolling {
            time_s: self.time_s.clone(),
            q_xyzw: turned.map(|q| [q.i, q.j, q.k, q.w].map(short)).collect(),
            pole: self.pole.iter().map(|p| p.map(point)).collect(),
            normal: self.normal.iter().copied().map(point).collect(),
            plane: plane.to_owned(),
            free,
            group: group(record),
        });
        let gaps = match broken {
            0 => String::new(),
            n => format!(
                " The polhode is broken at {} where samples are too sparse for the path.",
                counted(n, "place")
            ),
        };
        let motion = if free {
            "The body moves freely: the ellipsoid rolls without slip on the invariable plane."
        } else {
            "Wheels, joints or thrusters drive the body: its angular momentum is not constant, so there is no herpolhode. No pole is drawn where the body is nearly at rest."
        };
        format!("{motion}{gaps}")
    }
}

/// Rounds to five digits, enough for a picture.
fn short(x: f64) -> f64 {
    (x * 1.0e5).round() / 1.0e5
}

fn point(p: Vector3) -> Point {
    Point::from(p).map(short)
}

/// Components of a unit vector.
fn unit(v: &Vector3) -> Vector3 {
    v.try_normalize(0.0).unwrap_or_else(Vector3::z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_the_polhode_lies_on_the_ellipsoid_and_breaks_where_nothing_tells() {
        let I = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5));
        let angle = |k: i32| {
            if k < 20 {
                0.2 * f64::from(k)
            } else {
                0.2 * f64::from(k) + 2.5
            }
        };
        let segment = Segment {
            time_s: (0..40).map(f64::from).collect(),
            omega_rad_s: (0..40)
                .map(|k| [angle(k).cos(), angle(k).sin(), 0.4])
                .collect(),
            q_xyzw: vec![[0.0, 0.0, 0.0, 1.0]; 40],
            ..Segment::default()
        };
        let poles = Poles::new(&segment, &I, 1.0).unwrap();
        let (points, shares) = poles.polhode();
        assert_eq!(points.len(), shares.len());
        for p in points.iter().flatten() {
            let p = Vector3::from(*p);
            assert!((p.dot(&(I * p)) - 1.0).abs() < 1.0e-4);
        }
        // Breaks before the first point, and at the jump of 2.5 rad.
        assert_eq!(points.iter().filter(|p| p.is_none()).count(), 2);
        for pair in points.windows(2) {
            if let [Some(a), Some(b)] = pair {
                assert!(Vector3::from(*a).angle(&Vector3::from(*b)) < 1.2 * FINE);
            }
        }
    }
}
