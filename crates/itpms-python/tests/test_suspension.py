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
