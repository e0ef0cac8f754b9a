"""The same estimates as the command's, to the last digit."""

import json
import re

import numpy as np
import pandas as pd

import itpms


def read(path):
    return pd.read_csv(path, float_precision="round_trip", keep_default_na=True)


def test_a_drive_from_a_file_and_from_its_table(command, tmp_path):
    log, car, est, road, page, events = (
        tmp_path / name for name in ("drive.csv", "car.toml", "est.csv", "road.csv", "page.html", "events.jsonl")
    )
    command("simulate", "drive-puncture", "--seed", 7, "-o", log, "--vehicle-out", car)
    summary = json.loads(
        command(
            "estimate",
            log,
            "--vehicle",
            car,
            "-o",
            est,
            "--road-out",
            road,
            "--report",
            page,
            "--events",
            events,
            "--json",
        )
    )
    drive = itpms.simulate("drive-puncture", seed=7)
    # The made-up drive is the command's, too.
    pd.testing.assert_frame_equal(drive.frame("pandas"), read(log), check_exact=True)
    assert drive.vehicle == itpms.Vehicle.read(car)
    for given in (log, read(log), drive):
        result = itpms.estimate(given, car, road=True)
        pd.testing.assert_frame_equal(result.frame("pandas"), read(est), check_exact=True, check_dtype=False)
        pd.testing.assert_frame_equal(pd.DataFrame(result.road), read(road), check_exact=True)
        assert result.events == [json.loads(line) for line in events.read_text().splitlines()]
        for key in ("corners", "duration_s", "distance_m", "alerts", "warnings", "rows"):
            assert result.summary[key] == summary[key], key
    own = tmp_path / "own.html"
    itpms.estimate(log, car).report(own)
    # Only the command's page says which command made it, and of which commit it was built.
    made_by = re.compile(r'<tr><th scope="row">Command</th><td>itpms .*</td></tr>\n')
    assert len(made_by.findall(page.read_text())) == 1
    commit = re.compile(r"(itpms [\d.]+) \([0-9a-f]+\)")
    assert own.read_text() == commit.sub(r"\1", made_by.sub("", page.read_text()))


def test_calibration_and_its_reference(command, tmp_path):
    log, car = tmp_path / "drive.parquet", tmp_path / "car.toml"
    command("simulate", "drive-puncture", "--seed", 3, "-o", log, "--vehicle-out", car)
    command(
        "estimate",
        log,
        "--vehicle",
        car,
        "-o",
        tmp_path / "a.csv",
        "--calibrate-s",
        15,
        "--save-reference",
        tmp_path / "r1",
    )
    result = itpms.estimate(log, car, calibrate_s=15, save_reference=tmp_path / "r2")
    pd.testing.assert_frame_equal(result.frame("pandas"), read(tmp_path / "a.csv"), check_exact=True, check_dtype=False)

    # But for the second in which they were written.
    def learned(name):
        lines = (tmp_path / name).read_text().splitlines()[1:]
        return [line for line in lines if not line.startswith("unix_s")]

    assert learned("r1") == learned("r2")
    command(
        "estimate",
        log,
        "--vehicle",
        car,
        "-o",
        tmp_path / "b.csv",
        "--reference",
        tmp_path / "r1",
        "--estimator",
        "informed",
    )
    result = itpms.estimate(log, car, reference=tmp_path / "r2")
    pd.testing.assert_frame_equal(result.frame("pandas"), read(tmp_path / "b.csv"), check_exact=True, check_dtype=False)


def test_a_table_that_pandas_wrote_with_dates_and_decimal_commas(command, tmp_path):
    drive = itpms.simulate("drive-puncture", seed=2, truth=False)
    plain = drive.frame("pandas")
    # A clock that counts from 1970 has quarters of a microsecond: the plain table has it, too.
    plain["time_s"] = 1_772_352_000 + plain["time_s"].round(3)
    stamps = pd.DatetimeIndex(pd.to_datetime((1000 * plain["time_s"]).round().astype("int64"), unit="ms"), name="Zeit")
    odd = pd.DataFrame({"v_Fahrzeug [km/h]": 3.6 * plain["speed_m_s"].to_numpy()}, index=stamps)
    for ours, theirs in {"fl": "VL", "fr": "VR", "rl": "HL", "rr": "HR"}.items():
        odd[f"Aufbau_az_{theirs} [g]"] = plain[f"{ours}_body_accel_m_s2"].to_numpy() / 9.80665
        odd[f"Rad_az_{theirs} [g]"] = plain[f"{ours}_wheel_accel_m_s2"].to_numpy() / 9.80665
    odd.to_csv(tmp_path / "odd.csv", sep=";", decimal=",")
    odd.to_parquet(tmp_path / "odd.parquet")
    expected = itpms.estimate(plain, drive.vehicle)
    for name in ("odd.csv", "odd.parquet"):
        map_ = tmp_path / f"{name}.toml"
        command("signals", tmp_path / name, "--write-map", map_)
        assert "unit" not in "".join(line for line in map_.read_text().splitlines() if not line.startswith("#"))
        found = itpms.estimate(tmp_path / name, drive.vehicle, signals=map_)
        for column, values in expected.columns.items():
            if column.endswith("pressure_kpa"):
                # Two ways to add up a time may end in neighboring numbers.
                np.testing.assert_allclose(found.columns[column], values, atol=0.1, err_msg=f"{name} {column}")
    # The frame itself: its index is the clock.
    found = itpms.estimate(odd, drive.vehicle, signals=tmp_path / "odd.csv.toml")
    np.testing.assert_allclose(found.columns["fl_pressure_kpa"], expected.columns["fl_pressure_kpa"], atol=0.1)
