//! Ideal measurements of one sensor in many states of one tree, with their derivatives.

use super::error::{BatchError, expect};
use super::kernels::Kernel;
use super::rows::{Group, Rows, TWIST};
use super::{States, run};
use crate::acceleration::Accelerations;
use crate::kinematics::Kinematics;
use crate::lanes::Lanes;
use crate::measurement::{BasePose, Carried, Ideal, JointEffect, PointMotion, Scene};
use crate::sensor::SensorKind;
use crate::tree::{Motion, Tree};
use fearless_simd::Simd;
use nalgebra::{Quaternion, SMatrix, Unit, Vector3};

/// Numbers of a pose: `q_NB` (xyzw), `p_NoBo_N`.
const POSE: usize = 7;
/// Numbers of a vector.
const VECTOR: usize = 3;

/// One sensor, at the same place of all vehicles.
#[derive(Debug, Clone, Copy)]
pub struct PlacedSensor<'a> {
    /// A kind with axes.
    pub kind: SensorKind,
    /// Its body; of a relative kind the body that is seen.
    pub body: usize,
    /// Its position from the body's origin, in the body's axes, m.
    pub p_BioS_Bi: Vector3<f64>,
    /// The body from which a relative kind sees; 0 for all other kinds.
    pub seen_from: usize,
    /// For a direction: the unit vector in N, three numbers a state.
    pub reference_N: Option<&'a [f64]>,
    /// For an accelerometer: rows of [`super::forward_dynamics`].
    pub accelerations: Option<&'a [f64]>,
}

/// Numbers of a row of [`measure`]; `kind` is one with axes.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // Value, rate, columns of 3 over pose and twist, and over position and rate of one joint.
/// assert_eq!(batch::measured_width(&tree, SensorKind::Gyro), 3 + 3 + 3 * (6 + 6 + 2));
/// ```
pub fn measured_width(tree: &Tree, kind: SensorKind) -> usize {
    kind.columns().len() + VECTOR * (1 + 2 * TWIST + 2 * tree.dof())
}

/// Fills `out`, one row of [`measured_width`] numbers a state, by [`SensorKind::measure`] and [`SensorKind::over_joint`]:
/// the value (a rotation as xyzw); its rate (zero where pose and twist do not determine it); its columns over the pose
/// `[dphi_B, dp_N]` and over the twist of the base; for each joint coordinate the columns over its position and its rate.
///
/// `poses` holds attitude (xyzw) and position of the base in N, seven numbers a state.
///
/// # Errors
/// An array has the wrong length, a body is not in the tree, or the sensor lacks what its kind measures.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // The base turns at 1 rad/s about z, the joint at 2 rad/s: a gyro on the arm.
/// let states = batch::States { q: &[0.0], rates: &[2.0], twist: &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0] };
/// let poses = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
/// let gyro = batch::PlacedSensor {
///     kind: SensorKind::Gyro,
///     body: 1,
///     p_BioS_Bi: Vector3::zeros(),
///     seen_from: 0,
///     reference_N: None,
///     accelerations: None,
/// };
/// let mut out = vec![0.0; batch::measured_width(&tree, gyro.kind)];
/// batch::measure(&tree, states, &poses, gyro, &mut out)?;
/// assert_eq!(out[..3], [0.0, 0.0, 3.0]);
/// // The last column is that over the joint's rate.
/// assert_eq!(out[out.len() - 3..], [0.0, 0.0, 1.0]);
/// # Ok::<(), batch::BatchError>(())
/// ```
pub fn measure(
    tree: &Tree,
    states: States,
    poses: &[f64],
    sensor: PlacedSensor,
    out: &mut [f64],
) -> Result<(), BatchError> {
    let (count, kind) = (states.count(tree)?, sensor.kind);
    let lacks = match kind {
        SensorKind::Direction => sensor.reference_N.is_none(),
        SensorKind::Accelerometer => sensor.accelerations.is_none(),
        _ => kind.is_scalar(),
    };
    if lacks {
        return Err(BatchError::Unmeasured(kind));
    }
    for body in [sensor.body, sensor.seen_from] {
        if body >= tree.bodies() {
            return Err(BatchError::Body(body, tree.bodies()));
        }
    }
    expect("poses", poses.len(), count * POSE)?;
    let reference = sensor.reference_N.map_or(count * VECTOR, <[f64]>::len);
    expect("reference_N", reference, count * VECTOR)?;
    let acceleration = TWIST + tree.dof();
    let accelerations = sensor
        .accelerations
        .map_or(count * acceleration, <[f64]>::len);
    expect("accelerations", accelerations, count * acceleration)?;
    let width = measured_width(tree, kind);
    expect("out", out.len(), count * width)?;
    let kernel = Measure {
        poses,
        sensor,
        joints: carrying(tree, &sensor),
    };
    run(tree, states, kernel, width, out)
}

/// A joint that carries one of the two bodies of a measurement.
struct Carrier {
    coordinate: usize,
    /// The body behind it.
    link: usize,
    /// Whether it carries the body of the point.
    point: bool,
}

