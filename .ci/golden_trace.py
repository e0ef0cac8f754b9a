#!/usr/bin/env python3
"""Golden trace: whether a change leaves every number the program writes as it was.

    python3 .ci/golden_trace.py target/release            # compare with .ci/golden_trace.txt
    python3 .ci/golden_trace.py target/release --write    # a change of behavior: write it anew

Simulates a fixed set of drives, estimates them and keeps one line a case: checksums of every number in est.csv and
road.csv and of every event's time, kind and wheels (texts may change), and the last row in words for a reader. After a
refactoring the file must be the same; after a change of the estimator its diff is what to review. Rounding differs
between processors and math libraries, so the comparison is meant for one machine: the first line names it.
"""

import argparse
import csv
import hashlib
import json
import pathlib
import platform
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
SCENARIOS = HERE.parent / "crates/itpms-sim/scenarios"
BASELINE = HERE / "golden_trace.txt"

# Built-in scenario: seconds driven (the long ones are cut).
BUILT_IN = {
    "paper-drop": 40, "paper-deep-drop": 40, "paper-drop-recover": 40,
    "bench-drop": 60, "bench-drop-recover": 60, "bench-slow": 60,
    "drive-puncture": 40, "drive-slow-leak": 90, "drive-diffusion": 90, "drive-normal": 240,
    "example-everything": 10, "example-car": 20,
}
FILTERS = ["aekf-ui-informed", "aekf-ui", "ekf-ui"]

def fault(corner, sensor, kind, from_s=20.0, to_s=45.0):
    return f'[[fault]]\ncorner = "{corner}"\nsensor = "{sensor}"\nfrom_s = {from_s}\nto_s = {to_s}\nkind{kind}\n'

def swap(corner, sensor, other, other_sensor):
    return fault(corner, sensor, f'.swap = {{ with = {{ corner = "{other}", sensor = "{other_sensor}" }} }}')

def gain(corner, sensor, factor):
    return fault(corner, sensor, f".gain.factor = {factor}")

LOST = ".dropout.share = 1.0"
FAULTS = {
    "stuck-wheel": fault("fl", "wheel", ' = "stuck"'),
    "stuck-body": fault("rr", "body", ' = "stuck"'),
    "dropout-wheel": fault("fr", "wheel", LOST),
    "dropout-side": "".join(fault(c, s, LOST) for c in ("fl", "rl") for s in ("body", "wheel")),
    "dropout-axle": "".join(fault(c, s, LOST) for c in ("rl", "rr") for s in ("body", "wheel")),
    "dropout-partial": fault("rl", "body", ".dropout.share = 0.6"),
    "spikes-wheel": fault("fr", "wheel", ".spikes = { per_s = 1.0, size_m_s2 = 50.0 }"),
    "spikes-body": fault("rl", "body", ".spikes = { per_s = 1.0, size_m_s2 = 20.0 }"),
    "noise-wheel": fault("fl", "wheel", ".noise.rms_m_s2 = 2.0"),
    "noise-body": fault("rl", "body", ".noise.rms_m_s2 = 1.0"),
    "gain-half-wheel": gain("fr", "wheel", 0.5),
    "gain-double-wheel": gain("rr", "wheel", 2.0),
    "gain-low-wheel": gain("fl", "wheel", 0.75),
    "gain-high-wheel": gain("rl", "wheel", 1.35),
    "gain-low-body": gain("fr", "body", 0.7),
    "gain-high-body": gain("rr", "body", 1.5),
    "inverted-wheel": gain("rr", "wheel", -1.0),
    "inverted-body": gain("fl", "body", -1.0),
    "bias-wheel": fault("fr", "wheel", ".bias.offset_m_s2 = 5.0"),
    "swap-own": swap("fl", "wheel", "fl", "body"),
    "swap-crossed": swap("fl", "wheel", "rl", "body"),
    "swap-wheels-sides": swap("fl", "wheel", "fr", "wheel"),
    "swap-wheels-axles": swap("fl", "wheel", "rl", "wheel"),
    "swap-bodies-sides": swap("rl", "body", "rr", "body"),
    "swap-bodies-axles": swap("fr", "body", "rr", "body"),
    "swap-corners-sides": swap("rl", "body", "rr", "body") + swap("rl", "wheel", "rr", "wheel"),
    "swap-corners-axles": swap("fr", "body", "rr", "body") + swap("fr", "wheel", "rr", "wheel"),
}


