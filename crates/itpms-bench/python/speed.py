#!/usr/bin/env python3
"""Samples per second of processor time: the package, the command, and filterpy's extended Kalman filter.

    speed.py ITPMS [--repeat 3]

ITPMS is the command's program. Needs `pip install 'itpms[pandas]' pyarrow filterpy`. A sample is a row of the log with one corner
or four; times are the fastest of so many repetitions."""

import argparse
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

import itpms

# The paper's quarter car (Table 2) in kg, N s/m, N/m.
SPRUNG, UNSPRUNG, DAMPING, SPRING, TIRE = 433.3, 56.9, 1190.0, 21200.0, 230000.0


def fastest(repeat, run):
    """Least seconds of processor time, this process and its children, of several runs."""
    least = float("inf")
    for _ in range(repeat):
        before = os.times()
        run()
        after = os.times()
        least = min(least, sum(after[:4]) - sum(before[:4]))
    return least


def accelerations(x):
    force = DAMPING * (x[3] - x[1]) + SPRING * (x[2] - x[0])
    return np.array([force / SPRUNG, (-force - x[4] * x[2]) / UNSPRUNG])


def jacobian(x):
    body = np.array([-SPRING, -DAMPING, SPRING, DAMPING, 0.0])
    wheel = -body - np.array([0.0, 0.0, x[4], 0.0, x[2]])
    return np.array([body / SPRUNG, wheel / UNSPRUNG])


def extended_kalman(measured, period_s):
    """Body, wheel and the tire's stiffness from two accelerations: the published filter's states without its unknown input, which
    filterpy does not have."""
    filter = ExtendedKalmanFilter(dim_x=5, dim_z=2)
    filter.x = np.array([0.0, 0.0, 0.0, 0.0, TIRE])
    filter.P = np.diag([1e-6, 1e-4, 1e-6, 1e-4, 1e8])
    filter.Q = np.diag([1e-9, 1e-7, 1e-9, 1e-4, 1e4])
    filter.R = np.eye(2) * 0.0025
    for z in measured:
        slope = jacobian(filter.x)
        rate = np.array([[0, 1, 0, 0, 0], slope[0], [0, 0, 0, 1, 0], slope[1], np.zeros(5)])
        filter.F = np.eye(5) + period_s * rate
        filter.predict()
        filter.update(z, jacobian, accelerations)
    return filter.x[4]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("itpms")
    parser.add_argument("--repeat", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        drive = itpms.simulate("drive-puncture", seed=1, truth=False)
        frame = drive.frame("pandas")
        frame.to_parquet(folder / "drive.parquet", index=False)
        drive.vehicle.write(folder / "car.toml")
        command = [
            arguments.itpms,
            "--quiet",
            "estimate",
            "drive.parquet",
            "--vehicle",
            "car.toml",
            "-o",
            "est.parquet",
        ]
        by_command = fastest(
            arguments.repeat, lambda: subprocess.run(command, cwd=folder, check=True, capture_output=True)
        )
        by_frame = fastest(arguments.repeat, lambda: itpms.estimate(frame, drive.vehicle))
        by_path = fastest(arguments.repeat, lambda: itpms.estimate(folder / "drive.parquet", drive.vehicle))
        rows = len(frame)
        print(
            f"four wheels, {rows} rows: command {rows / by_command:.0f}, package from a file {rows / by_path:.0f}, ",
            end="",
        )
        print(f"from a frame {rows / by_frame:.0f} rows/s; package over command {by_command / by_frame:.2f}")
    corner = itpms.simulate("paper-drop", seed=1, truth=False)
    one = corner.frame("pandas")
    period_s = float(np.median(np.diff(one["time_s"])))
    name = next(column for column in one if column.endswith("_body_accel_m_s2"))[:2]
    measured = one[[f"{name}_body_accel_m_s2", f"{name}_wheel_accel_m_s2"]].to_numpy()
    started = time.process_time()
    stiffness = extended_kalman(measured, period_s)
    by_filterpy = time.process_time() - started
    published = fastest(arguments.repeat, lambda: itpms.estimate(one, corner.vehicle, estimator="ekf-ui"))
    default = fastest(arguments.repeat, lambda: itpms.estimate(one, corner.vehicle))
    rows = len(one)
    print(
        f"one corner, {rows} rows: filterpy {rows / by_filterpy:.0f} (stiffness {stiffness / 1e3:.0f} N/mm), ", end=""
    )
    print(f"published filter {rows / published:.0f}, default estimator {rows / default:.0f} rows/s; ", end="")
    print(f"published over filterpy {by_filterpy / published:.0f}, default over filterpy {by_filterpy / default:.0f}")
    print(f"most memory of this process {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


main()
