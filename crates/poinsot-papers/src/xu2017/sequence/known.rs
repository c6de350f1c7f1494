//! Bodies with known mass and mass centre: unobservable parts are transferred across joints to meet these values.

use super::super::least_squares::{shown_and_hidden, smallest};
use super::super::two_body::{equations, rows, transported};
use super::super::{natural, sum};
use super::Work;
use faer::Mat;
use poinsot_spatial::InertialParameters;

/// An unobservable transfer across a joint: gain of the child, gain of the parent side.
struct Transfer {
    child: usize,
    parent: usize,
    gains: [InertialParameters; 2],
}

impl Work<'_> {
    /// Applies the smallest transfers, in natural units, that give these bodies their known mass and mass centre.
    pub(super) fn keep_known(&mut self, outers: &[Option<InertialParameters>]) {
        let roots = self.roots(outers);
        let alone = |b: usize| roots.iter().filter(|r| **r == roots[b]).count() == 1;
        let kept: Vec<usize> = (0..roots.len())
            .filter(|&b| self.roles.tensor_alone[b] && alone(b))
            .collect();
        let moves = self.transfers(outers, &roots);
        if kept.is_empty() || moves.is_empty() {
            return;
        }
        let gain = |t: &Transfer, b: usize, k: usize| -> f64 {
            let of = |body: usize, which: usize| {
                if body == b {
                    t.gains[which].to_array()[k]
                } else {
                    0.0
                }
            };
            of(t.child, 0) + of(t.parent, 1)
        };
        let unit = |b: usize, k: usize| natural(&self.problem.model.bodies[b].nominal)[k];
        let at = |row: usize| (kept[row / 4], row % 4);
        let A = Mat::from_fn(4 * kept.len(), moves.len(), |i, j| {
            let (b, k) = at(i);
            gain(&moves[j], b, k) / unit(b, k)
        });
        let wanted: Vec<f64> = (0..4 * kept.len())
            .map(|i| {
                let (b, k) = at(i);
                let nominal = self.problem.model.bodies[b].nominal.parameters().to_array()[k];
                (nominal - self.found.bodies[b].to_array()[k]) / unit(b, k)
            })
            .collect();
        let Some(amounts) = smallest(&A, &wanted) else {
            return;
        };
        for (t, amount) in moves.iter().zip(amounts) {
            for (body, gain) in [t.child, t.parent].into_iter().zip(&t.gains) {
                self.found.bodies[body] = sum(&self.found.bodies[body], gain, amount);
            }
        }
    }

    /// Every unobservable direction of a joint with unknown bodies on both sides.
    fn transfers(&self, outers: &[Option<InertialParameters>], roots: &[usize]) -> Vec<Transfer> {
        let takes =
            |root: usize| (0..roots.len()).find(|&b| roots[b] == root && self.roles.unknown[b]);
        let mut list = Vec::new();
        for joint in (0..outers.len()).filter(|&j| outers[j].is_some()) {
            let c = self.child(joint);
            let (Some(child), Some(parent)) = (takes(c), takes(roots[self.parent(c)])) else {
                continue;
            };
            let (R, p) = (self.normal.R[c], self.normal.p[c]);
            let across = |x: &InertialParameters| {
                [
                    sum(&InertialParameters::ZERO, &transported(x, &R, &p), -1.0),
                    *x,
                ]
            };
            let nominal = self.composite(c, |b| self.carries(c, b));
            let Some(body) = nominal.mass_properties() else {
                continue;
            };
            let units = natural(&body);
            let seen = equations(&rows(&self.motions(joint), across));
            let Some((_, hidden)) = shown_and_hidden(&seen, &units) else {
                continue;
            };
            list.extend((0..hidden.ncols()).map(|h| {
                let d = std::array::from_fn(|k| units[k] * hidden[(k, h)]);
                let d = InertialParameters::from_array(&d);
                let back = sum(&InertialParameters::ZERO, &self.moved(&d, c, parent), -1.0);
                Transfer {
                    child,
                    parent,
                    gains: [self.moved(&d, c, child), back],
                }
            }));
        }
        list
    }
}
