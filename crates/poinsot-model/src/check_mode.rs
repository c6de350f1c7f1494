//! Flexible modes: numbers of each, and that the vehicle can carry them.

use crate::check::Check;
use crate::file::{ModeFile, ModeParameter, PanelFile, SlopeFile, TankFile, Which};
use crate::finding::{Key, all, each};
use crate::vehicle::{FlexibleMode, Mode, ModeEstimate, Model};
use poinsot_dynamics::propagation::MOST_MODES;
use poinsot_dynamics::{Kinematics, Vehicle, composite};
use poinsot_files::short;
use poinsot_spatial::{InertialParameters, Matrix3, Matrix6, Vector3, Vector6, stacked, tensor};
use std::f64::consts::TAU;

impl Check<'_, '_> {
    pub fn modes(&mut self) -> Vec<FlexibleMode> {
        let mut modes = each(&self.file.mode, |_, own| self.mode(own));
        modes.extend(each(&self.file.panel, |k, own| self.panel(k, own)));
        let of_tanks = each(&self.file.tank, |k, own| self.tank(k, own));
        modes.extend(of_tanks.into_iter().flatten());
        if modes.len() > MOST_MODES {
            let problem = format!("the file has {} modes", modes.len());
            let remedy = format!("keep to the {MOST_MODES} of the lowest frequencies");
            let key = Key::top("mode").index(MOST_MODES);
            self.findings.refuse("E0119", &key, problem, remedy);
        }
        modes
    }

    fn mode(&self, file: &ModeFile) -> Option<FlexibleMode> {
        let vector = |key: Option<[f64; 3]>| Vector3::from(key.unwrap_or_default());
        let slope = file.inertia_slope_kg05_m.as_ref();
        Some(FlexibleMode {
            name: file.name.clone()?,
            mode: Mode {
                body: self.body_of(file.body.as_deref())?,
                frequency_Hz: file.frequency_Hz?,
                damping_ratio: file.damping_ratio.unwrap_or(0.0),
                translation: vector(file.translation_kg05),
                rotation: vector(file.rotation_kg05_m),
                inertia_slope: slope.map_or_else(Matrix3::zeros, SlopeFile::tensor),
            },
            estimate: estimate(file.estimate.as_ref()),
        })
    }

    /// A panel that turns by `y / sqrt(I)` about its hinge, I its inertia there.
    fn panel(&mut self, k: usize, file: &PanelFile) -> Option<FlexibleMode> {
        let key = &Key::entry("panel", k, file.name.as_deref());
        let body = self.body_of(file.body.as_deref())?;
        let axis = self.axis(&file.axis?, &key.at("axis"), "axis")?;
        let (mass, stiffness) = (file.mass_kg?, file.stiffness_N_m_per_rad?);
        let (hinge, com) = (Vector3::from(file.hinge_m?), Vector3::from(file.com_m?));
        let I = file.inertia_kg_m2.as_ref()?.tensor()?;
        let (swing, at) = (axis.cross(&com), hinge + com);
        let about = axis.dot(&(I * axis)) + mass * swing.norm_squared();
        if about.is_nan() || about <= 0.0 {
            let about = short(about);
            let problem = format!("the panel has the inertia {about} kg m2 about its hinge");
            let remedy = "give the positive inertia of a body that has this mass";
            return self
                .findings
                .refused("E0115", &key.at("inertia_kg_m2"), problem, remedy);
        }
        let (root, across) = (about.sqrt(), axis.cross_matrix());
        let turned = across * I - I * across;
        Some(FlexibleMode {
            name: file.name.clone()?,
            mode: Mode {
                body,
                frequency_Hz: (stiffness / about).sqrt() / TAU,
                damping_ratio: self.ratio(file.damping_N_m_s_per_rad, stiffness, about, key)?,
                translation: swing * (mass / root),
                rotation: (I * axis + at.cross(&swing) * mass) / root,
                inertia_slope: (turned + slope_of(&at, &(swing * mass))) / root,
            },
            estimate: estimate(file.estimate.as_ref()),
        })
    }

    /// A mass that moves along some directions.
    fn tank(&mut self, k: usize, file: &TankFile) -> Option<Vec<FlexibleMode>> {
        let key = &Key::entry("tank", k, file.name.as_deref());
        let (name, body) = (file.name.as_ref()?, self.body_of(file.body.as_deref())?);
        let (at, mass) = (Vector3::from(file.position_m?), file.mass_kg?);
        let stiffness = file.stiffness_N_per_m?;
        let damping_ratio = self.ratio(file.damping_N_s_per_m, stiffness, mass, key)?;
        let directions = match file.axis {
            None => ["x", "y", "z"]
                .into_iter()
                .zip([Vector3::x(), Vector3::y(), Vector3::z()])
                .map(|(axis, e)| (format!("{name}_{axis}"), e))
                .collect(),
            Some(axis) => vec![(name.clone(), self.axis(&axis, &key.at("axis"), "axis")?)],
        };
        let root = mass.sqrt();
        let moving = |(name, e): (String, Vector3)| FlexibleMode {
            name,
            mode: Mode {
                body,
                frequency_Hz: (stiffness / mass).sqrt() / TAU,
                damping_ratio,
                translation: e * root,
                rotation: at.cross(&e) * root,
                inertia_slope: slope_of(&at, &(e * root)),
            },
            estimate: estimate(file.estimate.as_ref()),
        };
        Some(directions.into_iter().map(moving).collect())
    }

