//! A vehicle as links of bodies that do not move in each other.

use crate::bind::scalar as variance;
use crate::error::{Error, unsupported};
use poinsot_dynamics::propagation::Mode;
use poinsot_dynamics::{Kinematics, Link, Motion, SensorKind, Tree};
use poinsot_model::{FlexibleMode, Model};
use poinsot_onboard::{Configuration, Joint, Wheel};
use poinsot_spatial::{InertialParameters, Matrix3, Rotation3, UnitQuaternion, Vector3};

/// A joint that moves, with its link in the one that carries it.
pub(super) struct Moving {
    pub joint: usize,
    /// The link that carries it: 0 is the base.
    parent: usize,
    R: Matrix3,
    p: Vector3,
    axis: Vector3,
}

/// A vehicle as links of bodies that do not move in each other.
pub(super) struct Rigid {
    /// The link of each body, and the body whose frame is that of the link.
    pub of: Vec<usize>,
    frames: Vec<usize>,
    pub moving: Vec<Moving>,
    /// With all joints where nothing moves them.
    pub kinematics: Kinematics,
}

impl Rigid {
    pub fn new(model: &Model, tree: &Tree) -> Self {
        let joint = |k: usize| &model.joints[tree.coordinates[k]];
        let standing: Vec<f64> = (0..tree.dof()).map(|k| joint(k).standing_at()).collect();
        let mut rigid = Self {
            of: vec![0],
            frames: vec![0],
            moving: Vec::new(),
            kinematics: Kinematics::at(tree, &standing),
        };
        for (body, link) in tree.links.iter().enumerate().skip(1) {
            rigid.add(body, link, |k| joint(k).locked_at.is_none(), tree);
        }
        rigid
    }

    fn add(&mut self, body: usize, link: &Link, moves: impl Fn(usize) -> bool, tree: &Tree) {
        let parent = self.of[link.parent];
        match link.motion {
            Motion::Revolute(k) | Motion::Prismatic(k) if moves(k) => {
                let (R, p) = self.pose(link.parent);
                self.of.push(self.frames.len());
                self.frames.push(body);
                self.moving.push(Moving {
                    joint: tree.coordinates[k],
                    parent,
                    R: R * link.R_PC_zero,
                    p: p + R * link.p_PoCo_P,
                    axis: link.axis_C,
                });
            }
            _ => self.of.push(parent),
        }
    }

    /// A body in its link.
    pub fn pose(&self, body: usize) -> (Matrix3, Vector3) {
        let frame = self.frames[self.of[body]];
        let all = &self.kinematics;
        let R_LB = all.R[frame].transpose();
        (R_LB * all.R[body], R_LB * (all.p[body] - all.p[frame]))
    }

    /// The joints that move, and what of a vehicle with these bodies does not move in the base.
    pub fn add_links(&self, to: &mut Configuration, model: &Model, bodies: &[InertialParameters]) {
        to.known = self.known(0, bodies);
        for (k, link) in self.moving.iter().enumerate() {
            let noise = |kind| variance(model, kind, link.joint).sqrt();
            *to = to.with_joint(Joint {
                parent: link.parent,
                slides: model.joints[link.joint].slides(),
                rotation: quaternion(&link.R),
                position: link.p.into(),
                axis: link.axis.into(),
                known: self.known(k + 1, bodies),
                position_noise: noise(SensorKind::JointPosition),
                rate_noise: noise(SensorKind::JointRate),
            });
        }
    }

    /// The wheels, none of them on a link that moves.
    pub fn add_wheels(&self, to: &mut Configuration, model: &Model) -> Result<(), Error> {
        for (k, wheel) in model.wheels.iter().enumerate() {
            self.on_base(wheel.body, &format!("wheel \"{}\"", wheel.name))?;
            *to = to.with_wheel(Wheel {
                axis_B: (self.kinematics.R[wheel.body] * wheel.axis_B).into(),
                spin_inertia: wheel.spin_inertia,
                noise: variance(model, SensorKind::WheelSpeed, k).sqrt(),
            });
        }
        Ok(())
    }

    /// The modes, none of them of a body that joints move.
    pub fn add_modes(&self, to: &mut Configuration, model: &Model) -> Result<(), Error> {
        for FlexibleMode { name, mode, .. } in &model.modes {
            self.on_base(mode.body, &format!("mode \"{name}\""))?;
            let (R, p) = self.pose(mode.body);
            let translation = R * mode.translation;
            let slope = R * mode.inertia_slope * R.transpose();
            *to = to.with_mode(Mode {
                body: 0,
                translation,
                rotation: R * mode.rotation + p.cross(&translation),
                inertia_slope: (slope + slope.transpose()) * 0.5,
                ..*mode
            });
        }
        Ok(())
    }

    /// The ten parameters of a link.
    fn known(&self, link: usize, bodies: &[InertialParameters]) -> [f64; 10] {
        let own = (0..bodies.len()).filter(|body| self.of[*body] == link);
        let add = |sum: InertialParameters, body: usize| {
            let (R, p) = self.pose(body);
            sum.with_added(1.0, &bodies[body].transported(&R, &p))
        };
        own.fold(InertialParameters::ZERO, add).to_array()
    }

    pub fn on_base(&self, body: usize, what: &str) -> Result<(), Error> {
        match self.of[body] {
            0 => Ok(()),
            _ => Err(unsupported(
                format!("the on-board filter has no {what} on a body that joints move"),
                "lock the joint, or use identify for this model",
            )),
        }
    }
}

/// x, y, z, w.
pub(super) fn quaternion(R: &Matrix3) -> [f64; 4] {
    let R = Rotation3::from_matrix_unchecked(*R);
    UnitQuaternion::from_rotation_matrix(&R).coords.into()
}
