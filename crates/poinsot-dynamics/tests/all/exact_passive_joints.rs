//! Passive joints in the momentum form, against the articulated bodies of the simulation and against differences.

use poinsot_dynamics::propagation::*;
use poinsot_dynamics::*;
use poinsot_spatial::{
    InertialParameters, MassProperties, Matrix3, UnitQuaternion, Vector3, Vector6,
};

/// Coordinates that springs move, and the others.
const PASSIVE: [usize; 3] = [0, 1, 3];
const DRIVEN: [usize; 2] = [2, 4];
const FORCE: Vector3 = Vector3::new(0.6, -0.9, 0.5);

fn body(mass: f64, c: [f64; 3], size: f64) -> InertialParameters {
    let I = Matrix3::new(3.0, 0.2, -0.1, 0.2, 2.5, 0.3, -0.1, 0.3, 2.0) * size;
    let properties = MassProperties {
        mass,
        p_BoBcm_B: c.into(),
        I_BBcm_B: I,
    };
    properties.parameters()
}

fn springs() -> [SpringDamper; 3] {
    [(1.5, 0.2, 0.1), (9.0, -0.05, 0.3), (0.8, -0.3, 0.0)].map(|(stiffness, rest, damping)| {
        SpringDamper {
            stiffness,
            rest,
            damping,
        }
    })
}

/// A base with two branches: a hinge that carries a slide and a driven joint, and a driven joint that carries a hinge.
fn vehicle() -> Vehicle {
    let turned = |x, y, z| {
        *UnitQuaternion::from_euler_angles(x, y, z)
            .to_rotation_matrix()
            .matrix()
    };
    let link = |parent, motion, p: [f64; 3], R, axis: [f64; 3]| {
        let axis = Vector3::from(axis).normalize();
        Link::new(parent, motion, p.into(), R, axis)
    };
    let links = vec![
        Link::base(),
        link(
            0,
            Motion::Revolute(0),
            [0.5, 0.1, 0.2],
            turned(0.3, -0.2, 0.5),
            [0.0, 0.6, 0.8],
        ),
        link(
            1,
            Motion::Prismatic(1),
            [0.4, 0.0, -0.1],
            turned(-0.6, 0.1, 0.0),
            [1.0, 0.3, 0.0],
        ),
        link(
            0,
            Motion::Revolute(2),
            [-0.5, 0.2, 0.0],
            Matrix3::identity(),
            [1.0, 0.0, 0.0],
        ),
        link(
            3,
            Motion::Revolute(3),
            [0.0, 0.7, 0.1],
            turned(0.0, 0.4, 0.2),
            [0.0, 0.0, 1.0],
        ),
        link(
            1,
            Motion::Revolute(4),
            [0.0, 0.3, 0.3],
            turned(0.1, 0.0, 0.7),
            [0.2, 1.0, 0.0],
        ),
    ];
    let rotor = |body, axis: [f64; 3]| Rotor {
        body,
        axis_B: Vector3::from(axis).normalize(),
    };
    let tree = Tree {
        links,
        rotors: vec![rotor(0, [0.0, 0.0, 1.0]), rotor(3, [0.3, 1.0, 0.0])],
        coordinates: (0..5).collect(),
    };
    let bodies = vec![
        body(60.0, [0.1, -0.05, 0.2], 4.0),
        body(5.0, [0.3, 0.1, 0.0], 0.3),
        body(4.0, [0.0, 0.2, 0.1], 0.1),
        body(7.0, [0.0, 0.3, -0.1], 0.4),
        body(6.0, [0.4, 0.0, 0.1], 0.2),
        body(3.0, [0.1, 0.2, 0.3], 0.1),
    ];
    let nozzle = Nozzle {
        body: 0,
        p_BoT_B: Vector3::new(0.2, 0.3, -0.4),
        direction_B: FORCE.normalize(),
        propellant: None,
    };
    Vehicle::new(tree, bodies, vec![0.05, 0.03], vec![nozzle])
}

fn passive_joints(tree: &Tree) -> PassiveJoints {
    let each = PASSIVE.into_iter().zip(springs());
    PassiveJoints::new(
        tree,
        each.map(|(coordinate, spring)| PassiveJoint { coordinate, spring }),
    )
}

