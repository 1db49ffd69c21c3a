"""The configuration file of ``fedic run``, one module for each of its sections."""

from fedic.campaign.config.config import Config, load_config

__all__ = ["Config", "load_config"]
