//! Memory allocations of a step: none. A separate binary, because it has another allocator.
#![allow(clippy::unwrap_used, non_snake_case)]

use allocation_counter::measure;
use poinsot_dynamics::propagation::{
    LockedVehicle, PoseMomentum, PoseMomentumRate, Rates, StepPoint, runge_kutta_step,
};
use poinsot_dynamics::{Kinematics, composite, momentum};
use poinsot_spatial::{UnitQuaternion, Vector3};

#[path = "../benches/xu_arm/mod.rs"]
mod xu_arm;

/// Under a force and a torque about the mass centre.
struct Pushed(LockedVehicle);

impl Rates for Pushed {
    fn rate(&mut self, _: StepPoint, state: &PoseMomentum) -> Option<PoseMomentumRate> {
        let twist = self.0.base_motion(state).twist;
        let push = (&Vector3::z(), &Vector3::x());
        Some(PoseMomentumRate::new(state, &twist, push))
    }
}

#[test]
fn prop_a_step_allocates_nothing() {
    let (tree, bodies) = (xu_arm::tree(), xu_arm::parameters());
    let mut kinematics = Kinematics::new(&tree);
    let state = PoseMomentum {
        R_NB: UnitQuaternion::identity(),
        p_NoBo_N: Vector3::zeros(),
        P: Vector3::x(),
        h_SScm_N: Vector3::y(),
    };
    let counted = measure(|| {
        for _ in 0..100 {
            kinematics.place(&tree, &[0.1; 6]);
            kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::zeros(), &[0.2; 6]);
            let whole = composite(&bodies, &kinematics);
            let joints = momentum(&bodies, &kinematics);
            let mut pushed = Pushed(LockedVehicle::new(&whole, &whole, &joints).unwrap());
            let rate = pushed.rate(StepPoint::Begin, &state).unwrap();
            runge_kutta_step(&state, &rate, 0.1, &mut pushed).unwrap();
        }
    });
    assert_eq!(counted.count_total, 0);
}
