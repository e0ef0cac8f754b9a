"""The panel: one table by which a change of the estimator is judged, and the same as JSON so that two can be compared.

    panel.py RELEASE_FOLDER -o panel.json [--quick] [--only TEXT] [--firmware "COMMAND"]
    panel.py --compare before.json after.json

Run by `.ci/run panel` (half an hour on two cores) and `.ci/run panel_quick` (five minutes). Measures are taken two at a time, each on
one core. `--compare` marks what got worse by more than a tenth, and by more than 0.5 where the figure is in kPa or s."""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).parent
# Of these figures more is better; of all others less is.
MORE_IS_BETTER = ("inside", "inside_worst", "valid", "passed", "in_time", "named_exactly", "found", "hours_per_core_s",
                  "nearest_to_warning_kpa", "fine")

Figures = dict[str, dict[str, float | None]]


def cells(row: dict) -> dict[str, float | None]:
    return {cell["name"]: cell["value"] for cell in row["cells"]}


def most(values, key=lambda v: v):
    """The largest; `None`, which is what JSON has for infinite and for no figure, above all."""
    values = list(values)
    return None if not values or None in values else max(values, key=key)


# --- what each measure's output says: rows of figures ------------------------------------------------------------------


def one_corner(text: str) -> Figures:
    rows = json.loads(text)["rows"]
    return {
        f"one corner, {row['name']}": {"rmse_kpa": cells(row)["rmse_median_kpa"], "inside": cells(row)["coverage"]}
        for row in rows
    }


def drive(text: str) -> Figures:
    figures: Figures = {}
    for row in json.loads(text)["rows"]:
        cell = cells(row)
        others = most(cell[f"{c}_rmse_median_kpa"] for c in ("fr", "rl", "rr"))
        noisy = ", noisy" if row["part"] == "drive-noise" else ""
        figures[f"drive, {row['name']}{noisy}"] = {
            "struck_kpa": cell["fl_rmse_median_kpa"],
            "others_kpa": others,
            "inside": cell["coverage"],
            "inside_in_fall": cell["coverage_in_change"],
        }
    return figures


def car(text: str) -> Figures:
    """Deviations together: roots of mean squares, sums, and the worst of them."""
    figures: Figures = {}
    for part, name in (("car", "car"), ("car-calibrated", "car, calibrated")):
        rows = [cells(row) for row in json.loads(text)["rows"] if row["part"] == part]
        known = [row["rms_kpa"] for row in rows if row["rms_kpa"] is not None]
        figures[name] = {
            "rms_kpa": (sum(rms**2 for rms in known) / len(known)) ** 0.5,
            "worst_rms_kpa": max(known),
            "inside": sum(row["coverage"] or 0.0 for row in rows) / len(rows),
            "valid": sum(row["valid"] for row in rows) / len(rows),
            "false": sum(row["false_warnings"] for row in rows),
            "sensors_accused": sum(row["sensor_warnings"] for row in rows),
        }
    losses = [cells(row) for row in json.loads(text)["rows"] if row["part"] == "car-loss"]
    figures["car, loss of a fifth"] = {
        "after_worst_s": max((row["after_worst_s"] for row in losses if row["after_worst_s"] is not None), default=None),
        "missed": sum(row["missed"] for row in losses),
        "wrong": sum(row["wrong_wheels"] for row in losses),
        "early": sum(row["early"] for row in losses),
    }
    return figures


def detection(text: str) -> Figures:
    figures: Figures = {}
    for row in json.loads(text)["rows"]:
        if row["name"] in ("one wheel", "all four in a minute", "all four in a minute, reset", "all four in an hour",
                           "all four in an hour, reset"):
            cell = cells(row)
            names = {"after_median_s": "after_median_s", "after_worst_s": "after_worst_s", "missed": "missed",
                     "wrong": "wrong_wheels", "early": "early"}
            figures[f"detection, {row['name']}"] = {name: cell[key] for name, key in names.items()}
    return figures


def own(text: str) -> Figures:
    """Every figure of the score's rows: they are few."""
    return {f"{row['part']}, {row['name']}": cells(row) for row in json.loads(text)["rows"]}


def hours(name: str):
    def read(text: str) -> Figures:
        sums = json.loads(text)
        low = sums["low_margin_kpa"]["value"]
        return {name: {"rms_kpa": sums["rmse_kpa"], "inside": sums["covered"], "valid": sums["valid"],
                       "false": sums["false_warnings"], "nearest_to_warning_kpa": low}}

    return read


