#!/usr/bin/env python3
"""Each claim about how good the program is: its command, its figure, when and on which build that was measured.

    validation.py                          checks: docs/validation.md is made of docs/validation.toml, README has its figures, pages name them
    validation.py --write                  writes docs/validation.md and README's table anew
    validation.py --measure RELEASE [ID]   runs again what takes at most --minutes (2) of a processor, or the run or claim named, and notes
                                           figure, date and build; then --write

The figures lie in docs/validation.toml, a run with its claims each; a claim's `take` says where the command's JSON has it. Needs Python 3.11 and
nothing else. The first form is a part of `.ci/run pages`."""

import argparse
import datetime
import json
import re
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATA, PAGE, README = ROOT / "docs" / "validation.toml", ROOT / "docs" / "validation.md", ROOT / "README.md"
# What a controller takes, held by `.ci/run firmware`.
COUNTS = ROOT / "examples" / "firmware" / "counts.txt"
KINDS = {
    "recorded": ("Real recordings", "Wheel speeds of real cars. Of accelerations no recording at hand has a valid pressure: their accuracy is known from "
                 "simulation alone."),
    "other simulation": ("Simulated by others", "Cars and roads simulated by programs whose authors had not seen this one."),
    "simulated": ("Simulated here", "By this project's own simulation ([what it has](math/simulation.md)): what a real car has beside it does not show."),
}
BEGIN, END = "<!-- figures: docs/validation.toml -->", "<!-- end of figures -->"


def goal(claim: dict) -> str:
    unit = claim.get("unit", "")
    bounds = [f"{word} {claim[key]:g} {unit}".strip() for key, word in (("at_least", "at least"), ("at_most", "at most")) if key in claim]
    return " and ".join(bounds)


def number(figure: str) -> float | None:
    found = re.match(r"-?[\d.]+", figure.replace(" ", ""))
    return float(found[0]) if found else None


def missed(claim: dict) -> bool:
    value = number(claim["figure"])
    return value is not None and not (claim.get("at_least", value) <= value <= claim.get("at_most", value))


def shown(claim: dict) -> str:
    """A figure with its unit, bold where it misses its goal."""
    text = f"{claim['figure']} {claim.get('unit', '')}".strip()
    return f"**{text}**" if missed(claim) else text


def claims(data: dict) -> dict[str, dict]:
    named: dict[str, dict] = {}
    for run in data["run"]:
        for claim in run["claims"]:
            if claim["id"] in named:
                sys.exit(f"{DATA.name}: two claims {claim['id']}")
            named[claim["id"]] = claim
    return named


# --- the pages ---------------------------------------------------------------------------------------------------------


def table_of(run: dict) -> list[str]:
    took = f", {run['core_min']:g} min of a processor" if "core_min" in run else ""
    lines = [f"### {run['title']}", "", f"`{run['command']}`  " if "command" in run else f"{run['by']}  ",
             f"{run['measured']}, build {run['build']}{took}", ""]
    if "note" in run:
        lines += [run["note"], ""]
    goals = any(goal(claim) for claim in run["claims"])
    lines += ["| claim | figure | goal |", "|---|---|---|"] if goals else ["| claim | figure |", "|---|---|"]
    for claim in run["claims"]:
        cells = [claim["says"], shown(claim), *([goal(claim)] if goals else [])]
        lines.append(f"| {' | '.join(cells)} |".replace("|  |", "| |"))
    return [*lines, ""]


def page(data: dict) -> str:
    every = list(claims(data).values())
    judged = [claim for claim in every if goal(claim)]
    lines = ["<!-- Made of validation.toml by .ci/validation.py --write: change that. -->", "# Validation", "",
             "Each claim with its command, its figure, and the day and build of the measurement; bold: its goal is missed. The drives are described in "
             "[Accuracy](accuracy.md).", "",
             f"{len(every)} figures, {len(judged)} of them with a goal, {sum(map(missed, judged))} of these missed.", "",
             "`.ci/validation.py --measure target/release` runs the quick commands again and notes what comes out; with a claim's or a run's name also a "
             "long one. Simulated figures are the same on every machine; a figure of an older build may have changed since.", ""]
    for kind, (title, what) in KINDS.items():
        lines += [f"## {title}", "", what, ""]
        for run in (run for run in data["run"] if run["kind"] == kind):
            lines += table_of(run)
    return "\n".join(lines).rstrip() + "\n"


def filled(template: str, named: dict[str, dict]) -> str:
    """`{id}`: figure with unit; `{id.}`: figure alone."""
    def value(match: re.Match) -> str:
        name = match[1]
        if name.rstrip(".") not in named:
            sys.exit(f"{DATA.name}: no claim {name} in: {template}")
        claim = named[name.rstrip(".")]
        return claim["figure"] if name.endswith(".") else f"{claim['figure']} {claim.get('unit', '')}".strip()
    return re.sub(r"\{([\w.-]+)\}", value, template)


def readme_table(data: dict) -> str:
    named = claims(data)
    lines = ["| drive | result |", "|---|---|"]
    lines += [f"| {filled(row['drive'], named)} | {filled(row['result'], named)} |" for row in data["readme"]]
    return "\n".join(lines)


def with_table(text: str, table: str) -> str:
    before, rest = text.split(BEGIN, 1)
    return f"{before}{BEGIN}\n{table}\n{END}{rest.split(END, 1)[1]}"


def write(data: dict) -> None:
    PAGE.write_text(page(data), encoding="utf-8")
    README.write_text(with_table(README.read_text(encoding="utf-8"), readme_table(data)), encoding="utf-8")


