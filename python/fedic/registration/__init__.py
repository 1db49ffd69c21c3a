"""Placing a mesh in an image: `fedic.register`, and the pieces of a mesh's boundary it goes by."""

from fedic.registration.features import BoundaryFeature, boundary_features
from fedic.registration.from_data import register
from fedic.registration.pairs import read_pairs
from fedic.registration.result import FeatureDistances, Registration

__all__ = ["BoundaryFeature", "FeatureDistances", "Registration", "boundary_features", "read_pairs", "register"]
