"""Measurement of a series of images described by a configuration file."""

from fedic.campaign.config import Config, load_config
from fedic.campaign.series import Frame, measure_series

__all__ = ["Config", "Frame", "load_config", "measure_series"]
