//! Configuration of the road estimate: the corner, its sensors, how rough the road may be, and how late the sensors are.
//!
//! Made by whoever owns an estimator; read by [`crate::RoadFilter`] and [`crate::RoadRecorder`].
use itpms_core::Real;
use itpms_core::model::{ParameterError, QuarterCar, positive};

/// How rough the road is believed to be at long waves: the natural logarithm `c` of the one-sided density of its vertical velocity in
/// (m/s)²/Hz, the road level of the pressure estimators. On an ISO 8608 road of waviness 2 the density is the same at all frequencies, `e^c
/// = 4 pi² n0² Gd(n0) V`: class A at 20 km/h is -10.3, class B -8.9, class C at 80 km/h -6.1. It decides where the filter takes noise for
/// noise, not how the heights it sees turn out: a factor of two in the density moves the longest wavelength by 1.4.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RoadLevel<T> {
    /// Learned from the wheel's acceleration, within seconds.
    Adaptive,
    /// Given, and kept until the caller gives another.
    Fixed(T),
}

/// How much later than the motion the sensors' values are. Both sensors pass the same filter, so the data cannot
/// tell (docs/math/road.md, section 6): it is a property of the measuring chain that has to be known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SensorDelay<T> {
    /// A Butterworth low-pass of fourth order before sampling, its cutoff as a share of the sampling rate. Its
    /// delay at low frequencies is `2.613 / (2 pi cutoff)`.
    AntiAlias { cutoff_per_rate: T },
    /// A known delay in s; 0 for a chain without one (a zero-phase filter in a simulation).
    Seconds(T),
}

impl<T: Real> SensorDelay<T> {
    /// The drive log's anti-alias filter: 0.3 of the sampling rate.
    pub fn default_anti_alias() -> Self {
        SensorDelay::AntiAlias { cutoff_per_rate: T::lit(0.3) }
    }

    pub fn delay_s(self, interval_s: T) -> T {
        match self {
            // Sum of 1/Q over the two sections: 0.7654 + 1.8478.
            SensorDelay::AntiAlias { cutoff_per_rate } => {
                T::lit(2.613_126) * interval_s / (T::two_pi() * cutoff_per_rate)
            }
            SensorDelay::Seconds(delay) => delay,
        }
    }
}

/// Everything a road estimate starts from, valid by construction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoadConfig<T> {
    pub(crate) quarter_car: QuarterCar<T>,
    pub(crate) stiffness_n_per_m: T,
    pub(crate) accel_noise_m_s2: T,
    pub(crate) level: RoadLevel<T>,
    pub(crate) sensor_delay: SensorDelay<T>,
    pub(crate) body_mismatch: T,
    pub(crate) low_cut_rad_per_s: T,
    pub(crate) bias_sd_m_s2: T,
    pub(crate) bias_walk_m_s2: T,
}

impl<T: Real> RoadConfig<T> {
    /// A corner, its tire's stiffness in N/m to start from, and the noise of both accelerometers in m/s² rms per
    /// sample. The rest has defaults: [`RoadLevel::Adaptive`], an anti-alias filter at 0.3 of the sampling rate, a
    /// body 5 % off its model, sensor offsets of 10 m/s² that walk by 3e-4 m/s² in a second, a
    /// height without what is slower than 0.05 Hz. Errors: stiffness and noise must be positive and finite.
    pub fn new(
        quarter_car: QuarterCar<T>,
        stiffness_n_per_m: T,
        accel_noise_m_s2: T,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            quarter_car,
            stiffness_n_per_m: positive("stiffness_n_per_m", stiffness_n_per_m)?,
            accel_noise_m_s2: positive("accel_noise_m_s2", accel_noise_m_s2)?,
            level: RoadLevel::Adaptive,
            sensor_delay: SensorDelay::default_anti_alias(),
            body_mismatch: T::lit(0.05),
            low_cut_rad_per_s: T::lit(0.05) * T::two_pi(),
            bias_sd_m_s2: T::lit(10.0),
            bias_walk_m_s2: T::lit(3e-4),
        })
    }

    /// The same with a road level of the caller's. Errors: a fixed level must be between -25 and 5.
    pub fn with_level(self, level: RoadLevel<T>) -> Result<Self, ParameterError> {
        if let RoadLevel::Fixed(log_level) = level {
            within("road_log_level", log_level, -25.0, 5.0, "a number between -25 and 5")?;
        }
        Ok(Self { level, ..self })
    }

    /// The same with another delay of the sensors.
    /// Errors: the delay must be between 0 and 0.1 s, the cutoff between 0.01 and 10 times the sampling rate.
    pub fn with_sensor_delay(self, sensor_delay: SensorDelay<T>) -> Result<Self, ParameterError> {
        match sensor_delay {
            SensorDelay::Seconds(delay) => {
                within("sensor_delay_s", delay, 0.0, 0.1, "a number of seconds between 0 and 0.1")?
            }
            SensorDelay::AntiAlias { cutoff_per_rate } => {
                within("cutoff_per_rate", cutoff_per_rate, 0.01, 10.0, "a number between 0.01 and 10")?
            }
        };
        Ok(Self { sensor_delay, ..self })
    }

    /// The same with another trust in the body as a mass on a spring and a damper: 0 believes the model to the letter, 0.05 (the default)
    /// bears a sprung mass 10 % wrong, 1 takes the body's motion from its sensor alone. Errors: must be between 0 and 1.
    pub fn with_body_mismatch(self, body_mismatch: T) -> Result<Self, ParameterError> {
        Ok(Self {
            body_mismatch: within("body_mismatch", body_mismatch, 0.0, 1.0, "a number between 0 and 1")?,
            ..self
        })
    }

    /// The same with other sensor offsets: their sd at the start in m/s², and how far they walk in a second.
    /// Errors: both must be positive and finite.
    pub fn with_bias(self, bias_sd_m_s2: T, bias_walk_m_s2: T) -> Result<Self, ParameterError> {
        Ok(Self {
            bias_sd_m_s2: positive("bias_sd_m_s2", bias_sd_m_s2)?,
            bias_walk_m_s2: positive("bias_walk_m_s2", bias_walk_m_s2)?,
            ..self
        })
    }

    /// The same with another corner, in Hz, of the high-pass that frees the height of drift: second order, Butterworth,
    /// causal in the filter's estimate and without phase in a record (where it acts twice). Errors: must be between 0.01 and 1 Hz.
    pub fn with_low_cut_hz(self, low_cut_hz: T) -> Result<Self, ParameterError> {
        let low_cut_hz = within("low_cut_hz", low_cut_hz, 0.01, 1.0, "a frequency between 0.01 and 1 Hz")?;
        Ok(Self { low_cut_rad_per_s: low_cut_hz * T::two_pi(), ..self })
    }

    /// Look-ahead in s after which more changes nothing worth having in a record: the high-pass forgets `exp(-6)` in
    /// that time, and the drift behind it faster. 27 s for the default low cut.
    pub fn lookahead_s(&self) -> f64 {
        6.0 * core::f64::consts::SQRT_2 / self.low_cut_rad_per_s.to_f64()
    }
}

/// `value` if it lies between the bounds (NaN does not).
fn within<T: Real>(
    name: &'static str,
    value: T,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<T, ParameterError> {
    if value >= T::lit(low) && value <= T::lit(high) {
        Ok(value)
    } else {
        Err(ParameterError { name, value: value.to_f64(), expected })
    }
}
