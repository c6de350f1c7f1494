//! Flexible modes in the simulated motion, against closed forms, conserved quantities and a hinged panel.

use core::f64::consts::TAU;
use poinsot_dynamics::propagation::Mode;
use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, UnitQuaternion, Vector3};

const MASS: f64 = 120.0;
const C: Vector3 = Vector3::new(0.1, -0.05, 0.2);

fn inertia() -> Matrix3 {
    Matrix3::new(30.0, 1.5, -0.7, 1.5, 24.0, 0.9, -0.7, 0.9, 36.0)
}

fn bus(mass: f64, p_BoBcm_B: Vector3, I_BBcm_B: Matrix3) -> InertialParameters {
    let properties = MassProperties {
        mass,
        p_BoBcm_B,
        I_BBcm_B,
    };
    properties.parameters()
}

fn mode(frequency_Hz: f64, translation: [f64; 3], rotation: [f64; 3]) -> Mode {
    Mode {
        body: 0,
        frequency_Hz,
        damping_ratio: 0.0,
        translation: translation.into(),
        rotation: rotation.into(),
        inertia_slope: Matrix3::zeros(),
    }
}

fn two_modes() -> Vec<Mode> {
    vec![
        mode(0.23, [2.0, -1.0, 0.5], [0.8, 2.1, -1.2]),
        mode(0.41, [-0.7, 1.5, 1.1], [1.4, -0.6, 2.5]),
    ]
}

/// One body with rotors about z at its origin.
fn vehicle(body: InertialParameters, wheels: usize, modes: Vec<Mode>) -> Vehicle {
    let rotor = Rotor {
        body: 0,
        axis_B: Vector3::z(),
    };
    let tree = Tree {
        links: vec![Link::base()],
        rotors: vec![rotor; wheels],
        coordinates: Vec::new(),
    };
    let vehicle = Vehicle::new(tree, vec![body], vec![0.5; wheels], Vec::new());
    Vehicle { modes, ..vehicle }
}

fn turning(w: [f64; 3], v: [f64; 3]) -> Start {
    Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: v.into(),
            w_NB_B: w.into(),
        },
        ..Start::at_rest()
    }
}

fn fly(vehicle: &Vehicle, plan: &Plan, start: &Start, times: &[f64]) -> Vec<MotionSample> {
    let flight = Flight::new(vehicle.clone(), plan, Tolerance::default()).unwrap();
    let mut all = Vec::new();
    flight.run(start, times, |s| all.push(s.clone())).unwrap();
    all
}

fn every(step: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| step * k as f64).collect()
}

/// A torque about z: by the motor of a wheel, or by its speed.
fn spin_up(torque: f64, by_motor: bool) -> Plan {
    let wheel = match by_motor {
        true => WheelMotion::Torque {
            initial_speed: 0.0,
            torque: PiecewisePolynomial::constant(torque),
        },
        false => {
            let speeds = [0.0, torque / 0.5 * 1e3];
            WheelMotion::Speed(PiecewisePolynomial::linear(&[0.0, 1e3], &speeds).unwrap())
        }
    };
    Plan {
        wheels: vec![wheel],
        ..Plan::default()
    }
}

#[test]
fn exact_one_mode_on_one_axis_is_the_two_mass_solution() {
    // J w + z + d y' = 0 and d w' + y'' = -(2 pi f)^2 y under a constant torque z'. Measured: 7e-14.
    let (J, d, f, torque) = (36.0, 4.5, 0.3, 0.02);
    let body = bus(
        MASS,
        Vector3::zeros(),
        Matrix3::from_diagonal(&Vector3::new(30.0, 24.0, J)),
    );
    let vehicle = vehicle(body, 1, vec![mode(f, [0.0; 3], [0.0, 0.0, d])]);
    for by_motor in [true, false] {
        // The host of a rotor with a free axis lacks its inertia.
        let J = if by_motor { J - 0.5 } else { J };
        let frequency = TAU * f / (1.0 - d * d / J).sqrt();
        let pull = d * torque / (J - d * d);
        for s in fly(
            &vehicle,
            &spin_up(torque, by_motor),
            &Start::at_rest(),
            &every(0.7, 100),
        ) {
            let (sine, cosine) = (frequency * s.time).sin_cos();
            let y = pull / frequency.powi(2) * (1.0 - cosine);
            let rate = pull / frequency * sine;
            let w = -(torque * s.time + d * rate) / J;
            let angle = -(torque * s.time.powi(2) / 2.0 + d * y) / J;
            assert!(
                (s.mode_amplitude[0] - y).abs() < 1e-12,
                "{}",
                s.mode_amplitude[0] - y
            );
            assert!((s.mode_rate[0] - rate).abs() < 1e-12);
            assert!((s.w_NB_B.z - w).abs() < 1e-12);
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * angle);
            assert!(s.R_NB.angle_to(&turn) < 1e-12);
        }
    }
}

