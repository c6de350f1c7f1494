//! Bodies with known mass and mass centre: unobservable parts are transferred across joints to meet these values.

use super::super::least_squares::shown_and_hidden;
use super::super::natural;
use super::super::two_body::{equations, rows, transported};
use super::Work;
use crate::samples::add_smallest;
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
        // Mass and first moment of the kept bodies, in natural units.
        let natural = |b: usize| natural(&self.problem.model.bodies[b].nominal);
        let units: Vec<[f64; 10]> = kept.iter().map(|&b| natural(b)).collect();
        let A = Mat::from_fn(4 * kept.len(), moves.len(), |i, j| {
            let (b, k, t) = (kept[i / 4], i % 4, &moves[j]);
            let ends = [t.child, t.parent].into_iter().zip(&t.gains);
            let own = ends.filter(|(body, _)| *body == b);
            own.map(|(_, gain)| gain.to_array()[k]).sum::<f64>() / units[i / 4][k]
        });
        let missing = |i: usize| {
            let (b, k) = (kept[i / 4], i % 4);
            let nominal = self.problem.model.bodies[b].nominal.parameters();
            (nominal.to_array()[k] - self.found.bodies[b].to_array()[k]) / units[i / 4][k]
        };
        let missing: Vec<f64> = (0..4 * kept.len()).map(missing).collect();
        let mut amounts = vec![0.0; moves.len()];
        if add_smallest(&A, &missing, 1.0e-9, &mut amounts).is_none() {
            return;
        }
        for (t, amount) in moves.iter().zip(amounts) {
            for (body, gain) in [t.child, t.parent].into_iter().zip(&t.gains) {
                self.found.bodies[body] = self.found.bodies[body].with_added(amount, gain);
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
            let negative = |x: &InertialParameters| InertialParameters::ZERO.with_added(-1.0, x);
            let across = |x: &InertialParameters| [negative(&transported(x, &R, &p)), *x];
            let nominal = self.composite(c, |b| self.carries(c, b));
            let Some(units) = nominal.mass_properties().map(|body| natural(&body)) else {
                continue;
            };
            let seen = equations(&rows(&self.motions(joint), across));
            let Some((_, hidden)) = shown_and_hidden(&seen, &units) else {
                continue;
            };
            list.extend((0..hidden.ncols()).map(|h| {
                let d = std::array::from_fn(|k| units[k] * hidden[(k, h)]);
                let d = InertialParameters::from_array(&d);
                Transfer {
                    child,
                    parent,
                    gains: [
                        self.moved(&d, c, child),
                        negative(&self.moved(&d, c, parent)),
                    ],
                }
            }));
        }
        list
    }
}
