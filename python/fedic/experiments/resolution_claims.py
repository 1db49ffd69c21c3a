"""Claims of the resolution experiment."""

from collections.abc import Iterator

from fedic.experiments.mei import Measured
from fedic.experiments.outcome import Claim

__all__ = ["claims_of"]

_LARGEST_MEI, _AIM, _PEER = 0.285, 0.25, 0.403
_NODAL_NOISE = (1.6, 1.85)
_TURNED_LOSS = 1.5
_TURNED_TRIANGLES = 0.31
_FILTER_PRICE = 1.1
_AVERAGED_NOISE, _AVERAGED_PERIOD = 0.98, 1.03
_INDIFFERENT = 0.03
_OVERSHOOT = 1.2
_INDIFFERENT_WAYS = (
    "rule edges",
    "rule diameter",
    "density 2",
    "pixel quadrature",
    "bspline3",
    "bspline3, rule edges",
    "smoothing 0.4 px",
    "no brightness correction",
    "brightness by element",
    "finite-difference gradient",
    "there and back",
)
_DIRECT = {
    "8 px nodes to quad": "quad",
    "8 px nodes to quad8": "quad8",
    "8 px nodes to quad9": "quad9",
}
_HIGHEST = "8 px nodes to serendipity of degree 6"


def claims_of(found: list[Measured]) -> list[Claim]:
    """Evaluate the claims on one star.

    Parameters
    ----------
    found : list of Measured
        Measurements of one star; claims on missing variants are left out.

    Returns
    -------
    list of Claim
        Evaluated claims.
    """
    return [*_of_sizes(found), *_of_directions(found), *_of_ways(found), *_of_nodes(found)]


def _named(found: list[Measured], variant: str) -> dict[tuple[str, int], Measured]:
    return {(each.cell, each.size): each for each in found if each.variant == variant}


def _of_sizes(found: list[Measured]) -> Iterator[Claim]:
    star, plain = found[0].star, _named(found, "plain")
    best = min(plain.values(), key=lambda each: each.merit.kept_mei)
    measured = (
        f"{best.merit.mei:.3f}: {best.cell} of {best.size} px, {best.merit.noise:.4f} px x {best.merit.period:.1f} px"
    )
    for text, limit in (("MEI at most", _LARGEST_MEI), ("aim: MEI at most", _AIM)):
        yield Claim(
            f"{star} star, plain, best cell and size: {text} {limit:g}", measured, bool(best.merit.mei <= limit)
        )
    if star == "real":
        yield Claim(
            f"{star} star, plain, every cell and size: MEI below the best of pyvale, {_PEER:g}",
            f"at most {max(each.merit.mei for each in plain.values()):.3f}",
            all(each.merit.mei < _PEER for each in plain.values()),
        )
    peaks = [float(each.merit.amplitudes.max()) for each in plain.values()]
    yield Claim(
        f"{star} star, plain: on the line of nodes the amplitude overshoots, to {_OVERSHOOT:g} or more at some period, "
        "with every cell and size",
        f"{min(peaks):.2f} to {max(peaks):.2f} times the true one",
        min(peaks) >= _OVERSHOOT,
    )
    gains = [
        plain["quad8", size].merit.mei / each.merit.mei
        for (cell, size), each in plain.items()
        if cell == "quad9" and ("quad8", size) in plain
    ]
    yield Claim(
        f"{star} star, plain: quad8 below quad9 at every size",
        f"{min(gains):.2f} to {max(gains):.2f} times its MEI",
        max(gains) < 1.0,
    )


