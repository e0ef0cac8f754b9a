#!/usr/bin/env python3
"""Writes the CAN logs beside it with python-can (4.6.1 wrote those that are checked in).

    python3 generate.py [DIRECTORY]

The frames are a closed form that crates/itpms-data/tests/can_logs.rs computes as well.
"""

import os
import sys
import time
from pathlib import Path

import can

FRAMES = 48
FD_LENGTHS = [1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64]


def frame(i):
    """Frame number i: every kind, both forms of identifiers, both directions, three buses."""
    kind = i % 8
    length = FD_LENGTHS[i % 15] if kind in (5, 6) else i % 9
    data = bytes((37 * i + 11 * j) % 256 for j in range(length))
    return can.Message(
        timestamp=(1_795_195_053_250_000 + 12_500 * i + i % 3) / 1e6,
        channel=i % 3,
        arbitration_id=0x18FF0000 + 257 * i if i % 4 == 0 else 0x100 + 7 * i % 0x700,
        is_extended_id=i % 4 == 0,
        is_remote_frame=kind == 4,
        is_error_frame=kind == 7,
        is_fd=kind in (5, 6),
        bitrate_switch=kind == 5,
        error_state_indicator=kind == 6,
        is_rx=i % 5 != 0 or kind == 7,
        dlc=length,
        data=None if kind == 4 else data,
        check=True,
    )


def main():
    # The writers take local time.
    os.environ["TZ"] = "UTC"
    time.tzset()
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    for name, options in [
        ("python_can.log", {}),
        ("python_can.asc", {}),
        # Containers so small that objects lie across their borders.
        ("python_can.blf", {"max_container_size": 500}),
        ("python_can_stored.blf", {"max_container_size": 500, "compression_level": 0}),
        ("python_can.trc", {}),
        ("python_can.csv", {}),
        ("python_can.mf4", {"database": Path(__file__).parent / "rich.dbc"}),
    ]:
        with can.Logger(directory / name, **options) as log:
            for i in range(FRAMES):
                log.on_message_received(frame(i))
                if i == 20 and name.endswith((".asc", ".blf")):
                    log.log_event("something that is no frame", frame(i).timestamp)


if __name__ == "__main__":
    main()