/// What the internal equations give.
struct Found {
    motion: FlexibleMotion,
    rate: Internal,
    flexible: Flexibility,
    kinematics: Kinematics,
    still: JointSlopes,
}

fn equations(vehicle: &Vehicle, state: &FlexibleState, [q, rates, wheels]: [&[f64]; 3]) -> Found {
    let (tree, passive) = (&vehicle.tree, passive_joints(&vehicle.tree));
    let (mut q, mut rates) = (q.to_vec(), rates.to_vec());
    for (k, joint) in passive.joints().iter().enumerate() {
        (q[joint.coordinate], rates[joint.coordinate]) = (state.internal[2 * k], 0.0);
    }
    let none = Vector3::zeros();
    let mut kinematics = Kinematics::at(tree, &q);
    kinematics.set_velocities(tree, &none, &none, &rates);
    let (whole, joints) = composite_and_momentum(&vehicle.bodies, &kinematics);
    let h = wheel_momentum(tree, &kinematics, &vehicle.spin_inertia, wheels);
    let joints = joints + Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z);
    let locked = LockedVehicle::new(&whole, &whole, &joints).unwrap();
    let mut still = JointSlopes::default();
    still.fill(
        tree,
        &vehicle.bodies,
        &kinematics,
        &vehicle.spin_inertia,
        wheels,
    );
    let placed = (&passive, &still);
    let flexible = Flexibility::with_joints(&[], placed, &kinematics, &locked).unwrap();
    let motion = flexible.motion(&locked, state).unwrap();
    let rate = flexible.rate(&motion, &state.internal, &FORCE);
    for (k, joint) in passive.joints().iter().enumerate() {
        rates[joint.coordinate] = motion.rates[k];
    }
    kinematics.set_velocities(tree, &motion.twist.v, &motion.twist.w, &rates);
    Found {
        motion,
        rate,
        flexible,
        kinematics,
        still,
    }
}

/// The momentum of each passive joint in a simulated motion, from the bodies that it carries.
fn momenta(vehicle: &Vehicle, sample: &MotionSample) -> [f64; 3] {
    let (tree, k) = (&vehicle.tree, &sample.kinematics);
    let mass: f64 = vehicle.bodies.iter().map(|b| b.mass).sum();
    let u = sample.R_NB.inverse() * sample.l_S_N / mass;
    PASSIVE.map(|coordinate| {
        let joint = SubtreeMotion::of_joint(tree, coordinate).unwrap();
        let carried = |mut body: usize| {
            while body > joint.link {
                body = tree.links[body].parent;
            }
            body == joint.link
        };
        let (mut l, mut h) = (Vector3::zeros(), Vector3::zeros());
        for (i, own) in vehicle
            .bodies
            .iter()
            .enumerate()
            .filter(|(i, _)| carried(*i))
        {
            let (dl, dh) = body_momentum(own, &k.R[i], &k.p[i], &(k.v[i] - u), &k.w[i]);
            (l, h) = (l + dl, h + dh);
        }
        for (j, rotor) in tree
            .rotors
            .iter()
            .enumerate()
            .filter(|(_, r)| carried(r.body))
        {
            h += k.R[rotor.body] * rotor.axis_B * vehicle.spin_inertia[j] * sample.wheel_speed[j];
        }
        let axis = joint.axis_B(k);
        match joint.turns {
            true => axis.dot(&(h - k.p[joint.link].cross(&l))),
            false => axis.dot(&l),
        }
    })
}

fn state(vehicle: &Vehicle, sample: &MotionSample) -> FlexibleState {
    let mut internal = Internal::zeros();
    for (k, p) in momenta(vehicle, sample).into_iter().enumerate() {
        (internal[2 * k], internal[2 * k + 1]) = (sample.q[PASSIVE[k]], p);
    }
    let rigid = PoseMomentum {
        R_NB: sample.R_NB,
        p_NoBo_N: sample.p_NoBo_N,
        P: sample.l_S_N,
        h_SScm_N: sample.h_SScm_N,
    };
    FlexibleState { rigid, internal }
}

