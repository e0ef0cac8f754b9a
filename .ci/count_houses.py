"""Lines by house and the core's constants by class: `count_houses.py [--check | --against COMMIT [--write PAGE]]`.

    nothing           what there is now, with the ceilings
    --check           fails where a house is above its ceiling, or the core has more constants than it may
    --against COMMIT  a table in Markdown, that commit beside what there is now
    --write PAGE      puts this table between the marks of the page

A line is a line of a Rust file under version control, whatever is on it. A constant is what `count_core.py` calls one; its class follows from
its type and its module: see CLASSES. Firmware figures are those of examples/firmware/counts.txt. A ceiling is today's count, rounded up:
who needs more raises it in the same change and says why; who deletes lowers it. The goals stand in docs/benchmarks.md.
"""

import io
import re
import subprocess
import sys
import tarfile
import tempfile
from collections import Counter
from pathlib import Path

from count_core import OPEN, CLOSE, tokens, without_tests

ROOT = Path(__file__).parent.parent
CORE = ("crates/itpms-core", "crates/itpms-derive")
FORMATS = ("crates/itpms-mdf4", "crates/itpms-can-log", "crates/itpms-opencrg", "crates/itpms-files")
LABORATORY = ("lab/", "crates/itpms-sim", "crates/itpms-paper")
# House, ceiling in lines, goal in lines. The core is a part of the product.
HOUSES = [
    ("core, with its tests", 35_400, 26_000),
    ("product, with the core", 122_855, 92_000),
    ("formats", 16_280, 16_000),
    ("laboratory", 37_050, 34_000),
    ("all, with examples and checks", 177_290, 150_000),
]
# Constants of the core that are numbers to choose, not sizes or names, and fields of its tables that can be set, at most.
CHOSEN = 366
SETTABLE = 149
SIZES = "sizes, indices, layouts, names"
CLASSES = {
    "physics, numerics": ("model", "real", "cholesky", "memory"),
    "signals": ("conditioning", "spectrum"),
    "estimators": ("belief", "car", "cold_pressure", "estimator", "inter_axle", "single_wheel", "suspension"),
    "wheel speeds": ("torsion", "wheel_speed"),
    "faults": ("diagnosis",),
    "warnings": ("decision", "monitor", "warning"),
}
WHOLE = {"usize", "u8", "u16", "u32", "u64", "u128", "i8", "i16", "i32", "i64", "isize", "bool", "str", "char", "Self", "Corner", "Range"}
FIRMWARE = [
    ("instructions a sample on a Cortex-M4F, mean", "instructions_mean"),
    ("the worst sample", "instructions_worst"),
    ("the car in RAM, bytes", "car_bytes"),
    ("stack to take samples, bytes", "stack_to_run_bytes"),
]
MARKS = "<!-- counted -->", "<!-- /counted -->"


def houses(root: Path, files: list[str]) -> dict[str, int]:
    lines = {name: (root / name).read_text().count("\n") for name in files}
    of = lambda prefixes: sum(count for name, count in lines.items() if name.startswith(prefixes))
    product = of("crates/") - of(FORMATS) - of(LABORATORY[1:])
    counts = [of(CORE), product, of(FORMATS), of(LABORATORY), sum(lines.values())]
    return dict(zip([name for name, _, _ in HOUSES], counts))


def types_of_constants(found: list) -> list[set[str]]:
    """The words of each constant's type."""
    types = []
    for i, (_, text, _) in enumerate(found):
        after = [token[1] for token in found[i + 1 : i + 3]]
        if text not in ("const", "static") or len(after) < 2 or after[1] != ":" or (i > 0 and found[i - 1][1] in "<,"):
            continue
        words, depth, j = set(), 0, i + 3
        while j < len(found) and not (depth == 0 and found[j][1] in "=;"):
            depth += (found[j][1] in OPEN) - (found[j][1] in CLOSE)
            words.add(found[j][1])
            j += 1
        types.append(words)
    return types


