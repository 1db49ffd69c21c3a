"""The file of a campaign: VTKHDF for ParaView, and beside it what a campaign needs to go on."""

from fedic.campaign.store.campaign_file import CampaignFile
from fedic.campaign.store.frame_data import FrameData, of_failed_frame, of_result, to_result
from fedic.campaign.store.write_behind import WriteBehind

__all__ = ["CampaignFile", "FrameData", "WriteBehind", "of_failed_frame", "of_result", "to_result"]
