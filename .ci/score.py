"""Reads `itpms score --json` of a few seeds and refuses what only a broken estimator would give.

The limits are far from what is measured on purpose: goals are judged over many seeds, a few tell whether it works.
"""

import json
import sys

# Column, part or name of the rows, lowest and highest value, reason.
LIMITS = [
    # One drive's error scatters by some 4 kPa, so the median of eight by less than 2. An estimator that follows nothing
    # has 59 kPa in paper-drop (the error of its initial stiffness).
    ("rmse_median_kpa", "paper", 0.0, 24.0, "following a sudden loss"),
    # Of 95 % intervals. Over eight drives the share of time moves by a few per cent.
    ("coverage", "paper", 0.85, 1.0, "an honest standard deviation"),
    ("bias_before_kpa", "paper", -25.0, 25.0, "no systematic error before the drop"),
    # A mean square error of eight drives at three pressures has a relative standard deviation of sqrt(2/24).
    ("efficiency_39_s", "all pressures", 0.35, 2.5, "near the Cramer-Rao bound, not beyond it"),
    # The four-wheel puncture, on the track and 2 cm beside it: who follows nothing is 70 kPa off. A limit is
    # a good third above what eight seeds give with the noisier sensors; 2 cm off the track even that misses the goals, which
    # the table judges.
    ("fl_rmse_median_kpa", "drive", 0.0, 22.0, "following a puncture of one of four wheels"),
    ("fl_rmse_median_kpa", "car, 80 km/h", 0.0, 4.8, "following it on the track"),
    ("fl_rmse_median_kpa", "car, 80 km/h, reset", 0.0, 3.7, "following it after a reset"),
    ("fl_rmse_median_kpa", "car, 80 km/h, 2 cm off", 0.0, 10.0, "following it beside the track"),
    ("fl_rmse_median_kpa", "car, 20 km/h", 0.0, 10.0, "following it in town"),
    ("rr_rmse_median_kpa", "car, 80 km/h", 0.0, 5.0, "knowing the other wheels"),
    ("rr_rmse_median_kpa", "car, 80 km/h, reset", 0.0, 0.5, "knowing the other wheels after a reset"),
    # What a reset taught of the others is kept there: 2 to 3 kPa, and 6 if it fades.
    ("rl_rmse_median_kpa", "car, 20 km/h, 2 cm off, reset", 0.0, 5.0, "keeping what a reset taught"),
    ("coverage", "drive", 0.9, 1.0, "an honest standard deviation of four wheels"),
    # 74 to 97 % is measured.
    ("coverage_in_change", "drive", 0.65, 1.0, "the same while a tire goes down"),
    # Losses of a fifth, each wheel in turn, classes A to D, 20 to 120 km/h.
    ("missed", "detection", 0.0, 0.0, "every loss reported"),
    ("wrong_wheels", "detection", 0.0, 0.0, "no other wheel named"),
    ("early", "detection", 0.0, 0.0, "nothing reported before it begins"),
    # Counted from the end of a loss that takes seconds, in which it may be named already; before it begins would be `early`.
    ("after_median_s", "one wheel", -10.0, 2.5, "reported in time"),
    ("share_within_goal", "one wheel", 0.85, 1.0, "reported in time in nearly every drive"),
    ("error_median_percent", "road", 0.0, 16.0, "the road's shape"),
    ("iri_error_abs_median_percent", "road", 0.0, 10.0, "the road's roughness"),
]


def main() -> int:
    rows = json.load(sys.stdin)["rows"]
    complaints, looked_at = [], 0
    for row in rows:
        for cell in row["cells"]:
            for name, which, low, high, what in LIMITS:
                if cell["name"] != name or which not in (row["part"], row["name"]):
                    continue
                looked_at += 1
                value = cell["value"]
                verdict = "ok" if value is not None and low <= value <= high else "WRONG"
                line = f"{verdict:5} {row['part']} / {row['name']}: {name} {value}, expected {low} to {high}: {what}"
                print(line)
                if verdict != "ok":
                    complaints.append(line)
    if looked_at == 0:
        print("the score has none of the figures this looks for")
        return 1
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
