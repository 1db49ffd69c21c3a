"""Exceptions and warnings of fedic; every exception is a `FedicError`.

The extension module raises these classes too, so that ``except fedic.MeshError as error: error.cells`` works for
errors of both languages.
"""

from collections.abc import Sequence

__all__ = [
    "CalibrationWarning",
    "CameraError",
    "ConfigError",
    "ConvergenceWarning",
    "FedicError",
    "ImageError",
    "MeshError",
    "OptionError",
    "QualityWarning",
    "SolveError",
]


class FedicError(Exception):
    """Base class of the exceptions of fedic.

    Parameters
    ----------
    message : str
        Description of the error, its location, and a remedy.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(message)
        self.message = message

    def __str__(self) -> str:
        return self.message


class MeshError(FedicError):
    """A mesh that cannot be used: unreadable, malformed, inverted cells, or outside the image.

    Attributes
    ----------
    cells : list of int
        Indices of the invalid cells, counted over all blocks in their order; may be empty.
    nodes : list of int
        Indices of the invalid nodes; may be empty.
    """

    def __init__(self, message: str = "", cells: Sequence[int] = (), nodes: Sequence[int] = ()) -> None:
        super().__init__(message)
        self.cells = list(cells)
        self.nodes = list(nodes)

    def __reduce__(self) -> tuple[type["MeshError"], tuple[str, list[int], list[int]]]:
        return type(self), (self.message, self.cells, self.nodes)


class ImageError(FedicError):
    """An image that cannot be used: missing, truncated, of the wrong shape or type, or flat."""


class CameraError(FedicError):
    """A camera with invalid parameters, or points it cannot see."""


class OptionError(FedicError, ValueError):
    """An argument or option that does not exist, or that has the wrong type, shape or range.

    Attributes
    ----------
    option : str
        Name of the argument; empty if it is not known.
    """

    def __init__(self, message: str = "", option: str = "") -> None:
        super().__init__(message)
        self.option = option

    def __reduce__(self) -> tuple[type["OptionError"], tuple[str, str]]:
        return type(self), (self.message, self.option)


class CalibrationWarning(UserWarning):
    """A camera is known less well than it seems: points outside the domain of its lens, a rotation of few digits."""


class ConvergenceWarning(UserWarning):
    """The iterations of a measurement ended before the displacement had come to rest; the message says what to try."""


class QualityWarning(UserWarning):
    """A result, or what it is measured with, is doubtful; the message says where, and what to do."""


class SolveError(FedicError):
    """A correlation that cannot be solved: singular system, or divergence.

    Attributes
    ----------
    nodes : list of int
        Indices of the nodes whose displacement the images do not determine; may be empty.
    """

    def __init__(self, message: str = "", nodes: Sequence[int] = ()) -> None:
        super().__init__(message)
        self.nodes = list(nodes)

    def __reduce__(self) -> tuple[type["SolveError"], tuple[str, list[int]]]:
        return type(self), (self.message, self.nodes)


class ConfigError(FedicError):
    """A configuration file that cannot be used: not TOML, an unknown key, a value of the wrong type or out of range.

    Attributes
    ----------
    key : str
        Dotted name of the invalid key, such as ``"camera.focal"``; empty for the file as a whole.
    """

    def __init__(self, message: str = "", key: str = "") -> None:
        super().__init__(message)
        self.key = key

    def __reduce__(self) -> tuple[type["ConfigError"], tuple[str, str]]:
        return type(self), (self.message, self.key)
