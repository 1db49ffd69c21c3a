"""The limit on what is read of a file, so that none takes all memory."""

__all__ = ["MAX_BYTES"]

MAX_BYTES = 4 << 30
"""Bytes of the largest mesh with the files it includes, and of the largest array or decoded image in a file."""
