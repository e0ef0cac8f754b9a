"""One drive through every format, written by the formats' own Python libraries: the estimates have to be the same.

    python .ci/formats.py ITPMS_BINARY FOLDER

Tables and MDF4 hold the very numbers, so their estimates are the same to the byte. A bus rounds: its log is held against a
table of the rounded values, where only the stamps' microseconds differ, and against the original, where the rounding
itself shows. Needs numpy, asammdf, python-can and cantools.
"""

import csv
import subprocess
import sys
from pathlib import Path

import can
import cantools
import numpy as np
from asammdf import MDF, Signal

BINARY, FOLDER = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "can"
DBC, MAP = EXAMPLE / "car.dbc", EXAMPLE / "map.toml"
# Both as shares of the estimate's own standard deviation. Half a microsecond of a wheel that moves at 30 m/s^2 and 60 rad/s
# is 0.001 m/s^2 beside noise of 0.05: a fiftieth, a little more while the pressure falls.
STAMPS_SD = 0.05
# Half a step of 0.01 m/s^2 beside the same noise: a tenth.
ROUNDING_SD = 0.2
# A warning whose threshold is crossed near a row may come a row, a tenth of a second, earlier or later.
WORDS = 1


def run(*arguments):
    subprocess.run([BINARY, "--quiet", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def estimate(log, *options):
    out = FOLDER / f"est-{log.name}.csv"
    run("estimate", log, "--vehicle", FOLDER / "car.toml", "-o", out, *options)
    return out


def unit(column):
    for suffix, name in [("accel_m_s2", "m/s^2"), ("speed_m_s", "m/s"), ("kpa", "kPa"), ("_m", "m")]:
        if column.endswith(suffix):
            return name
    raise SystemExit(f"no unit for {column}")


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows[1:]])
    return rows[0], values


def mdf(path, columns, values, compression, rasters, version="4.10"):
    """A channel group per raster: names of its columns and every how many rows they have a sample."""
    file = MDF(version=version)
    for names, every in rasters:
        time = values[::every, 0]
        signals = [Signal(values[::every, columns.index(n)], time, name=n, unit=unit(n)) for n in names]
        file.append(signals, common_timebase=True)
    file.save(path, compression=compression, overwrite=True)
    file.close()


def frames(columns, values):
    """The messages of the example's bus, encoded by cantools, and the values as they come out of them again."""
    database = cantools.database.load_file(DBC)
    chosen = {}
    for line in MAP.read_text().splitlines():
        if " = " in line and not line.startswith("#"):
            column, signal = line.split(" = ")
            message, name = signal.strip('"').split(".")
            chosen.setdefault(message, []).append((name, column))
    # From the column's unit to the signal's.
    factors = {"km/h": 3.6, "mm": 1000.0}
    rounded = values.copy()
    encoded = []
    for message_name, signals in chosen.items():
        message = database.get_message_by_name(message_name)
        others = {signal.name: 0 for signal in message.signals}
        parts = []
        for name, column in signals:
            factor = factors.get(message.get_signal_by_name(name).unit, 1.0)
            parts.append((name, columns.index(column), factor))
        for row in range(len(values)):
            content = others | {name: values[row, index] * factor for name, index, factor in parts}
            data = message.encode(content, strict=False)
            decoded = message.decode(data, decode_choices=False)
            for name, index, factor in parts:
                rounded[row, index] = decoded[name] / factor
            encoded.append((values[row, 0], message.frame_id, message.is_extended_frame, data))
    encoded.sort(key=lambda frame: frame[0])
    return encoded, rounded


def bus_log(path, encoded, **options):
    with can.Logger(path, **options) as logger:
        for time_s, frame_id, extended, data in encoded:
            logger.on_message_received(
                can.Message(timestamp=float(1.7e9 + time_s), arbitration_id=frame_id, is_extended_id=extended, data=data, channel=0)
            )


def table(path, columns, values):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows([["" if np.isnan(x) else repr(float(x)) for x in row] for row in values])


