"""Files that are not read, named with what to do instead."""

from pathlib import Path

from fedic.errors import ImageError

__all__ = ["refusal"]

_READ = "TIFF, PNG, JPEG, BMP, JPEG 2000, JPEG XL, WebP, PGM, PPM, PFM or .npy"
_FRAMES = "export its frames as TIFF or PNG, with the camera's software or: ffmpeg -i FILE frame-%05d.png"
_DEVELOP = (
    "the colours of its sensor are not developed; export a linear 16-bit TIFF from the camera's software, or develop "
    "it with dcraw -4 -T"
)
_CAMERA_SOFTWARE = "export its frames as 16-bit TIFF from the camera's software"
_CONVERT = "convert it to TIFF or PNG"
_ARRAY = "save the image by itself with numpy.save, or as TIFF"

_SIGNATURES: tuple[tuple[int, bytes, str, str], ...] = (
    (0, b"GIF8", "a GIF image", "save it as PNG or TIFF; of an animation, each frame"),
    (0, b"\x76\x2f\x31\x01", "an OpenEXR image", "save it as 32-bit float TIFF"),
    (0, b"#?RADIANCE", "a Radiance HDR image", "save it as 32-bit float TIFF"),
    (0, b"II\xbc\x01", "a JPEG XR image", _CONVERT),
    (0, b"8BPS", "a Photoshop image", "save it as TIFF without layers"),
    (0, b"P7", "a PAM image", "save it as PGM, PNG or TIFF"),
    (0, b"SIMPLE  =", "a FITS file", _ARRAY),
    (0, b"\x89HDF", "an HDF5 file", _ARRAY),
    (0, b"MATLAB 5.0", "a MATLAB file", "write the image with imwrite as TIFF or PNG"),
    (0, b"NRRD", "an NRRD file", _CONVERT),
    (128, b"DICM", "a DICOM file", _CONVERT),
    (0, b"SDPX", "a DPX image", _CONVERT),
    (0, b"XPDS", "a DPX image", _CONVERT),
    (0, b"Andor Technology", "an Andor SIF file", _CAMERA_SOFTWARE),
    (0, b"CI\x2c\x00", "a Phantom cine recording", _CAMERA_SOFTWARE),
    (8, b"AVI ", "an AVI video", _FRAMES),
    (0, b"\x1a\x45\xdf\xa3", "a Matroska or WebM video", _FRAMES),
    (0, b"\x30\x26\xb2\x75\x8e\x66\xcf\x11", "a Windows Media video", _FRAMES),
    (0, b"\x00\x00\x01\xba", "an MPEG video", _FRAMES),
    (8, b"CR\x02", "a Canon raw image (CR2)", _DEVELOP),
    (4, b"ftypcrx", "a Canon raw image (CR3)", _DEVELOP),
    (0, b"IIRO", "an Olympus raw image", _DEVELOP),
    (0, b"IIU\x00", "a Panasonic raw image", _DEVELOP),
    (0, b"FUJIFILMCCD-RAW", "a Fujifilm raw image", _DEVELOP),
    (4, b"ftypheic", "a HEIC image", "save it as PNG or TIFF"),
    (4, b"ftypheix", "a HEIC image", "save it as PNG or TIFF"),
    (4, b"ftypmif1", "a HEIF image", "save it as PNG or TIFF"),
    (4, b"ftypavi", "an AVIF image", "save it as PNG or TIFF"),
    (4, b"ftyp", "an MP4 or QuickTime video", _FRAMES),
    (4, b"moov", "a QuickTime video", _FRAMES),
    (0, b"PK\x03\x04", "a zip archive, as .npz files are", _ARRAY),
    (0, b"\x1f\x8b", "a gzip archive", "unpack it"),
    (0, b"%PDF", "a PDF document", "export the image itself as PNG or TIFF"),
)
_RAW_FRAMES = (
    "a file of raw samples, whose size and type it does not state; read it with numpy.fromfile and give arrays"
)
_SUFFIXES = {
    **dict.fromkeys((".raw", ".bin", ".dat", ".img", ".b16", ".mraw", ".yuv"), _RAW_FRAMES),
    ".cine": f"a Phantom cine recording; {_CAMERA_SOFTWARE}",
    ".seq": f"a sequence of a camera; {_CAMERA_SOFTWARE}",
    ".spe": f"a Princeton Instruments recording; {_CAMERA_SOFTWARE}",
    ".his": f"a Hamamatsu recording; {_CAMERA_SOFTWARE}",
    **dict.fromkeys((".avi", ".mp4", ".mov", ".mkv", ".wmv", ".mpg", ".mpeg"), f"a video; {_FRAMES}"),
    **dict.fromkeys((".dng", ".cr2", ".cr3", ".nef", ".arw", ".orf", ".rw2", ".raf"), f"a raw image; {_DEVELOP}"),
    **dict.fromkeys(
        (".im7", ".imx", ".czi", ".nd2", ".lif"), "an image of a microscope or of DIC software; export TIFF"
    ),
    ".tga": f"a TGA image; {_CONVERT}",
    ".pcx": f"a PCX image; {_CONVERT}",
}


def refusal(header: bytes, path: Path) -> ImageError:
    """Return the error of a file that is not read.

    Parameters
    ----------
    header : bytes
        The first bytes of the file.
    path : Path
        Its name, which tells the format where the content does not.

    Returns
    -------
    ImageError
        To be raised.
    """
    for start, signature, name, advice in _SIGNATURES:
        if header.startswith(signature, start):
            return ImageError(f"the image format is not supported: this is {name}; {advice}.")
    guess = _SUFFIXES.get(path.suffix.lower())
    if guess is not None:
        return ImageError(f"the image format is not supported: by its name this is {guess}.")
    return ImageError(f"the image format is not supported; convert it to {_READ}.")
