"""Files of COLMAP, Metashape and Anipose."""

import cv2
import numpy as np

from scenes.camera_files.camera_file import CameraFile
from scenes.camera_files.pair import CX, CY, FX, FY, K1, K2, K3, P1, P2, SHIFT, K, R, truth

_CORNER = "px, corner of the first pixel (0, 0): 0.5 subtracted"

COLMAP = f"# Camera list\n# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 MODEL 640 480 {FX} {FY} {CX + 0.5} {CY + 0.5} "

METASHAPE = f"""<?xml version="1.0" encoding="UTF-8"?>
<calibration>
  <projection>frame</projection>
  <width>640</width>
  <height>480</height>
  <f>{FY}</f>
  <cx>{CX + 0.5 - 320}</cx>
  <cy>{CY + 0.5 - 240}</cy>
  <b1>{FX - FY}</b1>
  <k1>{K1}</k1>
  <k2>{K2}</k2>
  <k3>{K3}</k3>
  <p1>{P2}</p1>
  <p2>{P1}</p2>
</calibration>
"""

ANIPOSE = (
    "".join(
        f"""[cam_{index}]
name = "{index}"
size = [ 640, 480,]
matrix = {K.tolist()}
distortions = [ {K1}, {K2}, {P1}, {P2}, {K3},]
rotation = {vector.ravel().tolist()}
translation = {shift}

"""
        for index, (vector, shift) in enumerate([(np.zeros(3), [0.0, 0.0, 0.0]), (cv2.Rodrigues(R)[0], list(SHIFT))])
    )
    + "[metadata]\nadjusted = false\n"
)

FILES = [
    CameraFile(
        "COLMAP OPENCV",
        "cameras.txt",
        COLMAP.replace("MODEL", "OPENCV") + f"{K1} {K2} {P1} {P2}",
        truth(),
        _CORNER,
        "fedic",
    ),
    CameraFile(
        "COLMAP OPENCV_FISHEYE",
        "cameras.txt",
        COLMAP.replace("MODEL", "OPENCV_FISHEYE") + f"{K1} {K2} {P1} {P2}",
        "OPENCV_FISHEYE is not supported",
        "",
        "fedic",
    ),
    CameraFile(
        "Metashape calibration",
        "a.xml",
        METASHAPE,
        truth(k3=K3),
        _CORNER + "; cx cy from the middle; p1 p2 swapped",
        "defusedxml",
    ),
    CameraFile(
        "Metashape project", "a.xml", "<document><chunk/></document>", "export the calibration", "", "defusedxml"
    ),
    CameraFile(
        "Anipose",
        "calibration.toml",
        ANIPOSE,
        truth(second=True, k3=K3),
        "rotation vector; poses in one world",
        "tomllib",
        1,
    ),
]
