"""A plain writer of grey PNG files, right or wrong."""

import struct
import zlib

__all__ = ["png"]


def png(width: int, height: int, rows: bytes, *, bits: int = 8, animation: bytes = b"") -> bytes:
    """Return a PNG file of rows that each begin with their filter, and of the chunk of an animation."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0))
    frames = chunk(b"acTL", animation) if animation else b""
    return b"\x89PNG\r\n\x1a\n" + header + frames + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