def malfunctions(text: str) -> Figures:
    study = json.loads(text)
    total = lambda key: sum(row[key] or 0 for row in study["rows"])  # noqa: E731
    tires = lambda row: sum(row["tire_warnings_during"].values()) + sum(row["tire_warnings_after"].values())  # noqa: E731
    wrong = ("wrong_before_s", "wrong_after_s", "wrong_back_s", "wrong_before_others_s", "wrong_after_others_s",
             "wrong_back_others_s")
    return {
        "malfunctions": {
            "not_said": total("drives") - total("said"),
            "in_time": total("in_time"),
            "named_exactly": total("named_exactly"),
            "others_said": total("others_said"),
            "wrong_s": sum(total(key) for key in wrong),
            "false_of_tires": sum(map(tires, study["rows"])),
            "said_of_none": study["clean"]["malfunctions"] + study["clean"]["warnings"],
        }
    }


def certify(text: str) -> Figures:
    outcomes = json.loads(text)["outcomes"]
    passed = [outcome for outcome in outcomes if outcome["verdict"] == "pass"]
    figures: Figures = {"certify": {"passed": len(passed), "failed": len(outcomes) - len(passed)}}
    figures |= {f"certify FAILED, {o['name']}": {"failed": 1.0} for o in outcomes if o["verdict"] != "pass"}
    return figures


def firmware(text: str) -> Figures:
    found = {name: float(value) for name, value in re.findall(r"^([a-z_]+) (\d+)$", text, re.M)}
    names = ("instructions_mean", "instructions_worst", "car_bytes", "stack_to_build_bytes", "stack_to_run_bytes", "flash_bytes")
    return {"firmware": {name: found[name] for name in names}}


def memory(text: str) -> Figures:
    return {"memory": {"car_f32_bytes": float(re.search(r"MonitoredCar<f32>: (\d+)", text)[1])}}


def speed(text: str) -> Figures:
    times = {rate: float(n) for rate, n in re.findall(r"f64, (\d+) Hz: .* (\d+) times", text)}
    return {f"host, f64, {rate} Hz": {"hours_per_core_s": n / 3600.0} for rate, n in times.items()}


def counted(text: str) -> Figures:
    return {"core": json.loads(text)}


# --- taking them -------------------------------------------------------------------------------------------------------


def measures(args: argparse.Namespace, folder: str) -> list[tuple]:
    """Name, commands whose outputs are read one by one, reader; the longest first."""
    lab = [str(Path(args.release) / "itpms"), "--quiet", "lab"]
    examples = Path(args.release) / "examples"

    def score(*more: str) -> list[str]:
        return [*lab, "score", "--jobs", "1", "--json", *more]

    def soak(name: str, *more: str) -> list[str]:
        return [*lab, "soak", "--jobs", "1", "--json", "--out", f"{folder}/{name}", *more]

    quick = args.quick
    length = ["--hours", "1", "--drive-s", "1200"] if quick else ["--hours", "8"]
    detected = ["--only", "one wheel", "--seeds", "2"] if quick else ["--seeds", "6"]
    driven = ["--only", "car, ", "--seeds", "2"] if quick else ["--seeds", "6"]
    paper = ["paper-drop", "paper-deep-drop", "paper-drop-recover", "bench"]
    taken = [
        ("own", [score("--row", "own", "--quick")], own),
        ("malfunctions", [[*lab, "malfunctions", "--jobs", "1", "--json", "--drives", "3"]], malfunctions),
        ("several", [score("--row", "several", "--seeds", "3" if quick else "6")], own),
        ("car", [score("--row", "car", "--quick")], car),
        ("hours", [soak("hours", *length)], hours("everyday hours")),
        ("hours, calibrated", [soak("calibrated", *length, "--calibrate-s", "600")], hours("everyday hours, calibrated")),
        ("detection", [score("--row", "detection", *detected)], detection),
        ("drive", [score("--row", "drive", *driven)], drive),
        ("certify", [[*lab, "certify", "--jobs", "1", "--quick", "--json"]], certify),
        ("one corner", [score("--row", row, "--seeds", "16") for row in paper], one_corner),
        ("firmware", [["bash", "-c", args.firmware]] if args.firmware else [], firmware),
        ("host", [[str(examples / "drive")]], speed),
        ("memory", [[str(examples / "sizes")]], memory),
        ("core", [[sys.executable, str(HERE / "count_core.py"), "--json"]], counted),
    ]
    left_out = ("malfunctions", "car", "one corner", "firmware", "host") if quick else ()
    return [measure for measure in taken if measure[0] not in left_out and (args.only or "") in measure[0]]


