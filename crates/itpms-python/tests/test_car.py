"""Samples as they come: one by one, in pieces, saved in between; always the same numbers."""

import math

import numpy as np
import pandas as pd
import pytest

import itpms


@pytest.fixture(scope="module")
def whole(drive):
    return itpms.Car(drive.vehicle, 500).update(drive.columns)


def test_in_pieces_and_through_a_file_it_is_the_same(drive, whole, tmp_path):
    car = itpms.Car(drive.vehicle, 500)
    pieces = []
    for k, start in enumerate(range(0, 20_000, 4_000)):
        piece = {name: values[start : start + 4_000] for name, values in drive.columns.items()}
        pieces.append(car.update(pd.DataFrame(piece) if k % 2 else piece))
        car.save(tmp_path / "car.state")
        car = itpms.Car.load(tmp_path / "car.state")
    for name, values in whole.items():
        np.testing.assert_array_equal(np.concatenate([piece[name] for piece in pieces]), values, err_msg=name)
    assert car.states["fl"] == "low"
    assert any("fl" in alert["wheels"] for alert in car.alerts)
    assert (car.rate_hz, car.corners, car.vehicle) == (500.0, ["fl", "fr", "rl", "rr"], drive.vehicle)
    assert [path.name for path in tmp_path.iterdir()] == ["car.state"]


def test_as_a_whole_drive_has_it(drive, result, whole):
    rows = np.isin(whole["time_s"], result.columns["time_s"])
    for name, values in result.columns.items():
        np.testing.assert_array_equal(whole[name][rows], values, err_msg=name)


def test_the_air_gives_cold_pressures_and_leaves_the_others(drive, whole):
    air = {"ambient_temperature_c": np.full(20_000, -10.0), "barometric_kpa": np.full(20_000, 101.3)}
    found = itpms.Car(drive.vehicle, 500).update({**drive.columns, **air})
    named = {f"{c}_cold_pressure_{what}" for c in ("fl", "fr", "rl", "rr") for what in ("kpa", "sd_kpa")}
    assert set(found) - set(whole) == named
    np.testing.assert_array_equal(found["rr_pressure_kpa"], whole["rr_pressure_kpa"])
    # Hardly warm after 40 s; its temperature at the start is not known.
    last = {name: values[-1] for name, values in found.items()}
    assert 0.0 < last["rr_pressure_kpa"] - last["rr_cold_pressure_kpa"] < 3.0
    assert last["rr_cold_pressure_sd_kpa"] > last["rr_pressure_sd_kpa"]


def test_one_sample_at_a_time(drive, whole):
    car = itpms.Car(drive.vehicle, 500)
    names = list(drive.columns)
    for i in range(1500):
        found = car.update({name: float(drive.columns[name][i]) for name in names})
    assert isinstance(found["fl_pressure_kpa"], float) and isinstance(found["fl_valid"], bool)
    for name, value in found.items():
        expected = whole[name][1499]
        assert value == expected or (math.isnan(value) and math.isnan(expected)), name


def test_one_corner_alone(drive):
    car = itpms.Car(drive.vehicle, 500, corners=("rl",))
    found = car.update({name: drive.columns[name] for name in ("time_s", "rl_body_accel_m_s2", "rl_wheel_accel_m_s2")})
    assert set(found) == {"time_s"} | {
        f"rl_{what}"
        for what in (
            "pressure_kpa",
            "pressure_sd_kpa",
            "stiffness_n_per_m",
            "valid",
            "warning",
            "change_sd_kpa",
            "level",
            "axle_difference_sd_kpa",
            "lost_kpa",
            "lost_sd_kpa",
            "state",
        )
    }
    assert abs(found["rl_pressure_kpa"][-1] - 241.3) < 4 * found["rl_pressure_sd_kpa"][-1]


def test_what_is_refused(drive, tmp_path):
    car = itpms.Car(drive.vehicle, 500)
    columns = dict(drive.columns)
    with pytest.raises(itpms.SettingError, match="time_s is missing"):
        car.update({"speed_m_s": 3.0})
    del columns["rr_wheel_accel_m_s2"]
    with pytest.raises(itpms.SettingError, match="rr_wheel_accel_m_s2 is missing"):
        car.update(columns)
    with pytest.raises(itpms.SettingError, match="expected fl, fr, rl or rr"):
        itpms.Car(drive.vehicle, 500, corners=("front",))
    with pytest.raises(itpms.SettingError):
        itpms.Car(drive.vehicle, -5)
    with pytest.raises(itpms.SettingError, match="nothing was learned"):
        car.save_reference(tmp_path / "r")
    with pytest.raises(itpms.OutputError, match="cannot be written"):
        car.save(tmp_path / "no" / "car.state")
    with pytest.raises(itpms.LogError, match="cannot be read"):
        itpms.Car.load(tmp_path / "none")
    car.save(tmp_path / "car.state")
    state = bytearray((tmp_path / "car.state").read_bytes())
    state[len(state) // 2] ^= 1
    (tmp_path / "bad").write_bytes(state)
    with pytest.raises(itpms.SettingError, match="damaged"):
        itpms.Car.load(tmp_path / "bad")
    (tmp_path / "other").write_bytes(b"hello")
    with pytest.raises(itpms.SettingError, match="is no car saved by itpms"):
        itpms.Car.load(tmp_path / "other")
