//! The step of pose and momentum.

use crate::xu_arm;
use poinsot_dynamics::propagation::{
    LockedVehicle, PoseMomentum, PoseMomentumRate, Rates, StepPoint, runge_kutta_step,
};
use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::compare::attitude_apart;
use poinsot_testkit::rigid_body::{AsymmetricTop, Spin};
use std::ops::AddAssign;

/// What drives a vehicle at one time: joint positions, joint rates and wheel speeds.
type Inputs<'a> = [&'a [f64]; 3];

/// A vehicle with its wheels' spin inertia.
struct Driven<'a> {
    tree: &'a Tree,
    bodies: &'a [InertialParameters],
    spin: &'a [f64],
}

/// The vehicle at the three times of a step, under a wrench about `Bo` in B.
struct Pushed {
    points: [LockedVehicle; 3],
    wrench: Wrench,
}

impl Rates for Pushed {
    fn rate(&mut self, at: StepPoint, state: &PoseMomentum) -> Option<PoseMomentumRate> {
        let motion = self.points[at as usize].base_motion(state);
        let Wrench { force, torque } = self.wrench;
        let torque = torque - motion.centre.p_BoScm_B.cross(&force);
        Some(PoseMomentumRate::new(
            state,
            &motion.twist,
            (&force, &torque),
        ))
    }
}

impl Driven<'_> {
    fn locked(&self, [q, rates, wheel_speed]: Inputs<'_>) -> LockedVehicle {
        let mut kinematics = Kinematics::at(self.tree, q);
        kinematics.set_velocities(self.tree, &Vector3::zeros(), &Vector3::zeros(), rates);
        let mut joints = momentum(self.bodies, &kinematics);
        let wheels = wheel_momentum(self.tree, &kinematics, self.spin, wheel_speed);
        joints.fixed_rows_mut::<3>(3).add_assign(&wheels);
        let whole = composite(self.bodies, &kinematics);
        LockedVehicle::new(&whole, &whole, &joints).unwrap()
    }

    /// The state after `dt` seconds, with the inputs at the start, in the middle and at the end.
    fn step(
        &self,
        state: &PoseMomentum,
        inputs: [Inputs<'_>; 3],
        wrench: Wrench,
        dt: f64,
    ) -> PoseMomentum {
        let points = inputs.map(|inputs| self.locked(inputs));
        let mut pushed = Pushed { points, wrench };
        let rate = pushed.rate(StepPoint::Begin, state).unwrap();
        runge_kutta_step(state, &rate, dt, &mut pushed).unwrap()
    }
}

/// `[dphi_B, dp_N, dP_N, dh_N]` from one state to another.
fn off(from: &PoseMomentum, to: &PoseMomentum) -> [Vector3; 4] {
    [
        (from.R_NB.inverse() * to.R_NB).scaled_axis(),
        to.p_NoBo_N - from.p_NoBo_N,
        to.P - from.P,
        to.h_SScm_N - from.h_SScm_N,
    ]
}

#[test]
fn exact_torque_free_body_turns_as_the_elliptic_functions_say() {
    let I_BBcm_B = Matrix3::new(12.0, 0.4, -0.3, 0.4, 15.0, 0.6, -0.3, 0.6, 9.0);
    let body = MassProperties {
        mass: 80.0,
        p_BoBcm_B: Vector3::new(0.1, -0.2, 0.3),
        I_BBcm_B,
    };
    let tree = Tree {
        links: vec![Link::base()],
        rotors: Vec::new(),
        coordinates: Vec::new(),
    };
    let start = Spin {
        R_NB: Matrix3::identity(),
        w_NB_B: Vector3::new(0.2, -0.3, 0.4),
    };
    let top = AsymmetricTop::new(&I_BBcm_B, &start).unwrap();
    let vehicle = Driven {
        tree: &tree,
        bodies: &[body.parameters()],
        spin: &[],
    };
    let still: Inputs = [&[]; 3];
    let P = Vector3::new(8.0, -4.0, 1.6);
    let seconds = 20.0;
    let error = |steps: u32| {
        let mut state = PoseMomentum {
            R_NB: UnitQuaternion::identity(),
            p_NoBo_N: Vector3::zeros(),
            P,
            h_SScm_N: I_BBcm_B * start.w_NB_B,
        };
        for _ in 0..steps {
            let dt = seconds / f64::from(steps);
            state = vehicle.step(&state, [still; 3], Wrench::ZERO, dt);
        }
        let exact = top.at(seconds);
        let turned = attitude_apart(&state.R_NB.to_rotation_matrix().into_inner(), &exact.R_NB);
        // The mass centre goes straight.
        let p_NoScm_N = state.p_NoBo_N + exact.R_NB * body.p_BoBcm_B;
        let straight = body.p_BoBcm_B + P * (seconds / body.mass);
        turned.max((p_NoScm_N - straight).norm())
    };
    let (coarse, fine) = (error(200), error(400));
    println!("error {coarse:.1e} at 0.1 s, {fine:.1e} at 0.05 s");
    assert!(fine < 1.0e-7, "{fine:e}");
    let order = (coarse / fine).log2();
    assert!((order - 4.0).abs() < 0.3, "order {order}");
}

