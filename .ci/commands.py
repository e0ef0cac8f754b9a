"""The command lines of the documentation work as printed.

    python3 .ci/commands.py FOLDER_OF_THE_PROGRAMS FOLDER_TO_RUN_IN

Every fenced line of the pages in RUN is run, in the page's order, in a folder of its own that holds what the page takes for given; what it
writes must be there afterwards. The lines in NOT_RUN are not. Of every page of the documentation each `itpms ...`, fenced or not, is held
against its `--help`: the command exists and knows each option. Needs nothing but Python.
"""

import re
import shlex
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

PROGRAMS, FOLDER = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
ROOT = Path(__file__).resolve().parent.parent
RUN = ["README.md", "docs/vehicle.md", "docs/reset.md", "docs/commands.md", "docs/measurements.md", "docs/introduction.md",
    "docs/field-kit.md", "examples/README.md", "examples/wheel-speeds/README.md"]
READ = sorted({*RUN, *(str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md")), "examples/identify/README.md"})
NOT_RUN = {
    "cargo run --release -p itpms --no-default-features -- demo": "takes a build; the step demo runs it with all features",
    "cargo build --release": "the program is built",
    "cargo test --workspace": "takes many minutes; the step tests runs it",
    "pip install itpms-0.1.0-cp310-abi3-manylinux2014_x86_64.manylinux_2_17_x86_64.whl": "takes a build; the step dist installs it",
    "tar -xzf itpms-0.1.0-x86_64-linux-musl.tar.gz": "the same",
    "sudo apt install ./itpms_0.1.0-1_amd64.deb": "the same",
    "itpms monitor can0 --vehicle car.toml --dbc car.dbc --signals map.toml --http 127.0.0.1:8080": "needs a CAN interface; the step vcan has one",
    "itpms monitor can0 --vehicle car.toml --dbc car.dbc --mcap live.mcap": "the same",
    "itpms estimate bus.mf4 --dbc car.dbc --signals map.toml --vehicle car.toml -o est.csv": "itpms writes no frames into MDF; the step formats reads some",
    "itpms convert bus.mf4 bus.log": "the same",
    "cargo run --release -p itpms-core --example one_wheel": "takes a build; the step stack runs it",
    "pip install '../crates/itpms-python[pandas,plot]' jupyterlab": "takes a build; the step python has it",
    "jupyter lab notebooks/own_log.ipynb": "waits for a reader; the step python runs the notebooks",
    "itpms estimate today.csv --vehicle wheels.toml -o est.csv --reference car.reference --save-reference car.reference":
        "needs dated drives of wheel speeds; crates/itpms/tests/slow_leak.rs runs it",
    "itpms vehicle learn first.csv soft.csv --pressure-kpa 240 --pressure-kpa fl=180,fr=240,rl=240,rr=240 --from wheels.toml -o learned.toml":
        "needs wheel speeds at two pressures; crates/itpms/tests/simulated_wheel_speeds.rs runs it",
    'library=$(../.ci/capi-library x86_64-unknown-linux-gnu f32) && gcc -std=c99 -I ../crates/itpms-capi/include c/pressures.c c/vehicle_file.c "$library" -lm -o out/pressures':
        "takes a build; the step capi has it",
    "out/pressures out/drive.csv out/car.toml > out/c.csv": "the same",
    "cd firmware && cargo run": "takes a build; the step firmware runs it",
}
# Lines after which the reader edits what was written: the map then names the signals whose names do not say enough.
COMPLETED = {"itpms signals drive.log --dbc car.dbc --write-map map.toml": ROOT / "examples" / "can" / "map.toml"}
WRITES = {"-o", "--out", "--write-map", "--report", "--road-out", "--mcap", "--save-reference", "--vehicle-out"}
# Where the program is called in a line: at its beginning or behind a pipe, with or without its folder.
CALL = re.compile(r"(?:^|\| )(?:[^\s=]+/)?itpms (?:help )?")
faults = []


def itpms(folder, *arguments):
    done = subprocess.run([PROGRAMS / "itpms", "-q", *map(str, arguments)], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"itpms {' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stderr}")


def own_drive(folder, name, drive, **changed):
    """A drive of examples/calibration, with other values of its keys where some are named."""
    text = (ROOT / "examples" / "calibration" / f"{drive}.toml").read_text()
    for key, value in changed.items():
        text = re.sub(rf"\b{key} = [\d.]+", f"{key} = {value}", text)
    (folder / "own.toml").write_text(text)
    itpms(folder, "lab", "simulate", "own.toml", "-o", name, "--no-truth")


def bus_drive(folder, *logs):
    """A drive with its vehicle file, and as a log of the example's bus."""
    shutil.copy(ROOT / "examples" / "can" / "car.dbc", folder)
    shutil.copy(ROOT / "examples" / "can" / "map.toml", folder)
    itpms(folder, "lab", "simulate", "drive-puncture", "--seed", 1, "-o", "drive.csv", "--vehicle-out", "car.toml")
    for log in logs:
        itpms(folder, "convert", "drive.csv", log, "--dbc", "car.dbc", "--signals", "map.toml")


def given(page, folder):
    """What a page takes for given: a reader's own logs."""
    wheels = ROOT / "examples" / "wheel-speeds"
    if page == "README.md":
        itpms(folder, "lab", "simulate", "drive-puncture", "--seed", 1, "-o", "drive.csv")
        own_drive(folder, "first.csv", "first")
        own_drive(folder, "later.csv", "later")
        subprocess.run([sys.executable, wheels / "make.py", "bus.log", "1300"], cwd=folder, check=True)
        shutil.copy(wheels / "car.dbc", folder)
    elif page == "docs/reset.md":
        own_drive(folder, "calibration.csv", "first")
        own_drive(folder, "drive.csv", "later")
    elif page == "docs/vehicle.md":
        for name, all_kpa in [("calibration.csv", 240.0), ("drive.csv", 240.0), ("soft.csv", 180.0), ("hard.csv", 240.0)]:
            own_drive(folder, name, "first", duration_s=180.0, constant_kpa=all_kpa)
    elif page == "docs/commands.md":
        bus_drive(folder, "drive.blf")
        itpms(folder, "convert", "drive.csv", "drive.mf4")
    elif page == "docs/measurements.md":
        bus_drive(folder, "drive.log")
        head, rows = (folder / "drive.csv").read_text().split("\n", 1)
        (folder / "other.csv").write_text(f"{head.replace('time_s', 'Time [s]').replace('speed_m_s', 'VehicleSpeed [m/s]', 1)}\n{rows}")
    elif page == "docs/field-kit.md":
        scenario = ROOT / "crates" / "itpms" / "tests" / "data" / "field.toml"
        itpms(folder, "lab", "simulate", scenario, "-o", "drive.csv", "--no-truth")
    elif page == "docs/introduction.md":
        itpms(folder, "lab", "simulate", "drive-puncture", "--seed", 1, "-o", "drive.csv")
        (folder / "target").mkdir()
        (folder / "target" / "release").symlink_to(PROGRAMS)
    else:
        shutil.copytree((ROOT / page).parent, folder, ignore=shutil.ignore_patterns("target", "out"), dirs_exist_ok=True)


def fenced(text):
    """The command lines of a page's blocks, without remarks."""
    for block in re.findall(r"^```(?:sh|bash|console)\n(.*?)^```", text, re.M | re.S):
        for line in block.replace("\\\n", " ").splitlines():
            line = re.sub(r"(^|\s+)#.*", "", line).strip().removeprefix("$ ")
            if line:
                yield line


def named(text):
    """Each `itpms ...` of a page: in blocks, indented or within a line."""
    yield from (line for line in fenced(text) if CALL.search(line))
    yield from (re.sub(r"\s+#.*", "", line) for line in re.findall(r"^ {4}(itpms .*)", text, re.M))
    yield from (span.replace("\\|", "|").replace("\n", " ") for span in re.findall(r"`(itpms [^`]*)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)))


@cache
def options(command):
    """The options that a command's help lists, or nothing if there is no such command."""
    help = subprocess.run([PROGRAMS / "itpms", *command, "--help"], capture_output=True, text=True)
    lines = re.findall(r"^ +(-\w)?(?:, )?(--[\w-]+)?", help.stdout, re.M)
    return {option for line in lines for option in line if option} if help.returncode == 0 else set()


def parse(page):
    for line in dict.fromkeys(named((ROOT / page).read_text(encoding="utf-8"))):
        # From the program on, as far as a pipe; brackets of a synopsis count for nothing.
        words = re.sub(r"[\[\]|]", " ", re.split(r"\s[|>&;]|\s<", line[CALL.search(line).end() :])[0]).split()
        command = []
        for word in words:
            if word.startswith("-") and word != "-q":
                break
            command += [] if word == "-q" or not re.fullmatch(r"[a-z][a-z-]*", word) else [word]
        known = options(tuple(command))
        if not known:
            faults.append(f"{page}: no such command: {line}")
        for option in (w.split("=")[0] for w in words if re.match(r"--?[a-z]", w)):
            if known and option not in known:
                faults.append(f"{page}: `itpms {' '.join(command)}` has no option {option}: {line}")


def run(page):
    folder = FOLDER / Path(page).with_suffix("").as_posix().replace("/", "-")
    folder.mkdir(parents=True)
    given(page, folder)
    # The programs as a reader has them on his path.
    environment = {"PATH": f"{PROGRAMS}:/usr/local/bin:/usr/bin:/bin", "HOME": str(folder), "LC_ALL": "C.UTF-8"}
    for line in fenced((ROOT / page).read_text(encoding="utf-8")):
        if line in NOT_RUN:
            print(f"not run  {page}: {line} ({NOT_RUN[line]})", flush=True)
            continue
        began = time.monotonic()
        done = subprocess.run(line, shell=True, cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        took_s = time.monotonic() - began
        words = shlex.split(line)
        missing = [to for option, to in zip(words, words[1:]) if option in WRITES and not ((folder / to).is_dir() or (folder / to).is_file() and (folder / to).stat().st_size)]
        good = done.returncode == 0 and not missing
        if line in COMPLETED:
            shutil.copy(COMPLETED[line], folder)
        print(f"{'passed ' if good else 'FAILED '}  {took_s:5.1f} s  {page}: {line}", flush=True)
        if not good:
            faults.append(f"{page}: {line}\n    exit code {done.returncode}, not written: {missing}\n{done.stderr[-2000:]}")


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(run, RUN))
        list(pool.map(parse, READ))
    lines = {line for page in RUN for line in fenced((ROOT / page).read_text(encoding="utf-8"))}
    faults.extend(f"no page has the line {line}" for line in [*NOT_RUN, *COMPLETED] if line not in lines)
    for fault in faults:
        print(f"FAULT  {fault}")
    print(f"{len(lines)} lines, {len(NOT_RUN)} of them not run; {len(READ)} pages held against --help: {len(faults)} faults")
    sys.exit(bool(faults))


main()
