"""Fig. 16 of the paper: the error map of a large shift with the lens in the projector, and the rings without it."""

import numpy as np

from fedic._core import Mesh
from fedic._internal.types import CellName, Floats
from fedic.demo.measurement import Measurement
from fedic.demo.scene import ImagePair, Scene
from fedic.experiments.lens import SCENE, ignored_distortion, rounding_floor, textures
from fedic.experiments.lens_errors import average_errors, measure, rounding_bound
from fedic.experiments.option_sets import DEFAULT, PAPER, UNFILTERED, OptionSet
from fedic.experiments.outcome import Claim, Outcome, Request, Row
from fedic.experiments.reference_images import window_mesh
from fedic.plotting.error_maps import draw_error_maps

__all__ = ["run"]

SETTINGS = (PAPER, UNFILTERED, DEFAULT)
SIZE = 20
CELL: CellName = "quad"
TEXTURES, QUICK_TEXTURES = 6, 3
LARGEST_BIAS, NEAR_BOUND = 1e-4, 0.1
NEAR_THEORY = 0.15
LEAST_CORRELATION = 0.99


def run(request: Request) -> Outcome:
    """Measure the pairs of images with and without the lens, in each setting, in 8 and in 16 bits.

    Parameters
    ----------
    request : Request
        A quick run has fewer textures.

    Returns
    -------
    Outcome
        Rows over setting, depth and quadrature; maps of the first texture in the default and the paper's setting.
    """
    scene = SCENE
    fine = textures(QUICK_TEXTURES if request.quick else TEXTURES)
    coarse = [pair.rounded() for pair in fine]
    mesh = window_mesh(scene.window, SIZE, CELL)
    expected = ignored_distortion(scene, mesh)
    bound = rounding_bound(scene, coarse[0], mesh)
    rows: list[Row] = []
    figures = {}
    for done, setting in enumerate(SETTINGS):
        request.report(done / len(SETTINGS))
        for bits, pairs in ((8, coarse), (16, fine[:1])):
            found = {kind: _measure(scene, pairs, mesh, setting, kind) for kind in ("mesh", "pixel")}
            for kind, each in found.items():
                rows.append(
                    {
                        "setting": setting.name,
                        "quadrature": kind,
                        "bits": bits,
                        **average_errors(each).as_row(),
                        "bound_px": bound if bits == 8 else np.nan,
                        **_likeness(each, expected),
                    }
                )
            if bits == 8 and setting in (DEFAULT, PAPER):
                figures["" if setting is DEFAULT else setting.name] = draw_error_maps(
                    [found["mesh"][0].error_map, found["pixel"][0].error_map], expected
                )
    floor = float(rounding_floor(scene, coarse[0]).max())
    return Outcome(
        "fig16",
        "The rings of the lens in the error of a large shift",
        "A speckled plane seen by the paper's camera (Sect. 5.2: 1388 x 1036 px, 50 mm lens, k1 = -0.0321253) moves "
        f"by (-400, -200) px. A mesh of 300 x 300 px, quadrilaterals of {SIZE} px, measures the motion in millimetres "
        "through the calibrated camera (mesh quadrature, left) and in pixels as if there were no lens (pixel "
        "quadrature, right); the maps show the error of the vertical displacement of one texture, the first in the "
        "default setting, the second in the paper's. The images are rounded to 8 bits as the paper's. The rounding "
        "noise does not average out over one mesh: the mean error of one pair is a draw of standard deviation "
        f"{floor:.1e} px, whatever the method. The same images in 16 bits show the error without rounding. *Theory* "
        "is the distortion where a node arrives less the distortion where it was; iso-lines of the measured error "
        "follow it. The bound is that of Cramér and Rao for rounding noise of 1/sqrt(12) grey levels in each image, "
        "from the first 8-bit reference image without smoothing; compared are root mean squares over the nodes and "
        "both components.",
        rows,
        _claims(rows, expected, floor),
        dict(sorted(figures.items())),
    )


