"""Seeded mutations of the bytes and of the text of a file."""

import random
import zlib
from collections.abc import Callable

__all__ = ["mutated"]

_NUMBERS = (b"-1", b"0", b"1e400", b"nan", b"99999999999999999999", b"2147483648", b"-2147483649", b"1e-320", b"")
_BYTES = (0, 1, 127, 128, 254, 255)
_PNG = b"\x89PNG\r\n\x1a\n"


def mutated(data: bytes, draw: random.Random) -> bytes:
    """Return `data` after one to four mutations, checksums of PNG chunks mended most of the time."""
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        data = draw.choice(_BINARY if draw.random() < 0.6 or not _is_text(data) else _TEXT)(data, draw)
    return _with_checksums(data) if data.startswith(_PNG) and draw.random() < 0.8 else data


def _is_text(data: bytes) -> bool:
    return b"\0" not in data[:512]


def _flip(data: bytes, draw: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 8))):
        if changed:
            changed[_place(changed, draw)] ^= 1 << draw.randrange(8)
    return bytes(changed)


def _overwrite(data: bytes, draw: random.Random) -> bytes:
    changed = bytearray(data)
    if changed:
        place = _place(changed, draw)
        changed[place : place + draw.choice((1, 2, 4, 8))] = bytes([draw.choice(_BYTES)]) * draw.choice((1, 2, 4, 8))
    return bytes(changed)


def _cut(data: bytes, draw: random.Random) -> bytes:
    return data[: draw.randrange(len(data) + 1)]


def _remove(data: bytes, draw: random.Random) -> bytes:
    place = draw.randrange(len(data) + 1)
    return data[:place] + data[place + draw.choice((1, 2, 4, 16, 64)) :]


def _repeat(data: bytes, draw: random.Random) -> bytes:
    place, length = draw.randrange(len(data) + 1), draw.choice((1, 4, 16, 64))
    return data[:place] + data[place : place + length] * draw.choice((2, 3, 50)) + data[place + length :]


def _swap(data: bytes, draw: random.Random) -> bytes:
    first, second = sorted(draw.randrange(len(data) + 1) for _ in range(2))
    return data[first:second] + data[:first] + data[second:]


def _place(data: bytearray, draw: random.Random) -> int:
    # Headers hold the sizes and the offsets.
    return draw.randrange(min(len(data), 256)) if draw.random() < 0.5 else draw.randrange(len(data))


def _number(data: bytes, draw: random.Random) -> bytes:
    words = _words(data)
    places = [index for index, word in enumerate(words) if word[:1] in b"+-.0123456789" and word]
    if places:
        words[draw.choice(places)] = draw.choice(_NUMBERS)
    return b"".join(words)


def _line(data: bytes, draw: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    if lines:
        first, second = draw.randrange(len(lines)), draw.randrange(len(lines))
        action = draw.randrange(3)
        if action == 0:
            del lines[first]
        elif action == 1:
            lines.insert(first, lines[second])
        else:
            lines[first], lines[second] = lines[second], lines[first]
    return b"".join(lines)


def _word(data: bytes, draw: random.Random) -> bytes:
    words = _words(data)
    words[draw.randrange(len(words))] = draw.choice(
        (b"", b"x", b"\xff", b"*", b"{", b"]", b'"', b"\n", draw.choice(words))
    )
    return b"".join(words)


def _words(data: bytes) -> list[bytes]:
    words, word = [], bytearray()
    for byte in data:
        if byte in b" ,;=<>[](){}:\n\r\t\"'":
            words += [bytes(word), bytes([byte])]
            word.clear()
        else:
            word.append(byte)
    return [*words, bytes(word)]


def _with_checksums(data: bytes) -> bytes:
    changed, place = bytearray(data), len(_PNG)
    while place + 12 <= len(changed):
        end = place + 8 + int.from_bytes(changed[place : place + 4], "big")
        if end + 4 > len(changed):
            break
        changed[end : end + 4] = zlib.crc32(changed[place + 4 : end]).to_bytes(4, "big")
        place = end + 4
    return bytes(changed)


_Mutation = Callable[[bytes, random.Random], bytes]
_BINARY: tuple[_Mutation, ...] = (_flip, _flip, _overwrite, _overwrite, _cut, _remove, _repeat, _swap)
_TEXT: tuple[_Mutation, ...] = (_number, _number, _line, _word)
