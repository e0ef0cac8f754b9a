"""What must have come of the scenario in the virtual machine: reads the directory that `scenario` left and says, line by
line, what was seen and whether that is right.

    judge.py DIR

Called by `run`. Knows nothing of how the machine is made.
"""

import sys
from pathlib import Path

failures = []


def check(what, holds):
    print(f"{'ok    ' if holds else 'FAILED'}  {what}")
    if not holds:
        failures.append(what)


def hello(out):
    """Three frames sent by hand: a standard one, an extended one, one of CAN FD."""
    seen = [line.split(" ", 2)[2] for line in (out / "hello.log").read_text().splitlines()]
    # candump writes the flags of an FD frame behind `##`; the bit-rate switch is bit 0, and kernels since 6.1 set bit 2 (FDF).
    check(f"candump saw the frames of cansend: {seen}", len(seen) == 3
          and seen[:2] == ["123#DEADBEEF", "1ABCDEF0#01"]
          and seen[2].startswith("7FF##") and seen[2].endswith("000102030405060708090A0B"))


def main():
    out = Path(sys.argv[1])
    hello(out)
    if failures:
        sys.exit(f"{len(failures)} of the checks failed")


main()
