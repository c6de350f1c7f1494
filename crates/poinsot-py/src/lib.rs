//! The Python module `poinsot._core`: the verbs of `poinsot` with numbers as arrays and documents as JSON. Names, units
//! and shapes that a user sees are those of the Python package in `python/poinsot`.
#![allow(non_snake_case)]

mod answer;
mod arrays;
mod campaigns;
mod command;
mod dynamics;
mod fault;
mod filter;
mod model;
mod printed;
mod problem;
mod record;
mod run;
mod searches;
mod value;
mod verbs;

use pyo3::pymodule;

/// The compiled part of `poinsot`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::answer::{CoreAnswer, identify};
    #[pymodule_export]
    use crate::campaigns::CorePlan;
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::dynamics::{
        forward_dynamics, integrate, jacobian, mass_matrix, momentum, momentum_regressor,
    };
    #[pymodule_export]
    use crate::filter::CoreFilter;
    #[pymodule_export]
    use crate::model::CoreModel;
    #[pymodule_export]
    use crate::problem::CoreProblem;
    #[pymodule_export]
    use crate::record::CoreRecord;
    #[pymodule_export]
    use crate::run::after_fork;
    #[pymodule_export]
    use crate::searches::{design, study};
    #[pymodule_export]
    use crate::verbs::{
        compare, error_codes, explain, inspect, methods, predict, simulate, units, validate,
        version,
    };
}
