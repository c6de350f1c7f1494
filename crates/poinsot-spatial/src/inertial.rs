//! The ten inertial parameters of a rigid body: the only definition of their order, point and axes.

use crate::{Matrix3, Matrix6, Vector3, skew};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use nalgebra::{Matrix3x6, Matrix4, SymmetricEigen};

/// Names of the ten barycentric parameters in the order of [`InertialParameters::to_array`]:
/// mass, first moment and inertia tensor **about the body's frame origin `Bo`**, body axes.
pub const PARAMETER_NAMES: [&str; 10] = [
    "m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz",
];

/// The six entries of a symmetric tensor in the order of the barycentric parameters.
pub const TENSOR: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
const TENSOR_NAMES: [&str; 6] = ["xx", "xy", "yy", "xz", "yz", "zz"];

/// Names of the ten mass properties in the order of [`MassProperties::to_array`]: mass, mass centre from the body's
/// origin, inertia about the mass centre.
pub const MASS_PROPERTY_NAMES: [&str; 10] = [
    "mass",
    "com_x",
    "com_y",
    "com_z",
    "inertia_xx",
    "inertia_xy",
    "inertia_yy",
    "inertia_xz",
    "inertia_yz",
    "inertia_zz",
];
/// Their units.
pub const MASS_PROPERTY_UNITS: [&str; 10] = [
    "kg", "m", "m", "m", "kg m2", "kg m2", "kg m2", "kg m2", "kg m2", "kg m2",
];

/// Name of an element in the order of [`TENSOR`].
///
/// ```
/// assert_eq!(poinsot_spatial::tensor_name(3), "xz");
/// ```
pub fn tensor_name(k: usize) -> &'static str {
    TENSOR_NAMES.get(k % 6).copied().unwrap_or_default()
}

/// Index of an element in the order of [`TENSOR`] by its name, with its letters in either order.
///
/// ```
/// use poinsot_spatial::tensor_index;
///
/// assert_eq!((tensor_index("yz"), tensor_index("zy")), (4, 4));
/// ```
pub fn tensor_index(name: &str) -> usize {
    let same = |n: &&str| n.bytes().eq(name.bytes()) || n.bytes().rev().eq(name.bytes());
    TENSOR_NAMES.iter().position(same).unwrap_or_default()
}

/// The ten barycentric parameters of body B about its own frame origin `Bo`, in B.
///
/// Momentum is linear in them (DESIGN, "state = pose and momentum").
///
/// ```
/// use poinsot_spatial::{InertialParameters, PARAMETER_NAMES};
///
/// let numbers = [2.0, 2.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 3.0];
/// let body = InertialParameters::from_array(&numbers);
/// assert_eq!((PARAMETER_NAMES[1], body.mc_B.x), ("mc_x", 2.0));
/// // The mass centre is at x = 1 m; about it the moments are 1 kg m2.
/// let about_centre = body.mass_properties().unwrap();
/// assert_eq!(about_centre.p_BoBcm_B.x, 1.0);
/// assert_eq!(about_centre.I_BBcm_B, nalgebra::Matrix3::identity());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InertialParameters {
    /// Mass, kg.
    pub mass: f64,
    /// First moment of mass `m p_BoBcm_B`, kg m.
    pub mc_B: Vector3,
    /// Inertia tensor about `Bo` in B, tensor elements (`I_xy = -integral x y dm`), kg m2.
    pub I_BBo_B: Matrix3,
}

/// Mass, centre of mass and central inertia of body B, the form used in engineering.
///
/// ```
/// use poinsot_spatial::{MassProperties, Matrix3, Vector3};
///
/// // A cube of 6 kg with edges of 1 m has m / 6 about every axis through its centre.
/// let cube = MassProperties {
///     mass: 6.0,
///     p_BoBcm_B: Vector3::x(),
///     I_BBcm_B: Matrix3::identity(),
/// };
/// assert_eq!(cube.radius_of_gyration(), 0.5);
/// assert!(cube.check_physical(0.0).is_ok());
/// // About the frame origin, 1 m along x, the parallel axes add m d^2 about y and z.
/// assert_eq!(cube.parameters().I_BBo_B, Matrix3::from_diagonal(&Vector3::new(1.0, 7.0, 7.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassProperties {
    /// Mass, kg.
    pub mass: f64,
    /// Position of the mass centre from the body's frame origin, in B, m.
    pub p_BoBcm_B: Vector3,
    /// Inertia tensor about the mass centre in B, tensor elements, kg m2.
    pub I_BBcm_B: Matrix3,
}

