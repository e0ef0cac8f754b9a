"""Holds the units of `itpms fmu` to FMPy: `fmu_judge.py ITPMS FOLDER` packs both versions, has FMPy validate and simulate them, compares
every number with `itpms estimate`'s of the same log, and saves and restores the state in the middle. Needs fmpy."""

import csv
import math
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

CORNERS = ("fl", "fr", "rl", "rr")
RATE_HZ = 500.0
# Two seconds after the nail of `drive-puncture`, at 20 s.
DRIVE_S = 24.0
# simulate_fmu adds up its steps: its times differ from the log's in the last digits.
NEAR_KPA = 0.01


def with_air(path: Path) -> None:
    """A cold morning on a hill: known from the first row on, sent every ten seconds, as a bus has it."""
    head, *rows = path.read_text().splitlines()
    air = [",-10.0,97.5" if index % 5000 == 0 else ",," for index in range(len(rows))]
    path.write_text("\n".join([head + ",ambient_temperature_c,barometric_kpa", *(a + b for a, b in zip(rows, air, strict=True))]) + "\n")


def log_rows(path: Path) -> list[dict[str, float]]:
    with path.open(newline="") as file:
        rows = [{name: float(cell or "nan") for name, cell in row.items()} for row in csv.DictReader(file)]
    return [row for row in rows if row["time_s"] < DRIVE_S]


def estimates(path: Path) -> dict[float, dict[str, str]]:
    with path.open(newline="") as file:
        return {float(row["time_s"]): row for row in csv.DictReader(file) if float(row["time_s"]) < DRIVE_S}


class Unit:
    """One version's unit, driven step by step."""

    def __init__(self, path: Path, fmi: int):
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))
        self.fmi = fmi
        self.reference = {variable.name: variable.valueReference for variable in self.description.modelVariables}
        self.inputs = [v.name for v in self.description.modelVariables if v.causality == "input"]
        self.slave = self.instance()

    def instance(self):
        kind, token = (FMU2Slave, self.description.guid) if self.fmi == 2 else (FMU3Slave, self.description.instantiationToken)
        slave = kind(guid=token, unzipDirectory=self.folder, modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName="car")
        slave.instantiate()
        if self.fmi == 2:
            slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        return slave

    def set(self, row: dict[str, float]) -> None:
        names = [name for name in self.inputs if name in row]
        setter = self.slave.setReal if self.fmi == 2 else self.slave.setFloat64
        setter([self.reference[name] for name in names], [row[name] for name in names])

    def get(self, names: list[str]) -> list[float]:
        getter = self.slave.getReal if self.fmi == 2 else self.slave.getFloat64
        return list(getter([self.reference[name] for name in names]))

    def get_integers(self, names: list[str]) -> list[int]:
        getter = self.slave.getInteger if self.fmi == 2 else self.slave.getInt32
        return list(getter([self.reference[name] for name in names]))

    def get_flag(self, name: str) -> bool:
        return bool(list(self.slave.getBoolean([self.reference[name]]))[0])

    def step(self, time_s: float) -> None:
        self.slave.doStep(currentCommunicationPoint=time_s, communicationStepSize=1.0 / RATE_HZ)

    def serialized(self) -> bytes:
        state = self.slave.getFMUState()
        data = self.slave.serializeFMUState(state)
        self.slave.freeFMUState(state)
        return data

    def restore(self, data: bytes) -> None:
        state = self.slave.deserializeFMUState(data)
        self.slave.setFMUState(state)
        self.slave.freeFMUState(state)


WHAT = ("pressure_kpa", "pressure_sd_kpa", "lost_kpa", "stiffness_n_per_m", "cold_pressure_kpa", "cold_pressure_sd_kpa")
PRESSURES = [f"{corner}_{what}" for corner in CORNERS for what in WHAT]


def same(a: list[float], b: list[float]) -> bool:
    return all(x == y or (math.isnan(x) and math.isnan(y)) for x, y in zip(a, b, strict=True))


