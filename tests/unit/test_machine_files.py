"""Files of testing machines: separators, decimals, headings, units, and faults."""

import contextlib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fedic
from fedic.probes.machine.record import read_record

FILES = {
    "instron": '"Specimen 1"\n"Width";"12.5"\n\n"Time","Extension","Load"\n"(s)","(mm)","(kN)"\n\n'
    '"0.000","0.10","1.5"\n"0.500","0.20","2.5"\n"1.000","0.30","3.5"\n',
    "zwick": '"Prüfzeit";"Standardweg";"Standardkraft"\n"s";"mm";"kN"\n0,00;0,1;1,5\n0,50;0,2;2,5\n1,00;0,3;3,5\n',
    "mts": "MTS793|MPT|ENU|1|2|/|.|:|1|0|0|A\n\nData Header:\t\tTime:\t12.5\tSec\t9/9/2020 3:04:05 PM\n"
    "Data Acquisition: Timed\n\nTime\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n"
    "0\t0.1\t1.5\n0.5\t0.2\t2.5\n1\t0.3\t3.5\n",
    "trailing separators": "Time [s];Weg [mm];Kraft [kN];\n0;0,1;1,5;\n0,5;0,2;2,5;\n1;0,3;3,5;\n",
    "slashes": "Zeit / s;Weg / mm;Kraft / kN\n0;0,1;1,5\n0,5;0,2;2,5\n1;0,3;3,5\n",
    "milliseconds": "Time (ms),Disp (mm),Load (kN)\n0,0.1,1.5\n500,0.2,2.5\n1000,0.3,3.5\nEnd of test\n",
    "minutes": "Time,Disp,Load\nmin,mm,kN\n0,0.1,1.5\n0.00833333333333333,0.2,2.5\n0.0166666666666667,0.3,3.5\n",
    "quoted decimal commas": 'Time (s),Disp (mm),Load (kN)\n"0,0","0,1","1,5"\n"0,5","0,2","2,5"\n"1,0","0,3","3,5"\n',
    "date-times": "Moment;Disp (mm);Load (kN)\n01.03.2026 14:05:59;0,1;1,5\n01.03.2026 14:05:59,5;0,2;2,5\n"
    "01.03.2026 14:06:00;0,3;3,5\n",
    "iso": "Moment,Disp (mm),Load (kN)\n2026-03-01T23:59:59.5Z,0.1,1.5\n2026-03-02T00:00:00Z,0.2,2.5\n"
    "2026-03-02T00:00:00.5Z,0.3,3.5\n",
    "clock": "Moment,Disp (mm),Load (kN)\n2:05:59.0 PM,0.1,1.5\n2:05:59.5 PM,0.2,2.5\n2:06:00.0 PM,0.3,3.5\n",
    "hours": "Time (hh:mm:ss);Disp (mm);Load (kN)\n23:59:59,5;0,1;1,5\n24:00:00;0,2;2,5\n24:00:00,5;0,3;3,5\n",
    "text columns": "Time (s),Status,Disp (mm),Load (kN)\n0,ok,0.1,1.5\n0.5,ok,0.2,2.5\n1,hold,0.3,3.5\n",
}


def written(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "machine.csv"
    path.write_text(text, encoding=encoding)
    return path


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_files_of_machines_are_read(tmp_path: Path, name: str, encoding: str) -> None:
    path = written(tmp_path, FILES[name], encoding)
    time = FILES[name].split("Acquisition: Timed")[-1].strip("\n").replace('"', "")
    clock = next(each for each in ("Prüfzeit", "Zeit", "Moment", "Time") if each in time)
    record = read_record(path, clock)
    np.testing.assert_allclose(record.times, [0.0, 0.5, 1.0], atol=1e-9)
    displacement, load = record.channels
    np.testing.assert_allclose(record.channels[displacement], [0.1, 0.2, 0.3])
    np.testing.assert_allclose(record.channels[load], [1.5, 2.5, 3.5])
    assert list(record.units.values()) == ["mm", "kN"]


def test_columns_are_found_with_or_without_their_unit(tmp_path: Path) -> None:
    path = written(tmp_path, FILES["milliseconds"])
    for name in ("Time", "time", "Time (ms)", "TIME (MS)"):
        assert read_record(path, name).times[-1] == 1.0
    record = read_record(path, "Time")
    assert record.find("load (kN)", "columns") == "Load"


def test_names_that_differ_in_their_unit_are_kept_whole(tmp_path: Path) -> None:
    record = read_record(written(tmp_path, "Time (s),Strain (%),Strain (mm)\n0,1,2\n1,2,3\n"), "Time")
    assert list(record.channels) == ["Strain (%)", "Strain (mm)"]


def test_thousands_are_read_where_the_decimal_mark_is_clear(tmp_path: Path) -> None:
    record = read_record(written(tmp_path, "Time;Load\n0,5;1.234,5\n1,5;12.345.678,0\n2,5;12.345.678\n"), "Time")
    np.testing.assert_allclose(record.channels["Load"], [1234.5, 12345678.0, 12345678.0])


def test_units_are_given_where_the_file_has_none(tmp_path: Path) -> None:
    path = written(tmp_path, "Time,Load\n0,1.5\n500,2.5\n")
    record = read_record(path, "Time", {"Time": "ms", "Load": "N"})
    assert list(record.times) == [0.0, 0.5]
    assert record.units == {"Load": "N"}
    same = read_record(written(tmp_path, "Time (sec),Load\n0,1.5\n500,2.5\n"), "Time", {"Time": "s"})
    assert same.times[-1] == 500.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Time (s),Load\n0,1\n2,3\n1,4\n", r"times of 'Time' must increase, and line 4 has 1 after 2"),
        ("Time (s),Load\n0,1\n1,3\n1,4\n", r"line 4 has 1 after 1; remove repeated rows"),
        ("Time (s),Load\n0,1\nn/a,3\n1,4\n", "column 'Time' has no time in line 3; remove the row"),
        ("0,1\n1,3\n", "no line above the table names its 2 columns"),
        ("Time,Load\nnothing\n", "holds no table"),
        ("Time,Load\n0,1\n1,3\nTime,Load\n2,4\n", "line 5 has 2 fields, and the table that ends in line 3 has 2"),
        ("Time,Load\n0,1\n1,3\n2\n", "line 4 has 1 fields, and the table that ends in line 3 has 2"),
        ("Time;Load\n0;1,5\n1;3.5\n", "line 3 has numbers with a decimal point and line 2 with a decimal comma"),
        ("Time,Load,Load\n0,1,2\n1,3,4\n", "two columns are named 'Load'"),
        ("Time,Load\nsoon,1\nlater,3\n", "neither numbers nor date-times of one clear pattern: line 2 has 'soon'"),
        ("Time,Load\n01/02/2026 10:00,1\n03/05/2026 10:00,3\n", "neither numbers nor date-times of one clear pattern"),
    ],
)
def test_faulty_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(fedic.FedicError, match=message):
        read_record(written(tmp_path, text), "Time")


