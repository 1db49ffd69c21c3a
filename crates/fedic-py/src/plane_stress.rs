//! The law of plane stress, for the regularization by the equilibrium gap.

use fedic::{EquilibriumGap, OptionError};
use numpy::{AllowTypeChange, PyArrayLike1};
use pyo3::prelude::*;

use crate::errors::{IntoPyErr, argument_error};

/// A law of linear elasticity in plane stress; see `fedic.EquilibriumGap`.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct PlaneStress(fedic::PlaneStress);

#[pymethods]
impl PlaneStress {
    /// An isotropic law.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     Unless Poisson's ratio is greater than -1 and at most 0.5.
    #[staticmethod]
    fn isotropic(nu: f64) -> PyResult<Self> {
        checked(fedic::PlaneStress::isotropic(nu))
    }

    /// An orthotropic law whose axis 1 is at an angle, in radians, to ``x``.
    ///
    /// Raises
    /// ------
    /// OptionError
    ///     If a modulus is not positive, ``nu12`` is too large for them, or the angle is not finite.
    #[staticmethod]
    fn orthotropic(e1: f64, e2: f64, nu12: f64, g12: f64, angle: f64) -> PyResult<Self> {
        checked(fedic::PlaneStress::orthotropic(e1, e2, nu12, g12, angle))
    }
}

fn checked(law: Result<fedic::PlaneStress, OptionError>) -> PyResult<PlaneStress> {
    law.map(PlaneStress).map_err(IntoPyErr::into_py_err)
}

/// The settings of an equilibrium gap from a law and the free nodes.
pub(crate) fn equilibrium_gap(object: &Bound<'_, PyAny>) -> PyResult<EquilibriumGap> {
    let refuse = || argument_error("gap must be a law of plane stress and an array of nodes".to_owned());
    let (law, nodes): (Bound<'_, PlaneStress>, Bound<'_, PyAny>) = object.extract().map_err(|_| refuse())?;
    let nodes: PyArrayLike1<'_, i64, AllowTypeChange> = nodes.extract().map_err(|_| refuse())?;
    let nodes = nodes.as_array();
    let free_nodes = nodes.iter().map(|&node| usize::try_from(node)).collect::<Result<_, _>>().map_err(|_| refuse())?;
    Ok(EquilibriumGap { law: law.get().0, free_nodes })
}
