"""The noise of a camera and the noise floor of a measurement, from static images."""

from fedic.noise.floor import NoiseFloor, noise_floor
from fedic.noise.result import CameraNoise
from fedic.noise.static import camera_noise

__all__ = ["CameraNoise", "NoiseFloor", "camera_noise", "noise_floor"]
