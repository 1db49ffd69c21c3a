"""Files of ROS, Kalibr and EuRoC."""

import numpy as np

import fedic
from scenes.camera_files.camera_file import CameraFile
from scenes.camera_files.pair import CX, CY, FX, FY, K1, K2, K3, P1, P2, SHIFT, K, R, listed, truth, turn

_CENTRE = "px, first pixel centre (0, 0); k1 k2 p1 p2 k3"


def message(names: str = "DKR", *, dashes: bool = False, more: str = "", model: str = "plumb_bob") -> str:
    """Return a printed message of ROS of the first camera."""
    d, k, r = names
    entries = {d: [K1, K2, P1, P2, K3], k: K.ravel(), r: turn((2.0, 1.0, 0.5)).ravel()}
    lines = "".join(
        f"{key}:\n" + "".join(f"- {value!r}\n" for value in map(float, values))
        if dashes
        else f"{key}: {listed(values)}\n"
        for key, values in entries.items()
    )
    projection = f"{'p' if names.islower() else 'P'}: {listed(np.zeros(12))}\n"
    return f"header:\n  frame_id: c\nheight: 480\nwidth: 640\ndistortion_model: {model}\n{lines}{projection}{more}"


ROI = """binning_x: 2
binning_y: 2
roi:
  x_offset: 120
  y_offset: 80
  height: 320
  width: 400
  do_rectify: true
"""

CALIBRATION = f"""image_width: 640
image_height: 480
camera_name: cam
camera_matrix:
  rows: 3
  cols: 3
  data: {listed(K)}
distortion_model: MODEL
distortion_coefficients:
  rows: 1
  cols: 5
  data: [{K1}, {K2}, {P1}, {P2}, {K3}]
rectification_matrix:
  rows: 3
  cols: 3
  data: {listed(turn((2.0, 1.0, 0.5)))}
"""


def camchain(model: str = "radtan") -> str:
    """Return a camera chain of Kalibr."""
    pose = [[*map(float, row), shift] for row, shift in zip(R, SHIFT, strict=True)] + [[0.0, 0.0, 0.0, 1.0]]
    own = f"""  camera_model: pinhole
  distortion_coeffs: [{K1}, {K2}, {P1}, {P2}]
  distortion_model: {model}
  intrinsics: [{FX}, {FY}, {CX}, {CY}]
  resolution: [640, 480]
"""
    return f"cam0:\n  cam_overlaps: [1]\n{own}cam1:\n  T_cn_cnm1:\n" + "".join(f"  - {row}\n" for row in pose) + own


SENSOR = f"""sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: {listed(np.eye(4))}
resolution: [640, 480]
camera_model: pinhole
intrinsics: [{FX}, {FY}, {CX}, {CY}] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [{K1}, {K2}, {P1}, {P2}]
"""


FILES = [
    CameraFile(
        "ROS calibration",
        "a.yaml",
        CALIBRATION.replace("MODEL", "plumb_bob"),
        truth(k3=K3),
        _CENTRE + "; rectification is no pose",
        "PyYAML",
    ),
    CameraFile(
        "ROS calibration, other lens",
        "a.yaml",
        CALIBRATION.replace("MODEL", "Kannala_Brandt"),
        "lens model 'Kannala_Brandt'",
        "equidistant, fov, ...",
        "PyYAML",
    ),
    CameraFile(
        "ROS 1 message",
        "a.yaml",
        message(more="---\n"),
        truth(k3=K3),
        "K of the full frame; R and P are no pose",
        "PyYAML",
    ),
    CameraFile(
        "ROS 2 message", "a.yaml", message("dkr", dashes=True), truth(k3=K3), "the same in small letters", "PyYAML"
    ),
    CameraFile(
        "ROS message, ROI and binning",
        "a.yaml",
        message(more=ROI),
        fedic.Pinhole(
            (FX / 2, FY / 2),
            ((CX - 120) / 2, (CY - 80) / 2),
            distortion=fedic.BrownDistortion((K1, K2, K3), (P1, P2)),
            image_size=(200, 160),
        ),
        "(K - offset) / binning",
        "PyYAML",
    ),
    CameraFile(
        "ROS messages that differ",
        "a.yaml",
        message() + "---\n" + message(model="fov"),
        "2 messages of different cameras",
        "",
        "PyYAML",
    ),
    CameraFile("Kalibr radtan", "a.yaml", camchain(), truth(second=True), "T_cn_cnm1: X_n = T X_(n-1)", "PyYAML", 1),
    CameraFile("Kalibr equi", "a.yaml", camchain("equi"), "lens model 'equi'", "equi, fov", "PyYAML"),
    CameraFile("EuRoC sensor", "a.yaml", SENSOR, truth(), _CENTRE + "; T_BS is not used", "PyYAML"),
]
