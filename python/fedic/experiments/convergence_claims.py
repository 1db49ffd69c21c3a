"""Claims of the convergence experiment."""

from collections.abc import Iterator

from fedic.experiments.outcome import Claim, Row

__all__ = ["claims_of", "reached"]

_ZERO_LARGE, _ZERO_SMALL = 4.0, 2.0
_LARGE_ELEMENT = 20
_PYRAMID = {"translation": (48.0, "px"), "rotation": (8.0, "degrees"), "stretch": (10.0, "%")}
_FFT = 200.0
_MOST_ITERATIONS = 6
_FINITE_DIFFERENCES = (1.3, 3.0)


def reached(rows: list[Row]) -> dict[tuple[str, str, str, int], float]:
    """Return the largest motion up to which all were found.

    Parameters
    ----------
    rows : list of dict
        Rows of one image.

    Returns
    -------
    dict
        Pixels, degrees or percent by start, motion, cell and size; 0 if the first motion was not found.
    """
    most: dict[tuple[str, str, str, int], float] = {}
    missed: set[tuple[str, str, str, int, float]] = set()
    tried = [row for row in rows if row["study"] == "basin"]
    keys = [(str(row["variant"]), str(row["motion"]), str(row["cell"]), int(row["size_px"])) for row in tried]
    for key, row in zip(keys, tried, strict=True):
        if not row["found"]:
            missed.add((*key, float(row["amount"])))
    for key, row in zip(keys, tried, strict=True):
        amount = float(row["amount"])
        most[key] = max(most.get(key, 0.0), 0.0 if (*key, amount) in missed else amount)
    return most


def claims_of(rows: list[Row]) -> list[Claim]:
    """Evaluate the claims on one image.

    Parameters
    ----------
    rows : list of dict
        Rows of one image.

    Returns
    -------
    list of Claim
        Evaluated claims.
    """
    return [*_of_starts(rows), *_of_iterations(rows)]


def _of_starts(rows: list[Row]) -> Iterator[Claim]:
    image, most = rows[0]["image"], reached(rows)

    def over(start: str, motion: str) -> dict[tuple[str, int], float]:
        return {(cell, size): far for (s, m, cell, size), far in most.items() if (s, m) == (start, motion)}

    zero = over("zero", "translation")
    large = [far for (_, size), far in zero.items() if size >= _LARGE_ELEMENT]
    small = [far for (_, size), far in zero.items() if size < _LARGE_ELEMENT]
    yield Claim(
        f"{image} image, zero: finds translations up to at least {_ZERO_LARGE:g} px with elements from "
        f"{_LARGE_ELEMENT} px, {_ZERO_SMALL:g} px with smaller ones",
        f"{min(large):g} to {max(large):g} px, smaller ones {min(small):g} px",
        min(large) >= _ZERO_LARGE and min(small) >= _ZERO_SMALL,
    )
    for motion, (least, unit) in _PYRAMID.items():
        far = over("pyramid", motion)
        yield Claim(
            f"{image} image, pyramid: finds every {motion} up to at least {least:g} {unit}, all cells and sizes",
            f"{min(far.values()):g} to {max(far.values()):g} {unit}; zero: "
            f"{min(over('zero', motion).values()):g} to {max(over('zero', motion).values()):g}",
            min(far.values()) >= least,
        )
    translations = over("fft", "translation")
    yield Claim(
        f"{image} image, fft: finds every translation up to {_FFT:g} px, all cells and sizes",
        f"{min(translations.values()):g} px",
        min(translations.values()) >= _FFT,
    )
    worse = [
        most["fft", motion, cell, size] < most["pyramid", motion, cell, size]
        for motion in ("rotation", "stretch")
        for cell, size in translations
    ]
    yield Claim(
        f"{image} image, fft: finds smaller rotations and stretches than pyramid, all cells and sizes",
        f"rotations up to {max(over('fft', 'rotation').values()):g} degrees, stretches up to "
        f"{max(over('fft', 'stretch').values()):g} %",
        all(worse),
    )


def _of_iterations(rows: list[Row]) -> Iterator[Claim]:
    image = rows[0]["image"]

    def counts(setting: str) -> list[int]:
        return [int(row["iterations"]) for row in rows if (row["study"], row["variant"]) == ("iterations", setting)]

    default = counts("default")
    yield Claim(
        f"{image} image, default: at most {_MOST_ITERATIONS} iterations from within 1 px",
        f"{min(default)} to {max(default)}",
        max(default) <= _MOST_ITERATIONS,
    )
    updated = counts('hessian="updated"')
    yield Claim(
        f'{image} image: hessian="updated" takes as many iterations as "initial" where the mesh is drawn in pixels',
        f"{min(updated)} to {max(updated)}",
        updated == default,
    )
    analytic = counts("analytic, 1e-5 px, no smoothing")
    differences = counts("finite-difference, 1e-5 px, no smoothing")
    ratios = [slow / fast for slow, fast in zip(differences, analytic, strict=True)]
    yield Claim(
        f"{image} image, tolerance 1e-5 px, no smoothing: finite-difference gradients take "
        f"{_FINITE_DIFFERENCES[0]:g} to {_FINITE_DIFFERENCES[1]:g} times the iterations of analytic ones",
        f"{min(ratios):.2f} to {max(ratios):.2f} times",
        min(ratios) >= _FINITE_DIFFERENCES[0] and max(ratios) <= _FINITE_DIFFERENCES[1],
    )
