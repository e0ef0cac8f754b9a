"""The paper's filters once more, in numpy, to hold the Rust ones against.

Equations (1)-(4) and (6)-(33) of Electronics 2021, 10(11), 1359, transcribed one by one, matrices as printed. Nothing is
shared with the crate, not even the form of the arithmetic: inverses where the paper writes inverses, dense Q and R.
What the paper leaves open is decided as `docs/math/ekf-ui.md` and `docs/math/forgetting.md` say.

    python3 generate.py            writes accelerations.csv and one CSV per case beside this file
    python3 generate.py --compare  recomputes all and compares with what is there (to each case's tolerance)
    python3 generate.py --rounding how much each case amplifies rounding, against 80-bit arithmetic

Needs numpy. `accelerations.csv` is the input of all cases, rounded to 1e-6 m/s2 so that all sides read the same numbers.
"""

import argparse
import csv
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).parent
STEPS = 2000
EVERY = 20  # rows kept: each case's steps 1, 20, 40, ..., 2000
COLUMNS = ["k", "x_b", "v_b", "x_w", "v_w", "k_t", "P_55", "lambda", "road", "S"]

# Table 2 and Sec. 5.1. The unsprung mass of the test bed is not said: the simulated corner's.
TABLE_2 = {"m_b": 240.8, "m_w": 56.9, "c_s": 925.8, "k_s": 29114.0}
BENCH = {"m_b": 240.0, "m_w": 56.9, "c_s": 435.2, "k_s": 20663.0}

# Sec. 4 and Sec. 5.1. A sd of 1 m against an R of 0.5 (m/s2)2 costs digits: H P H' is 1e7 R, and (16) takes the
# difference of nearly equal numbers. --rounding shows 1e-6 (of P_55; 6e-8 of the states) and 2e-10 at worst, so two honest
# programs cannot agree to 1e-9 in the first.
SIMULATION = {"k_t0": 220000.0, "P_0": [1, 1, 1, 1, 1e5], "Q": 1e-10, "R": 0.5, "tolerance": 2e-5}
TEST_BED = {"k_t0": 200000.0, "P_0": [1, 1, 1, 1, 10], "Q": 1e-8, "R": 10.0, "tolerance": 1e-8}
# Motion known to 1 cm, a stiffness held for uncertain and an R that the residuals exceed now and then: the stiffness
# moves, the factor acts, 2000 steps are far from any divergence, and rounding grows to no more than 5e-12.
TAME = {"k_t0": 220000.0, "P_0": [1e-4, 1e-2, 1e-4, 1e-2, 1e7], "Q": 1e-10, "R": 0.2, "tolerance": 1e-9}

# name: car, settings, time step in s, reading of (17), forgetting, reading of (18)
CASES = {
    f"{reading}_{name}": (TABLE_2, TAME, 1e-3, reading, forgetting, timing)
    for reading in ("current", "previous")
    for name, forgetting, timing in (
        ("none", "none", "previous"),
        ("one_step", "one_step", "previous"),
        ("one_step_same", "one_step", "same"),
        ("iterative", "iterative", "previous"),
    )
} | {
    # As printed (17) runs away within 2000 steps of 1 ms from the paper's P_0; of 0.2 ms it does not.
    "simulation_current": (TABLE_2, SIMULATION, 1e-3, "current", "one_step", "previous"),
    "simulation_previous": (TABLE_2, SIMULATION, 2e-4, "previous", "one_step", "previous"),
    "bench_current": (BENCH, TEST_BED, 1e-3, "current", "one_step", "previous"),
    "bench_previous": (BENCH, TEST_BED, 2e-4, "previous", "one_step", "previous"),
}


def accelerations():
    """Body and wheel in m/s2: eq. (1) in its steady state over a road of sines, on a tire softer than the filters start
    from, and a little noise. Wheel hop is in it, and a jerk of the wheel half way."""
    m_b, m_w, c_s, k_s = (TABLE_2[name] for name in ("m_b", "m_w", "c_s", "k_s"))
    k_t = 160000.0
    k = np.arange(1, STEPS + 1)
    y = np.zeros((STEPS, 2))
    # Cycles per 1000 steps, road amplitude in m, phase in rad.
    for cycles, amplitude, phase in [(1.3, 6e-3, 0.3), (4.1, 1.5e-3, 1.1), (9.2, 6e-4, 2.0), (13.7, 4e-4, 4.0), (31.0, 1e-4, 5.5)]:
        s = 2j * np.pi * cycles
        strut = c_s * s + k_s
        body, wheel = m_b * s**2 + strut, m_w * s**2 + strut + k_t
        x_w = k_t * body / (body * wheel - strut**2)
        x_b = x_w * strut / body
        turn = np.exp(1j * (2 * np.pi * cycles * k / 1000 + phase))
        y[:, 0] += np.imag(amplitude * s**2 * x_b * turn)
        y[:, 1] += np.imag(amplitude * s**2 * x_w * turn)
    y += np.random.default_rng(1).normal(0.0, 0.02, y.shape)
    y[1000:1010, 1] += 3.0
    return np.round(y, 6)


