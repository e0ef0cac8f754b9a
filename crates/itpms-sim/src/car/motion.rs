//! Where the car's speed and turning leave its body and its rear wheels: accelerations over time, and how far beside the
//! front wheels' track the rear ones run.
//!
//! Called by the simulation, step by step in time. It knows nothing of roads or springs.

use super::CarSpec;
use crate::error::Result;
use crate::time_profile::TimeProfile;

#[derive(Debug, Clone)]
pub(crate) struct Motion {
    speed_m_s: TimeProfile,
    lateral_m_s2: TimeProfile,
    rise_s: f64,
    tightest_per_m: f64,
    wheelbase_m: f64,
    slip_rad_per_m_s2: f64,
    straight_m: f64,
    /// By how much the turns have carried the rear wheels to the left.
    turned_m: f64,
}

impl Motion {
    pub(crate) fn new(spec: &CarSpec, speed_m_s: &TimeProfile, wheelbase_m: f64) -> Result<Self> {
        Ok(Self {
            speed_m_s: speed_m_s.clone(),
            lateral_m_s2: spec.lateral_m_s2()?,
            rise_s: spec.rise_s,
            tightest_per_m: spec.tightest_radius_m.recip(),
            wheelbase_m,
            slip_rad_per_m_s2: spec.rear_slip_rad_per_m_s2,
            straight_m: spec.rear_offset_m,
            turned_m: 0.0,
        })
    }

    /// Acceleration of the car in m/s², forward and to the left.
    pub(crate) fn car_m_s2(&self, time_s: f64) -> [f64; 2] {
        // The mean over the time in which forces come and go: of a step in acceleration it makes a ramp.
        let half = 0.5 * self.rise_s;
        let gain_m_s = self.speed_m_s.value(time_s + half) - self.speed_m_s.value(time_s - half);
        let speed = self.speed_m_s.value(time_s);
        [gain_m_s / self.rise_s, self.curvature_per_m(time_s, speed) * speed * speed]
    }

    /// How far to the left of the front wheels' track the rear ones run now, in m.
    pub(crate) fn beside_m(&self) -> f64 {
        self.straight_m + self.turned_m
    }

    /// Goes on to a time, from one a short step before.
    pub(crate) fn advance(&mut self, time_s: f64, step_s: f64) {
        let speed = self.speed_m_s.value(time_s);
        let curvature = self.curvature_per_m(time_s, speed);
        // Steady turning: the rear wheels cut the corner by L²/2R and slip outwards by L alpha. Into a turn they take
        // about a wheelbase's way.
        let slip_rad = self.slip_rad_per_m_s2 * curvature * speed * speed;
        let steady_m = self.wheelbase_m * (0.5 * curvature * self.wheelbase_m - slip_rad);
        self.turned_m += (steady_m - self.turned_m) * (speed * step_s / self.wheelbase_m);
    }

    /// Curvature in 1/m, to the left, that gives the lateral acceleration asked for, as far as the wheels turn.
    fn curvature_per_m(&self, time_s: f64, speed_m_s: f64) -> f64 {
        let asked = self.lateral_m_s2.value(time_s);
        let most = self.tightest_per_m * speed_m_s * speed_m_s;
        if asked.abs() < most {
            asked / (speed_m_s * speed_m_s)
        } else if asked == 0.0 {
            0.0
        } else {
            self.tightest_per_m.copysign(asked)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(speed: &[[f64; 2]], lateral: &[[f64; 2]], slip: f64) -> Motion {
        let spec = CarSpec {
            lateral_points_s_m_s2: lateral.to_vec(),
            rear_slip_rad_per_m_s2: slip,
            ..CarSpec::default()
        };
        Motion::new(&spec, &TimeProfile::new(speed).unwrap(), 2.7).unwrap()
    }

    #[test]
    fn braking_is_the_speeds_slope_brought_on_in_time() {
        let m = motion(&[[0.0, 20.0], [10.0, 20.0], [15.0, 5.0], [20.0, 0.0]], &[], 0.0);
        // At 9.9 s a sixth of the 0.3 s lies beyond 10 s; at 10 s half of it.
        for (t, a) in [(5.0, 0.0), (9.9, -0.5), (10.0, -1.5), (12.0, -3.0), (17.0, -1.0), (30.0, 0.0)] {
            assert!((m.car_m_s2(t)[0] - a).abs() < 1e-9, "{t}: {:?}", m.car_m_s2(t));
        }
    }

    #[test]
    fn a_turn_is_as_tight_as_asked_for_or_as_the_wheels_allow() {
        let m = motion(&[[0.0, 0.0], [10.0, 20.0]], &[[0.0, -2.0]], 0.0);
        assert_eq!(m.car_m_s2(0.0)[1], 0.0);
        // 2 m/s on 6 m: 0.67 m/s² at most.
        assert!((m.car_m_s2(1.0)[1] + 4.0 / 6.0).abs() < 1e-12);
        assert!((m.car_m_s2(9.0)[1] + 2.0).abs() < 1e-12);
    }

    #[test]
    fn rear_wheels_cut_corners_and_slip_outwards() {
        // A tractrix on a circle: the rear axle's radius is sqrt(R² - L²), R - L²/2R for large R.
        let radius = 60.0f64;
        let speed = 5.0;
        let mut m = motion(&[[0.0, speed]], &[[0.0, speed * speed / radius]], 0.0);
        for i in 0..40_000 {
            m.advance(f64::from(i) * 2.5e-4, 2.5e-4);
        }
        let exact = radius - (radius * radius - 2.7 * 2.7).sqrt();
        // The next term is L⁴/8R³, a 2000th of it.
        assert!((m.beside_m() / exact - 1.0).abs() < 1e-3, "{} {exact}", m.beside_m());
        // At 30 m/s and 2 m/s²: 2.7 (0.5 2.7 2/900 - 0.004 2) m = -1.35 cm, outwards.
        let mut fast = motion(&[[0.0, 30.0]], &[[0.0, 2.0]], 0.004);
        for i in 0..40_000 {
            fast.advance(f64::from(i) * 2.5e-4, 2.5e-4);
        }
        assert!((fast.beside_m() + 0.0135).abs() < 1e-6, "{}", fast.beside_m());
        // Standing, nothing moves.
        let mut still = motion(&[[0.0, 0.0]], &[[0.0, 2.0]], 0.004);
        still.advance(1.0, 2.5e-4);
        assert_eq!(still.beside_m(), 0.0);
    }
}
