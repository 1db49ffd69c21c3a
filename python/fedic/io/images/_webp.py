"""WebP."""

from fedic._internal.types import Image
from fedic.errors import ImageError
from fedic.io.images._levels import luminance

__all__ = ["decode_webp"]

_EXTENDED = b"VP8X"
_ANIMATED = 0x02


def decode_webp(data: bytes) -> Image:
    """Decode a WebP file.

    Parameters
    ----------
    data : bytes
        The file; its format allows at most 16383 x 16383 px.

    Returns
    -------
    ndarray of uint8, shape (height, width)
        Its grey levels.

    Raises
    ------
    ImageError
        If it is damaged or animated.
    """
    import imagecodecs

    if data[12:16] == _EXTENDED and len(data) > 20 and data[20] & _ANIMATED:
        raise ImageError("this is an animated WebP file; save each of its frames in its own file.")
    return luminance(imagecodecs.webp_decode(data, hasalpha=True))
