"""Camera files of many programs, all of one pair of cameras, each written by the program's own convention."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

import fedic

FX, FY, CX, CY = 1200.0, 1195.0, 318.25, 243.5
K1, K2, K3, P1, P2 = -0.12, 0.31, 0.05, 0.0011, -0.0007
"""Coefficients of the lens in OpenCV's notation."""
SIZE = (640, 480)
ANGLES = (0.4, -18.0, 1.1)
"""Angles of the second camera relative to the first about x, y, z in degrees, in this order about fixed axes."""
SHIFT = (130.75, -0.6, 17.1)
K = np.array([[FX, 0, CX], [0, FY, CY], [0, 0, 1]])


def turn(angles: tuple[float, float, float]) -> Any:
    """Return the rotation matrix of angles in degrees about the fixed axes x, y, z."""
    x, y, z = (cv2.Rodrigues(np.radians(angle) * axis)[0] for angle, axis in zip(angles, np.eye(3), strict=True))
    return z @ y @ x


R = turn(ANGLES)


def truth(
    *, second: bool = False, k3: float = 0.0, tangential: bool = True, size: Any = SIZE, lens: bool = True
) -> Any:
    """Return the camera that a file should give."""
    model = fedic.BrownDistortion((K1, K2, k3), (P1, P2) if tangential else (0.0, 0.0)) if lens else None
    pose: Any = {"rotation": R, "translation": SHIFT} if second else {}
    return fedic.Pinhole((FX, FY), (CX, CY), distortion=model, image_size=size, **pose)


@dataclass(frozen=True)
class CameraFile:
    """A file of a program.

    Attributes
    ----------
    program : str
        Program and variant.
    name : str
        Name of the file.
    write : str, bytes or callable
        Its content, or a function that writes it.
    expected : Pinhole or str
        The camera in it, or what the error says.
    convention : str
        Units, signs, order, origin of the pixels.
    by : str
        Library that reads the syntax.
    number : int
        Camera in the file.
    """

    program: str
    name: str
    write: str | bytes | Callable[[Path], None]
    expected: Any
    convention: str
    by: str
    number: int = 0

    def make(self, folder: Path) -> Path:
        """Write the file."""
        path = folder / self.name
        if callable(self.write):
            self.write(path)
        elif isinstance(self.write, bytes):
            path.write_bytes(self.write)
        else:
            path.write_text(self.write, encoding="utf-8")
        return path


def storage(**values: Any) -> Callable[[Path], None]:
    """Return a function that writes a file of OpenCV."""

    def write(path: Path) -> None:
        file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        for key, value in values.items():
            file.write(key, value if isinstance(value, int) else np.atleast_2d(np.asarray(value, dtype=float)))
        file.release()

    return write


def listed(values: Any) -> str:
    """Return numbers as a list."""
    return str([float(value) for value in np.ravel(values)])


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


ROI = "binning_x: 2\nbinning_y: 2\nroi:\n  x_offset: 120\n  y_offset: 80\n  height: 320\n  width: 400\n  do_rectify: true\n"

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


def matlab_struct(*, with_k: bool = False) -> dict[str, Any]:
    """Return what ``toStruct(cameraParameters)`` holds: rows are multiplied from the left, the first pixel is (1, 1)."""
    matrix = np.array([[FX, 0, CX + 1], [0, FY, CY + 1], [0, 0, 1]])
    return {
        "RadialDistortion": np.array([[K1, K2, K3]]),
        "TangentialDistortion": np.array([[P1, P2]]),
        "ImageSize": np.array([[480.0, 640.0]]),
        "WorldUnits": "mm",
        **({"K": matrix} if with_k else {"IntrinsicMatrix": matrix.T}),
    }


def matlab(content: dict[str, Any]) -> Callable[[Path], None]:
    """Return a function that writes a file of version 5."""

    def write(path: Path) -> None:
        from scipy.io import savemat

        savemat(path, content)

    return write


