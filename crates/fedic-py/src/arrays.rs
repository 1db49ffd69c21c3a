//! NumPy arrays in and out, with errors that say which array, its shape and what was expected.

use numpy::{
    AllowTypeChange, PyArray, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

/// Longest value that an error message shows, in characters.
const LONGEST_VALUE: usize = 60;

/// Makes the exception of a module out of a sentence.
pub(crate) type Raise = fn(String) -> PyErr;

/// Rows of `D` numbers each, read from anything NumPy can make a float64 array of.
pub(crate) fn rows<const D: usize>(object: &Bound<'_, PyAny>, name: &str, raise: Raise) -> PyResult<Vec<[f64; D]>> {
    let array = matrix(object, name, raise)?;
    let view = array.as_array();
    if view.ncols() != D {
        return Err(raise(format!("{name} must have shape (n, {D}), got {:?}", view.shape())));
    }
    Ok(view.rows().into_iter().map(|row| std::array::from_fn(|c| row[c])).collect())
}

/// Points of the physical space: rows of 2 or 3 coordinates, the third zero where there are 2, and how many were given.
pub(crate) fn points(object: &Bound<'_, PyAny>, name: &str, raise: Raise) -> PyResult<(Vec<[f64; 3]>, usize)> {
    let array = coordinates(object, name, raise)?;
    let view = array.as_array();
    let dimension = view.ncols();
    let third = |row: &numpy::ndarray::ArrayView1<'_, f64>| if dimension == 3 { row[2] } else { 0.0 };
    Ok((view.rows().into_iter().map(|row| [row[0], row[1], third(&row)]).collect(), dimension))
}

/// The first two coordinates of points of the physical space.
pub(crate) fn plane_points(object: &Bound<'_, PyAny>, name: &str, raise: Raise) -> PyResult<Vec<[f64; 2]>> {
    let array = coordinates(object, name, raise)?;
    let view = array.as_array();
    Ok(match view.as_slice() {
        Some(numbers) if view.ncols() == 2 => numbers.as_chunks().0.to_vec(),
        _ => view.rows().into_iter().map(|row| [row[0], row[1]]).collect(),
    })
}

/// Points of the physical space: rows of 2 or 3 coordinates.
fn coordinates<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
    raise: Raise,
) -> PyResult<PyArrayLike2<'py, f64, AllowTypeChange>> {
    let array = matrix(object, name, raise)?;
    match array.as_array().shape() {
        [_, 2 | 3] => Ok(array),
        shape => Err(raise(format!("{name} must have shape (n, 2) or (n, 3), got {shape:?}"))),
    }
}

/// A vector of 2 or 3 components; the third is zero if there are 2.
pub(crate) fn vector(object: &Bound<'_, PyAny>, name: &str, raise: Raise) -> PyResult<[f64; 3]> {
    let refuse = || raise(format!("{name} must have shape (2,) or (3,), got {}", describe(object)));
    match numbers(object).as_deref() {
        Some(&[x, y]) => Ok([x, y, 0.0]),
        Some(&[x, y, z]) => Ok([x, y, z]),
        _ => Err(refuse()),
    }
}

/// A 1-dimensional array of float64; `None` if it is anything else.
pub(crate) fn numbers(object: &Bound<'_, PyAny>) -> Option<Vec<f64>> {
    let array: PyArrayLike1<'_, f64, AllowTypeChange> = object.extract().ok()?;
    Some(array.as_array().to_vec())
}

/// A 1-dimensional array of integers; numbers that are no integers are refused.
pub(crate) fn integers(object: &Bound<'_, PyAny>, name: &str, raise: Raise) -> PyResult<Vec<i64>> {
    match numbers(object) {
        Some(numbers) if numbers.iter().all(|x| x.fract() == 0.0) => Ok(numbers.iter().map(|&x| x as i64).collect()),
        _ => Err(raise(format!("{name} must be a 1-dimensional array of integers, got {}", describe(object)))),
    }
}

/// A 2-dimensional array of float64.
pub(crate) fn matrix<'py>(
    object: &Bound<'py, PyAny>,
    name: &str,
    raise: Raise,
) -> PyResult<PyArrayLike2<'py, f64, AllowTypeChange>> {
    object
        .extract()
        .map_err(|_| raise(format!("{name} must be a 2-dimensional array of real numbers, got {}", describe(object))))
}

/// A 2-dimensional array of indices, by rows, and its width; numbers that are no integers are refused.
pub(crate) fn indices(object: &Bound<'_, PyAny>, name: &str, raise: Raise) -> PyResult<(Vec<i64>, usize)> {
    let refuse = || raise(format!("{name} must be a 2-dimensional array of integers, got {}", describe(object)));
    let array: PyArrayLike2<'_, f64, AllowTypeChange> = object.extract().map_err(|_| refuse())?;
    let view = array.as_array();
    if view.iter().any(|x| x.fract() != 0.0 || x.is_nan()) {
        return Err(refuse());
    }
    Ok((view.iter().map(|&x| x as i64).collect(), view.ncols()))
}

/// What an object is, in the words of an error message.
pub(crate) fn describe(object: &Bound<'_, PyAny>) -> String {
    match object.cast::<PyUntypedArray>() {
        Ok(array) => format!("an array of shape {:?} and dtype {}", array.shape(), array.dtype()),
        Err(_) => object.get_type().name().map_or_else(|_| "another object".to_owned(), |name| name.to_string()),
    }
}

/// An object as Python writes it, shortened.
pub(crate) fn representation(object: &Bound<'_, PyAny>) -> String {
    let text = object.repr().map_or_else(|_| "an object without representation".to_owned(), |text| text.to_string());
    if text.chars().count() <= LONGEST_VALUE {
        return text;
    }
    text.chars().take(LONGEST_VALUE - 3).chain("...".chars()).collect()
}

/// Rows as a new `(n, D)` array.
pub(crate) fn to_array<'py, T: numpy::Element + Copy, const D: usize>(
    py: Python<'py>,
    rows: &[[T; D]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray::from_slice(py, rows.as_flattened()).reshape([rows.len(), D])
}
