//! Methods of the camera classes.

/// Defines the methods of a camera class: those of all cameras and its own.
macro_rules! camera_methods {
    ($type:ident { $($own:item)* }) => {
        #[pymethods]
        impl $type {
            $($own)*

            /// ``(width, height)`` of the images the camera was calibrated on, in pixels; None if it is not known.
            #[getter]
            fn image_size(&self) -> Option<(u32, u32)> {
                fedic::Resizable::image_size(&self.0).map(Into::into)
            }

            /// The camera of a region of the image.
            ///
            /// Parameters
            /// ----------
            /// left, top : int
            ///     Column and row of the first pixel of the region.
            /// width, height : int
            ///     Size of the region, in pixels.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If the region has no pixel, or is not inside an image of `image_size`.
            fn cropped(
                &self,
                left: &Bound<'_, PyAny>,
                top: &Bound<'_, PyAny>,
                width: &Bound<'_, PyAny>,
                height: &Bound<'_, PyAny>,
            ) -> PyResult<Self> {
                $crate::camera::resizing::cropped(&self.0, [left, top, width, height]).map(Self)
            }

            /// The camera of images of which ``n`` by ``n`` pixels are made one.
            ///
            /// Pixel centres are at integers: ``u`` becomes ``(u + 0.5) / n - 0.5``.
            ///
            /// Parameters
            /// ----------
            /// n : int
            ///     Pixels along a side, 1 or more. Pixels that fill no square are left out at the right and at the bottom.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If `n` is zero, or larger than the image.
            fn binned(&self, n: &Bound<'_, PyAny>) -> PyResult<Self> {
                $crate::camera::resizing::binned(&self.0, n).map(Self)
            }

            /// Image points of world points.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points; ``Z = 0`` if there are two coordinates.
            ///
            /// Returns
            /// -------
            /// (n, 2) float64
            ///     ``(u, v)`` in pixels; NaN if the camera cannot see the point.
            fn project<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
                $crate::camera::projection::project(py, &self.0, points)
            }

            /// Derivatives of the image points with respect to the world points.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points.
            ///
            /// Returns
            /// -------
            /// (n, 2, 3) float64
            ///     ``[i, 0] = du/d(X, Y, Z)``, ``[i, 1] = dv/d(X, Y, Z)`` in pixels per world unit.
            fn jacobian<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, numpy::PyArray3<f64>>> {
                $crate::camera::projection::jacobian(py, &self.0, points)
            }

            /// Test if world points lie in the domain in which the lens is calibrated, which is limited for spline lenses only.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points.
            ///
            /// Returns
            /// -------
            /// (n,) bool
            ///     False where a projection is an extrapolation.
            fn covers<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, numpy::PyArray1<bool>>> {
                $crate::camera::projection::covers(py, &self.0, points)
            }

            /// World points of the plane ``Z = z`` seen at image points, by Newton's method (paper, Sect. 5.2).
            ///
            /// Parameters
            /// ----------
            /// pixels : (n, 2) array_like
            ///     ``(u, v)`` in pixels.
            /// z : float
            ///     The plane.
            ///
            /// Returns
            /// -------
            /// (n, 3) float64
            ///     World points.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If a pixel sees no point of the plane.
            #[pyo3(signature = (pixels, z=0.0))]
            fn unproject<'py>(&self, py: Python<'py>, pixels: &Bound<'py, PyAny>, z: f64) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
                $crate::camera::projection::unproject(py, &self.0, pixels, z)
            }
        }
    };
}

/// Defines the methods of the class of a camera with parameters.
macro_rules! parametric_camera_methods {
    ($type:ident { $($own:item)* }) => {
        camera_methods!($type {
            $($own)*

            /// Names of the parameters.
            #[getter]
            fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyTuple>> {
                $crate::camera::parameters::names(py, &self.0)
            }

            /// Derivatives of the image points with respect to parameters of the camera.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points; ``Z = 0`` if there are two coordinates.
            /// parameters : sequence of str
            ///     Names of parameters, any of `parameters`.
            ///
            /// Returns
            /// -------
            /// (n, 2, p) float64
            ///     ``[i, 0] = du/dp``, ``[i, 1] = dv/dp`` in pixels per unit of the parameter, for the steps of `perturbed`; NaN
            ///     if the camera cannot see the point.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If the camera does not have one of the parameters.
            fn parameter_jacobian<'py>(
                &self,
                py: Python<'py>,
                points: &Bound<'py, PyAny>,
                parameters: Vec<String>,
            ) -> PyResult<Bound<'py, numpy::PyArray3<f64>>> {
                $crate::camera::parameters::jacobian(py, &self.0, points, &parameters)
            }

            /// The camera with a step added to each of some parameters.
            ///
            /// Rotations ``rx``, ``ry``, ``rz`` multiply from the left, ``R -> exp(d) R``.
            ///
            /// Parameters
            /// ----------
            /// steps : mapping of str to float
            ///     Step of each parameter, by its name.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If the camera does not have one of the parameters, or the result is not a valid camera.
            fn perturbed(&self, steps: std::collections::HashMap<String, f64>) -> PyResult<Self> {
                $crate::camera::parameters::perturbed(&self.0, steps).map(Self)
            }
        });
    };
}

pub(super) use camera_methods;
pub(super) use parametric_camera_methods;
