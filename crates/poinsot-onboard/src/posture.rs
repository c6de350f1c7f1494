//! The vehicle at one position and rate of its joints.
//!
//! Everything is in B, about `Bo`. A joint moves what it carries by a twist of its own for each unit of its rate.

use crate::configuration::{Configuration, INPUTS, ITERATIONS, JOINTS, Joint, of_joint, of_rate};
use crate::numbers::{AXES, Numbers, PARAMETERS, WHEELS};
use nalgebra::{ArrayStorage, Quaternion, SMatrix, SymmetricEigen};
use poinsot_dynamics::propagation::{BaseMotion, Flexibility, LockedVehicle, PoseMomentum};
use poinsot_spatial::{
    InertialParameters, Matrix3, Rotation3, UnitQuaternion, Vector3, Vector6, angular, elements,
    linear, stacked, tensor,
};

/// Without momentum.
pub const AT_REST: PoseMomentum = PoseMomentum {
    R_NB: UnitQuaternion::new_unchecked(Quaternion::new(1.0, 0.0, 0.0, 0.0)),
    p_NoBo_N: Vector3::new(0.0, 0.0, 0.0),
    P: Vector3::new(0.0, 0.0, 0.0),
    h_SScm_N: Vector3::new(0.0, 0.0, 0.0),
};

const NOTHING: Vector6 = Vector6::from_array_storage(ArrayStorage([[0.0; 6]]));

/// Elements of an inertia over ten parameters.
pub type InertiaSlopes = SMatrix<f64, 6, PARAMETERS>;

/// Position of a frame.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    /// From the frame to the base.
    pub R: Matrix3,
    /// Its origin.
    pub p: Vector3,
}

impl Pose {
    const BASE: Self = Self {
        R: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        p: Vector3::new(0.0, 0.0, 0.0),
    };

    /// A frame that stands in this one at a quaternion x, y, z, w and a position.
    fn then(&self, [x, y, z, w]: [f64; 4], p: [f64; AXES]) -> Self {
        let q = Quaternion::new(w, x, y, z);
        let R = UnitQuaternion::new_unchecked(q).to_rotation_matrix();
        Self {
            R: self.R * R.matrix(),
            p: self.p + self.R * Vector3::from(p),
        }
    }

    /// The link of a joint whose parent stands here.
    fn link(&self, joint: &Joint, position: f64) -> Self {
        let mut link = self.then(joint.rotation, joint.position);
        let axis = Vector3::from(joint.axis);
        if joint.slides {
            link.p += link.R * axis * position;
        } else {
            link.R *= Rotation3::new(axis * position).matrix();
        }
        link
    }
}

/// The vehicle at one position and rate of its joints.
#[derive(Debug, Clone, Copy)]
pub struct Posture {
    /// Frame of the unknown body.
    pub unknown: Pose,
    /// Twist of that body by the joints alone.
    pub of_unknown: Vector6,
    /// All bodies.
    pub whole: InertialParameters,
    /// Momentum of the joints, the base at rest.
    pub momentum: Vector6,
    /// Speeds of the wheels, rad/s.
    pub speeds: [f64; WHEELS],
    /// What each joint carries, and how it moves it.
    carried: [InertialParameters; JOINTS],
    screws: [Vector6; JOINTS],
    rates: [f64; JOINTS],
    /// Twist of each link by the joints alone, and momentum of what it carries beside that of its own twist.
    twists: [Vector6; JOINTS],
    beyond: [Vector6; JOINTS],
}

/// What changes at the present motion, pose and rates held.
#[derive(Debug, Clone, Copy)]
pub struct Held {
    /// The momentum about `Bo`.
    pub momentum: Vector6,
    /// The mass centre.
    pub centre: Vector3,
    /// The mass, and the first moment about `Bo`.
    pub mass: f64,
    pub first_moment: Vector3,
}

