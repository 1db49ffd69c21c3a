"""Text of files as editors and spreadsheets write it: UTF-8 or UTF-16, with a byte order mark or without."""

import codecs

__all__ = ["decoded_text"]

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks; that of UTF-32 begins like that of UTF-16."""


def decoded_text(data: bytes) -> str:
    """Decode text, without the byte order mark that says how; UTF-8 if there is none.

    Parameters
    ----------
    data : bytes
        Content of the file.

    Returns
    -------
    str
        The text.

    Raises
    ------
    UnicodeDecodeError
        If the bytes are not text in this encoding.
    """
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return data[len(mark) :].decode(encoding)
    return data.decode("utf-8")