#[test]
fn exact_energy_and_momentum_are_kept_while_it_tumbles() {
    // Over 1,000 s; measured: 8e-15.
    let modes = two_modes();
    let vehicle = vehicle(bus(MASS, C, inertia()), 0, modes.clone());
    let start = turning([0.3, -0.4, 0.25], [0.02, 0.01, -0.03]);
    let samples = fly(&vehicle, &Plan::default(), &start, &every(2.0, 500));
    let d = |m: &Mode| m.rotation - C.cross(&m.translation);
    let of = |s: &MotionSample| {
        let (w, v) = (&s.w_NB_B, s.R_NB.inverse() * s.v_NBo_N);
        let each = || modes.iter().zip(s.mode_amplitude.iter().zip(&s.mode_rate));
        let h: Vector3 = inertia() * w + each().map(|(m, (_, r))| d(m) * *r).sum::<Vector3>();
        let shift: Vector3 = each().map(|(m, (y, _))| m.translation * *y).sum();
        let slide: Vector3 = each().map(|(m, (_, r))| m.translation * *r).sum();
        let l = (v + w.cross(&C)) * MASS + w.cross(&shift) + slide;
        let springs: f64 = each()
            .map(|(m, (y, r))| 0.5 * (r * r + (TAU * m.frequency_Hz * y).powi(2)))
            .sum();
        let turn = 0.5 * w.dot(&(inertia() * w)) + w.dot(&(h - inertia() * w));
        let energy =
            turn + springs - 0.5 * slide.norm_squared() / MASS + 0.5 * l.norm_squared() / MASS;
        (energy, s.R_NB * l, s.R_NB * h)
    };
    let (energy, l, h) = of(&samples[0]);
    let most = samples
        .iter()
        .map(|s| s.mode_amplitude[1].abs())
        .fold(0.0, f64::max);
    assert!(most > 0.01, "{most}");
    for s in &samples {
        let now = of(s);
        assert!(
            (now.0 - energy).abs() < 1e-13 * energy,
            "{} {}",
            s.time,
            now.0 - energy
        );
        assert!(
            (now.1 - l).norm() < 1e-13 * l.norm(),
            "{}",
            (now.1 - l).norm()
        );
        assert!(
            (now.2 - h).norm() < 1e-13 * h.norm(),
            "{}",
            (now.2 - h).norm()
        );
    }
}

#[test]
fn exact_a_uniform_drift_changes_no_rotation() {
    // Measured: 4e-13.
    let vehicle = vehicle(bus(MASS, C, inertia()), 0, two_modes());
    let (w, drift) = ([0.1, -0.2, 0.15], Vector3::new(3.0, -4.0, 0.0));
    let times = every(1.0, 200);
    let still = fly(&vehicle, &Plan::default(), &turning(w, [0.0; 3]), &times);
    let moving = fly(
        &vehicle,
        &Plan::default(),
        &turning(w, drift.into()),
        &times,
    );
    for (a, b) in still.iter().zip(&moving) {
        assert!(a.R_NB.angle_to(&b.R_NB) < 1e-12);
        assert!((a.w_NB_B - b.w_NB_B).norm() < 1e-12);
        assert!((a.mode_amplitude[0] - b.mode_amplitude[0]).abs() < 1e-12);
        assert!((a.p_NoBo_N + drift * a.time - b.p_NoBo_N).norm() < 1e-10);
    }
}

#[test]
fn exact_a_stiff_mode_acts_as_the_inverse_square_of_its_frequency() {
    let speeds = PiecewisePolynomial::quintic_rest(&[0.0, 60.0], &[0.0, 40.0]).unwrap();
    let plan = Plan {
        wheels: vec![WheelMotion::Speed(speeds)],
        ..Plan::default()
    };
    let body = bus(MASS, C, inertia());
    let times = every(0.5, 120);
    let rigid = fly(
        &vehicle(body, 1, Vec::new()),
        &plan,
        &Start::at_rest(),
        &times,
    );
    let apart = |frequency: f64| {
        let modes = vec![mode(frequency, [2.0, -1.0, 0.5], [0.8, 2.1, -2.2])];
        let soft = fly(&vehicle(body, 1, modes), &plan, &Start::at_rest(), &times);
        let each = soft.iter().zip(&rigid);
        each.map(|(a, b)| (a.w_NB_B - b.w_NB_B).norm())
            .fold(0.0, f64::max)
    };
    let (one, two) = (apart(2.0), apart(4.0));
    assert!(one > 1e-8, "{one}");
    assert!((one / two - 4.0).abs() < 0.05, "{}", one / two);
}

