"""The sections that describe a measurement, in every configuration file that has one: mesh, camera and correlation."""

from fedic._internal.sections import Section
from fedic.cameras.schema import CAMERA_SCHEMA
from fedic.campaign.config.camera_section import CameraFileSection
from fedic.campaign.config.correlation_section import CorrelationSection
from fedic.campaign.config.equilibrium_gap_section import EquilibriumGapSection
from fedic.campaign.config.mesh_section import MeshSection, RectangleSection, UnstructuredSection

__all__ = ["MEASUREMENT_SECTIONS"]

MEASUREMENT_SECTIONS: dict[str, type[Section]] = {
    "mesh": MeshSection,
    "mesh.rectangle": RectangleSection,
    "mesh.unstructured": UnstructuredSection,
    "camera.file": CameraFileSection,
    "correlation": CorrelationSection,
    "correlation.equilibrium_gap": EquilibriumGapSection,
    **CAMERA_SCHEMA.sections,
}
