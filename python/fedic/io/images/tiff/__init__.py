"""TIFF files: one decoder and one rule for pages, planes, colours and damage."""

from fedic.io.images.tiff.reader import read_tiff

__all__ = ["read_tiff"]