/// A bus and an arm, of which the joint moves as prescribed, a wheel and a thruster; modes of both bodies.
fn arm() -> (Vehicle, Plan) {
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let hinge = Vector3::new(0.5, 0.1, -0.2);
    let tree = Tree {
        links: vec![
            Link::base(),
            Link::new(0, Motion::Revolute(0), hinge, Matrix3::identity(), axis),
        ],
        rotors: vec![Rotor {
            body: 0,
            axis_B: Vector3::new(0.0, 0.6, 0.8),
        }],
        coordinates: vec![0],
    };
    let bodies = vec![
        bus(MASS, C, inertia()),
        bus(
            20.0,
            Vector3::new(0.8, 0.1, 0.0),
            Matrix3::from_diagonal(&Vector3::new(2.0, 5.0, 6.0)),
        ),
    ];
    let nozzle = Nozzle {
        body: 0,
        p_BoT_B: Vector3::new(-0.4, 0.3, 0.1),
        direction_B: Vector3::new(0.0, 0.6, 0.8),
        propellant: None,
    };
    let slope = Matrix3::new(0.3, 0.1, 0.0, 0.1, -0.2, 0.15, 0.0, 0.15, 0.4);
    let mut modes = two_modes();
    modes[1] = Mode {
        body: 1,
        damping_ratio: 0.02,
        inertia_slope: slope,
        ..modes[1]
    };
    let vehicle = Vehicle {
        modes,
        ..Vehicle::new(tree, bodies, vec![0.5], vec![nozzle])
    };
    let swing = JointMotion::quintic_rest(&[0.0, 8.0], &[0.2, 1.4]).unwrap();
    let plan = Plan {
        joints: vec![swing.into()],
        wheels: vec![WheelMotion::Torque {
            initial_speed: 20.0,
            torque: PiecewisePolynomial::constant(0.4),
        }],
        firings: vec![Firing {
            thruster: 0,
            on: 0.0,
            off: 20.0,
            force: 5.0,
        }],
        ..Plan::default()
    };
    (vehicle, plan)
}

#[test]
fn exact_accelerations_are_the_derivatives_of_the_motion() {
    // Measured: 5e-14.
    let (vehicle, plan) = arm();
    let start = turning([0.1, -0.2, 0.15], [0.3, -0.1, 0.2]);
    let step = 0.01;
    for middle in [2.0, 4.5, 7.0] {
        let around: Vec<f64> = (-3..=3).map(|k| middle + step * f64::from(k)).collect();
        let times = [vec![0.0], around].concat();
        let all = fly(&vehicle, &plan, &start, &times);
        let (s, near) = (&all[4], &all[1..]);
        // Differences of sixth order.
        let weights = [-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0];
        let slope = |f: &dyn Fn(&MotionSample) -> Vector3| -> Vector3 {
            let sum: Vector3 = near.iter().zip(weights).map(|(s, x)| f(s) * x).sum();
            sum / (60.0 * step)
        };
        let v = slope(&|s| s.p_NoBo_N);
        assert!((v - s.v_NBo_N).norm() < 1e-12, "{}", (v - s.v_NBo_N).norm());
        let y = slope(&|s| Vector3::new(s.mode_amplitude[0], s.mode_amplitude[1], 0.0));
        assert!((y - Vector3::new(s.mode_rate[0], s.mode_rate[1], 0.0)).norm() < 1e-12);
        for body in 0..2 {
            let a = slope(&|s| s.R_NB * s.kinematics.v[body]) - s.R_NB * s.body.a[body];
            let alpha = slope(&|s| s.R_NB * s.kinematics.w[body]) - s.R_NB * s.body.alpha[body];
            assert!(a.norm() < 1e-12, "{middle} {body}: {}", a.norm());
            assert!(alpha.norm() < 1e-12, "{middle} {body}: {}", alpha.norm());
        }
    }
}

