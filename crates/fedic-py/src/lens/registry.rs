//! The list of the lens models in Python: their classes, and `LENSES`.

use fedic::for_each_lens;
use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMappingProxy, PyTuple, PyType};

use super::coefficients::*;
use super::distortion::Distortion;
use super::spline::*;

/// A lens model: its name in camera files, its class and its coefficients.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct LensModel {
    name: &'static str,
    lens: Py<PyType>,
    groups: Py<PyDict>,
}

#[pymethods]
impl LensModel {
    /// Name of the model in camera files and calibrations.
    #[getter]
    fn name(&self) -> &'static str {
        self.name
    }

    /// Class of its lenses.
    #[getter]
    fn lens<'py>(&self, py: Python<'py>) -> Bound<'py, PyType> {
        self.lens.bind(py).clone()
    }

    /// Names of the coefficients by group, as the constructor takes them; empty for a lens made of a field.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.groups.bind(py).copy()
    }

    /// Names of all coefficients, in the order of the groups.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = self.groups.bind(py).values().iter().map(|group| group.extract::<Vec<String>>());
        PyTuple::new(py, names.collect::<PyResult<Vec<_>>>()?.concat())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("LensModel(name={:?}, lens={}, groups={})", self.name, self.lens.bind(py).name()?, self.groups))
    }
}

impl LensModel {
    fn new<L: PyTypeInfo>(py: Python<'_>, summary: &fedic::lens::ModelSummary) -> PyResult<Self> {
        let groups = PyDict::new(py);
        for group in summary.groups {
            groups.set_item(group.name, PyTuple::new(py, group.coefficients)?)?;
        }
        Ok(Self { name: summary.name, lens: py.get_type::<L>().unbind(), groups: groups.unbind() })
    }
}

macro_rules! define_registry {
    ($($variant:ident($lens:ident: $kind:ident)),+ $(,)?) => {
        /// Adds the class of each lens model and the dictionary `LENSES` of the models by name to the module.
        pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
            let py = module.py();
            let (lenses, mut summaries) = (PyDict::new(py), fedic::Distortion::MODELS.iter());
            $(
                module.add_class::<$lens>()?;
                if let Some(summary) = summaries.next() {
                    lenses.set_item(summary.name, LensModel::new::<$lens>(py, summary)?)?;
                }
            )+
            module.add("LENSES", PyMappingProxy::new(py, lenses.as_mapping()))
        }

        /// A lens as an object of the class of its model.
        pub(crate) fn lens_object<'py>(py: Python<'py>, lens: &fedic::Distortion) -> PyResult<Bound<'py, PyAny>> {
            let base = PyClassInitializer::from(Distortion(lens.clone()));
            match lens {
                $(fedic::Distortion::$variant(_) => Ok(Bound::new(py, base.add_subclass($lens))?.into_any()),)+
                _ => Ok(Bound::new(py, base)?.into_any()),
            }
        }
    };
}

for_each_lens!(define_registry);
