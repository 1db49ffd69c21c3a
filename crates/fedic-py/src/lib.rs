//! The extension module `fedic._core`: checks and borrows NumPy arrays, releases the interpreter lock, converts errors.

mod arrays;
mod camera;
mod cell_type;
mod connectivity;
mod correlator;
mod covariance;
mod errors;
mod image;
mod lens;
mod mesh;
mod mesh_set;
mod options;
mod plane_stress;
mod rectangle;
mod self_calibration;
mod strains;
mod synthetic;
mod worker;

use pyo3::prelude::*;

/// The compiled core of fedic.
#[pymodule]
mod _core {
    use pyo3::prelude::*;
    use pyo3::types::PyTuple;

    #[pymodule_export]
    use crate::camera::{FrontParallel, ImageFrame, Pinhole};
    #[pymodule_export]
    use crate::cell_type::CellType;
    #[pymodule_export]
    use crate::correlator::{Correlator, Solution};
    #[pymodule_export]
    use crate::covariance::Covariance;
    #[pymodule_export]
    use crate::image::{full_scale, interpolate_image};
    #[pymodule_export]
    use crate::lens::{Distortion, LensModel, spline_basis};
    #[pymodule_export]
    use crate::mesh::Mesh;
    #[pymodule_export]
    use crate::mesh_set::MeshSet;
    #[pymodule_export]
    use crate::options::{PyOptionInfo, check_correlation_options};
    #[pymodule_export]
    use crate::plane_stress::PlaneStress;
    #[pymodule_export]
    use crate::rectangle::rectangle_mesh;
    #[pymodule_export]
    use crate::self_calibration::{SelfCalibration, calibrate_on_specimen};
    #[pymodule_export]
    use crate::synthetic::{Speckle, render_plane};
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::cell_type::add_cell_types(module)?;
        module.add("INTERPOLATIONS", PyTuple::new(module.py(), fedic::Interpolation::NAMES)?)?;
        module.add("STRAIN_MEASURES", PyTuple::new(module.py(), fedic::StrainMeasure::NAMES)?)?;
        crate::lens::register(module)?;
        crate::correlator::add_quality_constants(module)?;
        crate::options::add_tables(module)
    }
}
