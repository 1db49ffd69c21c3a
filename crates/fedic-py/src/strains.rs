//! Strains of a displacement field: arguments in, a `fedic.Strains` out.

use fedic::{Mesh, StrainAxes, StrainField, StrainMeasure, SurfaceStrain, UnknownStrainMeasure};
use numpy::{PyArray, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::arrays::{self, describe, to_array};
use crate::errors::{argument_error, option_error};

/// Places at which strains are evaluated.
pub(crate) enum Places {
    Cells,
    Nodes,
    Points(Vec<[f64; 3]>),
}

/// The arguments of `Mesh.strains` apart from the displacement.
pub(crate) struct StrainQuery {
    pub(crate) measure: StrainMeasure,
    pub(crate) places: Places,
    pub(crate) axes: StrainAxes,
    pub(crate) valid_cells: Option<Vec<bool>>,
}

impl StrainQuery {
    /// Strains of a displacement of the nodes.
    pub(crate) fn strains<const D: usize>(&self, mesh: &Mesh, displacement: &[[f64; D]]) -> Vec<SurfaceStrain> {
        let mut field = StrainField::new(mesh, displacement, self.measure);
        if let Some(valid) = &self.valid_cells {
            field = field.with_valid_cells(valid);
        }
        let found = match &self.places {
            Places::Cells => field.at_cells(),
            Places::Nodes => field.at_nodes(),
            Places::Points(points) => {
                let plane: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
                let found = field.at_points(&plane).into_iter().zip(points).map(|(strain, &point)| match strain {
                    // The point as given, on a surface in space at its height.
                    Some(strain) => SurfaceStrain { position: [point[0], point[1], strain.position[2]], ..strain },
                    None => SurfaceStrain { position: point, axes: [[f64::NAN; 3]; 2], components: [f64::NAN; 3] },
                });
                found.collect()
            }
        };
        found.into_iter().map(|strain| strain.along(self.axes)).collect()
    }
}

/// The measure of a name.
pub(crate) fn measure(name: &str) -> PyResult<StrainMeasure> {
    name.parse().map_err(|error: UnknownStrainMeasure| option_error(error.to_string(), "measure"))
}

/// The places of the argument `at`.
pub(crate) fn places(at: Option<&Bound<'_, PyAny>>) -> PyResult<Places> {
    let Some(at) = at else { return Ok(Places::Cells) };
    match at.extract::<String>().as_deref() {
        Ok("cells") => Ok(Places::Cells),
        Ok("nodes") => Ok(Places::Nodes),
        Ok(other) => Err(argument_error(format!(
            "at must be \"cells\", \"nodes\" or an array of points of shape (m, 2) or (m, 3), got \"{other}\""
        ))),
        Err(_) => Ok(Places::Points(arrays::points(at, "at", argument_error)?.0)),
    }
}

/// The axes of the arguments `axes` and `centre`.
pub(crate) fn axes(axes: Option<&Bound<'_, PyAny>>, centre: Option<&Bound<'_, PyAny>>) -> PyResult<StrainAxes> {
    let is_cylindrical = axes.is_some_and(|axes| axes.extract::<String>().is_ok_and(|name| name == "cylindrical"));
    match (axes, centre) {
        (Some(_), None) if is_cylindrical => Ok(StrainAxes::Cylindrical { centre: [0.0; 2] }),
        (Some(_), Some(centre)) if is_cylindrical => match arrays::numbers(centre).as_deref() {
            Some(&[x, y]) if x.is_finite() && y.is_finite() => Ok(StrainAxes::Cylindrical { centre: [x, y] }),
            _ => Err(argument_error(format!("centre must be two finite numbers, got {}", describe(centre)))),
        },
        (_, Some(_)) => Err(argument_error("centre needs axes=\"cylindrical\"".to_owned())),
        (None, None) => Ok(StrainAxes::Local),
        (Some(axes), None) => match axes.extract::<f64>() {
            Ok(angle) if angle.is_finite() => Ok(StrainAxes::Turned(angle)),
            _ => {
                let expected = "a finite angle in radians, \"cylindrical\" or None";
                Err(argument_error(format!("axes must be {expected}, got {}", axes.repr()?)))
            }
        },
    }
}

/// One flag per cell.
pub(crate) fn cell_flags(object: &Bound<'_, PyAny>, mesh: &Mesh) -> PyResult<Vec<bool>> {
    let flags: Option<Vec<bool>> =
        object.extract::<PyReadonlyArray1<'_, bool>>().ok().map(|array| array.as_array().to_vec());
    let expected = mesh.num_cells();
    flags.filter(|flags| flags.len() == expected).ok_or_else(|| {
        let found = describe(object);
        argument_error(format!(
            "valid_cells must be an array of {expected} bool, one per cell of the mesh, got {found}"
        ))
    })
}

/// A `fedic.Strains`, with positions and axes of as many coordinates as the points of the mesh.
pub(crate) fn to_python<'py>(
    py: Python<'py>,
    measure: StrainMeasure,
    strains: &[SurfaceStrain],
    dimension: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let components: Vec<[f64; 3]> = strains.iter().map(|strain| strain.components).collect();
    let positions = coordinates(py, strains.iter().map(|strain| strain.position), dimension)?;
    let axes = coordinates(py, strains.iter().flat_map(|strain| strain.axes), dimension)?;
    let axes = axes.reshape([strains.len(), 2, dimension])?;
    let arguments = (measure.name(), to_array(py, &components)?, positions, axes);
    py.import("fedic.results.strains")?.getattr("Strains")?.call1(arguments)
}

fn coordinates<'py>(
    py: Python<'py>,
    vectors: impl Iterator<Item = [f64; 3]>,
    dimension: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let vectors: Vec<[f64; 3]> = vectors.collect();
    let numbers: Vec<f64> = vectors.iter().flat_map(|vector| &vector[..dimension]).copied().collect();
    PyArray::from_vec(py, numbers).reshape([vectors.len(), dimension])
}