def _of_directions(found: list[Measured]) -> Iterator[Claim]:
    star, plain = found[0].star, _named(found, "plain")
    turned = {(each.cell, each.size): each for each in found if each.group == "turned"}
    for key, each in turned.items():
        cell, size = key
        straight = plain[key].merit
        if cell == "quad8":
            loss = each.merit.mei / straight.mei
            yield Claim(
                f"{star} star: quad8 of {size} px owes its figure to edges along the wave: turned by 45 degrees "
                f"its MEI is at least {_TURNED_LOSS:g} times as large",
                f"{each.merit.mei:.3f} against {straight.mei:.3f}, {loss:.2f} times",
                bool(loss >= _TURNED_LOSS),
            )
        if cell == "triangle6":
            yield Claim(
                f"{star} star: triangle6 of {size} px keeps its figure when turned by 45 degrees: MEI at most "
                f"{_TURNED_TRIANGLES:g} both ways",
                f"{straight.kept_mei:.3f}, turned {each.merit.kept_mei:.3f}",
                bool(max(straight.kept_mei, each.merit.kept_mei) <= _TURNED_TRIANGLES),
            )


def _of_ways(found: list[Measured]) -> Iterator[Claim]:
    star, plain = found[0].star, _named(found, "plain")
    default = _named(found, "default")
    if not default:
        return
    prices = [each.merit.mei / plain[key].merit.mei for key, each in default.items()]
    yield Claim(
        f"{star} star: the default's smoothing of 0.8 px costs at most {100 * (_FILTER_PRICE - 1):.0f} % of MEI",
        ", ".join(f"{cell} {size} px: {price:.2f} times" for (cell, size), price in zip(default, prices, strict=True)),
        max(prices) <= _FILTER_PRICE,
    )
    tried = [each for each in found if each.variant in _INDIFFERENT_WAYS and (each.cell, each.size) in plain]
    changes = [each.merit.mei / plain[each.cell, each.size].merit.mei for each in tried]
    yield Claim(
        f"{star} star: each of these changes MEI by at most {100 * _INDIFFERENT:.0f} %: "
        + ", ".join(dict.fromkeys(each.variant for each in tried)),
        f"{min(changes):.3f} to {max(changes):.3f} times",
        max(abs(change - 1.0) for change in changes) <= _INDIFFERENT,
    )
    averaged = [each for each in found if "moved along" in each.variant]
    noise = [each.merit.noise / plain[each.cell, each.size].merit.noise for each in averaged]
    period = [each.merit.period / plain[each.cell, each.size].merit.period for each in averaged]
    yield Claim(
        f"{star} star: the mean over meshes moved along the crest has at most {_AVERAGED_NOISE:g} times the noise, its "
        f"period within {100 * (_AVERAGED_PERIOD - 1):.0f} %",
        f"noise {min(noise):.3f} to {max(noise):.3f} times, period {min(period):.3f} to {max(period):.3f} times",
        max(noise) <= _AVERAGED_NOISE and max(period) <= _AVERAGED_PERIOD,
    )


def _of_nodes(found: list[Measured]) -> Iterator[Claim]:
    star, plain = found[0].star, _named(found, "plain")
    for key, each in _named(found, "nodes alone").items():
        ratio = each.merit.noise / plain[key].merit.noise
        yield Claim(
            f"{star} star: the nodes of {key[0]} have {_NODAL_NOISE[0]:g} to {_NODAL_NOISE[1]:g} times the noise of "
            "the field",
            f"{ratio:.2f} times; MEI {each.merit.mei:.2f} for who reads nodes",
            bool(_NODAL_NOISE[0] <= ratio <= _NODAL_NOISE[1]),
        )
    pairs = [
        (each.merit.mei, plain[_DIRECT[each.variant], each.size].merit.mei)
        for each in found
        if each.variant in _DIRECT and (_DIRECT[each.variant], each.size) in plain
    ]
    if pairs:
        yield Claim(
            f"{star} star: to measure on quad, quad8 or quad9 gives less than to reduce the nodes of a fine mesh",
            "MEI " + ", ".join(f"{direct:.3f} against {reduced:.3f}" for reduced, direct in pairs),
            all(direct < reduced for reduced, direct in pairs),
        )
    for each in _named(found, _HIGHEST).values():
        merit = each.merit
        yield Claim(
            f"{star} star: the MEI of a field of degree 6 is no resolution: its amplitude falls below 0.9 again at "
            "longer periods",
            f"MEI {merit.mei:.3f} by the first period, {merit.period:.1f} px; above 0.9 for good only from "
            f"{merit.kept_period:.1f} px",
            not merit.kept_period <= merit.period,
        )
