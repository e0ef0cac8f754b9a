"""The published EKF-UI (eq. 1-17 of Electronics 2021, 10(11), 1359) on filterpy's ExtendedKalmanFilter, as somebody who works in Python
would write it: filterpy predicts and corrects, and the road, which the filter takes for an unknown input, is found in between."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

# Sec. 4 of the paper.
P_0, Q, R = [1.0, 1.0, 1.0, 1.0, 1e5], 1e-10, 0.5


class UnknownInputFilter(ExtendedKalmanFilter):
    """State x_b, v_b, x_w, v_w, k_t; measurement: the accelerations of body and wheel; unknown input: the road's height."""

    def __init__(self, car, step_s):
        super().__init__(dim_x=5, dim_z=2)
        self.m_b, self.m_w = car["sprung_mass_kg"], car["unsprung_mass_kg"]
        self.c_s, self.k_s = car["damping_n_s_per_m"], car["spring_n_per_m"]
        self.step_s, self.road_m = step_s, 0.0
        # The tire starts at placard pressure.
        stiffness = car["stiffness_at_zero"] + car["stiffness_per_kpa"] * car["placard_kpa"]
        self.x = np.array([0.0, 0.0, 0.0, 0.0, stiffness])
        self.P, self.Q, self.R = np.diag(P_0), Q * np.eye(5), R * np.eye(2)

    def rates(self, x):
        """(1)-(3): the time derivative of the state."""
        strut = self.k_s * (x[2] - x[0]) + self.c_s * (x[3] - x[1])
        tire = x[4] * (self.road_m - x[2])
        return np.array([x[1], strut / self.m_b, x[3], (tire - strut) / self.m_w, 0.0])

    def jacobian(self, x):
        k_s, c_s, m_b, m_w = self.k_s, self.c_s, self.m_b, self.m_w
        return np.array(
            [
                [0.0, 1.0, 0.0, 0.0, 0.0],
                [-k_s / m_b, -c_s / m_b, k_s / m_b, c_s / m_b, 0.0],
                [0.0, 0.0, 0.0, 1.0, 0.0],
                [k_s / m_w, c_s / m_w, -(k_s + x[4]) / m_w, -c_s / m_w, (self.road_m - x[2]) / m_w],
                [0.0, 0.0, 0.0, 0.0, 0.0],
            ]
        )

    def predict_x(self, u=0):
        """(6)-(8), (13): what filterpy's predict calls before it advances the covariance by (14)."""
        self.F = np.eye(5) + self.step_s * self.jacobian(self.x)
        self.x = self.x + self.step_s * self.rates(self.x)

    def step(self, measured):
        self.predict()
        H, D = self.jacobian(self.x)[[1, 3]], np.array([0.0, self.x[4] / self.m_w])
        z = measured - self.rates(self.x)[[1, 3]]
        # (16), with R^-1 (I - H K) = C^-1
        weight = np.linalg.inv(H @ self.P @ H.T + self.R)
        S = 1.0 / (D @ weight @ D)
        self.road_m += S * (D @ weight @ z)
        self.update(measured, lambda x: H, lambda x: self.rates(x)[[1, 3]])
        # (17): what filterpy leaves of the covariance, for an input that had to be found
        gained = self.K @ D
        self.P = self.P + S * np.outer(gained, gained)


def run(columns, corner, car, step_s):
    """The stiffness in N/m after every sample, of shape (rows,)."""
    estimator = UnknownInputFilter(car, step_s)
    samples = np.column_stack([columns[f"{corner}_body_accel_m_s2"], columns[f"{corner}_wheel_accel_m_s2"]])
    found = np.empty(len(samples))
    for row, measured in enumerate(samples):
        estimator.step(measured)
        found[row] = estimator.x[4]
    return found
