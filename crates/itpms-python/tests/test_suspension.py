"""Dampers and load of a drive against a calibration of the same car."""

import json
import pickle

import numpy as np
import pandas as pd
import pytest

import itpms

CORNER = """
[corner.{name}]
sprung_mass_kg = {sprung_kg}
unsprung_mass_kg = 40.0
damping_n_s_per_m = 1500.0
spring_n_per_m = 23000.0
pressure.constant_kpa = 241.3
"""
CAR = """
name = "car"
duration_s = 100.0
rate_hz = 200.0
wheelbase_m = 2.7
speed.constant_km_h = 80.0
road.surface.iso8608 = {{ roughness = "B", slope = 2.0 }}
[car]
{payload}
""" + "".join(
    CORNER.format(name=name, sprung_kg=330.0 if name[0] == "f" else 270.0) for name in ("fl", "fr", "rl", "rr")
)
PAYLOAD = """
[[car.payload]]
behind_front_m = 2.7
left_m = 0.0
points_s_kg = [[0.0, 200.0], [100.0, 200.0]]
"""


def simulated(folder, name: str, payload: str, truth: str) -> itpms.Simulation:
    path = folder / f"{name}.toml"
    path.write_text(CAR.format(payload=payload) + truth)
    return itpms.simulate(str(path), seed=4)


def test_a_worn_damper_and_a_load_are_found(tmp_path):
    first = simulated(tmp_path, "first", "", "")
    reference = tmp_path / "car.reference"
    taught = itpms.estimate(first, calibrate_s=100.0, save_reference=reference)
    assert {damper["because"] for damper in taught.dampers.values()} == {"no reference"}
    assert taught.load["state"] == "unknown" and taught.load["total_kg"] is None
    later = simulated(tmp_path, "later", PAYLOAD, "[corner.rl.truth]\ndamping_factor = 0.4\n")
    found = itpms.estimate(later.columns, first.vehicle, reference=reference)
    assert found.dampers == found.summary["dampers"] and found.load == found.summary["load"]
    assert {name: damper["state"] for name, damper in found.dampers.items()} == {
        "fl": "fine",
        "fr": "fine",
        "rl": "worn",
        "rr": "fine",
    }
    # A table of them, as the docstring says.
    table = pd.DataFrame(found.dampers).T
    assert table.loc["rl", "over_reference"] == pytest.approx(0.4, abs=0.05)
    assert table.loc["rr", "left_right"] == pytest.approx(-0.6, abs=0.05)
    # 1200 kg of body, four wheels of 40 kg, and what lies over the rear axle.
    assert found.load["state"] == "known"
    for name, kg in {"front_axle": 740.0, "rear_axle": 820.0, "total": 1560.0, "added": 200.0}.items():
        assert abs(found.load[f"{name}_kg"] - kg) < 2 * found.load[f"{name}_sd_kg"], name
    # Line by line as the command shows them, and nothing turns with these wheels.
    assert "dampers over the reference: fl fine" in repr(found) and "load: front axle" in repr(found)
    assert {wheel["state"] for wheel in found.once_per_turn.values()} == {"no-line"}
    # What was pickled says the same.
    again = pickle.loads(pickle.dumps(found))
    assert json.dumps(again.load) == json.dumps(found.load)
    checked = first.vehicle.check(later.columns)
    assert checked.dampers["rl"]["left_right"] == pytest.approx(-0.6, abs=0.1)
    assert np.isfinite(checked.dampers["rl"]["wheel_damping_ratio"])


def test_where_corners_are_missing_both_are_empty(drive):
    columns = {name: values for name, values in drive.columns.items() if not name.startswith("rr_")}
    result = itpms.estimate(columns, drive.vehicle, report=False)
    assert result.dampers == {} and result.load == {}
    assert result.cold == {} and result.tire_sensors == {} and set(result.once_per_turn) == {"fl", "fr", "rl"}


def first_seconds(drive: itpms.Simulation, seconds: float) -> dict[str, np.ndarray]:
    begins = drive.columns["time_s"] < seconds
    return {name: values[begins] for name, values in drive.columns.items()}


def test_cold_pressures_and_own_sensors_where_the_drive_has_what_they_need():
    first = itpms.simulate("drive-normal", 3)
    columns = first_seconds(first, 900.0)
    time_s = columns["time_s"]
    columns["ambient_temperature_c"] = np.full_like(time_s, -10.0)
    # Every five seconds; one of them stays where it is as the others warm up by 24 kPa.
    sends = np.arange(len(time_s)) % round(5.0 / (time_s[1] - time_s[0])) == 0
    for name in ("fl", "fr", "rl", "rr"):
        kpa = 230.0 + (0.0 if name == "rl" else 24.0) * time_s / time_s[-1]
        columns[f"{name}_tpms_kpa"] = np.where(sends, np.round(kpa), np.nan)
    result = itpms.estimate(columns, first.vehicle, report=False)
    assert (
        result.cold["fl"] == result.summary["corners"]["fl"]["cold"]
        and result.cold["fl"]["ambient_temperature_c"] == -10.0
    )
    states = {name: sensor["state"] for name, sensor in result.tire_sensors.items()}
    assert states == {"fl": "fine", "fr": "fine", "rl": "stuck", "rr": "fine"}
    assert result.tire_sensors["rl"]["pressure_kpa"] == 230.0


def test_the_roads_map_has_the_places_and_only_where_it_was_asked_for():
    first = itpms.simulate("drive-normal", 3)
    columns = first_seconds(first, 300.0)
    # Northwards from 48 degrees, at what the speed makes of it.
    way_m = np.concatenate([[0.0], np.cumsum(np.diff(columns["time_s"]) * columns["speed_m_s"][1:])])
    columns["latitude_deg"] = 48.0 + way_m / 111_195.0
    columns["longitude_deg"] = np.full_like(way_m, 11.0)
    result = itpms.estimate(columns, first.vehicle, report=False, road_map=True)
    lines = [feature for feature in result.road_map["features"] if feature["geometry"]["type"] == "LineString"]
    assert len(lines) >= 3
    for line in lines:
        [[_, begins], *_, [_, ends]] = line["geometry"]["coordinates"]
        length_m = line["properties"]["end_m"] - line["properties"]["start_m"]
        assert (ends - begins) * 111_195.0 == pytest.approx(length_m, rel=0.02)
    assert any(line["properties"]["iri_m_per_km"] for line in lines)
    with pytest.raises(itpms.SettingError, match="road_map=True"):
        itpms.estimate(columns, first.vehicle, report=False).road_map  # noqa: B018
    with pytest.raises(itpms.ItpmsError, match="latitude_deg"):
        itpms.estimate(first_seconds(first, 60.0), first.vehicle, report=False, road_map=True)
