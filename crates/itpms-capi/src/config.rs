//! What a car is given, as a C program fills it in.

use crate::{ITPMS_API_VERSION, itpms_real};

/// How far the parameters of a car are to be trusted: standard deviations of parameters without one of their own.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_confidence {
    /// Weighed and measured on this car.
    Measured = 0,
    /// A manufacturer's figures, or a car of the same model that was measured.
    Typical = 1,
    /// A guess.
    Rough = 2,
}

/// Which loss is warned of.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_regulation {
    /// UN R141 (5.3): 20 % below the warm reference.
    UnR141 = 0,
    /// FMVSS 138 (S4.2): 25 % below the placard.
    Fmvss138 = 1,
}

/// Which wheels the engine turns.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum itpms_driven {
    /// The front wheels.
    Front = 0,
    /// The rear wheels.
    Rear = 1,
    /// All four.
    All = 2,
}

/// One corner of the car: masses, spring, damper, tire. NaN stands for what follows "NaN:".
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_corner_config {
    /// 1: this corner has both accelerometers; 0: it is left out, and nothing else here is read.
    pub is_measured: u32,
    /// Sprung mass in kg.
    pub sprung_mass_kg: itpms_real,
    /// Unsprung mass in kg.
    pub unsprung_mass_kg: itpms_real,
    /// Damping at the wheel in N s/m.
    pub damping_n_s_per_m: itpms_real,
    /// Spring rate at the wheel in N/m.
    pub spring_n_per_m: itpms_real,
    /// Tire stiffness over gauge pressure in N/m per kPa.
    pub stiffness_per_kpa: itpms_real,
    /// Tire stiffness at no gauge pressure in N/m.
    pub stiffness_at_zero: itpms_real,
    /// Standard deviation of `stiffness_per_kpa` in N/m per kPa; NaN: 0.
    pub stiffness_per_kpa_sd: itpms_real,
    /// Standard deviation of `stiffness_at_zero` in N/m; NaN: 0.
    pub stiffness_at_zero_sd: itpms_real,
    /// Correlation of the two, -1 to 1; NaN: 0.
    pub stiffness_correlation: itpms_real,
    /// Gauge pressure on the placard in kPa.
    pub placard_kpa: itpms_real,
    /// What the warm tire should have in kPa gauge; NaN: the placard's.
    pub reference_kpa: itpms_real,
    /// Gauge pressure to start from in kPa; NaN: the placard's.
    pub initial_kpa: itpms_real,
    /// Noise of both accelerometers in m/s^2, rms per sample; NaN: 0.05.
    pub accel_noise_m_s2: itpms_real,
    /// Relative standard deviation of the sprung mass (0.05 is 5 %); NaN: by `confidence`.
    pub sprung_mass_relative_sd: itpms_real,
    /// The same of the unsprung mass.
    pub unsprung_mass_relative_sd: itpms_real,
    /// The same of the spring.
    pub spring_relative_sd: itpms_real,
    /// The same of the damping.
    pub damping_relative_sd: itpms_real,
    /// The same of the tire's line of stiffness over pressure, as one scale.
    pub stiffness_relative_sd: itpms_real,
    /// The same of the tire's stiffness over the unsprung mass; NaN: from the two, each by itself.
    pub stiffness_over_mass_relative_sd: itpms_real,
    /// Coulomb friction of the strut in N; NaN: by `confidence`.
    pub friction_n: itpms_real,
    /// Its standard deviation in N; NaN: by `confidence`.
    pub friction_sd_n: itpms_real,
    /// Vertical damping of the tire in N s/m; NaN: by `confidence`.
    pub tire_damping_n_s_per_m: itpms_real,
    /// Its standard deviation in N s/m; NaN: by `confidence`.
    pub tire_damping_sd_n_s_per_m: itpms_real,
}