def speed_rows(change):
    """A damage to a log: `change(time_s, speed)` gives the speed to write."""
    def damage(rows):
        at = rows[0].index("speed_m_s")
        for row in rows[1:]:
            row[at] = repr(change(float(row[0]), float(row[at])))
        return rows
    return damage

def holes(rows):
    """Rows lost, out of order, cells empty, a pause of a minute."""
    header, body = rows[0], rows[1:]
    out = [row for i, row in enumerate(body) if i % 977 and not 5000 < i < 5600]
    out[3000], out[3001] = out[3001], out[3000]
    for row in out[9000:9300]:
        row[3] = ""
    for row in out[12000:]:
        row[0] = repr(float(row[0]) + 60.0)
    return [header, *out]

DAMAGE = {
    "speed-rescaled": speed_rows(lambda t, v: v * (1.06 if t > 25 else 1.0)),
    "speed-zero": speed_rows(lambda t, v: 0.0 if t > 25 else v),
    "speed-lost": speed_rows(lambda t, v: float("nan") if 10 < t < 20 else v),
    "holes": holes,
}


class Bench:
    def __init__(self, programs, folder):
        self.itpms, self.folder = programs / "itpms", folder

    def run(self, *args):
        done = subprocess.run([self.itpms, "--quiet", *map(str, args)], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"itpms {' '.join(map(str, args))}\n{done.stderr}")

    def scenario(self, name, built_in, seconds, rate_hz=None, extra=""):
        text = (SCENARIOS / f"{built_in}.toml").read_text()
        lines = []
        for line in text.splitlines():
            if line.startswith("duration_s"):
                line = f"duration_s = {float(seconds)}"
            if line.startswith("rate_hz") and rate_hz:
                line = f"rate_hz = {float(rate_hz)}"
            lines.append(line)
        path = self.folder / f"{name}.toml"
        path.write_text("\n".join(lines) + "\n" + extra)
        return path

    def drive(self, name, scenario, seed=3):
        log, car = self.folder / f"{name}.csv", self.folder / f"{name}.car.toml"
        self.run("simulate", scenario, "--seed", seed, "-o", log, "--vehicle-out", car)
        return log, car

    def estimate(self, name, log, car, *options):
        est, road, events = (self.folder / f"{name}.{kind}" for kind in ("est.csv", "road.csv", "events.jsonl"))
        self.run("estimate", log, "--vehicle", car, "-o", est, "--road-out", road, "--events", events, *options)
        line = f"{name:34} {numbers(est)} {numbers(road)} {happened(events)}  {last_row(est)}"
        for path in (est, road, events):
            path.unlink()
        return line


def sha(parts):
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.encode() + b"\n")
    return digest.hexdigest()[:12]

def numbers(path):
    """Every cell, a number as its exact value, whatever its spelling."""
    def exact(cell):
        try:
            return float(cell).hex()
        except ValueError:
            return cell
    with open(path, newline="") as file:
        return sha(",".join(map(exact, row)) for row in list(csv.reader(file))[1:])

def happened(path):
    """Time, kind and wheels of every event."""
    keys = ("time_s", "event", "kind", "wheels", "since_s", "reported_s")
    events = [json.loads(line) for line in path.read_text().splitlines()]
    return f"{sha(json.dumps([event.get(key) for key in keys]) for event in events)}/{len(events)}"

