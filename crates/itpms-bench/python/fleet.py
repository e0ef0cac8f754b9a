#!/usr/bin/env python3
"""A simulated fleet through `itpms fleet` with one and two drives at a time, and through Spark with two local workers: how long each
takes, and whether the rows are the same.

    fleet.py ITPMS [--cars 200] [--drives 500] [--seconds 20] [--spark]

ITPMS is the command's program. Needs Java 17 and `pip install 'itpms[spark,pandas]'` with --spark."""

import argparse
import csv
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import itpms

DRIVE = """
name = "fleet"
description = "Four wheels of one car at 80 km/h on a class A road"
duration_s = {seconds}
rate_hz = 200.0
settle_s = 4.0
wheelbase_m = 2.7
speed.constant_km_h = 80.0
road.surface.iso8608 = {{ roughness = "A", slope = 2.14 }}
sensor.noise_m_s2 = 0.05
antialias = {{ order = 4, corner = 0.3 }}
[car]
[corner.fl]
pressure.constant_kpa = {front}
[corner.fr]
pressure.constant_kpa = 241.3
[corner.rl]
sprung_mass_kg = 216.0
unsprung_mass_kg = 50.0
pressure.constant_kpa = 241.3
[corner.rr]
sprung_mass_kg = 216.0
unsprung_mass_kg = 50.0
pressure.constant_kpa = 241.3
"""


def simulate(folder, cars, drives, seconds):
    """Drives in turn among the cars; of every tenth one the front left tire is at 170 kPa."""
    scenario = folder / "drive.toml"
    (folder / "cars").mkdir()
    for number in range(drives):
        car = f"car-{number % cars:04}"
        scenario.write_text(DRIVE.format(seconds=seconds, front=170.0 if number % 10 == 9 else 241.3))
        made = itpms.simulate(scenario, seed=number, truth=False)
        (folder / "logs" / car).mkdir(parents=True, exist_ok=True)
        made.frame("pandas").to_parquet(folder / "logs" / car / f"{number // cars}.parquet", index=False)
        if number < cars:
            made.vehicle.write(folder / "cars" / f"{car}.toml")


def by_command(itpms_program, folder, jobs):
    """Rows of fleet.csv by car, drive and wheel."""
    started = time.monotonic()
    out = f"out-{jobs}"
    arguments = ["--quiet", "fleet", "logs/**/*.parquet", "--vehicle-dir", "cars", "--out", out, "--jobs", str(jobs)]
    before = os.times()
    subprocess.run([itpms_program, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    with open(folder / out / "fleet.csv", newline="") as file:
        rows = {(row["car"], int(Path(row["file"]).stem), row["wheel"]): row for row in csv.DictReader(file)}
    return rows, time.monotonic() - started, sum(after[2:4]) - sum(before[2:4])


def by_spark(folder, workers):
    import pandas as pd
    from pyspark.sql import SparkSession

    import itpms.spark

    os.environ["PYSPARK_PYTHON"] = sys.executable
    spark = SparkSession.builder.master(f"local[{workers}]").config("spark.ui.enabled", False)
    spark = spark.config("spark.driver.memory", "3g").getOrCreate()
    spark.sparkContext.setLogLevel("ERROR")
    for path in sorted((folder / "logs").glob("*/*.parquet")):
        place = folder / "table" / f"car={path.parent.name}" / f"drive={path.stem}"
        place.mkdir(parents=True)
        pd.read_parquet(path).to_parquet(place / "samples.parquet", index=False)
    samples = spark.read.parquet(str(folder / "table"))
    wheels = itpms.spark.estimate(samples, folder / "cars", partitions=4 * workers)
    wheels.limit(1).collect()
    started = time.monotonic()
    rows = {(row["car"], row["drive"], row["wheel"]): row.asDict() for row in wheels.collect()}
    took_s = time.monotonic() - started
    spark.stop()
    return rows, took_s


def differing(found, expected):
    """Cells of two tables with the same keys that are not the same."""

    def same(value, cell):
        if cell == "":
            return value is None or value == ""
        return float(cell) == value if isinstance(value, (int, float)) else cell == value

    if found.keys() != expected.keys():
        return sorted(found.keys() ^ expected.keys(), key=str)
    names = set(next(iter(expected.values()))) - {"file", "car", "wheel"}
    return [(key, name) for key, row in found.items() for name in names if not same(row[name], expected[key][name])]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("itpms")
    parser.add_argument("--cars", type=int, default=200)
    parser.add_argument("--drives", type=int, default=500)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--spark", action="store_true")
    arguments = parser.parse_args()
    program = str(Path(arguments.itpms).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulate(folder, arguments.cars, arguments.drives, arguments.seconds)
        driven_s = arguments.drives * arguments.seconds
        tables = {}
        for jobs in (1, 2):
            tables[jobs], took_s, processor_s = by_command(program, folder, jobs)
            memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
            print(
                f"fleet, {jobs} at a time: {arguments.drives} drives in {took_s:.0f} s, {processor_s:.0f} s of processor time, "
                f"{driven_s / took_s:.0f} s of driving per second, at most {memory:.0f} MB",
                flush=True,
            )
        print(f"cells that differ between one and two at a time: {len(differing(tables[2], tables[1]))}")
        if arguments.spark:
            rows, took_s = by_spark(folder, 2)
            cells = differing(rows, tables[1])
            print(
                f"Spark, 2 workers: {took_s:.0f} s, {len(rows)} rows, cells that differ from fleet's: {len(cells)} {cells[:3]}"
            )


if __name__ == "__main__":
    main()
