"""Machine data at the times of the frames, and the offset between the clocks."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

import fedic
from fedic.probes import join, table
from scenes.fields import Fields, result_of

MESH = fedic.rectangle_mesh((0, 0, 20, 10), 10)
STILL = result_of(MESH, np.zeros(MESH.points.shape))


def series(times: Any) -> Fields:
    return Fields(MESH, [STILL] * len(times), times=list(times))


def record(times: Any, **channels: Any) -> pd.DataFrame:
    return pd.DataFrame({"Time (s)": np.asarray(times, dtype=float), **channels})


def test_channels_are_linear_between_rows() -> None:
    machine = record([10, 11, 12, 13], **{"Load (kN)": [0.0, 10.0, 30.0, 20.0], "Stroke (mm)": [0, 1, 2, 3]})
    found = join(series([0.0, 0.25, 1.5, 3.0]), machine, time="Time", offset=-10.0)
    assert list(found.columns) == ["machine_time", "Load", "Stroke"]
    assert found.index.name == "frame"
    np.testing.assert_allclose(found["Load"], [0.0, 2.5, 20.0, 20.0])
    np.testing.assert_allclose(found["machine_time"], [10.0, 10.25, 11.5, 13.0])
    assert found.attrs["units"] == {"Load": "kN", "Stroke": "mm"}
    assert found.attrs["offset"] == -10.0


def test_stress_against_strain_in_three_lines(tmp_path: Path) -> None:
    path = tmp_path / "machine.csv"
    path.write_text("Time (ms);Force (kN)\n0;0,0\n1000;1,0\n2000;2,0\n")
    strained = [result_of(MESH, MESH.points * [0.0, 0.001 * k]) for k in range(3)]
    frames = Fields(MESH, strained, times=[0.0, 1.0, 2.0])
    curve = table(frames, "eyy", measure="small").join(join(frames, path, time="Time", columns=["Force"]))
    stress = 1000 * curve["Force"] / 25.0
    np.testing.assert_allclose(stress / np.maximum(curve["eyy"], 1e-12), [0.0, 40000.0, 40000.0], rtol=1e-9)


def test_frames_outside_in_gaps_and_beside_missing_cells_are_nan_with_a_warning() -> None:
    times = [0.0, 1.0, 2.0, 3.0, 4.0, 15.0, 16.0, 17.0]
    machine = record(times, Load=[0, 1, 2, np.nan, 4, 15, 16, 17], Stroke=times)
    frames = series([-0.5, 0.5, 2.0, 2.5, 3.0, 4.0, 9.0, 15.0, 17.1, np.nan])
    with pytest.warns(fedic.QualityWarning) as caught:
        found = join(frames, machine, time="Time")
    np.testing.assert_array_equal(found["Load"], [np.nan, 0.5, 2, np.nan, np.nan, 4, np.nan, 15, np.nan, np.nan])
    np.testing.assert_array_equal(found["Stroke"], [np.nan, 0.5, 2, 2.5, 3, 4, np.nan, 15, np.nan, np.nan])
    message = str(caught[0].message)
    for part in (
        "image_9.tif have no time",
        "image_0.tif, image_8.tif lie outside the record, which reaches from 0 to 17 s",
        "image_6.tif lie in a step of the record longer than 5 s",
        "image_3.tif, image_4.tif lie beside a cell of 'Load' without a number, the first in row 3",
    ):
        assert part in message
    with pytest.warns(fedic.QualityWarning):
        wide = join(frames, machine, time="Time", gap=20.0)
    assert wide["Stroke"][6] == pytest.approx(9.0)


def test_a_gap_is_five_steps_and_a_tenth_of_the_time_between_frames() -> None:
    machine = record([*np.arange(0, 5, 0.01), *np.arange(5.08, 10, 0.01)], Load=np.ones(992))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not join(series(np.arange(0.0, 9.5, 1.007)), machine, time="Time")["Load"].isna().any()
    with pytest.warns(fedic.QualityWarning, match="image_20.tif lie in a step"):
        join(series(np.arange(0.03, 9.5, 0.25)), machine, time="Time")


def test_many_frames_are_counted() -> None:
    with pytest.warns(fedic.QualityWarning, match=r"image_2\.tif, .* image_6\.tif and 13 more lie"):
        join(series(np.arange(20.0)), record([0, 1], Load=[0, 1]), time="Time")


@pytest.mark.parametrize(
    ("times", "options", "message"),
    [
        ([np.nan, np.nan], {}, "no frame of the series has a time"),
        (
            [100.0, 101.0],
            {},
            "the frames are at 100 to 101 s, and its record reaches from 0 to 3",
        ),
        ([100.0, 101.0], {}, "such as 100 if both begin together"),
        ([0.0, 1.0], {"offset": "auto"}, r'offset="auto" needs correlate'),
        ([0.0, 1.0], {"correlate": ("Load", [0, 1])}, r'offset="auto" needs correlate'),
        ([0.0, 1.0], {"offset": "later"}, "offset='later': give seconds"),
        ([0.0, 1.0], {"offset": np.nan}, "offset=nan: give seconds"),
        ([0.0, 1.0], {"gap": 0.0}, "gap=0.0: give the longest step"),
        ([0.0, 1.0], {"columns": ["Force"]}, "has no column 'Force'; its columns are 'Load'"),
        ([0.0, 1.0], {"time": "Clock"}, "has no column 'Clock'; its columns are 'Time', 'Load'"),
        (
            [0.0, 1.0],
            {"offset": "auto", "correlate": ("Load", [0, 1, 2])},
            r"has shape \(3,\); give one value for",
        ),
        ([0.0, 1.0], {"offset": "auto", "correlate": ("Load", [0, 1])}, "takes 6 frames with a time and a signal"),
    ],
)
def test_bad_arguments_are_refused(times: Any, options: dict[str, Any], message: str) -> None:
    machine = record([0, 1, 2, 3], Load=[0, 1, 2, 3])
    with pytest.raises(fedic.OptionError, match=message):
        join(series(times), machine, **{"time": "Time", **options})


def load(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a test of 60 s: rest, loading with a curve, hold, unloading, rest."""
    ramp = np.interp(t, [0, 5, 25, 32, 45, 60], [0, 0, 8, 8, 1, 1])
    return np.asarray(ramp + 0.4 * np.sin(np.clip(t - 5, 0, 20) / 3))