def matlab_73(content: dict[str, Any], *, is_object: bool = False) -> Callable[[Path], None]:
    """Return a function that writes a file of version 7.3, in which arrays are transposed."""

    def write(path: Path) -> None:
        import h5py

        with h5py.File(path, "w", userblock_size=512) as file:
            if is_object:
                file.create_dataset("cameraParams", data=np.zeros((1, 6), dtype=np.uint32))
                file["cameraParams"].attrs["MATLAB_object_decode"] = np.int32(3)
                return
            group = file.create_group("cameraParams")
            for key, value in content.items():
                text = isinstance(value, str)
                group.create_dataset(
                    key, data=np.array([list(map(ord, value))], dtype=np.uint16).T if text else value.T
                )
        with path.open("r+b") as raw:
            raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")

    return write


STEREO = {
    "CameraParameters1": matlab_struct(),
    "CameraParameters2": matlab_struct(with_k=True),
    "RotationOfCamera2": R.T,
    "TranslationOfCamera2": np.array([SHIFT]),
}

_BROWN5 = [K1, K2, P1, P2, K3]
_CENTRE = "px, first pixel centre (0, 0); k1 k2 p1 p2 k3"
_CORNER = "px, corner of the first pixel (0, 0): 0.5 subtracted"
_MATLAB = "px, first pixel (1, 1): 1 subtracted; matrices transposed (K is not); k1 k2 k3, p1 p2"
_ANGLES = "degrees, R = Rz Ry Rx; mm; kappas of r^2, r^4, r^6"
FILES = [
    CameraFile("OpenCV YAML", "a.yml", storage(image_width=640, image_height=480, camera_matrix=K, distortion_coefficients=_BROWN5), truth(k3=K3), _CENTRE, "PyYAML"),
    CameraFile("OpenCV XML", "a.xml", storage(image_width=640, image_height=480, camera_matrix=K, distortion_coefficients=_BROWN5), truth(k3=K3), _CENTRE, "defusedxml"),
    CameraFile("OpenCV stereo", "a.yml", storage(M1=K, D1=_BROWN5, M2=K, D2=_BROWN5, R=R, T=SHIFT), truth(second=True, k3=K3, size=None), "X_1 = R X_0 + T", "PyYAML", 1),
    CameraFile("OpenCV stereo without R, T", "a.yml", storage(M1=K, D1=_BROWN5, M2=K, D2=_BROWN5), "rotation and the translation of camera 1", "R, T in extrinsics.yml", "PyYAML", 1),
    CameraFile("OpenCV, rational model", "a.yml", storage(camera_matrix=K, D=[*_BROWN5, 0.1, 0, 0]), "k4 = 0.1", "k4 to k6 not zero", "PyYAML"),
    CameraFile("NumPy arrays", "a.npz", lambda path: np.savez(path, mtx=K, dist=_BROWN5, image_size=SIZE), truth(k3=K3), _CENTRE, "NumPy"),
    CameraFile("ROS calibration", "a.yaml", CALIBRATION.replace("MODEL", "plumb_bob"), truth(k3=K3), _CENTRE + "; rectification is no pose", "PyYAML"),
    CameraFile("ROS calibration, other lens", "a.yaml", CALIBRATION.replace("MODEL", "Kannala_Brandt"), "lens model 'Kannala_Brandt'", "equidistant, fov, ...", "PyYAML"),
    CameraFile("ROS 1 message", "a.yaml", message(more="---\n"), truth(k3=K3), "K of the full frame; R and P are no pose", "PyYAML"),
    CameraFile("ROS 2 message", "a.yaml", message("dkr", dashes=True), truth(k3=K3), "the same in small letters", "PyYAML"),
    CameraFile("ROS message, ROI and binning", "a.yaml", message(more=ROI), fedic.Pinhole((FX / 2, FY / 2), ((CX - 120) / 2, (CY - 80) / 2), distortion=fedic.BrownDistortion((K1, K2, K3), (P1, P2)), image_size=(200, 160)), "(K - offset) / binning", "PyYAML"),
    CameraFile("ROS messages that differ", "a.yaml", message() + "---\n" + message(model="fov"), "2 messages of different cameras", "", "PyYAML"),
    CameraFile("Kalibr radtan", "a.yaml", camchain(), truth(second=True), "T_cn_cnm1: X_n = T X_(n-1)", "PyYAML", 1),
    CameraFile("Kalibr equi", "a.yaml", camchain("equi"), "lens model 'equi'", "equi, fov", "PyYAML"),
    CameraFile("EuRoC sensor", "a.yaml", SENSOR, truth(), _CENTRE + "; T_BS is not used", "PyYAML"),
    CameraFile("DICe XML, OpenCV's lens", "a.xml", dice(), truth(second=True), "px; degrees, R = Rz Ry Rx; height before width", "defusedxml", 1),
    CameraFile("DICe XML, lens of VIC-3D", "a.xml", dice("VIC3D_LENS_DISTORTION"), "VIC3D_LENS_DISTORTION is not supported", "powers r, r^2, r^3", "defusedxml"),
    CameraFile("DICe XML without a pose", "a.xml", dice(pose=False), "pose of CAMERA 1", "", "defusedxml", 1),
    CameraFile("DICe text, no lens", "a.txt", dice_lines(0.0), truth(second=True, lens=False), "24 or 30 lines; degrees", "fedic", 1),
    CameraFile("DICe text, with a lens", "a.txt", dice_lines(0.06), "K1R1_K2R2_K3R3 is not supported", "powers r, r^2, r^3", "fedic"),
    CameraFile("VIC-3D report", "a.txt", REPORT, truth(second=True, tangential=False, size=None), _ANGLES, "fedic", 1),
    CameraFile("VIC-3D report, decimal commas", "a.txt", "\n".join(line if "agnif" in line else line.replace(".", ",") for line in REPORT.splitlines()), truth(second=True, tangential=False, size=None), _ANGLES, "fedic", 1),
    CameraFile("VIC-3D report in metres", "a.txt", REPORT.replace("[mm]", "[m]"), r"Distances, X is in \[m\]", "", "fedic", 1),
    CameraFile("VIC-3D project", "a.xml", project(), truth(second=True, tangential=False), "poses of both in one world; fs in px", "defusedxml", 1),
    CameraFile("MatchID", "a.caldat", caldat(), truth(second=True, k3=K3, size=None), _ANGLES + "; P1 P2 as OpenCV", "fedic", 1),
    CameraFile("MatchID, decimal commas", "a.caldat", caldat().replace(".", ","), truth(second=True, k3=K3, size=None), _ANGLES, "fedic", 1),
    CameraFile("MatchID in radians", "a.caldat", caldat("rad"), r"Theta is in \[rad\]", "", "fedic"),
    CameraFile("MATLAB toStruct, version 5", "a.mat", matlab(matlab_struct()), truth(k3=K3), _MATLAB, "SciPy"),
    CameraFile("MATLAB toStruct with K", "a.mat", matlab({"s": matlab_struct(with_k=True)}), truth(k3=K3), _MATLAB, "SciPy"),
    CameraFile("MATLAB toStruct, version 7.3", "a.mat", matlab_73(matlab_struct()), truth(k3=K3), _MATLAB, "h5py"),
    CameraFile("MATLAB stereo", "a.mat", matlab(STEREO), truth(second=True, k3=K3), "X_1 = R' X_0 + T", "SciPy", 1),
    CameraFile("MATLAB object", "a.mat", matlab_73({}, is_object=True), r"toStruct\(cameraParams\)", "", "h5py"),
    CameraFile("COLMAP OPENCV", "cameras.txt", COLMAP.replace("MODEL", "OPENCV") + f"{K1} {K2} {P1} {P2}", truth(), _CORNER, "fedic"),
    CameraFile("COLMAP OPENCV_FISHEYE", "cameras.txt", COLMAP.replace("MODEL", "OPENCV_FISHEYE") + f"{K1} {K2} {P1} {P2}", "OPENCV_FISHEYE is not supported", "", "fedic"),
    CameraFile("Metashape calibration", "a.xml", METASHAPE, truth(k3=K3), _CORNER + "; cx cy from the middle; p1 p2 swapped", "defusedxml"),
    CameraFile("Metashape project", "a.xml", "<document><chunk/></document>", "export the calibration", "", "defusedxml"),
    CameraFile("Anipose", "calibration.toml", ANIPOSE, truth(second=True, k3=K3), "rotation vector; poses in one world", "tomllib", 1),
]  # fmt: skip
"""Every variant, with what it should give."""
