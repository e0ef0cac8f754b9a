"""Holds what the firmware prints to examples/firmware/counts.txt: `firmware.py PROFILE < output`, or `firmware.py PROFILE --write`
to take the figures over after a change that is meant.

A figure may be three hundredths off either way: more is worse than what is documented, less means that the table and
docs/benchmarks.md are to be written anew."""

import re
import sys
from pathlib import Path

TABLE = Path(__file__).parent.parent / "examples" / "firmware" / "counts.txt"
HEADER = "# Profile, figure, value: what `cargo run` and `cargo run --bin wheels` in this folder print. `.ci/run firmware` holds it to them within 3 %.\n"
TOLERANCE = 0.03


def main(profile: str, write: bool) -> int:
    output = sys.stdin.read()
    found = {name: int(value) for name, value in re.findall(r"^([a-z_0-9]+) (\d+)$", output, re.M)}
    lines = TABLE.read_text().splitlines() if TABLE.exists() else []
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    warned = re.findall(r"^.*WARNING: fl (.*)$", output, re.M)
    if not any("under-inflated" in text for text in warned) or not any("differs" in text for text in warned) or not found:
        print(output)
        print("the firmware did not end, or did not warn of the tire that goes down, by accelerations and by wheel speeds")
        return 1
    if write:
        rows = [row for row in rows if row[0] != profile] + [[profile, name, str(value)] for name, value in found.items()]
        TABLE.write_text(HEADER + "".join(" ".join(row) + "\n" for row in rows))
        return 0
    held = {name: int(value) for row_profile, name, value in rows if row_profile == profile}
    wrong = 0
    for name in sorted(held.keys() | found.keys()):
        now, before = found.get(name), held.get(name)
        off = now is None or before is None or abs(now - before) > TOLERANCE * before
        wrong += off
        print(f"{profile}  {name}: {now}, in the table {before}{'  <-- more than 3 % off' if off else ''}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:] == ["--write"]))
