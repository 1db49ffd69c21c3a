"""What a campaign measures with, and its form in files."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fedic._core import CORRELATION_OPTIONS, Mesh
from fedic._internal.types import Camera, Floats, Image
from fedic.cameras.files.programs.camera_toml import camera_from_text, camera_text
from fedic.campaign.tracking import ReferenceUpdate, Starts
from fedic.correlation import Correlator
from fedic.options import core_options
from fedic.progress import ProgressCallback
from fedic.quadrature import MeshQuadrature, PixelQuadrature
from fedic.regularization.equilibrium_gap import EquilibriumGap, Regularization
from fedic.results import StrainMeasure
from fedic.starts.initial import Start

__all__ = ["Setup", "setup_entries", "setup_from_entries"]


@dataclass(frozen=True, eq=False)
class Setup:
    """What a campaign measures with, apart from the images.

    Attributes
    ----------
    mesh, camera, unit, regularization, initial
        See `fedic.Correlator`; the initial displacement is the name of a start or an array.
    mask : ndarray of bool, shape (height, width), or None
        Pixels of the first reference image that are left out.
    options : mapping
        Options of the correlation that were given.
    starts, reference_update, strain_measure
        See `fedic.Campaign`.
    """

    mesh: Mesh
    camera: Camera
    unit: str | None
    mask: NDArray[np.bool_] | None
    regularization: Regularization
    initial: Start | Floats
    options: Mapping[str, Any]
    starts: Starts
    reference_update: ReferenceUpdate
    strain_measure: StrainMeasure

    def prepare(
        self, image: Image, mesh: Mesh, mask: NDArray[np.bool_] | None, progress: ProgressCallback | None = None
    ) -> Correlator:
        """Prepare an image as the reference image of a mesh."""
        return Correlator(
            image,
            mesh,
            self.camera,
            initial=self.initial,
            mask=mask,
            regularization=self.regularization,
            unit=self.unit,
            progress=progress,
            **self.options,
        )


def setup_entries(setup: Setup) -> dict[str, Any]:
    """Return a setup as JSON types, the mesh and the mask as checksums.

    Parameters
    ----------
    setup : Setup
        The setup.

    Returns
    -------
    dict
        Entries; those of the same setup are equal.
    """
    initial, gap, mask = setup.initial, setup.regularization, setup.mask
    return {
        "mesh": _mesh_checksum(setup.mesh),
        "camera": camera_text(setup.camera, Path("camera.toml")),
        "unit": setup.unit,
        "mask": None if mask is None else _checksum(np.packbits(mask).tobytes(), repr(mask.shape).encode()),
        "regularization": {"moduli": gap.moduli, "edges": gap.edges} if isinstance(gap, EquilibriumGap) else gap,
        "initial": initial if isinstance(initial, str) else _checksum(initial.tobytes()),
        "options": _jsonable(core_options(setup.options, CORRELATION_OPTIONS)),
        "starts": setup.starts,
        "reference_update": setup.reference_update,
        "strain_measure": setup.strain_measure,
    }


def setup_from_entries(entries: Mapping[str, Any], mesh: Mesh, mask: NDArray[np.bool_] | None, path: Path) -> Setup:
    """Return the setup of entries.

    Parameters
    ----------
    entries : mapping
        From `setup_entries`.
    mesh : Mesh
        The mesh.
    mask : ndarray of bool, shape (height, width), or None
        The mask.
    path : Path
        The file, for messages.

    Returns
    -------
    Setup
        The setup; with the start ``"auto"`` in the place of an array.
    """
    gap = entries["regularization"]
    options = dict(entries["options"])
    if "quadrature" in options:
        rule, density = options["quadrature"]
        options["quadrature"] = PixelQuadrature() if rule == "pixel" else MeshQuadrature(density, rule)
    initial = entries["initial"]
    return Setup(
        mesh,
        camera_from_text(entries["camera"], path),
        entries["unit"],
        mask,
        "smooth" if isinstance(gap, str) else _gap(gap["moduli"], gap["edges"]),
        "auto" if isinstance(initial, dict) else initial,
        options,
        entries["starts"],
        entries["reference_update"],
        entries["strain_measure"],
    )


def _gap(moduli: Mapping[str, float], edges: Mapping[str, Any]) -> EquilibriumGap:
    kind: Any = EquilibriumGap if "nu" in moduli else EquilibriumGap.orthotropic
    gap: EquilibriumGap = kind(**moduli, **edges)
    return gap


def _mesh_checksum(mesh: Mesh) -> dict[str, str]:
    parts = [mesh.points.tobytes()]
    for name, nodes in mesh.cells.items():
        parts += [name.encode(), nodes.tobytes()]
    for name, found in mesh.sets.items():
        parts += [name.encode(), found.nodes.tobytes(), found.cells.tobytes()]
    return _checksum(*parts)


def _checksum(*parts: bytes) -> dict[str, str]:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little") + part)
    return {"sha256": digest.hexdigest()}


def _jsonable(options: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(options))
    return found
