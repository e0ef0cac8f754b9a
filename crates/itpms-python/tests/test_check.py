"""A vehicle file held against a drive, and how far a computation is."""

import json
import sys

import numpy as np
import pytest

import itpms


def test_a_file_and_a_table_are_checked_as_the_command_does(command, drive, tmp_path):
    log, file = tmp_path / "drive.parquet", tmp_path / "car.toml"
    drive.frame("pandas").to_parquet(log)
    drive.vehicle.write(file)
    page = tmp_path / "check.html"
    expected = json.loads(command("vehicle", "check", log, "--vehicle", file, "--json", "--report", page))
    found = drive.vehicle.check(log)
    assert found.corners == expected["corners"]
    assert found.concerns == []
    found.report(tmp_path / "own.html")
    assert (tmp_path / "own.html").read_text() == page.read_text()
    for table in (drive.frame("polars"), drive.frame("pyarrow"), drive.columns, iter([drive.frame("pandas")])):
        assert itpms.vehicle.check(table, file).corners == expected["corners"]
    assert found.corners["fl"]["sentence"] in repr(found)
    with pytest.raises(itpms.OutputError, match="does not exist"):
        found.report(tmp_path / "no" / "own.html")


def test_a_damper_that_is_not_the_files_is_seen(drive):
    halved = drive.vehicle.to_toml()
    for corner in drive.vehicle.corners.values():
        damping = corner["damping_n_s_per_m"]
        halved = halved.replace(f"damping_n_s_per_m = {damping}", f"damping_n_s_per_m = {damping / 2}")
    car = itpms.Vehicle.parse(halved)
    found = car.check(drive.frame("pandas"))
    estimated = itpms.estimate(drive.frame("pandas"), car).summary["corners"]
    for name, corner in found.corners.items():
        assert corner["asks_for_change"] and "set damping_n_s_per_m to" in corner["sentence"]
        assert abs(corner["damping_over_file"] - 2.0) < 0.3
        assert corner["fit"] == estimated[name]["fit"]
    curves = found.curves("fl")
    told = np.interp(curves["hz"], curves["file_hz"], curves["file_gain"])
    # Above the body's own frequency the gain is c w / (m w^2), in proportion to the damping.
    above = (curves["hz"] > 8) & (curves["hz"] < 16)
    assert np.median(curves["gain"][above] / told[above]) == pytest.approx(2.0, abs=0.4)
    assert np.all(curves["file_gain_low"] <= curves["file_gain"])
    with pytest.raises(itpms.SettingError, match="corner is 'front', expected one of: fl, fr"):
        found.curves("front")


def test_the_picture_has_a_column_of_panels_per_corner(drive):
    figure = drive.vehicle.check(drive.frame("pandas")).plot()
    titles = [panel.get_title(loc="left") for panel in figure.axes]
    assert titles[:4] == ["Front left", "Front right", "Rear left", "Rear right"]
    assert len(figure.axes) == 8
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_what_is_refused(drive):
    frame = drive.frame("pandas")
    with pytest.raises(itpms.SettingError, match="frames of a CAN log"):
        drive.vehicle.check(frame, dbc="car.dbc")
    with pytest.raises(itpms.LogError, match="column time_s is missing"):
        drive.vehicle.check(frame.drop(columns="time_s"))
    with pytest.raises(itpms.LogError, match="no such file"):
        itpms.vehicle.check("none.csv", drive.vehicle)


@pytest.fixture
def bars(monkeypatch):
    """What would be shown: every bar's name and the shares that it was told."""
    shown = []

    class Bar:
        def __init__(self, *, total, desc, **_):
            assert total == 1.0
            self.n, self.shares = 0.0, []
            shown.append((desc, self.shares))

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def update(self, more):
            self.n += more
            self.shares.append(self.n)

    import tqdm.auto

    monkeypatch.setattr(tqdm.auto, "tqdm", Bar)
    return shown


def test_progress_rises_to_the_end(bars, drive):
    frame = drive.frame("pandas")
    itpms.estimate(frame, drive.vehicle)
    assert bars == []
    itpms.estimate(frame, drive.vehicle, progress=True)
    drive.vehicle.check(iter([frame, frame.iloc[:0]]), progress=True)
    itpms.simulate("drive-puncture", progress=True)
    assert [name for name, _ in bars] == ["estimating", "checking", "driving"]
    for _, shares in bars:
        assert shares == sorted(shares) and shares[-1] == pytest.approx(1.0)
    # Forty seconds of a whole car take some ten looks; a table's rows are counted, an iterator's are not.
    assert any(0.0 < share < 1.0 for share in bars[0][1])
    assert not any(0.0 < share < 1.0 for share in bars[1][1])


def test_what_a_bar_raises_ends_the_computation(monkeypatch, drive):
    import tqdm.auto

    class Broken:
        n = 0.0

        def __init__(self, **_):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def update(self, _):
            raise KeyboardInterrupt

    monkeypatch.setattr(tqdm.auto, "tqdm", Broken)
    with pytest.raises(KeyboardInterrupt):
        itpms.estimate(drive, progress=True)


def test_without_tqdm_a_bar_is_refused_where_it_is_asked_for(monkeypatch, drive):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(itpms.SettingError, match="tqdm is not installed"):
        itpms.estimate(drive, progress=True)
    assert itpms.estimate(drive, progress=False).corners == ["fl", "fr", "rl", "rr"]