/// The largest differences of the base's rate and of the torque in a locked joint between a panel on a spring hinge and its mode, as
/// a wheel runs up.
fn panel_against_mode(speed: f64) -> [f64; 2] {
    let (hinge, axis) = (Vector3::new(0.5, 0.1, -0.2), Vector3::new(0.6, 0.0, 0.8));
    let (m, c, stiffness) = (20.0, Vector3::new(0.8, 1.0, 0.3), 60.0);
    let own = Matrix3::from_diagonal(&Vector3::new(2.0, 5.0, 6.0));
    let (panel, base) = (bus(m, c, own), bus(MASS, C, inertia()));
    let link = bus(8.0, Vector3::new(0.3, 0.1, 0.2), own * 0.5);
    let rotor = Rotor {
        body: 0,
        axis_B: Vector3::new(0.0, 0.6, 0.8),
    };
    let lock = Link::new(
        0,
        Motion::Revolute(0),
        Vector3::new(-0.3, 0.4, 0.1),
        Matrix3::identity(),
        Vector3::y(),
    );
    let swing = Link::new(1, Motion::Revolute(1), hinge, Matrix3::identity(), axis);
    let tree = |links: Vec<Link>| Tree {
        coordinates: (0..links.len() - 1).collect(),
        rotors: vec![rotor.clone()],
        links,
    };
    let speeds = PiecewisePolynomial::quintic_rest(&[0.0, 10.0], &[0.0, speed]).unwrap();
    let plan = Plan {
        joints: vec![JointMotion::locked(0.7).into()],
        wheels: vec![WheelMotion::Speed(speeds)],
        ..Plan::default()
    };
    let mut swinging = plan.clone();
    swinging.joints.push(JointDrive::Force {
        motor: ForceProfile::none(),
        spring: SpringDamper {
            stiffness,
            rest: 0.0,
            damping: 0.0,
        },
        initial_position: 0.0,
        initial_rate: 0.0,
    });
    let links = tree(vec![Link::base(), lock.clone(), swing]);
    let jointed = Vehicle::new(links, vec![base, link, panel], vec![0.5], Vec::new());
    // Momentum per rate of the hinge while the link is held.
    let moment = axis.dot(&(panel.I_BBo_B * axis));
    let l = axis.cross(&c) * m;
    let h = panel.I_BBo_B * axis + hinge.cross(&l);
    let root = moment.sqrt();
    let frequency = (stiffness / moment).sqrt() / TAU;
    let at = hinge + c;
    let steiner = Matrix3::identity() * at.norm_squared() - at * at.transpose();
    let both = InertialParameters {
        mass: link.mass + m,
        mc_B: link.mc_B + at * m,
        I_BBo_B: link.I_BBo_B + own + steiner * m,
    };
    let one = Mode {
        body: 1,
        ..mode(frequency, (l / root).into(), (h / root).into())
    };
    let links = tree(vec![Link::base(), lock]);
    let modal = Vehicle {
        modes: vec![one],
        ..Vehicle::new(links, vec![base, both], vec![0.5], Vec::new())
    };
    let times = every(0.25, 80);
    let exact = fly(&jointed, &swinging, &Start::at_rest(), &times);
    let modal = fly(&modal, &plan, &Start::at_rest(), &times);
    let largest = |f: &dyn Fn(&MotionSample, &MotionSample) -> f64| {
        exact
            .iter()
            .zip(&modal)
            .map(|(a, b)| f(a, b))
            .fold(0.0, f64::max)
    };
    let torque = |s: &MotionSample| s.motor_force[0];
    [
        largest(&|a, b| (a.w_NB_B - b.w_NB_B).norm()),
        largest(&|a, b| (torque(a) - torque(b)).abs()),
    ]
}

#[test]
fn exact_a_hinged_panel_is_a_mode_up_to_the_square_of_its_amplitude() {
    let (far, near) = (panel_against_mode(2.0), panel_against_mode(1.0));
    for (far, near) in far.into_iter().zip(near) {
        assert!(far > 1e-8, "{far}");
        assert!((far / near - 4.0).abs() < 0.1, "{far} {near}");
    }
}

#[test]
fn unit_what_is_not_simulated_beside_modes_is_refused() {
    let (mut vehicle, mut plan) = arm();
    let refused = |vehicle: &Vehicle, plan: &Plan| {
        Flight::new(vehicle.clone(), plan, Tolerance::default()).err()
    };
    assert_eq!(refused(&vehicle, &plan), None);
    plan.joints[0] = JointDrive::Force {
        motor: ForceProfile::none(),
        spring: SpringDamper::default(),
        initial_position: 0.0,
        initial_rate: 0.0,
    };
    assert!(matches!(
        refused(&vehicle, &plan),
        Some(MotionError::Modes(..))
    ));
    let (_, plan) = arm();
    vehicle.nozzles[0].propellant = Some(Propellant {
        used: 1e-3,
        p_BoF_B: Vector3::zeros(),
    });
    assert!(matches!(
        refused(&vehicle, &plan),
        Some(MotionError::Modes(..))
    ));
}
