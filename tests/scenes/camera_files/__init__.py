"""Camera files of many programs, all of one pair of cameras, each written by the program's own convention."""

from scenes.camera_files import image_correlation, matlab, opencv, photogrammetry, robotics

FILES = [*opencv.FILES, *robotics.FILES, *image_correlation.FILES, *matlab.FILES, *photogrammetry.FILES]
"""Every variant, with what reading it should give."""
