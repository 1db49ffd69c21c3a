"""The camera from the specimen itself: its parameters from images of it moved as a rigid body."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fedic import _core
from fedic._core import SPECIMEN_OPTIONS, Mesh, Pinhole
from fedic._internal.determinacy import correlated_pairs, insignificant
from fedic._internal.types import Camera, Floats, Image
from fedic.cameras.image_size import check_image_size
from fedic.errors import ImageError, OptionError
from fedic.io.images import as_image
from fedic.options import core_options, with_options
from fedic.progress import ProgressCallback, core_callback
from fedic.results import Iteration
from fedic.starts.fft import rigid_translation

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from fedic.options import SpecimenOptions

__all__ = ["SpecimenCalibration", "calibrate_on_specimen"]

_LARGEST_CORRELATION = 0.98
"""Correlation from which on two parameters are reported: few images determine them less well than views of a target."""
_LARGEST_DISPLACEMENT = 0.01
"""Displacement of a point by a standard deviation of a parameter, in image diagonals, from which advice is given."""
_SMALL_MOTION = 0.1
"""Largest motion, relative to the shorter side of the image, below which advice is given."""
_ONE_LINE = 0.1
"""Extent of the motions across their main direction, relative to that along it, below which advice is given."""


@dataclass(frozen=True, eq=False)
class SpecimenCalibration:
    """A camera calibrated on the specimen.

    Attributes
    ----------
    camera : Pinhole
        The camera.
    parameters : tuple of str
        Estimated parameters, in the order of `covariance`.
    covariance : ndarray of float64, shape (p, p)
        Covariance of the parameters; rotations in radians about the camera's axes.
    motions : ndarray of float64, shape (n, 6)
        Rigid motion of the specimen in each image: translation along ``X, Y, Z`` in the mesh's unit, and rotation
        vector in radians about the centre of the mesh (the mean of its nodes).
    motion_standard_deviations : ndarray of float64, shape (n, 6)
        Standard deviations of the motions; 0 for components that were held.
    history : list of Iteration
        Every iteration, coarsest level first; the corrections are root mean square displacements in the images.
    converged : bool
        True if the last correction was within the tolerance.
    residual_rms : float
        Root mean square difference between the grey levels of an image, as filtered, and the texture of all images.
    noise : float
        Standard deviation of the noise of an image as recorded, in grey levels, on which the covariance is based.
    num_points : int
        Number of quadrature points.
    advice : list of str
        Sentences on how to improve the calibration; empty if it is good.
    """

    camera: Pinhole
    parameters: tuple[str, ...]
    covariance: Floats
    motions: Floats
    motion_standard_deviations: Floats
    history: list[Iteration]
    converged: bool
    residual_rms: float
    noise: float
    num_points: int
    advice: list[str] = field(default_factory=list)

    @property
    def standard_deviations(self) -> dict[str, float]:
        """Standard deviation of each parameter, by its name."""
        deviations = np.sqrt(np.diag(self.covariance))
        return {name: float(deviation) for name, deviation in zip(self.parameters, deviations, strict=True)}


@with_options(SPECIMEN_OPTIONS)
def calibrate_on_specimen(
    reference: Image,
    images: Sequence[Image],
    mesh: Mesh,
    camera: Pinhole,
    parameters: Sequence[str] = ("k1", "cx", "cy"),
    *,
    translations: ArrayLike | None = None,
    progress: ProgressCallback | None = None,
    **options: "Unpack[SpecimenOptions]",
) -> SpecimenCalibration:
    """Calibrate a camera from rigid motions of the flat specimen, without a target.

    All images show one texture, seen through the camera after the motions. That determines the lens and the tilt of
    the camera, but neither the scale (``fx``, ``fy`` and ``tz`` together, unless the translations are known) nor the
    position of the specimen in its plane (``tx``, ``ty``, ``rz``). Motions by a third of the field of view in at least
    two directions are best; three images are enough.

    Parameters
    ----------
    reference : ndarray of uint8, uint16 or float32, shape (height, width)
        Image of the specimen in the position of the mesh.
    images : sequence of ndarray, each of shape (height, width)
        Images of the specimen moved, not deformed.
    mesh : Mesh
        Plane mesh of the part of the specimen to use, as large as possible. It may extend beyond the image, and its
        cells may be large.
    camera : Pinhole
        Start; parameters that are not estimated, and the rest of the pose, are kept.
    parameters : sequence of str
        Parameters to estimate: coefficients of the lens (those of `BrownDistortion` if the camera has no lens), ``cx,
        cy, fx, fy`` (pixels), ``rx, ry, rz`` (rotation about the camera's axes, relative to the start) and ``tx, ty,
        tz`` (translation).
    translations : array_like of shape (n, 2), optional
        Translation of the specimen along ``X`` and ``Y`` in each image, in the mesh's unit, to a few pixels; by default
        found by cross-correlation.
    progress : callable, optional
        See `Correlator.correlate`.
    {options}

    Returns
    -------
    SpecimenCalibration
        The camera, its uncertainty, and the history of the iterations.

    Raises
    ------
    ImageError
        If there is no image, or one cannot be used or is not of the size of the reference.
    CameraError
        If the camera is that of images of another size.
    OptionError
        If the camera is not a `Pinhole`, a parameter is unknown, or an option has the wrong type or lies outside its
        range.
    SolveError
        If the specimen does not move, an image does not match, or the images do not determine a parameter, which the
        message names.

    Notes
    -----
    The parameters, the motions ``T_j``, gains ``a_j``, offsets ``b_j`` and the texture ``m`` minimise

        sum over j and X of [ a_j g_j(P(T_j X)) + b_j - m(X) ]^2

    where the reference image is one of the ``g_j``. For white noise of equal standard deviation in all images,
    estimated from the residual, the covariance is ``noise^2 A^-1 B A^-1`` with the normal matrix ``A`` and the
    covariance ``noise^2 B`` of the right-hand side (see `Correlator.standard_deviations`). It includes noise, not model
    errors such as a specimen that is not flat or that deforms.

    Pixels closer to the border than 5 px plus 4 times the smoothing are not used.
    """
    reference = as_image(reference, "reference")
    moved = _checked_images(reference, images)
    arguments = core_options(options, SPECIMEN_OPTIONS, ("translations", "progress"))
    if not isinstance(mesh, Mesh):
        raise OptionError(f"mesh must be a fedic.Mesh, got a {type(mesh).__name__}.", "mesh")
    names = _checked_names(camera, parameters)
    check_image_size(camera, reference.shape, "reference")
    known = bool(options.get("known_translations", False))
    start = _start(reference, moved, mesh, camera, translations, known)
    found = _core.calibrate_on_specimen(
        [reference, *moved], mesh, camera, list(names), start, progress=core_callback(progress), **arguments
    )
    height, width = reference.shape
    return SpecimenCalibration(
        camera=found.camera.cropped(0, 0, width, height),
        parameters=names,
        covariance=found.covariance,
        motions=found.motions,
        motion_standard_deviations=found.motion_standard_deviations,
        history=[Iteration(*entry) for entry in found.history],
        converged=found.converged,
        residual_rms=found.residual_rms,
        noise=found.noise,
        num_points=found.num_points,
        advice=_advice(found, names, mesh, (width, height)),
    )


def _checked_images(reference: Image, images: Sequence[Image]) -> list[Image]:
    if isinstance(images, np.ndarray) and images.ndim == 2:
        raise OptionError("images is a single image; give a list of images.", "images")
    checked = [as_image(image, f"moved (images[{index}])") for index, image in enumerate(images)]
    if not checked:
        raise OptionError("images is empty; give at least one image of the specimen moved.", "images")
    for index, image in enumerate(checked):
        if image.shape != reference.shape:
            raise ImageError(
                f"images[{index}] has shape {image.shape} and the reference {reference.shape}; "
                "all must come from the same sensor area."
            )
    return checked


def _checked_names(camera: Camera, parameters: Sequence[str]) -> tuple[str, ...]:
    if not isinstance(camera, Pinhole):
        raise OptionError(
            f"camera: a {type(camera).__name__} has no parameters to estimate; give a Pinhole with the focal "
            "length and distance of the set-up.",
            "camera",
        )
    if isinstance(parameters, str):
        raise OptionError(f'parameters is {parameters!r}; give a sequence such as ("k1",).', "parameters")
    return tuple(str(name) for name in parameters)


def _start(
    reference: Image,
    moved: list[Image],
    mesh: Mesh,
    camera: Pinhole,
    translations: ArrayLike | None,
    known: bool,
) -> Floats:
    if translations is None:
        if known:
            raise OptionError("known_translations needs the translations.", "known_translations")
        return np.array([rigid_translation(reference, image, mesh, camera) for image in moved])
    try:
        start = np.array(translations, dtype=np.float64)
    except (TypeError, ValueError):
        start = np.empty(0)
    if start.shape != (len(moved), 2) or not np.isfinite(start).all():
        raise OptionError(
            f"translations must hold a finite pair (X, Y) for each of the {len(moved)} images, "
            f"shape ({len(moved)}, 2); got shape {start.shape}.",
            "translations",
        )
    return start


def _advice(found: _core.SelfCalibration, names: tuple[str, ...], mesh: Mesh, size: tuple[int, int]) -> list[str]:
    advice = []
    if not found.converged:
        advice.append("The iterations did not converge; increase max_iterations or give a closer start.")
    deviations = dict(zip(names, np.sqrt(np.diag(found.covariance)).tolist(), strict=True))
    for name, sensitivity in zip(names, found.sensitivities, strict=True):
        displacement = deviations[name] * sensitivity
        if displacement > _LARGEST_DISPLACEMENT * np.hypot(*size):
            advice.append(
                f"{name} is known to {deviations[name]:.2g} only, which displaces points by up to {displacement:.0f} "
                "px: leave it out of the parameters, or move the specimen further."
            )
    coefficients = _lens_coefficients(found.camera, names)
    advice += [
        f"{name} = {coefficients[name]:.2g} is zero within its standard deviation {deviations[name]:.2g}: leave it out."
        for name in insignificant(coefficients, deviations)
    ]
    advice += [
        f"{first} and {second} are correlated by {correlation:.3f}: their values mean little one by one; find fewer "
        "parameters, or move the specimen further."
        for first, second, correlation in correlated_pairs(names, found.covariance, at_least=_LARGEST_CORRELATION)
    ]
    return advice + _advice_on_motions(found, mesh, size)


def _advice_on_motions(found: _core.SelfCalibration, mesh: Mesh, size: tuple[int, int]) -> list[str]:
    used = mesh.points[mesh.used_nodes]
    centre = np.zeros(3)
    centre[: used.shape[1]] = used.mean(axis=0)
    paths = found.camera.project(centre + found.motions[:, :3]) - found.camera.project(centre[np.newaxis])
    furthest, shorter_side = float(np.hypot(*paths.T).max()), min(size)
    if furthest < _SMALL_MOTION * shorter_side:
        return [
            f"The specimen moves by {furthest:.0f} px at most, {furthest / shorter_side:.0%} of the image's shorter "
            "side: the effect of the lens is proportional to the motion."
        ]
    extents = np.linalg.svd(paths, compute_uv=False)
    if len(extents) < 2 or extents[1] < _ONE_LINE * extents[0]:
        return ["All motions lie along one line: move the specimen in a second direction too."]
    return []


def _lens_coefficients(camera: Pinhole, names: tuple[str, ...]) -> dict[str, float]:
    """Return the values of those parameters that are coefficients of the lens."""
    values = {} if camera.distortion is None else camera.distortion.parameters
    return {name: values[name] for name in names if name in values}
