#!/usr/bin/env python3
"""How fast a drive of four wheels is estimated from Python, and in how much memory; the command's figures beside it.

    speed.py [--minutes 10] [--repeat 3] [--only NAME ...] [--filterpy-s 20]

Every case runs in a process of its own; seconds are the processor's, so that other programs on the machine matter little. `command` and
`command --report` are the program ITPMS, or the one on the path, on the Parquet file that the case `path` reads, too. Memory is what the
operating system counts (Linux): `holds` before the estimate, with interpreter and table, and how much `more` it took at most while
estimating. `filterpy` is the published EKF-UI of all four wheels on filterpy's ExtendedKalmanFilter (needs pip install filterpy), on the
first seconds of the drive, held to the numbers of `itpms` with the same filter; `path, ekf-ui, no report` is `itpms` with it. Like `command`, `path, no report` smooths no road. A `sample` is one of
the whole car everywhere."""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import itpms

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from even_drive import even_drive

RATE_HZ = 500
FRONT = "pressure.constant_kpa = 240.0"
REAR = f"sprung_mass_kg = 216.0\nunsprung_mass_kg = 50.0\n{FRONT}"
CORNERS = {"fl": FRONT, "fr": FRONT, "rl": REAR, "rr": REAR}


def simulate(folder, minutes):
    """The drive as a Parquet file, and its car."""
    (folder / "drive.toml").write_text(even_drive(60.0 * minutes, RATE_HZ, CORNERS))
    made_up = itpms.simulate(folder / "drive.toml", seed=1, truth=False)
    made_up.vehicle.write(folder / "car.toml")
    pq.write_table(pa.table(made_up.columns), folder / "drive.parquet")


def load(case, path):
    """The drive as this case has it, and more arguments."""
    if case == "pandas":
        import pandas as pd

        return pd.read_parquet(path)
    if case == "pandas, datetime index":
        import pandas as pd

        frame = pd.read_parquet(path)
        return frame.set_index(pd.Timestamp("2026-03-01") + pd.to_timedelta(frame.pop("time_s"), unit="s"))
    if case == "polars":
        import polars as pl

        return pl.read_parquet(path)
    if case == "pyarrow":
        return pq.read_table(path)
    if case == "numpy":
        return {name: column.to_numpy() for name, column in zip(*_columns(path), strict=True)}
    if case == "batches":
        # Otherwise pyarrow reads a whole group of rows ahead.
        return pq.ParquetFile(path, pre_buffer=False, buffer_size=65536).iter_batches(8192)
    return path


def _columns(path):
    table = pq.read_table(path)
    return table.column_names, table.columns


CASES = (
    "path",
    "path, no report",
    "path, ekf-ui",
    "pandas",
    "pandas, datetime index",
    "polars",
    "pyarrow",
    "numpy",
    "batches",
)


def memory_mb():
    """What this process holds, and the most that it held since the last call, in MB."""
    lines = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    held, most = (int(lines[name].split()[0]) / 1024 for name in ("VmRSS", "VmHWM"))
    Path("/proc/self/clear_refs").write_text("5")
    return held, most


def python_case(case, folder, repeat):
    drive, car = load(case, folder / "drive.parquet"), itpms.Vehicle.read(folder / "car.toml")
    seconds = []
    held, _ = memory_mb()
    for _ in range(repeat):
        begun = time.process_time()
        estimator = "ekf-ui" if "ekf-ui" in case else "informed"
        result = itpms.estimate(drive, car, estimator=estimator, report=not case.endswith("no report"))
        seconds.append(time.process_time() - begun)
        if case == "batches":
            drive = load(case, folder / "drive.parquet")
    _, most = memory_mb()
    return {"samples": result.summary["rows"], "seconds": seconds, "holds": held, "more": most - held}


def filterpy_case(folder, seconds):
    import published

    table = pq.read_table(folder / "drive.parquet").slice(0, round(RATE_HZ * seconds))
    columns = {name: table.column(name).to_numpy() for name in table.column_names}
    car = itpms.Vehicle.read(folder / "car.toml")
    begun = time.process_time()
    stiffness = {corner: published.run(columns, corner, car.corners[corner], 1 / RATE_HZ) for corner in car.corners}
    took = time.process_time() - begun
    ours = itpms.Car(car, RATE_HZ, estimator="ekf-ui").update(columns)
    for corner, found in stiffness.items():
        apart = np.nanmax(np.abs(found / ours[f"{corner}_stiffness_n_per_m"] - 1))
        assert apart < 1e-3, f"{corner}: not the same filter, its stiffness is {apart:.1e} apart"
    return {"samples": table.num_rows, "seconds": [took], "holds": np.nan, "more": np.nan}


def command_case(program, folder, repeat, report):
    arguments = [program, "--quiet", "estimate", folder / "drive.parquet", "--vehicle", folder / "car.toml"]
    arguments += ["-o", folder / "est.csv"] + (["--report", folder / "page.html"] if report else [])
    seconds, most = [], 0.0
    for _ in range(repeat):
        running = subprocess.Popen(list(map(str, arguments)), stdout=subprocess.DEVNULL)
        # Not what wait4 tells of memory: that begins with what this process held.
        while not (ended := os.wait4(running.pid, os.WNOHANG))[0]:
            lines = Path(f"/proc/{running.pid}/status").read_text().splitlines()
            most = max([most, *(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))])
            time.sleep(0.05)
        _, status, used = ended
        assert status == 0
        seconds.append(used.ru_utime + used.ru_stime)
    rows = pq.ParquetFile(folder / "drive.parquet").metadata.num_rows
    return {"samples": rows, "seconds": seconds, "holds": 0.0, "more": most}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--only", action="append", help="this case; may be given more than once")
    parser.add_argument("--filterpy-s", type=float, default=20.0)
    parser.add_argument("--case", nargs=2, metavar=("CASE", "FOLDER"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.case:
        case, folder = arguments.case[0], Path(arguments.case[1])
        one = (
            filterpy_case(folder, arguments.filterpy_s)
            if case == "filterpy"
            else python_case(case, folder, arguments.repeat)
        )
        print(json.dumps(one))
        return
    program = os.environ.get("ITPMS") or shutil.which("itpms")
    cases = arguments.only or ["command", "command --report", *CASES, "filterpy"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulate(folder, arguments.minutes)
        print(f"{'':24}{'samples/s':>12}{'slowest':>12}{'holds, MB':>12}{'more, MB':>12}")
        for case in cases:
            if case.startswith("command"):
                if program is None:
                    sys.exit("no command itpms; build it and set ITPMS")
                one = command_case(program, folder, arguments.repeat, case.endswith("--report"))
            else:
                own = [
                    "--repeat",
                    str(arguments.repeat),
                    "--filterpy-s",
                    str(arguments.filterpy_s),
                    "--case",
                    case,
                    name,
                ]
                one = json.loads(subprocess.check_output([sys.executable, __file__, *own]))
            fastest, slowest = (one["samples"] / pick(one["seconds"]) for pick in (min, max))
            print(f"{case:24}{fastest:12,.0f}{slowest:12,.0f}{one['holds']:12,.0f}{one['more']:12,.0f}", flush=True)


if __name__ == "__main__":
    main()