def by_hand(unit: Unit, rows: list[dict[str, float]], expected: dict[float, dict[str, str]]) -> int:
    """Every step with the log's own times: the numbers are those of `estimate` to the last digit."""
    compared, warned_s, saved = 0, None, None
    middle = len(rows) // 2
    began, end = time.perf_counter(), []
    for index, row in enumerate(rows):
        unit.set(row)
        unit.step(row["time_s"])
        found = unit.get(PRESSURES)
        if row["time_s"] in expected:
            line = expected[row["time_s"]]
            right = [float(line[name] or "nan") for name in PRESSURES]
            if not same(found, right):
                raise SystemExit(f"FMI {unit.fmi} at {row['time_s']} s: {found}, expected {right}")
            words = ["unknown", "fine", "low", "over", "malfunction", "uncertain"]
            states = [words[state] for state in unit.get_integers([f"{corner}_state" for corner in CORNERS])]
            right_states = [line[f"{corner}_state"] for corner in CORNERS]
            if states != right_states:
                raise SystemExit(f"FMI {unit.fmi} at {row['time_s']} s: {states}, expected {right_states}")
            compared += len(found) + len(states)
        if warned_s is None and unit.get_flag("any_low"):
            warned_s = row["time_s"]
        if index == middle:
            saved = unit.serialized()
        end = found
    took = time.perf_counter() - began
    cold_states = unit.get_integers([f"{corner}_cold_state" for corner in CORNERS])
    # From the middle on again, in the same instance and in a new one.
    for fresh in (False, True):
        if fresh:
            unit.slave.terminate()
            unit.slave.freeInstance()
            unit.slave = unit.instance()
        unit.restore(saved)
        for row in rows[middle + 1 :]:
            unit.set(row)
            unit.step(row["time_s"])
        if not same(unit.get(PRESSURES), end):
            raise SystemExit(f"FMI {unit.fmi}: after a saved state {unit.get(PRESSURES)}, expected {end}")
    damaged = bytearray(saved)
    damaged[len(damaged) // 2] ^= 1
    try:
        unit.restore(bytes(damaged))
    except Exception:
        pass
    else:
        raise SystemExit(f"FMI {unit.fmi}: a damaged state was taken")
    unit.slave.terminate()
    unit.slave.freeInstance()
    print(f"FMI {unit.fmi}: {compared} numbers and states as estimate has them, warned at {warned_s} s; a state of {len(saved)} bytes goes on "
          f"to the same digits; {len(rows) / took:.0f} steps a second from Python")
    cold = [value for name, value in zip(PRESSURES, end, strict=True) if "_cold_" in name]
    if not all(math.isfinite(value) for value in cold) or set(cold_states) - {1, 2}:
        raise SystemExit(f"FMI {unit.fmi}: cold pressures {cold}, states {cold_states}")
    if compared < 28 * 230 or warned_s is None:
        raise SystemExit("that was too little")
    return compared


def by_fmpy(path: Path, fmi: int, rows: list[dict[str, float]], expected: dict[float, dict[str, str]]) -> None:
    """FMPy's own loop: inputs as a table, outputs as it records them, one step later."""
    names = [name for name in rows[0] if name.endswith("_m_s2") or name in ("speed_m_s", "ambient_temperature_c", "barometric_kpa")]
    table = np.array([tuple([row["time_s"], *(row[name] for name in names)]) for row in rows],
                     dtype=[("time", np.float64), *((name, np.float64) for name in names)])
    outputs = [f"{corner}_pressure_kpa" for corner in CORNERS]
    began = time.perf_counter()
    result = simulate_fmu(str(path), stop_time=DRIVE_S, step_size=1 / RATE_HZ, output_interval=1 / RATE_HZ, input=table, output=outputs,
                          fmi_type="CoSimulation")
    took = time.perf_counter() - began
    largest = 0.0
    for time_s, line in expected.items():
        at = int(round((time_s + 1 / RATE_HZ) * RATE_HZ))
        if at >= len(result):
            continue
        for name in outputs:
            right = float(line[name] or "nan")
            if not math.isnan(right):
                largest = max(largest, abs(float(result[name][at]) - right))
    print(f"FMI {fmi}: simulate_fmu differs by {largest:.2g} kPa at most, {(len(result) - 1) / took:.0f} steps a second")
    if not largest <= NEAR_KPA:
        raise SystemExit("more than 0.01 kPa")


def main(program: str, out: str) -> int:
    folder = Path(out)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    log, car, est = folder / "drive.csv", folder / "car.toml", folder / "est.csv"
    run = lambda *words: subprocess.run([program, "-q", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    run("lab", "simulate", "drive-puncture", "--seed", 1, "-o", log, "--vehicle-out", car)
    with_air(log)
    run("estimate", log, "--vehicle", car, "-o", est)
    rows, expected = log_rows(log), estimates(est)
    for fmi in (2, 3):
        unit = folder / f"itpms-{fmi}.fmu"
        run("fmu", "--vehicle", car, "-o", unit, "--fmi", fmi)
        problems = validate_fmu(str(unit))
        if problems:
            print("\n".join(problems))
            return 1
        by_hand(Unit(unit, fmi), rows, expected)
        by_fmpy(unit, fmi, rows, expected)
    missing = subprocess.run([program, "fmu", "--vehicle", car, "-o", folder / "no.fmu", "--library", folder / "no.so"], capture_output=True, text=True)
    if missing.returncode != 2 or "no.so" not in missing.stderr:
        print(f"without a library: exit code {missing.returncode}, {missing.stderr}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
