#!/usr/bin/env python3
"""What other cars tell of a car's pressures: uncalibrated cars of a few models, alone, beside others of their model, and beside others on
the same stretches of road (docs/math/shared-segments.md).

    shared_roads.py [--models 8] [--cars 6] [--stretches 4] [--seconds 40] [--scatter 1.0] [--workers 2]

Every model has a vehicle file that is off as one by `itpms vehicle init` is (unsprung mass 15 %, tires 8 %, dampers 30 %, springs 25 %),
the same for all its cars; every car differs from its model (tires 3 %, unsprung mass 2 %, dampers 10 %, load 5 %, all times --scatter) and
has its tires at 97 % of the placard pressure, give or take 5. Each car drives over the same stretches as the others, and over as many of
its own. Prints the error of a tire's pressure, rms in kPa: by the car's own file; held against the mean of its model's other cars, which
are taken to be at 97 % of the placard on average; and that with what a stretch does to all cars taken out of it. Beside them the scatter of
tire stiffness over unsprung mass as read from stretch to stretch, in per cent: of all, and what is left when a stretch's own part is taken
out."""

import argparse
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import itpms

CORNERS = ("fl", "fr", "rl", "rr")
PLACARD_KPA, USUAL = 241.3, 0.97
# The paper's tire, eq. (5), N/m and N/m per kPa.
AT_ZERO, PER_KPA = 60_880.0, 713.91
# Sprung and unsprung mass in kg, damper in N s/m, spring in N/m.
FRONT, REAR = np.array([390.0, 42.0, 1800.0, 26e3]), np.array([350.0, 40.0, 1700.0, 27e3])
FILE = np.array([0.08, 0.15, 0.30, 0.25])
CAR = np.array([0.05, 0.02, 0.10, 0.03])
FILE_TIRE, CAR_TIRE = 0.08, 0.03
SETTLED_S = 10.0
CLASSES = ("A", "B", "B", "C")


def scenario(corners, tires, pressures, seconds, km_h, roughness, slope):
    """The text of a drive; ``tires`` are factors of the tires' stiffness."""
    head = f"""
name = "stretch"
duration_s = {seconds}
rate_hz = 200.0
settle_s = 5.0
wheelbase_m = 2.82
speed.constant_km_h = {km_h:.1f}
road.surface.iso8608 = {{ roughness = "{roughness}", slope = {slope:.3f} }}
sensor.noise_m_s2 = 0.05
[car]
"""
    keys = ("sprung_mass_kg", "unsprung_mass_kg", "damping_n_s_per_m", "spring_n_per_m")
    for name, values, tire, kpa in zip(CORNERS, corners, tires, pressures, strict=True):
        head += f"[corner.{name}]\n" + "".join(f"{key} = {value:.3f}\n" for key, value in zip(keys, values, strict=True))
        # A tire that is stiffer by a factor is one with more pressure to whoever knows the paper's.
        stiffness = tire * (AT_ZERO + PER_KPA * kpa)
        head += f"pressure.constant_kpa = {(stiffness - AT_ZERO) / PER_KPA:.3f}\n"
    return head


def vehicle_file(corners, tire):
    """The model's file, with the deviations that `itpms vehicle init` states."""
    text = '[vehicle]\nname = "model"\nwheelbase_m = 2.82\n'
    text += f"[tire]\nstiffness_per_kpa = {tire * PER_KPA:.3f}\nstiffness_at_zero = {tire * AT_ZERO:.1f}\nstiffness_relative_sd = {FILE_TIRE}\n"
    sds = ("sprung_mass_relative_sd", "unsprung_mass_relative_sd", "damping_relative_sd", "spring_relative_sd")
    keys = ("sprung_mass_kg", "unsprung_mass_kg", "damping_n_s_per_m", "spring_n_per_m")
    for name, values in zip(CORNERS, corners, strict=True):
        text += f"[corner.{name}]\nplacard_kpa = {PLACARD_KPA}\n"
        for key, value, sd_key, sd in zip(keys, values, sds, FILE, strict=True):
            text += f"{key} = {value:.3f}\n{sd_key} = {sd}\n"
    return text


def stretch(rng):
    """Roughness, slope and seed of a road: its own, whoever drives over it."""
    return rng.choice(CLASSES), rng.uniform(1.8, 2.4), int(rng.integers(1 << 40))


