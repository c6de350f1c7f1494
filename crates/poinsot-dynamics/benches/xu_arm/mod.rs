//! The benchmark vehicle: a 400 kg satellite with a six-joint arm whose last body holds the target
//! (Xu et al. 2017, Table 1), and a stream of states to evaluate it at.
//!
//! Every joint turns about the z axis of its body. The paper does not give the turn between neighbouring
//! body axes at joint position zero; the rolls about x below are a choice, shared with the peers in
//! `benches/peers`.
#![allow(dead_code)]

use poinsot_dynamics::{
    ForceProfile, JointDrive, Link, Motion, SpringDamper, Start, StartVelocity, Tree,
};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Columns of the momentum regressor: ten parameters of seven bodies.
pub const COLUMNS: usize = 70;

const MASS: [f64; 7] = [400.0, 12.0, 10.0, 10.0, 8.0, 6.0, 30.0];
/// Mass centre of each body from its own origin, m.
const MASS_CENTRE: [[f64; 3]; 7] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 0.150],
    [0.270, 0.0, -0.251],
    [0.0, 0.0, 0.150],
    [0.0, 0.0, -0.350],
    [0.0, -0.034, 0.0],
    [-0.270, 0.0, 0.430],
];
/// Next joint from each body's mass centre, m.
const NEXT_JOINT: [[f64; 3]; 6] = [
    [0.357, -0.010, 0.419],
    [0.0, 0.0, 0.150],
    [0.560, 0.0, -0.049],
    [0.0, 0.0, 0.150],
    [0.0, 0.0, -0.700],
    [0.0, -0.066, 0.0],
];
/// Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the mass centre, kg m2.
const INERTIA: [[f64; 6]; 7] = [
    [30.0, 28.0, 32.0, 0.260, 0.370, -0.290],
    [0.510, 0.510, 0.200, 0.0, 0.0, 0.0],
    [0.278, 1.811, 1.690, 0.0, 0.263, 0.0],
    [0.420, 0.420, 0.150, 0.0, 0.0, 0.0],
    [0.500, 0.500, 0.210, 0.0, 0.0, 0.0],
    [0.330, 0.172, 0.260, 0.0, 0.0, 0.0],
    [2.398, 2.678, 1.405, -0.069, 0.013, 0.051],
];
/// Roll of each joint's body about x of its parent at joint position zero, quarter turns.
const ROLL: [f64; 6] = [0.0, 1.0, 0.0, -1.0, 1.0, -1.0];

/// The kinematics of the arm.
pub fn tree() -> Tree {
    let mut links = vec![Link::base()];
    for i in 0..6 {
        let angle = ROLL[i] * std::f64::consts::FRAC_PI_2;
        let roll = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
        let p = Vector3::from(MASS_CENTRE[i]) + Vector3::from(NEXT_JOINT[i]);
        links.push(Link::new(
            i,
            Motion::Revolute(i),
            p,
            *roll.matrix(),
            Vector3::z(),
        ));
    }
    Tree {
        links,
        rotors: Vec::new(),
        coordinates: (0..6).collect(),
    }
}

/// Inertial parameters of its bodies about their own origins.
pub fn parameters() -> Vec<InertialParameters> {
    (0..7)
        .map(|i| {
            let [xx, yy, zz, xy, xz, yz] = INERTIA[i];
            MassProperties {
                mass: MASS[i],
                p_BoBcm_B: Vector3::from(MASS_CENTRE[i]),
                I_BBcm_B: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            }
            .parameters()
        })
        .collect()
}

/// One state: joints and base twist.
#[derive(Debug, Clone, Copy)]
pub struct State {
    /// Joint positions, rad.
    pub q: [f64; 6],
    /// Joint rates, rad/s.
    pub rates: [f64; 6],
    /// `v_NBo_B`, m/s.
    pub v: Vector3,
    /// `w_NB_B`, rad/s.
    pub w: Vector3,
}