class Car:
    """Eq. (1)-(4) for the state x = [x_b, v_b, x_w, v_w, k_t] and the unknown input u = x_r."""

    def __init__(self, car, real):
        self.m_b, self.m_w, self.c_s, self.k_s = (real(str(car[name])) for name in ("m_b", "m_w", "c_s", "k_s"))
        self.real = real

    def f(self, x, u):
        """(3), its rows as eq. (1) gives them: the time derivative of the state."""
        x_b, v_b, x_w, v_w, k_t = x
        a_b = (self.k_s * (x_w - x_b) + self.c_s * (v_w - v_b)) / self.m_b
        a_w = (self.k_s * (x_b - x_w) + self.c_s * (v_b - v_w) + k_t * (u - x_w)) / self.m_w
        return np.array([v_b, a_b, v_w, a_w, self.real(0)])

    def h(self, x, u):
        """(4): the two accelerations."""
        return self.f(x, u)[[1, 3]]

    def df_dx(self, x, u):
        m_b, m_w, c_s, k_s = self.m_b, self.m_w, self.c_s, self.k_s
        zero, one = self.real(0), self.real(1)
        return np.array(
            [
                [zero, one, zero, zero, zero],
                [-k_s / m_b, -c_s / m_b, k_s / m_b, c_s / m_b, zero],
                [zero, zero, zero, one, zero],
                [k_s / m_w, c_s / m_w, -(k_s + x[4]) / m_w, -c_s / m_w, (u - x[2]) / m_w],
                [zero] * 5,
            ]
        )

    def dh_dx(self, x, u):
        return self.df_dx(x, u)[[1, 3], :]

    def dh_du(self, x):
        return np.array([[self.real(0)], [x[4] / self.m_w]])


def inverse_2x2(M):
    # Written out, since numpy's own knows no 80-bit numbers.
    (a, b), (c, d) = M
    return np.array([[d, -b], [-c, a]]) / (a * d - b * c)


def prior(lam, A, P, Q):
    return lam * (A @ P @ A.T) + Q  # (18); (14) for lam = 1


def gain(P, H, R):
    return P @ H.T @ inverse_2x2(H @ P @ H.T + R)  # (16)


def one_step(C_0, A, P, H, Q, R):
    M = H @ A @ P @ A.T @ H.T  # (29)
    N = C_0 - H @ Q @ H.T - R  # (30)
    return max(A.dtype.type(1), np.trace(N) / np.trace(M))  # (28)


def iterative(C_0, A, P, H, Q, R, lam_previous, relative_step=0.5, epsilon=1e-3, most=50):
    """(25)-(27) as a descent of (24). Open in the paper: the start (from above, see forgetting.md), the step length (here
    relative to the curvature |dT/dlam|^2), and an end to the iteration."""
    real = A.dtype.type
    F = A @ P @ A.T
    lam = max(lam_previous, np.trace(C_0) / np.trace(H @ F @ H.T))
    for _ in range(most):
        P_prior = prior(lam, A, P, Q)
        believed = inverse_2x2(H @ P_prior @ H.T + R)
        K = P_prior @ H.T @ believed
        T = P_prior @ H.T - K @ C_0  # (23)
        # d(P H')/dlam = F H' and d(C^-1)/dlam = -C^-1 (H F H') C^-1, product rule
        dK = F @ H.T @ believed - P_prior @ H.T @ believed @ (H @ F @ H.T) @ believed
        dT = F @ H.T - dK @ C_0
        slope = np.sum(T * dT)  # derivative of (24)
        phi = real(relative_step) / np.sum(dT * dT)
        following = max(lam - phi * slope, real(0))  # (25), downhill; no covariance below 0
        settled = abs(following - lam) < real(epsilon)  # (26)
        lam = following
        if settled:
            break
    return max(real(1), lam)  # (27)


