//! trial
use faer::prelude::*;
use faer::Mat;
use numpy::{PyArray1, PyReadonlyArray2, PyUntypedArrayMethods, PyArrayMethods};
use pyo3::prelude::*;

#[pyfunction]
fn solve<'py>(py: Python<'py>, a: PyReadonlyArray2<'py, f64>, b: Vec<f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let v = a.as_array();
    let x = py.detach(|| {
        let m = Mat::from_fn(v.nrows(), v.ncols(), |i, j| v[[i, j]]);
        let r = Mat::from_fn(b.len(), 1, |i, _| b[i]);
        m.partial_piv_lu().solve(&r).col_as_slice(0).to_vec()
    });
    let _ = a.shape();
    Ok(PyArray1::from_vec(py, x))
}

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::solve;
}