/// A reproducible stream of numbers between -1 and 1 (splitmix64), a few ns each.
pub struct Stream(pub u64);

impl Stream {
    /// The next number.
    #[inline]
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        // 53 bits: exact in a double.
        (z >> 11) as f64 * (2.0 / 9_007_199_254_740_992.0) - 1.0
    }

    /// The next state: joints within 2 rad, rates within 0.5 rad/s, slow base.
    #[inline]
    pub fn state(&mut self) -> State {
        let q = [(); 6].map(|()| 2.0 * self.number());
        let rates = [(); 6].map(|()| 0.5 * self.number());
        let v = Vector3::from([(); 3].map(|()| 0.1 * self.number()));
        let w = Vector3::from([(); 3].map(|()| 0.1 * self.number()));
        State { q, rates, v, w }
    }
}

/// A ring of states; its length is a power of two.
pub fn states() -> Vec<State> {
    let mut stream = Stream(1);
    (0..RING).map(|_| stream.state()).collect()
}

/// States of a batch.
pub const BATCH: usize = 4096;

/// Rows of joint positions, joint rates and base twists of a batch.
pub struct Rows {
    pub q: Vec<f64>,
    pub rates: Vec<f64>,
    pub twist: Vec<f64>,
}

impl Rows {
    /// The first states of the stream.
    pub fn new() -> Self {
        let mut stream = Stream(1);
        let states: Vec<State> = (0..BATCH).map(|_| stream.state()).collect();
        let twist = |s: &State| [s.v.x, s.v.y, s.v.z, s.w.x, s.w.y, s.w.z];
        Self {
            q: states.iter().flat_map(|s| s.q).collect(),
            rates: states.iter().flat_map(|s| s.rates).collect(),
            twist: states.iter().flat_map(twist).collect(),
        }
    }
}

/// States in the ring.
pub const RING: usize = 64;

/// Sinusoidal joint torques, the same in the peers: amplitude N m, frequency rad/s, phase rad (amplitudes
/// and frequencies after Xu et al. 2017, Table 13).
const TORQUE: [[f64; 3]; 6] = [
    [1.5, 4.0 * PI, 0.0],
    [-1.2, 3.0 * PI, FRAC_PI_2],
    [1.0, 2.0 * PI, PI],
    [0.15, 2.0 * PI, 3.0 * FRAC_PI_2],
    [-0.1, 3.0 * PI, -FRAC_PI_2],
    [0.05, 4.0 * PI, -PI],
];
/// Where the joints start in a simulation, rad.
const START: [f64; 6] = [0.3, -0.4, 0.5, 0.2, -0.7, 0.6];

/// The joints under these torques, from rest.
pub fn drives() -> Vec<JointDrive> {
    let joint = |([amplitude, frequency, phase], start): (&[f64; 3], &f64)| JointDrive::Force {
        motor: ForceProfile::Sine {
            amplitude: *amplitude,
            frequency: *frequency,
            phase: *phase,
        },
        spring: SpringDamper::default(),
        initial_position: *start,
        initial_rate: 0.0,
    };
    TORQUE.iter().zip(&START).map(joint).collect()
}

/// How the base starts in a simulation: at the origin, moving slowly.
pub fn start() -> Start {
    Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::new(0.01, 0.02, -0.01),
            w_NB_B: Vector3::new(0.02, -0.03, 0.05),
        },
        ..Start::at_rest()
    }
}

/// Joint positions after 20 s, rad, by Pinocchio 4.1.0: `aba`, classical Runge-Kutta, steps of 0.1 ms.
pub const JOINTS_AT_20_S: [f64; 6] = [
    0.155_469_068_867_869_7,
    -0.067_590_067_173_427_93,
    0.818_241_860_832_118_6,
    -0.372_131_987_627_725_4,
    -1.142_479_312_176_387_4,
    1.838_466_308_932_313_7,
];
