"""Series of ParaView: a ``.pvd`` file, and one ``.vtu`` file a frame beside it."""

import math
from pathlib import Path
from xml.sax.saxutils import quoteattr

from fedic.io.atomic import atomic_path
from fedic.io.exports.fields import measured_frames
from fedic.probes.series import Series
from fedic.results.strains import StrainMeasure

__all__ = ["write_pvd"]


def write_pvd(path: Path, series: Series, measure: StrainMeasure) -> None:
    """Write the measured frames for ParaView.

    Parameters
    ----------
    path : Path
        The ``.pvd`` file. The frames are files of the same name with ``_`` and their index; each is written whole, and
        the ``.pvd`` file is the last.
    series : Series
        The frames. If the time of one is not known, the indices are the times.
    measure : {"green-lagrange", "hencky", "small"}
        Strain measure.
    """
    frames = measured_frames(series)
    digits = max(4, len(str(max(frame.index for frame in frames))))
    has_times = all(math.isfinite(frame.time) for frame in frames)
    entries = []
    for frame in frames:
        file = path.with_name(f"{path.stem}_{frame.index:0{digits}d}.vtu")
        series.result(frame.index).write(file, measure=measure)
        time = float(frame.time if has_times else frame.index)
        entries.append(f'    <DataSet timestep="{time!r}" part="0" file={quoteattr(file.name)}/>\n')
    with atomic_path(path) as temporary:
        temporary.write_text(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
            + "".join(entries)
            + "  </Collection>\n</VTKFile>\n",
            encoding="utf-8",
        )