/// Radius analysis of four wheel speeds, beside the accelerations or alone.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_wheel_speed_config {
    /// 1: wheel speeds are used; 0: they are not, and nothing else here is read.
    pub is_used: u32,
    /// Which wheels the engine turns: an `itpms_driven`.
    pub driven: u32,
    /// 1: the wheels of a driven axle are coupled, so that they turn alike under torque.
    pub has_limited_slip: u32,
    /// Distance between the front wheels in m.
    pub track_front_m: itpms_real,
    /// Distance between the rear wheels in m.
    pub track_rear_m: itpms_real,
    /// `d ln R / d ln p` of the rolling radius R; NaN: 0.007.
    pub radius_per_ln_pressure: itpms_real,
    /// Its standard deviation as a share of it; NaN: 0.6.
    pub radius_per_ln_pressure_sd: itpms_real,
    /// Standard deviation of the rear axle's load from drive to drive, as a share of it; NaN: 0.2.
    pub load_rear_axle_sd: itpms_real,
    /// The same of one rear wheel's load against the other's; NaN: 0.03.
    pub load_rear_left_right_sd: itpms_real,
    /// Front passengers who get in or out, as a standard deviation; NaN: 1.
    pub load_front_passengers_sd: itpms_real,
}

/// All that a car is given. Filled with its defaults by `itpms_config_init`; four-element arrays are front left, front right,
/// rear left, rear right.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct itpms_config {
    /// `sizeof (itpms_config)`.
    pub struct_size: u32,
    /// `ITPMS_API_VERSION`.
    pub api_version: u32,
    /// Samples per second, about: 100 to 2000. The samples' own times count.
    pub sample_rate_hz: f64,
    /// Distance between the axles in m; NaN: the road that front and rear share is not used.
    pub wheelbase_m: itpms_real,
    /// How far the parameters are to be trusted: an `itpms_confidence`.
    pub confidence: u32,
    /// Which loss is warned of: an `itpms_regulation`.
    pub regulation: u32,
    /// Loss to be warned of as a share of the warm reference, up to 0.5; NaN: by `regulation`.
    pub loss_share: itpms_real,
    /// 1: the height of the road under each wheel is estimated with every sample, which costs time.
    pub wants_road: u32,
    /// 1: tires may gain air while they roll, as of a car with pumps.
    pub has_pumps: u32,
    /// The corners.
    pub corners: [itpms_corner_config; 4],
    /// Wheel speeds.
    pub wheel_speeds: itpms_wheel_speed_config,
    /// Height above the sea in m where the tires are filled, -500 to 6000; NaN: 0.
    pub home_altitude_m: itpms_real,
}

const NAN: itpms_real = itpms_real::NAN;

impl itpms_config {
    /// The struct's size as it says it itself.
    pub(crate) const SIZE: usize = size_of::<Self>();

    /// What is not known: NaN. What is to be chosen: the default. No corner is measured, no wheel speed used.
    pub(crate) const fn unknown() -> Self {
        let corner = itpms_corner_config {
            is_measured: 0,
            sprung_mass_kg: NAN,
            unsprung_mass_kg: NAN,
            damping_n_s_per_m: NAN,
            spring_n_per_m: NAN,
            stiffness_per_kpa: NAN,
            stiffness_at_zero: NAN,
            stiffness_per_kpa_sd: NAN,
            stiffness_at_zero_sd: NAN,
            stiffness_correlation: NAN,
            placard_kpa: NAN,
            reference_kpa: NAN,
            initial_kpa: NAN,
            accel_noise_m_s2: NAN,
            sprung_mass_relative_sd: NAN,
            unsprung_mass_relative_sd: NAN,
            spring_relative_sd: NAN,
            damping_relative_sd: NAN,
            stiffness_relative_sd: NAN,
            stiffness_over_mass_relative_sd: NAN,
            friction_n: NAN,
            friction_sd_n: NAN,
            tire_damping_n_s_per_m: NAN,
            tire_damping_sd_n_s_per_m: NAN,
        };
        let wheel_speeds = itpms_wheel_speed_config {
            is_used: 0,
            driven: itpms_driven::Front as u32,
            has_limited_slip: 0,
            track_front_m: NAN,
            track_rear_m: NAN,
            radius_per_ln_pressure: NAN,
            radius_per_ln_pressure_sd: NAN,
            load_rear_axle_sd: NAN,
            load_rear_left_right_sd: NAN,
            load_front_passengers_sd: NAN,
        };
        Self {
            struct_size: Self::SIZE as u32,
            api_version: ITPMS_API_VERSION,
            sample_rate_hz: f64::NAN,
            wheelbase_m: NAN,
            confidence: itpms_confidence::Typical as u32,
            regulation: itpms_regulation::UnR141 as u32,
            loss_share: NAN,
            wants_road: 0,
            has_pumps: 0,
            corners: [corner; 4],
            wheel_speeds,
            home_altitude_m: NAN,
        }
    }
}
