//! Shapes that predict the same measurements: tensors along the unobservable directions.

use super::tensor::{inertia_ellipsoid, matrix};
use poinsot_figures::{Morph, Point};
use poinsot_formats::{BodyFile, EstimateFile, unknown_name};
use poinsot_spatial::{Matrix3, Vector3, parallel_axis};
use std::collections::HashMap;

/// Elements in the order of [`matrix`].
const ELEMENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

/// Closed sequence of shapes: from the estimate along every unobservable direction, both ways. `None` if no direction
/// changes this body's tensor.
pub(super) fn morph(e: &EstimateFile, name: &str, body: &BodyFile) -> Option<Morph> {
    let walks = e.identifiability.not_identifiable.iter().map(|o| &o.walk);
    let all: Vec<Vec<Matrix3>> = walks
        .filter_map(|walk| {
            let walk = walk.iter().map(|(a, v)| (unknown_name(a), v.as_slice()));
            tensors(&walk.collect(), name, body)
        })
        .filter(|t| moves(t))
        .collect();
    let first = all.first()?;
    let size = (first[first.len() / 2].trace() / 3.0).sqrt();
    let mut out = Morph::default();
    for (k, tensors) in all.iter().enumerate() {
        for at in round(tensors.len()) {
            let I = &tensors[at];
            out.axes.push(inertia_ellipsoid(I, size)?);
            out.words.push(format!(
                "direction {} of {}: I_xx {:.3}, I_yy {:.3}, I_zz {:.3} kg m\u{b2}",
                k + 1,
                all.len(),
                I[(0, 0)],
                I[(1, 1)],
                I[(2, 2)]
            ));
        }
    }
    Some(out)
}

/// Indices from the middle to the last, back to the first, and to the middle.
fn round(count: usize) -> impl Iterator<Item = usize> {
    let middle = count / 2;
    (middle..count).chain((0..count - 1).rev()).chain(1..middle)
}

/// The two shapes farthest from the estimate, for a static picture.
pub(super) fn ends(morph: &Morph) -> [[Point; 3]; 2] {
    let far = |axes: &[Point; 3]| -> f64 {
        let pairs = axes.iter().flatten().zip(morph.axes[0].iter().flatten());
        pairs.map(|(a, b)| (a.abs() - b.abs()).powi(2)).sum()
    };
    let half = morph.axes.len() / 2;
    [&morph.axes[..half.max(1)], &morph.axes[half..]].map(|part| {
        let most = part.iter().max_by(|a, b| far(a).total_cmp(&far(b)));
        *most.unwrap_or(&morph.axes[0])
    })
}

/// Tensor about the mass centre at every point of a walk along a direction.
fn tensors(walk: &HashMap<String, &[f64]>, name: &str, body: &BodyFile) -> Option<Vec<Matrix3>> {
    let count = walk.values().next()?.len();
    let com = body.com_m.map(|n| n.value);
    let mass = body.mass_kg.value;
    let tensor = |at: usize| -> Option<Matrix3> {
        let of = |what: &str| walk.get(&format!("{name}.{what}")).map(|v| v[at]);
        let six = |point: &str| -> Option<Matrix3> {
            let mut six = [0.0; 6];
            for (out, element) in six.iter_mut().zip(ELEMENTS) {
                *out = of(&format!("I_{point}_{element}"))?;
            }
            Some(matrix(&six))
        };
        if let Some(I) = six("BBcm") {
            return Some(I);
        }
        let m = of("m").or(mass)?;
        let mut c = Vector3::zeros();
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let first = of(&format!("mc_{axis}")).map(|mc| mc / m);
            c[k] = first.or(com[k])?;
        }
        Some(six("BBo")? - parallel_axis(m, &c))
    };
    (0..count).map(tensor).collect()
}

/// Whether the tensor differs at the ends.
fn moves(tensors: &[Matrix3]) -> bool {
    let [Some(first), Some(last)] = [tensors.first(), tensors.last()] else {
        return false;
    };
    (first - last).norm() > f64::EPSILON * first.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_a_round_passes_every_shape_and_ends_beside_its_start() {
        let all: Vec<usize> = round(5).collect();
        assert_eq!(all, [2, 3, 4, 3, 2, 1, 0, 1]);
    }
}
