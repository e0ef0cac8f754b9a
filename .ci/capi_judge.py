"""Holds what the example in C prints to `itpms estimate`: `capi_judge.py est.csv f64.csv f32.csv [board.csv]`.

In double precision they differ by less than 1e-9 kPa: the library has its elementary functions and matrix products from crates without
an operating system, the command's come from the system's library and another crate. In single precision they are those of another rounding:
within 0.05 kPa here, but for 0.5 % of the numbers, within 0.5 kPa: where a weight lies at a limit, a piece of work falls into the sample before or
after, and what a frame moves is shown one sample earlier or later. The board's, compiled by another backend for another processor, are those of the host to the last bit of a float, but for
what the order of operations leaves open: the largest difference is printed and is to be below 1e-3 kPa."""

import csv
import sys


def read(path: str) -> dict[str, dict[str, str]]:
    with open(path, newline="") as file:
        return {f"{float(row['time_s']):.6f}": row for row in csv.DictReader(file)}


def differences(a: dict, b: dict, least_rows: int, beside: bool) -> tuple[list[float], int]:
    """Differences in kPa of pressures and their sds, the largest first, and the number of states that differ. With `beside` a number is held
    against the nearest of its own row and those beside it: by rounding a frame may be concluded a sample before a row or after it."""
    found, states = [], 0
    times = sorted(a, key=float)
    at = {time: i for i, time in enumerate(times)}
    for time in a.keys() & b.keys():
        near = times[max(at[time] - 1, 0) : at[time] + 2] if beside else [time]
        for corner in ("fl", "fr", "rl", "rr"):
            for column in (f"{corner}_pressure_kpa", f"{corner}_pressure_sd_kpa"):
                x, y = (float(row[time][column] or "nan") for row in (a, b))
                if (x == x) != (y == y):
                    raise SystemExit(f"{time} s {column}: {x} and {y}")
                others = [float(a[other][column] or "nan") for other in near]
                found.append(min(abs(other - y) for other in others if other == other) if x == x else 0.0)
            x, y = (row[time][f"{corner}_state"] for row in (a, b))
            states += x != y
    if len(found) < 8 * least_rows:
        raise SystemExit(f"{len(found)} cells in common, expected {8 * least_rows} or more")
    return sorted(found, reverse=True), states


def main(names: list[str]) -> int:
    estimate, double, single = (read(name) for name in names[:3])
    # The largest difference, that of all but the share that follows, and the share.
    pairs = [
        ("f64 against estimate", estimate, double, [1e-9, 1e-9], 0.0, 390),
        ("f32 against estimate", estimate, single, [0.5, 0.05], 0.005, 390),
    ]
    if len(names) > 3:
        pairs.append(("f32 on the board against the host's", single, read(names[3]), [1e-3, 1e-3], 0.0, 50))
    wrong = 0
    for what, a, b, [most, usual], share, rows in pairs:
        found, states = differences(a, b, rows, beside=b is single)
        rest = found[int(share * len(found))]
        bad = not (found[0] <= most and rest <= usual) or (a is estimate and b is double and states > 0)
        but = f", {rest:.3g} but for {100 * share} % of them" if share > 0.0 else ""
        print(f"{what}: {found[0]:.3g} kPa at most in {len(found)} numbers{but}, {states} states differ{'  <-- WRONG' if bad else ''}")
        wrong += bad
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
