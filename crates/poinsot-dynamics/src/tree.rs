//! The kinematic constants of a vehicle, laid out for the kernels.

use crate::algebra::{M3, Real, V3};
use alloc::vec::Vec;
use poinsot_spatial::{Matrix3, Vector3, skew};

/// How a body moves relative to its parent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// The base: free.
    Free,
    /// Rigidly attached.
    Fixed,
    /// Turns about the joint axis; the index is that of the joint coordinate.
    Revolute(usize),
    /// Slides along the joint axis; the index is that of the joint coordinate.
    Prismatic(usize),
}

/// One body with the joint that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Index of the parent; the base names itself.
    pub parent: usize,
    /// Motion relative to the parent.
    pub motion: Motion,
    /// Position of this body's origin from its parent's at joint position zero, in the parent, m.
    pub p_PoCo_P: Vector3,
    /// Rotation from this body to its parent at joint position zero.
    pub R_PC_zero: Matrix3,
    /// Joint axis in this body (unit).
    pub axis_C: Vector3,
    /// Joint axis in the parent: `R_PC_zero axis_C`.
    pub axis_P: Vector3,
    /// `R_PC_zero [axis]x` and `R_PC_zero [axis]x^2`: with them Rodrigues' formula is two scaled sums.
    rodrigues: [Matrix3; 2],
    /// Which coordinate axis of this body the joint axis is, 0 to 2, if it is one.
    along: Option<usize>,
}

/// Kinematic constants of a rotor.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotor {
    /// Index of the host body.
    pub body: usize,
    /// Unit spin axis in the host body.
    pub axis_B: Vector3,
}

/// The kinematic constants of a vehicle.
///
/// ```
/// use poinsot_dynamics::{Link, Motion, Tree};
/// use poinsot_spatial::{Matrix3, Vector3};
///
/// // A base and an arm that turns about z at x = 1 m.
/// let hinge = Link::new(0, Motion::Revolute(0), Vector3::x(), Matrix3::identity(), Vector3::z());
/// let tree = Tree { links: vec![Link::base(), hinge], rotors: vec![], coordinates: vec![0] };
/// assert_eq!((tree.bodies(), tree.dof()), (2, 1));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// Bodies; parents stand before their children.
    pub links: Vec<Link>,
    /// Wheels.
    pub rotors: Vec<Rotor>,
    /// Index among all joints of the vehicle of each joint coordinate (fixed joints have none).
    pub coordinates: Vec<usize>,
}

impl Link {
    /// A body with its joint; `axis_C` need not matter for a fixed or free one.
    pub fn new(
        parent: usize,
        motion: Motion,
        p_PoCo_P: Vector3,
        R_PC_zero: Matrix3,
        axis_C: Vector3,
    ) -> Self {
        let k = skew(&axis_C);
        Self {
            parent,
            motion,
            p_PoCo_P,
            R_PC_zero,
            axis_C,
            axis_P: R_PC_zero * axis_C,
            rodrigues: [R_PC_zero * k, R_PC_zero * k * k],
            along: (0..3).find(|k| axis_C == Vector3::ith(*k, 1.0)),
        }
    }

    /// The free base.
    pub fn base() -> Self {
        Self::new(
            0,
            Motion::Free,
            Vector3::zeros(),
            Matrix3::identity(),
            Vector3::zeros(),
        )
    }

    /// `R_BC` at a joint angle, rad, where the parent stands at `R_BP`.
    #[inline(always)]
    pub(crate) fn turned<T: Real>(&self, R_BP: &M3<T>, angle: T) -> M3<T> {
        let (sin, cos) = angle.sine_cosine();
        let at_zero = M3::of(&self.R_PC_zero);
        match self.along {
            // About a coordinate axis the turn mixes the two other columns.
            Some(0) => turn::<T, 1, 2>(R_BP.product(&at_zero), sin, cos),
            Some(1) => turn::<T, 2, 0>(R_BP.product(&at_zero), sin, cos),
            Some(2) => turn::<T, 0, 1>(R_BP.product(&at_zero), sin, cos),
            // Rodrigues.
            _ => {
                let [first, second] = &self.rodrigues;
                let first = M3::of(first).spread(sin) * sin;
                let second = M3::of(second).spread(sin) * (sin.all(1.0) - cos);
                R_BP.product(&(at_zero.spread(sin) + first + second))
            }
        }
    }

    /// Joint axis in the base where this body stands at `R_BC`.
    #[inline]
    pub fn axis_B(&self, R_BC: &Matrix3) -> Vector3 {
        self.axis_in_base(&M3::of(R_BC)).stored()
    }

    /// The same over any numbers.
    #[inline(always)]
    pub(crate) fn axis_in_base<T: Real>(&self, R_BC: &M3<T>) -> V3<T> {
        match self.along {
            Some(0) => R_BC.0[0],
            Some(1) => R_BC.0[1],
            Some(2) => R_BC.0[2],
            _ => R_BC.times(&V3::of(&self.axis_C)),
        }
    }
}

/// Columns `I`, `J` turned towards each other: `R` times the turn about the third axis.
#[inline(always)]
fn turn<T: Real, const I: usize, const J: usize>(R: M3<T>, sin: T, cos: T) -> M3<T> {
    let (a, b) = (R.0[I], R.0[J]);
    let mut turned = R;
    turned.0[I] = a * cos + b * sin;
    turned.0[J] = b * cos - a * sin;
    turned
}

impl Tree {
    /// The kinematics of a vehicle, whatever describes it.
    pub fn new<V>(vehicle: V) -> Self
    where
        Self: From<V>,
    {
        Self::from(vehicle)
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.links.len()
    }

    /// Number of joint coordinates.
    pub fn dof(&self) -> usize {
        self.coordinates.len()
    }

    /// Whether a body is another one or hangs on it: parents stand before their children.
    pub fn carries(&self, root: usize, mut body: usize) -> bool {
        while body > root {
            body = self.links[body].parent;
        }
        body == root
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_turn_about_a_coordinate_axis_is_rodrigues() {
        let tilt = |x, y, z| *nalgebra::Rotation3::new(Vector3::new(x, y, z)).matrix();
        let (R_BP, R_PC_zero) = (tilt(0.4, -1.1, 0.7), tilt(-0.2, 0.5, 2.1));
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let link = Link::new(0, Motion::Revolute(0), Vector3::zeros(), R_PC_zero, axis);
            assert!(link.along.is_some());
            for k in -20..=20 {
                let angle = 0.31 * f64::from(k);
                let turn = *nalgebra::Rotation3::new(axis * angle).matrix();
                let expected = R_BP * R_PC_zero * turn;
                let found = link.turned(&M3::of(&R_BP), angle).stored();
                assert!((found - expected).amax() < 1.0e-15, "{axis} {angle}");
                let of_axis = link.axis_B(&found) - R_BP * link.axis_P;
                assert!(of_axis.amax() < 1.0e-15, "{axis} {angle}");
            }
        }
    }
}