def run(case, y, real=np.float64):
    """All steps of one case: rows in the order of COLUMNS."""
    car_values, settings, dt, correction, forgetting, timing = CASES[case]
    car, dt = Car(car_values, real), real(str(dt))
    numbers = lambda values: np.array([real(str(v)) for v in values])
    x = numbers([0, 0, 0, 0, settings["k_t0"]])  # (12)
    P = np.diag(numbers(settings["P_0"]))
    Q = np.diag(numbers([settings["Q"]] * 5))
    R = np.diag(numbers([settings["R"]] * 2))
    I_2, I_5 = np.eye(2, dtype=real), np.eye(5, dtype=real)
    u, lam = real(0), real(1)
    G_1, G_2 = np.zeros((2, 2), dtype=real), real(0)
    rows = []
    for k in range(1, STEPS + 1):
        measured = numbers(y[k - 1])
        # Prediction: (6)-(8), (13), (14)
        A = I_5 + dt * car.df_dx(x, u)
        x_prior = x + dt * car.f(x, u)
        # (15), (19)
        H, D = car.dh_dx(x_prior, u), car.dh_du(x_prior)
        z = measured - car.h(x_prior, u)
        # (31)-(33)
        G_1 = G_1 / lam + np.outer(z, z)
        G_2 = G_2 / lam + 1
        C_0 = G_1 / G_2
        if forgetting == "none":
            lam_now = real(1)
        elif forgetting == "one_step":
            lam_now = one_step(C_0, A, P, H, Q, R)
        else:
            lam_now = iterative(C_0, A, P, H, Q, R, lam)
        P_prior = prior(lam if timing == "previous" else lam_now, A, P, Q)
        # Unknown input: (16)
        K = gain(P_prior, H, R)
        R_inverse = inverse_2x2(R)
        S = 1 / (D.T @ R_inverse @ (I_2 - H @ K) @ D)
        u_new = (S @ D.T @ R_inverse @ (I_2 - H @ K) @ (z[:, None] + D * u))[0, 0]
        # Correction: (17)
        x = x_prior + K @ (measured - car.h(x_prior, u_new if correction == "current" else u))
        P = (I_5 + K @ D @ S @ D.T @ R_inverse @ H) @ (I_5 - K @ H) @ P_prior
        u, lam = u_new, lam_now
        rows.append([k, *x, P[4, 4], lam, u, S[0, 0]])
    return rows


def kept(rows):
    return [row for row in rows if row[0] == 1 or row[0] % EVERY == 0]


def write(path, header, rows):
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([[v if isinstance(v, int) else repr(float(v)) for v in row] for row in rows])


def read(path):
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], [[float(value) for value in row] for row in rows[1:]]


def difference(rows, others):
    """Largest difference by column, relative to the column's largest value."""
    a, b = (np.array([[float(v) for v in row] for row in side]) for side in (rows, others))
    return np.max(np.abs(a - b), axis=0) / np.maximum(np.max(np.abs(b), axis=0), 1e-300)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--compare", action="store_true")
    parser.add_argument("--rounding", action="store_true")
    arguments = parser.parse_args()
    if arguments.compare or arguments.rounding:
        _, y = read(HERE / "accelerations.csv")
    else:
        y = accelerations()
        write(HERE / "accelerations.csv", ["body_accel_m_s2", "wheel_accel_m_s2"], y.tolist())
    for case in CASES:
        rows = kept(run(case, y))
        if arguments.compare:
            header, there = read(HERE / f"{case}.csv")
            worst = difference(rows, there)
            print(f"{case}: {np.max(worst):.1e}")
            if header != COLUMNS or not np.max(worst) <= CASES[case][1]["tolerance"]:
                sys.exit(f"{case}.csv is not what generate.py computes")
        elif arguments.rounding:
            worst = difference(rows, kept(run(case, y, np.longdouble)))
            print(case.ljust(24), " ".join(f"{name} {value:.0e}" for name, value in zip(COLUMNS[1:], worst[1:])))
        else:
            write(HERE / f"{case}.csv", COLUMNS, rows)
            last, factors = rows[-1], [row[7] for row in rows]
            forgot = np.mean([row[7] > 1 for row in rows])
            print(case.ljust(24), f"k_t {last[5]:.2f} P_55 {last[6]:.3g} factor to {max(factors):.3g}, above 1 {forgot:.0%} road {last[8]:.3g} max|x| {max(abs(v) for r in rows for v in r[1:5]):.3g}")


if __name__ == "__main__":
    main()
