# Written by `make generate` from the options declared in crates/fedic/src. Do not edit.
"""Types of the options."""

from typing import TypedDict

from fedic._internal.option_choices import Brightness, Gradient, Hessian, Interpolation, Motion, Robust
from fedic.quadrature import Quadrature

__all__ = ["CorrelationOptions", "SpecimenOptions"]


class CorrelationOptions(TypedDict, total=False):
    """Options of `fedic.correlate` and `fedic.Correlator`."""

    quadrature: Quadrature
    """Quadrature of the integral over the mesh: points in the cells, cut by a rule into equal parts, or the pixels
    whose centre falls in a cell. Default: MeshQuadrature(density=1.0, rule='rotated').
    """
    interpolation: Interpolation
    """Interpolation of both images between pixels. Default: "bspline5"."""
    gradient: Gradient
    """Gradient of the reference image: ``"analytic"``, that of the interpolant, or ``"finite-difference"``, central
    differences at the pixels, then interpolated. Default: "analytic".
    """
    smoothing: float
    """Standard deviation, in pixels, of a Gaussian smoothing of both images; 0 for none. It removes spatial
    frequencies that no interpolation reproduces: with the default the bias of the interpolation is at most 1e-4 px.
    It raises the noise of the displacement by 0 to 7 % where speckles are about five pixels wide, and by 30 % where
    they are one to three. Default: 0.8.
    """
    brightness: Brightness
    """Domain over which the grey levels of the deformed image are matched to those of the reference image:
    ``"global"``, the whole mesh, ``"element"``, each cell, ``"field"``, a gain and an offset that vary over the
    mesh and are smooth over about two cells, or ``None``, no correction. ``"auto"`` is ``"field"`` with robust
    weights and ``"global"`` without. Default: "auto".
    """
    robust: Robust | None
    """Function that weighs the points by their residual, so that damage does not spoil what lies beside it:
    ``"tukey"``, large residuals do not count, or ``"huber"``, they count less. The scale of the residual is that of
    neighbouring cells. Cells without an outlier are not weighed. Cells that lose much of their weight are flagged,
    left out, and the frame is measured again. By default no weights. Default: None.
    """
    hessian: Hessian
    """Time at which the Hessian is computed: ``"initial"``, once, over all points of the reference image, or
    ``"updated"``, at every iteration, over the points inside the deformed image. It does not depend on the
    displacement otherwise. Default: "initial".
    """
    regularization_length: float | None
    """Wavelength, in pixels of the reference image, of the displacements whose amplitude the regularization halves:
    waves of twice the length keep 94 %, of half the length 6 %. It is a penalty on the second derivatives, or on
    the forces of linear elasticity (the argument `regularization`), whose length is that of shear waves. Rigid
    motions of any size and uniform strain are left alone, with free edges too. The length is accurate from five
    cells on; no regularization by default. Default: None.
    """
    tolerance: float
    """The iterations stop when the error that they leave is below this at every node, in pixels. It is estimated from
    the last correction and its ratio to the one before. Default: 0.001.
    """
    noise: float | None
    """Standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing: that of a
    static pair divided by the square root of two. The verdict on the result is relative to it. By default it is
    estimated from the residual of the measurement, in the cells whose images correlate. Default: None.
    """
    max_iterations: int
    """Largest number of iterations on the images at full resolution. Default: 50."""
    num_threads: int | None
    """Number of threads; all processors by default. The result does not depend on it. Default: None."""


class SpecimenOptions(TypedDict, total=False):
    """Options of `fedic.calibrate_on_specimen`."""

    motion: Motion
    """Motions that the specimen may have made: ``"translation"``, along X and Y; ``"in-plane"``, also about Z; or
    ``"spatial"``, any. Default: "in-plane".
    """
    known_translations: bool
    """Whether the given translations are exact. They are then kept, and determine the scale; otherwise they are the
    start. Default: False.
    """
    density: float
    """Quadrature points per pixel of the reference image. Default: 1.0."""
    interpolation: Interpolation
    """Interpolation of the images between pixels. Default: "bspline5"."""
    smoothing: float
    """Standard deviation, in pixels, of a Gaussian smoothing of the images; 0 for none. Default: 0.8."""
    gain_and_offset: bool
    """Whether a gain and an offset of each image are unknown too. Default: True."""
    noise: float | None
    """Standard deviation of the noise of one image as recorded, in grey levels; estimated from the residual by
    default. Default: None.
    """
    tolerance: float
    """The iterations stop when the root mean square of the motion in the images caused by a correction is below this,
    in pixels. Default: 1e-05.
    """
    max_iterations: int
    """Largest number of iterations on the images at full resolution. Default: 50."""
    num_threads: int | None
    """Number of threads; all processors by default. The result does not depend on it. Default: None."""
