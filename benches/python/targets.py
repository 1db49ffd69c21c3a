"""What a comparison says of the targets that the project set itself."""

from collections.abc import Iterator
from typing import Any

from table import nanoseconds

Row = dict[str, Any]


def verdicts(rows: list[Row]) -> Iterator[str]:
    """Yield a line per target whose rows were measured, at the largest number of threads; the defaults of fedic."""
    done = [row for row in rows if "said" in row]
    if not done:
        return
    threads = max(row["threads"] for row in done)
    done = [row for row in done if row["threads"] == threads]

    def found(package: str, megapixels: float, element: int = 20) -> Row | None:
        wanted = (package, megapixels, element)
        return next((row for row in done if (row["package"], row["megapixels"], row["element_px"]) == wanted), None)

    if five := found("fedic", 5.0):
        for peer, times in (("pyxel-dic", 200.0), ("pyxel-dic full", 200.0), ("pyvale", 8.0)):
            if other := found(peer, 5.0):
                yield _least(f"5 Mpx, times faster than {peer}", other["seconds"] / five["seconds"], times)
        yield _most("5 Mpx, peak memory (MB)", five["peak_MB"], 250.0)
        series = five["series"]
        yield _most("5 Mpx, next frame of a series (s)", series["frame"], 0.12)
        yield _most("5 Mpx, part of it outside the iterations", series["outside"] / series["frame"], 0.30)
    large = found("fedic", 150.0)
    if large:
        pixels = large["width"] * large["height"]
        yield _most("150 Mpx, peak memory (bytes per pixel)", large["peak_MB"] * 1e6 / pixels, 20.0)
    same = [row for row in done if row["package"] == "fedic" and row["element_px"] == 20 and row["megapixels"] >= 1.0]
    sizes = [row["megapixels"] for row in same]
    each = [value for row in same if (value := nanoseconds(row))]
    if len(each) > 1:
        title = f"{min(sizes):g} to {max(sizes):g} Mpx, spread of the time per point and iteration, largest / smallest"
        yield _most(title, max(each) / min(each), 1.15)
    if million := found("fedic", 150.0, 17):
        yield _most(f"150 Mpx, {million['said']['unknowns']:.3g} unknowns (s)", million["seconds"], 60.0)


def _most(title: str, value: float, bound: float) -> str:
    return f"{'met   ' if value <= bound else 'MISSED'} {title}: {value:.3g}, at most {bound:g}"


def _least(title: str, value: float, bound: float) -> str:
    return f"{'met   ' if value >= bound else 'MISSED'} {title}: {value:.3g}, at least {bound:g}"
