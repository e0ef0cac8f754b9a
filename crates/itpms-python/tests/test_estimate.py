"""Whole drives: the kinds of input, the physics, and what is refused."""

import datetime
import re
import signal
import threading
import time

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

import itpms


def same(a: dict, b: dict) -> None:
    assert list(a) == list(b)
    for name in a:
        np.testing.assert_array_equal(a[name], b[name], err_msg=name)


def test_every_kind_of_table_gives_the_same_and_comes_back_as_it_came(drive, result, tmp_path):
    columns = drive.columns
    expected = result.columns
    frame = pd.DataFrame(columns)
    frame.to_parquet(tmp_path / "drive.parquet")
    inputs = {
        "pandas": (frame, pd.DataFrame),
        "polars": (pl.DataFrame(columns), pl.DataFrame),
        "lazy": (pl.DataFrame(columns).lazy(), pl.DataFrame),
        "pyarrow": (pa.table(columns), pa.Table),
        "numpy": (columns, dict),
        "lists": ({name: values.tolist() for name, values in columns.items()}, dict),
        "path": (tmp_path / "drive.parquet", pd.DataFrame),
        "text": (str(tmp_path / "drive.parquet"), pd.DataFrame),
    }
    for given, kind in inputs.values():
        found = itpms.estimate(given, drive.vehicle)
        assert type(found.frame()) is kind
        same(found.columns, expected)


def test_the_puncture_is_found_and_the_bands_hold_the_truth(drive, result):
    frame = result.frame("pandas").set_index("time_s")
    # The scenario's own numbers: 241.3 kPa until 20 s, 137.9 from 22.5 s on at one wheel.
    for corner in ("fl", "fr", "rl", "rr"):
        end_kpa = 137.9 if corner == "fl" else 241.3
        for truth_kpa, part in ((241.3, frame.loc[5:19.9]), (end_kpa, frame.loc[30:])):
            error = part[f"{corner}_pressure_kpa"] - truth_kpa
            assert (error.abs() < 4 * part[f"{corner}_pressure_sd_kpa"]).all(), corner
            assert error.abs().mean() < 10
        low = frame[f"{corner}_warning"] == "low"
        assert low.any() == (corner == "fl")
    low = frame.index[frame["fl_warning"] == "low"]
    # A fifth of the placard's is lost at 20 s + 2.5 s * 48.26 / 103.4.
    assert 21.1 < low[0] < 24.2
    assert frame["fl_valid"].dtype == bool
    begun = [event for event in result.events if event["event"] == "begun"]
    assert begun and all(event["wheels"] == ["fl"] for event in begun)
    assert result.summary["corners"]["fl"]["low_since_s"] == pytest.approx(low[0], abs=0.1)


def test_the_road_is_the_roads(drive, result):
    road = result.road
    assert len(road) == len(drive.columns["time_s"])
    truth = drive.columns["fl_road_m"]
    estimate = road["fl_road_m"].to_numpy()
    # Band-limited to what the sensors can see: the same waves, 0.5 to 10 m, by numpy's own transform.
    step_m = road["distance_m"].diff().median()
    waves = np.fft.rfftfreq(len(truth), step_m)
    seen = (waves > 0.1) & (waves < 2.0)
    window = np.hanning(len(truth))
    a, b = (np.fft.rfft(window * (x - x.mean()))[seen] for x in (truth, estimate))
    assert np.linalg.norm(a - b) < 0.2 * np.linalg.norm(a)


def test_the_road_is_only_there_when_asked_for(drive):
    without = itpms.estimate(drive)
    with pytest.raises(itpms.SettingError, match=r"road=True"):
        _ = without.road


def test_without_a_report_the_pressures_are_the_same(drive, result, tmp_path):
    without = itpms.estimate(drive, report=False)
    same(without.columns, result.columns)
    assert without.alerts == result.alerts
    with pytest.raises(itpms.SettingError, match=r"report=True"):
        without.report(tmp_path / "page.html")


