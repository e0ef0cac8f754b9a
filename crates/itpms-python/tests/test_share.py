"""What is handed on: masks, threads, pickles, maps as dicts."""

import copy
import pickle
import threading

import numpy as np
import pytest

import itpms


def test_a_mask_is_a_missing_value(drive):
    columns = dict(drive.columns)
    hidden = np.zeros(len(columns["time_s"]), dtype=bool)
    hidden[100:400] = True
    body = columns["fl_body_accel_m_s2"]
    absurd = np.where(hidden, 1e6, body)
    masked = itpms.estimate(
        columns | {"fl_body_accel_m_s2": np.ma.masked_array(absurd, hidden)}, drive.vehicle, trust_units=True
    )
    missing = itpms.estimate(
        columns | {"fl_body_accel_m_s2": np.where(hidden, np.nan, body)}, drive.vehicle, trust_units=True
    )
    for name, values in missing.columns.items():
        np.testing.assert_array_equal(masked.columns[name], values, err_msg=name)
    assert masked.concerns == missing.concerns


def test_two_threads_take_turns(drive):
    car = itpms.Car(drive.vehicle, 500)
    half = len(drive.columns["time_s"]) // 4
    piece = {name: values[:half] for name, values in drive.columns.items()}
    errors = []

    def work():
        try:
            for _ in range(3):
                car.update(piece)
                assert set(car.states) == {"fl", "fr", "rl", "rr"}
                assert car.corners and car.rate_hz == 500
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []


def test_what_is_pickled_is_the_same(drive, tmp_path):
    car = itpms.Car(drive.vehicle, 500)
    columns = drive.columns
    half = len(columns["time_s"]) // 2
    car.update({name: values[:half] for name, values in columns.items()})
    for twin in (pickle.loads(pickle.dumps(car)), copy.deepcopy(car)):
        rest = {name: values[half:] for name, values in columns.items()}
        first, second = copy.deepcopy(car).update(rest), twin.update(rest)
        for name, values in first.items():
            np.testing.assert_array_equal(second[name], values, err_msg=name)
    assert pickle.loads(pickle.dumps(drive.vehicle)) == drive.vehicle
    result = itpms.estimate(drive)
    again = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(result))))
    assert repr(again) == repr(result) and again.summary == result.summary and again.events == result.events
    for name, values in result.columns.items():
        np.testing.assert_array_equal(again.columns[name], values, err_msg=name)
    result.report(tmp_path / "a.html")
    again.report(tmp_path / "b.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert "<table>" in again._repr_html_() and result.frame("dict").keys() == result.columns.keys()


def test_a_map_is_a_dict_too(drive):
    renamed = {("v" if name == "speed_m_s" else name): values for name, values in drive.columns.items()}
    renamed["v"] = renamed["v"] * 3.6
    result = itpms.estimate(renamed, drive.vehicle, signals={"speed_m_s": {"signal": "v", "unit": "km/h"}})
    expected = itpms.estimate(drive.columns, drive.vehicle)
    np.testing.assert_allclose(result.columns["fl_pressure_kpa"], expected.columns["fl_pressure_kpa"], rtol=1e-6)
    with pytest.raises(itpms.SettingError, match="expected a name or a dict"):
        itpms.estimate(renamed, drive.vehicle, signals={"speed_m_s": 3})
    odd = {("front bounce" if name == "fl_body_accel_m_s2" else name): values for name, values in drive.columns.items()}
    named = {"fl_body_accel_m_s2": {"signal": "front bounce", "unit": "m/s^2"}}
    assert drive.vehicle.check(odd, signals=named).corners == drive.vehicle.check(drive.columns).corners
    assert itpms.vehicle.check(odd, drive.vehicle, signals=named).corners.keys() == {"fl", "fr", "rl", "rr"}


def test_people_read_their_unit(drive, tmp_path):
    kpa, psi = itpms.estimate(drive), itpms.estimate(drive, pressure_unit="psi")
    np.testing.assert_array_equal(psi.columns["fl_pressure_kpa"], kpa.columns["fl_pressure_kpa"])
    assert "psi" in repr(psi) and "kPa" not in repr(psi)
    psi.report(tmp_path / "psi.html")
    assert "placard 35.0 psi" in (tmp_path / "psi.html").read_text()
    with pytest.raises(itpms.SettingError, match="expected one of: kpa, bar, psi"):
        itpms.estimate(drive, pressure_unit="atm")


def test_a_car_of_typical_values_is_the_commands(command, tmp_path):
    path = tmp_path / "car.toml"
    arguments = ("--mass", "1600", "--front-share", "0.5", "--tire", "225/45R18,255/40R18", "--placard-kpa", "230,260")
    command("vehicle", "init", *arguments, "-o", path)
    car = itpms.Vehicle.typical(1600, 0.5, ("225/45R18", "255/40R18"), placard_kpa=(230, 260))
    assert car == itpms.Vehicle.read(path)
    assert [corner["placard_kpa"] for corner in car.corners.values()] == [230, 230, 260, 260]