/// Why mass properties are unphysical: no distribution of positive mass has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unphysical {
    /// A number is NaN or infinite.
    NotFinite,
    /// The mass is negative, kg.
    NegativeMass(f64),
    /// The mass is zero, but the first moment or the inertia is not.
    MasslessWithInertia,
    /// The smallest principal moment of the central inertia is negative, kg m2.
    Indefinite([f64; 3]),
    /// The largest principal moment exceeds the sum of the other two, kg m2 in ascending order.
    Triangle([f64; 3]),
}

/// `m (c.c 1 - c c^T)`: contribution of a point mass at `c` to an inertia tensor (parallel-axis theorem), kg m2.
///
/// ```
/// use poinsot_spatial::{Matrix3, Vector3, parallel_axis};
///
/// // 2 kg at (1, 1, 0): I_xx = m y^2, I_xy = -m x y, I_zz = m (x^2 + y^2).
/// let I = parallel_axis(2.0, &Vector3::new(1.0, 1.0, 0.0));
/// assert_eq!(I, Matrix3::new(2.0, -2.0, 0.0, -2.0, 2.0, 0.0, 0.0, 0.0, 4.0));
/// ```
#[inline]
pub fn parallel_axis(mass: f64, c: &Vector3) -> Matrix3 {
    // Element by element: with -C target-cpu=x86-64-v3, LLVM 22 makes a wrong element of `c * c.transpose()` when it
    // vectorises (z z from y z).
    let (x, y, z) = (c.x, c.y, c.z);
    let (xy, xz, yz) = (-mass * (x * y), -mass * (x * z), -mass * (y * z));
    Matrix3::new(
        mass * (y * y + z * z),
        xy,
        xz,
        xy,
        mass * (x * x + z * z),
        yz,
        xz,
        yz,
        mass * (x * x + y * y),
    )
}

/// The 4 x 4 pseudo-inertia `[[Sigma, mc], [mc^T, m]]` with `Sigma = tr(I)/2 1 - I` about `Bo`
/// (Wensing, Kim, Slotine 2018, eq. 9): positive definite exactly for realisable bodies.
///
/// ```
/// use poinsot_spatial::{MassProperties, Matrix3, Vector3, pseudo_inertia};
///
/// let body = |moments: Vector3| MassProperties {
///     mass: 10.0,
///     p_BoBcm_B: Vector3::x(),
///     I_BBcm_B: Matrix3::from_diagonal(&moments),
/// };
/// let is_real = |moments| pseudo_inertia(&body(moments).parameters()).cholesky().is_some();
/// assert!(is_real(Vector3::new(1.0, 2.0, 2.5)));
/// // The largest moment exceeds the sum of the others: no distribution of mass has it.
/// assert!(!is_real(Vector3::new(1.0, 2.0, 3.5)));
/// ```
pub fn pseudo_inertia(parameters: &InertialParameters) -> Matrix4<f64> {
    let sigma = Matrix3::identity() * (0.5 * parameters.I_BBo_B.trace()) - parameters.I_BBo_B;
    let mut j = Matrix4::zeros();
    j.fixed_view_mut::<3, 3>(0, 0).copy_from(&sigma);
    j.fixed_view_mut::<3, 1>(0, 3).copy_from(&parameters.mc_B);
    j.fixed_view_mut::<1, 3>(3, 0)
        .copy_from(&parameters.mc_B.transpose());
    j[(3, 3)] = parameters.mass;
    j
}

/// Elements of a symmetric tensor in the order of [`PARAMETER_NAMES`].
///
/// ```
/// use poinsot_spatial::{Matrix3, PARAMETER_NAMES, elements};
///
/// let I = Matrix3::new(1.0, 2.0, 4.0, 2.0, 3.0, 5.0, 4.0, 5.0, 6.0);
/// assert_eq!(elements(&I), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
/// assert_eq!(PARAMETER_NAMES[4..], ["I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz"]);
/// ```
pub fn elements(I: &Matrix3) -> [f64; 6] {
    [I.m11, I.m12, I.m22, I.m13, I.m23, I.m33]
}

