"""Series of images measured on one mesh: campaigns, their files, and the configuration of ``fedic run``."""

from fedic.campaign.campaign import Campaign, load
from fedic.campaign.config import Config, load_config
from fedic.campaign.record import FrameRecord
from fedic.campaign.series import Frame, measure_series

__all__ = ["Campaign", "Config", "Frame", "FrameRecord", "load", "load_config", "measure_series"]
