//! Measurement models of every kind: derivatives against differences.

use poinsot_dynamics::*;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Step of the central differences.
const STEP: f64 = 1.0e-5;
/// Their error: a third derivative times the square of the step, and round-off.
const CLOSE: f64 = 1.0e-8;

/// A base and a chain of three bodies.
fn chain() -> Tree {
    let turned = |angle: f64| {
        let turn = UnitQuaternion::from_euler_angles(angle, 0.2, -0.4);
        *turn.to_rotation_matrix().matrix()
    };
    let link = |parent, motion, angle, axis| {
        let p_PoCo_P = Vector3::new(0.5, 0.1 * angle, -0.2);
        Link::new(parent, motion, p_PoCo_P, turned(angle), axis)
    };
    Tree {
        links: [
            Link::base(),
            link(0, Motion::Revolute(0), 0.3, Vector3::z()),
            link(1, Motion::Revolute(1), -1.1, Vector3::new(0.6, 0.0, 0.8)),
            link(2, Motion::Prismatic(2), 0.8, Vector3::y()),
        ]
        .into(),
        rotors: [].into(),
        coordinates: [0, 1, 2].into(),
    }
}

/// Motion of base and joints.
#[derive(Clone)]
struct Here {
    pose: BasePose,
    twist: Twist,
    q: [f64; 3],
    rates: [f64; 3],
}

impl Here {
    fn new() -> Self {
        Self {
            pose: BasePose {
                R_NB: UnitQuaternion::from_euler_angles(0.4, -0.9, 1.3),
                p_NoBo_N: Vector3::new(1.0, -2.0, 0.5),
            },
            twist: Twist {
                v: Vector3::new(0.2, -0.1, 0.3),
                w: Vector3::new(-0.3, 0.5, 0.2),
            },
            q: [0.7, -0.4, 0.3],
            rates: [0.6, -0.8, 0.25],
        }
    }

    /// A point of a body.
    fn point(&self, tree: &Tree, body: usize, p_BioP_Bi: &Vector3) -> PointMotion {
        let mut kinematics = Kinematics::at(tree, &self.q);
        kinematics.set_velocities(tree, &self.twist.v, &self.twist.w, &self.rates);
        PointMotion::new(&kinematics, body, p_BioP_Bi)
    }
}

/// A sensor of a kind: its body, and the one from which it sees.
#[derive(Clone, Copy)]
struct Placed {
    kind: SensorKind,
    body: usize,
    from: usize,
}

impl Placed {
    const PLACE: Vector3 = Vector3::new(0.3, -0.2, 0.1);

    fn with<T>(&self, tree: &Tree, here: &Here, of: impl Fn(&Scene) -> T) -> T {
        of(&Scene {
            pose: &here.pose,
            point: &here.point(tree, self.body, &Self::PLACE),
            from: &here.point(tree, self.from, &Vector3::zeros()),
            reference_N: Some(Vector3::new(0.6, -0.48, 0.64)),
            a_NP_B: None,
        })
    }

    fn value(&self, tree: &Tree, here: &Here) -> Ideal {
        let measure = |scene: &Scene| self.kind.measure(scene).unwrap().value;
        self.with(tree, here, measure)
    }

    /// Derivative of the measurement along a change of the motion.
    fn difference(&self, tree: &Tree, change: impl Fn(&mut Here, f64)) -> Vector3 {
        let end = |step: f64| {
            let mut here = Here::new();
            change(&mut here, step);
            self.value(tree, &here)
        };
        match (end(-STEP), end(STEP)) {
            (Ideal::Vector(a), Ideal::Vector(b)) => (b - a) / (2.0 * STEP),
            (Ideal::Rotation(a), Ideal::Rotation(b)) => {
                (a.inverse() * b).scaled_axis() / (2.0 * STEP)
            }
            _ => panic!("one kind has one sort of value"),
        }
    }
}

/// Effect of a joint on a point, by differences of its placement.
fn effect(tree: &Tree, joint: usize, (body, p): (usize, &Vector3)) -> JointEffect {
    let end = |step: f64| {
        let mut here = Here::new();
        here.q[joint] += step;
        here.point(tree, body, p)
    };
    let (a, b) = (end(-STEP), end(STEP));
    let slope = |a: Vector3, b: Vector3| (b - a) / (2.0 * STEP);
    let skewed: Matrix3 = (b.R - a.R) / (2.0 * STEP) * end(0.0).R.transpose();
    JointEffect {
        turn: Vector3::new(skewed[(2, 1)], skewed[(0, 2)], skewed[(1, 0)]),
        shift: slope(a.r, b.r),
        w: slope(a.w, b.w),
        v: slope(a.v, b.v),
    }
}

