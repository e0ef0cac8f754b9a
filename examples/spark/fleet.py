#!/usr/bin/env python3
"""A simulated fleet's drives on Apache Spark, held row by row against `itpms fleet`.

    fleet.py [--folder FOLDER] [--cars 6] [--drives 3] [--seconds 40] [--first-s 40] [--workers 2] [--repeat 1] [--compare]

Needs Java 17 and `pip install pyspark pandas pyarrow` beside itpms. Cars differ from their vehicle files (../fleet/simulated_fleet.py); each one's first
drive calibrates it. A FOLDER that holds a fleet already is used as it is. Prints the wheels that are low, and how long the estimates took;
with --compare also how long `itpms fleet` (ITPMS, or the one on the path) took with as many drives at a time, and every cell in which the
two differ, and ends with 1 if there is one."""

import argparse
import csv
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from pyspark.sql import SparkSession

import itpms
import itpms.spark

sys.path.insert(0, str(Path(__file__).parent.parent / "fleet"))
from simulated_fleet import add_arguments, make_fleet


def estimate(folder, workers, first_s, repeat):
    """The fleet's rows by car, drive and wheel."""
    # The workers are to have the packages of this interpreter.
    os.environ["PYSPARK_PYTHON"] = sys.executable
    spark = SparkSession.builder.master(f"local[{workers}]").config("spark.ui.enabled", False).getOrCreate()
    spark.sparkContext.setLogLevel("ERROR")
    samples = spark.read.option("recursiveFileLookup", True).parquet(str(folder / "logs"))
    # A car is one task's work: no more tasks than cars.
    tasks = min(200, sum(1 for _ in (folder / "cars").glob("*.toml")))
    wheels = itpms.spark.estimate(samples, folder / "cars", calibrate_s=first_s, partitions=tasks)
    for _ in range(repeat):
        begun = time.monotonic()
        rows = wheels.collect()
        print(f"Spark, {workers} at a time: {len(rows)} wheels in {time.monotonic() - begun:.1f} s", flush=True)
    spark.stop()
    return {(row["car"], row["drive"], row["wheel"]): row.asDict() for row in rows}


def fleet(folder, workers, first_s):
    """The same of the command."""
    program = os.environ.get("ITPMS") or shutil.which("itpms")
    if program is None:
        sys.exit("no command itpms; build it and set ITPMS")
    with tempfile.TemporaryDirectory() as out:
        told = ["--vehicle-dir", folder / "cars", "--calibrate-s", first_s, "--jobs", workers, "--out", f"{out}/fleet"]
        begun = time.monotonic()
        subprocess.run([program, "--quiet", "fleet", f"{folder}/logs/**/*.parquet", *map(str, told)], check=True)
        print(f"itpms fleet, {workers} at a time: {time.monotonic() - begun:.1f} s", flush=True)
        with open(f"{out}/fleet/fleet.csv", newline="") as file:
            rows = list(csv.DictReader(file))
    return {(row["car"], int(row.pop("file").rsplit("-", 1)[1].split(".")[0]), row["wheel"]): row for row in rows}


def differences(found, expected):
    """Cells that are not the same, to the last digit."""
    if found.keys() != expected.keys():
        yield f"{len(found)} rows, expected {len(expected)}"
    for key in found.keys() & expected.keys():
        for name, cell in expected[key].items():
            value = found[key][name]
            same = value in (None, "") if cell == "" else float(cell) == value if isinstance(value, (int, float)) else cell == value
            if not same:
                yield f"{key} {name}: {value}, expected {cell}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path)
    add_arguments(parser, cars=6, drives=3)
    parser.add_argument("--workers", type=int, default=2, help="local ones")
    parser.add_argument("--repeat", type=int, default=1, help="estimate the fleet so many times, to see how long it takes")
    parser.add_argument("--compare", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = arguments.folder or Path(name)
        if not (folder / "cars").exists():
            make_fleet(folder, arguments.cars, arguments.drives, seconds=arguments.seconds, first_s=arguments.first_s)
        rows = estimate(folder, arguments.workers, arguments.first_s, arguments.repeat)
        expected = fleet(folder, arguments.workers, arguments.first_s) if arguments.compare else rows
    for (car, drive, wheel), row in sorted(rows.items(), key=lambda item: tuple(map(str, item[0]))):
        if row["error"] is not None:
            print(f"{car} drive {drive}: {row['error']}")
        elif row["warning"] == "low":
            print(f"{car} drive {drive} {wheel}: low, {row['pressure_kpa']:.0f} kPa, sd {row['pressure_sd_kpa']:.0f}")
    if arguments.compare:
        odd = list(differences(rows, expected))
        print(*odd[:20], f"{len(rows)} rows, {len(odd)} cells differ", sep="\n")
        sys.exit(bool(odd))


if __name__ == "__main__":
    main()