impl Held {
    /// Bodies stay as they are.
    pub fn of_motion(momentum: Vector6, centre: Vector3) -> Self {
        Self {
            momentum,
            centre,
            mass: 0.0,
            first_moment: Vector3::zeros(),
        }
    }
}

/// Momentum of a body at a twist.
pub fn momentum(of: &InertialParameters, twist: &Vector6) -> Vector6 {
    let (v, w) = (linear(twist), angular(twist));
    stacked(
        &(v * of.mass + w.cross(&of.mc_B)),
        &(of.mc_B.cross(&v) + of.I_BBo_B * w),
    )
}

impl Posture {
    /// Nothing, all of its bits zero.
    pub const NONE: Self = Self {
        unknown: Pose {
            R: Matrix3::from_array_storage(ArrayStorage([[0.0; AXES]; AXES])),
            p: Vector3::new(0.0, 0.0, 0.0),
        },
        of_unknown: NOTHING,
        whole: InertialParameters::ZERO,
        momentum: NOTHING,
        speeds: [0.0; WHEELS],
        carried: [InertialParameters::ZERO; JOINTS],
        screws: [NOTHING; JOINTS],
        rates: [0.0; JOINTS],
        twists: [NOTHING; JOINTS],
        beyond: [NOTHING; JOINTS],
    };

    /// The vehicle with these numbers.
    pub fn new(configuration: &Configuration, numbers: &Numbers, inputs: &[f64; INPUTS]) -> Self {
        let mut out = Self::NONE;
        out.set(configuration, numbers, inputs);
        out
    }

    /// Becomes the vehicle with these numbers.
    pub fn set(
        &mut self,
        configuration: &Configuration,
        numbers: &Numbers,
        inputs: &[f64; INPUTS],
    ) {
        let joints = configuration.joints();
        let mut links = [Pose::BASE; JOINTS];
        let out = self;
        out.whole = InertialParameters::from_array(&configuration.known);
        out.speeds.copy_from_slice(&inputs[..WHEELS]);
        (out.of_unknown, out.momentum) = (NOTHING, NOTHING);
        out.beyond[..joints.len()].fill(NOTHING);
        for (j, joint) in joints.iter().enumerate() {
            let (parent, by_parent) = match joint.parent.checked_sub(1) {
                Some(parent) => (links[parent], out.twists[parent]),
                None => (Pose::BASE, Vector6::zeros()),
            };
            let link = parent.link(joint, inputs[of_joint(j)]);
            let axis = link.R * Vector3::from(joint.axis);
            out.screws[j] = match joint.slides {
                true => stacked(&axis, &Vector3::zeros()),
                false => stacked(&link.p.cross(&axis), &axis),
            };
            out.rates[j] = inputs[of_rate(j)];
            out.twists[j] = by_parent + out.screws[j] * out.rates[j];
            let known = InertialParameters::from_array(&joint.known);
            out.carried[j] = known.transported(&link.R, &link.p);
            links[j] = link;
        }
        let place = configuration.unknown_link.checked_sub(1);
        let link = place.map_or(Pose::BASE, |j| links[j]);
        out.unknown = link.then(
            configuration.unknown_rotation,
            configuration.unknown_position,
        );
        let body = InertialParameters::from_array(&core::array::from_fn(|k| numbers[k]));
        let body = body.transported(&out.unknown.R, &out.unknown.p);
        match place {
            Some(j) => {
                out.of_unknown = out.twists[j];
                out.carried[j] = out.carried[j].with_added(1.0, &body);
            }
            None => out.whole = out.whole.with_added(1.0, &body),
        }
        for (j, joint) in joints.iter().enumerate().rev() {
            let carried = out.carried[j];
            let moved = momentum(&carried, &(out.screws[j] * out.rates[j]));
            out.momentum += moved;
            let all = moved + out.beyond[j];
            match joint.parent.checked_sub(1) {
                Some(parent) => {
                    out.carried[parent] = out.carried[parent].with_added(1.0, &carried);
                    out.beyond[parent] += all;
                }
                None => out.whole = out.whole.with_added(1.0, &carried),
            }
        }
    }