def test_times_may_be_times(drive, result):
    columns = dict(drive.columns)
    seconds = columns.pop("time_s")
    expected = result.columns
    # Whole microseconds, as 500 Hz has them.
    delta = pd.to_timedelta(np.round(seconds * 1e6).astype("int64"), unit="us")
    for frame in (
        pd.DataFrame(columns, index=delta),
        pd.DataFrame({"time_s": delta, **columns}),
        pl.DataFrame({"time_s": [datetime.timedelta(microseconds=round(s * 1e6)) for s in seconds], **columns}),
    ):
        found = itpms.estimate(frame, drive.vehicle).columns
        np.testing.assert_allclose(found["fl_pressure_kpa"], expected["fl_pressure_kpa"], rtol=1e-9)
    start = datetime.datetime(2026, 3, 1, 12, tzinfo=datetime.timezone.utc)
    frame = pd.DataFrame(columns, index=pd.Timestamp(start) + delta)
    found = itpms.estimate(frame, drive.vehicle)
    assert found.columns["time_s"][0] == pytest.approx(start.timestamp(), abs=1e-6)
    # A clock that counts from 1970 has quarters of a microsecond; that is all the difference.
    np.testing.assert_allclose(found.columns["fl_pressure_kpa"], expected["fl_pressure_kpa"], atol=0.05)


def test_a_map_says_which_column_is_what(drive, result, tmp_path):
    frame = pd.DataFrame({"Time": pd.to_timedelta(drive.columns["time_s"], unit="s"), "Note": "x"})
    frame["v_kmh"] = 3.6 * drive.columns["speed_m_s"]
    for corner in ("fl", "fr", "rl", "rr"):
        frame[f"AccZ_Body_{corner.upper()} [g]"] = drive.columns[f"{corner}_body_accel_m_s2"] / 9.80665
        frame[f"Hub {corner}"] = -1000 * drive.columns[f"{corner}_wheel_accel_m_s2"]
    lines = [f'{c}_wheel_accel_m_s2 = {{ signal = "Hub {c}", factor = -0.001 }}' for c in ("fl", "fr", "rl", "rr")]
    (tmp_path / "map.toml").write_text("\n".join(["[signals]", 'speed_m_s = "v_kmh"', *lines]))
    for given in (frame, pl.from_pandas(frame)):
        found = itpms.estimate(given, drive.vehicle, signals=tmp_path / "map.toml").columns
        np.testing.assert_allclose(found["fl_pressure_kpa"], result.columns["fl_pressure_kpa"], atol=1e-3)
    with pytest.raises(itpms.LogError, match="no corner has that of its body and of its wheel"):
        itpms.estimate(frame, drive.vehicle)


def test_missing_values_are_missing_however_they_are_written(drive):
    columns = {name: np.array(values) for name, values in drive.columns.items()}
    holes = np.zeros(len(columns["time_s"]), bool)
    holes[5000:5003] = True
    columns["fl_wheel_accel_m_s2"][holes] = np.nan
    expected = itpms.estimate(columns, drive.vehicle).columns
    frame = pd.DataFrame(columns)
    nullable = frame.astype({"fl_wheel_accel_m_s2": "Float64"})
    objects = frame.astype({"fl_wheel_accel_m_s2": object})
    objects.loc[holes, "fl_wheel_accel_m_s2"] = None
    polars = pl.from_pandas(frame)
    for given in (frame, nullable, objects, polars, polars.to_arrow()):
        same(itpms.estimate(given, drive.vehicle).columns, expected)


@pytest.mark.parametrize(
    ("change", "error", "sentence"),
    [
        (lambda c: c.pop("time_s"), itpms.LogError, "the table: column time_s is missing"),
        (lambda c: c.update(time_s=c["time_s"] * 1000), itpms.LogError, "milliseconds"),
        (
            lambda c: c.update(fl_body_accel_m_s2=["x"] * len(c["time_s"])),
            itpms.LogError,
            "row 1, column fl_body_accel_m_s2: found 'x'",
        ),
        (
            lambda c: c.update(speed_m_s=c["speed_m_s"][:-1]),
            itpms.LogError,
            "column speed_m_s has 19999 values, expected 20000",
        ),
        (
            lambda c: c.update({"fl_wheel_acceleration": c.pop("fl_wheel_accel_m_s2")}),
            itpms.LogError,
            "nearest name there is fl_wheel_acceleration",
        ),
        (lambda c: c.update(fl_body_accel_m_s2=np.zeros((20000, 2))), itpms.LogError, r"shape \(20000, 2\)"),
    ],
)
def test_a_table_that_cannot_be_used_is_refused_in_a_sentence(drive, change, error, sentence):
    columns = dict(drive.columns)
    change(columns)
    with pytest.raises(error, match=sentence) as caught:
        itpms.estimate(columns, drive.vehicle)
    assert isinstance(caught.value, (itpms.ItpmsError, ValueError))


