"""The published AEKF-UI step, and an ordinary EKF with the road as sixth state, on filterpy: reads samples from standard input as JSON,
prints for each filter what it found after every sample and the nanoseconds of the processor a step, of the fastest run. Run by the example `peers`."""

import json
import sys
import time
from pathlib import Path

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

sys.path.insert(0, str(Path(__file__).resolve().parents[4] / "crates" / "itpms-python" / "benches"))
from published import UnknownInputFilter

STEP_S = 2e-3
# The paper's Table 2, and the setting of src/peers/corner.rs.
CAR = {"sprung_mass_kg": 240.8, "unsprung_mass_kg": 56.9, "damping_n_s_per_m": 925.8, "spring_n_per_m": 29_114.0}
CAR |= {"stiffness_at_zero": 220_000.0, "stiffness_per_kpa": 0.0, "placard_kpa": 0.0}
P_0, Q, R = [1e-4, 1e-2, 1e-4, 1e-2, 1e7], 1e-10, 0.2
ROAD_P_0, ROAD_Q = 1e-4, 9e-4 * STEP_S
ROUNDS = 30


class WithoutFactor(UnknownInputFilter):
    """EKF-UI: what the benchmark of the Python package runs."""

    def __init__(self):
        super().__init__(CAR, STEP_S)
        self.P, self.R = np.diag(P_0), R * np.eye(2)

    def found(self):
        return [*self.x, self.road_m]


class Step(WithoutFactor):
    """AEKF-UI: the same with the one-step factor."""

    def __init__(self):
        super().__init__()
        self.factor, self.sum_1, self.sum_2 = 1.0, 0.0, 0.0

    def step(self, measured):
        # (18) with the last factor: λ A P Aᵀ = A λP Aᵀ
        self.P = self.factor * self.P
        self.predict()
        H, D = self.jacobian(self.x)[[1, 3]], np.array([0.0, self.x[4] / self.m_w])
        z = measured - self.rates(self.x)[[1, 3]]
        believed = H @ self.P @ H.T
        # (16), with R^-1 (I - H K) = C^-1
        weight = np.linalg.inv(believed + self.R)
        S = 1.0 / (D @ weight @ D)
        self.road_m += S * (D @ weight @ z)
        self.find_factor(z, np.trace(believed), self.Q[0, 0] * np.vdot(H, H))
        self.update(measured, lambda x: H, lambda x: self.rates(x)[[1, 3]])
        # (17)
        gained = self.K @ D
        self.P = self.P + S * np.outer(gained, gained)

    def find_factor(self, z, believed, by_process):
        """(28)-(33): from traces, `believed` of what the last factor made."""
        last = self.factor
        self.sum_1 = self.sum_1 / last + z @ z
        self.sum_2 = self.sum_2 / last + 1.0
        unexplained = self.sum_1 / self.sum_2 - by_process - np.trace(self.R)
        self.factor = max(1.0, unexplained * last / (believed - by_process))


class Ordinary(ExtendedKalmanFilter):
    """The road as sixth state, walking at random."""

    def __init__(self):
        super().__init__(dim_x=6, dim_z=2)
        self.corner = UnknownInputFilter(CAR, STEP_S)
        self.x = np.array([0.0, 0.0, 0.0, 0.0, 220_000.0, 0.0])
        self.P, self.Q, self.R = np.diag([*P_0, ROAD_P_0]), np.diag([Q] * 5 + [ROAD_Q]), R * np.eye(2)

    def jacobian(self, x):
        self.corner.road_m = x[5]
        whole = np.zeros((6, 6))
        whole[:5, :5] = self.corner.jacobian(x)
        whole[3, 5] = x[4] / self.corner.m_w
        return whole

    def rates(self, x):
        self.corner.road_m = x[5]
        return np.append(self.corner.rates(x), 0.0)

    def predict_x(self, u=0):
        self.F = np.eye(6) + STEP_S * self.jacobian(self.x)
        self.x = self.x + STEP_S * self.rates(self.x)

    def step(self, measured):
        self.predict()
        self.update(measured, lambda x: self.jacobian(x)[[1, 3]], lambda x: self.rates(x)[[1, 3]])

    def found(self):
        return list(self.x)


def once(filter_type, samples):
    """Nanoseconds a step."""
    estimator = filter_type()
    start = time.process_time_ns()
    for measured in samples:
        estimator.step(measured)
    return (time.process_time_ns() - start) / len(samples)


def found(filter_type, samples):
    estimator, everything = filter_type(), []
    for measured in samples:
        estimator.step(measured)
        everything.append([float(value) for value in estimator.found()])
    return everything


def main():
    samples = [np.array(sample) for sample in json.load(sys.stdin)]
    filters = {"filterpy": Step, "without-factor-filterpy": WithoutFactor, "ordinary-filterpy": Ordinary}
    # In turns, so that what else the machine does falls on all of them.
    rounds = [{key: once(filter_type, samples) for key, filter_type in filters.items()} for _ in range(ROUNDS)]
    said = {
        key: {"nanoseconds": min(one[key] for one in rounds), "found": found(filter_type, samples)}
        for key, filter_type in filters.items()
    }
    json.dump(said, sys.stdout)


if __name__ == "__main__":
    main()
