"""Vehicles, made-up drives and roads."""

import copy
import json

import numpy as np
import pytest

import itpms


def golden_car(heights, dx):
    """IRI by ASTM E1926's golden car, its four equations stepped exactly, in numpy alone; no enveloping."""
    k1, k2, c, mu = 653.0, 63.3, 6.0, 0.15
    speed = 80 / 3.6
    a = np.array([[0, 1, 0, 0], [-k2, -c, k2, c], [0, 0, 0, 1], [k2 / mu, c / mu, -(k1 + k2) / mu, -c / mu]])
    b = np.array([0, 0, 0, k1 / mu])
    # exp(A dt) by scaling and squaring of the series, and the exact response to a constant input.
    dt = dx / speed
    big = np.zeros((5, 5))
    big[:4, :4], big[:4, 4] = a * dt, b * dt
    term, total = np.eye(5), np.eye(5)
    for n in range(1, 20):
        term = term @ big / 2**8 / n
        total = total + term
    for _ in range(8):
        total = total @ total
    step, push = total[:4, :4], total[:4, 4]
    slopes = np.diff(heights) / dx
    start = (heights[round(11 / dx)] - heights[0]) / (round(11 / dx) * dx)
    state = np.array([start, 0, start, 0])
    summed = 0.0
    for slope in slopes:
        state = step @ state + push * slope
        summed += abs(state[0] - state[2])
    return 1000 * summed / len(slopes)


def test_the_roughness_is_the_standards():
    rng = np.random.default_rng(5)
    heights = np.cumsum(rng.normal(0, 0.002, 2000))
    assert itpms.iri(heights, 0.25, enveloped=True) == pytest.approx(golden_car(heights, 0.25), rel=1e-3)
    assert itpms.iri(np.zeros(500), 0.1) == 0.0
    assert itpms.iri(3 * heights, 0.25) == pytest.approx(3 * itpms.iri(heights, 0.25), rel=1e-12)
    parts = itpms.iri(heights, 0.25, segment_m=100.0)
    assert parts.shape == (4,)
    assert np.isnan(itpms.iri([0.0], 0.25))
    for dx in (0.0, 2.0, float("nan")):
        with pytest.raises(itpms.SettingError, match="profile spacing"):
            itpms.iri(heights, dx)
    with pytest.raises(itpms.SettingError, match="segment_m"):
        itpms.iri(heights, 0.25, segment_m=0.1)


def test_a_vehicle_reads_back_as_it_was_written(tmp_path):
    car = itpms.Vehicle.paper()
    car.write(tmp_path / "car.toml")
    again = itpms.Vehicle.read(str(tmp_path / "car.toml"))
    assert again == car and hash(again) == hash(car)
    # Table 2 and eq. (5) of the paper.
    front = car.corners["fl"]
    for write in (
        lambda: front.update(placard_kpa=200.0),
        lambda: car.corners.pop("fl"),
        lambda: front.__setitem__("placard_kpa", 200.0),
    ):
        with pytest.raises(TypeError, match="a Vehicle does not change"):
            write()
    assert type(copy.deepcopy(car.corners)["fl"]) is dict and json.loads(json.dumps(car.corners)) == car.corners
    assert (front["sprung_mass_kg"], front["unsprung_mass_kg"], front["spring_n_per_m"]) == (240.8, 56.9, 29114.0)
    assert (front["stiffness_per_kpa"], front["stiffness_at_zero"]) == (713.91, 60880.0)
    assert (car.wheelbase_m, car.id) == (2.7, None)
    with pytest.raises(itpms.VehicleError, match="line 2: unknown key mass"):
        itpms.Vehicle.parse("[corner.fl]\nmass = 3\n")
    with pytest.raises(itpms.OutputError):
        car.write(tmp_path / "no" / "car.toml")


def test_the_same_seed_makes_the_same_drive():
    one, same, other = (itpms.simulate("paper-drop", seed=seed) for seed in (4, 4, 5))
    for name, values in one.columns.items():
        np.testing.assert_array_equal(values, same.columns[name])
    assert not np.array_equal(one.columns["fl_road_m"], other.columns["fl_road_m"])
    # The paper's drop, in the scenario's words: 241.3 kPa until 20 s, 137.9 from 22.5 s on.
    time_s, pressure = one.columns["time_s"], one.columns["fl_pressure_kpa"]
    np.testing.assert_allclose(pressure[time_s < 20], 241.3, atol=1e-9)
    np.testing.assert_allclose(pressure[time_s > 22.5], 137.9, atol=1e-9)
    assert "fl_road_m" not in itpms.simulate("paper-drop", truth=False).columns
    assert "paper-drop" in itpms.scenarios()
    with pytest.raises(itpms.ScenarioError, match="paper-drop"):
        itpms.simulate("paper-dropp")
    with pytest.raises(itpms.SettingError, match="seed is -1"):
        itpms.simulate("paper-drop", seed=-1)
