"""Measurement of one frame after the other: starts from earlier frames, and updates of the reference image."""

from fedic.campaign.tracking.tracker import ReferenceUpdate, Starts, Tracked, Tracker, is_known

__all__ = ["ReferenceUpdate", "Starts", "Tracked", "Tracker", "is_known"]