/// A tumble with drift, swinging joints, moving ones, wheels and thrust, at seven times around each of some.
fn flown(vehicle: &Vehicle, step: f64) -> Vec<MotionSample> {
    let free = |k: usize, initial_position: f64, initial_rate: f64| JointDrive::Force {
        motor: ForceProfile::none(),
        spring: springs()[k],
        initial_position,
        initial_rate,
    };
    let smooth = |to: f64| PiecewisePolynomial::quintic_rest(&[0.0, 9.0], &[0.0, to]).unwrap();
    let driven = |to: f64| {
        JointMotion::quintic_rest(&[0.0, 9.0], &[0.0, to])
            .unwrap()
            .into()
    };
    let plan = Plan {
        joints: vec![
            free(0, 1.1, -0.3),
            free(1, 0.1, 0.2),
            driven(1.4),
            free(2, -0.9, 0.5),
            driven(-1.0),
        ],
        wheels: [120.0, -90.0]
            .map(|to| WheelMotion::Speed(smooth(to)))
            .to_vec(),
        firings: vec![Firing {
            thruster: 0,
            on: -1.0,
            off: 20.0,
            force: FORCE.norm(),
        }],
        ..Plan::default()
    };
    let start = Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(4.0, -3.0, 2.0),
            w_NB_B: Vector3::new(0.2, -0.15, 0.3),
        },
        ..Start::at_rest()
    };
    let around = |middle: f64| (-3..=3).map(move |k| middle + step * f64::from(k));
    let times: Vec<f64> = [1.0, 3.7, 6.2].into_iter().flat_map(around).collect();
    let flight = Flight::new(vehicle.clone(), &plan, Tolerance::default()).unwrap();
    let mut all = Vec::new();
    flight.run(&start, &times, |s| all.push(s.clone())).unwrap();
    all
}

#[test]
fn exact_passive_joints_move_as_articulated_bodies() {
    let (vehicle, step) = (vehicle(), 0.01);
    for around in flown(&vehicle, step).chunks_exact(7) {
        let now = &around[3];
        let state = state(&vehicle, now);
        let found = equations(&vehicle, &state, [&now.q, &now.rates, &now.wheel_speed]);
        let v = now.R_NB.inverse() * now.v_NBo_N;
        assert!((found.motion.twist.v - v).amax() < 1.0e-11);
        assert!((found.motion.twist.w - now.w_NB_B).amax() < 1.0e-11);
        let all: Vec<[f64; 3]> = around.iter().map(|s| momenta(&vehicle, s)).collect();
        for (k, coordinate) in PASSIVE.into_iter().enumerate() {
            assert!((found.motion.rates[k] - now.rates[coordinate]).abs() < 1.0e-11);
            let pair = |d: usize| all[3 + d][k] - all[3 - d][k];
            let slope = (45.0 * pair(1) - 9.0 * pair(2) + pair(3)) / (60.0 * step);
            let rate = found.rate[2 * k + 1];
            assert!((rate - slope).abs() < 1.0e-8, "{k}: {rate} {slope}");
            assert!(rate.abs() > 1.0e-3);
        }
    }
}

/// Twist, then rate of the internal state.
fn numbers(found: &Found) -> Vec<f64> {
    let twist = &found.motion.twist;
    let twist = twist.v.iter().chain(twist.w.iter());
    twist.chain(found.rate.iter()).copied().collect()
}

fn slope(f: impl Fn(f64) -> Found) -> Vec<f64> {
    let step = 1.0e-4;
    let [a, b, c, d] = [2.0, 1.0, -1.0, -2.0].map(|k| numbers(&f(k * step)));
    let each = (0..a.len()).map(|i| (8.0 * (b[i] - c[i]) - (a[i] - d[i])) / (12.0 * step));
    each.collect()
}

fn check(what: &str, found: impl IntoIterator<Item = f64>, expected: Vec<f64>) {
    for (i, (found, expected)) in found.into_iter().zip(expected).enumerate() {
        let off = (found - expected).abs() / (1.0 + expected.abs());
        assert!(off < 1.0e-8, "{what} {i}: {found} {expected}");
    }
}

