//! Dictionaries of Python to TOML, for the model file as data.

use crate::fault::Fault;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use toml::Value;

/// Deepest nesting that is read; a model file has five levels.
const DEEPEST: usize = 32;

/// A value of Python as TOML: dictionaries, sequences, arrays, text, numbers and flags. `None` entries are left out.
///
/// # Errors
/// A value of another type; the message names its key.
pub fn to_toml(value: &Bound<'_, PyAny>, key: &str, depth: usize) -> PyResult<Value> {
    if depth > DEEPEST {
        let what = "nested too deep";
        return Err(refused(key, what, "give plain dictionaries and lists"));
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(number) = value.cast::<PyInt>() {
        let number = number.extract::<i64>();
        return number
            .map(Value::Integer)
            .map_err(|_| refused(key, "an integer beyond 64 bits", "give a float"));
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(Value::Float(number.value()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        return table_of(table, key, depth);
    }
    // Arrays and numbers of NumPy.
    if value.hasattr("tolist")? {
        return to_toml(&value.call_method0("tolist")?, key, depth + 1);
    }
    if value.hasattr("__fspath__")? {
        return to_toml(&value.call_method0("__fspath__")?, key, depth + 1);
    }
    let Ok(items) = value.try_iter() else {
        let kind = value.get_type().name()?.to_string();
        let what = format!("a value of type {kind}");
        let remedy = "give a number, text, list or dictionary";
        return Err(refused(key, &what, remedy));
    };
    let mut list = Vec::new();
    for (k, item) in items.enumerate() {
        list.push(to_toml(&item?, &format!("{key}[{k}]"), depth + 1)?);
    }
    Ok(Value::Array(list))
}

fn table_of(table: &Bound<'_, PyDict>, key: &str, depth: usize) -> PyResult<Value> {
    let mut out = toml::Table::new();
    for (name, item) in table.iter() {
        let Ok(name) = name.extract::<String>() else {
            let what = "a key that is no text";
            return Err(refused(key, what, "name every entry by text"));
        };
        if item.is_none() {
            continue;
        }
        let within = match key {
            "" => name.clone(),
            key => format!("{key}.{name}"),
        };
        out.insert(name, to_toml(&item, &within, depth + 1)?);
    }
    Ok(Value::Table(out))
}

fn refused(key: &str, what: &str, remedy: &str) -> PyErr {
    Fault::argument("model", key, what, remedy).into()
}
