"""Holds what the example in C prints to `itpms estimate`: `capi_judge.py est.csv f64.csv f32.csv [board.csv]`.

In double precision they differ by less than 1e-9 kPa: the library has its elementary functions and matrix products from crates without
an operating system, the command's come from the system's library and another crate. In single precision they are those of another rounding:
within 0.05 kPa here. The board's, compiled by another backend for another processor, are those of the host to the last bit of a float, but for
what the order of operations leaves open: the largest difference is printed and is to be below 1e-3 kPa."""

import csv
import sys


def read(path: str) -> dict[str, dict[str, str]]:
    with open(path, newline="") as file:
        return {f"{float(row['time_s']):.6f}": row for row in csv.DictReader(file)}


def largest(a: dict, b: dict, least_rows: int) -> tuple[float, int, int]:
    """Largest difference in kPa of pressures and their sds, the number of cells, and of states that differ."""
    difference, cells, states = 0.0, 0, 0
    for time in a.keys() & b.keys():
        for corner in ("fl", "fr", "rl", "rr"):
            for column in (f"{corner}_pressure_kpa", f"{corner}_pressure_sd_kpa"):
                x, y = (float(row[time][column] or "nan") for row in (a, b))
                if (x == x) != (y == y):
                    raise SystemExit(f"{time} s {column}: {x} and {y}")
                difference = max(difference, abs(x - y) if x == x else 0.0)
                cells += 1
            # `estimate` has a word more for what is not known.
            x, y = (row[time][f"{corner}_state"].replace("uncertain", "unknown") for row in (a, b))
            states += x != y
    if cells < 8 * least_rows:
        raise SystemExit(f"{cells} cells in common, expected {8 * least_rows} or more")
    return difference, cells, states


def main(names: list[str]) -> int:
    estimate, double, single = (read(name) for name in names[:3])
    pairs = [("f64 against estimate", estimate, double, 1e-9, 390), ("f32 against estimate", estimate, single, 0.05, 390)]
    if len(names) > 3:
        pairs.append(("f32 on the board against the host's", single, read(names[3]), 1e-3, 50))
    wrong = 0
    for what, a, b, bound, rows in pairs:
        difference, cells, states = largest(a, b, rows)
        bad = not difference <= bound or (a is estimate and b is double and states > 0)
        print(f"{what}: {difference:.3g} kPa at most in {cells} numbers, {states} states differ{'  <-- WRONG' if bad else ''}")
        wrong += bad
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
