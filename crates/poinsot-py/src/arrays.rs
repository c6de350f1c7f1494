//! Arrays of NumPy as plain numbers, and what is wrong with those that cannot be.

use crate::fault::Fault;
use numpy::{PyReadonlyArray1, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use poinsot_telemetry::Values;
use pyo3::prelude::*;

/// One column of telemetry; the Python package has made it one-dimensional and of one of two types.
///
/// # Errors
/// It is neither.
pub fn column(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Values> {
    if let Ok(numbers) = array.extract::<PyReadonlyArray1<'_, f64>>() {
        return Ok(Values::Numbers(numbers.as_array().to_vec()));
    }
    if let Ok(times) = array.extract::<PyReadonlyArray1<'_, i64>>() {
        return Ok(Values::Nanoseconds(times.as_array().to_vec()));
    }
    let why = "is no array of one dimension and type float64";
    Err(Fault::argument("column", name, why, "give one number per time").into())
}

/// The numbers of a C-contiguous array whose last axis has `width` entries.
///
/// # Errors
/// It has another width, or is not contiguous.
pub fn rows<'a>(
    what: &'static str,
    array: &'a PyReadonlyArrayDyn<'_, f64>,
    width: usize,
) -> Result<&'a [f64], Fault> {
    let found = array.shape().last().copied().unwrap_or(1);
    if found != width {
        let value = format!("{:?}", array.shape());
        let problem = format!("its last axis has {found} entries, expected {width}");
        return Err(Fault::argument(what, value, problem, "give one for each"));
    }
    array.as_slice().map_err(|_| {
        let shape = format!("{:?}", array.shape());
        let problem = "it is not C-contiguous";
        Fault::argument(what, shape, problem, "use np.ascontiguousarray")
    })
}