#[test]
fn xval_steps_follow_the_simulated_motion() {
    let mut tree = xu_arm::tree();
    tree.rotors.push(Rotor {
        body: 2,
        axis_B: Vector3::new(0.6, 0.0, 0.8),
    });
    let bodies = xu_arm::parameters();
    let joints = (0..6).map(|k| {
        JointMotion::Fourier(Fourier {
            offset: 0.2 * k as f64,
            base_frequency_hz: 0.05 + 0.01 * k as f64,
            sine: vec![0.4, -0.1],
            cosine: vec![0.2],
        })
    });
    let speed = PiecewisePolynomial::linear(&[0.0, 10.0], &[20.0, 120.0]).unwrap();
    let plan = Plan {
        joints: joints.map(Into::into).collect(),
        wheels: vec![WheelMotion::Speed(speed)],
        firings: vec![Firing {
            thruster: 0,
            on: -1.0,
            off: 20.0,
            force: 5.0,
        }],
        ..Plan::default()
    };
    let nozzle = Nozzle {
        body: 0,
        p_BoT_B: Vector3::new(0.5, 0.2, -0.4),
        direction_B: Vector3::new(0.0, 0.6, 0.8),
        propellant: None,
    };
    let vehicle = Vehicle {
        modes: Vec::new(),
        tree: tree.clone(),
        bodies: bodies.clone(),
        spin_inertia: vec![0.1],
        nozzles: vec![nozzle],
        locked_at: vec![0.0; 6],
        gravity: Gravity::default(),
    };
    let (steps, dt) = (500, 0.01);
    let times: Vec<f64> = (0..=2 * steps).map(|k| 0.5 * dt * f64::from(k)).collect();
    let mut samples = Vec::new();
    Flight::new(vehicle, &plan, Tolerance::default())
        .unwrap()
        .run(&xu_arm::start(), &times, |s| samples.push(s.clone()))
        .unwrap();
    let state = |s: &MotionSample| PoseMomentum {
        R_NB: s.R_NB,
        p_NoBo_N: s.p_NoBo_N,
        P: s.l_S_N,
        h_SScm_N: s.h_SScm_N,
    };
    fn inputs(s: &MotionSample) -> Inputs<'_> {
        [&s.q, &s.rates, &s.wheel_speed]
    }
    let force = nozzle.direction_B * 5.0;
    let wrench = Wrench {
        force,
        torque: nozzle.p_BoT_B.cross(&force),
    };
    let vehicle = Driven {
        tree: &tree,
        bodies: &bodies,
        spin: &[0.1],
    };
    let mut now = state(&samples[0]);
    for three in samples.windows(3).step_by(2) {
        let inputs = [inputs(&three[0]), inputs(&three[1]), inputs(&three[2])];
        now = vehicle.step(&now, inputs, wrench, dt);
    }
    let last = samples.last().unwrap();
    let error = off(&state(last), &now);
    let worst = error.iter().fold(0.0, |m: f64, x| m.max(x.amax()));
    println!("after {} s off by {worst:.1e}", last.time);
    assert!(worst < 1.0e-7, "{error:?}");
    let twist = vehicle.locked(inputs(last)).base_motion(&state(last)).twist;
    assert!((twist.w - last.w_NB_B).norm() < 1.0e-11);
    assert!((last.R_NB * twist.v - last.v_NBo_N).norm() < 1.0e-11);
}