def read(folder, text, file, seed):
    """Stiffness over unsprung mass that a drive shows of each tire, in 1/s2: the mean once it has settled."""
    path = Path(folder) / f"{seed}-{abs(hash(text))}.toml"
    path.write_text(text)
    drive = itpms.simulate(path, seed=seed, truth=False)
    columns = itpms.estimate(drive, file, report=False).columns
    late = columns["time_s"] > SETTLED_S
    masses = {name: corner["unsprung_mass_kg"] for name, corner in file.corners.items()}
    return [np.mean(columns[f"{name}_stiffness_n_per_m"][late]) / masses[name] for name in CORNERS]


def model(number, arguments):
    """Errors in kPa of all tires of a model's cars (alone, beside others, beside others on the same roads), and both scatters."""
    rng = np.random.default_rng([number, 31])
    truth = np.array([FRONT, FRONT, REAR, REAR])
    # A file is wrong about all four corners in nearly the same way.
    wrong = np.exp(rng.normal(0, FILE * np.array([1, 0.97, 1, 1])) + rng.normal(0, [0, 0.03, 0.03, 0.03], (4, 4)))
    tire = np.exp(rng.normal(0, FILE_TIRE))
    file = itpms.Vehicle.parse(vehicle_file(truth * wrong, tire))
    shared = [stretch(rng) for _ in range(arguments.stretches)]
    pressures = PLACARD_KPA * (USUAL + rng.normal(0, 0.05, (arguments.cars, 4)))
    found = np.empty((2, arguments.cars, arguments.stretches, 4))
    with tempfile.TemporaryDirectory() as folder:
        for car in range(arguments.cars):
            corners = truth * np.exp(arguments.scatter * rng.normal(0, CAR, (4, 4)))
            tires = np.exp(arguments.scatter * rng.normal(0, CAR_TIRE, 4))
            for which, stretches in enumerate((shared, [stretch(rng) for _ in shared])):
                for place, (roughness, slope, seed) in enumerate(stretches):
                    km_h = rng.uniform(60, 90)
                    text = scenario(corners, tires, pressures[car], arguments.seconds, km_h, roughness, slope)
                    found[which, car, place] = np.log(read(folder, text, file, seed))
    return errors(found, pressures, truth[:, 1] * wrong[:, 1], tire)


def errors(found, pressures, masses_kg, tire):
    """The three errors, and the scatter in per cent from stretch to stretch of own roads and of shared ones without their mean."""

    def kpa(log_stiffness):
        return (np.exp(log_stiffness) / tire - AT_ZERO) / PER_KPA

    same, own = found
    cars = len(same)
    alone = kpa(own.mean(axis=1) + np.log(masses_kg))
    usual = np.log(tire * (AT_ZERO + PER_KPA * USUAL * PLACARD_KPA))

    def beside(means):
        others = (means.sum(axis=0) - means) / (cars - 1)
        return kpa(usual + means - others)

    with_others, on_the_same = (beside(each.mean(axis=1)) for each in (own, same))
    scatter = 100 * np.sqrt(own.var(axis=1, ddof=1).mean())
    without = same - same.mean(axis=0, keepdims=True)
    left = 100 * np.sqrt(without.var(axis=1, ddof=1).mean() * cars / (cars - 1))
    return [each - pressures for each in (alone, with_others, on_the_same)], (scatter, left)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--models", type=int, default=8)
    parser.add_argument("--cars", type=int, default=6, help="of each model")
    parser.add_argument("--stretches", type=int, default=4, help="of road, that all cars of a model drive over")
    parser.add_argument("--seconds", type=float, default=40.0, help="on each")
    parser.add_argument("--scatter", type=float, default=1.0, help="how much cars of a model differ, over what is usual")
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    with ProcessPoolExecutor(arguments.workers) as pool:
        all_errors, scatters = zip(*pool.map(model, range(arguments.models), [arguments] * arguments.models), strict=True)
    for name, each in zip(("alone", "beside others, other roads", "beside others, same roads"), zip(*all_errors, strict=True), strict=True):
        print(f"{name:28}{np.sqrt(np.mean(np.square(each))):7.1f} kPa rms")
    scatter, left = np.sqrt(np.mean(np.square(scatters), axis=0))
    print(f"{'from stretch to stretch':28}{scatter:7.2f} %, without the stretch's own part {left:.2f} %")


if __name__ == "__main__":
    main()
