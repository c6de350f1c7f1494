//! Rows of states in memory, and the same states side by side.

use crate::algebra::V3;
use crate::inertial::Inertial;
use crate::lanes::{Lanes, MOST};
use crate::symmetric::Symmetric;
use crate::tree::Tree;
use fearless_simd::Simd;
use nalgebra::Vector3;
use poinsot_spatial::InertialParameters;

/// Numbers of a twist, momentum or wrench.
pub(super) const TWIST: usize = 6;
/// Columns of the momentum regressor per body, and their numbers.
pub(super) const COLUMNS: usize = 10;
pub(super) const PER_BODY: usize = COLUMNS * TWIST;

/// The states side by side.
pub(super) struct Group<'a, S: Simd> {
    pub tree: &'a Tree,
    pub simd: S,
    /// Index of the first.
    pub first: usize,
    /// States of the group: as many as lanes, fewer in the last one, whose other lanes repeat its last state.
    pub count: usize,
}

/// The groups of the states that have rows of `width` numbers in `out`, each with its rows.
#[inline(always)]
pub(super) fn groups<'a, S: Simd>(
    tree: &'a Tree,
    simd: S,
    width: usize,
    out: &'a mut [f64],
) -> impl Iterator<Item = (Group<'a, S>, &'a mut [f64])> {
    let lanes = Lanes::<S>::COUNT;
    let parts = out.chunks_mut((lanes * width).max(1)).enumerate();
    parts.map(move |(k, of)| {
        let group = Group {
            tree,
            simd,
            first: lanes * k,
            count: of.len() / width,
        };
        (group, of)
    })
}

impl<S: Simd> Group<'_, S> {
    /// Index of the state in a lane.
    #[inline(always)]
    fn state(&self, lane: usize) -> usize {
        self.first + lane.min(self.count - 1)
    }

    /// The rows of `width` numbers of these states.
    #[inline(always)]
    pub fn rows<'a>(&self, all: &'a [f64], width: usize) -> Source<'a> {
        let mut rows = [&all[..0]; MOST];
        for (lane, row) in rows[..Lanes::<S>::COUNT].iter_mut().enumerate() {
            *row = &all[self.state(lane) * width..][..width];
        }
        Source(rows)
    }

    /// The bodies in a lane: those of all states, or its own.
    pub fn bodies_of<'a>(
        &self,
        lane: usize,
        all: &'a [InertialParameters],
    ) -> &'a [InertialParameters] {
        let many = self.tree.bodies();
        match all.len() == many {
            true => all,
            false => &all[self.state(lane) * many..][..many],
        }
    }

    /// The bodies of these states where every state has its own.
    pub fn gather(&self, all: &[InertialParameters], bodies: &mut [Inertial<Lanes<S>>]) {
        if all.len() == bodies.len() {
            return;
        }
        for (i, body) in bodies.iter_mut().enumerate() {
            let mut of = [[0.0; MOST]; COLUMNS];
            for lane in 0..Lanes::<S>::COUNT {
                let numbers = self.bodies_of(lane, all)[i].to_array();
                for (row, number) in of.iter_mut().zip(numbers) {
                    row[lane] = number;
                }
            }
            let [mass, x, y, z, inertia @ ..] = of.map(|n| Lanes::from_array(self.simd, &n));
            *body = Inertial {
                mass,
                mc: V3::new(x, y, z),
                I: Symmetric::new(inertia),
            };
        }
    }
}

/// One row per lane.
pub(super) struct Source<'a>([&'a [f64]; MOST]);

impl Source<'_> {
    /// Number `k` of each row.
    #[inline(always)]
    pub fn number<S: Simd>(&self, simd: S, k: usize) -> Lanes<S> {
        let mut numbers = [0.0; MOST];
        let rows = &self.0[..Lanes::<S>::COUNT];
        for (number, row) in numbers.iter_mut().zip(rows) {
            *number = row[k];
        }
        Lanes::from_array(simd, &numbers)
    }

    /// The vector of the numbers from `k` on.
    #[inline(always)]
    pub fn vector<S: Simd>(&self, simd: S, k: usize) -> Vector3<Lanes<S>> {
        let (x, y) = (self.number(simd, k), self.number(simd, k + 1));
        Vector3::new(x, y, self.number(simd, k + 2))
    }

    /// A linear and an angular vector.
    #[inline(always)]
    pub fn pair<S: Simd>(&self, simd: S) -> [Vector3<Lanes<S>>; 2] {
        [self.vector(simd, 0), self.vector(simd, 3)]
    }
}

/// The rows of the result of one group.
pub(super) struct Rows<'a> {
    /// One for each lane; empty where the group has no such state.
    of: [&'a mut [f64]; MOST],
}

impl<'a> Rows<'a> {
    /// The rows of `width` numbers in `all`, one per state of a group.
    #[inline(always)]
    pub fn new(all: &'a mut [f64], width: usize) -> Self {
        let mut of: [&mut [f64]; MOST] = Default::default();
        for (of, row) in of.iter_mut().zip(all.chunks_exact_mut(width)) {
            *of = row;
        }
        Self { of }
    }

    /// [`Self::put`] of all numbers.
    #[inline(always)]
    pub fn put_all<S: Simd>(&mut self, numbers: &[Lanes<S>]) {
        let (fours, rest) = numbers.as_chunks::<4>();
        for (k, four) in fours.iter().enumerate() {
            self.put(4 * k, four);
        }
        for (k, one) in rest.iter().enumerate() {
            self.put(4 * fours.len() + k, &[*one]);
        }
    }

    /// Puts the numbers of all lanes into their rows, from column `at` on.
    #[inline(always)]
    pub fn put<S: Simd, const N: usize>(&mut self, at: usize, numbers: &[Lanes<S>; N]) {
        let [a, b, c, d, e, f, g, h] = &mut self.of;
        let (a, b, c, d) = (part(a, at), part(b, at), part(c, at), part(d, at));
        let (e, f, g, h) = (part(e, at), part(f, at), part(g, at), part(h, at));
        let mut parts: [Option<&mut [f64; N]>; MOST] = [a, b, c, d, e, f, g, h];
        let (fours, rest) = numbers.as_chunks::<4>();
        for (k, four) in fours.iter().enumerate() {
            let turned = Lanes::four_of_each(*four);
            for lane in 0..Lanes::<S>::COUNT {
                if let Some(part) = &mut parts[lane] {
                    part[4 * k..][..4].copy_from_slice(&turned[lane]);
                }
            }
        }
        for (k, number) in rest.iter().enumerate() {
            let number = number.to_array();
            for lane in 0..Lanes::<S>::COUNT {
                if let Some(part) = &mut parts[lane] {
                    part[N - rest.len() + k] = number[lane];
                }
            }
        }
    }
}

/// `N` numbers of a row.
#[inline(always)]
fn part<'a, const N: usize>(row: &'a mut &mut [f64], at: usize) -> Option<&'a mut [f64; N]> {
    row.get_mut(at..)?.first_chunk_mut()
}