def last_row(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    cells = []
    for corner in ("fl", "fr", "rl", "rr"):
        if f"{corner}_pressure_kpa" in rows[-1]:
            row = rows[-1]
            mark = "" if row[f"{corner}_valid"] == "true" else "?"
            warned = "" if row[f"{corner}_warning"] == "none" else "!"
            value = [float(row[f"{corner}_{what}"] or "nan") for what in ("pressure_kpa", "pressure_sd_kpa")]
            cells.append(f"{corner} {value[0]:.1f}+-{value[1]:.1f}{mark}{warned}")
    return ", ".join(cells)


def cases(bench):
    """Each case is a function that gives its lines."""
    def plain(name, built_in, seconds, rate_hz=None, extra="", options=((),), damage=None):
        def lines():
            log, car = bench.drive(name, bench.scenario(name, built_in, seconds, rate_hz, extra))
            if damage:
                with open(log, newline="") as file:
                    rows = damage(list(csv.reader(file)))
                with open(log, "w", newline="") as file:
                    csv.writer(file, lineterminator="\n").writerows(rows)
            got = [bench.estimate(" ".join([name, *option]), log, car, *option) for option in options]
            log.unlink()
            return got
        return lines

    for built_in, seconds in BUILT_IN.items():
        yield plain(built_in, built_in, seconds)
    yield plain("filters", "paper-drop", 30, options=[("--estimator", name) for name in FILTERS])
    yield plain("bench-reset", "bench-drop", 60, options=[("--calibrate-s", "20")])
    for rate_hz in (100, 200):
        yield plain(f"puncture-{rate_hz}", "drive-puncture", 40, rate_hz, options=[(), ("--calibrate-s", "15")])
        yield plain(f"corner-{rate_hz}", "paper-drop", 40, rate_hz)
    yield plain("puncture-500", "drive-puncture", 40, 500, options=[("--calibrate-s", "15")])
    for name, tables in FAULTS.items():
        yield plain(name, "drive-puncture", 60, 200, tables)
    for name, damage in DAMAGE.items():
        yield plain(name, "drive-puncture", 60, 500, damage=damage)

    def calibrated():
        """A calibration, stored, and the next drive with it."""
        name, stored = "calibrated", bench.folder / "car.reference"
        log, car = bench.drive(name, bench.scenario(name, "drive-puncture", 120, 200))
        first = bench.estimate(f"{name} first", log, car, "--calibrate-s", "100", "--save-reference", stored)
        next_log, _ = bench.drive(name, bench.scenario(name, "drive-puncture", 60, 500), seed=4)
        kept = [line for line in stored.read_text().splitlines() if not line.startswith(("itpms-reference", "unix_s"))]
        return [first, bench.estimate(f"{name} next", next_log, car, "--reference", stored),
                f"{name} stored {sha(kept)}"]
    yield calibrated


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path, help="folder of the built programs (target/release)")
    parser.add_argument("--write", action="store_true", help="write the file anew instead of comparing")
    args = parser.parse_args()
    programs = args.programs.resolve()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(programs, pathlib.Path(folder))
        with ThreadPoolExecutor(2) as pool:
            lines = [line for got in pool.map(lambda case: case(), cases(bench)) for line in got]
    core = subprocess.run([programs / "examples/trace"], capture_output=True, text=True)
    if core.returncode != 0:
        raise SystemExit(f"the example `trace` of itpms-bench failed\n{core.stderr}")
    lines = [f"# {platform.machine()} {platform.libc_ver()[0]}", *lines, *core.stdout.splitlines()]
    if args.write:
        BASELINE.write_text("\n".join(lines) + "\n")
        print(f"{len(lines) - 1} cases written to {BASELINE.name}")
        return 0
    before = BASELINE.read_text().splitlines()
    if before[0] != lines[0]:
        print(f"the golden trace was written on another kind of machine ({before[0]}), this is {lines[0]}")
        return 77
    changed = sorted(set(before) ^ set(lines))
    for line in changed:
        print("-" if line in before else "+", line)
    print(f"{len(lines) - 1} cases, {len(changed)} lines differ")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