    /// Share of critical damping; `None` where nothing oscillates.
    fn ratio(
        &mut self,
        damping: Option<f64>,
        stiffness: f64,
        inertia: f64,
        key: &Key,
    ) -> Option<f64> {
        let ratio = damping.unwrap_or(0.0) / (2.0 * (stiffness * inertia).sqrt());
        if ratio < 1.0 {
            return Some(ratio);
        }
        let problem = format!("the damping is {} times the critical one", short(ratio));
        let remedy = "give a smaller damping, or a stiffer spring";
        self.findings.refused("E0115", key, problem, remedy)
    }

    /// Reports modes that carry more than the vehicle has where its joints stand: what follows the base at once must keep a positive
    /// mass and inertia. The model has no other fault.
    ///
    /// The slopes of the modes after those that the file has as such are taken from the body's origin to the mass centre of the vehicle.
    pub fn carried(&mut self, model: &mut Model) {
        if model.modes.is_empty() {
            return;
        }
        let vehicle = Vehicle::from(&*model);
        let kinematics = Kinematics::at(&vehicle.tree, &vehicle.locked_at);
        let whole = composite(&vehicle.bodies, &kinematics);
        let declared = all(&self.file.mode).len();
        for own in model.modes.iter_mut().skip(declared) {
            let (R, p) = (kinematics.R[own.mode.body], kinematics.p[own.mode.body]);
            let centre = R.transpose() * (whole.p_BoScm_B() - p);
            own.mode.inertia_slope -= slope_of(&centre, &own.mode.translation);
        }
        let mut follows = about_centre(&whole);
        for (k, mode) in model.modes.iter().enumerate() {
            let key = Key::entry("mode", k, Some(&mode.name));
            let carried = participation(&mode.mode, &kinematics, &whole);
            if carried == Vector6::zeros() {
                let text = "nothing excites this mode: it participates neither in translation nor in rotation; give one";
                self.note(&key.at("frequency_Hz"), text);
            }
            let moved = mode.mode.translation.norm_squared();
            let rest = follows - carried * carried.transpose();
            let (key, problem, remedy) = if moved >= whole.mass {
                let (moved, all) = (short(moved), short(whole.mass));
                (
                    key.at("translation_kg05"),
                    format!("the mode moves {moved} kg, but the vehicle has {all} kg"),
                    "correct it: the square of its length is below the mass of the vehicle",
                )
            } else if rest.cholesky().is_none() {
                let problem = "no positive inertia is left of the vehicle without what this mode and those before it carry";
                (
                    key.at("rotation_kg05_m"),
                    problem.to_owned(),
                    "correct the participations: the squares of their rotations are below the vehicle's moments of inertia",
                )
            } else {
                follows = rest;
                continue;
            };
            self.findings.refuse("E0115", &key, problem, remedy);
        }
    }
}

impl SlopeFile {
    fn tensor(&self) -> Matrix3 {
        let six = [self.xx, self.xy, self.yy, self.xz, self.yz, self.zz];
        tensor(six.map(|x| x.unwrap_or(0.0)))
    }
}

/// Slope of the inertia about a point where what has this first moment per slope moves at `at` from it.
fn slope_of(at: &Vector3, moved: &Vector3) -> Matrix3 {
    Matrix3::identity() * (2.0 * at.dot(moved)) - at * moved.transpose() - moved * at.transpose()
}

fn estimate(file: Option<&Which<ModeParameter>>) -> ModeEstimate {
    let has = |what| Which::asks(file, &what);
    ModeEstimate {
        frequency: has(ModeParameter::Frequency),
        damping: has(ModeParameter::Damping),
        translation: has(ModeParameter::Translation),
        rotation: has(ModeParameter::Rotation),
        inertia_slope: has(ModeParameter::InertiaSlope),
    }
}

/// Mass and inertia about the mass centre.
fn about_centre(whole: &InertialParameters) -> Matrix6 {
    let mut out = Matrix6::identity() * whole.mass;
    out.fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&whole.I_SScm_B());
    out
}

/// Linear momentum of a mode and its angular momentum about the mass centre, per rate of the amplitude, in base axes.
fn participation(mode: &Mode, kinematics: &Kinematics, whole: &InertialParameters) -> Vector6 {
    let R = kinematics.R[mode.body];
    let arm = kinematics.p[mode.body] - whole.p_BoScm_B();
    let l = R * mode.translation;
    stacked(&l, &(R * mode.rotation + arm.cross(&l)))
}
