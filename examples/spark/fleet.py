#!/usr/bin/env python3
"""A fleet's drives on Apache Spark, with a simulated fleet in place of one's own.

    fleet.py [--cars 4] [--drives 4] [--workers 2] [--repeat 1]

Needs Java 17 and `pip install 'itpms[spark,pandas]'`. Prints the wheels that are low and how long the estimates took."""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

from pyspark.sql import SparkSession

import itpms
import itpms.spark


def simulate_fleet(folder, cars, drives):
    """Forty seconds per drive; in each car's last one the front left tire is punctured."""
    (folder / "cars").mkdir()
    for car in range(cars):
        for drive in range(drives):
            last = drive == drives - 1
            made_up = itpms.simulate("drive-puncture", seed=100 * car + drive, truth=False)
            samples = made_up.frame("pandas")
            if not last:
                # Before the puncture at 20 s nothing is wrong.
                samples = samples[samples["time_s"] < 20]
            # One Parquet data set, by car and drive: a folder each.
            place = folder / "logs" / f"car=car-{car}" / f"drive={drive}"
            place.mkdir(parents=True)
            samples.to_parquet(place / "samples.parquet", index=False)
        made_up.vehicle.write(folder / "cars" / f"car-{car}.toml")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cars", type=int, default=4)
    parser.add_argument("--drives", type=int, default=4, help="per car")
    parser.add_argument("--workers", type=int, default=2, help="local ones: drives at a time")
    parser.add_argument("--repeat", type=int, default=1, help="estimate the fleet so many times, to see how long it takes")
    arguments = parser.parse_args()

    # The workers are to have the packages of this interpreter.
    os.environ["PYSPARK_PYTHON"] = sys.executable
    spark = SparkSession.builder.master(f"local[{arguments.workers}]").config("spark.ui.enabled", False).getOrCreate()
    spark.sparkContext.setLogLevel("ERROR")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulate_fleet(folder, arguments.cars, arguments.drives)
        samples = spark.read.parquet(str(folder / "logs"))
        # A few drives only: few tasks, so that each has something to do.
        tasks = min(200, arguments.cars * arguments.drives)
        wheels = itpms.spark.estimate(samples, folder / "cars", partitions=tasks)
        for _ in range(arguments.repeat):
            started = time.monotonic()
            rows = wheels.collect()
            took_s = time.monotonic() - started
            print(f"{len(rows)} wheels of {arguments.cars * arguments.drives} drives in {took_s:.1f} s")
    spark.stop()
    for row in sorted(rows, key=lambda row: (row["car"], row["drive"], row["wheel"] or "")):
        if row["error"] is not None:
            print(f"{row['car']} drive {row['drive']}: {row['error']}")
        elif row["warning"] == "low":
            print(f"{row['car']} drive {row['drive']} {row['wheel']}: low, {row['pressure_kpa']:.0f} kPa, sd {row['pressure_sd_kpa']:.0f}")


if __name__ == "__main__":
    main()
