"""A fleet that is made up: cars that differ from what their vehicle files say, and their drives as Parquet files.

    simulated_fleet.py FOLDER [--cars 10] [--drives 5] [--seconds 40] [--first-s 40] [--rate-hz 200] [--workers 2]

Leaves FOLDER/cars/CAR.toml, FOLDER/logs/CAR/drive-N.parquet (with columns `car` and `drive` for Spark) and
FOLDER/truth.csv with each tire's pressure at the end of each drive. A car's first drive is at placard pressure; in one car of
five a tire loses a quarter to a half of its pressure on a later drive. The same arguments give the same fleet."""

import argparse
import csv
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import itpms

CORNERS = ("fl", "fr", "rl", "rr")
PLACARD_KPA = 241.3
# Sprung and unsprung mass in kg, damper in N s/m, spring in N/m: front, rear; wheelbase in m.
CLASSES = {
    "compact": ((310.0, 36.0, 1500.0, 21e3), (240.0, 33.0, 1350.0, 20e3), 2.62),
    "sedan": ((390.0, 42.0, 1800.0, 26e3), (350.0, 40.0, 1700.0, 27e3), 2.82),
    "van": ((520.0, 50.0, 2300.0, 38e3), (460.0, 52.0, 2400.0, 42e3), 3.10),
}


def corner(values, pressures):
    """A corner of a scenario; `pressures` are points of s and kPa."""
    sprung, unsprung, damping, spring = values
    return "\n".join(
        [
            f"sprung_mass_kg = {sprung:.3f}",
            f"unsprung_mass_kg = {unsprung:.3f}",
            f"damping_n_s_per_m = {damping:.3f}",
            f"spring_n_per_m = {spring:.3f}",
            f"pressure.points_s_kpa = {[[round(float(s), 3), round(float(kpa), 3)] for s, kpa in pressures]}",
        ]
    )


def scenario(car_class, corners, pressures, seconds, rate_hz, km_h, roughness):
    """The text of a drive."""
    lines = [f'name = "{car_class}"', f"duration_s = {seconds}", f"rate_hz = {rate_hz}", "settle_s = 5.0"]
    lines += [f"wheelbase_m = {CLASSES[car_class][2]}", "[speed]", f"constant_km_h = {km_h:.1f}"]
    lines += ["[road.surface.iso8608]", f'roughness = "{roughness}"', "slope = 2.1", "[sensor]", "noise_m_s2 = 0.05", "[car]"]
    for name, values in zip(CORNERS, corners, strict=True):
        lines += [f"[corner.{name}]", corner(values, pressures[name])]
    return "\n".join(lines)


def nominal(car_class):
    front, rear, _ = CLASSES[car_class]
    return [front, front, rear, rear]


def make_car(folder, number, drives, seconds, first_s, rate_hz):
    """A car's vehicle file and drives; gives rows of the truth."""
    rng = np.random.default_rng([number, 20])
    name, car_class = f"car-{number:04}", list(CLASSES)[number % len(CLASSES)]
    # Load on the springs, another rim, worn dampers.
    corners = [np.array(values) * (1 + rng.normal(0, [0.05, 0.02, 0.10, 0.03])) for values in nominal(car_class)]
    loser = (int(rng.integers(4)), int(rng.integers(1, max(drives, 2))), rng.uniform(0.25, 0.5)) if number % 5 == 2 else None
    work, truth = folder / "scenarios", []
    work.mkdir(parents=True, exist_ok=True)
    kpa = np.full(4, PLACARD_KPA)
    for drive in range(drives):
        lasts = first_s if drive == 0 else seconds
        begin = kpa.copy()
        if drive > 0:
            begin = kpa = kpa * (1 - rng.uniform(0.0, 0.01, 4))
        end = begin.copy()
        if loser is not None and drive == loser[1]:
            end[loser[0]] *= 1 - loser[2]
        points = {c: [(0.2 * lasts, b), (0.35 * lasts, e)] for c, b, e in zip(CORNERS, begin, end, strict=True)}
        text = scenario(car_class, corners, points, lasts, rate_hz, rng.uniform(50, 110), rng.choice(["A", "B"]))
        path = work / f"{name}-{drive}.toml"
        path.write_text(text)
        made_up = itpms.simulate(path, seed=1000 * number + drive, truth=False)
        place = folder / "logs" / name
        place.mkdir(parents=True, exist_ok=True)
        made_up.frame("pandas").assign(car=name, drive=drive).to_parquet(place / f"drive-{drive}.parquet", index=False)
        truth += [[name, drive, c, round(float(e), 2)] for c, e in zip(CORNERS, end, strict=True)]
        kpa = end
    text = scenario(car_class, nominal(car_class), {c: [(0.0, PLACARD_KPA), (1.0, PLACARD_KPA)] for c in CORNERS}, 1.0, rate_hz, 80.0, "A")
    (work / f"{name}.toml").write_text(text)
    (folder / "cars").mkdir(exist_ok=True)
    itpms.simulate(work / f"{name}.toml", truth=False).vehicle.write(folder / "cars" / f"{name}.toml")
    return truth


def make_fleet(folder, cars, drives, *, seconds=40.0, first_s=40.0, rate_hz=200.0, workers=2):
    """All of them, several cars at a time."""
    folder = Path(folder)
    with ProcessPoolExecutor(workers) as pool:
        made = [pool.submit(make_car, folder, number, drives, seconds, first_s, rate_hz) for number in range(cars)]
        truth = [row for car in made for row in car.result()]
    with open(folder / "truth.csv", "w", newline="") as file:
        csv.writer(file).writerows([["car", "drive", "wheel", "pressure_kpa"], *truth])


def add_arguments(parser, *, cars, drives, seconds=40.0, first_s=40.0):
    """How large a fleet is, with what it is unless given otherwise."""
    parser.add_argument("--cars", type=int, default=cars)
    parser.add_argument("--drives", type=int, default=drives, help="of each car")
    parser.add_argument("--seconds", type=float, default=seconds, help="of a drive")
    parser.add_argument("--first-s", type=float, default=first_s, help="of each car's first drive, at placard pressure")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    add_arguments(parser, cars=10, drives=5)
    parser.add_argument("--rate-hz", type=float, default=200.0)
    parser.add_argument("--workers", type=int, default=2, help="cars that are made at a time")
    arguments = parser.parse_args()
    options = {name: getattr(arguments, name) for name in ("seconds", "first_s", "rate_hz", "workers")}
    make_fleet(arguments.folder, arguments.cars, arguments.drives, **options)


if __name__ == "__main__":
    main()