def _measure(scene: Scene, pairs: list[ImagePair], mesh: Mesh, setting: OptionSet, kind: str) -> list[Measurement]:
    rule = setting.quadrature(kind)
    return [measure(scene, pair, mesh, setting, rule, lens=kind == "mesh") for pair in pairs]


def _likeness(found: list[Measurement], expected: Floats) -> Row:
    """Compare the errors with those that the lens is to cause, averaged over the textures."""
    correlations = [[np.corrcoef(each.errors[:, k], expected[:, k])[0, 1] for k in (0, 1)] for each in found]
    rest = [np.sqrt(np.mean(np.var(each.errors - expected, axis=0))) for each in found]
    u, v = np.mean(correlations, axis=0)
    return {"correlation_u": float(u), "correlation_v": float(v), "std_from_theory_px": float(np.mean(rest))}


def _row(rows: list[Row], setting: OptionSet, kind: str, bits: int) -> Row:
    return next(row for row in rows if (row["setting"], row["quadrature"], row["bits"]) == (setting.name, kind, bits))


def _claims(rows: list[Row], expected: Floats, floor: float) -> list[Claim]:
    claims = []
    for setting in SETTINGS:
        lens, fine = _row(rows, setting, "mesh", 8), _row(rows, setting, "mesh", 16)
        ratio = float(lens["std_px"]) / float(lens["bound_px"])
        claims += [
            Claim(
                f"{setting.name}, with the lens: mean |bias| at most {LARGEST_BIAS:g} px along u and v",
                f"{_bias(lens)} px; {_bias(fine)} px in 16 bits (floor of rounding {floor:.1e} px)",
                max(float(lens["bias_u_px"]), float(lens["bias_v_px"])) <= LARGEST_BIAS,
            ),
            Claim(
                f"{setting.name}, with the lens: standard deviation within {100 * NEAR_BOUND:.0f} % of the bound of "
                "rounding",
                f"{ratio:.3f} times {float(lens['bound_px']):.2e} px",
                abs(ratio - 1.0) <= NEAR_BOUND,
            ),
        ]
    mean = np.abs(expected.mean(axis=0))
    for setting in SETTINGS:
        ignored, fine = _row(rows, setting, "pixel", 8), _row(rows, setting, "pixel", 16)
        found = np.array([float(ignored["bias_u_px"]), float(ignored["bias_v_px"])])
        correlation = min(float(fine["correlation_u"]), float(fine["correlation_v"]))
        claims += [
            Claim(
                f"{setting.name}, lens ignored: bias within {100 * NEAR_THEORY:.0f} % of the mean distortion, "
                f"({mean[0]:.4f}, {mean[1]:.4f}) px",
                f"({found[0]:.4f}, {found[1]:.4f}) px",
                bool((np.abs(found / mean - 1.0) <= NEAR_THEORY).all()),
            ),
            Claim(
                f"{setting.name}, lens ignored: the error is that of the lens, correlation of each component at least "
                f"{LEAST_CORRELATION:g} in 16 bits",
                f"{correlation:.6f} (in 8 bits, where rounding hides the rest, {float(ignored['correlation_u']):.3f} "
                f"along u, {float(ignored['correlation_v']):.3f} along v)",
                correlation >= LEAST_CORRELATION,
            ),
        ]
    ignored = _row(rows, DEFAULT, "pixel", 8)
    rest = float(ignored["std_from_theory_px"]) / float(ignored["bound_px"])
    claims.append(
        Claim(
            "default, lens ignored: what differs from the theory is rounding, standard deviation within "
            f"{100 * NEAR_BOUND:.0f} % of the bound",
            f"{rest:.3f} times",
            abs(rest - 1.0) <= NEAR_BOUND,
        )
    )
    return claims


def _bias(row: Row) -> str:
    return f"({float(row['bias_u_px']):.1e}, {float(row['bias_v_px']):.1e})"