def pressures(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    corners = ["fl", "fr", "rl", "rr"]
    number = lambda key: np.array([[float(row[f"{c}_{key}"]) for c in corners] for row in rows])
    words = [[(row[f"{c}_valid"], row[f"{c}_warning"]) for c in corners] for row in rows]
    return number("pressure_kpa"), number("pressure_sd_kpa"), words


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    original = FOLDER / "drive.csv"
    run("simulate", "drive-puncture", "--seed", 11, "-o", original, "--vehicle-out", FOLDER / "car.toml")
    columns, values = read(original)
    expected = estimate(original).read_bytes()
    faults = []

    def check(name, good, said):
        print(f"{'same ' if good else 'WRONG'}  {name}: {said}")
        if not good:
            faults.append(name)

    parquet = FOLDER / "drive.parquet"
    run("convert", original, parquet)
    check("Parquet", estimate(parquet).read_bytes() == expected, "to the byte")
    everything = [(columns[1:], 1)]
    for compression, word in [(0, "plain"), (1, "deflated"), (2, "transposed and deflated")]:
        path = FOLDER / f"drive-{compression}.mf4"
        mdf(path, columns, values, compression, everything)
        check(f"MDF4 by asammdf, {word}", estimate(path).read_bytes() == expected, "to the byte")
    # MDF 4.3 and its compressions, each plain and transposed.
    for compression, word in [(1, "deflate"), (3, "zstd"), (4, "transposed zstd"), (5, "lz4"), (6, "transposed lz4")]:
        path = FOLDER / f"drive-430-{compression}.mf4"
        mdf(path, columns, values, compression, everything, version="4.30")
        check(f"MDF 4.30 by asammdf, {word}", estimate(path).read_bytes() == expected, "to the byte")
    path = FOLDER / "drive-330.mdf"
    mdf(path, columns, values, 0, everything, version="3.30")
    check("MDF 3.30 by asammdf", estimate(path).read_bytes() == expected, "to the byte")
    # Each corner in a group of its own.
    corners = [([n for n in columns[1:] if n.startswith(c)], 1) for c in ["fl_", "fr_", "rl_", "rr_"]]
    path = FOLDER / "drive-groups.mf4"
    mdf(path, columns, values, 2, [(["speed_m_s"], 1), *corners])
    check("MDF4 by asammdf, five groups", estimate(path).read_bytes() == expected, "to the byte")
    ours = FOLDER / "drive-ours.mf4"
    run("convert", original, ours)
    check("MDF4 by us", estimate(ours).read_bytes() == expected, "to the byte")

    encoded, rounded = frames(columns, values)
    table(FOLDER / "rounded.csv", columns, rounded)
    mean, sd, words = pressures(estimate(FOLDER / "rounded.csv"))
    first, _, _ = pressures(FOLDER / "est-drive.csv.csv")
    # The last without a DBC: python-can puts it into the file.
    for name in ["drive.asc", "drive.blf", "drive.log", "drive.trc", "drive-frames.csv", "drive-frames.mf4", "drive-attached.mf4"]:
        path = FOLDER / name
        attached = name == "drive-attached.mf4"
        bus_log(path, encoded, **({"database": DBC} if attached else {}))
        found, _, said = pressures(estimate(path, *([] if attached else ["--dbc", DBC]), "--signals", MAP))
        if found.shape != mean.shape:
            check(name, False, f"{len(found)} rows instead of {len(mean)}")
            continue
        stamps = (np.abs(found - mean) / sd).max()
        rounding = (np.abs(found - first) / sd).max()
        moved = sum(a != b for a, b in zip(said, words, strict=True))
        good = stamps < STAMPS_SD and rounding < ROUNDING_SD and moved <= WORDS
        check(
            f"{path.name} by python-can, frames by cantools",
            good,
            f"{stamps:.3f} sd from the rounded table, {rounding:.3f} sd from the original, {moved} rows with other words",
        )
    sys.exit(f"not the same: {', '.join(faults)}" if faults else 0)


main()
