"""A drive with wheel speeds alone: a table in, a table out."""

import numpy as np
import pandas as pd
import polars as pl
import pytest

import itpms

CORNERS = ("fl", "fr", "rl", "rr")
VEHICLE = """
[vehicle]
name = "wheel speeds alone"
wheelbase_m = 2.7
track_front_m = 1.55
track_rear_m = 1.55
driven = "front"
[tire]
[corner.fl]
placard_kpa = 240.0
[corner.fr]
placard_kpa = 240.0
[corner.rl]
placard_kpa = 240.0
[corner.rr]
placard_kpa = 240.0
"""


def drive(lost: float) -> pd.DataFrame:
    """Four minutes at 54 to 76 km/h with bends; at 120 s the rear right tire has lost this share of its pressure: -.007 ln of what is left."""
    draw = np.random.default_rng(3)
    time_s = np.arange(0, 240, 0.02)
    speed = 18 + 3 * np.sin(time_s / 9)
    bend = 1.2e-3 * np.sin(time_s / 7) + 0.6e-3 * np.sin(time_s / 2.3)
    columns = {"time_s": time_s, "yaw_rate_rad_s": speed * bend + 1e-3 * draw.standard_normal(time_s.size)}
    offsets = {"fl": 1.3e-3, "fr": -0.4e-3, "rl": -0.9e-3, "rr": 0.6e-3}
    for corner, offset in offsets.items():
        outer = 0.5 * 1.55 * bend * (-1 if corner.endswith("l") else 1)
        way = outer + (0.5 * (2.7 * bend) ** 2 if corner.startswith("f") else 0)
        radius = offset + (0.007 * np.log(1 - lost) * (time_s >= 120) if corner == "rr" else 0)
        noise = 1e-3 * np.diff(draw.standard_normal(time_s.size + 1)) + 5e-4 * draw.standard_normal(time_s.size)
        columns[f"{corner}_wheel_speed_m_s"] = speed * np.exp(way - radius + noise)
    return pd.DataFrame(columns)


def test_the_tire_that_lost_a_quarter_is_named_and_none_of_a_healthy_car():
    vehicle = itpms.Vehicle.parse(VEHICLE)
    for lost in (0.25, 0.0):
        result = itpms.estimate(drive(lost), vehicle, calibrate_s=100)
        frame = result.frame()
        assert type(frame) is pd.DataFrame
        assert not [name for name in frame if name.endswith("pressure_kpa")]
        low = {corner for corner in CORNERS if (frame[f"{corner}_warning"] == "low").any()}
        assert low == ({"rr"} if lost else set())
        assert [alert["wheels"] for alert in result.alerts] == ([["rr"]] if lost else [])
        assert "rr_radius_change" in frame
        # Nothing before it is lost; a quarter within the stated standard deviation at the end.
        assert (frame.loc[frame.time_s < 120, "rr_warning"] == "none").all()
        last = frame.iloc[-1]
        assert abs(last.rr_lost_share - lost) < 1.96 * last.rr_lost_share_sd + 0.02
        assert abs(last.rear_radius_difference + 0.007 * np.log(1 - lost)) < 4 * last.rear_radius_difference_sd


def test_every_table_gives_the_same_and_a_speed_that_is_missing_is_named():
    vehicle = itpms.Vehicle.parse(VEHICLE)
    table = drive(0.25)
    expected = itpms.estimate(table, vehicle, calibrate_s=100).columns
    found = itpms.estimate(pl.from_pandas(table), vehicle, calibrate_s=100)
    assert type(found.frame()) is pl.DataFrame
    for name, values in found.columns.items():
        np.testing.assert_array_equal(values, expected[name], err_msg=name)
    with pytest.raises(itpms.LogError, match="rr_wheel_speed"):
        itpms.estimate(table.drop(columns="rr_wheel_speed_m_s"), vehicle)


def test_pulses_are_read_beside_the_drive_and_refused_without_wheel_speeds(tmp_path):
    # 48 teeth of a wheel of .31 m; the front left one turns faster by a hundredth.
    time_s = np.arange(0.0, 60.0, 0.02)
    table = {"time_s": time_s, "yaw_rate_rad_s": np.zeros_like(time_s)}
    edges = []
    for number, corner in enumerate(CORNERS):
        speed = np.full_like(time_s, 20.0 * (1.01 if number == 0 else 1.0))
        table[f"{corner}_wheel_speed_m_s"] = speed
        step_s = 2 * np.pi * 0.31 / 48 / speed[0]
        edges.append(pd.DataFrame({"time_s": np.arange(0.01 * number, 60.0, step_s), "wheel": corner}))
    path = tmp_path / "teeth.csv"
    pd.concat(edges).sort_values("time_s").to_csv(path, index=False)
    vehicle = itpms.Vehicle.parse(VEHICLE.replace("[tire]", "[tire]\nrolling_radius_m = 0.31"))
    without = itpms.estimate(table, vehicle, calibrate_s=30)
    result = itpms.estimate(table, vehicle, calibrate_s=30, pulses=path)
    # Teeth at even distances show no resonance: read, and nothing of a pressure.
    assert result.summary["torsion"] == dict.fromkeys(CORNERS) and without.summary["torsion"] is None
    assert "by the tooth pulses" in str(result) and "by the tooth pulses" not in str(without)
    with pytest.raises(itpms.SettingError, match="tooth pulses count together with wheel speeds"):
        itpms.estimate(itpms.simulate("bench-slow"), pulses=path)
    with pytest.raises(itpms.ItpmsError, match=r"no-teeth\.csv"):
        itpms.estimate(table, vehicle, pulses=tmp_path / "no-teeth.csv")
