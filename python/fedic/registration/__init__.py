"""Registration of a mesh to an image: `fedic.register`, and the boundary features it fits."""

from fedic.registration._features import BoundaryFeature, boundary_features
from fedic.registration._from_data import register
from fedic.registration._pair_files import read_pairs
from fedic.registration._result import FeatureDistances, Registration, check_format

__all__ = [
    "BoundaryFeature",
    "FeatureDistances",
    "Registration",
    "boundary_features",
    "check_format",
    "read_pairs",
    "register",
]
