//! The total mass if thrust segments have no translation: the second use of the Conclusion as printed.
//!
//! Attitude determines tensor and mass centre of the locked robot. The parameters of the whole, and so the momentum of
//! a moving joint, are then affine in the total mass. The ten numbers of one side and the mass are eleven unknowns of
//! a linear problem.

use super::super::least_squares::{Rows, answer, shown};
use super::super::two_body::{TwoBodyReading, equations, rows, transported_back};
use super::super::{natural, sum};
use super::steps::push;
use super::{Work, properties_of};
use crate::xu2017::error;
use nalgebra::SVector;
use poinsot_files::Faults;
use poinsot_spatial::{InertialParameters, MassProperties};

/// Change of the total mass for one unit of a column, kg.
const UNIT: f64 = 1.0;

impl Work<'_> {
    /// Determines the total mass from the motion of one joint.
    pub(super) fn weigh(&mut self, joint: usize) -> Result<(), Faults> {
        let total = self.found.total.ok_or_else(error::no_scale)?;
        let whole = properties_of(&total)?;
        let of_mass = |mass: f64| MassProperties { mass, ..whole }.parameters();
        let child = self.child(joint);
        let nominal = self.composite(0, |b| !self.carries(child, b));
        let mut units = natural(&properties_of(&nominal)?).to_vec();
        units.push(whole.mass);
        let mut start = nominal.to_array().to_vec();
        start.push(whole.mass);
        let seen = shown(
            &self.eleven(&self.motions(joint), child, &of_mass, whole.mass),
            &units,
        );

        let readings = self.readings(joint)?;
        let free = self.momentum_is_free();
        let heads = if free { 6 * readings.len() } else { 0 };
        let mut system = Rows::new(heads, 11);
        for (k, (_, list)) in readings.iter().enumerate() {
            let lists = [0.0, UNIT].map(|more| {
                let side = self.beside(child, of_mass(whole.mass + more));
                rows(list, side)
            });
            for (row, heavier) in lists[0].iter().zip(&lists[1]) {
                let column = (heavier.constant - row.constant) / UNIT;
                // The unknown is the mass itself, so its nominal part is removed from the constant.
                let mut row = *row;
                row.constant -= column * whole.mass;
                push(&mut system, &row, &[column], free.then_some(6 * k), heads);
            }
        }
        let found = answer(system, &units, &start, seen.as_ref());
        let mass = found.value[10];
        if !found.finite || mass.is_nan() || mass <= 0.0 {
            return Err(error::not_finite());
        }
        self.found.total = Some(of_mass(mass));
        Ok(())
    }

    /// Base side `x`, and the remainder of the whole behind the joint of `child`.
    fn beside(
        &self,
        child: usize,
        whole: InertialParameters,
    ) -> impl Fn(&InertialParameters) -> [InertialParameters; 2] {
        let (R, p) = (self.normal.R[child], self.normal.p[child]);
        move |x| [*x, transported_back(&sum(&whole, x, -1.0), &R, &p)]
    }

    /// Equations of the eleven unknowns.
    fn eleven(
        &self,
        list: &[TwoBodyReading],
        child: usize,
        of_mass: &dyn Fn(f64) -> InertialParameters,
        mass: f64,
    ) -> Vec<[f64; 11]> {
        let light = rows(list, self.beside(child, of_mass(mass)));
        let heavy = rows(list, self.beside(child, of_mass(mass + UNIT)));
        let columns = light.iter().zip(&heavy).flat_map(|(a, b)| {
            let change: SVector<f64, 9> = (b.constant - a.constant) / UNIT;
            [0, 1, 2, 6, 7, 8].map(|i| change[i])
        });
        let ten = equations(&light);
        ten.iter()
            .zip(columns)
            .map(|(ten, last)| std::array::from_fn(|j| if j < 10 { ten[j] } else { last }))
            .collect()
    }
}
