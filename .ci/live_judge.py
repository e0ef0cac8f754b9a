"""cantools reads our own DBC, and what it decodes of the frames of `itpms monitor --can-out` is what the lines of JSON say.

    python3 .ci/live_judge.py target/release/itpms

Needs cantools and python-can; exit code 77 without them.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import can
    import cantools
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

WORDS = {"wheels": {"state": "State", "warning": "Warning", "level": "Level"}}
# Half a step of each signal and a little for the rounding of sums.
NUMBERS = {"pressure_kpa": ("Pressure", 0.005), "pressure_sd_kpa": ("PressureSd", 0.05), "reference_kpa": ("Reference", 0.005), "gate": ("Gate", 0.0025)}


def run(program: str, folder: Path, *words: str) -> str:
    done = subprocess.run([program, *words], cwd=folder, check=True, stdout=subprocess.PIPE, timeout=300)
    return done.stdout.decode()


def expect(condition: bool, what: str) -> None:
    if not condition:
        sys.exit(f"error: {what}")


def number(value) -> int:
    """The number behind a value that may have a name."""
    return int(getattr(value, "value", value))


def compare(snapshot: dict, frames: list[tuple[str, dict]]) -> int:
    """Holds the frames of one set against the line they were made of; gives the number of values compared."""
    compared = 0
    for wheel in snapshot["wheels"]:
        corner = wheel["corner"].upper()
        values = dict(frames)[f"ITPMS_{corner}"]
        for key, (signal, half_a_step) in NUMBERS.items():
            found, told = values[f"ITPMS_{signal}_{corner}"], wheel[key]
            if told is None:
                expect(str(found) == "SNA", f"{signal} {corner}: {found} instead of SNA")
            else:
                # What a signal cannot say is sent as its nearest.
                message_signal = database.get_message_by_name(f"ITPMS_{corner}").get_signal_by_name(f"ITPMS_{signal}_{corner}")
                told = min(max(told, message_signal.minimum), message_signal.maximum)
                expect(abs(float(found) - told) <= half_a_step * 1.001, f"{signal} {corner}: {found} instead of {told}")
            compared += 1
        for key, signal in WORDS["wheels"].items():
            found = str(values[f"ITPMS_{signal}_{corner}"])
            expect(found == wheel[key], f"{signal} {corner}: {found} instead of {wheel[key]}")
            compared += 1
        deviations = dict(frames)["ITPMS_Deviations"]
        axle = {"F": "ITPMS_AxleDifferenceSd_F", "R": "ITPMS_AxleDifferenceSd_R"}[corner[0]]
        for key, signal in {"change_sd_kpa": f"ITPMS_ChangeSd_{corner}", "axle_difference_sd_kpa": axle}.items():
            found, told = deviations[signal], wheel[key]
            if told is None:
                expect(str(found) == "SNA", f"{signal}: {found} instead of SNA")
            else:
                expect(abs(float(found) - min(told, 102.2)) <= 0.05 * 1.001, f"{signal}: {found} instead of {told}")
            compared += 1
        expect(number(values[f"ITPMS_Valid_{corner}"]) == int(wheel["valid"]), f"Valid {corner}")
    status = dict(frames)["ITPMS_Status"]
    expect(str(status["ITPMS_Source"]) == snapshot["source"]["state"], "Source")
    expect(number(status["ITPMS_AllFine"]) == int(snapshot["all_fine"]), "AllFine")
    expect(number(status["ITPMS_Counter"]) == snapshot["seq"] % 256, "Counter")
    return compared


program = str(Path(sys.argv[1]).resolve())
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    (folder / "itpms.dbc").write_text(run(program, folder, "monitor", "--print-dbc"))
    run(program, folder, "-q", "simulate", "drive-puncture", "-o", "drive.csv", "--vehicle-out", "car.toml")
    run(program, folder, "-q", "monitor", "--replay", "drive.csv", "--speed", "max", "--vehicle", "car.toml", "--json", "live.jsonl", "--can-out", "out.log")
    database = cantools.database.load_file(folder / "itpms.dbc", strict=True)
    snapshots = [line for line in map(json.loads, (folder / "live.jsonl").read_text().splitlines()) if line["type"] == "estimate"]
    sets: list[list[tuple[str, dict]]] = []
    for frame in can.LogReader(folder / "out.log"):
        message = database.get_message_by_frame_id(frame.arbitration_id)
        if message.name == "ITPMS_Status":
            sets.append([])
        sets[-1].append((message.name, message.decode(frame.data)))
    expect(len(sets) == len(snapshots), f"{len(sets)} sets of frames for {len(snapshots)} estimates")
    compared = sum(compare(snapshot, frames) for snapshot, frames in zip(snapshots, sets))
    print(f"{len(sets)} sets of frames, {compared} values as in the lines of JSON; itpms.dbc is strict")
