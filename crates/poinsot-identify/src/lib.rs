//! Estimators, identifiability and information.
//!
//! `LinearProblem` -> [`linear`] -> [`Estimate`]. A question that cannot be asked is an error; what the
//! data leave open is part of the answer.
#![allow(non_snake_case)]

mod answer;
mod answer_body;
mod answer_momentum;
mod block_qr;
mod combination;
mod estimate;
mod impulse;
mod linear;
pub mod methods;
mod parameters;
mod quantity;
mod residual;
mod rows;
mod segment;
mod spectrum;
mod words;

pub use block_qr::{BlockQr, Triangle};
pub use combination::{Combination, Combinations, split};
pub use estimate::{
    BodyEstimate, DeterminedCombination, Estimate, Identifiability, MomentumEstimate, NamedNumber,
    Number, OpenCombination, Principal, SegmentFit, Source, Status,
};
pub use linear::{LinearError, LinearProblem, linear};
pub use parameters::{
    Equations, Parameters, ParametersError, TENSOR, Unknown, UnknownKind, axis_name, tensor_name,
};
pub use segment::{Firing, Noise, Samples, Segment, Translation};
pub use spectrum::{NotFinite, Spectrum};