/// The joints that change the measurement.
fn carrying(tree: &Tree, sensor: &PlacedSensor) -> Vec<Carrier> {
    let carries = |link: usize, mut body: usize| {
        while body > link {
            body = tree.links[body].parent;
        }
        body == link
    };
    let carrier = |(link, of): (usize, &crate::tree::Link)| {
        let (Motion::Revolute(coordinate) | Motion::Prismatic(coordinate)) = of.motion else {
            return None;
        };
        let point = carries(link, sensor.body);
        let from = sensor.kind.is_relative() && carries(link, sensor.seen_from);
        (point != from).then_some(Carrier {
            coordinate,
            link,
            point,
        })
    };
    tree.links.iter().enumerate().filter_map(carrier).collect()
}

struct Measure<'a> {
    poses: &'a [f64],
    sensor: PlacedSensor<'a>,
    joints: Vec<Carrier>,
}

/// Accelerations of the bodies and of the joints.
pub(super) struct MeasureScratch<S: Simd> {
    bodies: Accelerations<Lanes<S>>,
    joints: Vec<Lanes<S>>,
}

impl Measure<'_> {
    #[inline(always)]
    fn pose<S: Simd>(&self, group: &Group<S>) -> BasePose<Lanes<S>> {
        let rows = group.rows(self.poses, POSE);
        let mut numbers = [Lanes::new(group.simd, 0.0); POSE];
        for (k, number) in numbers.iter_mut().enumerate() {
            *number = rows.number(group.simd, k);
        }
        let [i, j, k, w, x, y, z] = numbers;
        BasePose {
            R_NB: Unit::new_unchecked(Quaternion::new(w, i, j, k)),
            p_NoBo_N: Vector3::new(x, y, z),
        }
    }

    /// Inertial acceleration of the sensor.
    #[inline(always)]
    fn acceleration<S: Simd>(
        &self,
        scratch: &mut MeasureScratch<S>,
        kinematics: &Kinematics<Lanes<S>>,
        rates: &[Lanes<S>],
        group: &Group<S>,
    ) -> Option<Vector3<Lanes<S>>> {
        let (tree, sensor) = (group.tree, &self.sensor);
        let rows = group.rows(sensor.accelerations?, TWIST + tree.dof());
        for (k, joint) in scratch.joints.iter_mut().enumerate() {
            *joint = rows.number(group.simd, TWIST + k);
        }
        let [a, alpha] = rows.pair(group.simd);
        let bodies = &mut scratch.bodies;
        bodies.set_without_base(tree, kinematics, rates, &scratch.joints);
        bodies.add_base(kinematics, &a, &alpha);
        Some(bodies.of_point(kinematics, sensor.body, &sensor.p_BioS_Bi))
    }
}

impl Kernel for Measure<'_> {
    type Scratch<S: Simd> = MeasureScratch<S>;

    fn scratch<S: Simd>(&self, tree: &Tree, zero: Lanes<S>) -> Self::Scratch<S> {
        MeasureScratch {
            bodies: Accelerations::over(tree, zero),
            joints: vec![zero; tree.dof()],
        }
    }

    #[inline(always)]
    fn fill<S: Simd>(
        &self,
        scratch: &mut Self::Scratch<S>,
        kinematics: &Kinematics<Lanes<S>>,
        rates: &[Lanes<S>],
        group: &Group<S>,
        rows: &mut Rows,
    ) -> Result<(), BatchError> {
        let PlacedSensor { kind, .. } = self.sensor;
        let reference_N = self.sensor.reference_N;
        let reference_N = reference_N.map(|all| group.rows(all, VECTOR).vector(group.simd, 0));
        let point = PointMotion::new(kinematics, self.sensor.body, &self.sensor.p_BioS_Bi);
        let from = PointMotion::new(kinematics, self.sensor.seen_from, &Vector3::zeros());
        let scene = Scene {
            pose: &self.pose(group),
            point: &point,
            from: &from,
            reference_N,
            a_NP_B: self.acceleration(scratch, kinematics, rates, group),
        };
        let found = kind.measure(&scene).ok_or(BatchError::Unmeasured(kind))?;
        let nothing = Vector3::from([Lanes::new(group.simd, 0.0); VECTOR]);
        let mut at = kind.columns().len();
        match found.value {
            Ideal::Vector(x) => rows.put(0, &x.into()),
            Ideal::Rotation(q) => rows.put(0, &q.as_ref().coords.into()),
        }
        rows.put(at, &found.rate.unwrap_or(nothing).into());
        at += VECTOR;
        for columns in [&found.pose, &found.twist] {
            put_columns(rows, at, columns);
            at += VECTOR * TWIST;
        }
        for k in 0..2 * group.tree.dof() {
            rows.put(at + VECTOR * k, &nothing.into());
        }
        for joint in &self.joints {
            let carried = if joint.point { &point } else { &from };
            let effect = JointEffect::new(group.tree, kinematics, joint.link, carried);
            let carried = match joint.point {
                true => Carried::Point(&effect),
                false => Carried::From(&effect),
            };
            if let Some(over) = kind.over_joint(&scene, carried) {
                let at = at + 2 * VECTOR * joint.coordinate;
                rows.put(at, &over.position.into());
                rows.put(at + VECTOR, &over.rate.into());
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn put_columns<S: Simd>(rows: &mut Rows, at: usize, columns: &SMatrix<Lanes<S>, 3, 6>) {
    let all: &[[Lanes<S>; VECTOR]; TWIST] = &columns.data.0;
    if let Some(numbers) = all.as_flattened().first_chunk::<{ VECTOR * TWIST }>() {
        rows.put(at, numbers);
    }
}
