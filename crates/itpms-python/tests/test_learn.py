"""What drives at known pressures teach of a car: the command's numbers, from files and from tables."""

import json

import pandas as pd
import pytest
from even_drive import even_drive

import itpms

# Two and a half minutes, all tires at the placard's 240 kPa, on a car that is lighter below than its file says.
DRIVE = even_drive(150.0, 200.0, "sprung_mass_kg = 320.0\nunsprung_mass_kg = 36.0\npressure.constant_kpa = 240.0")


@pytest.fixture(scope="module")
def calibration(tmp_path_factory):
    """The drive as a table, and the typical car that it is held against."""
    path = tmp_path_factory.mktemp("learn") / "calibration.toml"
    path.write_text(DRIVE)
    made_up = itpms.simulate(path, seed=3, truth=False)
    return made_up.frame("pandas"), itpms.Vehicle.typical(1450.0, 0.5, "205/55R16", wheelbase_m=2.7, name="ours")


def test_a_file_and_a_table_teach_what_the_command_learns(command, calibration, tmp_path):
    frame, car = calibration
    log, file, learned = (tmp_path / name for name in ("drive.parquet", "car.toml", "learned.toml"))
    frame.to_parquet(log)
    car.write(file)
    told = "fl=240,fr=240,rl=235,rr=240"
    arguments = ("vehicle", "learn", log, "--pressure-kpa", told, "--from", file, "-o", learned, "--json")
    expected = json.loads(command(*arguments))
    pressures = {"fl": 240, "fr": 240, "rl": 235, "rr": 240}
    found = car.learn(log, pressures)
    assert found.corners == expected["corners"]
    assert found.slope_over_file == expected["slope_over_file"]
    assert (found.unknown, found.concerns) == (expected["unknown"], expected["concerns"])
    assert found.to_toml("car.toml") == learned.read_text()
    found.write(tmp_path / "own.toml", "car.toml")
    assert (tmp_path / "own.toml").read_text() == learned.read_text()
    assert found.vehicle == itpms.Vehicle.read(learned)
    # The drive is short, which is said; a table is no file, and is called otherwise.
    assert any("was read for" in concern for concern in found.concerns)
    for table in (frame, frame.to_dict("series"), frame.set_index(pd.to_timedelta(frame["time_s"], unit="s"))):
        assert car.learn(table, pressures).corners == expected["corners"]
    renamed, named = frame.rename(columns={"speed_m_s": "v"}), {"speed_m_s": {"signal": "v", "unit": "m/s"}}
    assert car.learn(renamed, pressures, signals=named).corners == expected["corners"]
    # The car itself stays as it was.
    assert car == itpms.Vehicle.read(file)


def test_a_drive_tells_the_ratio_of_tire_and_wheel(calibration):
    frame, car = calibration
    found = car.learn([frame], [240.0])
    # The paper's tire, eq. (5), and the scenario's wheel.
    true_per_s2 = (713.91 * 240 + 60880) / 36.0
    for corner in found.corners.values():
        ratio = corner["stiffness_over_mass_per_s2"]
        assert ratio["learned"] and ratio["after_sd"] < 0.5 * ratio["before_sd"]
        assert abs(ratio["after"] - true_per_s2) < 0.5 * abs(ratio["before"] - true_per_s2)
    assert "stiffness_over_mass_per_s2" in repr(found)
    # Two drives tell more than one.
    both = car.learn([frame, frame.iloc[5000:]], 240)
    for name, corner in found.corners.items():
        ratio, less = (corners["stiffness_over_mass_per_s2"] for corners in (both.corners[name], corner))
        assert ratio["after_sd"] < less["after_sd"]


def test_what_is_refused(calibration, tmp_path):
    frame, car = calibration
    for drives, pressures, error, sentence in [
        (
            frame,
            2.4,
            itpms.SettingError,
            r"fl: 2\.4 kPa is no tire's pressure, expected 60 to 1500 \(another unit\? 2\.4 bar is 240 kPa\)",
        ),
        (frame, {"fl": 240.0}, itpms.SettingError, "no pressure is given of fr"),
        (frame, {"front": 240.0}, itpms.SettingError, "names 'front', expected corners"),
        ([frame, frame], [240, 240, 240], itpms.SettingError, "3 entries for 2 drives"),
        (iter([frame]), 240, itpms.SettingError, "gone through once only"),
        (frame.drop(columns="time_s"), 240, itpms.LogError, "the table: column time_s is missing"),
        (tmp_path / "none.csv", 240, itpms.LogError, "no such file"),
        ([], 240, itpms.SettingError, "no drive"),
        (frame.iloc[:500], 240, itpms.LogError, "no tire was read for a minute"),
    ]:
        with pytest.raises(error, match=sentence):
            car.learn(drives, pressures)
    with pytest.raises(itpms.SettingError, match=r"tire: .*205"):
        itpms.Vehicle.typical(1450.0, 0.5, "205")
    with pytest.raises(itpms.SettingError, match="front share"):
        itpms.Vehicle.typical(1450.0, 55, "205/55R16")
    with pytest.raises(itpms.SettingError, match='car_class is "lorry", expected one of: compact'):
        itpms.Vehicle.typical(1450.0, 0.5, "205/55R16", car_class="lorry")


def test_a_typical_car_is_the_commands(command, tmp_path):
    arguments = ("--mass", 1450, "--front-share", 0.55, "--tire", "205/55R16", "--class", "sedan", "--name", "ours")
    command("vehicle", "init", *arguments, "-o", tmp_path / "car.toml")
    assert itpms.Vehicle.typical(1450, 0.55, "205/55R16", car_class="sedan", name="ours") == itpms.Vehicle.read(
        tmp_path / "car.toml"
    )