def take(measure: tuple) -> tuple[str, Figures, float, str]:
    """Name, figures, seconds by the clock, why there are none."""
    name, commands, read = measure
    began, figures = time.monotonic(), {}
    if not commands:
        return name, {}, 0.0, "SKIPPED: no QEMU for ARM or no target for it"
    for command in commands:
        code, errors = None, ""
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
            code, errors = done.returncode, done.stderr
            figures |= read(done.stdout)
        except (OSError, ValueError, KeyError, TypeError) as error:
            why = (errors.strip().splitlines() or [f"no output that can be read ({error})"])[-1]
            return name, figures, time.monotonic() - began, f"FAILED: {' '.join(command)}: exit code {code}, {why}"
    print(f"{name}: {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    return name, figures, time.monotonic() - began, ""


def run(args: argparse.Namespace) -> int:
    panel: dict = {"version": 1, "commit": commit(), "quick": args.quick, "figures": {}, "seconds": {}, "without": {}}
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        for name, figures, seconds, why in pool.map(take, measures(args, folder)):
            panel["figures"] |= figures
            panel["seconds"][name] = round(seconds)
            if why:
                panel["without"][name] = why
    Path(args.output).write_text(json.dumps(panel, indent=1) + "\n")
    print(table(panel))
    return int(any(why.startswith("FAILED") for why in panel["without"].values()))


def commit() -> str:
    done = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=HERE, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


# --- showing them ------------------------------------------------------------------------------------------------------


def number(value: float | None) -> str:
    if value is None:
        return "none"
    if value == int(value) and abs(value) < 1e7:
        return f"{int(value)}"
    return f"{value:.3f}" if abs(value) < 2.0 else f"{value:.1f}"


def table(panel: dict) -> str:
    lines = [f"Panel of {panel['commit']}{', quick' if panel['quick'] else ''}.", "", "| row | figures |", "|---|---|"]
    for row, figures in panel["figures"].items():
        lines.append(f"| {row} | {', '.join(f'{name} {number(value)}' for name, value in figures.items())} |")
    lines += [f"| **{name}** | **{why}** |" for name, why in panel["without"].items()]
    return "\n".join(lines)


def worse(name: str, before: float | None, after: float | None) -> bool:
    """By more than a tenth, and by more than 0.5 kPa or s; a figure that is there no more is worse than any."""
    if before is None or after is None:
        return before is not None and after is None
    lost = before - after if name in MORE_IS_BETTER else after - before
    return lost > 0.1 * abs(before) + 1e-9 and (lost > 0.5 or not name.endswith(("_kpa", "_s")) or name in MORE_IS_BETTER)


def compare(before: dict, after: dict) -> str:
    lines = [f"{before['commit']} before, {after['commit']} after.", "", "| row | figure | before | after | |", "|---|---|---|---|---|"]
    rows = list(before["figures"]) + [row for row in after["figures"] if row not in before["figures"]]
    for row in rows:
        old, new = before["figures"].get(row, {}), after["figures"].get(row, {})
        for name in list(old) + [name for name in new if name not in old]:
            if old.get(name) == new.get(name) and name in old and name in new:
                continue
            values = [number(figures[name]) if name in figures else "-" for figures in (old, new)]
            mark = "gone" if name not in new else "**worse**" if name in old and worse(name, old[name], new[name]) else ""
            lines.append(f"| {row} | {name} | {values[0]} | {values[1]} | {mark} |")
    same = sum(old.get(n) == v for row, old in before["figures"].items() for n, v in after["figures"].get(row, {}).items())
    if before["quick"] != after["quick"]:
        lines.append("\nOne of the two is a quick panel: their seeds and hours differ.")
    return "\n".join([*lines, "", f"{same} figures are the same."])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("release", nargs="?", help="folder of the built command and examples, such as target/release")
    parser.add_argument("-o", "--output", default="panel.json")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", help="only measures whose names contain this")
    parser.add_argument("--firmware", help="command that runs the firmware under QEMU")
    parser.add_argument("--compare", nargs=2, metavar=("BEFORE", "AFTER"))
    args = parser.parse_args()
    if args.compare:
        print(compare(*(json.loads(Path(path).read_text()) for path in args.compare)))
        return 0
    if not args.release or not os.path.exists(os.path.join(args.release, "itpms")):
        parser.error("expected the folder of the built command, such as target/release")
    return run(args)


if __name__ == "__main__":
    sys.exit(main())
