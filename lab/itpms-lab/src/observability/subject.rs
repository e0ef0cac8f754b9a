//! Which corner the study is about, and on which drive.
//!
//! Filled by the binary from a vehicle file.

use itpms_core::model::{CornerConfig, QuarterCar};

use itpms_analysis::bound::BoundSetting;

#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    pub vehicle: String,
    pub corner: String,
    pub front: CornerConfig<f64>,
    /// The corner with another unsprung mass that meets the same road (source b').
    pub unlike: CornerConfig<f64>,
    /// Whether `unlike` was made up because the vehicle's corners are alike.
    pub unlike_is_made_up: bool,
    pub drive: BoundSetting,
    pub period_s: f64,
    pub before_s: f64,
    /// The loss as a share of the placard pressure.
    pub loss: f64,
    pub reset_sd_kpa: f64,
}

/// A gauge at a reset is taken to be right to 1.25 % of the placard pressure, as the estimators take it.
const RESET_SHARE: f64 = 0.0125;
/// Unsprung masses closer than this are alike.
const ALIKE: f64 = 0.01;

impl Subject {
    /// A corner on the paper's drive (class A, 20 km/h, 500 Hz) with its own noise; repeated roads of 0.66 s as on the
    /// paper's test bed; a loss of 20 % after 20 s. `partner` is the corner on the same side of the other axle; where
    /// there is none or it has the same unsprung mass, (b') has one 12 % lighter under a body 10 % lighter.
    pub fn new(
        vehicle: &str,
        corner: &str,
        front: &CornerConfig<f64>,
        partner: Option<&CornerConfig<f64>>,
    ) -> Self {
        let car = &front.quarter_car;
        let unlike = partner.filter(|partner| {
            let ratio = partner.quarter_car.unsprung_mass_kg() / car.unsprung_mass_kg();
            (ratio - 1.0).abs() > ALIKE
        });
        let lighter = QuarterCar::new(
            0.9 * car.sprung_mass_kg(),
            0.88 * car.unsprung_mass_kg(),
            car.damping_n_s_per_m(),
            car.spring_n_per_m(),
        );
        // The masses of a car, a little lighter, are masses; if rounding made them none, the corners are alike.
        let lighter = lighter.unwrap_or(*car);
        Self {
            vehicle: vehicle.to_owned(),
            corner: corner.to_owned(),
            front: *front,
            unlike: unlike.copied().unwrap_or(CornerConfig { quarter_car: lighter, ..*front }),
            unlike_is_made_up: unlike.is_none(),
            drive: BoundSetting {
                accel_noise_m_s2: front.accel_noise_or_usual_m_s2(),
                ..BoundSetting::paper()
            },
            period_s: 0.66,
            before_s: 20.0,
            loss: 0.2,
            reset_sd_kpa: RESET_SHARE * front.placard_kpa,
        }
    }

    pub fn paper() -> Self {
        Self::new("paper, Table 2", "fl", &CornerConfig::paper(), None)
    }
}
