//! Poinsot's picture (Poinsot 1834). The inertia ellipsoid `x . I x = const` touches, at the pole
//! `x = w sqrt(const / w . I w)`, a plane whose normal is `I w`. In torque-free motion the plane is invariable and the
//! ellipsoid rolls on it. The pole traces the polhode on the ellipsoid and the herpolhode on the plane.

use super::Answer;
use super::poles::Poles;
use super::tensor::{inertia_ellipsoid, matrix, principal, principal_sigmas};
use super::vehicle::drawn;
use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use nalgebra::Cholesky;
use poinsot_figures::{Arrow, Ellipsoid, Figure, PageError, Part, Scene, Spot, half_width};
use poinsot_files::significant;
use poinsot_formats::{BodyFile, all_known};
use poinsot_spatial::{Matrix3, Vector3, tensor};

/// Line width relative to a semi-axis: a thinner interval is not drawn.
const LINE: f64 = 0.004;
/// Number of ellipsoids drawn from the covariance.
const GHOSTS: usize = 6;
/// Length of a body axis relative to the mean semi-axis.
const AXIS: f64 = 1.4;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let ellipsoid = chosen(answer).and_then(|(name, body)| {
        let I = tensor_of(body)?;
        scene(answer, name, body, &I)
    });
    let vehicle = drawn(answer);
    let (name, scene) = match ellipsoid {
        Some(mut scene) => {
            scene.title += ", and the vehicle in the same attitude";
            scene.note = format!("{} {}", scene.note, vehicle.note);
            scene.beside = Some(Box::new(vehicle));
            ("poinsot", scene)
        }
        None if answer.estimate.is_withheld() => ("suspected", vehicle),
        None => ("vehicle", vehicle),
    };
    let figure = Figure::scene(name, scene);
    let context = context! { picture => figure.html()?.value(), name };
    let body = TEMPLATES.html("picture.html", context)?;
    Ok(Part::new("motion", "Poinsot's picture", body).with_figures(vec![figure]))
}

/// The whole vehicle if there are several bodies, otherwise the body.
fn chosen(answer: &Answer) -> Option<(&str, &BodyFile)> {
    let first = answer.estimate.bodies.first();
    let whole = answer.whole().map(|body| (super::WHOLE, body));
    whole.or_else(|| first.map(|(name, b)| (name.as_str(), b)))
}

/// The tensor, if all six elements are determined.
fn tensor_of(body: &BodyFile) -> Option<Matrix3> {
    all_known(body.inertia_kg_m2.map(|n| n.value)).map(tensor)
}

/// Sigmas of the six elements, and their covariance if the result file has it.
type Spread = ([f64; 6], Option<[[f64; 6]; 6]>);

fn spread(answer: &Answer, name: &str, body: &BodyFile) -> Option<Spread> {
    let numbers = body.inertia_kg_m2.named();
    let sigmas = all_known(numbers.map(|(_, n)| n.sigma))?;
    let covariance = &answer.estimate.covariance;
    let rows = numbers.map(|(element, _)| format!("{name}.inertia_kg_m2.{element}"));
    let mut six = [[0.0; 6]; 6];
    let mut full = true;
    for (row, one) in six.iter_mut().zip(&rows) {
        for (out, other) in row.iter_mut().zip(&rows) {
            let entry = covariance.between(one, other);
            full &= entry.is_some();
            *out = entry.unwrap_or(0.0);
        }
    }
    Some((sigmas, full.then_some(six)))
}

/// Principal moments with intervals, for the table of numbers; `None` if the tensor is not determined.
pub(super) fn moments(answer: &Answer) -> Option<Value> {
    let (name, body) = chosen(answer)?;
    let I = tensor_of(body)?;
    let (moments, axes) = principal(&I)?;
    let sigmas = spread(answer, name, body).map(|(s, c)| principal_sigmas(&axes, &s, c.as_ref()));
    let row = |k: usize| {
        let axis = axes[k].as_slice();
        context! { moment => moments[k], sigma => sigmas.map(|s| s[k]), axis }
    };
    Some(context! { name, rows => [0, 1, 2].map(row) })
}