#[test]
fn exact_slopes_over_the_state_are_those_of_differences() {
    let vehicle = vehicle();
    let now = &flown(&vehicle, 0.01)[10];
    let here = state(&vehicle, now);
    let inputs = [&now.q[..], &now.rates, &now.wheel_speed];
    let found = equations(&vehicle, &here, inputs);
    let (mut map, mut rows) = (found.motion.twist_rows(&here.rigid), ModeRows::default());
    (found.flexible).rows(&found.motion, &here.rigid, (&mut map, &mut rows), &FORCE);
    let matrix = map.matrix();
    for column in 0..12 {
        let moved = |d: f64| {
            let (mut state, unit) = (here, Vector3::ith(column % 3, d));
            match column / 3 {
                0 => state.rigid.R_NB *= UnitQuaternion::from_scaled_axis(unit),
                1 => state.rigid.p_NoBo_N += unit,
                2 => state.rigid.P += unit,
                _ => state.rigid.h_SScm_N += unit,
            }
            equations(&vehicle, &state, inputs)
        };
        let internal = rows.rate_over_state(column);
        let own = matrix
            .column(column)
            .iter()
            .chain(&internal)
            .copied()
            .collect::<Vec<_>>();
        check("state", own, slope(moved));
    }
    for number in 0..6 {
        let moved = |d: f64| {
            let mut state = here;
            state.internal[number] += d;
            equations(&vehicle, &state, inputs)
        };
        let mut column = Column::zeros();
        column[12 + number] = 1.0;
        let twist = rows.twist_times(&column);
        let internal: [f64; 6] = std::array::from_fn(|row| rows.slope(12 + row, 12 + number));
        check(
            "internal",
            twist.iter().chain(&internal).copied().collect::<Vec<_>>(),
            slope(moved),
        );
    }
}

#[test]
fn exact_slopes_over_bodies_and_springs_are_those_of_differences() {
    let vehicle = vehicle();
    let now = &flown(&vehicle, 0.01)[10];
    let here = state(&vehicle, now);
    let inputs = [&now.q[..], &now.rates, &now.wheel_speed];
    let found = equations(&vehicle, &here, inputs);
    let passive = passive_joints(&vehicle.tree);
    let k = &found.kinematics;
    for body in 0..vehicle.tree.bodies() {
        let mut columns = [[0.0; 6]; 10];
        body_regressor(k, body, &mut columns);
        for (parameter, momentum) in columns.iter().enumerate() {
            let dmc = match parameter {
                0 => k.p[body],
                axis @ 1..=3 => k.R[body].column(axis - 1).into(),
                _ => Vector3::zeros(),
            };
            let dm = f64::from(u8::from(parameter == 0));
            let dc = found
                .motion
                .mass_centre_slope(&k.R[body], &k.p[body], parameter);
            let momentum = Vector6::from(*momentum);
            let own = OneBody {
                over: passive.over(body),
                momentum,
                dm,
                dmc,
            };
            let mut of = BodyChange {
                dc,
                dm,
                ..BodyChange::default()
            };
            found
                .flexible
                .add_body(&found.motion, (&mut of.held, &own), &FORCE);
            let twist = found.motion.twist_slope(&momentum, &dc);
            let change = found
                .flexible
                .with_bodies((&found.motion, &here.internal), &twist, &of);
            let lighter = -FORCE * (dm / found.motion.centre.mass);
            let rate = found.flexible.rate_change(&found.motion, &change, &lighter);
            let moved = |d: f64| {
                let mut other = vehicle.clone();
                let mut numbers = other.bodies[body].to_array();
                numbers[parameter] += d;
                other.bodies[body] = InertialParameters::from_array(&numbers);
                equations(&other, &here, inputs)
            };
            let own = change
                .twist
                .iter()
                .chain(&rate)
                .copied()
                .collect::<Vec<_>>();
            check(&format!("body {body} {parameter}"), own, slope(moved));
        }
    }
    let off = found
        .flexible
        .with_spring((&found.motion, &here.internal), (2, SpringNumber::Rest));
    assert_eq!(off, (5, springs()[2].stiffness));
}