@pytest.mark.parametrize(
    ("time", "units", "message"),
    [
        ("Clock", None, r"machine.csv has no column 'Clock'; its columns are 'Time', 'Load'"),
        ("Load", None, "its unit 'kN' in .* is not a unit of time"),
        ("Time", {"Time": "s"}, "units gives 'Time' in 's', and .*machine.csv says 'ms'"),
        ("Time", {"Load": "N"}, "units gives 'Load' in 'N', and .* says 'kN'"),
        ("Time", {"Force": "N"}, "has no column 'Force'"),
    ],
)
def test_columns_and_units_that_contradict_the_file_are_refused(
    tmp_path: Path, time: str, units: dict[str, str] | None, message: str
) -> None:
    path = written(tmp_path, "Time (ms),Load (kN)\n0,1\n1,3\n")
    with pytest.raises(fedic.OptionError, match=message):
        read_record(path, time, units)


def test_tables_in_memory_are_read() -> None:
    moments = pd.to_datetime(["2026-03-01 10:00:00", "2026-03-01 10:00:00.5", "2026-03-01 10:00:01"], format="ISO8601")
    table = pd.DataFrame({"When": moments, "Load (kN)": [1, 2, 3], "Note": ["a", "b", "c"], "Text": ["1,5", "2", "3"]})
    record = read_record(table, "When")
    np.testing.assert_allclose(record.times, [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(record.channels["Load"], [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(record.channels["Text"], [1.5, 2.0, 3.0])
    assert record.units == {"Load": "kN", "Text": ""}
    table["Since"] = table["When"] - table["When"][0]
    np.testing.assert_allclose(read_record(table, "Since").times, [0.0, 0.5, 1.0])
    with pytest.raises(fedic.OptionError, match="two columns 'Load'"):
        read_record(pd.DataFrame([[1, 2, 3]], columns=["Time", "Load", "Load"]), "Time")
    with pytest.raises(fedic.OptionError, match="the column 'Note' holds no numbers"):
        record.find("Note", "columns")
    with pytest.raises(fedic.OptionError, match="times of 'Load' must increase, and row 1 has 1 after 2"):
        read_record(pd.DataFrame({"Load": [2, 1]}), "Load")
    with pytest.raises(fedic.OptionError, match="the table of the machine has no rows"):
        read_record(table[:0], "When")
    with pytest.raises(fedic.OptionError, match=r"must be a file or a pandas\.DataFrame, got 3"):
        read_record(3, "When")  # type: ignore[arg-type]


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=st.text(alphabet='0123456789,;.\t\n"() eab:-/%\xb5\x00', max_size=200))
def test_any_text_is_read_or_refused(tmp_path: Path, text: str) -> None:
    for content in (text, f"Time (s);Load\n0;1\n{text}", f"Time,Load\n{text}\n0,1\n1,2\n"):
        with contextlib.suppress(fedic.FedicError):
            assert np.isfinite(read_record(written(tmp_path, content), "Time").times).all()


def test_long_headings_and_lines_are_read_soon(tmp_path: Path) -> None:
    heading = "a( " * 100_000
    record = read_record(written(tmp_path, f"Time,{heading}\n0,1\n1,2\n"), "Time")
    assert len(next(iter(record.channels))) == len(heading) - 1