def test_what_else_is_refused(drive, tmp_path):
    for arguments, error, sentence in [
        ({"estimator": "best"}, itpms.SettingError, 'estimator is "best", expected one of: informed'),
        ({"regulation": "none"}, itpms.SettingError, "un-r141"),
        ({"rate_hz": 0}, itpms.SettingError, "rate_hz is 0, expected a positive"),
        ({"rate_hz": float("nan")}, itpms.SettingError, "rate_hz is NaN"),
        ({"calibrate_s": -1}, itpms.SettingError, "calibrate_s is -1"),
        ({"road_repeats": "often"}, itpms.SettingError, "expected seconds, never or auto"),
        ({"save_reference": tmp_path / "r"}, itpms.SettingError, "without calibrate_s"),
        ({"reference": tmp_path / "none"}, (itpms.SettingError, itpms.LogError), "no such file"),
        ({"dbc": tmp_path / "x.dbc"}, itpms.SettingError, "this drive is a table"),
    ]:
        with pytest.raises(error, match=sentence):
            itpms.estimate(drive, **arguments)
    with pytest.raises(itpms.SettingError, match="vehicle is missing"):
        itpms.estimate(drive.columns)
    with pytest.raises(itpms.VehicleError, match=r"none\.toml: no such file"):
        itpms.estimate(drive, tmp_path / "none.toml")
    with pytest.raises(itpms.SettingError, match="the drive is a int"):
        itpms.estimate(3, drive.vehicle)
    with pytest.raises(itpms.LogError, match=r"none\.csv: no such file"):
        itpms.estimate(tmp_path / "none.csv", drive.vehicle)
    result = itpms.estimate(drive)
    with pytest.raises(itpms.OutputError, match="does not exist"):
        result.report(tmp_path / "no" / "report.html")


def test_other_threads_run_meanwhile(drive):
    counted = [0]
    stop = threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    before = counted[0]
    itpms.estimate(drive)
    during = counted[0] - before
    stop.set()
    counter.join()
    # Half a second of work and more; with the lock held there would be none.
    assert during > 20


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="skipped: no interval timer on this system")
def test_ctrl_c_ends_it(drive):
    long = {name: np.tile(values, 20) for name, values in drive.columns.items()}
    long["time_s"] = np.arange(len(long["time_s"])) / 500.0
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    # A process that was started in the background ignores it unless told otherwise.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    begun = time.monotonic()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            itpms.estimate(long, drive.vehicle)
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - begun < 5
    # All is well afterwards.
    assert itpms.estimate(drive).summary["rows"] == 20_000


def test_the_figure_shows_every_corner(result):
    figure = result.plot()
    assert [panel.get_title(loc="left") for panel in figure.axes] == [
        "Front left",
        "Front right",
        "Rear left",
        "Rear right",
    ]
    names = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"estimate", "95 % band", "truth", "placard", "low"} <= names


def test_a_result_says_what_it_found(result):
    # The tire has 138 kPa at the end; the loss begins at 20 s.
    assert re.search(r"fl  1[34]\d\.\d kPa", repr(result)) and re.search(r"LOW, warned of at 2[0-4]\.", repr(result))
    assert result.concerns == []
    assert any(alert["wheels"] == ["fl"] for alert in result.alerts)


def test_a_drive_may_come_in_pieces(drive, result):
    def pieces(rows):
        for start in range(0, 20_000, rows):
            yield {name: values[start : start + rows] for name, values in drive.columns.items()}

    for rows in (700, 20_000):
        found = itpms.estimate(pieces(rows), drive.vehicle)
        same(found.columns, result.columns)
        assert found.summary == result.summary
    batches = (pa.RecordBatch.from_pydict(piece) for piece in pieces(5000))
    same(itpms.estimate(batches, drive.vehicle).columns, result.columns)

    def broken():
        yield from pieces(10_000)
        raise ZeroDivisionError("the source's own")

    with pytest.raises(ZeroDivisionError, match="the source's own"):
        itpms.estimate(broken(), drive.vehicle)
    with pytest.raises(itpms.LogError, match="no piece of a drive"):
        itpms.estimate(iter([]), drive.vehicle)
    with pytest.raises(itpms.LogError, match="piece 2 differs in the column speed_m_s"):
        first, second = pieces(10_000)
        del second["speed_m_s"]
        itpms.estimate(iter([first, second]), drive.vehicle)
