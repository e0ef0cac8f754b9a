"""Drives of a fleet on Spark: row for row what `itpms fleet` writes."""

import csv
import importlib.util
import os
import shutil
import sys

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from even_drive import even_drive

import itpms
import itpms.spark

# Twelve seconds of a whole car; the rear right tire at another pressure from 6 s on.
PLACARD = "pressure.constant_kpa = 241.3"
CORNERS = {"fl": PLACARD, "fr": PLACARD, "rl": PLACARD, "rr": "pressure.points_s_kpa = [[5.5, 241.3], [6.0, REAR]]"}
DRIVE = even_drive(12.0, 200.0, CORNERS, km_h=70.0)
DRIVES = {("alpha", 1): 241.3, ("alpha", 2): 150.0, ("bravo", 1): 241.3, ("bravo", 2): 235.0, ("charlie", 7): 140.0}


@pytest.fixture(scope="module")
def spark():
    if importlib.util.find_spec("pyspark") is None:
        pytest.skip("skipped: pyspark is not installed")
    if shutil.which("java") is None and "JAVA_HOME" not in os.environ:
        pytest.skip("skipped: Java is not installed")
    from pyspark.sql import SparkSession

    # The workers are to have the package that is tested.
    os.environ["PYSPARK_PYTHON"] = sys.executable
    session = (
        SparkSession.builder.master("local[2]")
        .config("spark.ui.enabled", False)
        .config("spark.sql.shuffle.partitions", 3)
        .config("spark.sql.session.timeZone", "UTC")
        # Batches that end within a drive.
        .config("spark.sql.execution.arrow.maxRecordsPerBatch", 700)
        .getOrCreate()
    )
    yield session
    session.stop()


@pytest.fixture(scope="module")
def cars(tmp_path_factory):
    """A folder of three cars, of which one weighs more."""
    folder = tmp_path_factory.mktemp("cars")
    text = simulated(DRIVE, 241.3, 0, folder).vehicle.to_toml()
    for name in ("alpha", "bravo"):
        (folder / f"{name}.toml").write_text(text)
    mass = itpms.Vehicle.parse(text).corners["fl"]["sprung_mass_kg"]
    heavy = text.replace(f"sprung_mass_kg = {mass}", f"sprung_mass_kg = {1.1 * mass:.3f}")
    assert heavy != text
    (folder / "charlie.toml").write_text(heavy)
    return folder


def simulated(text, rear_kpa, seed, folder):
    scenario = folder / "drive.scenario"
    scenario.write_text(text.replace("REAR", str(rear_kpa)))
    return itpms.simulate(scenario, seed)