def words(text: str) -> str:
    """In one line, without what makes it bold."""
    return re.sub(r"\s+", " ", text.replace("**", ""))


def check(data: dict) -> list[str]:
    faults, named = [], claims(data)
    if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != page(data):
        faults.append("docs/validation.md is not what docs/validation.toml makes of it: .ci/validation.py --write")
    readme = README.read_text(encoding="utf-8")
    if BEGIN not in readme or with_table(readme, readme_table(data)) != readme:
        faults.append("README's table is not that of docs/validation.toml: .ci/validation.py --write")
    for sentence in data["sentences"]:
        text, where = filled(sentence["has"], named), sentence["page"]
        if words(text) not in words((ROOT / where).read_text(encoding="utf-8")):
            faults.append(f"{where} lacks: {text}")
    counts = {line.rpartition(" ")[0]: float(line.rpartition(" ")[2]) for line in COUNTS.read_text().splitlines() if not line.startswith("#")}
    for claim in (claim for claim in named.values() if "counts" in claim):
        value = claim.get("times", 1.0) * counts[claim["counts"]]
        if number(claim["figure"]) != round(value):
            faults.append(f"{claim['id']}: {claim['figure']}, and {COUNTS.name} has {value:.0f}")
    for run in data["run"]:
        if run["kind"] not in KINDS:
            faults.append(f"{run['title']}: no kind {run['kind']}")
        if not {"command", "by"} & run.keys():
            faults.append(f"{run['title']}: neither a command nor by whom it was measured")
        if not re.fullmatch(r"[0-9a-f]{8,}|earlier", run["build"]):
            faults.append(f"{run['title']}: no build {run['build']}")
    return faults


# --- measuring ---------------------------------------------------------------------------------------------------------


def cell(rows: list[dict], part: str, name: str, key: str) -> float:
    for row in rows:
        if row["part"] == part and row["name"] == name:
            return next(cell["value"] for cell in row["cells"] if cell["name"] == key)
    raise KeyError(f"no row {part} / {name}")


def taken(take: str, output: dict) -> float:
    """`part / name / cell` of a score; `a.b.c` of any other; `count a b=c`: of the list a, how many have c as b."""
    if " / " in take:
        part, name, key = take.split(" / ")
        return cell(output["rows"], part, name, key)
    if take.startswith("count "):
        _, where, what = take.split(" ")
        key, value = what.split("=")
        return float(sum(item[key] == value for item in output[where]))
    value = output
    for key in take.split("."):
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


def like(figure: str, value: float) -> str:
    """A value with the decimals that the figure had."""
    decimals = len(figure.partition(".")[2])
    return f"{value:.{decimals}f}"


def measure(data: dict, release: Path, only: str | None, minutes: float) -> list[str]:
    text, faults = DATA.read_text(encoding="utf-8"), []
    version = subprocess.run([release / "itpms", "--version"], capture_output=True, text=True, check=True).stdout
    build = re.search(r"[0-9a-f]{8,}", version)
    if not build:
        return [f"the program does not name its commit: {version.strip()}"]
    for run in data["run"]:
        names = {run["title"], *(claim["id"] for claim in run["claims"])}
        is_wanted = only in names if only else run.get("core_min", 1e9) <= minutes
        if not is_wanted or "command" not in run or not any("take" in claim for claim in run["claims"]):
            continue
        command = shlex.split(run["command"].removeprefix("itpms lab ").removeprefix("itpms "))
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            line = [str(release / "itpms-lab"), "--quiet", *command, "--jobs", "1", "--json"]
            done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            faults.append(f"{run['title']}: exit code {done.returncode}: {done.stderr.strip()[-200:]}")
            continue
        output, core_min = json.loads(done.stdout), (time.monotonic() - began) / 60.0
        for claim in (claim for claim in run["claims"] if "take" in claim):
            new = like(claim["figure"], claim.get("times", 1.0) * taken(claim["take"], output))
            if new != claim["figure"]:
                print(f"{claim['id']}: {claim['figure']} before, {new} now")
            text = re.sub(rf'(id = "{re.escape(claim["id"])}",.*?figure = ")[^"]*', rf"\g<1>{new}", text)
        head = rf'(title = "{re.escape(run["title"])}"\n(?:.*\n)*?)measured = [\d-]+\nbuild = "\w+"\ncore_min = [\d.]+'
        stamp = f'measured = {datetime.date.today()}\nbuild = "{build[0][:8]}"\ncore_min = {max(core_min, 0.1):.1f}'
        text, count = re.subn(head, rf"\g<1>{stamp}", text, count=1)
        if count != 1:
            faults.append(f"{run['title']}: expected measured, build and core_min in this order")
        print(f"{run['title']}: {core_min:.1f} min", flush=True)
        DATA.write_text(text, encoding="utf-8")
    return faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--measure", nargs="+", metavar=("RELEASE", "ID"))
    parser.add_argument("--minutes", type=float, default=2.0)
    args = parser.parse_args()
    data = tomllib.loads(DATA.read_text(encoding="utf-8"))
    faults = []
    if args.measure:
        release = Path(args.measure[0]).resolve()
        for only in args.measure[1:] or [None]:
            faults += measure(data, release, only, args.minutes)
        data = tomllib.loads(DATA.read_text(encoding="utf-8"))
    if args.write or args.measure:
        write(data)
    faults += check(data)
    for fault in faults:
        print(f"FAULT  {fault}")
    print(f"{len(claims(data))} figures: {len(faults)} faults")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
