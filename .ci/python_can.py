#!/usr/bin/env python3
"""python-can judges the CAN logs, both ways.

    python3 .ci/python_can.py CAN_COPY

python-can writes frames of every kind in each of six formats; the example `can_copy` copies each into each of the three that it
writes; python-can reads the copies. Every field of every frame has to be what was put in, times to a microsecond (a date as a double has
steps of 0.24 us), but for what a format or python-can cannot say (`lost`).
"""

import copy
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import can

FRAMES = 3000
FORMATS = ["log", "asc", "blf"]
READ_ONLY = ["trc", "csv", "mf4"]
TOLERANCE_S = 1e-6


def frames():
    """Every kind, both forms of identifiers, both directions, four buses, uneven steps of time."""
    source = random.Random(5)
    microseconds = 1_795_195_053_250_000
    made = []
    for i in range(FRAMES):
        # The first at a whole millisecond: python-can writes the date of an ASC without what is below.
        microseconds += source.randrange(1, 4000) if i else 0
        kind = source.choices(["data", "remote", "fd", "error"], [10, 2, 6, 1])[0]
        # python-can takes a CAN FD frame without data in an ASC for a remote one.
        length = source.choice([1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64]) if kind == "fd" else source.randrange(9)
        is_extended = source.random() < 0.5
        made.append(
            can.Message(
                timestamp=microseconds / 1e6,
                channel=source.randrange(4),
                arbitration_id=source.randrange(1 << (29 if is_extended else 11)),
                is_extended_id=is_extended,
                is_remote_frame=kind == "remote",
                is_error_frame=kind == "error",
                is_fd=kind == "fd",
                bitrate_switch=kind == "fd" and source.random() < 0.5,
                error_state_indicator=kind == "fd" and source.random() < 0.5,
                is_rx=kind == "error" or source.random() < 0.5,
                dlc=length,
                data=None if kind == "remote" else source.randbytes(length),
                check=True,
            )
        )
    return made


def as_written(message, source):
    """What a format keeps of a message when python-can writes it; None for one that it leaves out."""
    if source == "trc" and (message.is_fd or message.is_remote_frame or message.is_error_frame):
        return None
    if source != "csv":
        return message
    kept = copy.copy(message)
    kept.channel, kept.is_rx, kept.bitrate_switch, kept.error_state_indicator = 0, True, False, False
    kept.is_fd = message.is_fd and message.dlc > 8
    return kept


def read(path):
    """What python-can reads; an ASC with its date."""
    options = {"relative_timestamp": False} if path.suffix == ".asc" else {}
    with can.LogReader(path, **options) as log:
        return list(log)


def fields(message, lost):
    """What has to be the same."""
    if message.is_error_frame:
        # In candump's lines python-can reads no channel of an error; in an ASC there is nothing but the channel.
        return ("error",)
    channel = message.channel
    return (
        int(channel.removeprefix("can")) if isinstance(channel, str) else channel,
        message.arbitration_id,
        message.is_extended_id,
        message.is_remote_frame,
        message.is_fd,
        message.bitrate_switch,
        message.error_state_indicator,
        message.is_rx,
        None if message.is_remote_frame and lost else message.dlc,
        bytes(message.data),
    )


def main():
    os.environ["TZ"] = "UTC"  # ASC files hold local time
    time.tzset()
    can_copy = sys.argv[1]
    made = frames()
    wrong = 0
    with tempfile.TemporaryDirectory() as directory:
        for source in FORMATS + READ_ONLY:
            wanted = [kept for kept in (as_written(message, source) for message in made) if kept is not None]
            written = Path(directory) / f"python.{source}"
            with can.Logger(written) as log:
                for message in made if source == "csv" else wanted:
                    log.on_message_received(message)
            for target in FORMATS:
                copied = Path(directory) / f"{source}-copied.{target}"
                subprocess.run([can_copy, written, copied], check=True, stdout=subprocess.DEVNULL)
                found = read(copied)
                # python-can writes no length of a remote frame into candump's lines.
                lost = source == "log"
                different = sum(fields(a, lost) != fields(b, lost) for a, b in zip(wanted, found, strict=False))
                different += abs(len(wanted) - len(found))
                late_s = max(abs(a.timestamp - b.timestamp) for a, b in zip(wanted, found, strict=False))
                ok = different == 0 and late_s <= TOLERANCE_S
                wrong += not ok
                print(f"{source} -> {target}: {len(found)} frames, {different} different, times to {late_s * 1e6:.2f} us", "" if ok else "WRONG")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
