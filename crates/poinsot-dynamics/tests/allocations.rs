//! Memory allocations of a step: none. A separate binary, because it has another allocator.
#![allow(clippy::unwrap_used, non_snake_case)]

use allocation_counter::measure;
use poinsot_dynamics::propagation::{Inputs, Linearisation, PoseMomentum, Propagation};
use poinsot_dynamics::{Rotor, Tree, Wrench};
use poinsot_spatial::{UnitQuaternion, Vector3};

#[path = "../benches/xu_arm/mod.rs"]
mod xu_arm;

#[test]
fn prop_a_step_allocates_nothing() {
    let mut tree: Tree = xu_arm::tree();
    tree.rotors.push(Rotor {
        body: 0,
        axis_B: Vector3::z(),
    });
    let bodies = xu_arm::parameters();
    let mut vehicle = Propagation::new(&tree, &bodies, &[0.1]).unwrap();
    let mut out = Linearisation::new(&tree);
    let state = PoseMomentum {
        R_NB: UnitQuaternion::identity(),
        p_NoBo_N: Vector3::zeros(),
        P: Vector3::x(),
        h_SScm_N: Vector3::y(),
    };
    let inputs = Inputs {
        q: &[0.1; 6],
        rates: &[0.2; 6],
        wheel_speed: &[100.0],
    };
    let wrench = Wrench {
        force: Vector3::z(),
        torque: Vector3::x(),
    };
    let counted = measure(|| {
        for _ in 0..100 {
            let push = Some(&wrench);
            vehicle.step(&state, [inputs; 3], push, 0.1).unwrap();
            let done = vehicle.linearise(&state, [inputs; 3], push, 0.1, &mut out);
            done.unwrap();
        }
    });
    assert_eq!(counted.count_total, 0);
}
