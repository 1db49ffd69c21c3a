//! Parameters of cameras: names, Jacobians, steps.

use std::collections::HashMap;

use fedic::{Parameter, Parametric};
use numpy::{PyArray, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays;
use crate::errors::{IntoPyErr, argument_error};

/// Names of the parameters of a camera.
pub(super) fn names<'py>(py: Python<'py>, camera: &impl Parametric) -> PyResult<Bound<'py, PyTuple>> {
    let names: Vec<&str> = camera.parameters().into_iter().map(Parameter::name).collect();
    PyTuple::new(py, names)
}

/// Derivatives of image points with respect to parameters, (n, 2, p).
pub(super) fn jacobian<'py>(
    py: Python<'py>,
    camera: &impl Parametric,
    points: &Bound<'py, PyAny>,
    names: &[String],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    let parameters = names.iter().map(|name| parse(camera, name)).collect::<PyResult<Vec<_>>>()?;
    let count = parameters.len();
    let entries = py.detach(|| {
        let (mut columns, mut entries) = (vec![[0.0; 2]; count], vec![0.0; 2 * points.len() * count]);
        for (point, rows) in points.iter().zip(entries.chunks_exact_mut((2 * count).max(1))) {
            camera.parameter_jacobian(*point, &parameters, &mut columns);
            let (u, v) = rows.split_at_mut(count);
            u.iter_mut().zip(v).zip(&columns).for_each(|((u, v), column)| [*u, *v] = *column);
        }
        entries
    });
    PyArray::from_vec(py, entries).reshape([points.len(), 2, count])
}

/// The camera with a step added to each of some parameters.
pub(super) fn perturbed<C: Parametric>(camera: &C, steps: HashMap<String, f64>) -> PyResult<C> {
    let steps = steps.into_iter().map(|(name, step)| Ok((parse(camera, &name)?, step)));
    camera.perturbed(steps.collect::<PyResult<Vec<_>>>()?).map_err(IntoPyErr::into_py_err)
}

/// A parameter of a camera, by its name.
fn parse(camera: &impl Parametric, name: &str) -> PyResult<Parameter> {
    let parameter: Parameter = name.parse().map_err(IntoPyErr::into_py_err)?;
    camera.check_parameters(&[parameter]).map_err(IntoPyErr::into_py_err)?;
    Ok(parameter)
}