/// The inverse of [`elements`].
///
/// ```
/// use poinsot_spatial::{elements, tensor};
///
/// let six = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
/// assert_eq!(tensor(six)[(0, 2)], 4.0);
/// assert_eq!(elements(&tensor(six)), six);
/// ```
pub fn tensor([xx, xy, yy, xz, yz, zz]: [f64; 6]) -> Matrix3 {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Eigenvalues of a symmetric matrix in ascending order, and the rotation whose columns are their axes (right-handed).
///
/// ```
/// use poinsot_spatial::{Matrix3, Vector3, principal_axes};
///
/// let (moments, axes) = principal_axes(&Matrix3::from_diagonal(&Vector3::new(3.0, 1.0, 2.0)));
/// assert_eq!(moments, [1.0, 2.0, 3.0]);
/// assert_eq!(axes.column(0).iamax(), 1);
/// ```
pub fn principal_axes(I: &Matrix3) -> ([f64; 3], Matrix3) {
    let eigen = SymmetricEigen::new(*I);
    let mut order = [0, 1, 2];
    order.sort_unstable_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let moments = order.map(|k| eigen.eigenvalues[k]);
    let mut axes = Matrix3::from_columns(&order.map(|k| eigen.eigenvectors.column(k).into_owned()));
    if axes.determinant() < 0.0 {
        axes.set_column(2, &(-axes.column(2)));
    }
    (moments, axes)
}

/// `K` with `I w = K elements(I)`.
///
/// ```
/// use poinsot_spatial::{Vector3, tensor, tensor_regressor};
///
/// let (six, w) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], Vector3::new(1.0, -2.0, 3.0));
/// let product = tensor_regressor(&w) * nalgebra::Vector6::from(six);
/// assert_eq!(product, tensor(six) * w);
/// ```
#[rustfmt::skip]
pub fn tensor_regressor(w: &Vector3) -> Matrix3x6<f64> {
    Matrix3x6::new(
        w.x, w.y, 0.0, w.z, 0.0, 0.0,
        0.0, w.x, w.y, 0.0, w.z, 0.0,
        0.0, 0.0, 0.0, w.x, w.y, w.z,
    )
}

impl InertialParameters {
    /// These with a share of others added: all ten are linear in the distribution of mass.
    #[must_use]
    pub fn with_added(&self, share: f64, others: &Self) -> Self {
        Self {
            mass: self.mass + share * others.mass,
            mc_B: self.mc_B + others.mc_B * share,
            I_BBo_B: self.I_BBo_B + others.I_BBo_B * share,
        }
    }

    /// The same body about the origin of another frame and in its axes; the own frame has position `p` and rotation `R` in it
    /// (parallel-axis theorem).
    ///
    /// ```
    /// use poinsot_spatial::{MassProperties, Matrix3, Vector3};
    ///
    /// let I_BBcm_B = Matrix3::identity();
    /// let body = MassProperties { mass: 2.0, p_BoBcm_B: Vector3::zeros(), I_BBcm_B }.parameters();
    /// // 1 m along x: m d^2 more about y and z.
    /// let moved = body.transported(&Matrix3::identity(), &Vector3::x());
    /// assert_eq!(moved.I_BBo_B, Matrix3::from_diagonal(&Vector3::new(1.0, 3.0, 3.0)));
    /// ```
    #[must_use]
    pub fn transported(&self, R: &Matrix3, p: &Vector3) -> Self {
        let mc = R * self.mc_B;
        let cross =
            Matrix3::identity() * (2.0 * p.dot(&mc)) - p * mc.transpose() - mc * p.transpose();
        Self {
            mass: self.mass,
            mc_B: mc + p * self.mass,
            I_BBo_B: R * self.I_BBo_B * R.transpose() + parallel_axis(self.mass, p) + cross,
        }
    }

    /// A body without mass and inertia.
    pub const ZERO: Self = Self {
        mass: 0.0,
        mc_B: Vector3::new(0.0, 0.0, 0.0),
        I_BBo_B: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// One of parameter `k` in the order of [`PARAMETER_NAMES`], and zero of all others.
    pub fn unit(k: usize) -> Self {
        let mut unit = [0.0; 10];
        unit[k] = 1.0;
        Self::from_array(&unit)
    }

    /// The parameters in the order of [`PARAMETER_NAMES`].
    pub fn to_array(&self) -> [f64; 10] {
        let c = &self.mc_B;
        let [xx, xy, yy, xz, yz, zz] = elements(&self.I_BBo_B);
        [self.mass, c.x, c.y, c.z, xx, xy, yy, xz, yz, zz]
    }

    /// The inverse of [`Self::to_array`].
    pub fn from_array(p: &[f64; 10]) -> Self {
        Self {
            mass: p[0],
            mc_B: Vector3::new(p[1], p[2], p[3]),
            I_BBo_B: tensor([p[4], p[5], p[6], p[7], p[8], p[9]]),
        }
    }

    /// Mass, mass centre and central inertia; `None` if the mass is not positive.
    pub fn mass_properties(&self) -> Option<MassProperties> {
        (self.mass > 0.0).then(|| MassProperties {
            mass: self.mass,
            p_BoBcm_B: self.p_BoScm_B(),
            I_BBcm_B: self.I_SScm_B(),
        })
    }

    /// Mass centre of the system S that they describe, a body or several as one, m; not finite without mass.
    pub fn p_BoScm_B(&self) -> Vector3 {
        self.mc_B / self.mass
    }

    /// Its inertia about the mass centre, kg m2; not finite without mass.
    pub fn I_SScm_B(&self) -> Matrix3 {
        self.I_BBo_B - parallel_axis(self.mass, &self.p_BoScm_B())
    }

    /// The locked inertia `H`: momentum about `Bo` per unit twist of B, linear part first.
    pub fn locked_inertia(&self) -> Matrix6 {
        let mut h = Matrix6::identity() * self.mass;
        let mc = skew(&self.mc_B);
        h.fixed_view_mut::<3, 3>(0, 3).copy_from(&-mc);
        h.fixed_view_mut::<3, 3>(3, 0).copy_from(&mc);
        h.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.I_BBo_B);
        h
    }
}

impl MassProperties {
    /// A body without mass.
    pub const ZERO: Self = Self {
        mass: 0.0,
        p_BoBcm_B: Vector3::new(0.0, 0.0, 0.0),
        I_BBcm_B: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// The ten numbers in the order of [`MASS_PROPERTY_NAMES`].
    ///
    /// ```
    /// use poinsot_spatial::MassProperties;
    ///
    /// let numbers = [2.0, 0.1, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 3.0];
    /// let body = MassProperties::from_array(&numbers);
    /// assert_eq!((body.p_BoBcm_B.x, body.to_array()), (0.1, numbers));
    /// ```
    pub fn to_array(&self) -> [f64; 10] {
        let c = &self.p_BoBcm_B;
        let [xx, xy, yy, xz, yz, zz] = elements(&self.I_BBcm_B);
        [self.mass, c.x, c.y, c.z, xx, xy, yy, xz, yz, zz]
    }

    /// The inverse of [`Self::to_array`].
    pub fn from_array(p: &[f64; 10]) -> Self {
        Self {
            mass: p[0],
            p_BoBcm_B: Vector3::new(p[1], p[2], p[3]),
            I_BBcm_B: tensor([p[4], p[5], p[6], p[7], p[8], p[9]]),
        }
    }

    /// Natural units of the ten numbers: m, L and m L^2 with the radius of gyration L.
    pub fn natural_units(&self) -> [f64; 10] {
        let (m, L) = (self.mass, self.radius_of_gyration());
        core::array::from_fn(|k| match k {
            0 => m,
            1..=3 => L,
            _ => m * L * L,
        })
    }

    /// The barycentric parameters about the body's frame origin.
    pub fn parameters(&self) -> InertialParameters {
        InertialParameters {
            mass: self.mass,
            mc_B: self.mass * self.p_BoBcm_B,
            I_BBo_B: self.I_BBcm_B + parallel_axis(self.mass, &self.p_BoBcm_B),
        }
    }

    /// Principal moments in ascending order, kg m2, and the rotation whose columns are their axes in B
    /// (right-handed).
    pub fn principal(&self) -> ([f64; 3], Matrix3) {
        principal_axes(&self.I_BBcm_B)
    }

    /// The body with the nearest tensor that a mass distribution has: the second moments along its principal axes,
    /// `tr(I) / 2 - I_k`, are at least a thousandth of half the trace. All else stays.
    ///
    /// ```
    /// use poinsot_spatial::{MassProperties, Matrix3, Vector3};
    ///
    /// // The largest moment exceeds the sum of the others by 0.2 kg m2.
    /// let I_BBcm_B = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 2.2));
    /// let guess = MassProperties { mass: 3.0, p_BoBcm_B: Vector3::zeros(), I_BBcm_B };
    /// let near = guess.nearest_physical();
    /// assert!(near.check_physical(0.0).is_ok());
    /// assert!((near.I_BBcm_B - guess.I_BBcm_B).amax() < 0.11);
    /// ```
    pub fn nearest_physical(&self) -> Self {
        let (moments, axes) = self.principal();
        let half = 0.5 * moments.iter().sum::<f64>();
        let second = moments.map(|moment| (half - moment).max(1.0e-3 * half.abs()));
        let sum: f64 = second.iter().sum();
        let moments = Matrix3::from_diagonal(&Vector3::from(second.map(|s| sum - s)));
        Self {
            I_BBcm_B: axes * moments * axes.transpose(),
            ..*self
        }
    }

    /// Radius of gyration, m: root mean square distance of the mass from its centre,
    /// `sqrt(tr(I_BBcm) / 2 m)`; zero for a massless body.
    ///
    /// With the mass it gives the natural units m, m L, m L^2 of identifiability.
    pub fn radius_of_gyration(&self) -> f64 {
        if self.mass > 0.0 {
            (self.I_BBcm_B.trace().max(0.0) / (2.0 * self.mass)).sqrt()
        } else {
            0.0
        }
    }

    /// Whether some distribution of positive mass has these properties.
    ///
    /// `tolerance` is relative to the largest principal moment: rounding in printed tables of slender bodies violates
    /// the triangle inequality.
    ///
    /// # Errors
    /// The first condition that fails.
    pub fn check_physical(&self, tolerance: f64) -> Result<(), Unphysical> {
        let finite = self.mass.is_finite()
            && self.p_BoBcm_B.iter().all(|x| x.is_finite())
            && self.I_BBcm_B.iter().all(|x| x.is_finite());
        if !finite {
            return Err(Unphysical::NotFinite);
        }
        if self.mass < 0.0 {
            return Err(Unphysical::NegativeMass(self.mass));
        }
        if self.mass == 0.0 && self.I_BBcm_B.iter().any(|x| *x != 0.0) {
            return Err(Unphysical::MasslessWithInertia);
        }
        let (moments, _) = self.principal();
        let slack = tolerance * moments[2].abs();
        if moments[0] < -slack {
            return Err(Unphysical::Indefinite(moments));
        }
        if moments[2] > moments[0] + moments[1] + slack {
            return Err(Unphysical::Triangle(moments));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> MassProperties {
        MassProperties {
            mass: 30.0,
            p_BoBcm_B: Vector3::new(-0.27, 0.0, 0.43),
            I_BBcm_B: Matrix3::new(
                2.398, -0.069, 0.013, -0.069, 2.678, 0.051, 0.013, 0.051, 1.405,
            ),
        }
    }

    #[test]
    fn unit_parameters_round_trip() {
        let back = InertialParameters::from_array(&body().parameters().to_array())
            .mass_properties()
            .unwrap();
        assert!((back.p_BoBcm_B - body().p_BoBcm_B).norm() < 1e-15);
        assert!((back.I_BBcm_B - body().I_BBcm_B).norm() < 1e-14);
    }

    #[test]
    fn exact_two_point_masses_have_the_textbook_tensor() {
        // Two masses of 1 kg at (1, 1, 0) and (-1, -1, 0): I_xy = -sum x y = -2.
        let i = parallel_axis(1.0, &Vector3::new(1.0, 1.0, 0.0))
            + parallel_axis(1.0, &Vector3::new(-1.0, -1.0, 0.0));
        assert_eq!(
            i,
            Matrix3::new(2.0, -2.0, 0.0, -2.0, 2.0, 0.0, 0.0, 0.0, 4.0)
        );
    }

    #[test]
    fn unit_pseudo_inertia_is_definite_for_a_real_body_and_not_for_a_broken_one() {
        assert!(pseudo_inertia(&body().parameters()).cholesky().is_some());
        let mut broken = body();
        broken.I_BBcm_B[(2, 2)] = 9.0;
        assert!(pseudo_inertia(&broken.parameters()).cholesky().is_none());
        assert!(matches!(
            broken.check_physical(0.0),
            Err(Unphysical::Triangle(_))
        ));
    }

    #[test]
    fn unit_principal_axes_diagonalise() {
        let (moments, axes) = body().principal();
        let d = axes.transpose() * body().I_BBcm_B * axes;
        for k in 0..3 {
            assert!((d[(k, k)] - moments[k]).abs() < 1e-13);
        }
        assert!((axes.determinant() - 1.0).abs() < 1e-14);
    }
}