def classes(root: Path, files: list[str]) -> Counter:
    found, tests = {}, set()
    for name in files:
        if name.startswith("crates/itpms-core/src/"):
            path = Path(name)
            found[path], modules = without_tests(tokens((root / path).read_text()))
            home = path.parent if path.name in ("mod.rs", "lib.rs") else path.with_suffix("")
            tests |= {home / module for module in modules}
    counted = Counter({name: 0 for name in [SIZES, *CLASSES]})
    for path, of_file in found.items():
        if any(test == path.with_suffix("") or test in path.parents for test in tests):
            continue
        module = path.parts[3].removesuffix(".rs")
        home = next((name for name, modules in CLASSES.items() if module in modules), "physics, numerics")
        for words in types_of_constants(of_file):
            counted[SIZES if words & WHOLE and not words & {"f64", "f32"} else home] += 1
    return counted


def settable(root: Path, files: list[str]) -> int:
    """Fields of the tables that the macro `tuning!` makes."""
    tables = [name for name in files if re.fullmatch(r"crates/itpms-core/src/\w+/tuning\.rs", name)]
    return sum(len(re.findall(r"^ +\w+: [\w; \[\]]+ = .*,$", (root / name).read_text(), re.M)) for name in tables)


def firmware(root: Path) -> dict[str, int]:
    rows = [line.split() for line in (root / "examples/firmware/counts.txt").read_text().splitlines()]
    return {figure: int(value) for profile, figure, value in (row for row in rows if row[0] == "dev")}


def git(*arguments: str) -> bytes:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, check=True).stdout


def rust_files() -> list[str]:
    listed = git("ls-files", "--cached", "--others", "--exclude-standard", "*.rs").decode().split()
    return [name for name in listed if (ROOT / name).exists()]


def figures(root: Path, files: list[str]) -> list[tuple[str, int]]:
    by_class, on_firmware = classes(root, files), firmware(root)
    return [
        *((f"lines: {name}", count) for name, count in houses(root, files).items()),
        *((f"constants of the core: {name}", count) for name, count in by_class.items()),
        ("fields of the core's tables that can be set", settable(root, files)),
        *((name, on_firmware[figure]) for name, figure in FIRMWARE),
    ]


def table(commit: str) -> str:
    goals = {f"lines: {name}": goal for name, _, goal in HOUSES}
    number = lambda value: f"{value:,}".replace(",", " ")
    now = figures(ROOT, rust_files())
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(git("archive", commit))) as archive:
            archive.extractall(folder, filter="data")
        before_files = [name for name in git("ls-tree", "-r", "--name-only", commit).decode().split() if name.endswith(".rs")]
        before = dict(figures(Path(folder), before_files))
    rows = [f"| | {commit[:8]} | now | goal |", "|---|---|---|---|"]
    for name, value in now:
        goal = number(goals[name]) if name in goals else ""
        rows.append(f"| {name} | {number(before[name])} | {number(value)} | {goal} |")
    return "\n".join(rows)


def check() -> int:
    files, failed = rust_files(), False
    counts = houses(ROOT, files)
    for name, ceiling, goal in HOUSES:
        print(f"{name:32} {counts[name]:8} lines, ceiling {ceiling}, goal {goal}")
        failed |= counts[name] > ceiling
    chosen = sum(classes(ROOT, files).values()) - classes(ROOT, files)[SIZES]
    print(f"{'numbers of the core to choose':32} {chosen:8}, ceiling {CHOSEN}")
    fields = settable(ROOT, files)
    print(f"{'numbers in tables that can be set':32} {fields:8}, ceiling {SETTABLE}")
    if failed or chosen > CHOSEN or fields > SETTABLE:
        print("above a ceiling of .ci/count_houses.py: delete as much, or raise it there and say why")
        return 1
    return 0


def main(arguments: list[str]) -> int:
    if "--against" not in arguments:
        code = check()
        return code if "--check" in arguments else 0
    made = table(arguments[arguments.index("--against") + 1])
    if "--write" not in arguments:
        print(made)
        return 0
    page = Path(arguments[arguments.index("--write") + 1])
    before, _, rest = page.read_text().partition(MARKS[0])
    _, _, after = rest.partition(MARKS[1])
    page.write_text(f"{before}{MARKS[0]}\n\n{made}\n\n{MARKS[1]}{after}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
