#!/usr/bin/env python3
"""A small fleet that is made up, for the example of `itpms fleet`: `make.py FOLDER` has `itpms` write FOLDER/cars/CAR.toml and
FOLDER/logs/CAR/drive-N.csv. Needs nothing but Python and `itpms` on the path; simulated_fleet.py makes larger ones."""

import subprocess
import sys
from pathlib import Path

CARS, DRIVES, PLACARD_KPA = 6, 3, 240.0
# Car and drive of a loss, its wheel and the pressure that is left.
LOSSES = {(2, 3): ("rr", 170.0), (5, 2): ("fl", 185.0), (5, 3): ("fl", 185.0)}
# Sprung and unsprung mass of a corner in kg, front and rear, and the wheelbase in m.
MODELS = [(310.0, 36.0, 240.0, 33.0, 2.62), (390.0, 42.0, 350.0, 40.0, 2.82)]


def scenario(car, drive):
    front, front_wheel, rear, rear_wheel, wheelbase_m = MODELS[car % len(MODELS)]
    lines = [f'name = "car-{car}"', "duration_s = 40.0", "rate_hz = 200.0", f"wheelbase_m = {wheelbase_m}", 'confidence = "measured"']
    lines += [f"speed.constant_km_h = {50 + 10 * ((car + 2 * drive) % 5)}", "sensor.noise_m_s2 = 0.05"]
    lines += [f'road.surface.iso8608 = {{ roughness = "{"AB"[(car + drive) % 2]}", slope = 2.0 }}', "[car]"]
    loser, left_kpa = LOSSES.get((car, drive), ("", PLACARD_KPA))
    for corner in ("fl", "fr", "rl", "rr"):
        sprung, unsprung = (front, front_wheel) if corner.startswith("f") else (rear, rear_wheel)
        lines += [f"[corner.{corner}]", f"sprung_mass_kg = {sprung}", f"unsprung_mass_kg = {unsprung}"]
        end_kpa = left_kpa if corner == loser else PLACARD_KPA
        begin_kpa = end_kpa if (car, drive - 1) in LOSSES else PLACARD_KPA
        lines += [f"placard_kpa = {PLACARD_KPA}", f"pressure.points_s_kpa = [[15.0, {begin_kpa}], [20.0, {end_kpa}]]"]
    return "\n".join(lines)


def main():
    folder = Path(sys.argv[1])
    (folder / "cars").mkdir(parents=True, exist_ok=True)
    text = folder / "scenario.toml"
    for car in range(1, CARS + 1):
        logs = folder / "logs" / f"car-{car}"
        logs.mkdir(parents=True, exist_ok=True)
        for drive in range(1, DRIVES + 1):
            text.write_text(scenario(car, drive))
            command = ["itpms", "-q", "lab", "simulate", text, "--seed", 10 * car + drive, "--no-truth", "-o", logs / f"drive-{drive}.csv"]
            subprocess.run([*map(str, command), "--vehicle-out", folder / "cars" / f"car-{car}.toml"], check=True)
    text.unlink()


main()
