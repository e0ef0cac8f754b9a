#!/usr/bin/env python3
"""`itpms fleet` on a simulated fleet with broken files in it, killed in the middle and started again.

    trial.py [--folder FOLDER] [--cars 100] [--drives 5] [--seconds 20] [--first-s 25] [--jobs 2] [--out OUT]

Three files more are put among the drives: one that is cut off, an empty one, and one whose time is in milliseconds. The first run is killed
(SIGKILL) when a third of the drives are done; the same command then goes on. Ends with 1 unless every drive is estimated once, the broken
files and no others have failed, and the tires that lost pressure are those that were warned of. Prints how fast it was and how much
memory it held (Linux). ITPMS is the program, or else the one on the path. A FOLDER that holds a fleet already is used as it is."""

import argparse
import csv
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import pandas as pd
from simulated_fleet import PLACARD_KPA, add_arguments, make_fleet


def break_some(logs):
    """Three files that cannot be used; gives their names."""
    folders = sorted(logs.iterdir())[:3]
    cut, empty, milliseconds = (
        folder / f"drive-{name}.parquet" for folder, name in zip(folders, ("cut-off", "empty", "milliseconds"), strict=True)
    )
    whole = folders[0] / "drive-0.parquet"
    content = whole.read_bytes()
    cut.write_bytes(content[: len(content) // 2])
    empty.write_bytes(b"")
    frame = pd.read_parquet(whole)
    frame.assign(time_s=1000 * frame["time_s"]).to_parquet(milliseconds, index=False)
    return {str(path) for path in (cut, empty, milliseconds)}


class Run:
    """The command at work, watched."""

    def __init__(self, folder, out, first_s, jobs):
        program = os.environ.get("ITPMS") or shutil.which("itpms") or sys.exit("no command itpms; build it and set ITPMS")
        told = ["--vehicle-dir", folder / "cars", "--calibrate-s", first_s, "--jobs", jobs, "--out", out, "--reports"]
        self.begun, self.records, self.held = time.monotonic(), out / "drives.jsonl", []
        self.process = subprocess.Popen([program, "--quiet", "fleet", f"{folder}/logs/**/*.parquet", *map(str, told)])
        self.watcher = threading.Thread(target=self.watch)
        self.watcher.start()

    def done(self):
        """Drives that are on the disk; the first line is no drive."""
        return max(self.records.read_bytes().count(b"\n") - 1, 0) if self.records.exists() else 0

    def watch(self):
        while self.process.poll() is None:
            try:
                status = Path(f"/proc/{self.process.pid}/status").read_text()
            except OSError:
                break
            held = [int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmRSS")]
            self.held += [(self.done(), mb) for mb in held]
            time.sleep(0.2)

    def wait(self):
        code = self.process.wait()
        self.watcher.join()
        return code, time.monotonic() - self.begun


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--out", type=Path)
    add_arguments(parser, cars=100, drives=5, seconds=20.0, first_s=25.0)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder, out = arguments.folder or Path(name) / "fleet", arguments.out or Path(name) / "out"
        if not (folder / "cars").exists():
            make_fleet(folder, arguments.cars, arguments.drives, seconds=arguments.seconds, first_s=arguments.first_s)
        sys.exit(not trial(folder, out, arguments.first_s, arguments.jobs))


def trial(folder, out, first_s, jobs):
    truth = pd.read_csv(folder / "truth.csv").set_index(["car", "drive", "wheel"])["pressure_kpa"]
    drives = len(truth) // 4
    broken = break_some(folder / "logs")

    first = Run(folder, out, first_s, jobs)
    while first.done() < drives // 3 and first.process.poll() is None:
        time.sleep(0.1)
    first.process.send_signal(signal.SIGKILL)
    code, first_took_s = first.wait()
    kept = first.done()
    print(f"killed after {first_took_s:.1f} s with {kept} of {drives} drives done (exit code {code})", flush=True)

    second = Run(folder, out, first_s, jobs)
    code, took_s = second.wait()
    with open(out / "fleet.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    with open(out / "failed.csv", newline="") as file:
        failed = {row["file"]: row["error"] for row in csv.DictReader(file)}
    files = [row["file"] for row in rows]
    driven_s = sum(float(row["duration_s"]) for row in rows) / 4
    done_s = driven_s * (drives - kept) / drives
    print(f"went on to the end in {took_s:.1f} s (exit code {code}): {drives - kept} drives, {(drives - kept) / took_s:.1f} drives and {done_s / took_s:.0f} s of driving per second, {jobs} at a time")
    lines = [line.split(b'"file":"')[1].split(b'"')[0].decode() for line in (out / "drives.jsonl").read_bytes().splitlines()[1:]]
    print(f"{len(lines)} records of {len(set(lines))} drives; {len(failed)} failed:")
    for path, why in failed.items():
        print(f"  {Path(path).parent.name}/{Path(path).name}: {why.removeprefix(f'{path}: ')}")
    for part, label in ((0.1, "a tenth"), (0.5, "half"), (1.0, "all")):
        upto = kept + part * (drives - kept)
        print(f"memory at most with {label} of these drives done: {max(mb for done, mb in second.held if done <= upto):.0f} MB")

    key = lambda row: (row["car"], int(row["file"].rsplit("-", 1)[1].split(".")[0]), row["wheel"])  # noqa: E731
    lost = {key for key, kpa in truth.items() if kpa < 0.8 * PLACARD_KPA}
    warned = {key(row) for row in rows if row["warning"] == "low"}
    valid = [(key(row), row) for row in rows if row["pressure_kpa"]]
    errors = pd.Series([float(row["pressure_kpa"]) - truth[which] for which, row in valid])
    inside = pd.Series([abs(float(row["pressure_kpa"]) - truth[which]) < 1.96 * float(row["pressure_sd_kpa"]) for which, row in valid])
    print(f"tires that lost a fifth and more: {len(lost)} at the end of a drive, warned of at its end: {len(lost & warned)}, falsely: {len(warned - lost)}")
    print(f"last pressures: {errors.pow(2).mean() ** 0.5:.1f} kPa rms, {100 * inside.mean():.0f} % inside the 95 % band, {len(valid)} of {len(rows)} known")

    good = code == 0 and sorted(files) == sorted(4 * list(set(files))) and len(set(files)) == drives
    good &= set(failed) == broken and sorted(lines) == sorted(set(files)) and (out / "index.html").exists()
    if not good:
        print("not every drive was estimated once, or others failed than the broken ones")
    return good


if __name__ == "__main__":
    main()