fn sensors() -> impl Iterator<Item = Placed> {
    // The derivatives of an accelerometer are those of the equation of motion.
    let kinds = SensorKind::with_axes().filter(|kind| *kind != SensorKind::Accelerometer);
    kinds.flat_map(|kind| {
        let places: &[(usize, usize)] = match kind.is_relative() {
            true => &[(3, 0), (0, 3), (3, 1), (1, 3)],
            false => &[(0, 0), (2, 0), (3, 0)],
        };
        let placed = move |(body, from): &(usize, usize)| Placed {
            kind,
            body: *body,
            from: *from,
        };
        places.iter().map(placed)
    })
}

fn unit(k: usize) -> Vector3 {
    let mut e = Vector3::zeros();
    e[k] = 1.0;
    e
}

#[test]
fn exact_slopes_over_the_base_are_differences() {
    let tree = chain();
    for sensor in sensors() {
        let here = Here::new();
        let found = sensor.with(&tree, &here, |scene| sensor.kind.measure(scene).unwrap());
        let close = |slope: Vector3, other: Vector3, what: &str| {
            let gap = (slope - other).amax();
            let Placed { kind, body, from } = sensor;
            assert!(gap < CLOSE, "{kind:?} {body} {from} {what}: {gap:e}");
        };
        for k in 0..3 {
            let turn = sensor.difference(&tree, |here, d| {
                here.pose.R_NB *= UnitQuaternion::from_scaled_axis(unit(k) * d);
            });
            close(found.pose.column(k).into(), turn, "turn");
            let shift = sensor.difference(&tree, |here, d| here.pose.p_NoBo_N += unit(k) * d);
            close(found.pose.column(k + 3).into(), shift, "shift");
            let v = sensor.difference(&tree, |here, d| here.twist.v += unit(k) * d);
            close(found.twist.column(k).into(), v, "v");
            let w = sensor.difference(&tree, |here, d| here.twist.w += unit(k) * d);
            close(found.twist.column(k + 3).into(), w, "w");
        }
        if let Some(rate) = found.rate {
            let along = sensor.difference(&tree, |here, d| {
                here.pose.p_NoBo_N += here.pose.R_NB * here.twist.v * d;
                here.pose.R_NB *= UnitQuaternion::from_scaled_axis(here.twist.w * d);
                let pairs = here.q.iter_mut().zip(here.rates);
                pairs.for_each(|(q, rate)| *q += rate * d);
            });
            close(rate, along, "rate");
        }
    }
}

#[test]
fn exact_slopes_over_joints_are_differences() {
    let tree = chain();
    let mut compared = 0;
    for sensor in sensors() {
        let Placed { kind, body, from } = sensor;
        for joint in 0..3 {
            let position = sensor.difference(&tree, |here, d| here.q[joint] += d);
            let rate = sensor.difference(&tree, |here, d| here.rates[joint] += d);
            // A joint of the chain carries all bodies behind it.
            let carries = |body: usize| body > joint;
            let own = effect(&tree, joint, (body, &Placed::PLACE));
            let other = effect(&tree, joint, (from, &Vector3::zeros()));
            let carried = match (carries(body), carries(from) && kind.is_relative()) {
                (true, false) => Some(Carried::Point(&own)),
                (false, true) => Some(Carried::From(&other)),
                _ => None,
            };
            let slope = |carried| {
                let over = |scene: &Scene| kind.over_joint(scene, carried);
                sensor.with(&tree, &Here::new(), over).unwrap()
            };
            let nothing = OverJoint {
                position: Vector3::zeros(),
                rate: Vector3::zeros(),
            };
            let found = carried.map_or(nothing, slope);
            let gaps = [found.position - position, found.rate - rate];
            for gap in gaps.map(|gap| gap.amax()) {
                assert!(gap < CLOSE, "{kind:?} {body} {from} joint {joint}: {gap:e}");
            }
            compared += usize::from(carried.is_some());
        }
    }
    assert!(compared > 30, "{compared}");
}

#[test]
fn exact_effects_of_a_joint_are_differences() {
    let (tree, here) = (chain(), Here::new());
    let mut kinematics = Kinematics::at(&tree, &here.q);
    kinematics.set_velocities(&tree, &here.twist.v, &here.twist.w, &here.rates);
    for body in 1..tree.bodies() {
        let point = PointMotion::new(&kinematics, body, &Placed::PLACE);
        for joint in 0..body {
            let found = JointEffect::new(&tree, &kinematics, joint + 1, &point);
            let other = effect(&tree, joint, (body, &Placed::PLACE));
            let gaps = [
                found.turn - other.turn,
                found.shift - other.shift,
                found.w - other.w,
                found.v - other.v,
            ];
            for gap in gaps.map(|gap| gap.amax()) {
                assert!(gap < CLOSE, "body {body} joint {joint}: {gap:e}");
            }
        }
    }
}