#[test]
fn exact_slopes_over_driven_joints_are_those_of_differences() {
    let vehicle = vehicle();
    let now = &flown(&vehicle, 0.01)[10];
    let here = state(&vehicle, now);
    let inputs = [&now.q[..], &now.rates, &now.wheel_speed];
    let found = equations(&vehicle, &here, inputs);
    let passive = passive_joints(&vehicle.tree);
    let mut slopes = JointSlopes::default();
    let (bodies, spin) = (&vehicle.bodies, &vehicle.spin_inertia);
    slopes.fill(
        &vehicle.tree,
        bodies,
        &found.kinematics,
        spin,
        &now.wheel_speed,
    );
    // As the joints were placed.
    let (none, mut rates) = (Vector3::zeros(), now.rates.clone());
    PASSIVE.iter().for_each(|k| rates[*k] = 0.0);
    let mut still = found.kinematics.clone();
    still.set_velocities(&vehicle.tree, &none, &none, &rates);
    for coordinate in DRIVEN {
        let motion = SubtreeMotion::of_joint(&vehicle.tree, coordinate).unwrap();
        let joint = passive.hinge(&motion, &found.still, &still);
        for (what, by) in [("position", [1.0, 0.0]), ("rate", [0.0, 1.0])] {
            let slope_of = &slopes.of[coordinate];
            let momentum = slope_of.position * by[0] + slope_of.rate * by[1];
            let dc = slope_of.first_moment * (by[0] / found.motion.centre.mass);
            let mut of = BodyChange {
                dc,
                ..BodyChange::default()
            };
            found
                .flexible
                .add_joint(&found.motion, (&mut of.held, &joint), by, &FORCE);
            let twist = found.motion.twist_slope(&momentum, &dc);
            let change = found
                .flexible
                .with_bodies((&found.motion, &here.internal), &twist, &of);
            let rate = found
                .flexible
                .rate_change(&found.motion, &change, &Vector3::zeros());
            let moved = |d: f64| {
                let (mut q, mut rates) = (now.q.clone(), now.rates.clone());
                (q[coordinate], rates[coordinate]) =
                    (q[coordinate] + d * by[0], rates[coordinate] + d * by[1]);
                equations(&vehicle, &here, [&q, &rates, &now.wheel_speed])
            };
            let own = change
                .twist
                .iter()
                .chain(&rate)
                .copied()
                .collect::<Vec<_>>();
            check(&format!("joint {coordinate} {what}"), own, slope(moved));
        }
    }
}

#[test]
fn exact_a_free_wheel_is_a_passive_joint_without_a_spring() {
    // A rotor about z on a body about z: both keep their share of the momentum.
    let rotor = body(2.0, [0.0; 3], 0.0);
    let rotor = InertialParameters {
        I_BBo_B: Matrix3::from_diagonal(&Vector3::new(0.1, 0.1, 0.2)),
        ..rotor
    };
    let hinge = Link::new(
        0,
        Motion::Revolute(0),
        Vector3::zeros(),
        Matrix3::identity(),
        Vector3::z(),
    );
    let tree = Tree {
        links: vec![Link::base(), hinge],
        rotors: vec![],
        coordinates: vec![0],
    };
    let box_of = InertialParameters {
        I_BBo_B: Matrix3::from_diagonal(&Vector3::new(4.0, 5.0, 6.0)),
        ..body(50.0, [0.0; 3], 0.0)
    };
    let bodies = [box_of, rotor];
    let spring = SpringDamper::default();
    let joint = PassiveJoint {
        coordinate: 0,
        spring,
    };
    let passive = PassiveJoints::new(&tree, [joint].into_iter());
    let kinematics = Kinematics::new(&tree);
    let whole = composite(&bodies, &kinematics);
    let locked = LockedVehicle::new(&whole, &whole, &Vector6::zeros()).unwrap();
    let mut still = JointSlopes::default();
    still.fill(&tree, &bodies, &kinematics, &[], &[]);
    let placed = (&passive, &still);
    let flexible = Flexibility::with_joints(&[], placed, &kinematics, &locked).unwrap();
    let mut state = FlexibleState::from(PoseMomentum {
        R_NB: UnitQuaternion::identity(),
        p_NoBo_N: Vector3::zeros(),
        P: Vector3::zeros(),
        h_SScm_N: Vector3::zeros(),
    });
    state.rigid.h_SScm_N = Vector3::new(0.0, 0.0, 1.5);
    state.internal[1] = 0.6;
    let motion = flexible.motion(&locked, &state).unwrap();
    // h = 6 w + 0.2 (w + q'), pi = 0.2 (w + q').
    let w = (1.5 - 0.6) / 6.0;
    assert!((motion.twist.w.z - w).abs() < 1.0e-14);
    assert!((motion.rates[0] - (0.6 / 0.2 - w)).abs() < 1.0e-14);
    assert_eq!(
        flexible.rate(&motion, &state.internal, &Vector3::zeros())[1],
        0.0
    );
}