    /// As one body, with a momentum about `Bo` beside that of the joints.
    pub fn locked(&self, more: &Vector6) -> Option<LockedVehicle> {
        LockedVehicle::new(&self.whole, &self.whole, &(self.momentum + more))
    }

    /// Elements of the inertia about the mass centre over the parameters of the unknown body.
    pub fn inertia_slopes(&self, motion: &BaseMotion) -> InertiaSlopes {
        let (R, d) = (&self.unknown.R, self.unknown.p - motion.centre.p_BoScm_B);
        let columns: [Vector6; PARAMETERS] = core::array::from_fn(|k| {
            let slope = match k {
                0 => Matrix3::identity() * d.norm_squared() - d * d.transpose(),
                1..=AXES => {
                    let a = R.column(k - 1);
                    let both = d * a.transpose();
                    Matrix3::identity() * (2.0 * d.dot(&a)) - both - both.transpose()
                }
                _ => {
                    let unit = core::array::from_fn(|i| f64::from(u8::from(i + AXES + 1 == k)));
                    R * tensor(unit) * R.transpose()
                }
            };
            elements(&slope).into()
        });
        InertiaSlopes::from_columns(&columns)
    }

    /// What the rate of a joint changes.
    pub fn of_rate(&self, j: usize) -> Held {
        let momentum = momentum(&self.carried[j], &self.screws[j]);
        Held::of_motion(momentum, Vector3::zeros())
    }

    /// What the position of a joint changes.
    ///
    /// What the joint carries is turned with its momentum, but its twist as far as the joint's own link has it does not turn.
    pub fn of_position(&self, j: usize, motion: &BaseMotion) -> Held {
        let carried = &self.carried[j];
        let (v, w) = (linear(&self.screws[j]), angular(&self.screws[j]));
        let link = self.twists[j] + stacked(&motion.twist.v, &motion.twist.w);
        let all = momentum(carried, &link) + self.beyond[j];
        let (l, h) = (linear(&all), angular(&all));
        let turned = stacked(&w.cross(&l), &(w.cross(&h) + v.cross(&l)));
        let (v_link, w_link) = (linear(&link), angular(&link));
        let held = stacked(&(w.cross(&v_link) + v.cross(&w_link)), &w.cross(&w_link));
        let centre = (v * carried.mass + w.cross(&carried.mc_B)) / motion.centre.mass;
        let change = turned - momentum(carried, &held);
        Held::of_motion(change, centre)
    }
}

impl Configuration {
    /// Whether the vehicle has a positive mass and central inertia with these numbers, its joints at zero.
    pub(crate) fn is_possible(&self, numbers: &Numbers) -> bool {
        let posture = Posture::new(self, numbers, &[0.0; INPUTS]);
        let positive = central_moments(&posture.whole).is_some_and(|smallest| smallest > 0.0);
        positive && (self.mode_count == 0 || self.holds_modes(&posture).is_some())
    }

    /// Whether its modes carry less than the vehicle weighs and turns.
    // They are not on the stack of every sample.
    #[inline(never)]
    fn holds_modes(&self, posture: &Posture) -> Option<()> {
        let locked = posture.locked(&Vector6::zeros())?;
        let mut flexible = Flexibility::default();
        flexible.place_on_base(self.modes(), &locked)?;
        flexible.motion(&locked, &AT_REST.into()).map(|_| ())
    }
}

/// Smallest principal moment about the mass centre; `None` without positive mass.
fn central_moments(whole: &InertialParameters) -> Option<f64> {
    let central: Matrix3 = whole.mass_properties()?.I_BBcm_B;
    let finite = central.iter().all(|x| x.is_finite());
    let eigen = SymmetricEigen::try_new(central, f64::EPSILON, ITERATIONS);
    Some(eigen.filter(|_| finite)?.eigenvalues.min())
}
