"""Files of DICe, VIC-3D and MatchID."""

import numpy as np

from scenes.camera_files.camera_file import CameraFile
from scenes.camera_files.pair import ANGLES, CX, CY, FX, FY, K1, K2, K3, P1, P2, SHIFT, R, truth, turn

_ANGLES = "degrees, R = Rz Ry Rx; mm; kappas of r^2, r^4, r^6"


def dice(model: str = "OPENCV_LENS_DISTORTION", *, pose: bool = True) -> str:
    """Return a calibration of DICe."""

    def parameters(**values: object) -> str:
        return "".join(f'<Parameter name="{key}" type="double" value="{value}"/>\n' for key, value in values.items())

    own = parameters(CX=CX, CY=CY, FX=FX, FY=FY, K1=K1, K2=K2, P1=P1, P2=P2, LENS_DISTORTION_MODEL=model)
    own += parameters(IMAGE_HEIGHT_WIDTH="{ 480, 640 }")
    names = ("ALPHA", "BETA", "GAMMA", "TX", "TY", "TZ")
    second = parameters(**dict(zip(names, ANGLES + SHIFT, strict=True))) if pose else ""
    return (
        f"<ParameterList>{parameters(extrinsics_relative_camera_to_camera='true')}"
        f'<ParameterList name="CAMERA 0">{own}</ParameterList>'
        f'<ParameterList name="CAMERA 1">{own}{second}</ParameterList></ParameterList>'
    )


def dice_lines(k1: float) -> str:
    """Return the older text file of DICe."""
    own = [CX, CY, FX, FY, 0.0, k1, 0.0, 0.0]
    return "\n".join([f"{CX} # cx (a comment)", *map(str, [*own[1:], *own, *ANGLES, *SHIFT, 480, 640])])


REPORT = f"""Calibration results:

Overall score: 0.037
Camera 0 intrinsics:
Center (X): {CX} +/- 0.786
Center (Y): {CY} +/- 1.063
Focal Length (X): {FX} +/- 2.148
Focal Length (Y): {FY} +/- 0.0
Kappa 1: {K1} +/- 0.003
Kappa 2: {K2} +/- 0.385
Magnification [pixel/mm] average: 31.2172, min: 29.7693, max: 32.4072

Camera 1 intrinsics:
Center (X): {CX}
Center (Y): {CY}
Focal Length (X): {FX}
Focal Length (Y): {FY}
Kappa 1: {K1}
Kappa 2: {K2}

Extrinsics:

Angles:
X: {ANGLES[0]} +/- 0.005
Y: {ANGLES[1]} +/- 0.006
Z: {ANGLES[2]} +/- 0.002

Distances:
X [mm]: {SHIFT[0]} +/- 0.032
Y [mm]: {SHIFT[1]} +/- 0.006
Z [mm]: {SHIFT[2]} +/- 0.091
"""


def project(*, second: bool = True) -> str:
    """Return a project of VIC-3D: both cameras have a pose in the same world."""
    angles, shift = (179.9, 9.0, 0.3), np.array([-63.2, -0.3, 18.7])
    own_turn, own_shift = R @ turn(angles), R @ shift + SHIFT
    y = -np.arcsin(own_turn[2, 0])
    x, z = np.arctan2(own_turn[2, 1], own_turn[2, 2]), np.arctan2(own_turn[1, 0], own_turn[0, 0])
    poses = [(*angles, *shift), (*np.degrees([x, y, z]), *own_shift)]
    cameras = "".join(
        f'<camera id="{index}">{CX} {CY} {FX} {FY} 0 {K1} {K2} 0'
        + (f"<orientation>{' '.join(map(repr, map(float, pose)))}</orientation>" if second or index == 0 else "")
        + "</camera>"
        for index, pose in enumerate(poses)
    )
    mask = '<polygonmask width="640" height="480"/>'
    return (
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n<!DOCTYPE vpml>\n<project dir="C:/a">'
        f"<calibration>{cameras}</calibration>{mask}</project>"
    )


def caldat(angle: str = "deg", length: str = "mm") -> str:
    """Return a calibration of MatchID."""
    values = {"Fx [pixels]": FX, "Fy [pixels]": FY, "Fs [pixels]": 0, "Cx [pixels]": CX, "Cy [pixels]": CY}
    values |= {"Kappa 1": K1, "Kappa 2": K2, "Kappa 3": K3, "P1": P1, "P2": P2}
    cameras = "".join(f"Cam{camera}_{key};{value}\n" for camera in (1, 2) for key, value in values.items())
    units = dict.fromkeys(("Theta", "Phi", "Psi"), angle) | dict.fromkeys(("Tx", "Ty", "Tz"), length)
    return cameras + "".join(
        f"{key} [{unit}];{value}\n" for (key, unit), value in zip(units.items(), ANGLES + SHIFT, strict=True)
    )


FILES = [
    CameraFile(
        "DICe XML, OpenCV's lens",
        "a.xml",
        dice(),
        truth(second=True),
        "px; degrees, R = Rz Ry Rx; height before width",
        "defusedxml",
        1,
    ),
    CameraFile(
        "DICe XML, lens of VIC-3D",
        "a.xml",
        dice("VIC3D_LENS_DISTORTION"),
        "VIC3D_LENS_DISTORTION is not supported",
        "powers r, r^2, r^3",
        "defusedxml",
    ),
    CameraFile("DICe XML without a pose", "a.xml", dice(pose=False), "pose of CAMERA 1", "", "defusedxml", 1),
    CameraFile(
        "DICe text, no lens",
        "a.txt",
        dice_lines(0.0),
        truth(second=True, lens=False),
        "24 or 30 lines; degrees",
        "fedic",
        1,
    ),
    CameraFile(
        "DICe text, with a lens",
        "a.txt",
        dice_lines(0.06),
        "K1R1_K2R2_K3R3 is not supported",
        "powers r, r^2, r^3",
        "fedic",
    ),
    CameraFile("VIC-3D report", "a.txt", REPORT, truth(second=True, tangential=False, size=None), _ANGLES, "fedic", 1),
    CameraFile(
        "VIC-3D report, decimal commas",
        "a.txt",
        "\n".join(line if "agnif" in line else line.replace(".", ",") for line in REPORT.splitlines()),
        truth(second=True, tangential=False, size=None),
        _ANGLES,
        "fedic",
        1,
    ),
    CameraFile(
        "VIC-3D report in metres", "a.txt", REPORT.replace("[mm]", "[m]"), r"Distances, X is in \[m\]", "", "fedic", 1
    ),
    CameraFile(
        "VIC-3D project",
        "a.xml",
        project(),
        truth(second=True, tangential=False),
        "poses of both in one world; fs in px",
        "defusedxml",
        1,
    ),
    CameraFile(
        "MatchID", "a.caldat", caldat(), truth(second=True, k3=K3, size=None), _ANGLES + "; P1 P2 as OpenCV", "fedic", 1
    ),
    CameraFile(
        "MatchID, decimal commas",
        "a.caldat",
        caldat().replace(".", ","),
        truth(second=True, k3=K3, size=None),
        _ANGLES,
        "fedic",
        1,
    ),
    CameraFile("MatchID in radians", "a.caldat", caldat("rad"), r"Theta is in \[rad\]", "", "fedic"),
]