@pytest.mark.parametrize("rate", [100.0, 2.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("faults", [False, True])
def test_the_offset_is_found_within_its_standard_deviation(rate: float, sign: float, faults: bool) -> None:
    """Of 20 draws, with frames each second and 1 % noise in both signals."""
    rng, true, times = np.random.default_rng(3), 417.3, np.arange(0, 60, 1 / rate)
    pulls, found = [], []
    for _ in range(20):
        machine = record(times, Load=load(times) + rng.normal(0, 0.05, len(times)))
        moments = np.arange(-3.0, 57.0) + rng.uniform(-0.2, 0.2, 60) + true
        signal = sign * 2e-4 * (load(moments - true) + rng.normal(0, 0.08, 60)) + 1e-3
        if faults:
            signal[[12, 40]] += 0.05
            signal[20] = np.nan
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=".*frames without machine data")
            joined = join(series(moments), machine, time="Time", offset="auto", correlate=("Load", signal))
        found.append(joined.attrs["offset"] - true)
        pulls.append(found[-1] / joined.attrs["offset_std"])
    assert np.abs(found).max() < 0.3
    assert np.sqrt(np.mean(np.square(found))) < 0.1
    assert 0.6 < np.sqrt(np.mean(np.square(pulls))) < 1.6


def test_the_offset_is_exact_without_noise() -> None:
    times, moments = np.arange(0, 60, 0.1), np.arange(2.0, 58.0)
    joined = join(
        series(moments - 7.77), record(times, Load=load(times)), time="Time", offset="auto",
        correlate=("Load", 3 * load(moments)),
    )  # fmt: skip
    assert joined.attrs["offset"] == pytest.approx(-7.77, abs=0.01)
    np.testing.assert_allclose(joined["Load"], load(moments), atol=0.05)


def test_signals_that_do_not_determine_the_offset_are_refused() -> None:
    times, moments = np.arange(0, 60, 0.1), np.arange(10.0, 50.0)
    rng = np.random.default_rng(0)
    with pytest.raises(fedic.OptionError, match="the signals do not determine the offset"):
        join(
            series(moments), record(times, Load=2 * times), time="Time", offset="auto",
            correlate=("Load", moments + rng.normal(0, 0.1, 40)),
        )  # fmt: skip
    with pytest.raises(fedic.OptionError, match="the signals do not determine the offset"):
        join(
            series(moments), record(times, Load=load(times)), time="Time", offset="auto",
            correlate=("Load", rng.normal(0, 0.1, 40)),
        )  # fmt: skip


def test_a_signal_that_repeats_is_reported() -> None:
    times, moments = np.arange(0, 60, 0.05), np.arange(0.0, 25.0, 0.5)
    machine = record(times, Load=np.sin(2 * np.pi * times / 10))
    with pytest.warns(fedic.QualityWarning, match="is not the only one: .* explains the signal almost as well"):
        join(
            series(moments), machine, time="Time", offset="auto",
            correlate=("Load", np.sin(2 * np.pi * (moments + 3.3) / 10)),
        )  # fmt: skip
