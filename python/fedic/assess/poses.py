"""Assessment of results on a specimen at rest and after known rigid motions."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fedic._internal.choices import check_choice
from fedic._internal.types import Floats
from fedic.assess.assessment import LIMITS, Assessment, Check, Reading
from fedic.assess.squares import average_over_squares
from fedic.assess.statistics import (
    Deviations,
    PixelSize,
    deviations,
    pixel_size,
    zero_displacement_deviation,
    zero_strain_deviation,
)
from fedic.errors import OptionError
from fedic.results import Result
from fedic.results.rigid import fit_rigid_motion

__all__ = ["Pose", "assess_poses"]


@dataclass(frozen=True)
class Pose:
    """A position of the specimen, and the results of its images.

    Attributes
    ----------
    name : str
        Name in tables.
    results : sequence of Result
        One for each image.
    displacement : (float, float), optional
        Set displacement of the centre of the mesh, in the mesh's unit; ``(0, 0)`` for static images. Not compared if it
        is None.
    rotation : float, optional
        Set rotation in degrees, counter-clockwise from x to y of the mesh; not compared if it is None.
    """

    name: str
    results: Sequence[Result]
    displacement: tuple[float, float] | None = None
    rotation: float | None = None


def assess_poses(
    poses: Sequence[Pose], *, square: float, limits: Mapping[str, float] | None = None, set_uncertainty: float = 0.0
) -> Assessment:
    """Assess results on a specimen at rest and after known rigid motions.

    Parameters
    ----------
    poses : sequence of Pose
        The poses and the results of their images, all against one reference image.
    square : float
        Side of the squares over which the fields are averaged, in the mesh's unit.
    limits : mapping of str to float, optional
        Largest values allowed: ``"zd"`` and ``"d"`` in the mesh's unit, ``"zs"``, ``"rotation"`` in degrees.
    set_uncertainty : float
        Standard uncertainty of the set displacements, in the mesh's unit.

    Returns
    -------
    Assessment
        The deviations and the verdict.

    Raises
    ------
    OptionError
        If there is no image, the squares do not fit, or a limit is unknown or not positive.
    """
    for name, limit in (limits or {}).items():
        check_choice("limit", name, LIMITS)
        if not 0.0 < limit < math.inf:
            raise OptionError(f"limit {name}={limit}: give a positive number.", name)
    pairs = [(pose, result) for pose in poses for result in pose.results]
    if not pairs:
        raise OptionError("There is no image to assess; give poses with results.", "poses")
    fields = [average_over_squares(result, square) for _, result in pairs]
    motions = [_motion(field.points, field.displacement) for field in fields]
    readings = [
        Reading(
            pose.name,
            translation,
            rotation,
            np.abs(translation - (math.nan if pose.displacement is None else np.array(pose.displacement))),
            math.nan if pose.rotation is None else abs(_turned(rotation - pose.rotation)),
            len(field.points),
        )
        for (pose, _), field, (translation, rotation) in zip(pairs, fields, motions, strict=True)
    ]
    along, turned = _compared(pairs, readings)
    results = [result for _, result in pairs]
    found = Assessment(
        square=square,
        zero_displacement=zero_displacement_deviation([(field.points, field.displacement) for field in fields]),
        zero_strain=zero_strain_deviation([field.strains for field in fields]),
        readings=readings,
        along=along,
        rotation=turned,
        pixel=_pixel(pairs, set_uncertainty),
        checks=[],
        num_poses=len(poses),
        not_measured=sum(int(np.count_nonzero(r.mesh.used_nodes & ~r.valid_nodes)) for r in results),
        squares_left_out=sum(field.left_out for field in fields),
        doubtful=sum(not result.quality.is_good for result in results),
        unit=results[0].unit,
    )
    values = {"zd": found.zd, "zs": found.zs, "d": found.d, "rotation": found.rotation.largest}
    found.checks.extend(Check(name, values[name], limit) for name, limit in (limits or {}).items())
    return found


def _motion(points: Floats, displacement: Floats) -> tuple[Floats, float]:
    """Return the translation and the rotation in degrees; NaN of fewer than two squares."""
    if len(points) < 2:
        return np.full(2, math.nan), math.nan
    motion = fit_rigid_motion(points, displacement)
    return motion.translation, math.degrees(motion.rotation)


def _compared(
    pairs: list[tuple[Pose, Result]], readings: list[Reading]
) -> tuple[tuple[Deviations, Deviations], Deviations]:
    moved = [
        (reading.displacement, pose.displacement)
        for (pose, _), reading in zip(pairs, readings, strict=True)
        if pose.displacement is not None
    ]
    turned = [
        (pose.rotation + _turned(reading.rotation - pose.rotation), pose.rotation)
        for (pose, _), reading in zip(pairs, readings, strict=True)
        if pose.rotation is not None
    ]
    measured, given = (np.array([pair[k] for pair in moved], dtype=np.float64).reshape(-1, 2) for k in range(2))
    angles, set_angles = (np.array([pair[k] for pair in turned], dtype=np.float64) for k in range(2))
    x, y = (deviations(measured[:, axis], given[:, axis]) for axis in range(2))
    return (x, y), deviations(angles, set_angles)


def _pixel(pairs: list[tuple[Pose, Result]], set_uncertainty: float) -> PixelSize:
    moved = [(result, pose.displacement) for pose, result in pairs if pose.displacement not in (None, (0.0, 0.0))]
    known = [(result.pixel_displacement[result.valid_nodes], given) for result, given in moved]
    pixels = [nodes.mean(axis=0) for nodes, _ in known if len(nodes)]
    given = [displacement for nodes, displacement in known if len(nodes)]
    return pixel_size(np.array(pixels).reshape(-1, 2), np.array(given).reshape(-1, 2), set_uncertainty)


def _turned(degrees: float) -> float:
    """Return an angle between -180 and 180 degrees."""
    return (degrees + 180.0) % 360.0 - 180.0
