//! The 27 nonlinear models, as printed by NIST.

use crate::nist::dual::Dual;
use std::f64::consts::PI;

/// Prediction from parameters and predictors.
pub type Model = fn(&[Dual], &[f64]) -> Dual;

/// Every nonlinear set with its model.
pub const MODELS: [(&str, Model); 27] = [
    ("Misra1a", rising_exponential),
    ("Chwirut2", chwirut),
    ("Chwirut1", chwirut),
    ("Lanczos3", three_exponentials),
    ("Gauss1", two_gaussians),
    ("Gauss2", two_gaussians),
    ("DanWood", danwood),
    ("Misra1b", misra1b),
    ("Kirby2", kirby2),
    ("Hahn1", cubic_over_cubic),
    ("Nelson", nelson),
    ("MGH17", mgh17),
    ("Lanczos1", three_exponentials),
    ("Lanczos2", three_exponentials),
    ("Gauss3", two_gaussians),
    ("Misra1c", misra1c),
    ("Misra1d", misra1d),
    ("Roszman1", roszman1),
    ("ENSO", enso),
    ("MGH09", mgh09),
    ("Thurber", cubic_over_cubic),
    ("BoxBOD", rising_exponential),
    ("Rat42", rat42),
    ("MGH10", mgh10),
    ("Eckerle4", eckerle4),
    ("Rat43", rat43),
    ("Bennett5", bennett5),
];

/// The model Nelson uses the logarithm of the response.
pub fn response(name: &str, y: f64) -> f64 {
    if name == "Nelson" { y.ln() } else { y }
}

fn rising_exponential(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * (1.0 - (-b[1] * x[0]).exp())
}

fn chwirut(b: &[Dual], x: &[f64]) -> Dual {
    (-b[0] * x[0]).exp() / (b[1] + b[2] * x[0])
}

fn three_exponentials(b: &[Dual], x: &[f64]) -> Dual {
    let term = |k: usize| b[k] * (-b[k + 1] * x[0]).exp();
    term(0) + term(2) + term(4)
}

fn two_gaussians(b: &[Dual], x: &[f64]) -> Dual {
    let bump = |k: usize| b[k] * (-((x[0] - b[k + 1]) / b[k + 2]).square()).exp();
    b[0] * (-b[1] * x[0]).exp() + bump(2) + bump(5)
}

fn danwood(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * b[1].exponent_of(x[0])
}

fn misra1b(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * (1.0 - 1.0 / (1.0 + b[1] * x[0] / 2.0).square())
}

fn misra1c(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * (1.0 - (1.0 + 2.0 * b[1] * x[0]).power(-0.5))
}

fn misra1d(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * b[1] * x[0] / (1.0 + b[1] * x[0])
}

fn kirby2(b: &[Dual], x: &[f64]) -> Dual {
    let x = x[0];
    (b[0] + (b[1] + b[2] * x) * x) / (1.0 + (b[3] + b[4] * x) * x)
}

fn cubic_over_cubic(b: &[Dual], x: &[f64]) -> Dual {
    let x = x[0];
    (b[0] + (b[1] + (b[2] + b[3] * x) * x) * x) / (1.0 + (b[4] + (b[5] + b[6] * x) * x) * x)
}

fn nelson(b: &[Dual], x: &[f64]) -> Dual {
    b[0] - b[1] * x[0] * (-b[2] * x[1]).exp()
}

fn mgh17(b: &[Dual], x: &[f64]) -> Dual {
    b[0] + b[1] * (-b[3] * x[0]).exp() + b[2] * (-b[4] * x[0]).exp()
}

fn roszman1(b: &[Dual], x: &[f64]) -> Dual {
    b[0] - b[1] * x[0] - (b[2] / (x[0] - b[3])).atan() / PI
}

fn enso(b: &[Dual], x: &[f64]) -> Dual {
    let x = x[0];
    let year = 2.0 * PI * x / 12.0;
    let cycle = |k: usize| {
        let phase = 2.0 * PI * x / b[k];
        b[k + 1] * phase.cos() + b[k + 2] * phase.sin()
    };
    b[0] + b[1] * year.cos() + b[2] * year.sin() + cycle(3) + cycle(6)
}

fn mgh09(b: &[Dual], x: &[f64]) -> Dual {
    let x = x[0];
    b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3])
}

fn rat42(b: &[Dual], x: &[f64]) -> Dual {
    b[0] / (1.0 + (b[1] - b[2] * x[0]).exp())
}

fn rat43(b: &[Dual], x: &[f64]) -> Dual {
    b[0] / (1.0 + (b[1] - b[2] * x[0]).exp()).to_the(1.0 / b[3])
}

fn mgh10(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * (b[1] / (x[0] + b[2])).exp()
}

fn eckerle4(b: &[Dual], x: &[f64]) -> Dual {
    b[0] / b[1] * (-0.5 * ((x[0] - b[2]) / b[1]).square()).exp()
}

fn bennett5(b: &[Dual], x: &[f64]) -> Dual {
    b[0] * (b[1] + x[0]).to_the(-1.0 / b[2])
}