@pytest.fixture(scope="module")
def drives(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scenarios")
    return {
        drive: simulated(DRIVE, rear_kpa, seed, folder).frame("pandas")
        for seed, (drive, rear_kpa) in enumerate(DRIVES.items())
    }


def shuffled(drives):
    """The samples of all drives in a wild order."""
    pieces = [frame.assign(car=car, drive=drive) for (car, drive), frame in drives.items()]
    samples = pd.concat(pieces, ignore_index=True)
    mixed = samples.iloc[np.random.default_rng(1).permutation(len(samples))]
    return pa.Table.from_pandas(mixed, preserve_index=False)


def same_as(found, expected):
    """A cell of Spark's and one of fleet.csv's, which is empty where a number is missing."""
    if expected == "":
        return found is None or found == ""
    return float(expected) == found if isinstance(found, (int, float)) else expected == found


# What `fleet` is told, and the same in Spark's words.
CALIBRATIONS = {
    "none": ((), {}),
    "each car's first": (("--calibrate-s", 10), {"calibrate_s": 10}),
    "named drives": (
        ("--calibrate-s", 10, "--calibration-drives", "**/bravo/1.parquet"),
        {"calibrate_s": 10, "calibration": "reset"},
    ),
    "too short": (("--calibrate-s", 60), {"calibrate_s": 60}),
}


@pytest.mark.parametrize("calibration", CALIBRATIONS)
def test_the_rows_are_the_fleets(spark, command, cars, drives, tmp_path, monkeypatch, calibration):
    from pyspark.sql import functions

    monkeypatch.chdir(tmp_path)
    for (car, drive), frame in drives.items():
        (tmp_path / "logs" / car).mkdir(parents=True, exist_ok=True)
        frame.to_parquet(tmp_path / "logs" / car / f"{drive}.parquet")
    told, arguments = CALIBRATIONS[calibration]
    command("--quiet", "fleet", "logs/**/*.parquet", "--vehicle-dir", cars, "--out", "out", *told)
    with open("out/fleet.csv", newline="") as file:
        expected = {
            (row["car"], int(row["file"].split("/")[-1].split(".")[0]), row["wheel"]): row
            for row in csv.DictReader(file)
        }
    assert len(expected) == 4 * len(DRIVES)

    samples = spark.createDataFrame(shuffled(drives))
    if "calibration" in arguments:
        samples = samples.withColumn("reset", (functions.col("car") == "bravo") & (functions.col("drive") == 1))
    found = itpms.spark.estimate(samples, cars, **arguments)
    assert found.columns == ["car", "drive", *(name for name, _ in itpms.spark.COLUMNS)]
    rows = {(row["car"], row["drive"], row["wheel"]): row.asDict() for row in found.collect()}
    assert rows.keys() == expected.keys()
    for key, row in rows.items():
        assert row.pop("error") is None
        del row["drive"]
        for name, value in row.items():
            assert same_as(value, expected[key][name]), (key, name, value, expected[key][name])
    # The columns of fleet.csv are all there.
    assert set(next(iter(expected.values()))) - {"file"} == set(row)
    begun = {key[:2]: row["calibration"] for key, row in rows.items()}
    taught, carried = {
        "none": (set(), set()),
        "each car's first": ({("alpha", 1), ("bravo", 1), ("charlie", 7)}, {("alpha", 2), ("bravo", 2)}),
        "named drives": ({("bravo", 1)}, {("bravo", 2)}),
        "too short": (set(), set()),
    }[calibration]
    assert begun == {key: "drive" if key in taught else "carried" if key in carried else "none" for key in DRIVES}
    assert any("taught nothing" in row["concerns"] for row in rows.values()) == (calibration == "too short")
    if calibration == "none":
        low = {key for key, row in rows.items() if row["warnings"] > 0}
        assert low == {("alpha", 2, "rr"), ("charlie", 7, "rr")}


def test_a_stored_reference_is_what_a_drive_starts_with(spark, cars, drives, tmp_path):
    from pyspark.sql import functions

    itpms.estimate(drives["alpha", 1], cars / "alpha.toml", calibrate_s=10, save_reference=tmp_path / "alpha.reference")
    given = {("alpha", 2): drives["alpha", 2], ("bravo", 2): drives["bravo", 2]}
    samples = spark.createDataFrame(shuffled(given))
    # Other names, and a time that is one.
    start_s = 1_772_352_000
    stamped = samples.withColumn(
        "stamp", functions.timestamp_micros(functions.round((samples.time_s + start_s) * 1e6).cast("long"))
    )
    stamped = stamped.drop("time_s").withColumnRenamed("car", "vin").withColumn("day", functions.lit("2026-03-01"))
    found = itpms.spark.estimate(
        stamped,
        {"alpha": cars / "alpha.toml", "bravo": itpms.Vehicle.read(cars / "bravo.toml")},
        car="vin",
        drive=("day", "drive"),
        time="stamp",
        references={"alpha": tmp_path / "alpha.reference"},
    )
    rows = found.toArrow().to_pandas().set_index(["vin", "wheel"])
    assert (rows["calibration"].loc["alpha"] == "carried").all() and (rows["calibration"].loc["bravo"] == "none").all()
    assert (rows["day"] == "2026-03-01").all() and set(rows["drive"]) == {2}
    assert (rows["start_s"] == start_s).all()
    for (car, _), frame in given.items():
        reference = tmp_path / "alpha.reference" if car == "alpha" else None
        one = itpms.estimate(frame, cars / f"{car}.toml", reference=reference).summary["corners"]
        for wheel, corner in one.items():
            # A clock that counts from 1970 has quarters of a microsecond; that is all the difference.
            assert rows.loc[(car, wheel), "pressure_kpa"] == pytest.approx(corner["last"]["pressure_kpa"], abs=0.5)


def test_a_map_says_what_the_columns_are(spark, cars, drives, tmp_path):
    frame = drives["alpha", 2].rename(columns={"fl_wheel_accel_m_s2": "Hub", "time_s": "Stamp"})
    frame["v"] = 3.6 * frame.pop("speed_m_s")
    lines = ['time_s = "Stamp"', 'speed_m_s = { signal = "v", unit = "km/h" }']
    lines += ['fl_wheel_accel_m_s2 = { signal = "Hub", unit = "m/s^2" }']
    (tmp_path / "map.toml").write_text("\n".join(["[signals]", *lines]))
    samples = spark.createDataFrame(shuffled({("alpha", 2): frame}))
    found = itpms.spark.estimate(samples, cars, time="Stamp", signals=tmp_path / "map.toml").collect()
    one = itpms.estimate(drives["alpha", 2], cars / "alpha.toml").summary
    assert [row["error"] for row in found] == 4 * [None]
    for row in found:
        # A speed in km/h has been rounded once more.
        assert row["pressure_kpa"] == pytest.approx(one["corners"][row["wheel"]]["last"]["pressure_kpa"], abs=0.01)
        assert row["distance_m"] == pytest.approx(one["distance_m"])


def test_a_drive_that_fails_is_a_row_and_ends_nothing(spark, cars, drives):
    given = dict(drives)
    given["stranger", 1] = given["bravo", 1]
    given["alpha", 3] = drives["alpha", 1].assign(time_s=lambda frame: 1000 * frame["time_s"])
    given["bravo", 3] = drives["bravo", 1].iloc[:1]
    given[None, 4] = drives["bravo", 1]
    found = itpms.spark.estimate(spark.createDataFrame(shuffled(given)), cars).toArrow().to_pandas()
    failed = found[found["error"].notna()].set_index("drive")
    assert len(found) - len(failed) == 4 * len(DRIVES)
    assert failed["wheel"].isna().all() and failed["pressure_kpa"].isna().all()
    sentences = failed.set_index(failed["car"].fillna("nobody"), append=True)["error"]
    assert len(sentences) == 4
    assert "expected 'stranger' to be one of the 3 vehicles" in sentences[1, "stranger"]
    assert "milliseconds" in sentences[3, "alpha"] and sentences[3, "alpha"].startswith("alpha/3: ")
    assert "1 sample" in sentences[3, "bravo"] or "row" in sentences[3, "bravo"]
    assert "rows without a car" in sentences[4, "nobody"]


def test_what_is_refused_before_anything_is_computed(spark, cars, drives, tmp_path):
    frame = drives["alpha", 1].head(10).assign(car="alpha", drive=1, wheel="x")
    samples = spark.createDataFrame(pa.Table.from_pandas(frame, preserve_index=False))
    (tmp_path / "bad.toml").write_text("[corner.fl]\nmass = 3\n")
    for vehicles, arguments, error, sentence in [
        (cars, {"car": "vin"}, itpms.SettingError, "column vin is not in the data frame"),
        (cars, {"drive": "wheel"}, itpms.SettingError, "column wheel is one of the result"),
        (cars, {"drive": "car"}, itpms.SettingError, "expected different ones"),
        (cars, {"car": None}, itpms.SettingError, "car is None"),
        (cars, {"estimator": "best"}, itpms.SettingError, "expected one of: informed"),
        (cars, {"partitions": 0}, itpms.SettingError, "partitions is 0"),
        (cars, {"references": {"zulu": "x"}}, itpms.SettingError, "references has 'zulu'"),
        (cars, {"calibration": "wheel"}, itpms.SettingError, "without calibrate_s"),
        (cars, {"calibration": "reset", "calibrate_s": 9}, itpms.SettingError, "column reset is not in the data frame"),
        (cars, {"calibrate_s": -9}, itpms.SettingError, "calibrate_s is -9"),
        (cars, {"signals": "none.toml"}, itpms.SettingError, "cannot be read"),
        ({}, {}, itpms.SettingError, "holds no car"),
        (tmp_path, {}, itpms.VehicleError, "unknown key mass"),
        (tmp_path / "none.toml", {}, itpms.VehicleError, "no such file"),
    ]:
        with pytest.raises(error, match=sentence):
            itpms.spark.estimate(samples, vehicles, **arguments)


def test_without_pyspark_it_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyspark", None)
    monkeypatch.setitem(sys.modules, "pyspark.sql", None)
    with pytest.raises(itpms.SettingError, match=r"pyspark.* is not installed, expected pip install pyspark"):
        itpms.spark.estimate(None, "cars")