fn scene(answer: &Answer, name: &str, body: &BodyFile, I: &Matrix3) -> Option<Scene> {
    let (moments, axes) = principal(I)?;
    // Scaled so that a body with three equal moments of this mean is the unit sphere.
    let size = (moments.iter().sum::<f64>() / 3.0).sqrt();
    let mut scene = Scene {
        title: format!("inertia ellipsoid of {name}"),
        ..Scene::default()
    };
    scene.ellipsoids.push(ellipsoid(
        "inertia ellipsoid",
        inertia_ellipsoid(I, size)?,
        false,
    ));
    scene.note = uncertainty(&mut scene, spread(answer, name, body), I, size);
    for (k, axis) in axes.iter().enumerate() {
        let tip = axis * (size / moments[k].sqrt());
        scene.spots.push(Spot {
            at: tip.into(),
            label: format!("I{}", k + 1),
            colour: 3,
            ..Spot::default()
        });
    }
    scene.arrows = body_axes();
    let motion = answer
        .data
        .segments
        .iter()
        .position(|s| !s.time_s.is_empty());
    if let Some(record) = motion
        && let Some(poles) = Poles::new(&answer.data.segments[record], I, size)
    {
        let words = poles.add_to(&mut scene, record);
        scene.note.push_str(&words);
    }
    Some(scene)
}

fn body_axes() -> Vec<Arrow> {
    let axes = ["x", "y", "z"].into_iter().enumerate();
    axes.map(|(k, label)| Arrow {
        from: [0.0; 3],
        to: Vector3::ith(k, AXIS).into(),
        label: label.to_owned(),
        colour: 6,
        ..Arrow::default()
    })
    .collect()
}

fn ellipsoid(name: &str, axes: [[f64; 3]; 3], faint: bool) -> Ellipsoid {
    Ellipsoid {
        name: name.to_owned(),
        axes,
        colour: if faint { 0 } else { 5 },
        faint,
        ..Ellipsoid::default()
    }
}

/// Adds ellipsoids drawn from the covariance; returns a note if they are thinner than a line.
fn uncertainty(scene: &mut Scene, spread: Option<Spread>, I: &Matrix3, size: f64) -> String {
    let (Some((sigmas, covariance)), Some((moments, axes))) = (spread, principal(I)) else {
        return String::new();
    };
    let along = principal_sigmas(&axes, &sigmas, covariance.as_ref());
    // A semi-axis is proportional to the inverse square root of its moment.
    let share = |k: usize| half_width(Some(along[k])).map_or(0.0, |half| 0.5 * half / moments[k]);
    let widest = (0..3).map(share).fold(0.0, f64::max);
    if widest <= 0.0 {
        return String::new();
    }
    let percent = significant(100.0 * widest, 2);
    if widest < LINE {
        return format!(
            "95 % interval of the semi-axes: {percent} % at most, thinner than a line of this picture. "
        );
    }
    let drawn = covariance.map(|c| drawn_from(I, &c)).unwrap_or_default();
    let drawn = drawn.iter().filter_map(|I| inertia_ellipsoid(I, size));
    let ghosts = drawn.map(|axes| ellipsoid("drawn from the covariance", axes, true));
    scene.ellipsoids.extend(ghosts);
    format!("95 % interval of the semi-axes: {percent} % at most. ")
}

/// Tensors at two sigmas from the estimate along each column of the Cholesky factor of the covariance.
fn drawn_from(I: &Matrix3, covariance: &[[f64; 6]; 6]) -> Vec<Matrix3> {
    let c = nalgebra::Matrix6::from_fn(|i, j| covariance[i][j]);
    let Some(factor) = Cholesky::new(c).map(|c| c.l()) else {
        return Vec::new();
    };
    (0..GHOSTS)
        .map(|k| {
            let sign = if k % 2 == 0 { 2.0 } else { -2.0 };
            let six: [f64; 6] = std::array::from_fn(|i| sign * factor[(i, k)]);
            I + matrix(&six)
        })
        .collect()
}
