#!/usr/bin/env python3
"""Steps of a radius put into a real log of wheel speeds: how many are found, how fast, and whether a wrong wheel is named.

    injections.py ITPMS LOG [--dbc CAR.dbc] --vehicle V.toml --step 0.2 [--calibrate-s 15] [--onsets 36,40,42,46]

From each onset (s since the first row) on, one wheel after the other turns by the step (%) faster, as one with a smaller radius does; the
same log without a step is the healthy one. Prints JSON: found, of, worst_s (from the onset to the warning), wrong, healthy_reports. Called
for docs/validation.toml; needs nothing but Python and a recording, which is not part of the project."""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

WHEELS = ("fl", "fr", "rl", "rr")


def run(*words: object) -> str:
    done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("itpms")
    parser.add_argument("log")
    parser.add_argument("--dbc")
    parser.add_argument("--vehicle", required=True)
    parser.add_argument("--step", type=float, required=True)
    parser.add_argument("--calibrate-s", type=float, default=15.0)
    parser.add_argument("--onsets", default="36,40,42,46")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        plain, changed = Path(folder) / "plain.csv", Path(folder) / "changed.csv"
        run(args.itpms, "-q", "convert", args.log, plain, *(["--dbc", args.dbc] if args.dbc else []))
        with plain.open(newline="") as file:
            head, *rows = csv.reader(file)
        times = [float(row[head.index("time_s")]) for row in rows]

        def reported(wheel: str | None, onset_s: float) -> list[dict]:
            column = head.index(f"{wheel}_wheel_speed_m_s") if wheel else None
            with changed.open("w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(head)
                for time_s, row in zip(times, rows):
                    new = list(row)
                    if column is not None and time_s - times[0] >= onset_s and new[column]:
                        new[column] = repr(float(new[column]) * (1.0 + 0.01 * args.step))
                    writer.writerow(new)
            summary = run(args.itpms, "-q", "estimate", changed, "--vehicle", args.vehicle, "-o", Path(folder) / "est.csv",
                          "--calibrate-s", args.calibrate_s, "--json")
            return json.loads(summary)["alerts"]

        found, worst_s, wrong, cases = 0, 0.0, 0, 0
        for onset_s in map(float, args.onsets.split(",")):
            for wheel in WHEELS:
                cases += 1
                alerts = reported(wheel, onset_s)
                named = [alert for alert in alerts if wheel in alert["wheels"]]
                wrong += any(set(alert["wheels"]) - {wheel} for alert in alerts)
                if named:
                    found += 1
                    worst_s = max(worst_s, min(alert["reported_s"] for alert in named) - times[0] - onset_s)
        healthy = len(reported(None, 0.0))
    print(json.dumps({"found": found, "of": cases, "worst_s": worst_s, "wrong": wrong, "healthy_reports": healthy}))


main()
